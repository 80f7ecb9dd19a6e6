use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// A falling rack drives a pinion, and a gear on the pinion's shaft a second wheel.
///
/// The rack falls with g m / (m + (J1 + J2 (r1 / r2)^2) / r^2): pinion radius r, gears of radii r1 and r2.
pub struct GearTrain;

impl Scene for GearTrain {
    fn name(&self) -> String {
        "gear-train".into()
    }
    fn summary(&self) -> String {
        "a falling rack drives a pinion and, over gears, a flywheel".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("rack mass", 2.0, (0.1, 20.0), "kg"),
            DesignVariable::new("pinion radius", 0.05, (0.01, 0.1), "m"),
            DesignVariable::new("first gear radius", 0.12, (0.05, 0.15), "m"),
            DesignVariable::new("second gear radius", 0.06, (0.04, 0.2), "m"),
            DesignVariable::new("inertia of the first shaft", 0.01, (1e-4, 1.0), "kg m2"),
            DesignVariable::new("inertia of the flywheel", 0.004, (1e-4, 1.0), "kg m2"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 1000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, radius, first, second, shaft_inertia, flywheel_inertia] = x else {
            return Err(format!("6 variables expected, {} given", x.len()));
        };
        let [x, y, axis] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::<S>::from_f64);
        let zero = S::zero();
        let ground = m.ground();
        let mut wheel = |name: &str, centre: Vector3<S>, radii: [S; 2], inertia: S| {
            let node = m.body(name, centre, Quaternion::identity());
            let across = inertia * 0.5;
            m.rigid_body(name, node, S::one(), Vector3::zeros(), [across, across, inertia, zero, zero, zero]);
            m.revolute(&format!("bearing of the {name}"), [ground, node], centre, axis);
            for radius in radii {
                let rim: Vec<Vector3<S>> = (0..=24)
                    .map(|i| (f64::from(i) / 24.0 * std::f64::consts::TAU).sin_cos())
                    .map(|(sine, cosine)| centre + (x * S::from(cosine) + y * S::from(sine)) * radius)
                    .collect();
                m.draw(node, &rim);
            }
            m.draw(node, &[centre, centre + x * radii[1]]);
            let angle = m.joint_angle(&format!("angle of the {name}"), [ground, node], axis);
            (node, angle)
        };
        let (pinion, turned) = wheel("pinion", Vector3::zeros(), [*radius, *first], *shaft_inertia);
        let (flywheel, answered) = wheel("flywheel", x * (*first + *second), [*second, *second], *flywheel_inertia);
        m.gear("gears", [turned, answered], [*first, *second]);

        let contact = x * -*radius;
        let rack = m.body("rack", contact, Quaternion::identity());
        let small = *mass * 1e-3;
        m.rigid_body("rack", rack, *mass, Vector3::zeros(), [small, small, small, zero, zero, zero]);
        m.prismatic("guide", [ground, rack], contact, y);
        m.rack_and_pinion("mesh", [ground, pinion, rack], [Vector3::zeros(), contact], axis);
        m.draw(rack, &[contact - y * S::from(0.1), contact + y * S::from(0.4)]);
        m.gravity(y * S::from(-9.81));

        m.position_functional("height of the rack at the end", Over::Terminal, rack, contact, y);
        m.coordinate_functional("angle of the flywheel at the end", Over::Terminal, answered, 0);
        let rim = x * (*first + *second * 2.0);
        m.position_functional("flywheel, y of its rim at the end", Over::Terminal, flywheel, rim, y);
        Ok(())
    }
}
