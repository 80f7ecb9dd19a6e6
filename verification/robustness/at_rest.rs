//! Bodies at rest, and brought to rest: nothing that moves is no size to divide by.

use crate::Report;
use costate::integrators::{StepError, tables};
use costate::prelude::*;

/// A bar on a hinge. Its design variables are length, mass, weight of a kilogram and angle of the motor.
struct Bar {
    gravity: f64,
    /// A motor turns it within a time [s].
    motor: Option<f64>,
    steps: usize,
}

impl Scene for Bar {
    fn name(&self) -> String {
        "bar at rest".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("length", 0.7, (0.1, 10.0), "m"),
            DesignVariable::new("mass", 1.3, (0.1, 10.0), "kg"),
            DesignVariable::new("gravity", self.gravity, (0.0, 20.0), "m/s2"),
            DesignVariable::new("angle", 0.5, (-10.0, 10.0), "rad"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, self.steps)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let &[length, mass, gravity, angle] = x else { return Err("4 variables expected".into()) };
        let (ground, axis) = (m.ground(), Vector3::from_f64([0.0, 1.0, 0.0]));
        let up = Vector3::from_f64([0.0, 0.0, 1.0]);
        let bar = m.body("bar", up * (length * -0.5), Quaternion::identity());
        m.rigid_body("bar", bar, mass, Vector3::zeros(), [0.11, 0.12, 0.13, 0.0, 0.0, 0.0].map(S::from));
        m.gravity(up * -gravity);
        m.revolute("hinge", [ground, bar], Vector3::zeros(), axis);
        if let Some(duration) = self.motor {
            let [from, start, duration] = [0.0, 0.0, duration].map(S::from);
            m.prescribed_rotation("motor", [ground, bar], axis, Signal::SmoothRamp { from, to: angle, start, duration });
        }
        m.position_functional("way", Over::Terminal, bar, up * -length, Vector3::from_f64([1.0, 0.0, 0.0]));
        Ok(())
    }
}

/// Difference between adjoint and complex step by the largest entry.
const APART: f64 = 1e-10;
/// Place of the tip against the closed form [m]: of a driven bar the end is where the motor says.
const OFF: f64 = 1e-9;

/// Every method and level with bars at rest and brought to rest: the end against its closed form, the adjoint against complex step, and no
/// warning about bars that are at rest.
pub fn count(report: &mut Report) {
    let (mut right, mut errors, mut warned, mut wrong) = (0, 0, 0, 0);
    for table in tables() {
        for level in ConstraintLevel::ALL {
            for (gravity, motor, steps) in
                [(9.81, None, 50), (0.0, None, 50), (0.0, Some(0.4), 200), (9.81, Some(0.4), 200), (0.0, Some(0.05), 400)]
            {
                let scene = Bar { gravity, motor, steps };
                let method = Method::new(table.clone(), level);
                let case = format!("{} at {} level, gravity {gravity}, motor {motor:?}", table.name, level.name());
                match outcome(&scene, method) {
                    Err(error) => {
                        errors += 1;
                        report.note(format!("{case}: {error}"));
                    }
                    Ok((true, false)) => right += 1,
                    Ok((true, true)) => warned += 1,
                    Ok((false, _)) => {
                        wrong += 1;
                        report.note(format!("{case}: wrong"));
                    }
                }
            }
        }
    }
    report.inform("at rest/right", f64::from(right));
    report.inform("at rest/right, with a warning about the motion to the rest", f64::from(warned));
    report.at_most("at rest/ended by an error", f64::from(errors), 0.0);
    report.at_most("at rest/wrong", f64::from(wrong), 0.0);
}

/// Whether the end and the gradient are right, and whether the estimated error asks for a warning; one at rest that does is wrong.
fn outcome(scene: &Bar, method: Method) -> Result<(bool, bool), RunError> {
    let x: Vec<f64> = Scene::variables(scene).iter().map(|variable| variable.initial).collect();
    let closes = method.level == ConstraintLevel::Acceleration || method.table.stiffly_accurate;
    let prepared = Prepared::with(scene, &x, method, Scene::settings(scene))?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x)?;
    let (adjoint, check) = (analysis.adjoint(&x, &forward)?, analysis.complex_step(&x, &forward)?);
    let angle = if scene.motor.is_some() { x[3] } else { 0.0 };
    // stages that end before the step leave the method's error there
    let off = (forward.values[0] + x[0] * angle.sin()).abs();
    let size = adjoint.rows[0].iter().zip(&x).fold(forward.values[0].abs().max(1e-6), |s: f64, (g, x)| s.max((g * x).abs()));
    let apart = adjoint.rows[0].iter().zip(&check.rows[0]).zip(&x);
    let apart = apart.fold(0.0, |most: f64, ((a, c), x)| most.max((a - c).abs() * x.abs().max(1.0)));
    let warned = forward.error.is_some_and(|error| error.share > StepError::COARSE);
    let is_alarm = warned && scene.motor.is_none();
    Ok(((off <= OFF || !closes) && apart <= APART * size && !is_alarm && forward.leap.is_none(), warned))
}
