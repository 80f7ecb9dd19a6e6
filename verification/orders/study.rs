//! Observed orders of coordinates, velocities, multipliers and an integral, for every integrator at every constraint level.

mod exact;

use crate::{Report, Study};
use costate::functionals::Over;
use costate::history::{Keep, Watch};
use costate::integrators::{ConstraintLevel, Method, StepRecord, Table, tables};
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{AnyScene, DesignVariable, MechanismBuilder, Prepared, Scene, Settings, built_in};
use costate::sensitivity::Analysis;
use exact::{Exact, HeavyTop};

/// How far an observed order may be from the expected one.
const TOLERANCE: f64 = 0.1;
/// Steps of the runs over one second.
const STEPS: [usize; 7] = [40, 80, 160, 320, 640, 1280, 2560];

/// Expected orders of q, v, mu and the integral.
type Orders4 = [f64; 4];
/// No clean order: the error passes through zero, or the order still changes at these steps.
const OPEN: f64 = f64::NAN;
/// Orders of one integrator at the position and the acceleration level.
type Row = (&'static str, [Orders4; 2]);

/// On the pendulum released from rest, from h = 1/160 to 1/320: the table of the design.
const FROM_REST: [Row; 14] = [
    ("midpoint", [[2.0, 2.0, 1.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("dirk2", [[2.2, 1.0, 0.0, OPEN], [3.0, 3.0, 2.0, 3.0]]),
    ("dirk3", [[1.9, 1.0, 0.0, 2.0], [OPEN, 4.2, 2.0, OPEN]]),
    ("sdirk2", [[1.0, 1.0, 0.0, 1.0], [2.0, 2.0, 2.0, 2.0]]),
    ("sdirk3", [[1.0, 1.0, 0.0, 1.0], [3.0, 3.0, 3.0, 3.0]]),
    ("sdirk4", [[1.0, 1.0, 0.0, 1.0], [4.0, 4.0, 4.0, 4.0]]),
    ("esdirk3", [[2.0, 2.0, 1.0, 2.0], [3.0, 3.0, 3.0, 3.0]]),
    ("esdirk4", [[OPEN, 2.0, OPEN, OPEN], [4.0, 4.0, 4.0, 4.0]]),
    ("esdirk5", [[2.0, 2.0, 1.0, 2.0], [5.0, 5.0, 5.0, 5.0]]),
    ("newmark", [[2.0, 2.0, 2.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("generalized-alpha", [[2.0, 2.0, 2.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("bdf1", [[1.0, 0.9, 1.0, 1.0], [1.0, 0.95, 1.1, 1.0]]),
    ("bdf2", [[2.0, 2.0, 2.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("bdf3", [[3.0, 3.0, 2.9, 3.0], [3.0, 3.0, 2.5, 3.0]]),
];

/// For any consistent start, with steps fine enough: whole numbers, and the implicit midpoint rule at its worst.
const EVENTUALLY: [Row; 14] = [
    ("midpoint", [[2.0, 0.0, -1.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("dirk2", [[2.0, 1.0, 0.0, 2.0], [3.0, 3.0, 2.0, 3.0]]),
    ("dirk3", [[2.0, 1.0, 0.0, 2.0], [4.0, 4.0, 2.0, OPEN]]),
    ("sdirk2", [[1.0, 1.0, 0.0, 1.0], [2.0, 2.0, 2.0, 2.0]]),
    ("sdirk3", [[1.0, 1.0, 0.0, 1.0], [3.0, 3.0, 3.0, 3.0]]),
    ("sdirk4", [[1.0, 1.0, 0.0, 1.0], [4.0, 4.0, 4.0, 4.0]]),
    ("esdirk3", [[2.0, 2.0, 1.0, 2.0], [3.0, 3.0, 3.0, 3.0]]),
    ("esdirk4", [[2.0, 2.0, 1.0, 2.0], [4.0, 4.0, 4.0, 4.0]]),
    ("esdirk5", [[2.0, 2.0, 1.0, 2.0], [5.0, 5.0, 5.0, 5.0]]),
    ("newmark", [[2.0, 2.0, 0.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("generalized-alpha", [[2.0, 2.0, 2.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("bdf1", [[1.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0]]),
    ("bdf2", [[2.0, 2.0, 2.0, 2.0], [2.0, 2.0, 2.0, 2.0]]),
    ("bdf3", [[3.0, 3.0, 3.0, 3.0], [3.0, 3.0, 3.0, 3.0]]),
];

/// Entries of the second table that one scene cannot show: scene, table, level, what.
const HIDDEN: [(&str, &str, ConstraintLevel, &str); 5] = [
    // these errors pass through zero
    ("moving-pendulum", "dirk2", ConstraintLevel::Position, "q"),
    ("moving-pendulum", "dirk3", ConstraintLevel::Acceleration, "q"),
    ("moving-pendulum", "dirk3", ConstraintLevel::Acceleration, "v"),
    ("heavy-top", "midpoint", ConstraintLevel::Acceleration, "integral"),
    ("moving-pendulum", "esdirk4", ConstraintLevel::Position, "integral"),
];

/// A motion with its exact solution.
struct Problem {
    name: &'static str,
    scene: &'static dyn AnyScene,
    exact: fn(f64) -> Exact,
    expected: &'static [Row],
}

fn problems() -> Result<[Problem; 3], String> {
    let pendulum = built_in::named("pendulum")?;
    Ok([
        Problem { name: "pendulum", scene: pendulum, exact: exact::pendulum, expected: &FROM_REST },
        Problem { name: "moving-pendulum", scene: &MovingPendulum, exact: exact::moving_pendulum, expected: &EVENTUALLY },
        Problem { name: "heavy-top", scene: &HeavyTop, exact: HeavyTop::at, expected: &EVENTUALLY },
    ])
}

impl Problem {
    /// The expectation for one observed order; a new integrator is held to its own order at acceleration level.
    fn expected(&self, table: &Table, level: ConstraintLevel, compared: usize) -> Option<f64> {
        let hidden = |(scene, name, own, what): &(&str, &str, ConstraintLevel, &str)| {
            *scene == self.name && *name == table.name && *own == level && *what == COMPARED[compared]
        };
        if HIDDEN.iter().any(hidden) {
            return None;
        }
        let place = ConstraintLevel::ALL.iter().position(|own| *own == level)?;
        match self.expected.iter().find(|(name, _)| *name == table.name) {
            Some((_, levels)) => Some(levels[place][compared]).filter(|order| order.is_finite()),
            None => (level == ConstraintLevel::Acceleration && compared < 2).then_some(table.order as f64),
        }
    }

    /// Index of the coarser run of the pair that is held to the expectation.
    fn pair(&self, table: &Table, level: ConstraintLevel) -> usize {
        match (self.name, level) {
            ("pendulum", _) => 2,
            // its terms of low order are so small that they take over late
            (_, ConstraintLevel::Position) if table.name == "esdirk4" => 5,
            (_, ConstraintLevel::Acceleration) if table.order >= 5 => 2,
            // at order 4 the finest run has reached round-off
            (_, ConstraintLevel::Acceleration) if table.order >= 4 => 3,
            _ => 4,
        }
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
        let miss = |t: f64| {
            let (closed, q) = (exact::pendulum_angle(t), exact::pendulum(t).q);
            (-closed.sin() - q[0]).abs().max((-closed.cos() - q[1]).abs())
        };
        let worst = [0.2, 0.5, 0.8, 1.0].into_iter().map(miss).fold(0.0, f64::max);
        report.at_most("reference/pendulum-against-elliptic-function", worst, 1e-14);
        for table in tables() {
            for level in ConstraintLevel::ALL {
                for problem in &problems()? {
                    let pair = problem.pair(&table, level);
                    let runs: Result<Vec<_>, String> =
                        STEPS[..pair + 2].iter().map(|&steps| errors(problem, &table, level, steps)).collect();
                    report_orders(report, problem, &table, level, &runs?);
                }
            }
        }
        Ok(())
    }
}

/// What is compared.
const COMPARED: [&str; 4] = ["q", "v", "mu", "integral"];

/// Observed orders between successive runs; that of the last pair is compared, the others inform.
fn report_orders(report: &mut Report, problem: &Problem, table: &Table, level: ConstraintLevel, errors: &[[f64; 4]]) {
    for (k, compared) in COMPARED.iter().enumerate() {
        let name = format!("orders/{}/{}/{}/{compared}", table.name, level.name(), problem.name);
        for (place, pair) in errors.windows(2).enumerate() {
            let order = (pair[0][k] / pair[1][k]).log2();
            if place + 2 < errors.len() {
                report.inform(format!("{name}/from-{}-steps", STEPS[place]), order);
            } else if let Some(expected) = problem.expected(table, level, k) {
                report.compare(&name, order, expected, TOLERANCE);
            } else {
                report.inform(&name, order);
            }
        }
    }
}

/// Errors of q, v and the integral after one second, and of the last stage's multipliers at their own time.
fn errors(problem: &Problem, table: &Table, level: ConstraintLevel, steps: usize) -> Result<[f64; 4], String> {
    let (scene, exact) = (problem.scene, problem.exact);
    let words = |error: costate::integrators::RunError| format!("{} at {} level: {error}", table.name, level.name());
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let method = Method::new(table.clone(), level);
    let prepared = Prepared::with(scene, &x, method, Settings::new(1.0, steps)).map_err(words)?;
    let mut last = None;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        last = Some(step.clone());
        true
    });
    let analysis = Analysis { keep: &Keep::Nothing, ..prepared.analysis() };
    let (forward, stopped) = analysis.observed(&x, &mut watch).map_err(words)?;
    stopped.map_or(Ok(()), Err).map_err(words)?;
    let step = last.ok_or("a run without steps")?;
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

/// The pendulum of the built-in scene, taken over 0.3 s after its release, so that it starts with a velocity.
struct MovingPendulum;

impl Scene for MovingPendulum {
    fn name(&self) -> String {
        "moving-pendulum".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 1.0, (0.1, 10.0), "kg")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 160)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass] = x else { return Err(format!("1 variable expected, {} given", x.len())) };
        let start = exact::pendulum(exact::TAKEN_OVER);
        let vector = |x: &[f64]| Vector3::<S>::from_f64([x[0], x[1], x[2]]);
        let ground = m.ground();
        let bob = m.point("bob", vector(&start.q));
        m.set_velocity(bob, vector(&start.v), Vector3::zeros());
        m.point_mass("bob", bob, *mass);
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
        m.distance("rod", [ground, bob], [Vector3::zeros(), vector(&start.q)]);
        m.position_functional("height, integral", Over::Integral, bob, vector(&start.q), Vector3::from_f64([0.0, 1.0, 0.0]));
        Ok(())
    }
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
        let (arm, omega) = (Vector3::from_f64(Self::ARM), Vector3::from_f64(Self::OMEGA));
        let ground = m.ground();
        let top = m.body("top", e.rotate(arm), e);
        m.set_velocity(top, e.rotate(omega.cross(&arm)), e.rotate(omega));
        let [xx, yy, zz] = Self::INERTIA.map(S::from);
        m.rigid_body("top", top, *mass, Vector3::zeros(), [xx, yy, zz, S::zero(), S::zero(), S::zero()]);
        m.gravity(Vector3::from_f64(Self::GRAVITY));
        m.spherical("tip", [ground, top], Vector3::zeros());
        let vertical = Vector3::from_f64([0.0, 0.0, 1.0]);
        m.position_functional("height, integral", Over::Integral, top, e.rotate(arm), vertical);
        Ok(())
    }
}
