//! Constraints inside a node: satisfied there, and removed from the matrix exactly.
//!
//! With B = A^T (the reaction's direction) and C the derivative of the node's own equations with respect to its unknowns
//! (at acceleration level A + 2 beta dA/dt + ..., so C is not B^T), the matrix gets N_L^T J N_R, where N_L is orthogonal to B and
//! N_R to C, both orthonormal. Unknowns move along N_R and are then brought back onto the node's equations.

use super::node_runs::NodeRun;
use super::numbering::{NodeConstraint, System};
use super::quadratic::UnitLength;
use super::residual::{LocalVec, select};
use super::{Equations, Level, Rates, StageCoefficients, Unknowns, VectorsAvq};
use crate::elements::{RunScalar, State};
use crate::linalg::{Kernel, dispatch};
use crate::scalar::Scalar;
use smallvec::SmallVec;

/// Rows A (equations by coordinates, row-major) of a node's own constraint.
pub(super) fn reaction_rows<S: RunScalar>(local: &NodeConstraint, q: &[S]) -> LocalVec<S> {
    let mut rows: LocalVec<S> = SmallVec::from_elem(S::zero(), local.equations.len() * q.len());
    local.form.rows(q, &mut rows);
    rows
}

/// Multipliers m with rows (f + rows^T m) = 0.
pub(super) fn least_squares<S: Scalar>(rows: &[S], count: usize, f: &[S]) -> LocalVec<S> {
    let n = f.len();
    let row = |i: usize| &rows[i * n..(i + 1) * n];
    let dot = |a: &[S], b: &[S]| a.iter().zip(b).map(|(&a, &b)| a * b).sum::<S>();
    if count == 1 {
        return SmallVec::from_elem(-(dot(rows, f) / dot(rows, rows)), 1);
    }
    let mut rhs: LocalVec<S> = (0..count).map(|i| -dot(row(i), f)).collect();
    let mut normal: LocalVec<S> = (0..count * count).map(|ij| dot(row(ij / count), row(ij % count))).collect();
    solve_positive(&mut normal, &mut rhs);
    rhs
}

/// Solves a small symmetric positive system in place by elimination.
fn solve_positive<S: Scalar>(matrix: &mut [S], rhs: &mut [S]) {
    let n = rhs.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = matrix[i * n + k] / matrix[k * n + k];
            for j in k..n {
                let above = matrix[k * n + j];
                matrix[i * n + j] -= factor * above;
            }
            let above = rhs[k];
            rhs[i] -= factor * above;
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            let known = rhs[j];
            rhs[k] -= matrix[k * n + j] * known;
        }
        rhs[k] /= matrix[k * n + k];
    }
}

/// f += rows^T multipliers.
pub(super) fn add_combination<S: Scalar>(rows: &[S], multipliers: &[S], f: &mut [S]) {
    let n = f.len();
    for (row, &m) in multipliers.iter().enumerate() {
        for (f, &a) in f.iter_mut().zip(&rows[row * n..(row + 1) * n]) {
            *f += a * m;
        }
    }
}

/// C: derivative of the node's scaled equations with respect to its unknowns (x, or x then y), row-major, at a real point.
pub(super) fn equation_rows(local: &NodeConstraint, equations: &Equations, node: State<f64>) -> LocalVec<f64> {
    let n = node.q.len();
    let mut gradients: SmallVec<[Rates<f64>; 16]> = SmallVec::from_elem(Rates::zero(), local.equations.len() * n);
    local.form.moving_rows(node, &mut gradients);
    rows_of(&gradients, n, equations)
}

/// The same from the rows A (equations by `n` coordinates, row-major) along the motion.
pub(super) fn rows_of(gradients: &[Rates<f64>], n: usize, equations: &Equations) -> LocalVec<f64> {
    let (count, stabilized) = (gradients.len() / n, equations.level == Level::Stabilized);
    let columns = if stabilized { 2 * n } else { n };
    let mut rows: LocalVec<f64> = SmallVec::from_elem(0.0, columns * if stabilized { 2 * count } else { count });
    for (place, &gradient) in gradients.iter().enumerate() {
        let (row, dof) = (place / n, place % n);
        let [x, y] = equations.row_entries(gradient);
        rows[row * columns + dof] = x[0];
        if stabilized {
            rows[row * columns + n + dof] = y[0];
            rows[(count + row) * columns + dof] = x[1];
            rows[(count + row) * columns + n + dof] = y[1];
        }
    }
    rows
}

/// Moves x (and y) of each node along C^T until the node's own equations hold to round-off, in every derivative part; with
/// `keep_values` in the derivative parts only; at most `corrections` times.
pub(super) fn restore<S: RunScalar>(
    system: &System,
    equations: &Equations,
    base: &VectorsAvq<S>,
    unknowns: &mut Unknowns<S>,
    keep_values: bool,
    corrections: usize,
    work: &mut VectorsAvq<S>,
) {
    if S::PARTS == 0 && corrections == 1 && equations.level != Level::Stabilized {
        return correct_once(system, equations, base, unknowns);
    }
    for local in system.eliminated() {
        let dofs = system.model.nodes[local.node].dofs.clone();
        if let (Some(unit), true) = (local.form.unit_length(), S::PARTS == 0 && equations.level != Level::Stabilized) {
            if !keep_values {
                restore_unit_length(unit, dofs.start, equations, base, unknowns, corrections);
            }
            continue;
        }
        let n = dofs.len();
        let count = local.equations.len();
        let scales = equations.row_scales();
        let stabilized = equations.level == Level::Stabilized;
        let mut rows: Option<LocalVec<f64>> = None;
        let mut previous = f64::INFINITY;
        for _ in 0..corrections {
            let VectorsAvq { a, v, q } = &mut *work;
            let x = &unknowns.x[dofs.clone()];
            for (own, base, factor) in [
                (&mut *a, &base.a, equations.constraint.gamma),
                (&mut *v, &base.v, equations.constraint.beta),
                (&mut *q, &base.q, equations.constraint.alpha),
            ] {
                own.clear();
                own.extend(base[dofs.clone()].iter().zip(x).map(|(&base, &x)| base + x * factor));
            }
            for (q, &y) in q.iter_mut().zip(unknowns.y.get(dofs.clone()).unwrap_or_default()) {
                *q += y * equations.constraint.alpha;
            }
            let mut g: SmallVec<[Rates<S>; 6]> = SmallVec::from_elem(Rates::zero(), count);
            let state = State { a, v, q };
            local.form.derivatives(state, &mut g);
            let mut residual: LocalVec<S> = g.iter().map(|&g| select(equations.level, g).0 * scales[0]).collect();
            if stabilized {
                residual.extend(g.iter().map(|&g| select(equations.level, g).1 * scales[1]));
            }
            let size = residual.iter().map(|&r| magnitude(r)).fold(0.0, f64::max);
            // nothing is gained below the round-off of the equation's own terms (derivative parts have their own size)
            let terms = local.form.size_of_terms(equations.level, State { a, v, q });
            let value_settled =
                keep_values || residual.iter().all(|r| r.value().abs() <= f64::EPSILON * terms * scales[0].abs());
            if value_settled && S::PARTS == 0 {
                break;
            }
            if value_settled {
                // only derivative parts are corrected: a value at round-off stays what it is
                residual.iter_mut().for_each(|r| *r -= S::from(r.value()));
            }
            // below a quarter of the last one: still converging; otherwise round-off is reached
            if size == 0.0 || size >= 0.25 * previous {
                break;
            }
            previous = size;
            let rows = rows.get_or_insert_with(|| {
                let real = |x: &[S]| x.iter().map(|x| x.value()).collect::<LocalVec<_>>();
                let (a, v, q) = (real(a), real(v), real(q));
                equation_rows(local, equations, State { a: &a, v: &v, q: &q })
            });
            let total = residual.len();
            let columns = rows.len() / total;
            let row = |i: usize| &rows[i * columns..(i + 1) * columns];
            let dot = |i: usize, j: usize| row(i).iter().zip(row(j)).fold(0.0, |sum, (a, b)| sum + a * b);
            if total == 1 {
                residual[0] = residual[0] / dot(0, 0);
            } else {
                let mut normal: LocalVec<S> = (0..total * total).map(|ij| S::from(dot(ij / total, ij % total))).collect();
                solve_positive(&mut normal, &mut residual);
            }
            for (i, &multiplier) in residual.iter().enumerate() {
                let (towards_x, towards_y) = row(i).split_at(n);
                for (target, rows) in [(&mut unknowns.x, towards_x), (&mut unknowns.y, towards_y)] {
                    if !rows.is_empty() {
                        target[dofs.clone()].iter_mut().zip(rows).for_each(|(x, &c)| *x -= multiplier * c);
                    }
                }
            }
        }
    }
}

/// One correction of every node that is off by more than round-off; the next evaluation follows anyway.
fn correct_once<S: RunScalar>(system: &System, equations: &Equations, base: &VectorsAvq<S>, unknowns: &mut Unknowns<S>) {
    let StageCoefficients { gamma, beta, alpha } = equations.constraint;
    let scale = equations.row_scales()[0];
    let [by_value, by_rate, by_second] = equations.row_weights();
    let mut rows = LocalVec::<S>::new();
    let (mut a, mut v, mut q) = (LocalVec::<S>::new(), LocalVec::<S>::new(), LocalVec::<S>::new());
    for run in &system.node_runs {
        let locals = run.locals(system);
        if let Some(unit) = locals.first().and_then(|local| local.form.unit_length()) {
            dispatch(CorrectUnitLengths { unit, run, equations, weights: [by_value, by_rate, by_second], base, unknowns });
            continue;
        }
        for local in locals {
            let dofs = system.model.nodes[local.node].dofs.clone();
            let x = &mut unknowns.x[dofs.clone()];
            for (own, base, factor) in [(&mut a, &base.a, gamma), (&mut v, &base.v, beta), (&mut q, &base.q, alpha)] {
                own.resize(x.len(), S::zero());
                for (own, (&base, &x)) in own.iter_mut().zip(base[dofs.clone()].iter().zip(&*x)) {
                    *own = base + x * factor;
                }
            }
            let mut g: SmallVec<[Rates<S>; 6]> = SmallVec::from_elem(Rates::zero(), local.equations.len());
            local.form.derivatives(State { a: &a, v: &v, q: &q }, &mut g);
            let terms = local.form.size_of_terms(equations.level, State { a: &a, v: &v, q: &q });
            for (equation, &g) in g.iter().enumerate() {
                let gap = select(equations.level, g).0;
                if gap.value().abs() <= f64::EPSILON * terms {
                    continue;
                }
                rows.clear();
                rows.resize(x.len(), S::zero());
                local.form.add_row(equation, [(by_value, &q), (by_rate, &v), (by_second, &a)], &mut rows);
                let norm = rows.iter().fold(S::zero(), |sum, &c| sum + c * c);
                let multiplier = gap * scale / norm;
                x.iter_mut().zip(&rows).for_each(|(x, &c)| *x -= multiplier * c);
            }
        }
    }
}

/// One correction of the Euler parameters of all nodes of a run.
struct CorrectUnitLengths<'r, S> {
    unit: UnitLength,
    run: &'r NodeRun,
    equations: &'r Equations,
    weights: [f64; 3],
    base: &'r VectorsAvq<S>,
    unknowns: &'r mut Unknowns<S>,
}

impl<S: RunScalar> Kernel for CorrectUnitLengths<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let CorrectUnitLengths { unit, run, equations, weights, base, unknowns } = self;
        for start in run.starts() {
            correct_unit_length(unit, start, equations, weights, base, unknowns);
        }
    }
}

/// Corrects Euler parameters of a node until they have unit length to round-off.
fn restore_unit_length<S: RunScalar>(
    unit: UnitLength,
    start: usize,
    equations: &Equations,
    base: &VectorsAvq<S>,
    unknowns: &mut Unknowns<S>,
    corrections: usize,
) {
    let mut previous = f64::INFINITY;
    for _ in 0..corrections {
        let gap = correct_unit_length(unit, start, equations, equations.row_weights(), base, unknowns);
        // below a quarter of the last one: still converging
        if gap == 0.0 || gap >= 0.25 * previous {
            return;
        }
        previous = gap;
    }
}

/// One correction of Euler parameters of a node that starts at a coordinate. Returns what was corrected, 0 for round-off.
#[inline(always)]
fn correct_unit_length<S: RunScalar>(
    unit: UnitLength,
    start: usize,
    equations: &Equations,
    weights: [f64; 3],
    base: &VectorsAvq<S>,
    unknowns: &mut Unknowns<S>,
) -> f64 {
    let StageCoefficients { gamma, beta, alpha } = equations.constraint;
    let places = start + unit.first..start + unit.first + 4;
    let x: &mut [S; 4] = unknowns.x[places.clone()].first_chunk_mut().expect("four parameters");
    let own = |base: &[S], factor: f64| -> [S; 4] {
        let base: &[S; 4] = base[places.clone()].first_chunk().expect("four parameters");
        std::array::from_fn(|i| base[i] + x[i] * factor)
    };
    let (a, v, q) = (own(&base.a, gamma), own(&base.v, beta), own(&base.q, alpha));
    let size = |x: &[S; 4], y: &[S; 4]| (0..4).fold(0.0, |sum, i| sum + (x[i].value() * y[i].value()).abs());
    let (gap, terms) = match equations.level {
        Level::Position => (dot4(&q, &q) * (0.5 * unit.second) + unit.constant, 0.5 * size(&q, &q) + 0.5),
        Level::Velocity => (dot4(&q, &v) * unit.second, size(&q, &v)),
        _ => ((dot4(&q, &a) + dot4(&v, &v)) * unit.second, size(&q, &a) + size(&v, &v)),
    };
    if gap.value().abs() <= f64::EPSILON * terms * unit.second {
        return 0.0;
    }
    let row: [S; 4] = std::array::from_fn(|i| (q[i] * weights[0] + v[i] * weights[1] + a[i] * weights[2]) * unit.second);
    let multiplier = gap * equations.row_scales()[0] / dot4(&row, &row);
    x.iter_mut().zip(row).for_each(|(x, row)| *x -= multiplier * row);
    gap.value().abs()
}

/// Product of four numbers with four.
#[inline(always)]
pub(super) fn dot4<S: Scalar>(x: &[S], y: &[S]) -> S {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2] + x[3] * y[3]
}

/// Size of a number with its derivative parts.
fn magnitude<S: RunScalar>(s: S) -> f64 {
    (0..S::PARTS).map(|part| s.part(part).abs()).fold(s.value().abs(), f64::max)
}

/// Orthonormal basis (n by n - rows, row-major) of the vectors at right angles to the given rows, by Householder reflections
/// with the largest entry as pivot, so that unit vectors of untouched coordinates stay unit vectors.
pub(super) fn complement(rows: &[f64], count: usize, n: usize, basis: &mut Vec<f64>) {
    if count == 1 {
        return complement_of_one(rows, basis);
    }
    let mut work: LocalVec<f64> = rows.into();
    let mut reflectors: SmallVec<[LocalVec<f64>; 6]> = SmallVec::new();
    let mut pivots: SmallVec<[usize; 6]> = SmallVec::new();
    for k in 0..count {
        let own = &work[k * n..(k + 1) * n];
        let free = |i: &usize| !pivots.contains(i);
        let Some(pivot) = (0..n).filter(free).max_by(|&i, &j| own[i].abs().total_cmp(&own[j].abs())) else { break };
        let mut reflector: LocalVec<f64> = (0..n).map(|i| if free(&i) { own[i] } else { 0.0 }).collect();
        let norm = reflector.iter().map(|v| v * v).sum::<f64>().sqrt();
        reflector[pivot] += norm.copysign(reflector[pivot]);
        for row in k + 1..count {
            reflect(&reflector, &mut work[row * n..(row + 1) * n]);
        }
        pivots.push(pivot);
        reflectors.push(reflector);
    }
    let kept: LocalVec<usize> = (0..n).filter(|i| !pivots.contains(i)).collect();
    basis.clear();
    basis.resize(n * kept.len(), 0.0);
    let mut column: LocalVec<f64> = SmallVec::from_elem(0.0, n);
    for (j, &unit) in kept.iter().enumerate() {
        column.fill(0.0);
        column[unit] = 1.0;
        for reflector in reflectors.iter().rev() {
            reflect(reflector, &mut column);
        }
        for i in 0..n {
            basis[i * kept.len() + j] = column[i];
        }
    }
}

/// The same for one row: I - 2 v v^T / (v . v) without the column of the pivot.
fn complement_of_one(row: &[f64], basis: &mut Vec<f64>) {
    let pivot = (0..row.len()).max_by(|&i, &j| row[i].abs().total_cmp(&row[j].abs())).unwrap_or(0);
    let norm = row.iter().fold(0.0, |sum, v| sum + v * v).sqrt();
    let mut reflector: LocalVec<f64> = row.into();
    reflector[pivot] += norm.copysign(reflector[pivot]);
    let square = reflector.iter().fold(0.0, |sum, v| sum + v * v);
    let factor = if square > 0.0 { 2.0 / square } else { 0.0 };
    basis.clear();
    for (i, &v) in reflector.iter().enumerate() {
        let scaled = factor * v;
        for (j, w) in reflector.iter().enumerate().filter(|(j, _)| *j != pivot) {
            basis.push(f64::from(u8::from(i == j)) - scaled * w);
        }
    }
}

/// x - 2 v (v . x) / (v . v); nothing for v = 0.
fn reflect(v: &[f64], x: &mut [f64]) {
    let square: f64 = v.iter().map(|v| v * v).sum();
    if square > 0.0 {
        let factor = 2.0 * v.iter().zip(&*x).map(|(v, x)| v * x).sum::<f64>() / square;
        for (x, v) in x.iter_mut().zip(v) {
            *x -= factor * v;
        }
    }
}
