//! Cables in absolute nodal coordinates against closed forms: elastica, stretch, frequencies, momentum, damping; gradients; what a user
//! may get wrong.

use costate::elements::flexible::{CableSection, Material, Shape};
use costate::elements::forces::LoadFrame;
use costate::elements::joints::HeldSlope;
use costate::functionals::quantities::CableMeasure;
use costate::history::Watch;
use costate::integrators::StepRecord;
use costate::internals::{AppliedForce, march};
use costate::prelude::*;
use costate::scenes::{AnyScene, CableLine, CableMember, built_in};
use std::f64::consts::PI;

/// How the start of a cantilever is held.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    /// A node that never moves.
    Node,
    /// A weld to the ground.
    Weld(HeldSlope),
}

#[derive(Clone, Copy)]
enum What {
    /// A cantilever under a load at its tip, across or along it.
    Loaded { elements: usize, small: bool, held: Held, load: [f64; 3], axial: f64 },
    /// Free, simply supported or clamped, and unloaded.
    Vibrating { supports: Supports, small: bool },
    /// A free cable, thrown and turning.
    Thrown { small: bool },
    /// The first mode of a simply supported cable with damping.
    Damped,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Supports {
    None,
    Simple,
    Clamped,
}

struct Bar(What);

/// Length [m], bending stiffness [N m2] and mass [kg/m] of all cables.
const LENGTH: f64 = 10.0;
const BENDING: f64 = 100.0;
const MASS: f64 = 0.5;
/// Axial stiffness of those that move [N].
const AXIAL: f64 = 1e5;
/// Elements of those that vibrate.
const ELEMENTS: usize = 8;
/// Damping [s].
const DAMPING: f64 = 0.02;

fn vector<S: Scalar>(components: [f64; 3]) -> Vector3<S> {
    Vector3::from_f64(components)
}

fn section<S: Scalar>(axial: f64, small: bool) -> CableSection<S> {
    let section = CableSection::new(S::from(axial), S::from(BENDING), S::from(MASS));
    if small { section.small_strains() } else { section }
}

fn line<S: Scalar>(elements: usize) -> CableLine<S> {
    CableLine::straight([Vector3::zeros(), vector([LENGTH, 0.0, 0.0])], elements)
}

impl Scene for Bar {
    fn name(&self) -> String {
        "bar".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        match self.0 {
            // bending stretches a linear guess, against which these are stiff: load steps are divided
            What::Loaded { .. } => Settings::statics(40).dividing_steps(),
            What::Vibrating { .. } => Settings::new(1.0, 1),
            What::Thrown { .. } => Settings::new(4.0, 800),
            What::Damped => Settings::new(20.0, 2000),
        }
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        match self.0 {
            What::Loaded { elements, small, held, load, axial } => {
                let line = line(elements);
                let line = if held == Held::Node { line.clamped_start() } else { line };
                let cable = m.cable("cable", line, &section(axial, small));
                if let Held::Weld(slope) = held {
                    let ground = m.ground();
                    m.cable_weld("weld", [ground, cable.start()], slope);
                }
                let p = [&load.map(S::from)[..], &[S::zero(); 3], &[S::zero(), S::one()]].concat();
                let force = AppliedForce { on: NodeKind::Slope, frame: LoadFrame::World, size: TimeFunction::ConstantRate };
                m.element("load", &[cable.end()], force, &p);
                let end = cable.end();
                for (name, direction) in [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0])] {
                    m.position_functional(name, Over::Terminal, end, m.position(end), vector(direction));
                }
                m.cable_strain_functional("strain", Over::Terminal, &cable, 0.9, CableMeasure::Strain);
                m.cable_strain_functional("curvature", Over::Terminal, &cable, 0.5, CableMeasure::Curvature);
                m.cable_stress_functional("stress", Over::Terminal, (&cable, 0.9), S::from(7.0), S::zero());
                m.strain_energy_functional("strain energy", Over::Terminal, &cable.group());
            }
            What::Vibrating { supports, small } => {
                let line = line(ELEMENTS);
                let line = if supports == Supports::Clamped { line.clamped_start() } else { line };
                let cable = m.cable("cable", line, &section(AXIAL, small));
                supported(m, supports, &cable);
            }
            What::Thrown { small } => {
                let cable = m.cable("cable", line(ELEMENTS), &section(AXIAL, small));
                m.set_rigid_motion(&cable.nodes, Vector3::zeros(), vector([0.3, -0.7, 0.4]), vector([0.0, 0.4, 0.9]));
                // one end is pushed, so that the cable bends in space
                m.set_velocity(cable.end(), vector([0.0, 4.0, -2.0]), Vector3::zeros());
                m.energy_functional("energy at the start", Over::Initial);
                m.energy_functional("energy", Over::Terminal);
            }
            What::Damped => {
                let cable = m.cable("cable", line(ELEMENTS), &section(AXIAL, false).damped(S::from(DAMPING)));
                supported(m, Supports::Simple, &cable);
                for (i, &node) in cable.nodes.iter().enumerate() {
                    let phase = PI * i as f64 / ELEMENTS as f64;
                    let rate = 1e-4 * PI / LENGTH * phase.cos();
                    // d(r_x)/dt = omega x r_x
                    m.set_velocity(node, vector([0.0, 1e-4 * phase.sin(), 0.0]), vector([0.0, 0.0, rate]));
                }
            }
        }
        Ok(())
    }
}

fn supported<S: Scalar>(m: &mut MechanismBuilder<S>, supports: Supports, cable: &CableMember) {
    let ground = m.ground();
    if supports == Supports::Simple {
        m.spherical("left", [ground, cable.start()], Vector3::zeros());
        m.point_on_line("right", [ground, cable.end()], vector([LENGTH, 0.0, 0.0]), vector([1.0, 0.0, 0.0]));
    }
}

fn equilibrium(what: What) -> Vec<f64> {
    let bar = Bar(what);
    let prepared = Prepared::new(&bar).expect("a sound bar");
    prepared.analysis().forward(&[]).expect("an equilibrium").values
}

/// Elastica: tip of an inextensible cantilever under a dead load with P L^2 / (EI) = 4, Mattiasson (1981), recomputed to 12 digits; its
/// energy times L / (EI) is 4 (sin phi - y / L) with the angle phi at the tip.
#[test]
fn a_cantilever_bends_like_the_elastica() {
    let (shortening, deflection, bent) = (0.328_941_242_247, 0.669_964_181_278, 0.922_702_125_745);
    let load = [0.0, 4.0 * BENDING / (LENGTH * LENGTH), 0.0];
    for small in [false, true] {
        // nothing but bending resists a stretch of slopes where strains are those of the chord: it is kept at the start
        let held = if small { Held::Node } else { Held::Weld(HeldSlope::Direction) };
        let mut errors = Vec::new();
        for elements in [8, 16, 32] {
            // EA L^2 / (EI) = 1e7: the load stretches by less than 1e-6
            let [x, y, .., energy] = equilibrium(What::Loaded { elements, small, held, load, axial: 1e7 })[..] else {
                unreachable!()
            };
            let of_energy = (energy * LENGTH / BENDING / bent - 1.0).abs();
            errors.push((x / LENGTH - 1.0 + shortening).abs().max((y / LENGTH - deflection).abs()).max(of_energy));
        }
        println!("small strains: {small}: errors of the tip {errors:?} of the length");
        assert!(errors[2] < 2.5e-4 && errors.windows(2).all(|pair| pair[0] > 3.0 * pair[1]), "{small}: {errors:?}");
    }
}

/// The load F along the cable: EA eps lambda = F with eps = (lambda^2 - 1) / 2 everywhere, and EA (lambda - 1) = F for small strains.
#[test]
fn a_cable_stretches_uniformly_unless_its_end_is_kept_from_it() {
    let (force, axial) = (30.0, 100.0);
    let load = [force, 0.0, 0.0];
    let mut stretch: f64 = 1.0;
    for _ in 0..50 {
        let (f, slope) =
            (0.5 * axial * (stretch * stretch - 1.0) * stretch - force, 0.5 * axial * (3.0 * stretch * stretch - 1.0));
        stretch -= f / slope;
    }
    for (small, stretch, strain) in [(false, stretch, 0.5 * (stretch * stretch - 1.0)), (true, 1.3, 0.3)] {
        for held in [Held::Weld(HeldSlope::Direction), Held::Weld(HeldSlope::Vector), Held::Node] {
            let found = equilibrium(What::Loaded { elements: 3, small, held, load, axial });
            let off = (found[0] / LENGTH - stretch).abs();
            println!("small: {small}, {held:?}: stretch {:.6} for {stretch:.6}", found[0] / LENGTH);
            if held == Held::Weld(HeldSlope::Direction) {
                assert!(off < 1e-12 && (found[2] - strain).abs() < 1e-12, "{found:?}");
                assert!((found[5] - 0.5 * axial * strain * strain * LENGTH).abs() < 1e-10, "{found:?}");
                assert!((found[4] - 7.0 * strain).abs() < 1e-11 && found[3].abs() < 1e-12, "{found:?}");
            } else if !small {
                // a slope that keeps its length takes part of the stretch
                assert!((1e-3..0.1).contains(&off), "{held:?}: {off:.1e}");
            }
        }
    }
}

fn frequencies(supports: Supports, small: bool, count: usize) -> Vec<f64> {
    let bar = Bar(What::Vibrating { supports, small });
    let prepared = Prepared::new(&bar).expect("a sound bar");
    prepared.modes(count).expect("modes").iter().map(|mode| mode.frequency).collect()
}

/// Euler-Bernoulli: omega = (beta L)^2 sqrt(EI / (m L^4)), each twice in space.
#[test]
fn frequencies_are_those_of_euler_and_bernoulli() {
    let unit = (BENDING / (MASS * LENGTH.powi(4))).sqrt();
    // roots of sin x = 0, cos x cosh x = -1 and cos x cosh x = 1
    let cases = [
        (Supports::Simple, 0, [PI, 2.0 * PI]),
        (Supports::Clamped, 0, [1.875_104_068_711_961, 4.694_091_132_974_175]),
        (Supports::None, 5, [4.730_040_744_862_704, 7.853_204_624_095_838]),
    ];
    for small in [false, true] {
        for (supports, rigid, roots) in cases {
            let found = frequencies(supports, small, rigid + 4);
            assert!(found[..rigid].iter().all(|frequency| *frequency < 1e-3 * unit), "{supports:?}: {found:?}");
            let expected = roots.iter().flat_map(|root| [root * root * unit; 2]);
            for (found, expected) in found[rigid..].iter().zip(expected) {
                let off = found / expected - 1.0;
                println!("{supports:?}, small strains: {small}: {found:.6} rad/s, off by {off:.1e}");
                // cubic elements are too stiff by about (beta l)^4 / 720 of omega^2: 1.3e-3 for the largest root
                assert!((-1e-9..1.3e-3).contains(&off), "{supports:?}: {found} for {expected}");
            }
        }
    }
}

/// Momentum, and angular momentum about the origin, of all elements: integrals of m dr/dt and m r x dr/dt, exact by four Gauss points.
fn momenta(prepared: &Prepared, q: &[f64], v: &[f64]) -> [Vector3<f64>; 2] {
    use costate::internals::hermite_values as values;
    let (inner, outer) = ((3.0 / 7.0 - 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt(), (3.0 / 7.0 + 2.0 / 7.0 * 1.2_f64.sqrt()).sqrt());
    let weights = [(18.0 + 30.0_f64.sqrt()) / 72.0, (18.0 - 30.0_f64.sqrt()) / 72.0];
    let points = [(-inner, weights[0]), (inner, weights[0]), (-outer, weights[1]), (outer, weights[1])];
    let model = prepared.model();
    let length = LENGTH / ELEMENTS as f64;
    let mut sums = [Vector3::zeros(); 2];
    for element in model.elements.iter().filter(|element| element.name.starts_with("cable, element")) {
        let first = model.node(element.nodes[0]).dofs.start;
        let second = model.node(element.nodes[1]).dofs.start;
        for (place, weight) in points {
            let functions = values(0.5 * (1.0 + place));
            let at = |x: &[f64]| {
                let vector = |place: usize, weight: f64| Vector3::first_three(&x[place..]) * weight;
                vector(first, functions[0])
                    + vector(first + 3, functions[1] * length)
                    + vector(second, functions[2])
                    + vector(second + 3, functions[3] * length)
            };
            let share = MASS * length * weight;
            sums[0] += at(v) * share;
            sums[1] += at(q).cross(&at(v)) * share;
        }
    }
    sums
}

#[test]
fn a_thrown_cable_keeps_momentum_angular_momentum_and_energy() {
    for small in [false, true] {
        let bar = Bar(What::Thrown { small });
        let prepared = Prepared::new(&bar).expect("a sound bar");
        let numbers = &prepared.mechanism.numbers;
        let start = momenta(&prepared, &numbers.q, &numbers.v);
        let mut worst = [0.0_f64; 2];
        let mut watch = Watch(|step: &StepRecord<f64>| {
            let now = momenta(&prepared, &step.q, &step.v);
            for k in 0..2 {
                worst[k] = worst[k].max((now[k] - start[k]).length());
            }
            true
        });
        march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch).expect("it runs");
        let energies = prepared.analysis().forward(&[]).expect("it runs").values;
        let drift = (energies[1] / energies[0] - 1.0).abs();
        println!(
            "small strains: {small}: momentum {:.1e} N s, angular {:.1e} N m s, energy {drift:.1e}",
            worst[0], worst[1]
        );
        // a linear invariant to round-off; the others as exactly as the method is, with axial waves of 80 rad/s and more resolved
        assert!(worst[0] < 1e-11, "{}", worst[0]);
        assert!(worst[1] < 1e-3 * start[1].length() && drift < 1e-2, "{} of {}, {drift}", worst[1], start[1].length());
    }
}

/// Damping proportional to stiffness: the first mode fades with eta omega^2 / 2.
#[test]
fn structural_damping_takes_half_eta_omega_squared() {
    let bar = Bar(What::Damped);
    let prepared = Prepared::new(&bar).expect("a sound bar");
    let omega = frequencies(Supports::Simple, false, 1)[0];
    let decay = 0.5 * DAMPING * omega * omega;
    let period = 2.0 * PI / (omega * omega - decay * decay).sqrt();
    // whole periods: the velocity in the middle is at its peak again
    let (steps, periods) = (400, 2.0);
    let settings = Settings { end: periods * period, steps, ..Scene::settings(&bar) };
    let prepared = Prepared::with(&bar, &[], prepared.method.clone(), settings).expect("a sound bar");
    let model = prepared.model();
    let middle = model.nodes.iter().find(|node| node.name == format!("cable[{}]", ELEMENTS / 2)).expect("it has one");
    let place = middle.dofs.start + 1;
    let mut last = 0.0;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        last = step.v[place];
        true
    });
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch).expect("it runs");
    let found = -(last / 1e-4).ln() / (periods * period);
    println!("decay {found:.8} 1/s, eta omega^2 / 2 = {decay:.8} 1/s");
    // amplitudes of 1e-4 m are small, and the start is the mode but for 1e-5 of it
    assert!((found / decay - 1.0).abs() < 1e-3, "{found} against {decay}");
}

/// Everything at once: cables with exact and small strains, welded to and hinged on natural and Euler bodies, springs and dampers.
struct Everything {
    stretch: HeldSlope,
}

impl Scene for Everything {
    fn name(&self) -> String {
        "everything".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [
            ("length", 0.8, "m"),
            ("E", 2e6, "N/m2"),
            ("width", 0.05, "m"),
            ("density", 900.0, "kg/m3"),
            ("mass", 1.2, "kg"),
            ("stiffness", 40.0, "N/m"),
            ("damping", 0.01, "s"),
            ("spin", 1.5, "rad/s"),
        ]
        .map(|(name, value, unit)| DesignVariable::new(name, value, (0.0, 1e9), unit))
        .to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.2, 60)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [length, young, width, density, mass, stiffness, damping, spin] = x else {
            return Err("8 variables expected".into());
        };
        let (along, up) = (vector([0.6, 0.0, 0.8]), vector([0.0, 1.0, 0.0]));
        let at = |k: f64| along * (*length * k);
        let material = Material { young: *young, poisson: S::from(0.3), density: *density };
        let section = CableSection::of(material, Shape::rectangle(*width, *width, material.poisson));
        let ground = m.ground();
        let first = m.cable("first", CableLine::straight([at(0.0), at(1.0)], 2), &section.damped(*damping));
        let block = m.natural_body("block", at(1.1), Quaternion::about(up, S::from(0.3)));
        let second = m.cable("second", CableLine::straight([at(1.2), at(2.2)], 2), &section.small_strains());
        let weight = m.body("weight", at(2.3), Quaternion::about(along, S::from(0.5)));
        let tensor = [0.01, 0.012, 0.013, 0.001, 0.0, -0.001];
        for (name, node) in [("block", block), ("weight", weight)] {
            m.rigid_body(name, node, *mass, vector([0.01, 0.0, 0.02]), tensor.map(|entry| *mass * entry));
        }
        let all: Vec<_> = first.nodes.iter().chain(&second.nodes).copied().chain([block, weight]).collect();
        m.set_rigid_motion(&all, Vector3::zeros(), Vector3::zeros(), up * *spin);
        m.cable_hinge("hinge", [ground, first.start()], up);
        m.cable_weld("weld", [block, first.end()], self.stretch);
        m.cable_weld("other weld", [block, second.start()], HeldSlope::Direction);
        m.spherical("ball", [weight, second.end()], at(2.2));
        let outside = vector([1.0, -0.5, 0.2]);
        m.line_spring("spring", [ground, second.nodes[1]], [outside, at(1.7)], *stiffness, S::from(0.4));
        m.vector_damper("damper", [block, weight], [at(1.1), at(2.3)], S::from(0.8));
        m.line_damper("line damper", [first.nodes[1], weight], [at(0.5), at(2.3) + up], S::from(0.8));
        m.gravity(vector([0.0, 0.0, -9.81]));
        m.target_functional("path", Over::Integral, weight, at(2.4), Vector3::zeros());
        m.velocity_functional("speed", Over::Terminal, second.end(), m.position(second.end()), along);
        m.energy_functional("energy", Over::Terminal);
        m.mass_functional("mass", Over::Initial);
        m.cable_strain_functional("strain", Over::Integral, &first, 0.5, CableMeasure::Strain);
        m.cable_strain_functional("curvature", Over::Terminal, &second, 0.3, CableMeasure::Curvature);
        m.cable_stress_functional("stress", Over::Integral, (&first, 0.8), *young, *width * 0.5);
        let sharpness = Over::smooth_maximum(1e-3);
        m.cable_stress_functional("largest stress", sharpness, (&second, 0.5), *young, *width * -0.5);
        m.cable_deflection_functional("deflection", Over::Terminal, [first.start(), second.end()], up);
        m.largest_cable_stress_functional("largest stress anywhere", &second, *young, *width * 0.5, 1e-3);
        m.largest_cable_stress_functional("largest stress of the first", &first, *young, *width * 0.5, 1e-3);
        let points = [at(1.1), at(2.2)];
        m.distance_functional("distance", Over::Integral, [block, second.end()], points);
        Ok(())
    }
}

#[test]
fn gradients_equal_complex_steps() {
    for stretch in [HeldSlope::Direction, HeldSlope::Vector] {
        let scene = Everything { stretch };
        let x: Vec<f64> = Scene::variables(&scene).iter().map(|variable| variable.initial).collect();
        for level in ConstraintLevel::ALL {
            let method = Method::new(Prepared::default_method().table, level);
            let prepared = Prepared::with(&scene, &x, method, Scene::settings(&scene)).expect("a sound scene");
            let analysis = prepared.analysis();
            let forward = analysis.forward(&x).unwrap_or_else(|error| panic!("{}: {error}", level.name()));
            let exact = analysis.complex_step(&x, &forward).expect("it runs");
            let adjoint = analysis.adjoint(&x, &forward).expect("adjoint");
            // at position level round-off of the multipliers is divided by h^2
            let limit = if level == ConstraintLevel::Position { 1e-9 } else { 1e-12 };
            let names = prepared.functionals().iter().map(|functional| &functional.name);
            for ((own, exact), name) in adjoint.rows.iter().zip(&exact.rows).zip(names) {
                let difference = largest_difference(exact, own);
                println!("{stretch:?}, {}, {name}: {difference:.1e}", level.name());
                assert!(difference < limit, "{stretch:?}, {}, {name}: {difference:.1e}", level.name());
            }
        }
    }
}

/// Two cables at a right angle.
struct Corner {
    /// Mass of a body to which both are welded; without a body they are welded to each other.
    body: Option<f64>,
}

impl Scene for Corner {
    fn name(&self) -> String {
        "corner".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("length", 1.0, (0.1, 10.0), "m"), DesignVariable::new("EI", 2.0, (0.1, 10.0), "N m2")]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.3, 150)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let (corner, tip) = (vector([1.0, 0.0, 0.0]) * x[0], vector([1.0, 0.5, 0.0]) * x[0]);
        let section = CableSection::new(S::from(2e3), x[1], S::from(0.4));
        let first = m.cable("first", CableLine::straight([Vector3::zeros(), corner], 2).clamped_start(), &section);
        let second = m.cable("second", CableLine::straight([corner, tip], 2), &section);
        if let Some(mass) = self.body {
            let joint = m.natural_body("corner", corner, Quaternion::identity());
            if mass > 0.0 {
                let inertia = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0].map(|entry| S::from(entry * mass));
                m.rigid_body("corner", joint, S::from(mass), Vector3::zeros(), inertia);
            }
            m.cable_weld("before", [joint, first.end()], HeldSlope::Direction);
            m.cable_weld("behind", [joint, second.start()], HeldSlope::Direction);
        } else {
            m.cable_corner("corner", [first.end(), second.start()]);
        }
        m.gravity(vector([0.0, -1.0, -2.0]));
        for (name, axis) in [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])] {
            m.position_functional(name, Over::Terminal, second.end(), m.position(second.end()), vector(axis));
        }
        Ok(())
    }
}

#[test]
fn cables_meet_in_a_corner_without_inertia() {
    let runs = [None, Some(0.0), Some(1e-9)].map(|body| {
        let scene = Corner { body };
        let x: Vec<f64> = Scene::variables(&scene).iter().map(|variable| variable.initial).collect();
        let prepared = Prepared::new(&scene).expect("a sound scene");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&x).expect("it runs");
        let (exact, adjoint) =
            (analysis.complex_step(&x, &forward).expect("runs"), analysis.adjoint(&x, &forward).expect("runs"));
        for (own, exact) in adjoint.rows.iter().zip(&exact.rows) {
            assert!(largest_difference(exact, own) < 1e-12, "{own:?} {exact:?}");
        }
        forward.values
    });
    // a weld to each other is what a body without inertia does
    assert!(largest_difference(&runs[0], &runs[1]) < 1e-10, "{runs:?}");
    // with the mass of the cables at 0.6 kg
    assert!(largest_difference(&runs[0], &runs[2]) < 1e-7, "{runs:?}");
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    NoElements,
    NoLength,
    DampedSmall,
    BodyAtEnd,
    Bent,
    Gap,
    SkewHinge,
    Swapped,
    PlaneWeld,
    StraightCorner,
    CornerWithBody,
    Share,
    StressWithoutYoung,
}

struct Mistaken(Option<Mistake>);

impl Scene for Mistaken {
    fn name(&self) -> String {
        "mistaken".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 10)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        use Mistake::*;
        let point = |x: f64, y: f64| vector::<S>([x, y, 0.0]);
        let is = |mistake: Mistake| self.0 == Some(mistake);
        let own = section(AXIAL, false);
        let first = m.cable("first", CableLine::straight([point(0.0, 0.0), point(1.0, 0.0)], 1), &own);
        let to = if is(Bent) {
            point(1.0, 1.0)
        } else if is(NoLength) {
            point(1.0, 0.0)
        } else {
            point(2.0, 0.0)
        };
        let from = if is(Gap) { point(1.2, 0.0) } else { point(1.0, 0.0) };
        let elements = if is(NoElements) { 0 } else { 2 };
        let block = m.natural_body("block", point(1.0, 0.0), Quaternion::identity());
        m.rigid_body("block", block, S::one(), Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0].map(S::from));
        let line = CableLine::straight([from, to], elements).from_node(if is(BodyAtEnd) { block } else { first.end() });
        let own = if is(DampedSmall) { own.damped(S::one()).small_strains() } else { own };
        let second = m.cable("second", line, &own);
        m.gravity(point(0.0, -1.0));
        let ground = m.ground();
        let axis = if is(SkewHinge) { point(1.0, 1.0) } else { point(0.0, 1.0) };
        m.cable_hinge("hinge", [ground, first.start()], axis);
        let nodes = if is(Swapped) { [first.end(), block] } else { [block, first.end()] };
        m.cable_weld("weld", nodes, if is(PlaneWeld) { HeldSlope::Plane } else { HeldSlope::Direction });
        if is(StraightCorner) || is(CornerWithBody) {
            m.cable_corner("corner", [first.start(), if is(CornerWithBody) { block } else { second.end() }]);
        }
        let share = if is(Share) { 1.5 } else { 0.5 };
        let measure = if is(StressWithoutYoung) { CableMeasure::Stress } else { CableMeasure::Strain };
        m.cable_strain_functional("read", Over::Terminal, &second, share, measure);
        Ok(())
    }
}

#[test]
fn mistakes_about_cables_are_named() {
    use Mistake::*;
    Prepared::new(&Mistaken(None)).expect("nothing is wrong");
    let cases: [(Mistake, &[&str]); 13] = [
        (NoElements, &["\"second\" has 0 elements", "one element or more"]),
        (NoLength, &["\"second\"", "on a line of 0 m", "ends that lie apart"]),
        (DampedSmall, &["\"second\" asks for damping", "take the exact strains"]),
        (BodyAtEnd, &["\"second\" ends in \"block\"", "no node of a cable", "a joint"]),
        (Bent, &["\"second\" meets its node \"first[1]\"", "differs by 1.414e0", "one direction"]),
        (Gap, &["\"second\" meets its node", "a distance of 2.000e-1 m"]),
        (SkewHinge, &["the axis of \"hinge\" is at 45", "must be at 90"]),
        (Swapped, &["\"weld\" needs a body", "\"weld\" needs a cable's node as the second, but \"block\"", "body first"]),
        (PlaneWeld, &["\"weld\"", "take cable_hinge"]),
        (StraightCorner, &["\"corner\" joins cables at 0.000 degrees", "share a node"]),
        (CornerWithBody, &["\"corner\" needs nodes of two cables", "\"first[0]\" and \"block\"", "cable_weld"]),
        (Share, &["\"read\" asks for 1.5 of the length of \"second\"", "0 to 1"]),
        (StressWithoutYoung, &["\"read\"", "cable_stress_functional"]),
    ];
    for (mistake, parts) in cases {
        let message = match Prepared::new(&Mistaken(Some(mistake))) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("{mistake:?} went unnoticed"),
        };
        for part in parts {
            assert!(message.contains(part), "{mistake:?}: \"{part}\" is missing in: {message}");
        }
    }
}

/// One run with few steps: sound scenes, finite numbers, exact gradients.
#[test]
fn the_scenes_of_the_paper_run_and_have_exact_gradients() {
    for (name, changes) in [("flexible-pendulum", ""), ("rigid-spring-beam", ""), ("suspension", "define.elements = 1")] {
        let scene = &built_in::changed(name, changes).expect("sound");
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let steps = if x.len() > 10 { 20 } else { 100 };
        let settings = Settings { end: 0.2, steps, ..scene.settings().without_method() };
        let mut prepared = Prepared::with(scene, &x, Prepared::default_method(), settings).expect("a sound scene");
        // stresses of steel are E = 2e11 N/m2 times strains that end in 1e-16: no twelve digits of them exist
        prepared.mechanism.functionals.retain(|functional| !functional.name.contains("stress in beam"));
        let analysis = prepared.analysis();
        let forward = analysis.forward(&x).expect("it runs");
        let (exact, adjoint) =
            (analysis.complex_step(&x, &forward).expect("runs"), analysis.adjoint(&x, &forward).expect("runs"));
        // a strain of 1e-16 is a force of 1e-9 N in the stiff beam, on which loads of 10 N act: round-off of the motion itself
        let limits = prepared.gradient_limits(1e-12).expect("complex steps nearby");
        for ((own, exact), limit) in adjoint.rows.iter().zip(&exact.rows).zip(limits) {
            let difference = largest_difference(exact, own);
            println!("{}: {difference:.1e}", scene.name());
            assert!(difference < limit, "{}: {difference:.1e}\n{own:?}\n{exact:?}", scene.name());
        }
    }
}
