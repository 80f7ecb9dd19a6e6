//! What every constraint owes, for every joint in every topology: one line in `cases` enters a new one.

mod cases;
mod entries;
#[path = "../support/mod.rs"]
mod support;

use cases::{AXIS, Case, Move, NORMAL_U, NORMAL_W, NOW, Placement, STEP, cases, rollings};
use costate::elements::NodeKind::Body;
use costate::elements::{Constraint, NodeKind, State, TimeFunction};
use costate::internals::{EulerParameterNorm, PrescribedRotation, Reads, RunScalar};
use costate::scalar::{COMPLEX_STEP, Complex64, Quaternion, SpatialVector, TANGENTS, Tangents, Vector3};
use costate::testing;
use std::cell::Cell;
use std::f64::consts::TAU;
use support::motion::{RigidMotion, random_coordinates};
use support::{Random, for_all, twelve};

fn value<S: RunScalar>(case: &Case, q: &[S], p: &[S], t: S) -> Vec<S> {
    case.constraint.value(q, p, t)
}

/// g, dg/dt and d2g/dt2.
fn derivatives<S: RunScalar>(case: &Case, s: State<S>, p: &[S], t: S) -> Vec<[S; 3]> {
    case.constraint.motion(s, p, t)
}

fn reaction<S: RunScalar>(case: &Case, q: &[S], mu: &[S], p: &[S], t: S) -> Vec<S> {
    case.constraint.reaction(q, mu, p, t)
}

/// One random state, far from g = 0; Euler parameters have any length between 1/2 and 3/2.
#[derive(Debug)]
struct Sample {
    a: Vec<f64>,
    v: Vec<f64>,
    q: Vec<f64>,
    mu: Vec<f64>,
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

/// Times at which a case jumps or bends.
fn breakpoints(case: &Case) -> Vec<f64> {
    let (formula, state) = (case.constraint.formula(), vec![0.0; 2 * case.constraint.dof_count()]);
    let Some(switches) = formula.switches(Reads::TimeAlone, true) else { return Vec::new() };
    let inputs = [&state[..], &case.p, &[0.0]].concat();
    let times = switches.times(&inputs, &[inputs.len() - 1], [-1.5, 1.5]).expect("few");
    times.iter().map(|own| own.t).collect()
}

fn sample(case: &Case, random: &mut Random) -> Sample {
    let n = case.constraint.dof_count();
    let mut q = random_coordinates(&case.nodes, random, |random| random.uniform(0.5, 1.5));
    q.extend(random.vector(case.scalars));
    let mu = random.vector(case.constraint.equation_count());
    let (a, v) = (random.vector(n), random.vector(n));
    let breakpoints = breakpoints(case);
    // differences of time do not reach over a breakpoint
    let mut t = random.uniform(-1.0, 1.0);
    while breakpoints.iter().any(|breakpoint| (t - breakpoint).abs() < 2e-3) {
        t += 1e-3;
    }
    Sample { a, v, q, mu, t }
}

fn complex(real: &[f64]) -> Vec<Complex64> {
    real.iter().map(|&x| x.into()).collect()
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// Asserts |a - b| <= tolerance x the larger of 1 and the largest number.
fn assert_close(what: &str, a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len(), "{what}");
    assert!(a.iter().chain(b).all(|x| x.is_finite()), "{what}: {a:?} against {b:?}");
    let limit = tolerance * largest(a).max(largest(b)).max(1.0);
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= limit), "{what}: {a:?} against {b:?}");
}

#[test]
fn sizes_fit_and_sample_parameters_are_admissible() {
    for case in cases() {
        let parameters = case.constraint.parameter_list();
        assert_eq!(parameters.len(), case.p.len(), "{}", case.name);
        assert_eq!(
            case.nodes.iter().map(|node| node.dofs()).sum::<usize>() + case.scalars,
            case.constraint.dof_count(),
            "{}",
            case.name
        );
        for (parameter, &value) in parameters.iter().zip(&case.p) {
            assert!(parameter.admissible.contains(value), "{}: {} = {value}", case.name, parameter.name);
        }
        let distinct: std::collections::BTreeSet<_> = parameters.iter().map(|p| &p.name).collect();
        assert_eq!(distinct.len(), parameters.len(), "{}: two parameters of one name", case.name);
    }
}

#[test]
fn every_parameter_is_read_unless_the_topology_ignores_it() {
    for case in cases() {
        for (k, parameter) in case.constraint.parameter_list().iter().enumerate() {
            let moves = samples(&case).iter().any(|sample| {
                // exactly as many entries as the list of parameters has: reading one more would panic here
                let mut p = complex(&case.p);
                p[k].im = COMPLEX_STEP;
                value(&case, &complex(&sample.q), &p, sample.t.into()).iter().any(|g| g.im != 0.0)
            });
            let ignored = case.ignored.iter().any(|start| parameter.name.starts_with(start));
            assert_eq!(moves, !ignored, "{}: does {} enter g?", case.name, parameter.name);
        }
    }
}

#[test]
fn what_is_derived_from_the_recording_is_what_other_numbers_say() {
    let mut failed = Vec::new();
    let of_case = |case: &Case| -> Vec<testing::Sample> {
        let own = samples(case).into_iter().take(6);
        own.map(|Sample { a, v, q, t, .. }| testing::Sample { a, v, q, p: case.p.clone(), t }).collect()
    };
    for case in cases() {
        if let Err(why) = case.contract.check(&of_case(&case)) {
            failed.push(format!("{}: {why}", case.name));
        }
    }
    let mut random = Random::new(8);
    for rolling in rollings() {
        let mut coordinates = || random_coordinates(&rolling.nodes, &mut random, |random| random.uniform(0.5, 1.5));
        let samples: Vec<testing::Sample> = (0..6)
            .map(|k| {
                let [a, v, q] = [(); 3].map(|()| coordinates());
                testing::Sample { a, v, q, p: rolling.p.clone(), t: 0.3 * f64::from(k) }
            })
            .collect();
        if let Err(why) = (rolling.constraint)(&samples) {
            failed.push(format!("{}: {why}", rolling.name));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn derivatives_equal_complex_steps_along_the_motion() {
    for case in cases() {
        for_all_samples(&case, |sample| {
            let g = derivatives(&case, sample.state(), &case.p, sample.t);
            let along = |x: &[f64], rate: &[f64]| -> Vec<Complex64> {
                x.iter().zip(rate).map(|(&x, &rate)| Complex64::new(x, rate * COMPLEX_STEP)).collect()
            };
            let (q, v) = (along(&sample.q, &sample.v), along(&sample.v, &sample.a));
            let (a, p, t) = (complex(&sample.a), complex(&case.p), Complex64::new(sample.t, COMPLEX_STEP));
            let stepped = value(&case, &q, &p, t);
            let stepped_rate = derivatives(&case, State { a: &a, v: &v, q: &q }, &p, t);
            let of = |order: usize| g.iter().map(|g| g[order]).collect::<Vec<_>>();
            let part = |x: &Complex64| x.im / COMPLEX_STEP;
            assert_close(&case.name, &of(0), &value(&case, &sample.q, &case.p, sample.t), 1e-15);
            assert_close(&case.name, &of(1), &stepped.iter().map(part).collect::<Vec<_>>(), 1e-12);
            assert_close(&case.name, &of(2), &stepped_rate.iter().map(|g| part(&g[1])).collect::<Vec<_>>(), 1e-12);
        });
    }
}

#[test]
fn derivatives_equal_differences_of_time_along_a_smooth_path() {
    for case in cases() {
        let (seen, left_out) = (Cell::new(0), Cell::new(0));
        for_all_samples(&case, |sample| {
            let at = |s: f64| {
                let q: Vec<_> =
                    (0..sample.q.len()).map(|i| sample.q[i] + s * (sample.v[i] + 0.5 * s * sample.a[i])).collect();
                value(&case, &q, &case.p, sample.t + s)
            };
            // an angle leaps by a full turn at half a turn, and differences over the leap say nothing
            if at(8e-4).iter().zip(at(-8e-4)).any(|(after, before)| (after - before).abs() > std::f64::consts::PI) {
                left_out.set(left_out.get() + 1);
                return;
            }
            seen.set(seen.get() + 1);
            let g = derivatives(&case, sample.state(), &case.p, sample.t);
            // one step of Richardson removes h^2; round-off of the second difference is 1e-16 / h^2
            let [(first_coarse, second_coarse), (first_fine, second_fine)] = [8e-4, 4e-4].map(|h| {
                let (plus, here, minus) = (at(h), at(0.0), at(-h));
                let row = |i: usize| (plus[i] - minus[i]) / (2.0 * h);
                let bend = |i: usize| (plus[i] - 2.0 * here[i] + minus[i]) / (h * h);
                let rows = 0..here.len();
                (rows.clone().map(row).collect::<Vec<f64>>(), rows.map(bend).collect::<Vec<f64>>())
            });
            let richardson = |coarse: &[f64], fine: &[f64]| -> Vec<f64> {
                coarse.iter().zip(fine).map(|(coarse, fine)| (4.0 * fine - coarse) / 3.0).collect()
            };
            let place = format!("{} at t = {}", case.name, sample.t);
            let (first, second): (Vec<_>, Vec<_>) = g.iter().map(|g| (g[1], g[2])).unzip();
            assert_close(&place, &first, &richardson(&first_coarse, &first_fine), 1e-7);
            assert_close(&place, &second, &richardson(&second_coarse, &second_fine), 1e-7);
        });
        let (seen, left_out) = (seen.get(), left_out.get());
        assert!(seen > 9 * left_out, "{}: {seen} samples, {left_out} left out at half a turn", case.name);
    }
}

#[test]
fn reaction_is_the_transposed_gradient_times_the_multipliers() {
    for case in cases() {
        for_all_samples(&case, |sample| {
            let gradient_times_mu: Vec<f64> = (0..sample.q.len())
                .map(|column| {
                    let mut q = complex(&sample.q);
                    q[column].im = COMPLEX_STEP;
                    let g = value(&case, &q, &complex(&case.p), sample.t.into());
                    g.iter().zip(&sample.mu).map(|(g, mu)| g.im / COMPLEX_STEP * mu).sum()
                })
                .collect();
            let r = reaction(&case, &sample.q, &sample.mu, &case.p, sample.t);
            assert_close(&case.name, &r, &gradient_times_mu, 1e-12);
        });
    }
}

/// Reaction, g, dg/dt and d2g/dt2 of the arguments (a, v, q, mu, p, t), one after the other.
fn everything<S: RunScalar>(case: &Case, arguments: &[S]) -> Vec<S> {
    let n = case.constraint.dof_count();
    let (a, rest) = arguments.split_at(n);
    let (v, rest) = rest.split_at(n);
    let (q, rest) = rest.split_at(n);
    let (mu, rest) = rest.split_at(case.constraint.equation_count());
    let (p, t) = rest.split_at(case.p.len());
    let mut all = reaction(case, q, mu, p, t[0]);
    all.extend(derivatives(case, State { a, v, q }, p, t[0]).into_iter().flatten());
    all
}

#[test]
fn tangents_equal_complex_step_for_reaction_and_all_levels_in_every_argument() {
    for case in cases() {
        for_all_samples(&case, |sample| {
            let at = [&sample.a[..], &sample.v, &sample.q, &sample.mu, &case.p, &[sample.t]].concat();
            for first in (0..at.len()).step_by(TANGENTS) {
                let lanes = TANGENTS.min(at.len() - first);
                let mut seeded: Vec<Tangents> = at.iter().map(|&x| x.into()).collect();
                for lane in 0..lanes {
                    seeded[first + lane].add_to_part(lane, 1.0);
                }
                let by_tangents = everything(&case, &seeded);
                for lane in 0..lanes {
                    let mut stepped = complex(&at);
                    stepped[first + lane].im = COMPLEX_STEP;
                    let by_step: Vec<_> = everything(&case, &stepped).iter().map(|x| x.im / COMPLEX_STEP).collect();
                    let column: Vec<_> = by_tangents.iter().map(|x| x.part(lane)).collect();
                    let place = format!("{}, derivative to entry {} of (a, v, q, mu, p, t)", case.name, first + lane);
                    assert_close(&place, &column, &by_step, 1e-12);
                }
            }
        });
    }
}

#[test]
fn consistent_configuration_stays_consistent_when_moved_rigidly() {
    let turn = Quaternion::about(Vector3::new(0.48, -0.6, 0.64), 1.1);
    for case in cases() {
        // a point has no frame, so what it sees is seen from the world
        let q = case.coordinates(Vector3::new(0.9, -0.4, 0.2), turn, case.placed);
        let rows = case.constraint.equation_count();
        assert_close(&case.name, &value(&case, &q, &case.p, NOW), &vec![0.0; rows], 1e-14);
        for (k, translation) in [Vector3::new(0.4, -1.3, 2.1), Vector3::new(-7.0, 3.0, 0.5)].into_iter().enumerate() {
            let rotation = Quaternion([0.5, -0.5, 0.7 - k as f64, 0.1]);
            // coordinates of no place stay as they are
            let (places, scalars) = q.split_at(q.len() - case.scalars);
            let moved = [&RigidMotion { rotation, translation }.of_coordinates(&case.nodes, places)[..], scalars].concat();
            assert_close(&case.name, &value(&case, &moved, &case.p, NOW), &vec![0.0; rows], 1e-13);
        }
    }
}

#[test]
fn rows_are_zero_exactly_where_the_joint_leaves_freedom() {
    for case in cases() {
        for Move { what, to, violated } in &case.moves {
            // body a in the axes of the world, so that shifts seen from a are rows of g
            let q = case.coordinates(Vector3::new(0.9, -0.4, 0.2), Quaternion::identity(), *to);
            for (row, g) in value(&case, &q, &case.p, NOW).into_iter().enumerate() {
                // rows are lengths and angles, so that a small step away shows at its own size
                let (size, limit) = if violated.contains(&row) { (STEP, 1e-2 * STEP) } else { (0.0, 1e-14) };
                assert!((g.abs() - size).abs() <= limit, "{}, {what}: row {row} is {g}, not {size}", case.name);
            }
        }
    }
}

#[test]
fn euler_parameters_of_another_length_violate_their_norm_whatever_the_rotation() {
    for scale in [0.5, 0.9, 1.0, 1.1] {
        let turn = Quaternion::about(AXIS, 2.0);
        let q = [&[0.3, 0.4, 0.5][..], &turn.0.map(|e| e * scale)].concat();
        let mut g = [0.0];
        EulerParameterNorm.g(&q, &[], 0.0, &mut g);
        assert_close("norm", &g, &[0.5 * (scale * scale - 1.0)], 1e-15);
    }
}

#[test]
fn prescribed_rotation_follows_several_turns_and_sees_every_angle_off() {
    let drive = PrescribedRotation { nodes: [Body; 2], angle: TimeFunction::ConstantRate };
    let (offset, rate) = (0.2, 9.0);
    let p = [&AXIS.components()[..], &NORMAL_U.components(), &NORMAL_U.components(), &[offset, rate]].concat();
    let case = Case::new("driven", drive, &p, Placement::default());
    let of_a = Quaternion::about(Vector3::new(0.48, -0.6, 0.64), 1.1);
    // 4 seconds are almost 6 turns forwards, and as many backwards
    for k in -40..=40 {
        let t = f64::from(k) / 10.0;
        for off in [0.0, 1e-6, -0.5, 2.0, -3.1, 3.1] {
            let placed = case.placed.turned(AXIS, offset + rate * t + off);
            let g = value(&case, &case.coordinates(Vector3::zeros(), of_a, placed), &p, t);
            assert_close(&format!("t = {t}"), &g, &[off], 1e-13);
        }
        let half_a_turn = case.placed.turned(AXIS, offset + rate * t + std::f64::consts::PI);
        let g = value(&case, &case.coordinates(Vector3::zeros(), of_a, half_a_turn), &p, t);
        assert_close(&format!("half a turn off at t = {t}"), &[g[0].abs()], &[std::f64::consts::PI], 1e-13);
    }
}

/// For a joint that turns b about [`AXIS`] of a: what g[row] becomes when b stands `beyond` [rad] past where it should be.
fn assert_counts_turns(case: &Case, row: usize, by: f64, place: impl Fn(f64) -> (Placement, f64)) {
    let of_a = Quaternion::about(Vector3::new(0.48, -0.6, 0.64), 1.1);
    // more than six turns both ways
    for k in -40..=40 {
        for beyond in [0.0, 1e-6, -0.5, 2.0, -3.1, 3.1] {
            let (placed, angle) = place(f64::from(k));
            let placed = placed.turned(AXIS, angle + beyond);
            let g = value(case, &case.coordinates(Vector3::zeros(), of_a, placed), &case.p, NOW);
            let mut expected = vec![0.0; g.len()];
            expected[row] = by * beyond;
            assert_close(&format!("{}: {angle} rad and {beyond}", case.name), &g, &expected, 1e-13);
        }
    }
}

#[test]
fn a_screw_advances_by_its_pitch_with_every_turn() {
    let case = cases().into_iter().find(|case| case.name == "helical").expect("listed");
    let pitch = case.p[18];
    assert_counts_turns(&case, 4, pitch / TAU, |k| {
        let advance = k * 0.161 * pitch;
        (Placement { offset: AXIS * advance, ..Placement::default() }, advance * TAU / pitch)
    });
}

#[test]
fn an_angle_coordinate_counts_turns() {
    let case = cases().into_iter().find(|case| case.name == "angle coordinate").expect("listed");
    assert_counts_turns(&case, 0, 1.0, |k| (Placement { scalars: [k, 0.0], ..Placement::default() }, k));
}

#[test]
fn a_rack_moves_by_the_radius_times_the_angle_of_its_pinion() {
    let case = cases().into_iter().find(|case| case.name == "rack and pinion").expect("listed");
    let radius = case.p[18];
    for k in -40..=40 {
        let angle = f64::from(k);
        for beyond in [0.0, 1e-6, -0.5, 2.0, -3.1, 3.1] {
            let pinion = Quaternion::about(AXIS, angle + beyond);
            let placed = Placement { offset: NORMAL_W * (radius * angle), pinion, ..Placement::default() };
            let g = value(&case, &case.coordinates(Vector3::zeros(), pinion, placed), &case.p, NOW);
            assert_close(&format!("{angle} rad and {beyond}"), &g, &[radius * beyond], 1e-13);
        }
    }
    let q = case.coordinates(Vector3::zeros(), Quaternion::identity(), case.placed);
    let r = reaction(&case, &q, &[3.0], &case.p, NOW);
    assert_close("force on the rack", &r[14..17], &(NORMAL_W * -3.0).components(), 1e-14);
}

/// Rows of the slope seen from a, which no move of a rigid body shows one by one.
#[test]
fn a_weld_that_holds_the_vector_of_a_slope_sees_tilt_and_stretch() {
    let case = cases().into_iter().find(|case| case.name == "cable welded to Body").expect("listed");
    let mut q = case.coordinates(Vector3::zeros(), Quaternion::about(NORMAL_U, 0.8), case.placed);
    let off = [0.3, -0.2, 0.1];
    let slope = Quaternion::about(NORMAL_U, 0.8).rotate(AXIS + Vector3::from(off));
    let first = q.len() - 3;
    q[first..].copy_from_slice(&slope.components());
    let g = value(&case, &q, &case.p, NOW);
    assert_close(&case.name, &g, &[&[0.0; 3][..], &off].concat(), 1e-14);
}

/// Force of the constraint on the node of b [N]: the first three entries of -A^T mu there.
fn force_on_b(case: &Case, q: &[f64], mu: &[f64]) -> [f64; 3] {
    let r = reaction(case, q, mu, &case.p, NOW);
    let first = case.nodes[0].dofs();
    [-r[first], -r[first + 1], -r[first + 2]]
}

#[test]
fn multipliers_are_the_forces_that_the_joints_say() {
    for case in cases().iter().filter(|case| case.nodes.len() == 2 && case.scalars == 0) {
        let q = case.coordinates(Vector3::new(0.9, -0.4, 0.2), Quaternion::identity(), case.placed);
        let force = |mu: &[f64]| force_on_b(case, &q, mu);
        if case.name.starts_with("distance") {
            // a tension of 3 N draws b towards a
            assert_close(&case.name, &force(&[3.0]), &(AXIS * -3.0).components(), 1e-14);
        } else if case.name.starts_with("spherical") {
            // the force of a on b is opposite to that of b on a
            assert_close(&case.name, &force(&[1.0, 2.0, 3.0]), &[-1.0, -2.0, -3.0], 1e-14);
        } else if case.name == "rigid link Body to Point" {
            assert_close(&case.name, &force(&[1.0, 2.0, 3.0]), &[-1.0, -2.0, -3.0], 1e-14);
        } else if case.name.contains("translation") || case.name.contains("in plane") {
            assert_close(&case.name, &force(&[-3.0]), &(AXIS * 3.0).components(), 1e-14);
        } else if case.name.contains("rotation") && case.nodes == [Body, Body] {
            // the power of the driving moment 3 N m on b while b turns by 0.8 rad/s about the axis, a at rest
            let r = reaction(case, &q, &[-3.0], &case.p, NOW);
            let rate = case.placed.turn.rate_of_body_velocity(AXIS * 0.8);
            let power: f64 = r[10..].iter().zip(rate).map(|(r, rate)| -r * rate).sum();
            assert_close(&case.name, &[power], &[3.0 * 0.8], 1e-14);
            assert_close(&case.name, &force(&[-3.0]), &[0.0; 3], 1e-14);
        }
    }
}

#[test]
fn rows_are_the_gradients_of_all_levels() {
    for case in cases() {
        for_all_samples(&case, |sample| {
            let n = sample.q.len();
            let rows = case.constraint.rows(&sample.q, &case.p, sample.t);
            let (q, p, t) = (complex(&sample.q), complex(&case.p), sample.t.into());
            for column in 0..n {
                let stepped = |x: &[f64]| {
                    let mut x = complex(x);
                    x[column].im = COMPLEX_STEP;
                    x
                };
                let (a, v) = (complex(&sample.a), complex(&sample.v));
                let of_q = derivatives(&case, State { a: &a, v: &v, q: &stepped(&sample.q) }, &p, t);
                let of_v = derivatives(&case, State { a: &a, v: &stepped(&sample.v), q: &q }, &p, t);
                let of_a = derivatives(&case, State { a: &stepped(&sample.a), v: &v, q: &q }, &p, t);
                let part = |g: &[[Complex64; 3]], order: usize| g.iter().map(|g| g[order].im / COMPLEX_STEP).collect();
                let own: Vec<f64> = rows.iter().skip(column).step_by(n).copied().collect();
                // A is what positions, rates and second rates depend on positions, velocities and accelerations by
                for exact in [part(&of_q, 0), part(&of_v, 1), part(&of_a, 2)] {
                    let exact: Vec<f64> = exact;
                    assert_close(&case.name, &own, &exact, 1e-12);
                }
                // and dA/dt is what rates depend on positions by, and half of what second rates depend on velocities by
                let (rates, halves): (Vec<f64>, Vec<f64>) = (part(&of_q, 1), part(&of_v, 2));
                assert_close(&case.name, &rates, &halves.iter().map(|x| 0.5 * x).collect::<Vec<_>>(), 1e-12);
            }
        });
    }
}

#[test]
fn constraints_depend_on_time_where_they_prescribe_a_motion() {
    for case in cases() {
        let depends = samples(&case).iter().any(|sample| {
            let t = Complex64::new(sample.t, COMPLEX_STEP);
            value(&case, &complex(&sample.q), &complex(&case.p), t).iter().any(|g| g.im != 0.0)
        });
        // a drive may hold still
        let drive = case.name.contains(" rotation") || case.name.contains(" translation");
        let may = !case.name.starts_with("constant ") || case.name.starts_with("constant rate");
        assert_eq!(depends, drive && may, "{}", case.name);
        let program = case.constraint.formula().values();
        assert_eq!(program.reads().last(), Some(&depends), "{}: the recording reads the time", case.name);
    }
}

#[test]
fn separable_constraints_couple_no_two_nodes() {
    let (mut separable, mut coupled) = (0, 0);
    for case in cases().iter().filter(|case| case.nodes.len() == 2 && case.scalars == 0) {
        let nodes: Vec<usize> = case.nodes.iter().map(|node: &NodeKind| node.dofs()).collect();
        let mut couples = false;
        for sample in samples(case) {
            for column in 0..sample.q.len() {
                let mut q = complex(&sample.q);
                q[column].im = COMPLEX_STEP;
                let r = reaction(case, &q, &complex(&sample.mu), &complex(&case.p), sample.t.into());
                let other = if column < nodes[0] { &r[nodes[0]..] } else { &r[..nodes[0]] };
                couples |= other.iter().any(|r| r.im != 0.0);
            }
        }
        let said = case.constraint.is_separable(&nodes);
        assert!(!(said && couples), "{}", case.name);
        assert_eq!(said, !couples, "{}: what is read off the recording misses nothing", case.name);
        separable += usize::from(said);
        coupled += usize::from(!said);
    }
    assert!(separable > 0 && coupled > 0);
}
