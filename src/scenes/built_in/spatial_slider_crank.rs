use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// A spatial slider-crank (IFToMM benchmark, after Haug): the crank turns about x beside and above the line on which the slider moves.
///
/// Crank with a revolute joint at A = (0, 0.1, 0.12) m, a spherical joint at its end B, a universal joint at the slider C, whose cross has
/// one pin along the guide. The crank points upwards at the start and turns at 6 rad/s.
///
/// Source: IFToMM library of computational benchmark problems, "Spatial rigid slider-crank mechanism"; Haug (1989).
pub struct SpatialSliderCrank;

impl SpatialSliderCrank {
    /// Bearing of the crank \[m\].
    pub const BEARING: [f64; 3] = [0.0, 0.1, 0.12];
    /// Lengths of crank and rod \[m\].
    pub const LENGTHS: [f64; 2] = [0.08, 0.3];
}

impl Scene for SpatialSliderCrank {
    fn name(&self) -> String {
        "spatial-slider-crank".into()
    }
    fn summary(&self) -> String {
        "spatial slider-crank with a universal joint (IFToMM benchmark)".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let [crank, rod] = Self::LENGTHS;
        vec![
            DesignVariable::new("crank length", crank, (0.04, 0.1), "m"),
            DesignVariable::new("rod length", rod, (0.26, 0.5), "m"),
            DesignVariable::new("slider mass", 2.0, (0.1, 10.0), "kg"),
            DesignVariable::new("rod mass", 0.5, (0.05, 5.0), "kg"),
            DesignVariable::new("rate", 6.0, (-20.0, 20.0), "rad/s"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(5.0, 2500)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [crank_length, rod_length, slider_mass, rod_mass, rate] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let zero = S::zero();
        let [x, up] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::<S>::from_f64);
        let bearing = Vector3::<S>::from_f64(Self::BEARING);
        let pin = bearing + up * *crank_length;
        let [_, y, z] = pin.components();
        let end = x * (*rod_length * *rod_length - y * y - z * z).sqrt();
        let along = end - pin;
        let cross = x.cross(&along);

        // the rod's rates: its ends move with crank and slider, and the pin of its cross stays at right angles to the guide
        let omega = x * *rate;
        let of_pin = omega.cross(&(pin - bearing));
        let of_end = x * (along.dot(&of_pin) / along[0]);
        let lateral = along.cross(&(of_end - of_pin)) * along.dot(&along).recip();
        let normal = cross.cross(&x);
        let turning = lateral - along * (lateral.dot(&normal) / along.dot(&normal));

        let ground = m.ground();
        let half = S::from(0.5);
        let crank = m.body("crank", (bearing + pin) * half, Quaternion::identity());
        m.set_velocity(crank, of_pin * half, omega);
        let moments = [1e-4, 1e-4, 1e-5, 0.0, 0.0, 0.0].map(S::from);
        m.rigid_body("crank", crank, S::from(0.12), Vector3::zeros(), moments);
        let rod = m.body("rod", (pin + end) * half, Quaternion::x_axis_to(along.unit()));
        m.set_velocity(rod, (of_pin + of_end) * half, turning);
        // as published for 0.5 kg
        let (axial, lateral) = (*rod_mass * (4e-4 / 0.5), *rod_mass * (4e-3 / 0.5));
        m.rigid_body("rod", rod, *rod_mass, Vector3::zeros(), [axial, lateral, lateral, zero, zero, zero]);
        let slider = m.body("slider", end, Quaternion::identity());
        m.set_velocity(slider, of_end, Vector3::zeros());
        let cube = S::from(1e-4);
        m.rigid_body("slider", slider, *slider_mass, Vector3::zeros(), [cube, cube, cube, zero, zero, zero]);
        m.gravity(up * S::from(-9.81));
        m.revolute("bearing", [ground, crank], bearing, x);
        m.spherical("crank pin", [crank, rod], pin);
        m.universal("wrist", [slider, rod], end, [x, cross]);
        m.prismatic("guide", [ground, slider], end, x);

        m.draw(crank, &[bearing, pin]);
        m.draw(rod, &[pin, end]);
        let block = x * S::from(0.02);
        m.draw(slider, &[end - block, end + block]);
        m.position_functional("x of the slider at the end", Over::Terminal, slider, end, x);
        m.position_functional("x of the slider, integral", Over::Integral, slider, end, x);
        m.energy_functional("energy at the end", Over::Terminal);
        Ok(())
    }
}
