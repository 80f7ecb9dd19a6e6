//! Projections end at round-off of coordinates and velocities, whatever the step.

use costate::design::DesignVariable;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, StepRecord, march, table_by_name};
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::built_in::DoublePendulum;
use costate::scenes::{AnyScene, MechanismBuilder, Prepared, Scene, Settings, Violation};

/// A heavy top whose body frame sits at its tip: the joint's equation is r = 0, and any round-off in r is all of r.
struct TopWithFrameAtTip;

impl Scene for TopWithFrameAtTip {
    fn name(&self) -> String {
        "top with its frame at the tip".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.02, 100)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let (sine, cosine) = f64::sin_cos(0.5);
        let top = m.body("top", Vector3::zeros(), Quaternion::about(Vector3::from_f64([0.0, 1.0, 0.0]), S::from(0.5)));
        m.set_velocity(top, Vector3::zeros(), Vector3::from_f64([10.0 * sine, 0.0, 10.0 * cosine]));
        let inertia = [0.75, 0.75, 0.5, 0.0, 0.0, 0.0].map(S::from);
        m.rigid_body("top", top, S::one(), Vector3::from_f64([0.0, 0.0, 0.5]), inertia);
        m.gravity(Vector3::from_f64([0.0, 0.0, -2.0]));
        m.spherical("tip", [ground, top], Vector3::zeros());
        Ok(())
    }
}

fn worst_violation(scene: &dyn AnyScene, table: &str, end: f64, steps: usize) -> Violation {
    let x: Vec<f64> = scene.design_variables().iter().map(|variable| variable.initial).collect();
    let method = Method::new(table_by_name(table).expect("listed"), ConstraintLevel::Acceleration);
    let settings = Settings { end, steps, ..scene.default_settings().without_method() };
    let prepared = Prepared::with(scene, &x, method, settings).expect("a sound scene");
    let mut worst = Violation::default();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        worst = worst.worse(prepared.violation(step.t + step.h, &step.q, &step.v));
        true
    });
    let run = march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch);
    if let Err(error) = run {
        panic!("{} with {table}, {steps} steps: {error}", scene.scene_name());
    }
    worst
}

#[test]
fn projections_converge_at_small_steps() {
    for steps in [20, 100, 200] {
        let worst = worst_violation(&TopWithFrameAtTip, "sdirk4", 0.02, steps);
        assert!(worst.position <= 1e-14 && worst.velocity <= 1e-13, "{steps} steps: {worst:?}");
    }
}

/// Velocities are of order 10 m/s, so 1e-13 m/s is about a hundred units in the last place.
#[test]
fn projected_velocities_satisfy_the_joints_to_round_off() {
    for (table, steps) in [("esdirk3", 4000), ("sdirk4", 4000)] {
        let worst = worst_violation(DoublePendulum.as_ref(), table, 4.0, steps);
        assert!(worst.velocity <= 1e-12, "{table}: {worst:?}");
    }
}
