//! The scenes of the study.

use costate::functionals::Over;
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{DesignVariable, MechanismBuilder, Scene, Settings};

/// How long a metre is and how heavy a kilogram, in the units of a scene.
#[derive(Clone, Copy)]
pub struct Units {
    pub metre: f64,
    pub kilogram: f64,
}

impl Units {
    pub const SI: Units = Units { metre: 1.0, kilogram: 1.0 };
    pub const MILLIMETRE_TONNE: Units = Units { metre: 1e3, kilogram: 1e-3 };

    /// Units that change no bit: what differs then depends on units.
    pub const POWERS_OF_TWO: Units = Units { metre: 1024.0, kilogram: 1.0 / 1024.0 };

    fn newton(self) -> f64 {
        self.metre * self.kilogram
    }
}

/// A rigid bar on a hinge of the ground, a second on a spherical joint at its end, held by a spring; both are moving at the start.
pub struct Arm(pub Units);

impl Arm {
    /// Units of the functionals, in the order in which they are added.
    pub fn functional_units(&self) -> [f64; 5] {
        let Units { metre, .. } = self.0;
        let newton = self.0.newton();
        [metre, metre, newton * metre, newton, newton]
    }
    /// Units of the variables.
    pub fn variable_units(&self) -> [f64; 4] {
        let Units { metre, kilogram } = self.0;
        [metre, kilogram, self.0.newton() / metre, 1.0]
    }
}

impl Scene for Arm {
    fn name(&self) -> String {
        "arm".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let [metre, kilogram, stiffness, spin] = self.variable_units();
        vec![
            DesignVariable::new("length", 0.8 * metre, (0.1 * metre, 5.0 * metre), "length"),
            DesignVariable::new("mass", 2.0 * kilogram, (0.1 * kilogram, 20.0 * kilogram), "mass"),
            DesignVariable::new("stiffness", 5.0 * stiffness, (0.1 * stiffness, 1e3 * stiffness), "force/length"),
            DesignVariable::new("spin", 0.5 * spin, (-20.0, 20.0), "rad/s"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 100)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [length, mass, stiffness, spin] = x else { return Err(format!("4 variables expected, {} given", x.len())) };
        let Units { metre, .. } = self.0;
        let newton = self.0.newton();
        let (right, up) = (Vector3::new(S::one(), S::zero(), S::zero()), Vector3::from_f64([0.0, 0.0, 1.0]));
        let ground = m.ground();
        let mut bar = |name: &str, from: S, mass: S| {
            let centre = right * (from + *length * 0.5);
            let bar = m.body(name, centre, Quaternion::identity());
            let across = mass * *length * *length / 12.0;
            let inertia = [across * 0.02, across, across, S::zero(), S::zero(), S::zero()];
            m.rigid_body(name, bar, mass, centre, inertia);
            let omega = Vector3::new(S::zero(), -*spin, S::zero());
            m.set_velocity(bar, Vector3::new(S::zero(), S::zero(), *spin * centre[0]), omega);
            bar
        };
        let (upper, lower) = (bar("upper", S::zero(), *mass), bar("lower", *length, *mass * 0.5));
        let hinge = m.revolute("hinge", [ground, upper], Vector3::zeros(), Vector3::from_f64([0.0, 1.0, 0.0]));
        m.spherical("elbow", [upper, lower], right * *length);
        m.gravity(up * S::from(-9.81 * metre));
        let tip = right * (*length * 2.0);
        let anchor = Vector3::new(*length, S::from(0.5 * metre), S::from(0.3 * metre));
        m.line_spring("spring", [ground, lower], [anchor, tip], *stiffness, S::from(0.2 * metre));
        m.position_functional("height at the end", Over::Terminal, lower, tip, up);
        // the sharpness is per unit of what is measured
        let largest = Over::smooth_maximum(20.0 / metre);
        m.position_functional("largest height", largest, lower, tip, up);
        m.energy_functional("energy at the end", Over::Terminal);
        let force = [1.0, 0.0, 0.0, 0.0, 0.0].map(S::from);
        m.reaction_functional("hinge force at the end", Over::Terminal, hinge, &force);
        let largest = Over::smooth_maximum(0.1 / newton);
        m.reaction_functional("largest hinge force", largest, hinge, &force);
        Ok(())
    }
}

/// Two point masses on two rods, the second `ratio` times as heavy as the first, both moving at the start.
pub struct UnequalMasses {
    pub ratio: f64,
}

impl Scene for UnequalMasses {
    fn name(&self) -> String {
        format!("masses 1 and {:e}", self.ratio)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("first length", 1.0, (0.1, 5.0), "m"),
            DesignVariable::new("second length", 0.7, (0.1, 5.0), "m"),
            DesignVariable::new("first mass", 1.0, (0.1, 5.0), "kg"),
            DesignVariable::new("second mass", self.ratio, (0.1 * self.ratio, 5.0 * self.ratio), "kg"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 500)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [first, second, first_mass, second_mass] = x else {
            return Err(format!("4 variables expected, {} given", x.len()));
        };
        let ground = m.ground();
        let knee = Vector3::new(*first, S::zero(), S::zero());
        let end = Vector3::new(*first, *second, S::zero());
        let (near, far) = (m.point("near", knee), m.point("far", end));
        m.point_mass("near", near, *first_mass);
        m.point_mass("far", far, *second_mass);
        m.set_velocity(near, Vector3::from_f64([0.0, 0.0, 1.0]), Vector3::zeros());
        m.set_velocity(far, Vector3::from_f64([0.5, 0.0, 1.0]), Vector3::zeros());
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        m.distance("upper rod", [ground, near], [Vector3::zeros(), knee]);
        m.distance("lower rod", [near, far], [knee, end]);
        m.position_functional("near at the end", Over::Terminal, near, knee, Vector3::from_f64([0.3, 0.5, 0.8]));
        m.position_functional("far at the end", Over::Terminal, far, end, Vector3::from_f64([0.3, 0.5, 0.8]));
        m.energy_functional("energy at the end", Over::Terminal);
        Ok(())
    }
}

/// A pendulum in the plane z = 0, held there by a second rod whose end on the ground lies `gap` beside that of the first; without a
/// gap there is one rod only, and the motion stays in the plane by itself.
pub struct NearlyParallelRods {
    pub gap: f64,
}

impl Scene for NearlyParallelRods {
    fn name(&self) -> String {
        format!("rods {:e} m apart", self.gap)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("length", 1.0, (0.1, 5.0), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 200)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let place = Vector3::new(x[0], S::zero(), S::zero());
        let bob = m.point("bob", place);
        m.point_mass("bob", bob, S::one());
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
        m.distance("rod", [ground, bob], [Vector3::zeros(), place]);
        if self.gap != 0.0 {
            m.distance("second rod", [ground, bob], [Vector3::from_f64([0.0, 0.0, self.gap]), place]);
        }
        m.position_functional("height at the end", Over::Terminal, bob, place, Vector3::from_f64([0.0, 1.0, 0.0]));
        m.position_functional("out of the plane", Over::Terminal, bob, place, Vector3::from_f64([0.0, 0.0, 1.0]));
        Ok(())
    }
}
