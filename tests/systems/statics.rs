//! Equilibria: load steps, their gradients, what a user may get wrong.

use costate::elements::flexible::{CableSection, Section};
use costate::elements::forces::LoadFrame;
use costate::functionals::{LoadKind, Quantity};
use costate::history::Keep;
use costate::integrators::{ArcLength, PathEnd, PathPoint, STATIC_TABLE, StepControl};
use costate::internals::{AppliedForce, table_named};
use costate::prelude::*;
use costate::scenes::{AnyScene, BeamLine, CableLine, NodeId};

fn vector(x: f64, y: f64, z: f64) -> [f64; 3] {
    [x, y, z]
}

/// A force along a world direction that grows with the load factor: `size` at 1.
fn ramped_force<S: Scalar>(
    m: &mut MechanismBuilder<S>,
    name: &str,
    (node, on): (NodeId, NodeKind),
    (direction, point): ([f64; 3], Vector3<S>),
    frame: LoadFrame,
    size: S,
) {
    let local = m.local_point(node, point);
    let p = [&direction.map(S::from)[..], &local.components(), &[S::zero(), size]].concat();
    m.element(name, &[node], AppliedForce { on, frame, size: TimeFunction::ConstantRate }, &p);
}

/// Shallow von Mises truss: two line springs from (-b, 0, 0) and (b, 0, 0) to a mass at (0, 0, rise), guided along z.
struct Truss {
    settings: Settings,
    load: f64,
}

const HALF_SPAN: f64 = 1.0;
const RISE: f64 = 0.2;
const STIFFNESS: f64 = 1000.0;

impl Scene for Truss {
    fn name(&self) -> String {
        "truss".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("stiffness", STIFFNESS, (1.0, 1e6), "N/m"),
            DesignVariable::new("rest length", HALF_SPAN.hypot(RISE), (0.1, 10.0), "m"),
            DesignVariable::new("half span", HALF_SPAN, (0.1, 10.0), "m"),
            DesignVariable::new("mass", 0.1, (0.0, 100.0), "kg"),
            DesignVariable::new("load", self.load, (-1e3, 1e3), "N"),
        ]
    }
    fn settings(&self) -> Settings {
        self.settings.clone()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [stiffness, rest, half, mass, load] = x else { return Err("5 variables".into()) };
        let ground = m.ground();
        let place = Vector3::from_f64([0.0, 0.0, RISE]);
        let apex = m.point("apex", place);
        m.point_mass("apex", apex, *mass);
        m.gravity(Vector3::from_f64([0.0, 0.0, -GRAVITY]));
        for (name, side) in [("left", -1.0), ("right", 1.0)] {
            let foot = Vector3::new(*half * side, S::zero(), S::zero());
            m.line_spring(name, [ground, apex], [foot, place], *stiffness, *rest);
            m.line_damper(&format!("{name} damper"), [ground, apex], [foot, place], S::from(7.0));
        }
        let guide = m.point_on_line("guide", [ground, apex], place, Vector3::from_f64([0.0, 0.0, 1.0]));
        ramped_force(m, "load", (apex, NodeKind::Point), (vector(0.0, 0.0, -1.0), place), LoadFrame::World, *load);
        let up = Vector3::from_f64([0.0, 0.0, 1.0]);
        m.position_functional("height", Over::Terminal, apex, place, up);
        m.position_functional("height at the start", Over::Initial, apex, place, up);
        m.position_functional("integral of the height", Over::Integral, apex, place, up);
        let over = Over::smooth_maximum(20.0);
        m.position_functional("largest height", over, apex, place, up);
        m.velocity_functional("speed", Over::Terminal, apex, place, up);
        m.functional("acceleration", Over::Terminal, (&[apex], &[]), Acceleration, &[]);
        m.energy_functional("energy", Over::Terminal);
        m.reaction_norm_functional("guide", Over::Integral, guide);
        Ok(())
    }
}

/// Acceleration of a point along z.
#[derive(Hash)]
struct Acceleration;
impl Quantity for Acceleration {
    fn dofs(&self) -> usize {
        3
    }
    fn unit(&self) -> &'static str {
        "m/s2"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.a[2]
    }
}

/// Force on the apex that holds it at a height z: F = 2 k z (l / L - 1), L^2 = b^2 + z^2.
fn holding_force(z: f64) -> f64 {
    2.0 * STIFFNESS * z * (HALF_SPAN.hypot(RISE) / HALF_SPAN.hypot(z) - 1.0)
}

/// The height under a force, on the first branch, by bisection.
fn height_under(force: f64) -> f64 {
    let (mut above, mut below) = (limit_height(), RISE);
    for _ in 0..200 {
        let z = 0.5 * (above + below);
        if holding_force(z) > force { above = z } else { below = z }
    }
    below
}

/// dF/dz = 0: L^3 = l b^2.
fn limit_height() -> f64 {
    let l = (HALF_SPAN.hypot(RISE) * HALF_SPAN * HALF_SPAN).cbrt();
    (l * l - HALF_SPAN * HALF_SPAN).sqrt()
}

fn prepared<'s>(scene: &'s dyn AnyScene) -> Prepared<'s> {
    Prepared::new(scene).expect("a sound scene")
}

#[test]
fn equal_load_steps_reach_the_height_in_closed_form() {
    let scene = Truss { settings: Settings::statics(10), load: 1.5 };
    let prepared = prepared(&scene);
    let forward = prepared.analysis().forward(&prepared.x).expect("an equilibrium");
    // the slope dz/dF of some 40 mm/N below the limit of 3.0 N leaves round-off of z at 1e-15
    let expected = height_under(1.5 + WEIGHT);
    assert!((forward.values[0] - expected).abs() < 1e-14, "{} against {expected}", forward.values[0]);
    assert_eq!(forward.values[1], RISE);
    // by its rule: the end of each step
    let sum: f64 = (1..=10).map(|i| 0.1 * height_under(0.15 * f64::from(i) + WEIGHT)).sum();
    assert!((forward.values[2] - sum).abs() < 1e-14, "{} against {sum}", forward.values[2]);
    let soft: f64 = (1..=10).map(|i| 0.1 * (20.0 * height_under(0.15 * f64::from(i) + WEIGHT)).exp()).sum();
    assert!((forward.values[3] - soft.ln() / 20.0).abs() < 1e-13, "{}", forward.values[3]);
    assert_eq!(forward.values[4..6], [0.0, 0.0], "in statics nothing moves");
}

#[test]
fn a_load_that_does_not_change_costs_one_iteration_a_step_and_changes_nothing() {
    let scene = Truss { settings: Settings::statics(5), load: 0.0 };
    let prepared = prepared(&scene);
    let forward = prepared.analysis().forward(&prepared.x).expect("an equilibrium");
    let expected = height_under(WEIGHT);
    assert!((forward.values[0] - expected).abs() < 1e-15, "{} against {expected}", forward.values[0]);
    // four steps of one or two iterations behind the first one
    assert!(forward.counters.iterations < 20, "{} iterations", forward.counters.iterations);
}

#[test]
fn adjoint_tangent_and_complex_step_agree_and_match_the_closed_form() {
    let control = StepControl { longest: 0.3, ..StepControl::new(1e-6) };
    let two_links = TwoLinks { settings: Settings::statics(6), velocity: 0.0, rolling: false, redundant: false };
    let settings = Settings::statics(6).dropping_redundant();
    let scenes: [&dyn AnyScene; 5] = [
        &TwoLinks { settings, velocity: 0.0, rolling: false, redundant: true },
        &Driven,
        &Truss { settings: Settings::statics(10), load: 1.5 },
        &Truss { settings: Settings::statics(1).choosing_steps(control), load: 1.5 },
        &two_links,
    ];
    for scene in scenes {
        let prepared = prepared(scene);
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let forward = analysis.forward(x).expect("an equilibrium");
        let [adjoint, tangent, complex] =
            [analysis.adjoint(x, &forward), analysis.tangent(x, &forward), analysis.complex_step(x, &forward)]
                .map(|gradient| gradient.expect("differentiable").rows);
        for (k, functional) in prepared.functionals().iter().enumerate() {
            for (name, other) in [("tangent", &tangent), ("complex step", &complex)] {
                let apart = costate::sensitivity::largest_difference(&other[k], &adjoint[k]);
                // linear systems whose matrix has a condition of some hundreds
                assert!(apart < 1e-12, "{}: \"{}\", {name}: {apart:e}", scene.name(), functional.name);
            }
        }
        if scene.name() == "truss" {
            // F(z, k) = k phi(z): dz/dk = -phi / (k phi'), and dz/dF = 1 / F'
            let z = forward.values[0];
            let slope = (holding_force(z + 1e-5) - holding_force(z - 1e-5)) / 2e-5;
            let expected = [-holding_force(z) / (STIFFNESS * slope), 1.0 / slope];
            for (value, expected) in [adjoint[0][0], adjoint[0][4]].iter().zip(expected) {
                // error of the difference quotient: h^2 F''' / 6 F' = 1e-8
                assert!((value / expected - 1.0).abs() < 1e-7, "{value} against {expected}");
            }
        }
    }
}

#[test]
fn beyond_the_limit_load_chosen_steps_say_where_it_is() {
    let limit = holding_force(limit_height());
    let load = 40.0;
    let scene = Truss { settings: Settings::statics(1).choosing_steps(StepControl::new(1e-6)), load };
    let prepared = prepared(&scene);
    match prepared.analysis().forward(&prepared.x) {
        // a jump onto the far branch, where the bars are pulled, is an equilibrium too
        Ok(forward) => {
            let z = forward.values[0];
            assert!(z < -RISE && (holding_force(z) - load - WEIGHT).abs() < 1e-9, "{z}");
        }
        Err(RunError::NoEquilibrium { t, .. }) => assert!(load * t + WEIGHT <= limit, "{t}"),
        Err(other) => panic!("{other}"),
    }
}

/// Two rods that hang from each other, pulled sideways at the tip: tan theta = sideways force / weight below and half of the own one.
struct TwoLinks {
    settings: Settings,
    velocity: f64,
    rolling: bool,
    /// The upper rod hangs from two hinges on one axis.
    redundant: bool,
}

const LENGTHS: [f64; 2] = [0.8, 0.5];
const MASSES: [f64; 2] = [2.0, 1.2];
const PULL: f64 = 15.0;
const GRAVITY: f64 = 9.81;

impl Scene for TwoLinks {
    fn name(&self) -> String {
        "two links".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("upper mass", MASSES[0], (0.1, 10.0), "kg"),
            DesignVariable::new("lower mass", MASSES[1], (0.1, 10.0), "kg"),
            DesignVariable::new("upper length", LENGTHS[0], (0.1, 10.0), "m"),
            DesignVariable::new("pull", PULL, (-1e3, 1e3), "N"),
        ]
    }
    fn settings(&self) -> Settings {
        self.settings.clone()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [upper_mass, lower_mass, upper_length, pull] = x else { return Err("4 variables".into()) };
        let ground = m.ground();
        let down = Vector3::from_f64([0.0, 0.0, -1.0]);
        let (elbow, tip) = (down * *upper_length, down * (*upper_length + S::from(LENGTHS[1])));
        let upper = m.body("upper", elbow * S::from(0.5), Quaternion::identity());
        let lower = m.body("lower", (elbow + tip) * S::from(0.5), Quaternion::identity());
        let tensor = [0.1, 0.1, 0.01, 0.0, 0.0, 0.0].map(S::from);
        m.rigid_body("upper", upper, *upper_mass, Vector3::zeros(), tensor);
        m.rigid_body("lower", lower, *lower_mass, Vector3::zeros(), tensor);
        m.gravity(down * S::from(GRAVITY));
        let axis = Vector3::from_f64([0.0, 1.0, 0.0]);
        let hinge = m.revolute("hinge", [ground, upper], Vector3::zeros(), axis);
        m.revolute("elbow", [upper, lower], elbow, axis);
        if self.redundant {
            m.revolute("second hinge", [ground, upper], axis * S::from(0.3), axis);
        }
        ramped_force(m, "pull", (lower, NodeKind::Body), (vector(1.0, 0.0, 0.0), tip), LoadFrame::World, *pull);
        if self.velocity != 0.0 {
            m.set_velocity(lower, Vector3::from_f64([self.velocity, 0.0, 0.0]), Vector3::zeros());
        }
        if self.rolling {
            let centre = Vector3::from_f64([3.0, 0.0, 0.5]);
            let ball = m.body("ball", centre, Quaternion::identity());
            m.rigid_body("ball", ball, S::one(), Vector3::zeros(), tensor);
            m.rolling_sphere(
                ["contact", "rolling"],
                [ground, ball],
                centre,
                Vector3::from_f64([0.0, 0.0, 1.0]),
                S::from(0.5),
            );
        }
        m.position_functional("x of the tip", Over::Terminal, lower, tip, Vector3::from_f64([1.0, 0.0, 0.0]));
        m.position_functional("z of the tip", Over::Terminal, lower, tip, Vector3::from_f64([0.0, 0.0, 1.0]));
        for (name, direction) in [("hinge, x", [1.0, 0.0, 0.0]), ("hinge, z", [0.0, 0.0, 1.0])] {
            let load = (LoadKind::Force, LoadFrame::World);
            m.joint_load_functional(
                name,
                Over::Terminal,
                (hinge, upper),
                load,
                Vector3::from_f64(direction),
                Vector3::zeros(),
            );
        }
        let load = (LoadKind::ForceNorm, LoadFrame::World);
        m.joint_load_functional("hinge, integral", Over::Integral, (hinge, upper), load, axis, Vector3::zeros());
        m.joint_angle_functional("angle", Over::Integral, [ground, upper], axis);
        Ok(())
    }
}

#[test]
fn two_hanging_rods_are_pulled_aside_with_the_right_reactions() {
    for settings in [Settings::statics(8), Settings::statics(1).choosing_steps(StepControl::new(1e-3))] {
        let scene = TwoLinks { settings, velocity: 0.0, rolling: false, redundant: false };
        let prepared = prepared(&scene);
        let values = prepared.analysis().forward(&prepared.x).expect("an equilibrium").values;
        let tangents = [PULL / (MASSES[0] / 2.0 + MASSES[1]) / GRAVITY, PULL / (MASSES[1] / 2.0) / GRAVITY];
        let [x, z] = LENGTHS.iter().zip(tangents).fold([0.0, 0.0], |[x, z], (l, tangent)| {
            let angle = f64::atan(tangent);
            [x + l * angle.sin(), z - l * angle.cos()]
        });
        // forces on the upper rod balance the pull and both weights
        let expected = [x, z, -PULL, (MASSES[0] + MASSES[1]) * GRAVITY];
        for (value, expected) in values.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-12 * expected.abs().max(1.0), "{value} against {expected}");
        }
    }
}

/// A rod that a driver turns as the load factor grows.
struct Driven;

const TURN: f64 = 0.7;

impl Scene for Driven {
    fn name(&self) -> String {
        "driven".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("mass", MASSES[0], (0.1, 10.0), "kg"),
            DesignVariable::new("turn", TURN, (-2.0, 2.0), "rad"),
            DesignVariable::new("length", LENGTHS[0], (0.1, 10.0), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::statics(5)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, turn, length] = x else { return Err("3 variables".into()) };
        let ground = m.ground();
        let centre = Vector3::new(S::zero(), S::zero(), -*length);
        let rod = m.body("rod", centre, Quaternion::identity());
        m.rigid_body("rod", rod, *mass, Vector3::zeros(), [0.1, 0.1, 0.01, 0.0, 0.0, 0.0].map(S::from));
        m.gravity(Vector3::from_f64([0.0, 0.0, -GRAVITY]));
        let axis = Vector3::from_f64([0.0, 1.0, 0.0]);
        m.revolute("hinge", [ground, rod], Vector3::zeros(), axis);
        let driver =
            m.prescribed_rotation("driver", [ground, rod], axis, Signal::ConstantRate { offset: S::zero(), rate: *turn });
        m.position_functional("x", Over::Terminal, rod, centre, Vector3::from_f64([1.0, 0.0, 0.0]));
        let load = (LoadKind::Moment, LoadFrame::World);
        m.joint_load_functional("moment", Over::Terminal, (driver, rod), load, axis, Vector3::zeros());
        m.joint_load_functional("moment, integral", Over::Integral, (driver, rod), load, axis, Vector3::zeros());
        Ok(())
    }
}

#[test]
fn a_driver_turns_a_rod_through_equilibria() {
    let prepared = prepared(&Driven);
    let values = prepared.analysis().forward(&prepared.x).expect("an equilibrium").values;
    // turned about y, the rod that hangs down goes towards -x; the driver holds its weight
    let arm = LENGTHS[0] * TURN.sin();
    assert!((values[0] + arm).abs() < 1e-14, "{}", values[0]);
    assert!((values[1] - MASSES[0] * GRAVITY * arm).abs() < 1e-12, "{}", values[1]);
    let path = prepared.path(&ArcLength::new(0.1).up_to_load(1.0)).expect("a path");
    let last = path.points.last().expect("points");
    assert!((last.q[7] + arm).abs() < 1e-13, "{}", last.q[7]);
}

#[test]
fn gradients_do_not_depend_on_where_load_steps_are_kept() {
    let control = StepControl { longest: 0.05, ..StepControl::new(1e-6) };
    for settings in [Settings::statics(40), Settings::statics(1).choosing_steps(control)] {
        let scene = TwoLinks { settings, velocity: 0.0, rolling: false, redundant: false };
        let rows = |keep: Keep| {
            let mut prepared = prepared(&scene);
            prepared.keep = keep;
            let analysis = prepared.analysis();
            let forward = analysis.forward(&prepared.x).expect("an equilibrium");
            let gradient = analysis.adjoint(&prepared.x, &forward).expect("differentiable").rows;
            (gradient, forward.history.usage().recomputed)
        };
        let (memory, none) = rows(Keep::Memory);
        // room for some of the steps
        let (checkpoints, recomputed) = rows(Keep::Checkpoints(20_000));
        assert_eq!(none, 0);
        assert!(recomputed > 0, "all steps fitted into the memory of the checkpoints");
        assert_eq!(memory, checkpoints);
    }
}

/// A body that nothing holds; or one whose only support has no inertia behind it.
struct Loose {
    spring: bool,
}

impl Scene for Loose {
    fn name(&self) -> String {
        "loose".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("load", 2.0, (-10.0, 10.0), "N")]
    }
    fn settings(&self) -> Settings {
        Settings::statics(4)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let place = Vector3::from_f64([0.0, 0.0, 1.0]);
        let block = m.point("block", place);
        if self.spring {
            let foot = Vector3::zeros();
            m.line_spring("support", [ground, block], [foot, place], S::from(50.0), S::from(1.0));
            m.point_on_line("guide", [ground, block], place, Vector3::from_f64([0.0, 0.0, 1.0]));
        } else {
            m.point_mass("block", block, S::one());
        }
        ramped_force(m, "load", (block, NodeKind::Point), (vector(0.0, 0.0, -1.0), place), LoadFrame::World, x[0]);
        m.position_functional("height", Over::Terminal, block, place, Vector3::from_f64([0.0, 0.0, 1.0]));
        Ok(())
    }
}

#[test]
fn equilibria_need_no_inertia() {
    let scene = Loose { spring: true };
    let prepared = prepared(&scene);
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("an equilibrium");
    assert!((forward.values[0] - (1.0 - 2.0 / 50.0)).abs() < 1e-15, "{}", forward.values[0]);
    let gradient = analysis.adjoint(&prepared.x, &forward).expect("differentiable").rows[0][0];
    assert!((gradient + 1.0 / 50.0).abs() < 1e-15, "{gradient}");
}

#[test]
fn mistakes_are_named() {
    let still = Settings::statics(4);
    let mut messages = Vec::new();
    let scene = Loose { spring: false };
    let prepared = prepared(&scene);
    messages.push(prepared.analysis().forward(&prepared.x).expect_err("nothing holds the block").to_string());
    for (velocity, rolling) in [(0.5, false), (0.0, true)] {
        let scene = TwoLinks { settings: still.clone(), velocity, rolling, redundant: false };
        let Err(error) = Prepared::new(&scene) else { panic!("accepted") };
        assert!(matches!(error, RunError::Input(_)), "{error}");
        messages.push(error.to_string());
    }
    let scene = Truss { settings: still.with_method("statics"), load: 1.0 };
    let Err(error) = Prepared::new(&scene) else { panic!("accepted") };
    messages.push(error.to_string());
    let expected = [
        ["\"block\"", "nothing holds it"],
        ["\"lower\", x is 0.5", "set it to 0"],
        ["\"rolling\"", "velocities"],
        ["\"statics\"", "did you mean \"static\"?"],
    ];
    for (message, parts) in messages.iter().zip(expected) {
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?} are not in {message}");
    }
}

#[test]
fn the_table_of_equilibria_is_found_by_name_and_is_no_motion() {
    let table = table_named(STATIC_TABLE).expect("sound").expect("listed");
    assert!(table.is_static());
    assert!(costate::integrators::tables().iter().all(|table| !table.is_static()));
}

/// Weight of the apex.
const WEIGHT: f64 = 0.1 * GRAVITY;

fn truss(load: f64) -> Truss {
    Truss { settings: Settings::statics(1), load }
}

/// Height of the apex: behind the seven coordinates of the ground.
const HEIGHT: usize = 9;

#[test]
fn arc_length_follows_the_truss_through_both_limits() {
    let load = 2.0;
    let scene = truss(load);
    let prepared = prepared(&scene);
    let path = prepared.path(&ArcLength::new(0.05).up_to_load(4.0)).expect("a path");
    assert_eq!(path.end, PathEnd::Load);
    for PathPoint { load: factor, q, .. } in path.points.iter().chain(&path.limits) {
        // some times the round-off of the bars' forces, k l eps = 2e-13
        let off = holding_force(q[HEIGHT]) - load * factor - WEIGHT;
        assert!(off.abs() < 2e-12, "at {factor}: {off:e}");
    }
    let last = path.points.last().expect("points");
    assert!((last.load - 4.0).abs() < 1e-14 && last.q[HEIGHT] < -RISE, "{last:?}");
    let [snap, back] = [&path.limits[0], &path.limits[1]];
    assert_eq!(path.limits.len(), 2);
    for (limit, sign) in [(snap, 1.0), (back, -1.0)] {
        let expected = (sign * holding_force(limit_height()) - WEIGHT) / load;
        // the load is off by the square of what is left of the slope, 1e-7
        assert!((limit.load - expected).abs() < 1e-12, "{} against {expected}", limit.load);
        // the height by this slope itself
        assert!((limit.q[HEIGHT] - sign * limit_height()).abs() < 1e-6, "{}", limit.q[HEIGHT]);
    }
    // down between the limits, up outside
    let falling = path.points.iter().filter(|point| point.slope < 0.0);
    assert!(falling.clone().count() > 3);
    falling.for_each(|point| assert!(point.q[HEIGHT].abs() < limit_height()));
}

#[test]
fn a_path_does_not_depend_on_the_unit_of_the_load() {
    let heights = |load: f64| {
        let scene = truss(load);
        let prepared = prepared(&scene);
        let path = prepared.path(&ArcLength::new(0.05 / load).up_to_coordinate(HEIGHT, -0.1)).expect("a path");
        assert_eq!(path.end, PathEnd::Coordinate);
        let last = path.points.last().expect("points");
        assert!((last.q[HEIGHT] + 0.1).abs() < 1e-14, "{last:?}");
        path.points.iter().map(|point| point.q[HEIGHT]).collect::<Vec<f64>>()
    };
    let (one, hundred) = (heights(1.0), heights(100.0));
    assert_eq!(one.len(), hundred.len());
    one.iter().zip(&hundred).for_each(|(a, b)| assert!((a - b).abs() < 1e-10, "{a} {b}"));
}

#[test]
fn a_path_follows_rods_on_joints_with_their_reactions() {
    let scene = TwoLinks { settings: Settings::statics(1), velocity: 0.0, rolling: false, redundant: false };
    let prepared = prepared(&scene);
    let path = prepared.path(&ArcLength::new(0.1).up_to_load(1.0)).expect("a path");
    let last = path.points.last().expect("points");
    // the frame of the upper rod is its middle; the ground has seven coordinates
    let angle = f64::atan(PULL / (MASSES[0] / 2.0 + MASSES[1]) / GRAVITY);
    assert!((last.q[7] - 0.5 * LENGTHS[0] * angle.sin()).abs() < 1e-13, "{}", last.q[7]);
    assert!((last.q[9] + 0.5 * LENGTHS[0] * angle.cos()).abs() < 1e-13, "{}", last.q[9]);
    let run = prepared.equilibrium().expect("an equilibrium");
    let apart = run.mu.iter().zip(&last.mu).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    assert!(apart < 1e-10, "reactions of some 30 N differ by {apart:e}");
    assert!(path.limits.is_empty());
}

#[test]
fn mistakes_about_paths_are_named() {
    let scene = truss(1.0);
    let prepared = prepared(&scene);
    let cases = [
        (ArcLength::new(0.0), "first increment of the load is 0"),
        (ArcLength { points: 0, ..ArcLength::new(1.0) }, "0 points"),
        (ArcLength::new(1.0).up_to_coordinate(10, 0.0), "the model has 10"),
    ];
    for (options, part) in cases {
        let error = prepared.path(&options).expect_err("refused");
        assert!(matches!(error, RunError::Input(_)) && error.to_string().contains(part), "{error}");
    }
    let scene = truss(0.0);
    let error = Prepared::new(&scene).expect("sound").path(&ArcLength::new(0.1)).expect_err("nothing moves");
    assert!(error.to_string().contains("nothing moves with the load factor"), "{error}");
}

/// Beams, cables of both strains, a body and a point on springs, with their weight given at one place or in two parts.
#[derive(Clone, Copy)]
enum Weight {
    First,
    Last,
    Halves,
}

impl Scene for Weight {
    fn name(&self) -> String {
        "hanging".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(2)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let at = |x: f64, y: f64, z: f64| Vector3::from_f64([x, y, z]);
        let gravity = at(0.3, 0.2, -9.81);
        match self {
            Weight::First => m.gravity(gravity),
            Weight::Halves => m.gravity(gravity * S::from(0.5)),
            Weight::Last => {}
        }
        let ground = m.ground();
        let section = Section::new([1e5, 1e5, 1e5, 1e2, 1e2, 1e2].map(S::from)).with_inertia(S::one(), [S::from(0.01); 2]);
        let line = |y: f64| [at(0.0, y, 0.0), at(1.0, y, 0.0)];
        let beam = m.beam("beam", BeamLine::straight(line(0.0), 1, at(0.0, 1.0, 0.0)).clamped_start(), &section);
        m.rigid_body("lump", beam.end(), S::one(), at(0.1, 0.0, 0.1), [0.1, 0.1, 0.1, 0.0, 0.0, 0.0].map(S::from));
        let rope = CableSection::new(S::from(1e5), S::from(1e2), S::one());
        let exact = m.cable("exact", CableLine::straight(line(1.0), 2).clamped_start(), &rope);
        let small = m.cable("small", CableLine::straight(line(2.0), 2).clamped_start(), &rope.small_strains());
        let bob = m.point("bob", at(0.0, 0.0, -1.0));
        m.point_mass("bob", bob, S::one());
        for (i, hook) in [at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(-1.0, -1.0, 0.0)].into_iter().enumerate() {
            let place = at(0.0, 0.0, -1.0);
            m.line_spring(&format!("spring {i}"), [ground, bob], [hook, place], S::from(100.0), (hook - place).length());
        }
        match self {
            Weight::First => {}
            Weight::Halves => m.gravity(gravity * S::from(0.5)),
            Weight::Last => m.gravity(gravity),
        }
        for (name, node, place) in [
            ("beam", beam.end(), at(1.0, 0.0, 0.0)),
            ("exact", exact.end(), at(1.0, 1.0, 0.0)),
            ("small", small.end(), at(1.0, 2.0, 0.0)),
            ("bob", bob, at(0.0, 0.0, -1.0)),
        ] {
            m.position_functional(name, Over::Terminal, node, place, at(0.0, 0.0, 1.0));
        }
        m.energy_functional("energy", Over::Terminal);
        Ok(())
    }
}

#[test]
fn weight_acts_on_everything_wherever_gravity_is_given() {
    let [first, last, halves] = [Weight::First, Weight::Last, Weight::Halves].map(|weight| {
        let prepared = Prepared::new(&weight).expect("a sound scene");
        prepared.analysis().forward(&[]).expect("an equilibrium").values
    });
    assert!(last[..4].iter().zip([0.0, 0.0, 0.0, -1.0]).all(|(z, start)| *z < start - 1e-3), "all hang: {last:?}");
    for (k, value) in last.iter().enumerate() {
        assert!((first[k] - value).abs() < 1e-9 * value.abs(), "{}, {value}", first[k]);
        assert!((halves[k] - value).abs() < 1e-9 * value.abs(), "{}, {value}", halves[k]);
    }
}
