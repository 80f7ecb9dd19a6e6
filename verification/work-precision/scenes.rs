//! The scene of the study that is not built in.

use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::{DesignVariable, MechanismBuilder, Prepared, Scene, Settings};

/// Two masses of 1 kg: the first on a rigid link of 1 m to the ground, the second on a bar of 1 m that is very stiff along its line;
/// released from rest, horizontally.
pub struct StiffChain;

impl StiffChain {
    /// EA / L of the bar [N/m].
    pub const STIFFNESS: f64 = 5e7;
    /// Length of the bar without force [m].
    const LENGTH: f64 = 1.0;

    /// Axial force of the bar [N] for the coordinates of the model [m].
    pub fn axial_force(prepared: &Prepared, q: &[f64]) -> f64 {
        let place = |name: &str| {
            let node = prepared.model().nodes.iter().find(|node| node.name == name).expect("a mass of this scene");
            Vector3::first_three(&q[node.dofs.clone()])
        };
        Self::STIFFNESS * ((place("second") - place("first")).length() - Self::LENGTH)
    }
}

impl Scene for StiffChain {
    fn name(&self) -> String {
        "stiff-chain".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 1.0, (0.1, 10.0), "kg")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 100)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass] = x else { return Err(format!("1 variable expected, {} given", x.len())) };
        let ground = m.ground();
        let [near, far] = [1.0, 1.0 + Self::LENGTH].map(|x| Vector3::from_f64([x, 0.0, 0.0]));
        let first = m.point("first", near);
        let second = m.point("second", far);
        m.point_mass("first", first, *mass);
        m.point_mass("second", second, *mass);
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
        m.distance("link", [ground, first], [Vector3::zeros(), near]);
        m.line_spring("bar", [first, second], [near, far], S::from(Self::STIFFNESS), S::from(Self::LENGTH));
        Ok(())
    }
}
