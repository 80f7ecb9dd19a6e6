use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// A point mass on a massless rod, released from rest with the rod horizontal (IFToMM benchmark A01).
pub struct Pendulum;

impl Scene for Pendulum {
    fn name(&self) -> String {
        "pendulum".into()
    }
    fn summary(&self) -> String {
        "point mass on a massless rod, in Cartesian coordinates (IFToMM A01)".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("mass", 1.0, (0.1, 10.0), "kg"),
            DesignVariable::new("length", 1.0, (0.1, 10.0), "m"),
            DesignVariable::new("gravity", 9.81, (0.1, 20.0), "m/s2"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(10.0, 1000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, length, gravity] = x else { return Err(format!("3 variables expected, {} given", x.len())) };
        let ground = m.ground();
        let start = Vector3::new(-*length, S::zero(), S::zero());
        let bob = m.point("bob", start);
        m.point_mass("bob", bob, *mass);
        m.gravity(Vector3::new(S::zero(), -*gravity, S::zero()));
        let rod = m.distance("rod", [ground, bob], [Vector3::zeros(), start]);
        m.draw(ground, &[Vector3::zeros()]);
        m.position_functional("height, integral", Over::Integral, bob, start, Vector3::from_f64([0.0, 1.0, 0.0]));
        m.position_functional("x at the end", Over::Terminal, bob, start, Vector3::from_f64([1.0, 0.0, 0.0]));
        m.reaction_functional("rod force, integral", Over::Integral, rod, &[S::one()]);
        Ok(())
    }
}
