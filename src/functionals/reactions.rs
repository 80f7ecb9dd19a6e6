//! Reactions where constraints are redundant: of all multipliers with the same forces, those of least norm.
//!
//! A norm of forces and moments needs a length: L, the root mean square of the lengths among the parameters of the joints. Moments count by
//! m / L, as forces on an arm of this length, so that the split depends on no unit.
//!
//! With A the rows of all equations towards translations and rotations in these measures, K those that are kept, and F = A^T mu the forces of
//! the solved multipliers: mu* = argmin |mu*| subject to A^T mu* = F. Rows of K, orthonormalized, are Q; then A = M Q with M = A Q^T,
//! and mu* = M (M^T M)^-1 Q F, a smooth function of the state that depends on the choice K only by round-off.

use crate::assembly::Model;
use crate::elements::{NodeKind, RunScalar};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use std::ops::Range;

type Matrix<S> = Vec<Vec<S>>;

fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    a.iter().zip(b).map(|(&a, &b)| a * b).sum()
}

fn combination<S: Scalar>(rows: &[Vec<S>], weights: &[S], length: usize) -> Vec<S> {
    let mut sum = vec![S::zero(); length];
    for (row, &weight) in rows.iter().zip(weights) {
        sum.iter_mut().zip(row).for_each(|(sum, &x)| *sum += x * weight);
    }
    sum
}

/// Orthonormalizes independent rows; twice, because once leaves parts of the size of round-off times their dependence.
fn orthonormal<S: RunScalar>(mut rows: Matrix<S>) -> Matrix<S> {
    for i in 0..rows.len() {
        let (done, rest) = rows.split_at_mut(i);
        let own = &mut rest[0];
        for _ in 0..2 {
            for unit in &*done {
                let share = dot(own, unit);
                // rows of a planar mechanism act in its plane or across it
                if share.value() == 0.0 && (0..S::PARTS).all(|part| share.part(part) == 0.0) {
                    continue;
                }
                own.iter_mut().zip(unit).for_each(|(x, &u)| *x -= u * share);
            }
        }
        let norm = dot(own, own).sqrt();
        own.iter_mut().for_each(|x| *x /= norm);
    }
    rows
}

/// Columns of the generalized forces on the moving nodes: force and moment of a body, the coordinates of others.
struct Columns {
    first: Vec<Option<usize>>,
    count: usize,
    /// Those of moments.
    moments: Vec<Range<usize>>,
}

impl Columns {
    fn of(model: &Model) -> Self {
        let (mut count, mut moments) = (0, Vec::new());
        let first: Vec<Option<usize>> = model
            .nodes
            .iter()
            .map(|node| {
                (!node.fixed).then(|| {
                    let first = count;
                    count += if node.kind.has_axes() { 6 } else { node.dofs.len() };
                    moments.extend(node.kind.has_axes().then_some(first + 3..first + 6));
                    first
                })
            })
            .collect();
        Columns { first, count, moments }
    }
}

/// The length by which moments are measured, and the parameters of which it is the root mean square.
struct Length<S> {
    value: S,
    places: Vec<usize>,
}

impl<S: Scalar> Length<S> {
    fn of(model: &Model, p: &[S]) -> Self {
        let joints = model.constraints.iter();
        let mut places: Vec<usize> =
            joints.flat_map(|joint| joint.physics.lengths().iter().map(|own| joint.parameters.start + own)).collect();
        let square = places.iter().map(|&place| p[place] * p[place]).sum::<S>();
        // joints at the origin alone have no length
        if square.value() == 0.0 {
            places.clear();
            return Length { value: S::one(), places };
        }
        let count = places.len() as f64;
        Length { value: (square / S::from(count)).sqrt(), places }
    }

    /// Adds the gradient by the parameters, times a factor.
    fn add_gradient(&self, p: &[S], factor: S, bars: &mut [S]) {
        let by = factor / (self.value * S::from(self.places.len().max(1) as f64));
        self.places.iter().for_each(|&place| bars[place] += by * p[place]);
    }
}

/// Rows A of all constraint equations towards `columns`; the moment on a body is G(e) f / 2 in its frame, with natural coordinates the
/// sum of axis x force on it in the world.
fn rows<S: RunScalar>(model: &Model, columns: &Columns, p: &[S], q: &[S], t: S) -> Matrix<S> {
    let mut all = vec![vec![S::zero(); columns.count]; model.equations];
    for joint in &model.constraints {
        let dofs: Vec<usize> = joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone()).collect();
        let own: Vec<S> = dofs.iter().map(|&dof| q[dof]).collect();
        let all_forces = joint.physics.rows(&own, &p[joint.parameters.clone()], t);
        for (force, equation) in all_forces.chunks_exact(own.len()).zip(joint.equations.clone()) {
            let mut local = 0;
            for node in &joint.nodes {
                let (kind, count) = (model.nodes[node.0].kind, model.nodes[node.0].dofs.len());
                let (force, place) = (&force[local..local + count], &own[local..local + count]);
                local += count;
                let Some(first) = columns.first[node.0] else { continue };
                let target = &mut all[equation][first..];
                if kind.has_axes() {
                    let moment = match kind {
                        NodeKind::Body => {
                            let e = Quaternion::from_slice(&place[3..]);
                            e.g_times(Quaternion::from_slice(&force[3..])) * S::from(0.5)
                        }
                        _ => NodeKind::Natural.moment(place, force),
                    };
                    target
                        .iter_mut()
                        .zip(force[..3].iter().chain(&moment.components()))
                        .for_each(|(target, &f)| *target += f);
                } else {
                    target.iter_mut().zip(force).for_each(|(target, &f)| *target += f);
                }
            }
        }
    }
    all
}

/// What stands between multipliers as solved and those of least norm.
struct Sharing<S> {
    columns: Columns,
    length: Length<S>,
    /// Which equations have moments as multipliers: their rows act on no translation.
    are_moments: Vec<bool>,
    /// A.
    rows: Matrix<S>,
    /// Kept rows.
    kept: Vec<usize>,
    /// Q: an orthonormal basis of the kept rows.
    basis: Matrix<S>,
    /// M^T, and its orthonormalized rows.
    shares: Matrix<S>,
    units: Matrix<S>,
}

impl<S: RunScalar> Sharing<S> {
    fn new(model: &Model, dropped: &[usize], p: &[S], q: &[S], t: S) -> Self {
        let columns = Columns::of(model);
        let length = Length::of(model, p);
        let mut rows = rows(model, &columns, p, q, t);
        let is_moment = |column: usize| columns.moments.iter().any(|own| own.contains(&column));
        let on_points = |row: &Vec<S>| row.iter().enumerate().any(|(i, x)| x.value() != 0.0 && !is_moment(i));
        let are_moments: Vec<bool> = rows.iter().map(|row| !on_points(row)).collect();
        // of an equation of moments the two lengths cancel
        for row in rows.iter_mut().zip(&are_moments).filter(|(_, is_moment)| !**is_moment).map(|(row, _)| row) {
            columns.moments.iter().cloned().flatten().for_each(|column| row[column] /= length.value);
        }
        let kept: Vec<usize> = (0..rows.len()).filter(|row| !dropped.contains(row)).collect();
        let basis = orthonormal(kept.iter().map(|&row| rows[row].clone()).collect());
        let shares: Matrix<S> = basis.iter().map(|unit| rows.iter().map(|row| dot(row, unit)).collect()).collect();
        let units = orthonormal(shares.clone());
        Sharing { columns, length, are_moments, rows, kept, basis, shares, units }
    }

    /// Entry of R in M = P R.
    fn triangle(&self, k: usize, j: usize) -> S {
        dot(&self.units[k], &self.shares[j])
    }

    /// Multipliers times L^power where they are moments.
    fn measured(&self, mu: &[S], power: i32) -> Vec<S> {
        let factor = self.length.value.powi(power);
        mu.iter().zip(&self.are_moments).map(|(&mu, is_moment)| if *is_moment { mu * factor } else { mu }).collect()
    }

    /// mu* = P R^-T Q A^T mu, both as forces.
    fn least(&self, mu: &[S]) -> Vec<S> {
        let force = combination(&self.rows, mu, self.columns.count);
        let mut solved: Vec<S> = Vec::with_capacity(self.basis.len());
        for (j, unit) in self.basis.iter().enumerate() {
            let known: S = (0..j).map(|k| self.triangle(k, j) * solved[k]).sum();
            solved.push((dot(unit, &force) - known) / self.triangle(j, j));
        }
        combination(&self.units, &solved, self.rows.len())
    }

    /// y = A^+ b = Q^T R^-1 P^T b, and the weights of all equations (zero for dropped ones) with y = sum of weights times rows.
    fn pseudoinverse_times(&self, b: &[S]) -> (Vec<S>, Vec<S>) {
        let count = self.basis.len();
        let mut solved = vec![S::zero(); count];
        for k in (0..count).rev() {
            let known: S = (k + 1..count).map(|j| self.triangle(k, j) * solved[j]).sum();
            solved[k] = (dot(&self.units[k], b) - known) / self.triangle(k, k);
        }
        let y = combination(&self.basis, &solved, self.columns.count);
        // the kept rows are L Q with a lower triangle L: L^T weights = the solution
        let mut weights = vec![S::zero(); self.rows.len()];
        for k in (0..count).rev() {
            let unit = &self.basis[k];
            let known: S = (k + 1..count).map(|j| dot(&self.rows[self.kept[j]], unit) * weights[self.kept[j]]).sum();
            weights[self.kept[k]] = (solved[k] - known) / dot(&self.rows[self.kept[k]], unit);
        }
        (y, weights)
    }

    /// Forces in the model's units whose product with a row without measures is that of measured ones: moments by L.
    fn unmeasured_columns(&self, beta: &[S]) -> Vec<S> {
        let mut own = beta.to_vec();
        self.columns.moments.iter().cloned().flatten().for_each(|column| own[column] /= self.length.value);
        own
    }

    /// d (alpha . A beta) / d L.
    fn length_gradient(&self, alpha: &[S], beta: &[S]) -> S {
        let rows = self.rows.iter().zip(alpha).zip(&self.are_moments).filter(|(_, is_moment)| !**is_moment);
        let of_moments = |row: &Vec<S>| -> S {
            self.columns.moments.iter().cloned().flatten().map(|column| row[column] * beta[column]).sum()
        };
        -rows.map(|((row, &alpha), _)| alpha * of_moments(row)).sum::<S>() / self.length.value
    }

    /// What of A^T alpha is not in the span of the kept rows: zero on the constraints, where the dropped rows depend on them.
    fn outside(&self, alpha: &[S]) -> Vec<S> {
        let mut rest = combination(&self.rows, alpha, self.columns.count);
        for unit in &self.basis {
            let share = dot(&rest, unit);
            rest.iter_mut().zip(unit).for_each(|(x, &u)| *x -= u * share);
        }
        rest
    }
}

/// The multipliers of least norm with the same forces as `mu`, which are zero for `dropped` equations.
pub fn least_multipliers<S: RunScalar>(model: &Model, dropped: &[usize], p: &[S], q: &[S], mu: &[S], t: S) -> Vec<S> {
    let sharing = Sharing::new(model, dropped, p, q, t);
    sharing.measured(&sharing.least(&sharing.measured(mu, -1)), 1)
}

/// Share of a multiplier without forces below which it is round-off.
const DETERMINED: f64 = 1e-9;

/// Multipliers that change no force, and can be added to those of least norm: one list for each equation that is left out.
pub(crate) fn multipliers_without_forces(model: &Model, dropped: &[usize], p: &[f64], q: &[f64], t: f64) -> Vec<Vec<f64>> {
    let sharing = Sharing::new(model, dropped, p, q, t);
    let of = |equation: usize| {
        let mut own = vec![0.0; sharing.rows.len()];
        own[equation] = 1.0;
        for unit in &sharing.units {
            let share = unit[equation];
            own.iter_mut().zip(unit).for_each(|(own, unit)| *own -= share * unit);
        }
        own.iter_mut().filter(|own| own.abs() < DETERMINED).for_each(|own| *own = 0.0);
        sharing.measured(&own, 1)
    };
    dropped.iter().map(|&equation| of(equation)).collect()
}

/// Where the adjoints of [`least_multipliers`] go.
pub(super) struct Bars<'b> {
    pub q: &'b mut [f64],
    pub mu: &'b mut [f64],
    pub p: &'b mut [f64],
}

/// Adds (d mu*/d(q, mu, p))^T mu*_bar to `bars`.
///
/// With eta = A^+ mu*_bar = K^T kappa, zeta = A^+ mu* = K^T theta, alpha = mu - mu*, beta = mu*_bar - A eta and W = (I - Q^T Q) A^T:
///
/// d f = alpha . dA eta + beta . dA zeta + kappa . dK W alpha + theta . dK W beta + (A eta) . d mu
///
/// from the derivative of the pseudoinverse of A Q^T Q, whose rank is constant (Golub & Pereyra 1973). W vanishes on the constraints,
/// where dropped rows depend on the kept ones; stages at acceleration level lie beside them. All of these are as forces: what is measured by L
/// depends on it.
pub(super) fn add_least_multipliers_transposed(
    model: &Model,
    dropped: &[usize],
    (p, q, mu): (&[f64], &[f64], &[f64]),
    t: f64,
    least_bar: &[f64],
    bars: Bars,
) {
    let sharing = Sharing::new(model, dropped, p, q, t);
    let mu = &sharing.measured(mu, -1)[..];
    let least = sharing.least(mu);
    // mu* = L times its measure, and so is its adjoint's measure
    let least_bar = &sharing.measured(least_bar, 1)[..];
    let moments = |one: &[f64], other: &[f64]| -> f64 {
        let pairs = one.iter().zip(other).zip(&sharing.are_moments);
        pairs.map(|((a, b), is_moment)| if *is_moment { a * b } else { 0.0 }).sum()
    };
    let [(eta, kappa), (zeta, theta)] = [least_bar, &least[..]].map(|b| sharing.pseudoinverse_times(b));
    let moved: Vec<f64> = sharing.rows.iter().map(|row| dot(row, &eta)).collect();
    let first: Vec<f64> = mu.iter().zip(&least).map(|(mu, least)| mu - least).collect();
    let second: Vec<f64> = least_bar.iter().zip(&moved).map(|(bar, moved)| bar - moved).collect();
    bars.mu.iter_mut().zip(sharing.measured(&moved, -1)).for_each(|(bar, moved)| *bar += moved);
    let mut length_bar = (moments(least_bar, &least) - moments(&moved, mu)) / sharing.length.value;
    let [first_outside, second_outside] = [&first, &second].map(|alpha| sharing.outside(alpha));
    let pairs = [(&first, &eta), (&second, &zeta), (&kappa, &first_outside), (&theta, &second_outside)];
    for (alpha, beta) in pairs {
        length_bar += sharing.length_gradient(alpha, beta);
        let (alpha, beta) = (sharing.measured(alpha, 1), sharing.unmeasured_columns(beta));
        add_row_gradient(model, &sharing, (p, q), t, (&alpha, &beta), (bars.q, bars.p));
    }
    sharing.length.add_gradient(p, length_bar, bars.p);
}

/// Adds the gradient of alpha . A(q, p) beta.
fn add_row_gradient(
    model: &Model,
    sharing: &Sharing<f64>,
    (p, q): (&[f64], &[f64]),
    t: f64,
    (alpha, beta): (&[f64], &[f64]),
    (q_bar, p_bar): (&mut [f64], &mut [f64]),
) {
    for joint in &model.constraints {
        let alpha = &alpha[joint.equations.clone()];
        let dofs: Vec<usize> = joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone()).collect();
        let own: Vec<f64> = dofs.iter().map(|&dof| q[dof]).collect();
        let own_p = &p[joint.parameters.clone()];
        let n = own.len();
        let force = joint.physics.reaction(&own, alpha, own_p, t);
        // beta as a movement of the coordinates: forces on bodies are (f, G f_e / 2) or (f, sum of axis x force)
        let mut along = vec![0.0; n];
        let mut local = 0;
        for node in &joint.nodes {
            let count = model.nodes[node.0].dofs.len();
            let places = local..local + count;
            local += count;
            let Some(first) = sharing.columns.first[node.0] else { continue };
            if model.nodes[node.0].kind == NodeKind::Body {
                let e = Quaternion::from_slice(&own[places.start + 3..]);
                let half = Vector3::first_three(&beta[first + 3..]) * 0.5;
                along[places.start..places.start + 3].copy_from_slice(&beta[first..first + 3]);
                along[places.start + 3..places.end].copy_from_slice(&e.g_transposed_times(half));
                // G(e) f = -G(f) e
                let of_e = Quaternion::from_slice(&force[places.start + 3..]).g_transposed_times(half);
                let target = &mut q_bar[dofs[places.start] + 3..];
                target.iter_mut().zip(of_e).for_each(|(bar, g)| *bar -= g);
            } else if model.nodes[node.0].kind == NodeKind::Natural {
                let turn = Vector3::first_three(&beta[first + 3..]);
                along[places.start..places.start + 3].copy_from_slice(&beta[first..first + 3]);
                for axis in (3..12).step_by(3).map(|axis| places.start + axis) {
                    along[axis..axis + 3].copy_from_slice(&turn.cross(&Vector3::first_three(&own[axis..])).components());
                    let of_axis = Vector3::first_three(&force[axis..]).cross(&turn);
                    q_bar[dofs[axis]..].iter_mut().zip(of_axis.components()).for_each(|(bar, g)| *bar += g);
                }
            } else {
                along[places].copy_from_slice(&beta[first..first + count]);
            }
        }
        let (of_q, of_p) = joint.physics.reaction_gradient((&own, own_p, t), alpha, &along);
        dofs.iter().zip(&of_q).for_each(|(&dof, own)| q_bar[dof] += own);
        p_bar[joint.parameters.clone()].iter_mut().zip(&of_p).for_each(|(bar, own)| *bar += own);
    }
}
