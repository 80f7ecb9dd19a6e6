//! Two shafts nearly at a right angle with a universal joint, driven from the slow side.

use costate::functionals::Over;
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{DesignVariable, MechanismBuilder, Scene, Settings, Signal};

/// Input along x, output at a right angle less `short` [rad]; the output is driven so far that the input turns by 1 rad.
pub struct BentShafts {
    pub short: f64,
}

impl BentShafts {
    /// Angle by which the input turns [rad]: tan(output) = cos(bend) tan(input).
    pub const INPUT: f64 = 1.0;
}

impl Scene for BentShafts {
    fn name(&self) -> String {
        "bent-shafts".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("inertia", 0.01, (1e-3, 1.0), "kg m2")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 200).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let zero = S::zero();
        let axes = [[1.0, 0.0, 0.0], [self.short.sin(), 0.0, self.short.cos()]].map(Vector3::<S>::from_f64);
        let y = Vector3::from_f64([0.0, 1.0, 0.0]);
        let ground = m.ground();
        let shafts = [("input", -0.2), ("output", 0.2)].map(|(name, place)| {
            let axis = axes[usize::from(place > 0.0)];
            let node = m.body(name, axis * S::from(place), Quaternion::x_axis_to(axis));
            m.rigid_body(name, node, S::from(3.0), Vector3::zeros(), [x[0], S::from(0.04), S::from(0.04), zero, zero, zero]);
            m.revolute(&format!("bearing of the {name}"), [ground, node], axis * S::from(place), axis);
            node
        });
        m.universal("universal joint", shafts, Vector3::zeros(), [y, y.cross(&axes[1])]);
        let turn = (self.short.sin() * Self::INPUT.tan()).atan();
        let ramp = Signal::SmoothRamp { from: zero, to: S::from(turn), start: zero, duration: S::one() };
        m.prescribed_rotation("drive", [ground, shafts[1]], axes[1], ramp);
        m.position_functional("height of a point of the input at the end", Over::Terminal, shafts[0], y, y);
        Ok(())
    }
}
