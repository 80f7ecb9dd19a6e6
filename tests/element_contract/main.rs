//! What every element owes, for every element in every topology: one line in `cases` enters a new one.

mod cases;
#[path = "../support/mod.rs"]
mod support;
mod users;

use cases::UnderRigidMotion::Invariant;
use cases::{Case, FRAMES, PAIRS, cases};
use costate::elements::NodeKind::{Body, Slope};
use costate::elements::forces::LoadFrame;
use costate::elements::{Element, State, Table, TimeFunction};
use costate::internals::{
    AppliedForce, AppliedTorque, Bushing, LineDamper, PrescribedTranslation, RunScalar, Soft, TorsionSpringDamper,
    VectorDamper,
};
use costate::scalar::{COMPLEX_STEP, Complex64, Interpolant, Quaternion, SpatialVector, TANGENTS, Tangents, Vector3};
use costate::testing::{self, check_element};
use num_dual::{Dual2_64, Dual64};
use std::sync::Arc;
use support::motion::{RigidMotion, random_coordinates};
use support::time_functions::time_functions;
use support::{Random, for_all, twelve};

/// An element in other numbers than its recording; every `Element` is one.
pub trait Contract {
    /// Everything that is derived from the recording.
    fn check(self: Arc<Self>, samples: &[testing::Sample]) -> Result<(), String>;
    /// The non-conservative force, that of damping stresses included.
    fn force(&self, v: &[f64], q: &[f64], p: &[f64], t: f64) -> Vec<f64>;
    /// Number of its strains.
    fn strain_count(&self) -> usize;
    /// T + V with its rate along the motion of coordinates.
    fn energy_rate(&self, s: State<f64>, p: &[f64], t: f64) -> Dual64;
}

/// Numbers on their way.
fn along(x: &[f64], rate: &[f64]) -> Vec<Dual64> {
    x.iter().zip(rate).map(|(&x, &rate)| Dual64::new(x, rate)).collect()
}

fn still(x: &[f64]) -> Vec<Dual64> {
    x.iter().map(|&x| x.into()).collect()
}

fn strains<E: Element>(element: &E, q: &[Dual64], p: &[f64], t: Dual64) -> Vec<Dual64> {
    let mut e = vec![Dual64::from(0.0); element.strain_count()];
    element.strains(q, &still(p), t, &mut e);
    e
}

impl<E: Element> Contract for E {
    fn check(self: Arc<Self>, samples: &[testing::Sample]) -> Result<(), String> {
        check_element(&self, samples)
    }
    fn strain_count(&self) -> usize {
        Element::strain_count(self)
    }
    fn force(&self, v: &[f64], q: &[f64], p: &[f64], t: f64) -> Vec<f64> {
        let mut force = vec![0.0; q.len()];
        self.add_force(v, q, p, t, &mut force);
        let moving = strains(self, &along(q, v), p, Dual64::new(t, 1.0));
        let (e, rate): (Vec<f64>, Vec<f64>) = moving.iter().map(|e| (e.re, e.eps)).unzip();
        let stresses = testing::damping_stresses(self, [&e, &rate, p], t);
        for (dof, force) in force.iter_mut().enumerate() {
            let mut q = still(q);
            q[dof].eps = 1.0;
            let gradient = strains(self, &q, p, t.into());
            *force -= gradient.iter().zip(&stresses).map(|(e, s)| e.eps * s).sum::<f64>();
        }
        force
    }
    fn energy_rate(&self, s: State<f64>, p: &[f64], t: f64) -> Dual64 {
        let (q, v) = (along(s.q, s.v), along(s.v, s.a));
        let e = strains(self, &q, p, t.into());
        let p = still(p);
        self.kinetic(&v, &q, &p) + self.potential(&q, &p) + self.strain_energy(&q, &p) + self.stored(&e, &p)
    }
}

/// One random state; Euler parameters have any length between 1/2 and 3/2.
#[derive(Debug)]
struct Sample {
    a: Vec<f64>,
    v: Vec<f64>,
    q: Vec<f64>,
    t: f64,
}

impl Sample {
    fn state(&self) -> State<'_, f64> {
        State { a: &self.a, v: &self.v, q: &self.q }
    }
}

fn samples(case: &Case) -> Vec<Sample> {
    twelve(|random| sample(case, random))
}

fn for_all_samples(case: &Case, test: impl Fn(Sample)) {
    for_all(&case.name, |random| sample(case, random), test);
}

fn sample(case: &Case, random: &mut Random) -> Sample {
    let n = case.physics.dof_count();
    let mut q = random_coordinates(&case.nodes, random, |random| random.uniform(0.5, 1.5));
    q.extend(random.vector(case.scalars));
    if case.neighbours && case.nodes[0] == Slope {
        // the second node of a cable about as far as its length, and the slope bent by about half a radian
        let first = Vector3::first_three(&q[3..]);
        let bend = first.unit().perpendiculars()[0] * (0.5 * first.length());
        for i in 0..3 {
            q[9 + i] = first[i] + bend[i] + random.uniform(-0.05, 0.05);
            q[6 + i] = q[i] + case.p[0] * (first[i] + 0.5 * bend[i]) + random.uniform(-0.01, 0.01);
        }
    } else if case.neighbours {
        let first: Vec<f64> = q[3..7].to_vec();
        for node in q.chunks_exact_mut(7).skip(1) {
            node[3..].iter_mut().zip(&first).for_each(|(e, first)| *e = first + random.uniform(-0.15, 0.15));
        }
    }
    Sample { a: random.vector(n), v: random.vector(n), q, t: random.uniform(-1.0, 1.0) }
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// Asserts |a - b| <= tolerance x the larger of `scale` and the largest number.
fn assert_close(what: &str, a: &[f64], b: &[f64], tolerance: f64, scale: f64) {
    assert_eq!(a.len(), b.len(), "{what}");
    assert!(a.iter().chain(b).all(|x| x.is_finite()), "{what}: {a:?} against {b:?}");
    let limit = tolerance * largest(a).max(largest(b)).max(scale);
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= limit), "{what}: {a:?} against {b:?}");
}

/// (a, v, q, p, t) in one list, so that every column of the derivative is one entry of it.
fn inputs(case: &Case, sample: &Sample) -> Vec<f64> {
    [&sample.a[..], &sample.v, &sample.q, &case.p, &[sample.t]].concat()
}

fn residual<S: RunScalar>(case: &Case, inputs: &[S]) -> Vec<S> {
    let n = case.physics.dof_count();
    let (a, rest) = inputs.split_at(n);
    let (v, rest) = rest.split_at(n);
    let (q, rest) = rest.split_at(n);
    let (p, t) = rest.split_at(case.p.len());
    case.physics.residual_at(State { a, v, q }, p, t[0])
}

/// Columns of dR/d(a, v, q, p, t), by tangents.
fn columns_by_tangents(case: &Case, at: &[f64]) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for first in (0..at.len()).step_by(TANGENTS) {
        let count = TANGENTS.min(at.len() - first);
        let mut seeded: Vec<Tangents> = at.iter().map(|&x| x.into()).collect();
        (0..count).for_each(|k| seeded[first + k].add_to_part(k, 1.0));
        let r = residual(case, &seeded);
        columns.extend((0..count).map(|k| r.iter().map(|r| r.part(k)).collect::<Vec<_>>()));
    }
    columns
}

fn column_by_complex_step(case: &Case, at: &[f64], column: usize) -> Vec<f64> {
    let mut stepped: Vec<Complex64> = at.iter().map(|&x| x.into()).collect();
    stepped[column].im = COMPLEX_STEP;
    residual(case, &stepped).iter().map(|r| r.im / COMPLEX_STEP).collect()
}

fn column_by_differences(case: &Case, at: &[f64], column: usize) -> Vec<f64> {
    let shifted = |h: f64| {
        let mut at = at.to_vec();
        at[column] += h;
        residual(case, &at)
    };
    let central = |h: f64| -> Vec<f64> {
        shifted(h).iter().zip(shifted(-h)).map(|(plus, minus)| (plus - minus) / (2.0 * h)).collect()
    };
    // one step of Richardson removes h^2
    central(2e-5).iter().zip(central(1e-5)).map(|(coarse, fine)| (4.0 * fine - coarse) / 3.0).collect()
}

#[test]
fn sizes_fit_and_sample_parameters_are_admissible() {
    for case in cases() {
        let parameters = case.physics.parameter_list();
        assert_eq!(parameters.len(), case.p.len(), "{}", case.name);
        assert_eq!(
            case.nodes.iter().map(|node| node.dofs()).sum::<usize>() + case.scalars,
            case.physics.dof_count(),
            "{}",
            case.name
        );
        for (parameter, &value) in parameters.iter().zip(&case.p) {
            assert!(parameter.admissible.contains(value), "{}: {} = {value}", case.name, parameter.name);
            assert!(!parameter.name.is_empty() && !parameter.unit.is_empty(), "{}: {parameter:?}", case.name);
        }
        let distinct: std::collections::BTreeSet<_> = parameters.iter().map(|p| &p.name).collect();
        assert_eq!(distinct.len(), parameters.len(), "{}: two parameters of one name", case.name);
    }
}

#[test]
fn every_parameter_is_read_unless_the_topology_ignores_it() {
    for case in cases() {
        let mut moves = vec![false; case.p.len()];
        for sample in samples(&case) {
            // exactly as many entries as the list of parameters has: reading one more would panic here
            let columns = columns_by_tangents(&case, &inputs(&case, &sample));
            for (moves, column) in moves.iter_mut().zip(&columns[3 * sample.q.len()..]) {
                *moves |= largest(column) > 0.0;
            }
        }
        // of a law by a table each sample reads one piece
        let of_table = |name: &str| [", value ", ", slope "].iter().any(|own| name.contains(own));
        let parameters = case.physics.parameter_list();
        for (parameter, moves) in parameters.iter().zip(&moves).filter(|own| !of_table(&own.0.name)) {
            let ignored = case.ignored.iter().any(|start| parameter.name.starts_with(start));
            assert_eq!(*moves, !ignored, "{}: does {} enter the residual?", case.name, parameter.name);
        }
        let read = parameters.iter().zip(&moves).filter(|own| of_table(&own.0.name)).map(|own| *own.1);
        let [count, read] = [read.clone().count(), read.filter(|moves| *moves).count()];
        assert!(2 * read >= count, "{}: {read} of {count} numbers of tables are read", case.name);
    }
}

#[test]
fn tangents_equal_complex_step_and_differences_in_every_argument() {
    for case in cases() {
        for_all_samples(&case, |sample| {
            let at = inputs(&case, &sample);
            let columns = columns_by_tangents(&case, &at);
            let scale = columns.iter().map(|column| largest(column)).fold(0.0, f64::max);
            for (k, column) in columns.iter().enumerate() {
                let place = format!("{}, derivative to entry {k} of (a, v, q, p, t) at t = {}", case.name, sample.t);
                assert_close(&place, column, &column_by_complex_step(&case, &at, k), 1e-12, scale);
                // the limit is the round-off of a difference
                assert_close(&place, column, &column_by_differences(&case, &at, k), 1e-7, scale);
            }
        });
    }
}

#[test]
fn what_is_derived_from_the_recording_is_what_other_numbers_say() {
    let mut failed = Vec::new();
    for case in cases() {
        let samples: Vec<testing::Sample> = samples(&case)
            .into_iter()
            .map(|Sample { a, v, q, t }| testing::Sample { a, v, q, p: case.p.clone(), t })
            .collect();
        if let Err(why) = Arc::clone(&case.element).check(&samples) {
            failed.push(format!("{}: {why}", case.name));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn a_recording_reads_what_moves_its_residual_and_nothing_else() {
    for case in cases() {
        let n = case.physics.dof_count();
        let reads = case.physics.residual().values().reads();
        let mut moves = vec![false; reads.len()];
        for sample in samples(&case) {
            let columns = columns_by_tangents(&case, &inputs(&case, &sample));
            moves.iter_mut().zip(&columns).for_each(|(moves, column)| *moves |= largest(column) > 0.0);
        }
        for (place, (reads, moves)) in reads.into_iter().zip(moves).enumerate() {
            assert!(reads || !moves, "{}: argument {place} of (a, v, q, p, t), n = {n}", case.name);
        }
    }
}

#[test]
fn value_is_the_same_in_every_number_type() {
    for case in cases() {
        for_all_samples(&case, |sample| {
            let at = inputs(&case, &sample);
            let real = residual(&case, &at);
            let complex = residual(&case, &at.iter().map(|&x| Complex64::from(x)).collect::<Vec<_>>());
            let tangents = residual(&case, &at.iter().map(|&x| Tangents::from(x)).collect::<Vec<_>>());
            assert_close(&case.name, &real, &complex.iter().map(|r| r.re).collect::<Vec<_>>(), 1e-14, 1.0);
            assert_close(&case.name, &real, &tangents.iter().map(|r| r.re).collect::<Vec<_>>(), 1e-14, 1.0);
        });
    }
}

#[test]
fn springs_and_flexible_elements_state_their_energies_whether_they_damp_or_not() {
    let of_energies =
        |case: &&Case| ["line spring", "beam", "cable", "shell"].iter().any(|name| case.name.starts_with(name));
    let cases = cases();
    let own: Vec<&Case> = cases.iter().filter(of_energies).collect();
    assert!(own.len() > 15, "{}", own.len());
    own.iter().for_each(|case| assert!(case.physics.has_energies(), "{}", case.name));
}

#[test]
fn power_of_the_residual_is_energy_rate_minus_power_of_the_forces() {
    // what is written out without energies has no such balance
    for case in cases().into_iter().filter(|case| !case.without_energies) {
        for_all_samples(&case, |sample| {
            let power = |force: &[f64]| -> f64 { force.iter().zip(&sample.v).map(|(f, v)| f * v).sum() };
            let r = residual(&case, &inputs(&case, &sample));
            let force = case.element.force(&sample.v, &sample.q, &case.p, sample.t);
            let rate = case.element.energy_rate(sample.state(), &case.p, sample.t).eps;
            let scale = largest(&r).max(largest(&force));
            assert_close(&case.name, &[power(&r)], &[rate - power(&force)], 1e-12, scale);
        });
    }
}

#[test]
fn dampers_never_give_power() {
    for case in cases().iter().filter(|case| case.name.contains("damper")) {
        for_all_samples(case, |sample| {
            let force = case.element.force(&sample.v, &sample.q, &case.p, sample.t);
            let power: f64 = force.iter().zip(&sample.v).map(|(f, v)| f * v).sum();
            assert!(power < 0.0, "{}: {power} W", case.name);
        });
    }
}

/// Power of an element's non-conservative forces [W]: their size, which the balance above cannot see.
fn power(element: &impl Contract, sample: &Sample, p: &[f64]) -> f64 {
    element.force(&sample.v, &sample.q, p, sample.t).iter().zip(&sample.v).map(|(f, v)| f * v).sum()
}

#[test]
fn damper_between_points_takes_c_times_the_square_of_the_rate() {
    let ends = [0.3, -0.2, 0.5, -0.4, 0.1, 0.6];
    for [a, b] in PAIRS {
        let p = [&[2.3], &ends[..]].concat();
        let case = Case::new("dampers", LineDamper([a, b]), &p);
        for_all_samples(&case, |sample| {
            // positions along the motion: their rates need no formula of velocities
            let along = along(&sample.q, &sample.v);
            let (of_a, of_b) = along.split_at(a.dofs());
            let ends = [&ends[..3], &ends[3..]].map(|point: &[f64]| Vector3::from_f64([point[0], point[1], point[2]]));
            let between: Vector3<Dual64> = b.position(of_b, ends[1]) - a.position(of_a, ends[0]);
            let length_rate = between.length().eps;
            let speed = between.map(|x| x.eps).length();
            let line = power(&LineDamper([a, b]), &sample, &p);
            let vector = power(&VectorDamper([a, b]), &sample, &p);
            assert_close("line damper", &[line], &[-2.3 * length_rate * length_rate], 1e-12, 1.0);
            assert_close("vector damper", &[vector], &[-2.3 * speed * speed], 1e-12, 1.0);
        });
    }
}

#[test]
fn applied_loads_have_the_power_of_force_times_velocity_and_torque_times_angular_velocity() {
    let (direction, point) = (Vector3::new(0.3, -0.5, 0.7), Vector3::new(0.2, 0.4, -0.1));
    let axis = Vector3::new(0.6, 0.0, 0.8);
    for frame in FRAMES {
        let size = TimeFunction::Constant;
        let body = Case::new("load", AppliedTorque { on: Body, frame, size: size.clone() }, &[0.3, -0.5, 0.7, 1.3]);
        for_all_samples(&body, |Sample { mut v, mut q, t, a }| {
            // a rotation of unit length that turns by 0.9 rad/s about `axis`, exactly
            let unit = Quaternion::about(axis, t);
            q[3..].copy_from_slice(&unit.0);
            v[3..].copy_from_slice(&unit.rate_of_body_velocity(axis * 0.9));
            let in_world = |vector: Vector3<f64>| if frame == LoadFrame::Body { unit.rotate(vector) } else { vector };
            let velocity = Vector3::first_three(&v) + (axis * 0.9).cross(&unit.rotate(point));
            let sample = Sample { a, v, q, t };
            let force = AppliedForce { on: Body, frame, size: size.clone() };
            let of_force = power(&force, &sample, &[0.3, -0.5, 0.7, 0.2, 0.4, -0.1, 1.3]);
            assert_close("force", &[of_force], &[1.3 * in_world(direction).dot(&velocity)], 1e-13, 1.0);
            let of_torque = power(&AppliedTorque { on: Body, frame, size: size.clone() }, &sample, &body.p);
            assert_close("torque", &[of_torque], &[1.3 * 0.9 * in_world(direction).dot(&axis)], 1e-13, 1.0);
        });
    }
}

#[test]
fn torsion_spring_damper_feels_angle_and_rate_about_its_axis_only() {
    let [stiffness, damping, rest] = [3.1, 0.7, 0.2];
    let [axis, reference_a, reference_b] = [[0.6, 0.0, 0.8], [0.8, 0.0, -0.6], [0.8, 0.0, -0.6]];
    let p = [&[stiffness, damping, rest][..], &axis, &reference_a, &reference_b].concat();
    let axis = Vector3::from(axis);
    let rate = -1.7;
    for angle in [-3.0, -1.2, 0.0, 0.4, 2.9] {
        // both bodies tumble together, b turns on about the axis: e_b = e_a about(axis, angle)
        let (of_a, tumbling) = (Quaternion::about(Vector3::new(0.0, 1.0, 0.0), 0.8), Vector3::new(0.5, -1.1, 0.3));
        let relative = Quaternion::about(axis, angle);
        let of_b = of_a.times(relative);
        let rate_a = of_a.rate_of_body_velocity(tumbling);
        let rate_b = of_b.rate_of_body_velocity(relative.rotate_back(tumbling) + axis * rate);
        let at = [1.0, 2.0, 3.0];
        let q = [&at[..], &of_a.0, &at, &of_b.0].concat();
        let v = [&at[..], &rate_a, &at, &rate_b].concat();
        let sample = Sample { a: vec![0.0; 14], v, q, t: 0.0 };
        let spring = TorsionSpringDamper([Body; 2]);
        let [_, potential, ..] =
            testing::element_physics(&Arc::new(TorsionSpringDamper([Body; 2]))).energies_at(&sample.v, &sample.q, &p);
        assert_close("energy", &[potential], &[0.5 * stiffness * (angle - rest) * (angle - rest)], 1e-13, 1.0);
        let taken = power(&spring, &sample, &p);
        assert_close("power", &[taken], &[-damping * rate * rate], 1e-13, 1.0);
        let balance = spring.energy_rate(sample.state(), &p, 0.0).eps;
        assert_close("rate of energy", &[balance], &[stiffness * (angle - rest) * rate], 1e-13, 1.0);
    }
}

#[test]
fn a_bushing_pulls_along_and_turns_about_the_axes_of_its_frame() {
    let frame = Quaternion::about(Vector3::new(0.36, 0.48, 0.8), 0.9);
    let (along, about) = ([3.0, 5.0, 7.0], [2.0, 4.0, 6.0]);
    let point = [0.3, -0.2, 0.5];
    let p = [&along[..], &about, &[0.0; 6], &point, &[0.0; 3], &frame.0, &frame.0].concat();
    let of_a = Quaternion::about(Vector3::new(0.48, -0.6, 0.64), 1.1);
    for axis in 0..3 {
        let mut unit = [0.0; 3];
        unit[axis] = 1.0;
        let axis_of_a = frame.rotate(Vector3::from(unit));
        for (shift, angle) in [(0.2, 0.0), (-0.1, 0.3), (0.0, -1.4)] {
            let place = of_a.rotate(Vector3::from(point) + axis_of_a * shift);
            let q =
                [&[0.0; 3][..], &of_a.0, &place.components(), &of_a.times(Quaternion::about(axis_of_a, angle)).0].concat();
            let bushing = testing::element_physics(&Arc::new(Bushing([Body; 2])));
            let [_, energy, ..] = bushing.energies_at(&[0.0; 14], &q, &p);
            let turn = 2.0 * (0.5 * angle).sin();
            let expected = 0.5 * (along[axis] * shift * shift + about[axis] * turn * turn);
            assert_close("energy", &[energy], &[expected], 1e-13, 1.0);
            let r = bushing.residual_at(State { a: &[0.0; 14], v: &[0.0; 14], q: &q }, &p, 0.0);
            assert_close("pull", &r[7..10], &(of_a.rotate(axis_of_a) * (along[axis] * shift)).components(), 1e-13, 1.0);
        }
    }
}

#[test]
fn a_soft_drive_pulls_towards_its_moving_target() {
    let drive = Soft(PrescribedTranslation { nodes: [Body; 2], displacement: TimeFunction::ConstantRate });
    let drive = testing::element_physics(&Arc::new(drive));
    let (stiffness, damping, offset, rate, t) = (30.0, 4.0, 0.1, 0.7, 0.5);
    let p = [&[stiffness, damping][..], &[0.0; 6], &[1.0, 0.0, 0.0], &[offset, rate]].concat();
    let unit = Quaternion::identity().0;
    let (place, speed) = (0.9, -0.3);
    let q = [&[0.0; 3][..], &unit, &[place, 0.2, 0.0], &unit].concat();
    let v = [&[0.0; 7][..], &[speed, 0.0, 0.0], &[0.0; 4]].concat();
    let r = drive.residual_at(State { a: &[0.0; 14], v: &v, q: &q }, &p, t);
    let force = stiffness * (place - offset - rate * t) + damping * (speed - rate);
    assert_close("force", &r[7..10], &[force, 0.0, 0.0], 1e-13, 1.0);
    assert!(!drive.has_energies());
}

#[test]
fn rigid_motion_keeps_the_energies_and_carries_the_residual_along() {
    let motion = RigidMotion { rotation: Quaternion([0.5, -0.5, 0.7, 0.1]), translation: Vector3::new(0.4, -1.3, 2.1) };
    for case in cases().iter().filter(|case| case.motion == Invariant && case.scalars == 0) {
        for_all_samples(case, |sample| {
            let q = motion.of_coordinates(&case.nodes, &sample.q);
            let [v, a] = [&sample.v, &sample.a].map(|rate| motion.of_rates(&case.nodes, rate));
            let moved = Sample { a, v, q, t: sample.t };
            let [before, after] = [&sample, &moved].map(|s| case.physics.energies_at(&s.v, &s.q, &case.p));
            assert_close(&case.name, &before, &after, 1e-12, 1.0);
            let [before, after] = [&sample, &moved].map(|s| residual(case, &inputs(case, s)));
            // rotations are orthogonal maps of the coordinates, so generalized forces turn like rates
            assert_close(&case.name, &motion.of_rates(&case.nodes, &before), &after, 1e-12, 1.0);
        });
    }
}

#[test]
fn mass_is_that_of_the_kinetic_energy_in_translation() {
    for case in cases() {
        let n = case.physics.dof_count();
        let q = &samples(&case)[0].q;
        // all nodes move with (1, 2, 2) / 3 m/s and do not turn: T = m / 2
        let mut v = vec![0.0; n];
        let mut first = 0;
        for node in &case.nodes {
            v[first..first + 3].copy_from_slice(&[1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]);
            first += node.dofs();
        }
        let [kinetic, _, mass, _] = case.physics.energies_at(&v, q, &case.p);
        assert_close(&case.name, &[mass], &[2.0 * kinetic], 1e-14, 1e-9);
    }
}

#[test]
fn functions_of_time_are_twice_differentiable_away_from_steps_and_name_their_breakpoints() {
    for (name, function, p) in time_functions() {
        let breakpoints = function.breakpoints(&p, [-1.6, 1.6]).expect("few");
        for k in 0..400 {
            let t = -1.5 + 3.0 * f64::from(k) / 400.0 + 1e-4;
            let [left, right] = [t - 1e-6, t + 1e-6].map(|t| {
                function.value(Dual2_64::new(t, 1.0, 0.0), &p.iter().map(|&p| p.into()).collect::<Vec<Dual2_64>>())
            });
            if breakpoints.iter().all(|breakpoint| (breakpoint - t).abs() > 1e-5) {
                assert_close(name, &[left.re, left.v1], &[right.re, right.v1], 1e-4, 1.0);
                assert_close(name, &[left.v2], &[right.v2], 1e-3, 1.0);
            }
        }
        // at a breakpoint the value itself stays, except where the function is a step; steps begin with the first value
        let jumps = name.contains("step");
        for breakpoint in breakpoints.into_iter().skip(usize::from(name == "steps")) {
            let jump = function.value(breakpoint + 1e-9, &p) - function.value(breakpoint - 1e-9, &p);
            assert_eq!(jump.abs() > 1e-6, jumps, "{name} at {breakpoint}: {jump}");
        }
    }
}

#[test]
fn a_smooth_start_begins_at_rest_and_ends_half_its_duration_late() {
    let of = |inner: TimeFunction| TimeFunction::SmoothStart(Arc::new(inner));
    let started = of(TimeFunction::ConstantRate);
    let p = [0.2, 3.0, 0.8].map(Dual2_64::from);
    let at = |t: f64| started.value(Dual2_64::new(t, 1.0, 0.0), &p);
    for t in [-1.0, 0.0] {
        assert_close("rest", &[at(t).re, at(t).v1, at(t).v2], &[0.2, 0.0, 0.0], 1e-15, 1.0);
    }
    for t in [0.8, 2.0] {
        assert_close("motion", &[at(t).re, at(t).v1, at(t).v2], &[0.2 + 3.0 * (t - 0.4), 3.0, 0.0], 1e-14, 1.0);
    }
    // half the rate after half the duration
    assert_close("half", &[at(0.4).v1], &[1.5], 1e-14, 1.0);
    // a jump happens at the time that its breakpoint says, to the last bit
    for switch in [0.05, 0.3, 0.9] {
        let step = of(TimeFunction::Step { switch });
        let p = [0.8, -0.6, 0.8];
        let sides = |t: f64| [t.next_down(), t].map(|t| step.value(t, &p));
        let mut breakpoints = step.breakpoints(&p, [0.0, 2.0]).expect("few");
        breakpoints.retain(|&breakpoint| sides(breakpoint)[0] != sides(breakpoint)[1]);
        assert_eq!(breakpoints.iter().map(|&breakpoint| sides(breakpoint)).collect::<Vec<_>>(), [[0.8, -0.6]], "{switch}");
    }
}

#[test]
fn cubic_tables_go_through_their_knots_and_on_with_constant_slope() {
    let (times, values) = (vec![-0.7, -0.2, 0.1, 0.8], [0.5, -0.3, 0.9, 0.2]);
    for way in [Interpolant::Monotone, Interpolant::Smooth] {
        let of_design = Table::new(&times, way).expect("increasing times");
        let numbers = of_design.numbers(&values);
        let fixed = TimeFunction::curve(&times, &values, way).expect("increasing times");
        let table = |t: f64| {
            let [one, other] = [TimeFunction::Table(of_design.clone()).value(t, &numbers), fixed.value(t, &[])];
            assert_close("with parameters and without", &[one], &[other], 1e-13, 1.0);
            one
        };
        for (&t, &f) in times.iter().zip(&values) {
            assert_close("knot", &[table(t)], &[f], 1e-14, 1.0);
        }
        for (end, out) in [(-0.7, -1.0), (0.8, 1.0)] {
            let slope = |from: f64, to: f64| (table(to) - table(from)) / (to - from);
            let inside = slope(end, end - 1e-6 * out);
            let beyond = [slope(end, end + out), slope(end + out, end + 2.0 * out)];
            assert_close("slope beyond the end", &beyond, &[inside; 2], 1e-4, 1.0);
        }
        let straight: Vec<f64> = times.iter().map(|t| 2.0 - 3.0 * t).collect();
        let numbers = of_design.numbers(&straight);
        let line = [0.33, 4.0].map(|t| of_design.value(t, &numbers));
        assert_close("a line", &line, &[1.01, -10.0], 1e-13, 1.0);
    }
    let refused = |times: &[f64]| TimeFunction::table(times, Interpolant::Monotone).is_err();
    assert!(refused(&[0.0]) && refused(&[0.0, 0.0]) && refused(&[0.0, f64::NAN, 1.0]) && refused(&[f64::NAN, 1.0]));
    assert!(refused(&[f64::NEG_INFINITY, 1.0]));
}
