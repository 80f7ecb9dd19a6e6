use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// A stiff flyball governor (IFToMM benchmark A05): two rods with balls on a turning shaft, a slider on stiff springs and dampers.
///
/// Shaft and rods 1 m x 0.01 m x 0.01 m, slider a cube of 0.1 m, 3000 kg/m3; balls of 5 kg at the rods' ends, which start 30 degrees below
/// the horizontal; springs and dampers from the middles of the rods to the slider. Nothing acts about the vertical.
///
/// Source: IFToMM library of computational benchmark problems, A05.
pub struct FlyballGovernor;

impl Scene for FlyballGovernor {
    fn name(&self) -> String {
        "flyball-governor".into()
    }
    fn summary(&self) -> String {
        "stiff flyball governor: balls on rods, a slider on stiff springs and dampers (IFToMM A05)".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("stiffness", 8e5, (1e3, 1e7), "N/m"),
            DesignVariable::new("damping", 4e4, (0.0, 1e5), "N s/m"),
            DesignVariable::new("ball mass", 5.0, (0.1, 20.0), "kg"),
            DesignVariable::new("rate", std::f64::consts::TAU, (0.0, 20.0), "rad/s"),
            DesignVariable::new("angle", std::f64::consts::FRAC_PI_6, (0.1, 1.2), "rad"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(10.0, 5000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [stiffness, damping, ball, rate, angle] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let of = S::from;
        let (zero, along) = (S::zero(), |x: S, z: S| Vector3::new(x, S::zero(), z));
        let up = along(zero, S::one());
        let omega = up * *rate;
        // a bar's mass, its moment about its axis and those across
        let (rod, thin, across) = (of(0.3), of(0.3 * 1e-4 / 6.0), of(0.3 * (1.0 + 1e-4) / 12.0));
        let ground = m.ground();
        let shaft = m.body("shaft", up * of(0.5), Quaternion::identity());
        m.set_velocity(shaft, Vector3::zeros(), omega);
        m.rigid_body("shaft", shaft, rod, Vector3::zeros(), [across, across, thin, zero, zero, zero]);
        m.draw(shaft, &[Vector3::zeros(), up]);
        let slider = m.body("slider", up * of(0.5), Quaternion::identity());
        m.set_velocity(slider, Vector3::zeros(), omega);
        let cube = of(3.0 * 0.01 / 6.0);
        m.rigid_body("slider", slider, of(3.0), Vector3::zeros(), [cube, cube, cube, zero, zero, zero]);
        m.revolute("bearing", [ground, shaft], Vector3::zeros(), up);
        m.prismatic("guide", [shaft, slider], up * of(0.5), up);
        m.draw(slider, &[along(of(-0.05), of(0.5)), along(of(0.05), of(0.5))]);

        let (sine, cosine) = angle.sin_cos();
        let y = Vector3::from_f64([0.0, 1.0, 0.0]);
        let mut ball_end = None;
        for (name, side) in [("right", 1.0), ("left", -1.0)] {
            let pivot = along(of(0.05 * side), S::one());
            let direction = along(cosine * side, -sine);
            let middle = pivot + direction * of(0.5);
            let node = m.body(&format!("{name} rod"), middle, Quaternion::x_axis_to(direction));
            m.set_velocity(node, omega.cross(&middle), omega);
            // rod and ball together
            let mass = rod + *ball;
            let centre = *ball * 0.5 / mass;
            let lateral = across + rod * centre * centre + *ball * (-centre + 0.5) * (-centre + 0.5);
            let offset = Vector3::new(centre, zero, zero);
            m.rigid_body(&format!("{name} rod and ball"), node, mass, offset, [thin, lateral, lateral, zero, zero, zero]);
            m.revolute(&format!("{name} pivot"), [shaft, node], pivot, y);
            let (ends, lug) = ([slider, node], along(of(0.05 * side), of(0.5)));
            let rest = (middle - lug).length();
            m.line_spring(&format!("{name} spring"), ends, [lug, middle], *stiffness, rest);
            m.line_damper(&format!("{name} damper"), ends, [lug, middle], *damping);
            let tip = pivot + direction;
            m.draw(node, &[pivot, tip]);
            ball_end = Some((node, tip));
        }
        m.gravity(up * of(-9.81));

        m.position_functional("height of the slider at the end", Over::Terminal, slider, up * of(0.5), up);
        m.position_functional("height of the slider, integral", Over::Integral, slider, up * of(0.5), up);
        if let Some((node, tip)) = ball_end {
            m.position_functional("height of the left ball at the end", Over::Terminal, node, tip, up);
        }
        Ok(())
    }
}
