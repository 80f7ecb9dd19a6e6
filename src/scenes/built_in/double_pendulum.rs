use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// Two uniform bars in space: the upper one hangs on a spherical joint, the lower one on a hinge across the elbow.
///
/// The bars start horizontal along x, turning together about the vertical z axis, so that the motion leaves every plane.
pub struct DoublePendulum;

impl Scene for DoublePendulum {
    fn name(&self) -> String {
        "double-pendulum".into()
    }
    fn summary(&self) -> String {
        "two bars in space, spherical shoulder and hinged elbow, thrown about the vertical".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("upper length", 1.0, (0.1, 5.0), "m"),
            DesignVariable::new("lower length", 0.8, (0.1, 5.0), "m"),
            DesignVariable::new("upper mass", 2.0, (0.1, 20.0), "kg"),
            DesignVariable::new("lower mass", 1.0, (0.1, 20.0), "kg"),
            DesignVariable::new("hinge angle", 0.6, (-1.5, 1.5), "rad"),
            DesignVariable::new("spin", 2.0, (-20.0, 20.0), "rad/s"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(5.0, 1000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [upper, lower, upper_mass, lower_mass, hinge, spin] = x else {
            return Err(format!("6 variables expected, {} given", x.len()));
        };
        let along = |x: S| Vector3::new(x, S::zero(), S::zero());
        let omega_world = Vector3::new(S::zero(), S::zero(), *spin);
        let ground = m.ground();
        let mut bar = |name: &str, from: S, length: S, mass: S| {
            let centre = along(from + length * 0.5);
            let node = m.body(name, centre, Quaternion::identity());
            m.set_velocity(node, omega_world.cross(&centre), omega_world);
            let lateral = mass * length * length / 12.0;
            // a round bar whose radius is a twentieth of its length
            let axial = mass * length * length / 800.0;
            m.rigid_body(name, node, mass, Vector3::zeros(), [axial, lateral, lateral, S::zero(), S::zero(), S::zero()]);
            m.draw(node, &[along(from), along(from + length)]);
            node
        };
        let upper_bar = bar("upper bar", S::zero(), *upper, *upper_mass);
        let lower_bar = bar("lower bar", *upper, *lower, *lower_mass);
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        let shoulder = m.spherical("shoulder", [ground, upper_bar], Vector3::zeros());
        let (sine, cosine) = hinge.sin_cos();
        m.revolute("elbow", [upper_bar, lower_bar], along(*upper), Vector3::new(S::zero(), cosine, sine));

        let tip = along(*upper + *lower);
        m.target_functional("distance of the tip from its start, integral", Over::Integral, lower_bar, tip, tip);
        m.position_functional("y of the tip at the end", Over::Terminal, lower_bar, tip, Vector3::from_f64([0.0, 1.0, 0.0]));
        let upwards = [S::zero(), S::zero(), S::one()];
        m.reaction_functional("vertical force of the shoulder, integral", Over::Integral, shoulder, &upwards);
        m.energy_functional("energy at the end", Over::Terminal);
        Ok(())
    }
}
