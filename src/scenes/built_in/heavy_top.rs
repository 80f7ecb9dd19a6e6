use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// A symmetric top whose tip stands on a spherical joint, released tilted with nothing but its own spin.
///
/// Lateral inertia is given about the mass centre; about the pivot it is I1 = I + m l^2, here 0.75 + 1 * 0.5^2 = 1, and
/// m g l = 1. The body frame sits at the mass centre, its z axis along the top.
pub struct HeavyTop;

impl Scene for HeavyTop {
    fn name(&self) -> String {
        "heavy-top".into()
    }
    fn summary(&self) -> String {
        "symmetric top on a spherical joint, nutating".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("mass", 1.0, (0.1, 10.0), "kg"),
            DesignVariable::new("distance of mass centre", 0.5, (0.05, 5.0), "m"),
            DesignVariable::new("lateral inertia", 0.75, (0.01, 10.0), "kg m2"),
            DesignVariable::new("axial inertia", 0.5, (0.01, 10.0), "kg m2"),
            DesignVariable::new("spin", 10.0, (-100.0, 100.0), "rad/s"),
            DesignVariable::new("tilt", 0.5, (0.01, 3.1), "rad"),
            DesignVariable::new("gravity", 2.0, (0.0, 20.0), "m/s2"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(5.0, 1000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, distance, lateral, axial, spin, tilt, gravity] = x else {
            return Err(format!("7 variables expected, {} given", x.len()));
        };
        let ground = m.ground();
        let (sine, cosine) = tilt.sin_cos();
        let axis = Vector3::new(sine, S::zero(), cosine);
        let centre = axis * *distance;
        let top = m.body("top", centre, Quaternion::about(Vector3::from_f64([0.0, 1.0, 0.0]), *tilt));
        m.set_velocity(top, Vector3::zeros(), axis * *spin);
        let inertia = [*lateral, *lateral, *axial, S::zero(), S::zero(), S::zero()];
        m.rigid_body("top", top, *mass, Vector3::zeros(), inertia);
        m.gravity(Vector3::new(S::zero(), S::zero(), -*gravity));
        let tip = m.spherical("tip", [ground, top], Vector3::zeros());
        m.draw(top, &[Vector3::zeros(), centre * S::from(2.0)]);

        let [x, z] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::from_f64);
        m.position_functional("height of the mass centre, integral", Over::Integral, top, centre, z);
        m.position_functional("x of the mass centre at the end", Over::Terminal, top, centre, x);
        m.reaction_functional("vertical force of the tip, integral", Over::Integral, tip, &[0.0, 0.0, 1.0].map(S::from));
        Ok(())
    }
}
