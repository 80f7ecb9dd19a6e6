use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// Two four-bar linkages side by side (IFToMM benchmark A02 with N = 2): three vertical and two horizontal uniform links.
///
/// Upright at the start, B0 moves along x. Each time the links lie flat in one line the mechanism is singular: other branches
/// than the parallelogram open there. Spatial bodies with parallel hinges, so some constraint equations are redundant.
pub struct TwoFourBar;

impl Scene for TwoFourBar {
    fn name(&self) -> String {
        "two-four-bar".into()
    }
    fn summary(&self) -> String {
        "two four-bar linkages through singular poses (IFToMM A02, N = 2)".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("height", 1.0, (0.2, 5.0), "m"),
            DesignVariable::new("width", 1.0, (0.2, 5.0), "m"),
            DesignVariable::new("vertical mass", 1.0, (0.1, 10.0), "kg"),
            DesignVariable::new("horizontal mass", 1.0, (0.1, 10.0), "kg"),
            DesignVariable::new("speed", 1.0, (-10.0, 10.0), "m/s"),
        ]
    }
    fn settings(&self) -> Settings {
        // up to shortly before the first singular pose
        Settings::new(0.7, 700).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [height, width, vertical_mass, horizontal_mass, speed] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let at = |column: usize, y: S| Vector3::new(*width * column as f64, y, S::zero());
        let hinge = Vector3::from_f64([0.0, 0.0, 1.0]);
        let ground = m.ground();
        let mut link = |name: String, from: Vector3<S>, to: Vector3<S>, mass: S, velocity: Vector3<S>, omega: Vector3<S>| {
            let along = to - from;
            let length = along.length();
            let node = m.body(&name, (from + to) * S::from(0.5), Quaternion::x_axis_to(along.unit()));
            m.set_velocity(node, velocity, omega);
            let lateral = mass * length * length / 12.0;
            // a slender link: next to no inertia about its own axis, which never turns in the plane
            let axial = lateral * 1e-3;
            m.rigid_body(&name, node, mass, Vector3::zeros(), [axial, lateral, lateral, S::zero(), S::zero(), S::zero()]);
            m.draw(node, &[from, to]);
            node
        };
        let along_x = |speed: S| Vector3::new(speed, S::zero(), S::zero());
        let omega = hinge * (-*speed / *height);
        let verticals: Vec<_> = (0..3)
            .map(|i| {
                let (foot, head) = (at(i, S::zero()), at(i, *height));
                link(format!("vertical {i}"), foot, head, *vertical_mass, along_x(*speed * 0.5), omega)
            })
            .collect();
        let horizontals: Vec<_> = (0..2)
            .map(|i| {
                let (from, to) = (at(i, *height), at(i + 1, *height));
                link(format!("horizontal {i}"), from, to, *horizontal_mass, along_x(*speed), Vector3::zeros())
            })
            .collect();
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
        for (i, &vertical) in verticals.iter().enumerate() {
            m.revolute(&format!("A{i}"), [ground, vertical], at(i, S::zero()), hinge);
        }
        for (i, &horizontal) in horizontals.iter().enumerate() {
            m.revolute(&format!("B{i} right"), [verticals[i], horizontal], at(i, *height), hinge);
            m.revolute(&format!("B{} left", i + 1), [horizontal, verticals[i + 1]], at(i + 1, *height), hinge);
        }
        let head = at(0, *height);
        let [x, y] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from_f64);
        m.position_functional("x of B0 at the end", Over::Terminal, verticals[0], head, x);
        m.position_functional("y of B0, integral", Over::Integral, verticals[0], head, y);
        m.energy_functional("energy at the end", Over::Terminal);
        Ok(())
    }
}
