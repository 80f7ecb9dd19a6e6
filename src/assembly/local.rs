//! Constraints inside a node: satisfied there, and removed from the matrix exactly.
//!
//! With B = A^T (the reaction's direction) and C the derivative of the node's own equations with respect to its unknowns
//! (at acceleration level A + 2 beta dA/dt + ..., so C is not B^T), the matrix gets N_L^T J N_R, where N_L is orthogonal to B and
//! N_R to C, both orthonormal. Unknowns move along N_R and are then brought back onto the node's equations.

use super::numbering::{Local, System};
use super::residual::{LocalVec, select, write_level};
use super::{Equations, Level, Unknowns, VectorsAvq};
use crate::elements::{RunScalar, State};
use crate::scalar::{LANES, Lanes, Scalar, Taylor};
use smallvec::SmallVec;

/// Rows A (equations by coordinates, row-major) of a node's own constraint.
pub(super) fn reaction_rows<S: RunScalar>(local: &Local, q: &[S], t: f64) -> LocalVec<S> {
    let count = local.equations.len();
    let mut rows: LocalVec<S> = SmallVec::from_elem(S::zero(), count * q.len());
    let mut unit: LocalVec<S> = SmallVec::from_elem(S::zero(), count);
    for row in 0..count {
        unit[row] = S::one();
        let own = &mut rows[row * q.len()..(row + 1) * q.len()];
        S::constraint(&*local.physics).add_reaction(q, &unit, &[], S::from(t), own);
        unit[row] = S::zero();
    }
    rows
}

/// Multipliers m with rows (f + rows^T m) = 0.
pub(super) fn least_squares<S: Scalar>(rows: &[S], count: usize, f: &[S]) -> LocalVec<S> {
    let n = f.len();
    let row = |i: usize| &rows[i * n..(i + 1) * n];
    let dot = |a: &[S], b: &[S]| a.iter().zip(b).map(|(&a, &b)| a * b).sum::<S>();
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
pub(super) fn equation_rows(local: &Local, equations: &Equations, node: State<f64>, t: f64) -> LocalVec<f64> {
    let n = node.q.len();
    let stabilized = equations.level == Level::Stabilized;
    let columns = if stabilized { 2 * n } else { n };
    let count = local.equations.len();
    let mut rows: LocalVec<f64> = SmallVec::from_elem(0.0, columns * if stabilized { 2 * count } else { count });
    let lanes = |x: &[f64]| -> LocalVec<Lanes> { x.iter().map(|&x| Lanes::constant(x)).collect() };
    let (mut a, mut v, mut q) = (lanes(node.a), lanes(node.v), lanes(node.q));
    let (shift, scales) = (equations.constraint, equations.row_scales());
    let mut g: SmallVec<[Taylor<Lanes>; 6]> = SmallVec::from_elem(Taylor::default(), count);
    for first in (0..columns).step_by(LANES) {
        let width = LANES.min(columns - first);
        for lane in 0..width {
            let (dof, rate) = ((first + lane) % n, first + lane >= n);
            a[dof].eps[lane] = if rate { 0.0 } else { shift.gamma };
            v[dof].eps[lane] = if rate { 0.0 } else { shift.beta };
            q[dof].eps[lane] = shift.alpha;
        }
        let state = State { a: &a, v: &v, q: &q };
        write_level(Lanes::constraint(&*local.physics), equations.level, state, &[], Lanes::from(t), &mut g);
        for (row, g) in g.iter().enumerate() {
            let (value, second) = select(equations.level, *g);
            for lane in 0..width {
                rows[row * columns + first + lane] = value.eps[lane] * scales[0];
                if stabilized {
                    rows[(count + row) * columns + first + lane] = second.eps[lane] * scales[1];
                }
            }
        }
        for lane in 0..width {
            let dof = (first + lane) % n;
            (a[dof].eps[lane], v[dof].eps[lane], q[dof].eps[lane]) = (0.0, 0.0, 0.0);
        }
    }
    rows
}

/// Most corrections of a node's own equations; each gains many digits.
const RESTORATIONS: usize = 8;

/// Moves x (and y) of each node along C^T until the node's own equations hold to round-off, in every derivative part; with
/// `keep_values` in the derivative parts only.
pub(super) fn restore<S: RunScalar>(
    system: &System,
    equations: &Equations,
    base: &VectorsAvq<S>,
    unknowns: &mut Unknowns<S>,
    keep_values: bool,
) {
    // Euler parameters do not depend on time: the equations of nodes are taken at t = 0
    let t = 0.0;
    for local in system.eliminated() {
        let dofs = system.model.nodes[local.node].dofs.clone();
        let n = dofs.len();
        let count = local.equations.len();
        let scales = equations.row_scales();
        let stabilized = equations.level == Level::Stabilized;
        let mut rows: Option<LocalVec<f64>> = None;
        let mut previous = f64::INFINITY;
        for _ in 0..RESTORATIONS {
            let (mut a, mut v, mut q) = (LocalVec::new(), LocalVec::new(), LocalVec::new());
            for i in dofs.clone() {
                let x = unknowns.x[i];
                let y = unknowns.y.get(i).copied().unwrap_or_default();
                a.push(base.a[i] + x * equations.constraint.gamma);
                v.push(base.v[i] + x * equations.constraint.beta);
                q.push(base.q[i] + (x + y) * equations.constraint.alpha);
            }
            let mut g: SmallVec<[Taylor<S>; 6]> = SmallVec::from_elem(Taylor::default(), count);
            let state = State { a: &a, v: &v, q: &q };
            write_level(S::constraint(&*local.physics), equations.level, state, &[], S::from(t), &mut g);
            let mut residual: LocalVec<S> = g.iter().map(|&g| select(equations.level, g).0 * scales[0]).collect();
            if stabilized {
                residual.extend(g.iter().map(|&g| select(equations.level, g).1 * scales[1]));
            }
            let size = residual.iter().map(|&r| magnitude(r)).fold(0.0, f64::max);
            // nothing is gained below the round-off of the equation's own terms (derivative parts have their own size)
            let term = |(q, (v, a)): (&S, (&S, &S))| {
                let (q, v, a) = (q.value().abs(), v.value().abs(), a.value().abs());
                match equations.level {
                    Level::Position => q * q,
                    Level::Velocity => q * v,
                    Level::Acceleration => q * a + v * v,
                    Level::Stabilized => 0.0,
                }
            };
            let terms: f64 = q.iter().zip(v.iter().zip(&a)).map(term).sum();
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
                let (a, v, q) = (real(&a), real(&v), real(&q));
                equation_rows(local, equations, State { a: &a, v: &v, q: &q }, t)
            });
            let total = residual.len();
            let columns = rows.len() / total;
            let rows: LocalVec<S> = rows.iter().map(|&r| S::from(r)).collect();
            let row = |i: usize| &rows[i * columns..(i + 1) * columns];
            let dot = |i: usize, j: usize| row(i).iter().zip(row(j)).map(|(&a, &b)| a * b).sum::<S>();
            let mut normal: LocalVec<S> = (0..total * total).map(|ij| dot(ij / total, ij % total)).collect();
            solve_positive(&mut normal, &mut residual);
            for (i, &multiplier) in residual.iter().enumerate() {
                for (column, &c) in row(i).iter().enumerate() {
                    let target = if column < n { &mut unknowns.x } else { &mut unknowns.y };
                    target[dofs.start + column % n] -= c * multiplier;
                }
            }
        }
    }
}

/// Size of a number with its derivative parts.
fn magnitude<S: RunScalar>(s: S) -> f64 {
    (0..S::PARTS).map(|part| s.part(part).abs()).fold(s.value().abs(), f64::max)
}

/// Orthonormal basis (n by n - rows, row-major) of the vectors at right angles to the given rows, by Householder reflections
/// with the largest entry as pivot, so that unit vectors of untouched coordinates stay unit vectors.
pub(super) fn complement(rows: &[f64], count: usize, n: usize, basis: &mut Vec<f64>) {
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
