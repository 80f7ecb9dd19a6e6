use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};
use std::f64::consts::TAU;

/// A nut that sinks on a steep vertical screw without friction: its weight turns it.
///
/// z'' = -g m / (m + J (2 pi / pitch)^2), and it turns by 2 pi for every pitch.
pub struct Screw;

impl Scene for Screw {
    fn name(&self) -> String {
        "screw".into()
    }
    fn summary(&self) -> String {
        "a nut sinks on a steep screw and turns".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("mass", 0.4, (0.01, 10.0), "kg"),
            DesignVariable::new("inertia", 1e-3, (1e-6, 1e-2), "kg m2"),
            DesignVariable::new("pitch", 0.1, (0.005, 1.0), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.5, 1500)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, inertia, pitch] = x else { return Err(format!("3 variables expected, {} given", x.len())) };
        let [x, up] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::<S>::from_f64);
        let zero = S::zero();
        let ground = m.ground();
        let nut = m.body("nut", Vector3::zeros(), Quaternion::identity());
        m.rigid_body("nut", nut, *mass, Vector3::zeros(), [*inertia, *inertia, *inertia, zero, zero, zero]);
        m.gravity(up * S::from(-9.81));
        m.helical("thread", [ground, nut], Vector3::zeros(), up, *pitch);
        let arm = x * S::from(0.1);
        m.draw(nut, &[-arm, arm]);
        // the lead of the nut over the time of the scene
        let fall = mass.value() / (mass.value() + inertia.value() * (TAU / pitch.value()).powi(2)) * 9.81 * 1.5 * 1.5 / 2.0;
        m.draw(ground, &[up * S::from(0.1), up * S::from(-1.1 * fall)]);

        m.position_functional("height at the end", Over::Terminal, nut, Vector3::zeros(), up);
        m.position_functional("x of the arm at the end", Over::Terminal, nut, arm, x);
        Ok(())
    }
}
