use crate::design::DesignVariable;
use crate::elements::forces::LoadFrame;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings, Signal, Torque};

/// Two shafts at an angle with a universal joint between them: the input turns evenly, the output does not.
///
/// tan(output) = cos(bend) tan(input), both zero where the input's pin is at right angles to both shafts, as it is at the start. A
/// torque brakes the output. Both shafts have two bearings' worth of support, so three constraint equations are redundant.
pub struct UniversalShaft;

impl Scene for UniversalShaft {
    fn name(&self) -> String {
        "universal-shaft".into()
    }
    fn summary(&self) -> String {
        "two shafts with a universal joint: an even input, an uneven output".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("bend", 0.6, (0.05, 1.5), "rad"),
            DesignVariable::new("rate", 5.0, (0.1, 50.0), "rad/s"),
            DesignVariable::new("inertia of the output", 0.02, (1e-3, 1.0), "kg m2"),
            DesignVariable::new("braking torque", 0.5, (0.0, 10.0), "N m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(3.0, 1500).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [bend, rate, inertia, brake] = x else { return Err(format!("4 variables expected, {} given", x.len())) };
        let (sine, cosine) = bend.sin_cos();
        let zero = S::zero();
        let axes = [Vector3::new(S::one(), zero, zero), Vector3::new(cosine, zero, sine)];
        let y = Vector3::from_f64([0.0, 1.0, 0.0]);
        let ground = m.ground();
        // the output is slowest at the start
        let rates = [*rate, *rate * cosine];
        let mut shafts = Vec::new();
        for (i, (name, from, to)) in [("input", -0.4, 0.0), ("output", 0.0, 0.4)].into_iter().enumerate() {
            let [from, to, middle] = [from, to, 0.5 * (from + to)].map(|place| axes[i] * S::from(place));
            let node = m.body(name, middle, Quaternion::x_axis_to(axes[i]));
            m.set_velocity(node, Vector3::zeros(), axes[i] * rates[i]);
            let axial = if i == 0 { S::from(0.01) } else { *inertia };
            m.rigid_body(
                name,
                node,
                S::from(3.0),
                Vector3::zeros(),
                [axial, S::from(0.04), S::from(0.04), zero, zero, zero],
            );
            m.revolute(&format!("bearing of the {name}"), [ground, node], middle, axes[i]);
            let arm = (if i == 0 { y } else { y.cross(&axes[1]) }) * S::from(0.08);
            // a flange and the fork
            let flange = if i == 0 { from } else { to };
            m.draw(node, &[flange - arm, flange + arm, flange, Vector3::zeros()]);
            m.draw(node, &[-arm, arm]);
            shafts.push(node);
        }
        let [input, output] = [shafts[0], shafts[1]];
        m.universal("universal joint", [input, output], Vector3::zeros(), [y, y.cross(&axes[1])]);
        let turning = Signal::ConstantRate { offset: S::zero(), rate: *rate };
        let drive = m.prescribed_rotation("drive", [ground, input], axes[0], turning);
        let (frame, size) = (LoadFrame::Body, Signal::Constant(*brake));
        m.torque("brake", Torque { on: output, axis: -axes[1], frame, size });

        let tip = axes[1] * S::from(0.4) + y * S::from(0.08);
        m.position_functional("y of the output's flange at the end", Over::Terminal, output, tip, y);
        m.velocity_functional("speed of the output's flange along y at the end", Over::Terminal, output, tip, y);
        m.reaction_functional("driving moment, integral", Over::Integral, drive, &[-S::one()]);
        let largest = Over::smooth_maximum(20.0);
        m.reaction_functional("largest driving moment", largest, drive, &[-S::one()]);
        Ok(())
    }
}
