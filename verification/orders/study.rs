//! Observed orders of coordinates, velocities, multipliers and an integral, for every integrator at every constraint level.

mod exact;

use crate::verification::{Report, Study};
use costate::design::DesignVariable;
use costate::functionals::Over;
use costate::integrators::{ConstraintLevel, Method, Table, tables};
use costate::scalar::{Quaternion, Scalar, Vec3};
use costate::scenes::built_in::Pendulum;
use costate::scenes::{AnyScene, MechanismBuilder, Prepared, Scene, Settings};
use exact::{Exact, HeavyTop};

/// How far an observed order may be from the expected one.
const TOLERANCE: f64 = 0.1;
/// Steps of the runs over one second; the last pair is held to the expectation, the others inform.
const STEPS: [usize; 4] = [40, 80, 160, 320];

/// Expected orders of q, v and mu from h = 1/160 to 1/320 on the pendulum; `None` where no clean order is claimed.
type Expected = [Option<f64>; 3];

const fn orders(q: f64, v: f64, mu: f64) -> Expected {
    [Some(q), Some(v), Some(mu)]
}

/// What each integrator does at the position, velocity and acceleration level: the table of the design.
const EXPECTED: [(&str, [Expected; 3]); 7] = [
    ("midpoint", [orders(2.0, 2.0, 1.0), orders(2.0, 2.0, 2.0), orders(2.0, 2.0, 2.0)]),
    ("dirk2", [orders(2.2, 1.0, 0.0), orders(2.4, 1.9, 1.0), orders(3.0, 3.0, 2.0)]),
    ("dirk3", [orders(1.9, 1.0, 0.0), orders(2.0, 2.0, 1.0), [None, Some(4.2), Some(2.0)]]),
    ("sdirk2", [orders(1.0, 1.0, 0.0), orders(2.0, 2.0, 1.0), orders(2.0, 2.0, 2.0)]),
    ("sdirk3", [orders(1.0, 1.0, 0.0), orders(2.0, 2.0, 1.0), orders(3.0, 3.0, 3.0)]),
    ("sdirk4", [orders(1.0, 1.0, 0.0), orders(2.0, 2.0, 1.0), orders(4.0, 4.0, 4.0)]),
    ("esdirk3", [orders(2.0, 2.0, 1.0), orders(3.0, 3.0, 2.0), orders(3.0, 3.0, 3.0)]),
];

/// The expectation for a table; a new integrator is held to its own order at acceleration level.
fn expected(table: &Table, level: ConstraintLevel) -> Expected {
    let place = ConstraintLevel::ALL.iter().position(|own| *own == level).unwrap_or(0);
    match EXPECTED.iter().find(|(name, _)| *name == table.name) {
        Some((_, levels)) => levels[place],
        None if level == ConstraintLevel::Acceleration => [Some(table.order as f64), Some(table.order as f64), None],
        None => [None; 3],
    }
}

/// The study.
pub struct Orders;

impl Study for Orders {
    fn name(&self) -> &'static str {
        "orders"
    }
    fn summary(&self) -> &'static str {
        "observed orders of every integrator at every constraint level, on a pendulum and a heavy top"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let angle = exact::pendulum(1.0).q[0].atan2(exact::pendulum(1.0).q[1]);
        let closed = exact::pendulum_angle(1.0);
        report.at_most(
            "reference/pendulum-angle-against-elliptic-function",
            (-closed.sin()).atan2(-closed.cos()) - angle,
            1e-13,
        );
        let problems: [(&str, &dyn AnyScene, fn(f64) -> Exact); 2] =
            [("pendulum", &Pendulum, exact::pendulum), ("heavy-top", &HeavyTop, HeavyTop::at)];
        for table in tables() {
            for level in ConstraintLevel::ALL {
                for (scene_name, scene, exact) in problems {
                    let errors: Result<Vec<[f64; 4]>, String> =
                        STEPS.iter().map(|&steps| errors(scene, exact, &table, level, steps)).collect();
                    report_orders(report, &format!("orders/{}/{}/{scene_name}", table.name, level.name()), &errors?, &{
                        let [q, v, mu] = expected(&table, level);
                        [q, v, mu, None]
                    });
                }
            }
        }
        Ok(())
    }
}

/// What is compared.
const COMPARED: [&str; 4] = ["q", "v", "mu", "integral"];

/// Observed orders between successive runs; the last is compared, the others inform.
fn report_orders(report: &mut Report, name: &str, errors: &[[f64; 4]], expected: &[Option<f64>; 4]) {
    for (k, compared) in COMPARED.iter().enumerate() {
        for (pair, steps) in errors.windows(2).zip(&STEPS) {
            let order = (pair[0][k] / pair[1][k]).log2();
            let name = format!("{name}/{compared}");
            match expected[k] {
                Some(expected) if *steps == STEPS[STEPS.len() - 2] => report.compare(name, order, expected, TOLERANCE),
                None if *steps == STEPS[STEPS.len() - 2] => report.inform(name, order),
                _ => report.inform(format!("{name}/from-{steps}-steps"), order),
            }
        }
        let finest = errors.last().map_or(f64::NAN, |errors| errors[k]);
        report.inform(format!("{name}/{compared}/error-at-{}-steps", STEPS[STEPS.len() - 1]), finest);
    }
}

/// Errors of q, v and the integral after one second, and of the last stage's multipliers at their own time.
fn errors(
    scene: &dyn AnyScene,
    exact: fn(f64) -> Exact,
    table: &Table,
    level: ConstraintLevel,
    steps: usize,
) -> Result<[f64; 4], String> {
    let words = |error: costate::integrators::RunError| format!("{} at {} level: {error}", table.name, level.name());
    let x: Vec<f64> = scene.design_variables().iter().map(|variable| variable.initial).collect();
    let method = Method::new(table.clone(), level);
    let prepared = Prepared::with(scene, &x, method, Settings::new(1.0, steps)).map_err(words)?;
    let forward = prepared.analysis().forward(&x).map_err(words)?;
    let step = forward.history.steps.last().ok_or("a run without steps")?;
    let stage = &step.stages.last().ok_or("a step without stages")?.solve;
    // the ground's coordinates come first or not at all: compare those that move
    let moving: Vec<usize> = prepared.model().nodes.iter().filter(|n| !n.fixed).flat_map(|n| n.dofs.clone()).collect();
    let end = exact(1.0);
    let multipliers = exact(stage.t).mu;
    let distance = |ours: &[f64], exact: &[f64]| {
        ours.iter().zip(exact).map(|(ours, exact)| (ours - exact) * (ours - exact)).sum::<f64>().sqrt()
    };
    let of_moving = |x: &[f64]| moving.iter().map(|&i| x[i]).collect::<Vec<_>>();
    Ok([
        distance(&of_moving(&step.q), &end.q),
        distance(&of_moving(&step.v), &end.v),
        distance(&stage.unknowns.mu, &multipliers),
        (forward.values[0] - end.integral).abs(),
    ])
}

impl Scene for HeavyTop {
    fn name(&self) -> String {
        "heavy-top".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", Self::MASS, (0.1, 10.0), "kg")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 160)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass] = x else { return Err(format!("1 variable expected, {} given", x.len())) };
        let e = Quaternion(Self::start().0.map(S::from));
        let (arm, omega) = (Vec3::from_f64(Self::ARM), Vec3::from_f64(Self::OMEGA));
        let ground = m.ground();
        let top = m.body("top", e.rotate(arm), e);
        m.set_velocity(top, e.rotate(omega.cross(arm)), e.rotate(omega));
        let [xx, yy, zz] = Self::INERTIA.map(S::from);
        m.rigid_body("top", top, *mass, Vec3::zero(), [xx, yy, zz, S::zero(), S::zero(), S::zero()]);
        m.gravity(Vec3::from_f64(Self::GRAVITY));
        m.spherical("tip", [ground, top], Vec3::zero());
        let vertical = Vec3::from_f64([0.0, 0.0, 1.0]);
        m.position_functional("height, integral", Over::Integral, top, e.rotate(arm), vertical);
        Ok(())
    }
}
