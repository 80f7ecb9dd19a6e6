//! Which table makes a step, steps chosen by their error, and the motion between steps.

use costate::functionals::{Aggregate, AggregateKind, Times};
use costate::history::{Keep, Watch};
use costate::integrators::{
    ConstraintLevel, Method, NewtonTolerance, Scheme, StepControl, StepRecord, Table, TimeGrid, tables,
};
use costate::internals::{QuadratureWeights, march, table_named};
use costate::prelude::*;
use costate::scenes::{AnyScene, built_in};
use costate::sensitivity::{Analysis, Forward};
use std::hash::{Hash, Hasher};

/// R = a + stiffness q - load, the load jumping from 0 to 1 at a time; nothing is defined for |q| beyond `wall`.
struct Oscillator {
    jump: Option<f64>,
    ledge: Option<f64>,
    wall: f64,
}

impl Hash for Oscillator {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let Oscillator { jump, ledge, wall } = self;
        [*jump, *ledge, Some(*wall)].map(|own| own.map(f64::to_bits)).hash(state);
    }
}

impl Element for Oscillator {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("stiffness", "N/m")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        let from =
            |switch: Option<f64>, on: S| switch.map_or(S::zero(), |at| on.less(S::from(at)).select(S::zero(), S::one()));
        let load = from(self.jump, t) + from(self.ledge.map(|ledge| -ledge), -s.q[0]);
        let inside = S::from(self.wall).less(s.q[0].abs()).select(S::from(f64::NAN), S::one());
        r[0] += (s.a[0] + p[0] * s.q[0] - load) * inside;
    }
}

/// Start at rest at 1.
struct Swinging {
    jump: Option<f64>,
    /// Place below which the load jumps.
    ledge: Option<f64>,
    wall: f64,
    stiffness: f64,
}

impl Default for Swinging {
    fn default() -> Self {
        Swinging { jump: None, ledge: None, wall: f64::INFINITY, stiffness: 4.0 }
    }
}

impl Scene for Swinging {
    fn name(&self) -> String {
        "swinging".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("stiffness", self.stiffness, (-1e13, 1e13), "N/m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(2.0, 20)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = m.coordinates("swing", &[S::one()], &[S::zero()]);
        m.element("swing", &[node], Oscillator { jump: self.jump, ledge: self.ledge, wall: self.wall }, x);
        m.coordinate_functional("end", Over::Terminal, node, 0);
        m.coordinate_functional("integral", Over::Integral, node, 0);
        m.coordinate_functional("largest", Over::smooth_maximum(3.0), node, 0);
        Ok(())
    }
}

/// The same, with all aggregates so sharp that one sample alone counts.
struct SharplySwinging;

impl Scene for SharplySwinging {
    fn name(&self) -> String {
        "sharply swinging".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Scene::variables(&Swinging::default())
    }
    fn settings(&self) -> Settings {
        Settings::new(2.0, 20)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = m.coordinates("swing", &[S::one()], &[S::zero()]);
        m.element("swing", &[node], Oscillator { jump: Some(1.03), ledge: None, wall: f64::INFINITY }, x);
        for kind in Aggregate::KINDS {
            m.coordinate_functional(&format!("{kind:?}"), Aggregate::new(kind, 1e5).at(Times::Run), node, 0);
        }
        Ok(())
    }
}

fn named(name: &str) -> Table {
    table_named(name).expect("sound").expect("listed")
}

fn prepared<'s>(scene: &'s dyn AnyScene, table: &str, settings: Settings) -> Result<Prepared<'s>, RunError> {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    // its jumps and walls are those of steps that do not know of them
    let method = Method { locates: false, ..Method::new(named(table), ConstraintLevel::Acceleration) };
    Prepared::with(scene, &x, method, settings)
}

fn chosen(scene: &Swinging, table: &str, control: StepControl) -> Forward {
    let prepared = prepared(scene, table, Scene::settings(scene).choosing_steps(control)).expect("sound");
    prepared.analysis().forward(&prepared.x).expect("runs")
}

/// All steps of a run over given steps.
fn steps_over(prepared: &Prepared, grid: &TimeGrid) -> Vec<StepRecord<f64>> {
    let mut steps = Vec::new();
    let mut keep = Watch(|step: &StepRecord<f64>| {
        steps.push(step.clone());
        true
    });
    march(&prepared.problem(), &prepared.method, grid, &prepared.plan, &mut keep).expect("runs");
    steps
}

#[test]
fn several_steps_of_one_size_without_a_breakpoint_lie_behind_a_multistep_step() {
    let grid = TimeGrid::uniform(1.0, 10, &[0.35, 0.7]).unwrap();
    // four steps up to .35, four up to .7, three up to 1: a breakpoint may be where the oldest state lies
    let made = |table: &str| -> String {
        let table = named(table);
        let letter = |index| if table.scheme_at(&grid, index) == Scheme::Main { 'm' } else { 's' };
        (0..grid.steps()).map(letter).collect()
    };
    assert_eq!(made("esdirk3"), "mmmmmmmmmmm");
    assert_eq!(made("bdf1"), "mmmmmmmmmmm");
    assert_eq!(made("bdf2"), "smmmsmmmsmm");
    assert_eq!(made("bdf3"), "ssmmssmmssm");
}

#[test]
fn weights_of_an_integral_are_exact_for_the_powers_below_the_order() {
    for table in tables() {
        let scene = Swinging { jump: Some(1.03), ..Swinging::default() };
        let prepared = prepared(&scene, &table.name, Scene::settings(&scene)).expect("sound");
        let steps = steps_over(&prepared, &prepared.grid);
        let mut from_the_end = QuadratureWeights::at_end(&table);
        let mut weights: Vec<Vec<_>> = steps.iter().rev().map(|step| from_the_end.back_through(step)).collect();
        weights.reverse();
        let weights = weights.concat();
        let [integral, aggregate]: [Vec<f64>; 2] = [
            weights.iter().map(|weight| weight.integral).collect(),
            weights.iter().map(|weight| weight.aggregate).collect(),
        ];
        assert!(aggregate.iter().all(|&weight| weight >= 0.0), "{}: {aggregate:?}", table.name);
        // three stages with a weight that is not negative are too few for order 3: straight lines are always exact
        let aggregates = (0..table.order.min(2) as i32).map(|power| (power, &aggregate));
        for (power, weights) in (0..table.order as i32).map(|power| (power, &integral)).chain(aggregates) {
            let times = steps.iter().map(|step| step.stages.iter().map(|stage| stage.solve.t));
            let terms = times.flatten().zip(weights).map(|(t, weight)| weight * t.powi(power));
            let (sum, exact) = (terms.sum::<f64>(), 2f64.powi(power + 1) / f64::from(power + 1));
            assert!((sum - exact).abs() < 1e-12, "{}: integral of t^{power} is {sum}, not {exact}", table.name);
        }
    }
}

/// The sample that counts may be one whose weight in an integral is negative, or none.
#[test]
fn aggregates_of_any_sharpness_are_numbers_near_the_largest_value() {
    for table in tables() {
        let prepared = prepared(&SharplySwinging, &table.name, Scene::settings(&SharplySwinging)).expect("sound");
        let forward = prepared.analysis().forward(&prepared.x).expect("runs");
        for ((kind, value), extremes) in Aggregate::KINDS.iter().zip(&forward.values).zip(&forward.extremes) {
            let largest = extremes.as_ref().expect("of an aggregate").largest.value;
            let squared = matches!(kind, AggregateKind::SquaredExponential | AggregateKind::SquaredPower);
            let largest = if squared { largest * largest } else { largest };
            assert!((value - largest).abs() < 1e-3, "{}, {kind:?}: {value}, of values up to {largest}", table.name);
        }
    }
}

/// Values follow the table's recursion while the run goes on; gradients go back through its transpose.
#[test]
fn values_summed_on_the_way_and_weights_handed_out_from_the_end_agree() {
    for table in tables() {
        let scene = Swinging { jump: Some(1.03), ..Swinging::default() };
        let prepared = prepared(&scene, &table.name, Scene::settings(&scene)).expect("sound");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).expect("runs");
        let steps = steps_over(&prepared, &prepared.grid);
        let mut from_the_end = QuadratureWeights::at_end(&table);
        let (mut integral, mut largest) = (0.0, 0.0);
        for step in steps.iter().rev() {
            for (stage, weight) in step.stages.iter().zip(from_the_end.back_through(step)) {
                let q = stage.solve.point().q[0];
                integral += weight.integral * q;
                largest += weight.aggregate * (3.0 * q).exp();
            }
        }
        let expected = [integral, (largest / 2.0).ln() / 3.0];
        for (value, expected) in forward.values[1..].iter().zip(expected) {
            assert!((value - expected).abs() < 1e-13, "{}: {value} {expected}", table.name);
        }
        let adjoint = analysis.adjoint(&prepared.x, &forward).expect("has a gradient");
        let complex = analysis.complex_step(&prepared.x, &forward).expect("runs");
        for (complex, adjoint) in complex.rows.iter().zip(&adjoint.rows) {
            assert!(largest_difference(complex, adjoint) < 1e-12, "{}: {complex:?} {adjoint:?}", table.name);
        }
    }
}

/// After many steps far above the period, a step multiplies the motion by the spectral radius at infinity.
#[test]
fn generalized_alpha_damps_high_frequencies_by_its_spectral_radius() {
    for (name, radius) in [("generalized-alpha", 0.8), ("generalized-alpha:0.6", 0.6), ("generalized-alpha:0.3", 0.3)] {
        let scene = Swinging { stiffness: 1e12, ..Swinging::default() };
        let prepared = prepared(&scene, name, Settings::new(60.0, 60)).expect("sound");
        let steps = steps_over(&prepared, &prepared.grid);
        let size = |index: usize| steps[index].q[0].abs();
        // a triple root: the sizes fall like n^2 radius^n
        let observed = (size(59) / 3600.0 / (size(29) / 900.0)).powf(1.0 / 30.0);
        assert!((observed - radius).abs() < 0.02 * radius, "{name}: {observed}");
    }
    assert!(table_named("generalized-alpha:1.2").unwrap_err().contains("from 0 to 1"));
    assert_eq!(table_named("generalized"), Ok(None));
}

#[test]
fn the_error_follows_the_tolerance() {
    for table in ["sdirk4", "esdirk3", "esdirk4", "esdirk5"] {
        let mut errors = Vec::new();
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let forward = chosen(&Swinging::default(), table, StepControl::new(tolerance));
            let error = (forward.values[0] - 4f64.cos()).abs();
            assert!(error < 20.0 * tolerance, "{table}: {error:e} at {tolerance:e}");
            errors.push((error, forward.grid.steps()));
        }
        assert!(errors.windows(2).all(|pair| pair[1].0 < 0.2 * pair[0].0 && pair[1].1 > pair[0].1), "{table}: {errors:?}");
    }
}

#[test]
fn equal_steps_say_what_error_chosen_ones_would_have_been_held_to() {
    for table in ["sdirk4", "esdirk3", "esdirk4", "esdirk5"] {
        let scene = Swinging::default();
        let tolerance = 1e-4;
        let chosen = chosen(&scene, table, StepControl::new(tolerance));
        let prepared = prepared(&scene, table, Scene::settings(&scene)).expect("sound");
        let error = |forward: &costate::sensitivity::Forward| forward.error.expect("estimated");
        let same = prepared.analysis().on_steps_of(&chosen).forward(&prepared.x).expect("runs");
        // allowed was the tolerance of 1 and the size; what is said is a share of the largest size, of about 1
        let share = error(&same).share;
        assert!(share < 2.0 * tolerance && share > 0.01 * tolerance, "{table}: {share:e}");
        // of half the size: by the order of the embedded solution, and one
        // what lies below round-off is not said
        let steps = if table == "esdirk5" { 80 } else { 160 };
        let [whole, halved] = [steps, 2 * steps].map(|steps| TimeGrid::uniform(2.0, steps, &[]).expect("steps"));
        let [whole, halved] = [whole, halved].map(|grid| {
            let prepared = Prepared { grid, ..self::prepared(&scene, table, Scene::settings(&scene)).expect("sound") };
            error(&prepared.analysis().forward(&prepared.x).expect("runs")).share
        });
        // the first step of one with an explicit stage is estimated without it, to third order at most
        let embedded = f64::from(named(table).embedded.expect("has one").order as u32);
        let order = if table.starts_with('e') { embedded.min(3.0) } else { embedded } + 1.0;
        let observed = (whole / halved).log2();
        assert!((observed - order).abs() < 0.1, "{table}: {observed} for {order}");
    }
}

#[test]
fn equal_steps_without_an_embedded_solution_say_the_error_of_the_trapezoidal_rule() {
    for table in ["midpoint", "newmark", "generalized-alpha", "bdf2", "bdf3"] {
        let scene = Swinging::default();
        let share = |steps: usize| {
            let grid = TimeGrid::uniform(2.0, steps, &[]).expect("steps");
            let prepared = Prepared { grid, ..prepared(&scene, table, Scene::settings(&scene)).expect("sound") };
            let forward = prepared.analysis().forward(&prepared.x).expect("runs");
            forward.error.expect("estimated").share
        };
        let (whole, halved) = (share(320), share(640));
        let observed = (whole / halved).log2();
        assert!((observed - 3.0).abs() < 0.1, "{table}: {whole:e} and {halved:e}, order {observed}");
    }
}

#[test]
fn chosen_steps_end_at_breakpoints_stay_below_the_longest_and_are_taken_again_by_other_runs() {
    let scene = Swinging { jump: Some(0.77), ..Swinging::default() };
    let control = StepControl { longest: 0.13, ..StepControl::new(1e-5) };
    let prepared = prepared(&scene, "esdirk4", Scene::settings(&scene).choosing_steps(control)).expect("sound");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("runs");
    let breakpoint = forward.grid.times.iter().position(|&t| t == 0.77).expect("a step ends at the breakpoint");
    assert!(forward.grid.breakpoints.contains_key(&breakpoint) && forward.grid.breakpoints.len() == 1);
    let steps = steps_over(&prepared, &forward.grid);
    assert!(steps[breakpoint].restart.is_some());
    let longest = steps.iter().fold(0.0, |most: f64, step| most.max(step.h));
    assert!(longest <= 0.13 + 1e-15 && longest > 0.1, "{longest}");
    assert_eq!(forward.grid.times.last(), Some(&2.0));

    let again = analysis.on_steps_of(&forward).forward(&prepared.x).expect("runs");
    assert_eq!((again.history.steps(), again.rejected), (forward.history.steps(), 0));
    assert_eq!(again.values[0].to_bits(), forward.values[0].to_bits());
    let adjoint = analysis.adjoint(&prepared.x, &forward).expect("has a gradient");
    let complex = analysis.complex_step(&prepared.x, &forward).expect("runs");
    let tangent = analysis.tangent(&prepared.x, &forward).expect("runs");
    assert!(largest_difference(&complex.rows[0], &adjoint.rows[0]) < 1e-13);
    assert!(largest_difference(&complex.rows[0], &tangent.rows[0]) < 1e-13);
}

#[test]
fn steps_that_cannot_be_solved_are_halved_and_counted() {
    // the motion stays within 1, but the first guess of a long step does not stay within the wall
    let loose = StepControl::new(1e3);
    let scene = |wall| Swinging { wall, stiffness: 100.0, ..Swinging::default() };
    let free = chosen(&scene(f64::INFINITY), "esdirk3", loose);
    assert_eq!(free.rejected, 0);
    let walled = chosen(&scene(1.3), "esdirk3", loose);
    assert!(
        walled.rejected > 0 && walled.grid.steps() > free.grid.steps(),
        "{} of {}",
        walled.rejected,
        walled.grid.steps()
    );

    // this one runs into the wall, where no step is short enough
    let scene = Swinging { wall: 1.5, stiffness: -30.0, ..Swinging::default() };
    let prepared = prepared(&scene, "esdirk3", Scene::settings(&scene).choosing_steps(loose)).expect("sound");
    let error = prepared.analysis().forward(&prepared.x).map(|forward| forward.rejected).expect_err("a wall");
    assert!(error.to_string().contains("of its formula is"), "{error}");
}

#[test]
fn a_jump_that_no_step_resolves_ends_the_run_with_its_time() {
    let scene = Swinging { ledge: Some(0.03), ..Swinging::default() };
    // across the jump a step's error is about the step times 1 m/s2
    let fine = StepControl::new(1e-14);
    let prepared = prepared(&scene, "esdirk5", Settings::new(1e3, 1).choosing_steps(fine)).expect("sound");
    let error = prepared.analysis().forward(&prepared.x).map(|forward| forward.rejected).expect_err("a jump");
    let message = error.to_string();
    assert!(message.contains("t = 0.7") && message.contains("larger tolerance"), "{message}");
}

#[test]
fn a_method_without_an_error_estimate_refuses_to_choose_steps() {
    for table in tables().into_iter().filter(|table| table.embedded.is_none()) {
        let scene = Swinging::default();
        let refused = prepared(&scene, &table.name, Scene::settings(&scene).choosing_steps(StepControl::new(1e-6)));
        let message = refused.err().expect("refused").to_string();
        assert!(message.contains(&table.name) && message.contains("esdirk5"), "{message}");
    }
    let scene = Swinging::default();
    for control in
        [StepControl::new(0.0), StepControl::new(f64::NAN), StepControl { longest: 0.0, ..StepControl::new(1e-6) }]
    {
        assert!(prepared(&scene, "esdirk3", Scene::settings(&scene).choosing_steps(control)).is_err(), "{control:?}");
    }
}

/// Largest errors of q, v and a at 201 times, on steps that do not meet them.
fn errors_between_steps(table: &str, steps: usize) -> [f64; 3] {
    let scene = Swinging::default();
    let prepared = prepared(&scene, table, Settings::new(2.0, steps)).expect("sound");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("runs");
    let times: Vec<f64> = (0..=200).map(|i| 0.01 * f64::from(i)).collect();
    let mut errors = [0.0f64; 3];
    for (t, moment) in times.iter().zip(analysis.motion(&forward, &times).expect("within the run")) {
        assert_eq!(moment.t, *t);
        let exact = [(2.0 * t).cos(), -2.0 * (2.0 * t).sin(), -4.0 * (2.0 * t).cos()];
        for (error, (found, exact)) in errors.iter_mut().zip([moment.q[0], moment.v[0], moment.a[0]].iter().zip(exact)) {
            *error = error.max((found - exact).abs());
        }
    }
    for wrong in [&[-1e-9][..], &[2.1], &[f64::NAN], &[1.0, 0.5]] {
        assert!(analysis.motion(&forward, wrong).is_err(), "{wrong:?}");
    }
    errors
}

#[test]
fn the_motion_between_steps_is_the_same_wherever_they_are_kept() {
    let scene = Swinging { jump: Some(0.77), ..Swinging::default() };
    let times: Vec<f64> = (0..40).map(|i| 0.05 * f64::from(i)).collect();
    let mut motions = Vec::new();
    for keep in [Keep::Memory, Keep::Checkpoints(7000)] {
        let mut prepared = prepared(&scene, "bdf3", Scene::settings(&scene)).expect("sound");
        prepared.keep = keep;
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).expect("runs");
        motions.push(analysis.motion(&forward, &times).expect("kept"));
        assert_eq!(forward.history.usage().recomputed > 0, motions.len() == 2);
    }
    assert_eq!(motions[0], motions[1]);
}

#[test]
fn the_motion_between_steps_has_its_orders() {
    // midpoint: q and v of a step fit each other to h^3, and the second derivative divides that by h^2
    for (table, orders) in [("esdirk5", [5.0, 5.0, 4.0]), ("midpoint", [2.0, 2.0, 1.0])] {
        let (coarse, fine) = (errors_between_steps(table, 37), errors_between_steps(table, 74));
        for k in 0..3 {
            let order = (coarse[k] / fine[k]).log2();
            assert!((order - orders[k]).abs() < 0.3, "{table}, derivative {k}: {order}");
        }
    }
}

/// A run whose Newton's method stops by a rule.
fn by_rule(scene: &dyn AnyScene, table: &str, rule: NewtonTolerance, settings: Settings) -> Forward {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let method = Method { tolerance: rule, ..Method::new(named(table), ConstraintLevel::Acceleration) };
    Prepared::with(scene, &x, method, settings.without_method()).unwrap().analysis().forward(&x).unwrap()
}

#[test]
fn phases_are_measured_by_the_method_that_asks_for_it_and_by_no_other() {
    let own = Prepared::new(built_in::named("five-bar").unwrap()).unwrap();
    let method = Method { measures_phases: true, ..own.analysis().method.clone() };
    let (plain, measuring) = (own.analysis(), Analysis { method: &method, ..own.analysis() });
    let (first, second) = (plain.forward(&own.x).unwrap(), measuring.forward(&own.x).unwrap());
    assert_eq!(first.counters.nanoseconds, None);
    assert!(second.counters.nanoseconds.unwrap().iter().all(|&phase| phase > 0), "{:?}", second.counters);
    // the forward run of one is the other's, too, and the numbers are the same
    let (measured, gradient) = (measuring.adjoint(&own.x, &first).unwrap(), plain.adjoint(&own.x, &second).unwrap());
    assert_eq!(measured.rows, gradient.rows);
    assert_eq!(gradient.counters.nanoseconds, None);
    let [_, matrices, factorizations, solutions] = measured.counters.nanoseconds.unwrap();
    assert!(matrices.min(factorizations).min(solutions) > 0, "{:?}", measured.counters);
}

#[test]
fn the_scaled_rule_saves_corrections_and_changes_less_than_the_error_of_the_steps() {
    for (name, table, steps, end, corrections) in [
        ("five-bar", "esdirk4", 100, 1.0, 0.96),
        ("five-bar", "generalized-alpha", 400, 1.0, 1.0),
        ("chain-common", "esdirk4", 20, 0.02, 0.7),
        ("flexible-four-bar", "bdf2", 100, 1.0, 0.94),
        ("double-pendulum", "variational", 400, 1.0, 0.7),
    ] {
        let scene = built_in::named(name).unwrap();
        let run = |rule, steps| by_rule(scene, table, rule, Settings { steps, end, ..scene.settings() });
        let (exact, scaled) = (run(NewtonTolerance::RoundOff, steps), run(NewtonTolerance::Scaled, steps));
        let finer = run(NewtonTolerance::RoundOff, 2 * steps);
        let by_exact = scaled.counters.iterations as f64 / exact.counters.iterations as f64;
        assert!(by_exact < corrections, "{name} {table}: {by_exact}");
        let away = |other: &Forward| {
            let shares = exact.values.iter().zip(&other.values).map(|(own, other)| ((other - own) / own).abs());
            shares.fold(0.0, f64::max)
        };
        let (left, error) = (away(&scaled), away(&finer));
        assert!(left > 0.0 && left <= 0.05 * error, "{name} {table}: {left:e} of {error:e}");
    }
}

#[test]
fn the_scaled_rule_follows_the_tolerance_of_chosen_steps() {
    let scene = built_in::named("five-bar").unwrap();
    for tolerance in [1e-5, 1e-7, 1e-9] {
        let settings = || Settings { control: Some(StepControl::new(tolerance)), end: 1.0, ..scene.settings() };
        let [exact, scaled] =
            [NewtonTolerance::RoundOff, NewtonTolerance::Scaled].map(|rule| by_rule(scene, "esdirk4", rule, settings()));
        assert!(scaled.counters.iterations < exact.counters.iterations);
        let left = (scaled.values[0] - exact.values[0]).abs();
        assert!(left <= tolerance * exact.values[0].abs(), "{left:e} at {tolerance:e}");
    }
}

#[test]
fn a_run_by_the_scaled_rule_is_taken_again_bit_by_bit_and_has_no_derivative() {
    let scene = built_in::named("five-bar").unwrap();
    for table in ["esdirk4", "generalized-alpha", "bdf2"] {
        let settings = Settings {
            newton: NewtonTolerance::Scaled,
            method: Some(table.into()),
            end: 0.3,
            steps: 60,
            ..scene.settings()
        };
        let motion = |keep: Keep| {
            let mut prepared = Prepared::with(
                scene,
                &Prepared::new(scene).unwrap().x,
                Prepared::method_of(&settings).unwrap(),
                settings.clone(),
            )
            .unwrap();
            prepared.keep = keep;
            let forward = prepared.analysis().forward(&prepared.x).unwrap();
            let refused = prepared.analysis().adjoint(&prepared.x, &forward).unwrap_err().to_string();
            assert!(refused.contains("scaled") && refused.contains("round-off"), "{refused}");
            assert!(prepared.analysis().tangent(&prepared.x, &forward).is_err());
            let times: Vec<f64> = (1..60).map(|step| 5e-3 * f64::from(step)).collect();
            prepared.analysis().motion(&forward, &times).unwrap().into_iter().map(|moment| moment.q).collect::<Vec<_>>()
        };
        assert_eq!(motion(Keep::Memory), motion(Keep::Checkpoints(60_000)), "{table}");
    }
}
