//! Beams against closed forms: momentum, section forces, offsets, bodies at their ends, loads, damping; what a user may get wrong.

use costate::elements::flexible::Section;
use costate::elements::forces::LoadFrame;
use costate::elements::{Field, Flexible, Interpolation};
use costate::functionals::quantities::SectionMeasure;
use costate::history::Watch;
use costate::integrators::StepRecord;
use costate::internals::{AppliedForce, AppliedTorque, STRAINS, TWO, march, table_named};
use costate::prelude::*;
use costate::scalar::{COMPLEX_STEP, Complex64};
use costate::scenes::{AnyScene, BeamLine, BeamMember, NodeId, built_in};
use costate::sensitivity::largest_difference;
use std::fs;
use std::ops::Range;
use std::process::Command;

/// What is built.
#[derive(Clone, Copy)]
enum What {
    /// A cantilever of [`STIFF`] under small loads at its tip and along it: section forces at [`SHARES`].
    Determinate,
    /// A soft cantilever that a dead load at its tip bends far, with this number of elements: section forces at all tying points.
    Bent(usize),
    /// A tapered bar that hangs: its normal force at [`SHARES`], the place of its tip, its mass.
    Hanging,
    /// A bar whose line lies in its centroid or beside it, free of loads or bent by its weight and a force at its centroid.
    Beside { elements: usize, offset: [f64; 2], loaded: bool },
    /// Two equal free bodies on a bar without noticeable mass.
    Dumbbell,
    /// A cantilever under a load along it that grows, given by the beam's own element or by forces at its nodes.
    Loaded { elements: usize, frame: LoadFrame, at_nodes: bool },
    /// A cantilever with structural damping.
    Damped,
}

struct Bar(What);

/// Length of most bars [m].
const LENGTH: f64 = 2.0;
/// Elements of the bars whose section forces are known.
const ELEMENTS: usize = 3;
/// Every stiffness of the cantilever under small loads [N, N m2].
const STIFF: f64 = 1e8;
/// Force and moment at its tip [N, N m], and load along it [N/m].
const TIP: [[f64; 3]; 2] = [[3.0, -2.0, 1.5], [0.7, -0.4, 0.9]];
const ALONG: [f64; 3] = [0.8, 0.5, -1.2];
/// Both ends, between two elements, tying points of two elements, and anywhere.
const SHARES: [f64; 9] = [
    0.0,
    1.0,
    1.0 / 3.0,
    0.5 * (1.0 + TWO[0]) / 3.0,
    0.5 * (1.0 + TWO[1]) / 3.0,
    (2.5 + 0.5 * TWO[0]) / 3.0,
    0.1,
    0.5,
    0.87,
];
/// Dead load of the bent cantilever, of size 5 N.
const BENDING_LOAD: [f64; 3] = [0.0, 4.0, 3.0];
/// Hanging bar: stiffness [N] and mass [kg/m] at its upper end, both falling to 0.4 of it; weight [m/s2].
const HANGING: [f64; 2] = [2e3, 3.0];
const GRAVITY: f64 = 9.81;
/// Mass and inertia of the bodies, stiffnesses EA, GA2, GA3, GJ, EI2, EI3 between them.
const BODY: [f64; 2] = [2.0, 0.4];
const BETWEEN: [f64; STRAINS] = [5e4, 3e4, 3e4, 700.0, 900.0, 1300.0];
/// Damping of the cantilever [s].
const DAMPING: f64 = 0.011;

fn axis<S: Scalar>(i: usize) -> Vector3<S> {
    Vector3::from(std::array::from_fn(|k| S::from(if k == i { 1.0 } else { 0.0 })))
}

/// All components of the section force at a share.
fn section_forces<S: Scalar>(m: &mut MechanismBuilder<S>, beam: &BeamMember, share: f64) {
    for component in 0..STRAINS {
        let name = format!("force {component} at {share}");
        m.section_functional(&name, Over::Terminal, beam, share, SectionMeasure::Force(component));
    }
}

/// A force that grows with the load factor or time.
fn growing_force<S: Scalar>(
    m: &mut MechanismBuilder<S>,
    name: &str,
    node: NodeId,
    (frame, force): (LoadFrame, [f64; 3]),
    point: Vector3<S>,
) {
    let p =
        [force.map(S::from).to_vec(), m.local_point(node, point).components().to_vec(), vec![S::zero(), S::one()]].concat();
    m.element(name, &[node], AppliedForce { on: NodeKind::Body, frame, size: TimeFunction::ConstantRate }, &p);
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
            What::Dumbbell | What::Damped => Settings::new(1.0, 10),
            What::Determinate | What::Hanging => Settings::statics(1),
            What::Loaded { .. } => Settings::statics(20),
            _ => Settings::statics(8),
        }
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let number = |value: f64| S::from(value);
        let along = |length: f64| axis::<S>(0) * S::from(length);
        let cantilever = |length: f64, elements: usize| {
            BeamLine::straight([Vector3::zeros(), along(length)], elements, axis(1)).clamped_start()
        };
        match self.0 {
            What::Determinate => {
                let beam = m.beam("beam", cantilever(LENGTH, ELEMENTS), &Section::new([number(STIFF); STRAINS]));
                growing_force(m, "force", beam.end(), (LoadFrame::World, TIP[0]), along(LENGTH));
                let moment = AppliedTorque { on: NodeKind::Body, frame: LoadFrame::World, size: TimeFunction::Constant };
                m.element("moment", &[beam.end()], moment, &[&TIP[1].map(S::from)[..], &[S::one()]].concat());
                let direction = (LoadFrame::World, Vector3::from_f64(ALONG));
                m.distributed_load("load", &beam, direction, Signal::Constant(S::one()));
                SHARES.iter().for_each(|&share| section_forces(m, &beam, share));
            }
            What::Bent(elements) => {
                let section = Section::new([50.0, 20.0, 20.0, 0.8, 1.0, 1.5].map(S::from));
                let beam = m.beam("beam", cantilever(1.0, elements), &section);
                growing_force(m, "force", beam.end(), (LoadFrame::World, BENDING_LOAD), along(1.0));
                for element in 0..elements {
                    for xi in TWO {
                        section_forces(m, &beam, (element as f64 + 0.5 * (1.0 + xi)) / elements as f64);
                    }
                }
            }
            What::Hanging => {
                let down = Vector3::from_f64([0.0, 0.0, -LENGTH]);
                let line = BeamLine::straight([Vector3::zeros(), down], ELEMENTS, axis(1)).clamped_start();
                let beam = m.tapered_beam("bar", line, |share| {
                    let [stiffness, mass] = HANGING.map(|number| S::from(number * (1.0 - 0.6 * share)));
                    Section::new([stiffness; STRAINS]).with_inertia(mass, [number(1e-3); 2])
                });
                m.gravity(Vector3::from_f64([0.0, 0.0, -GRAVITY]));
                for share in SHARES {
                    let name = format!("normal force at {share}");
                    m.section_functional(&name, Over::Terminal, &beam, share, SectionMeasure::Force(0));
                }
                m.position_functional("tip", Over::Terminal, beam.end(), down, axis(2));
                m.mass_functional("mass", Over::Terminal);
            }
            What::Beside { elements, offset: [x2, x3], loaded } => {
                let section = Section::new([1e3, 400.0, 300.0, 6.0, 8.0, 5.0].map(S::from));
                let mut section = section.with_inertia(number(1.2), [2e-3, 3e-3].map(S::from));
                if [x2, x3] != [0.0; 2] {
                    section = section.offset([x2, x3].map(S::from));
                }
                let beside = Vector3::from_f64([0.0, -x2, -x3]);
                let line = BeamLine::straight([beside, along(1.0) + beside], elements, axis(1)).clamped_start();
                let beam = m.beam("beam", line, &section);
                if loaded {
                    m.gravity(Vector3::from_f64([0.0, 1.0, -2.0]));
                    growing_force(m, "force", beam.end(), (LoadFrame::World, [-1.0, 3.0, 6.0]), along(1.0));
                }
                for i in 0..3 {
                    m.position_functional(&format!("{i} of the tip"), Over::Terminal, beam.end(), along(1.0), axis(i));
                }
            }
            What::Dumbbell => {
                // the frames of the bodies lie askew to the bar
                let turn = Quaternion::about(Vector3::from_f64([1.0, 2.0, -1.0]).unit(), number(0.7));
                let ends = [Vector3::from_f64([0.3, -0.2, 0.5]), Vector3::from_f64([0.3, 1.0, 2.1])];
                let [mass, inertia] = BODY.map(S::from);
                let nodes = [("left", ends[0]), ("right", ends[1])].map(|(name, place)| {
                    let node = m.body(name, place, turn);
                    let zero = S::zero();
                    m.rigid_body(name, node, mass, Vector3::zeros(), [inertia, inertia, inertia, zero, zero, zero]);
                    node
                });
                let section = Section::new(BETWEEN.map(S::from)).with_inertia(number(1e-8), [number(1e-9); 2]);
                m.beam("bar", BeamLine::straight(ends, 2, axis(0)).from_node(nodes[0]).to_node(nodes[1]), &section);
            }
            What::Loaded { elements, frame, at_nodes } => {
                let section = Section::new([100.0, 40.0, 40.0, 1.0, 1.0, 1.0].map(S::from));
                let beam = m.beam("beam", cantilever(1.0, elements), &section);
                let direction = [0.0, 4.0, 1.0];
                if at_nodes {
                    let h = 1.0 / elements as f64;
                    for (i, &node) in beam.nodes.iter().enumerate().skip(1) {
                        // Simpson's weights
                        let weight = if i % 2 == 1 {
                            4.0
                        } else if i == 2 * elements {
                            1.0
                        } else {
                            2.0
                        };
                        let force = direction.map(|d| d * weight * h / 6.0);
                        let place = m.position(node);
                        growing_force(m, &format!("force {i}"), node, (frame, force), place);
                    }
                } else {
                    let size = Signal::ConstantRate { offset: S::zero(), rate: S::one() };
                    m.distributed_load("load", &beam, (frame, Vector3::from_f64(direction)), size);
                }
                for i in 0..3 {
                    m.position_functional(&format!("{i} of the tip"), Over::Terminal, beam.end(), along(1.0), axis(i));
                }
            }
            What::Damped => {
                let section = Section::new([1e3, 400.0, 400.0, 1.0, 1.0, 3.0].map(S::from));
                let section = section.with_inertia(S::one(), [number(1e-3); 2]).damped(number(DAMPING));
                m.beam("beam", cantilever(1.0, 4), &section);
            }
        }
        Ok(())
    }
}

/// All functionals of a scene at its initial design.
fn values(scene: &dyn AnyScene) -> Vec<f64> {
    let prepared = Prepared::new(scene).expect("a sound scene");
    prepared.analysis().values(&prepared.x).expect("it runs")
}

/// `exact` at the tying points of the elements, and linear between and beyond them; between two elements the mean of both.
fn by_tying_points(share: f64, exact: impl Fn(f64) -> f64) -> f64 {
    let place = share * ELEMENTS as f64;
    let beside = |element: f64| {
        let [first, second] = TWO.map(|xi| (element + 0.5 * (1.0 + xi)) / ELEMENTS as f64);
        exact(first) + (exact(second) - exact(first)) * (share - first) / (second - first)
    };
    let (below, above) = ((place - 1e-9).floor(), (place + 1e-9).floor());
    0.5 * (beside(below.max(0.0)) + beside(above.min(ELEMENTS as f64 - 1.0)))
}

/// Momentum [N s], angular momentum about the origin [N m s] and energy [J] of all beams, from the kinetic energy of their elements:
/// dT along the velocities of a rigid motion.
fn invariants(prepared: &Prepared, q: &[f64], v: &[f64]) -> [f64; 7] {
    let (model, p) = (prepared.model(), &prepared.mechanism.numbers.p);
    let mut totals = [0.0; 7];
    for element in model.elements.iter().filter(|element| element.name.contains(", element ")) {
        let mut own_q: Vec<f64> = Vec::new();
        let mut own_v: Vec<f64> = Vec::new();
        let mut rigid: [Vec<f64>; 6] = Default::default();
        for node in &element.nodes {
            let dofs = model.node(*node).dofs.clone();
            let (place, e) = (Vector3::first_three(&q[dofs.start..]), Quaternion::from_slice(&q[dofs.start + 3..]));
            for i in 0..3 {
                rigid[i].extend(axis::<f64>(i).components().into_iter().chain([0.0; 4]));
                let turning = e.rate_of_body_velocity(e.rotate_back(axis(i)));
                rigid[3 + i].extend(axis::<f64>(i).cross(&place).components().into_iter().chain(turning));
            }
            own_q.extend_from_slice(&q[dofs.clone()]);
            own_v.extend_from_slice(&v[dofs]);
        }
        let own_p = &p[element.parameters.clone()];
        let lift = |x: &[f64]| -> Vec<Complex64> { x.iter().map(|&x| Complex64::from(x)).collect() };
        let (complex_q, complex_p) = (lift(&own_q), lift(own_p));
        for (total, direction) in totals.iter_mut().zip(&rigid) {
            let moved: Vec<Complex64> =
                own_v.iter().zip(direction).map(|(&v, &d)| Complex64::new(v, d * COMPLEX_STEP)).collect();
            *total += element.physics.energies_at(&moved, &complex_q, &complex_p)[0].im / COMPLEX_STEP;
        }
        totals[6] += element.physics.energies_at(&own_v, &own_q, own_p)[..2].iter().sum::<f64>();
    }
    totals
}

#[test]
fn a_free_rod_keeps_the_momentum_that_its_load_gave_it() {
    let settings = Settings::new(7.0, 700);
    let scene = built_in::named("flying-rod").expect("built in");
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let prepared = Prepared::with(scene, &x, Prepared::default_method(), settings).expect("a sound scene");
    let mut course = Vec::new();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        course.push((step.t + step.h, invariants(&prepared, &step.q, &step.v)));
        true
    });
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch).expect("it runs");
    // the force rises to 20 N at 2.5 s and is gone at 5 s: straight lines, which the method integrates exactly
    let impulse = |t: f64| if t < 2.5 { 4.0 * t * t } else { 50.0 - 4.0 * (5.0 - t.min(5.0)).powi(2) };
    let missing = course.iter().flat_map(|(t, own)| [own[0] - impulse(*t), own[1], own[2]]);
    let worst = missing.fold(0.0, |worst: f64, miss| worst.max(miss.abs()));
    println!("momentum: largest error {worst:.1e} N s");
    // a linear invariant: what is left is round-off of the sum over 700 steps
    assert!(worst < 1e-12, "momentum: {worst:.1e} N s");
    let free: Vec<&[f64; 7]> = course.iter().filter(|(t, _)| *t >= 5.0 - 1e-9).map(|(_, own)| own).collect();
    let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (angular, energy) = (norm(&free[0][3..6]), free[0][6]);
    let turned = free.iter().map(|own| norm(&[own[3] - free[0][3], own[4] - free[0][4], own[5] - free[0][5]]) / angular);
    let turned = turned.fold(0.0, f64::max);
    let lost = free.iter().map(|own| (own[6] / energy - 1.0).abs()).fold(0.0, f64::max);
    println!("angular momentum {angular:.6} N m s, largest change {turned:.1e}; energy {energy:.6} J, {lost:.1e}");
    // quadratic, which the method keeps to its order 4: (0.01 s times some 1 rad/s)^4 for the slow motions that hold the energy
    assert!(free.len() > 190 && turned < 1e-7 && lost < 1e-7, "angular momentum {turned:.1e}, energy {lost:.1e}");
}

#[test]
fn section_forces_of_a_cantilever_balance_its_loads() {
    let found = values(&Bar(What::Determinate));
    let (force, moment, load) = (Vector3::from(TIP[0]), Vector3::from(TIP[1]), Vector3::from(ALONG));
    for (share, found) in SHARES.into_iter().zip(found.chunks(STRAINS)) {
        for component in 0..STRAINS {
            let exact = |share: f64| {
                let rest = LENGTH * (1.0 - share);
                let of_load = axis::<f64>(0).cross(&load) * (0.5 * rest * rest);
                let moment = moment + axis::<f64>(0).cross(&force) * rest + of_load;
                let force = force + load * rest;
                if component < 3 { force[component] } else { moment[component - 3] }
            };
            let expected = by_tying_points(share, exact);
            // angles of 1e-7 rad turn forces of some newtons, and strains of 1e-8 have lost their last eight digits
            let error = (found[component] - expected).abs();
            assert!(error < 2e-6, "component {component} at {share}: {} against {expected}", found[component]);
        }
    }
}

#[test]
fn at_tying_points_the_section_force_of_a_bent_cantilever_has_the_size_of_the_load() {
    let found = values(&Bar(What::Bent(3)));
    let moments: Vec<f64> = found.chunks(STRAINS).map(|own| own[3..].iter().map(|m| m * m).sum::<f64>().sqrt()).collect();
    for own in found.chunks(STRAINS) {
        let size = own[..3].iter().map(|n| n * n).sum::<f64>().sqrt();
        // the sum of the elements' nodal forces says so whatever the mesh
        assert!((size - 5.0).abs() < 1e-9, "{size} N");
    }
    assert!(moments.windows(2).all(|pair| pair[0] > pair[1]) && moments[0] > 2.0, "bent far: {moments:?}");
}

#[test]
fn a_beam_in_steady_rotation_is_longer_by_its_centrifugal_force() {
    let scene = built_in::named("spin-up-beam").expect("built in");
    let settings = Settings { steps: 1000, ..scene.settings() };
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let prepared = Prepared::with(scene, &x, Prepared::default_method(), settings).expect("a sound scene");
    let found = prepared.analysis().values(&x).expect("it runs");
    let (stiffness, mass, length, rate) = (2.8e7, 1.2, 10.0, 6.0_f64);
    let first_order = mass * rate * rate * f64::powi(length, 3) / (3.0 * stiffness);
    let extension = found[0].sqrt() - length;
    println!("extension {extension:.6e} m, first order {first_order:.6e} m; normal force {:.4} N", found[1]);
    // the next order is rho A omega^2 L^2 / EA = 1.5e-4 of it, and the bending that is left shortens the beam
    assert!((extension / first_order - 1.0).abs() < 2e-3, "{extension:e} m against {first_order:e} m");
    let force = 0.5 * mass * rate * rate * length * length;
    assert!((found[1] / force - 1.0).abs() < 5e-3, "{} N against {force} N", found[1]);
}

#[test]
fn a_tapered_bar_carries_and_stretches_by_its_own_weight() {
    let found = values(&Bar(What::Hanging));
    let [stiffness, mass] = HANGING;
    // g times the mass below: exact at the tying points
    let force = |share: f64| GRAVITY * mass * LENGTH * ((1.0 - share) - 0.3 * (1.0 - share * share));
    for (share, found) in SHARES.into_iter().zip(&found) {
        let expected = by_tying_points(share, force);
        assert!((found - expected).abs() < 1e-10, "{found} N against {expected} N at {share}");
    }
    let strain = |share: f64| force(share) / (stiffness * (1.0 - 0.6 * share));
    let intervals = 2000;
    let simpson = |i: usize| {
        (if i == 0 || i == intervals { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 }) * strain(i as f64 / intervals as f64)
    };
    let stretch = LENGTH / (3.0 * intervals as f64) * (0..=intervals).map(simpson).sum::<f64>();
    let tip = -found[SHARES.len()] - LENGTH;
    println!("tapered bar: stretch {tip:.8} m, integral {stretch:.8} m");
    // two points in each of three elements integrate N / EA with h^4 / 4320 of its fourth derivative
    assert!((tip / stretch - 1.0).abs() < 1e-4, "{tip} m against {stretch} m");
    assert!((found[SHARES.len() + 1] - mass * LENGTH * 0.7).abs() < 1e-14);
}

#[test]
fn a_bar_whose_line_lies_beside_its_centroid_bends_like_the_bar_itself() {
    let offset = [0.15, -0.1];
    let difference = |elements: usize| {
        let [own, moved] = [[0.0; 2], offset].map(|offset| values(&Bar(What::Beside { elements, offset, loaded: true })));
        let away = (0..3).map(|i| (own[i] - f64::from(u8::from(i == 0))).abs()).fold(0.0, f64::max);
        assert!(away > 0.2, "bent far: {own:?}");
        (0..3).map(|i| (own[i] - moved[i]).abs()).fold(0.0, f64::max)
    };
    // both lines are interpolated by quadratics and have errors of their own, of order 4
    let [coarse, fine] = [4, 8].map(difference);
    println!("line beside the centroid: {coarse:.2e} m with 4 elements, {fine:.2e} m with 8");
    assert!(fine < 1e-4 && ((coarse / fine).log2() - 4.0).abs() < 0.5, "{coarse:e} m, {fine:e} m");
    // small vibrations about the straight bar see no interpolated rotation: the same to round-off of the eigenvalues
    let [own, moved] = [[0.0; 2], offset].map(|offset| {
        let scene = Bar(What::Beside { elements: 4, offset, loaded: false });
        let settings = Settings::new(1.0, 1);
        let prepared = Prepared::with(&scene, &[], Prepared::default_method(), settings).expect("a sound scene");
        prepared.modes(6).expect("modes").into_iter().map(|mode| mode.frequency).collect::<Vec<_>>()
    });
    for (own, moved) in own.iter().zip(&moved) {
        assert!((moved / own - 1.0).abs() < 1e-8, "{moved} rad/s against {own} rad/s");
    }
}

#[test]
fn a_bar_between_two_bodies_is_their_spring() {
    let scene = Bar(What::Dumbbell);
    let modes = Prepared::new(&scene).expect("a sound scene").modes(12).expect("modes");
    let [mass, inertia] = BODY;
    let [axial, _, _, torsion, second, third] = BETWEEN;
    // half the bar for each body, since both move against each other
    for (name, stiffness, own) in [
        ("axial", axial, mass),
        ("torsion", torsion, inertia),
        ("about axis 2", second, inertia),
        ("about axis 3", third, inertia),
    ] {
        let expected = (2.0 * stiffness / (LENGTH * own)).sqrt();
        let nearest = modes.iter().map(|mode| (mode.frequency / expected - 1.0).abs()).fold(f64::INFINITY, f64::min);
        // the bar has 1e-8 of the mass of the bodies
        assert!(
            nearest < 1e-7,
            "{name}: {expected} rad/s is missing among {:?}",
            modes.iter().map(|mode| mode.frequency).collect::<Vec<_>>()
        );
    }
    assert!(modes[..6].iter().all(|mode| mode.frequency < 1e-4 * modes[6].frequency), "six rigid motions");
}

#[test]
fn a_load_along_a_beam_does_what_forces_at_its_nodes_do() {
    let tip = |elements, frame, at_nodes| values(&Bar(What::Loaded { elements, frame, at_nodes }));
    let difference = |elements, frame| {
        let [along, at_nodes] = [false, true].map(|at_nodes| tip(elements, frame, at_nodes));
        assert!(along[1] > 0.3, "bent far: {along:?}");
        along.iter().zip(&at_nodes).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    // a dead load meets shape functions alone, which Simpson's rule integrates exactly
    let dead = difference(4, LoadFrame::World);
    assert!(dead < 1e-11, "{dead:e} m");
    // a follower load turns with the sections between nodes too: Simpson's rule has order 4
    let [coarse, fine] = [4, 8].map(|elements| difference(elements, LoadFrame::Body));
    println!("follower load: {coarse:.2e} m with 4 elements, {fine:.2e} m with 8");
    assert!(fine > 0.0 && ((coarse / fine).log2() - 4.0).abs() < 0.5, "{coarse:e} m, {fine:e} m");
}

#[test]
fn structural_damping_lets_a_mode_decay_with_eta_omega_squared_by_two() {
    let scene = Bar(What::Damped);
    let first = Prepared::new(&scene).expect("a sound scene").modes(1).expect("a mode").remove(0);
    let decay = 0.5 * DAMPING * first.frequency * first.frequency;
    let damped = (first.frequency * first.frequency - decay * decay).sqrt();
    // after whole periods the velocity has its shape again
    let end = 4.0 * 2.0 * std::f64::consts::PI / damped;
    let settings = Settings::new(end, 400);
    let mut prepared = Prepared::with(&scene, &[], Prepared::default_method(), settings).expect("a sound scene");
    prepared.mechanism.numbers.v = first.shape.iter().map(|x| 1e-4 * x).collect();
    let tip =
        first.shape.iter().position(|x| *x == first.shape.iter().fold(0.0, |a: f64, x| a.max(*x))).expect("a largest one");
    let mut last = 0.0;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        last = step.v[tip];
        true
    });
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch).expect("it runs");
    let found = -(last / prepared.mechanism.numbers.v[tip]).ln() / end;
    println!("decay {found:.8} 1/s, eta omega^2 / 2 = {decay:.8} 1/s");
    // angles of 1e-4 rad are small, and order 4 with 100 steps each period
    assert!((found / decay - 1.0).abs() < 1e-5, "{found} 1/s against {decay} 1/s");
}

#[test]
fn a_run_writes_a_column_for_each_output_of_a_section() {
    let folder = std::env::temp_dir().join(format!("costate-beams-{}", std::process::id()));
    let output = Command::new(env!("CARGO_BIN_EXE_costate"))
        .args(["run", "princeton-beam", "--json", "--out"])
        .arg(&folder)
        .output()
        .expect("the program");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(folder.join("histories.csv")).expect("histories");
    fs::remove_dir_all(&folder).expect("the folder of this test");
    let mut lines = text.lines();
    // quoted names hold commas: every second part between quotes
    let header = lines.next().expect("a header").split('"').enumerate();
    let header: String = header.map(|(i, part)| if i % 2 == 1 { part.replace(',', ";") } else { part.into() }).collect();
    let header: Vec<&str> = header.split(',').collect();
    let last: Vec<f64> = lines.next_back().expect("rows").split(',').map(|word| word.parse().expect("a number")).collect();
    assert_eq!(header.len(), last.len());
    let prepared = Prepared::new(built_in::named("princeton-beam").expect("built in")).expect("a sound scene");
    let said = String::from_utf8_lossy(&output.stdout);
    let json: serde_json::Value = serde_json::from_str(said.lines().last().expect("JSON")).expect("JSON");
    for (index, functional) in prepared.functionals().iter().enumerate() {
        let name = format!("measured for {} [{}]", functional.name, functional.unit);
        let column = header.iter().position(|column| *column == name);
        let column = column.unwrap_or_else(|| panic!("\"{name}\" is missing in {header:?}"));
        let value = json["functionals"][index]["value"].as_f64().expect("a value");
        // the file keeps every digit
        assert!((last[column] - value).abs() <= 1e-14 * value.abs(), "{name}: {} against {value}", last[column]);
    }
}

/// A flexible element of a user's own: V = EA L / 2 (|r_b - r_a| / L - 1)^2 of a cable between two points.
#[derive(Hash)]
struct Cable;

const fn difference(component: usize) -> Interpolation {
    Interpolation { component, weights: &[-1.0, 1.0] }
}

impl Field for Cable {
    const NODES: usize = 2;
    const NODE: NodeKind = NodeKind::Point;
    const POINTS: &'static [&'static [Interpolation]] = &[&[difference(0), difference(1), difference(2)]];
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::non_negative("EA", "N"), Parameter::positive("length", "m")]
    }
    fn parameters_of(&self, _point: usize) -> Range<usize> {
        0..2
    }
    fn strain_energy<S: Scalar>(&self, _point: usize, h: &[S], p: &[S]) -> S {
        let strain = Vector3::first_three(h).length() / p[1] - 1.0;
        p[0] * p[1] * strain * strain * 0.5
    }
}

/// A mass on the cable.
struct Plumb;

impl Scene for Plumb {
    fn name(&self) -> String {
        "plumb".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("EA", 100.0, (1.0, 1e3), "N"), DesignVariable::new("length", 0.8, (0.1, 10.0), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::statics(2)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let start = Vector3::from_f64([0.1, 0.0, -0.9]);
        let (hook, mass) = (m.point("hook", Vector3::zeros()), m.point("mass", start));
        let ground = m.ground();
        m.spherical("hook", [ground, hook], Vector3::zeros());
        m.point_mass("mass", mass, S::from(1.3));
        m.gravity(Vector3::from_f64([0.0, 0.0, -GRAVITY]));
        m.element("cable", &[hook, mass], Flexible(Cable), x);
        m.position_functional("height", Over::Terminal, mass, start, axis(2));
        Ok(())
    }
}

#[test]
fn a_flexible_element_of_a_users_own_has_equilibria_and_gradients() {
    let prepared = Prepared::new(&Plumb).expect("a sound scene");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("an equilibrium");
    // z = -L (1 + m g / EA)
    let (strain, length) = (1.3 * GRAVITY / 100.0, 0.8);
    assert!((forward.values[0] + length * (1.0 + strain)).abs() < 1e-13, "{}", forward.values[0]);
    let gradient = analysis.adjoint(&prepared.x, &forward).expect("a gradient").rows.remove(0);
    assert!(largest_difference(&[length * strain / 100.0, -1.0 - strain], &gradient) < 1e-12, "{gradient:?}");
}

/// A beam with one thing wrong.
#[derive(Clone, Copy, Debug)]
enum Mistake {
    TwoPoints,
    NoPoints,
    CoincidingPoints,
    AxisAlongLine,
    PointAtEnd,
    CoordinateAtEnd,
    Gap,
    FramesApart,
    KindsApart,
    FibreWithoutPlace,
    Component,
    Share,
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
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        use Mistake::*;
        let section = Section::new([S::from(10.0); STRAINS]).with_inertia(S::one(), [S::one(); 2]);
        let ends = [Vector3::zeros(), axis::<S>(0)];
        let ground = m.ground();
        let body =
            |m: &mut MechanismBuilder<S>, angle: f64| m.body("body", ends[1], Quaternion::about(axis(2), S::from(angle)));
        let line = match self.0 {
            Some(TwoPoints) => BeamLine::through(&ends, axis(1)),
            Some(NoPoints) => BeamLine::through(&[], axis(1)).twisted(S::one()),
            Some(CoincidingPoints) => BeamLine::straight([ends[0]; 2], 1, axis(1)),
            Some(AxisAlongLine) => BeamLine::straight(ends, 1, axis(0)),
            _ => BeamLine::straight(ends, 1, axis(1)),
        };
        let line = match self.0 {
            Some(PointAtEnd) => line.to_node(m.point("bob", ends[1])),
            Some(CoordinateAtEnd) => line.to_node(m.coordinates("angle", &[S::zero()], &[S::zero()])),
            Some(Gap) => line.to_node(ground),
            Some(FramesApart) => line.from_node(ground).to_node(body(m, 0.3)),
            _ => line.clamped_start(),
        };
        let kinds = matches!(self.0, Some(KindsApart));
        let beam =
            m.tapered_beam("beam", line, |share| if kinds && share > 0.6 { section.damped(S::zero()) } else { section });
        // what hangs on a beam that was refused is no reason to stop
        let tip = beam.end();
        growing_force(m, "force", tip, (LoadFrame::World, [0.0, 0.1, 0.0]), ends[1]);
        m.gravity(axis(2));
        m.distributed_load("load", &beam, (LoadFrame::Body, axis(1)), Signal::Constant(S::one()));
        m.set_rigid_motion(&beam.nodes, ends[0], Vector3::zeros(), Vector3::zeros());
        let (share, measure) = match self.0 {
            Some(FibreWithoutPlace) => (0.5, SectionMeasure::FibreStress),
            Some(Component) => (0.5, SectionMeasure::Strain(6)),
            Some(Share) => (1.1, SectionMeasure::Force(2)),
            _ => (0.5, SectionMeasure::Force(0)),
        };
        m.section_functional("section", Over::Terminal, &beam, share, measure);
        m.fibre_stress_functional("fibre", Over::Terminal, (&beam, 0.0), S::one(), [S::zero(), S::one()]);
        Ok(())
    }
}

/// Stiff bars, projected starts, drivers, loads, equilibria: each scene with beams has the gradients that a complex step has.
///
/// An axial force N of a bar has the digits of its strain: with N / EA about 4e-7 in the four-bar, nine. In equilibrium nothing
/// but stiffness holds a bar, EA L^2 / EI = 3e5 here: the condition of the matrix.
#[test]
fn adjoint_tangent_and_complex_step_agree_for_every_scene_with_beams() {
    let few = [
        ("flexible-four-bar", "beam = { AB.elements = 2, BC.elements = 2, CD.elements = 2 }", 0.2, 20),
        ("spin-up-beam", "", 4.0, 40),
        ("flying-rod", "", 0.5, 10),
        ("right-angle-cantilever", "beam = { 'first arm'.elements = 2, 'second arm'.elements = 2 }", 0.5, 10),
        ("princeton-beam", "beam.beam.elements = 2", 1.0, 4),
    ];
    for (name, changes, end, steps) in few {
        let scene = &built_in::changed(name, changes).expect("sound");
        for table in ["esdirk4", "bdf2"] {
            let mut settings = scene.settings();
            (settings.end, settings.steps) = (end, steps);
            let name = settings.method.clone().unwrap_or_else(|| table.into());
            let method = Method::new(table_named(&name).expect("no mistake").expect("listed"), ConstraintLevel::default());
            let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
            let prepared = Prepared::with(scene, &x, method, settings).expect("prepared");
            let analysis = prepared.analysis();
            let forward = analysis.forward(&x).expect("runs");
            let adjoint = analysis.adjoint(&x, &forward).expect("adjoint");
            let tangent = analysis.tangent(&x, &forward).expect("tangent");
            let complex_step = analysis.complex_step(&x, &forward).expect("complex step");
            // EA times a rounding of a length is a force
            let limits = prepared.gradient_limits(3e-12).expect("complex steps nearby");
            for ((k, functional), limit) in prepared.functionals().iter().enumerate().zip(limits) {
                let expected = &complex_step.rows[k];
                let worst =
                    largest_difference(&adjoint.rows[k], expected).max(largest_difference(&tangent.rows[k], expected));
                assert!(worst < limit, "{}, {name}, {}: {worst:e}", scene.name(), functional.name);
            }
        }
    }
}

#[test]
fn mistakes_about_beams_are_named() {
    use Mistake::*;
    Prepared::new(&Mistaken(None)).expect("nothing is wrong");
    let cases: [(Mistake, &[&str]); 12] = [
        (TwoPoints, &["\"beam\" has 2 points", "two for each element and one: 3, 5, 7"]),
        (NoPoints, &["\"beam\" has 0 points", "3, 5, 7"]),
        (CoincidingPoints, &["\"beam\", element 1", "points coincide", "another second axis"]),
        (AxisAlongLine, &["\"beam\", element 1", "lies along the line", "another second axis"]),
        (PointAtEnd, &["\"beam\" needs a body", "\"bob\" is none", "make it a body"]),
        (CoordinateAtEnd, &["\"beam\" needs a body", "\"angle\" is none"]),
        (Gap, &["\"beam\" lies 1.000e0 m from its node \"ground\"", "fixed joint, or move the frame"]),
        (
            FramesApart,
            &["\"beam\" joins nodes", "different Euler parameters", "[1.0, 0.0, 0.0, 0.0]", "0.988", "start alike"],
        ),
        (KindsApart, &["the section of \"beam\"", "damped: false", "damped: true", "of its length", "the same functions"]),
        (FibreWithoutPlace, &["\"section\"", "stress of a fibre needs its place", "fibre_stress_functional"]),
        (Component, &["\"section\" asks for component 6 at 0.5 of the length of \"beam\"", "components are 0 to 5"]),
        (Share, &["\"section\" asks for component 2 at 1.1 of the length", "shares 0 to 1"]),
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
