use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// A body with three different principal inertias turning freely, close enough to its middle axis to tumble.
pub struct FreeBody;

impl Scene for FreeBody {
    fn name(&self) -> String {
        "free-body".into()
    }
    fn summary(&self) -> String {
        "torque-free body with three different inertias".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("I1", 1.0, (0.1, 10.0), "kg m2"),
            DesignVariable::new("I2", 2.0, (0.1, 10.0), "kg m2"),
            DesignVariable::new("I3", 3.0, (0.1, 10.0), "kg m2"),
            DesignVariable::new("omega 1", 1.0, (-10.0, 10.0), "rad/s"),
            DesignVariable::new("omega 2", 0.0, (-10.0, 10.0), "rad/s"),
            DesignVariable::new("omega 3", 1.0, (-10.0, 10.0), "rad/s"),
            DesignVariable::new("arm", 1.0, (0.1, 10.0), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(10.0, 1000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [i1, i2, i3, w1, w2, w3, arm] = x else { return Err(format!("7 variables expected, {} given", x.len())) };
        let body = m.body("body", Vector3::zeros(), Quaternion::identity());
        // body and world frame agree at the start
        m.set_velocity(body, Vector3::zeros(), Vector3::new(*w1, *w2, *w3));
        m.rigid_body("body", body, S::one(), Vector3::zeros(), [*i1, *i2, *i3, S::zero(), S::zero(), S::zero()]);
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::from_f64);
        for axis in [x, y, z] {
            m.draw(body, &[axis * -*arm, axis * *arm]);
        }
        m.position_functional("x of the arm's tip at the end", Over::Terminal, body, y * *arm, x);
        m.target_functional("distance of the arm's tip from its start, integral", Over::Integral, body, y * *arm, y * *arm);
        m.energy_functional("energy at the end", Over::Terminal);
        Ok(())
    }
}
