//! Example scenes whose laws are formulas of the file, against the same laws in Rust, and against what is known of them.

use super::runge_kutta;
use costate::elements::Frame;
use costate::functionals::Times;
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};
use std::f64::consts::PI;
use std::time::Instant;

/// Values at the end and gradients.
fn run(scene: &dyn AnyScene) -> (Vec<f64>, Vec<Vec<f64>>) {
    let prepared = Prepared::new(scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{why}"));
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap().rows;
    let other = analysis.complex_step(&prepared.x, &forward).unwrap().rows;
    for (own, other) in gradient.iter().zip(&other) {
        let apart = largest_difference(other, own);
        assert!(apart < 1e-12, "{apart:e}");
    }
    (forward.values, gradient)
}

fn of_file(name: &str) -> FileScene {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes").join(name);
    FileScene::read(&path).unwrap_or_else(|why| panic!("{why}"))
}

/// The file and the program do the same operations in the same order.
fn assert_same_bits(file: &str, twin: &dyn AnyScene) -> Vec<f64> {
    let ((own, rows), (other, other_rows)) = (run(&of_file(file)), run(twin));
    let bits = |values: &[f64]| values.iter().map(|own| own.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&own), bits(&other), "{own:?} for {other:?}");
    for (own, other) in rows.iter().zip(&other_rows) {
        assert!(largest_difference(own, other) < 1e-14, "{rows:?} for {other_rows:?}");
    }
    let [file_time, twin_time] = times([&of_file(file), twin]);
    println!("{file}: {:.3} times as long as its twin, with the gradient", file_time / twin_time);
    own
}

/// Least seconds of simulations with gradients, in turn.
fn times(scenes: [&dyn AnyScene; 2]) -> [f64; 2] {
    let prepared = scenes.map(|scene| Prepared::new(scene).unwrap_or_else(|why| panic!("{why}")));
    let mut least = [f64::INFINITY; 2];
    let turns = if cfg!(debug_assertions) { 1 } else { 9 };
    for _ in 0..turns {
        for (prepared, least) in prepared.iter().zip(&mut least) {
            let (analysis, begun) = (prepared.analysis(), Instant::now());
            let forward = analysis.forward(&prepared.x).unwrap();
            analysis.adjoint(&prepared.x, &forward).unwrap();
            *least = least.min(begun.elapsed().as_secs_f64());
        }
    }
    least
}

struct TyreSlip;
impl Element for TyreSlip {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("relaxation", "m")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point, NodeKind::States(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[3] += s.a[3] - (-s.v[1] - s.v[0] * s.v[3]) / p[0];
    }
}

/// F = grip tanh(stiffness slip / grip).
fn side_force<S: Scalar>(slip: S, [stiffness, grip]: [S; 2]) -> S {
    grip * (stiffness * slip / grip).tanh()
}

struct TyreGrip;
impl Element for TyreGrip {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("stiffness", "N/rad"), Parameter::positive("grip", "N")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point, NodeKind::States(1)]
    }
    fn add_force<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S], _t: S, force: &mut [S]) {
        force[1] += side_force(v[3], [p[0], p[1]]);
    }
}

struct Push;
impl TimeFormula for Push {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("push", "N")];
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        p[0] * (t * (2.0 * PI)).sin().powi(2)
    }
}

/// The slip, or the power of the side force.
struct OfTyre(bool);
impl Quantity for OfTyre {
    fn dofs(&self) -> usize {
        4
    }
    fn unit(&self) -> &'static str {
        "-"
    }
    fn parameters(&self) -> Vec<Parameter> {
        TyreGrip::PARAMETERS.to_vec()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        if self.0 { side_force(s.v[3], [p[0], p[1]]) * s.v[1] } else { s.v[3] }
    }
}

struct Tyre;
impl Scene for Tyre {
    fn name(&self) -> String {
        "tyre".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("stiffness", 4e4), ("grip", 3e3), ("relaxation", 0.4), ("push", 2500.0)]
            .map(|(name, value)| DesignVariable::new(name, value, (0.1, 1e5), "-"))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.5, 300)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let (ground, cart) = (m.ground(), m.point("cart", Vector3::zeros()));
        let [_, y, z] = [0, 1, 2].map(|axis| Vector3::from_f64(std::array::from_fn(|i| f64::from(u8::from(i == axis)))));
        m.set_velocity(cart, Vector3::from_f64([15.0, 0.0, 0.0]), Vector3::zeros());
        m.point_mass("cart", cart, S::from(400.0));
        m.point_in_plane("road", [ground, cart], Vector3::zeros(), z);
        let tyre = m.states("tyre", &[S::zero()]);
        m.element("rates", &[cart, tyre], TyreSlip, &x[2..3]);
        m.element("grip", &[cart, tyre], TyreGrip, &x[..2]);
        let (frame, size) = (LoadFrame::World, Signal::own(Push, &x[3..])?);
        m.force("push", Force { on: cart, point: Vector3::zeros(), direction: y, frame, size });
        m.position_functional("aside", Over::Terminal, cart, Vector3::zeros(), y);
        let largest = Aggregate::smooth_maximum(200.0).at(Times::Run);
        m.functional("slip", largest, (&[cart, tyre], &[]), OfTyre(false), &x[..2]);
        m.functional("work", Over::Integral, (&[cart, tyre], &[]), OfTyre(true), &x[..2]);
        Ok(())
    }
}

#[test]
fn a_tyre_of_a_file_is_that_of_a_program_and_moves_as_its_equations_say() {
    let values = assert_same_bits("tyre.toml", &Tyre);
    let slope = |t: f64, [_, v, slip, _]: [f64; 4]| {
        let force = 3e3 * (4e4 * slip / 3e3).tanh();
        [v, (force + 2500.0 * (2.0 * PI * t).sin().powi(2)) / 400.0, (-v - 15.0 * slip) / 0.4, force * v]
    };
    let end = runge_kutta::integrated([0.0; 4], (15_000, 1e-4), slope);
    assert!((values[0] - end[0]).abs() < 1e-8 && (values[2] - end[3]).abs() < 1e-4, "{values:?} for {end:?}");
}

const DENSITY: f64 = 1.225;
const RADIUS: f64 = 2.0;
const ROOT: f64 = 0.4;
const WIDTH: f64 = (RADIUS - ROOT) / 8.0;

/// What a strip knows of the air: velocity of the blade along its chord and up through the air, of a place in its frame.
fn of_air<S: Scalar>(v: &[S], q: &[S], place: Vector3<S>, w: S) -> (Frame<S>, [S; 2]) {
    let (frame, velocity) = (Frame::of(NodeKind::Body, q), NodeKind::Body.velocity(v, q, place));
    let along = velocity.dot(&frame.axes[1]);
    let up = velocity.dot(&frame.axes[2]) + w;
    (frame, [along, up])
}

/// Parameters: place x, y, z, pitch, slope, drag, chord.
const OF_STRIP: &[Parameter] = &[
    Parameter::new("place x", "m"),
    Parameter::new("place y", "m"),
    Parameter::new("place z", "m"),
    Parameter::new("pitch", "rad"),
    Parameter::new("slope", "1/rad"),
    Parameter::new("drag", "-"),
    Parameter::new("chord", "m"),
];

struct Inflow(f64);
impl Element for Inflow {
    const PARAMETERS: &'static [Parameter] = OF_STRIP;
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Body, NodeKind::States(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let [x, y, z, pitch, slope, _, chord] = p else { unreachable!() };
        let w = s.v[7];
        let (_, [along, up]) = of_air(s.v, s.q, Vector3::new(*x, *y, *z), w);
        let lift = *chord * (0.5 * DENSITY) * *slope * (*pitch - up.atan2(along)) * (along.powi(2) + up.powi(2));
        let rate = (lift * 2.0 / (2.0 * PI * self.0 * DENSITY) - w.powi(2) * 2.0) * 3.0 * PI / (8.0 * RADIUS);
        r[7] += s.a[7] - rate;
    }
}

struct Strip;
impl Element for Strip {
    const PARAMETERS: &'static [Parameter] = OF_STRIP;
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Body, NodeKind::States(1)]
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, force: &mut [S]) {
        let [x, y, z, pitch, slope, drag, chord] = p else { unreachable!() };
        let place = Vector3::new(*x, *y, *z);
        let (frame, [along, up]) = of_air(v, q, place, v[7]);
        let flow = (frame.axes[1] * along + frame.axes[2] * up).unit();
        let pressure = *chord * (0.5 * DENSITY) * WIDTH * (along.powi(2) + up.powi(2));
        let lift = pressure * *slope * (*pitch - up.atan2(along));
        NodeKind::Body.add_force(q, place, frame.axes[0].cross(&flow) * lift - flow * (*drag * pressure), force);
    }
}

struct NearTip;
impl Quantity for NearTip {
    fn dofs(&self) -> usize {
        1
    }
    fn unit(&self) -> &'static str {
        "m/s"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.v[0]
    }
}

struct AirLoads;
impl Scene for AirLoads {
    fn name(&self) -> String {
        "air-loads".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("pitch", 6.0 * (PI / 180.0)), ("slope", 5.7), ("drag", 0.012), ("chord", 0.1)]
            .map(|(name, value)| DesignVariable::new(name, value, (0.0, 7.0), "-"))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.42, 400)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let vector = |components| Vector3::<S>::from_f64(components);
        let of_mass = |numbers: [f64; 3]| [numbers, [0.0; 3]].concat().iter().map(|&own| S::from(own)).collect::<Vec<_>>();
        let inertia = |numbers| <[S; 6]>::try_from(of_mass(numbers)).map_err(|_| "six numbers".to_string());
        let ground = m.ground();
        let hub = m.body("hub", Vector3::zeros(), Quaternion::identity());
        m.set_velocity(hub, Vector3::zeros(), vector([0.0, 0.0, 60.0]));
        m.rigid_body("hub", hub, S::one(), Vector3::zeros(), inertia([0.1; 3])?);
        let blade = m.body("blade", vector([0.1, 0.0, 0.0]), Quaternion::identity());
        m.set_velocity(blade, vector([0.0, 6.0, 0.0]), vector([0.0, 0.0, 60.0]));
        m.rigid_body("blade", blade, S::from(2.0), vector([0.95, 0.0, 0.0]), inertia([0.002, 0.6, 0.602])?);
        m.gravity(vector([0.0, 0.0, -9.81]));
        m.revolute("shaft", [ground, hub], Vector3::zeros(), vector([0.0, 0.0, 1.0]));
        m.revolute("flap hinge", [hub, blade], vector([0.1, 0.0, 0.0]), vector([0.0, -1.0, 0.0]));
        let turning = Signal::ConstantRate { offset: S::zero(), rate: S::from(60.0) };
        let motor = m.prescribed_rotation("motor", [ground, hub], vector([0.0, 0.0, 1.0]), turning);
        let places: Vec<f64> = (0..8).map(|k| ROOT + (f64::from(k) + 0.5) * WIDTH).collect();
        let strip = |place: f64, m: &MechanismBuilder<S>| {
            let local = m.local_point(blade, Vector3::from_f64([place, 0.0, 0.0]));
            [&local.components()[..], x].concat()
        };
        let mut inflows = Vec::new();
        for (k, &place) in places.iter().enumerate() {
            let (own, p) = (m.states(&format!("inflow {k}"), &[S::zero()]), strip(place, m));
            m.element("rates", &[blade, own], Inflow(place), &p);
            inflows.push(own);
        }
        for (&place, &inflow) in places.iter().zip(&inflows) {
            let p = strip(place, m);
            m.element("strip", &[blade, inflow], Strip, &p);
        }
        m.joint_angle_functional("flap", Over::Integral, [hub, blade], vector([0.0, -1.0, 0.0]));
        m.reaction_functional("moment", Over::Terminal, motor, &[S::one()]);
        m.functional("inflow", Over::Terminal, (&inflows[7..], &[]), NearTip, &[]);
        Ok(())
    }
}

#[test]
fn air_loads_of_a_file_are_those_of_a_program_and_hover_as_momentum_theory_says() {
    let values = assert_same_bits("air-loads.toml", &AirLoads);
    // at rest in the rotating frame: lift of a ring is its momentum, which gives the inflow; the blade cones by a few degrees
    let (omega, pitch, slope, chord) = (60.0, 6.0_f64.to_radians(), 5.7, 0.1);
    let place = ROOT + 7.5 * WIDTH;
    let mut w = 0.0;
    for _ in 0..200 {
        let angle = pitch - (w / (omega * place)).atan();
        let lift = chord * slope * angle * ((omega * place).powi(2) + w * w);
        w = 0.5 * (w + (lift / (4.0 * PI * place)).sqrt());
    }
    // 2 rho 2 pi r w^2 = blades rho / 2 c a alpha u^2, with two blades
    assert!((values[2] - w).abs() < 0.01 * w, "{} for {w}", values[2]);
}

const TARGET: f64 = 60.0 * (PI / 180.0);

/// T z' = u - z, of a number u.
struct Command;
impl Element for Command {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("rise", "s")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::States(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[0] += s.a[0] - (S::from(TARGET) - s.v[0]) / p[0];
    }
}

/// Of the angle, the command, and the integral term.
struct Control;
impl Element for Control {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("ki", "N m/(rad s)")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1), NodeKind::States(1), NodeKind::States(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[2] += s.a[2] - p[0] * (s.v[1] - s.q[0]);
    }
}

/// Of the angle, the command, the integral term, and the torque.
struct Motor;
impl Element for Motor {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("kp", "N m/rad"), Parameter::new("kd", "N m s/rad"), Parameter::positive("lag", "s")];
    fn nodes(&self) -> Vec<NodeKind> {
        [vec![NodeKind::Coordinates(1)], vec![NodeKind::States(1); 3]].concat()
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let rate = (S::from(TARGET) - s.v[1]) / S::from(0.3);
        let output = p[0] * (s.v[1] - s.q[0]) + s.v[2] + p[1] * (rate - s.v[0]);
        r[3] += s.a[3] - (output - s.v[3]) / p[2];
    }
}

/// The torque of a motor on the angle.
struct Torque;
impl Element for Torque {
    const PARAMETERS: &'static [Parameter] = &[];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1), NodeKind::States(1)]
    }
    fn add_force<S: Scalar>(&self, v: &[S], _q: &[S], _p: &[S], _t: S, force: &mut [S]) {
        force[0] += v[1];
    }
}

/// The error squared, a state, or the angle.
#[derive(Clone, Copy)]
enum OfArm {
    Error,
    State,
    Angle,
}
impl Quantity for OfArm {
    fn dofs(&self) -> usize {
        1
    }
    fn unit(&self) -> &'static str {
        "-"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        match self {
            OfArm::Error => (s.q[0] - S::from(TARGET)).powi(2),
            OfArm::State => s.v[0],
            OfArm::Angle => s.q[0],
        }
    }
}

struct ControlledArm;
impl Scene for ControlledArm {
    fn name(&self) -> String {
        "controlled-arm".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("kp", 60.0), ("ki", 80.0), ("kd", 8.0)]
            .map(|(name, value)| DesignVariable::new(name, value, (0.0, 300.0), "-"))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(2.5, 500)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let vector = |components| Vector3::<S>::from_f64(components);
        let ground = m.ground();
        let arm = m.body("arm", vector([0.0, 0.0, -0.4]), Quaternion::identity());
        let across = 1.2 * 0.8_f64.powi(2) / 12.0;
        let inertia = [across, across, 0.0001, 0.0, 0.0, 0.0].map(S::from);
        m.rigid_body("arm", arm, S::from(1.2), Vector3::zeros(), inertia);
        let load = m.point("load", vector([0.0, 0.0, -0.8]));
        m.point_mass("load", load, S::from(0.5));
        m.gravity(vector([0.0, 0.0, -9.81]));
        m.revolute("hinge", [ground, arm], Vector3::zeros(), vector([0.0, -1.0, 0.0]));
        m.spherical("grip", [arm, load], vector([0.0, 0.0, -0.8]));
        let angle = m.joint_angle("angle", [ground, arm], vector([0.0, -1.0, 0.0]));
        let [command, control, motor] = ["command", "control", "motor"].map(|name| m.states(name, &[S::zero()]));
        m.element("command", &[command], Command, &[S::from(0.3)]);
        m.element("control", &[angle, command, control], Control, &x[1..2]);
        m.element("lag", &[angle, command, control, motor], Motor, &[x[0], x[2], S::from(0.02)]);
        m.element("motor", &[angle, motor], Torque, &[]);
        m.functional("error", Over::Integral, (&[angle], &[]), OfArm::Error, &[]);
        let largest = Aggregate::smooth_maximum(40.0).relative_to(10.0).at(Times::Run);
        m.functional("torque", largest, (&[motor], &[]), OfArm::State, &[]);
        m.functional("angle", Over::Terminal, (&[angle], &[]), OfArm::Angle, &[]);
        Ok(())
    }
}

#[test]
fn a_controlled_arm_of_a_file_is_that_of_a_program_and_comes_to_its_target() {
    let values = assert_same_bits("controlled-arm.toml", &ControlledArm);
    assert!((values[2] - TARGET).abs() < 0.05, "{values:?}");
}
