//! Reactions where constraints are redundant: of all multipliers with the same forces, those of least norm.
//!
//! A norm of forces and moments needs a length: L, the root mean square of the lengths among the parameters of the joints. Moments count by
//! m / L, as forces on an arm of this length, so that the split depends on no unit.
//!
//! With A the rows of all equations towards translations and rotations in these measures, K those that are kept, and F = A^T mu the forces of
//! the solved multipliers: mu* = argmin |mu*| subject to K A^T mu* = K F. It is the first part of the solution of
//!
//! mu* - A y = 0,  s - A^T mu* = 0,  y - K^T w = 0,  -K s = -K F,
//!
//! a sparse system, and a smooth function of the state that depends on the choice K only by round-off. It is solved for the joints that may
//! share loads with those of a redundant equation (`kinematic_loops`): the multipliers of others are determined.

use super::aggregate::derivatives;
use super::kinematic_loops::parts_of_joints;
use crate::assembly::{Attached, Model};
use crate::elements::{ConstraintPhysics, FormulaWork, NodeKind, RunScalar, unrelated_numbers};
use crate::linalg::{Backend, Factorization, SparsePattern};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Tangents};
use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

/// Rows of a sparse matrix: columns and entries.
type Matrix<S> = Vec<Vec<(usize, S)>>;

fn product<S: Scalar>(row: &[(usize, S)], b: &[S]) -> S {
    row.iter().map(|&(column, x)| x * b[column]).sum()
}

/// A^T times weights of rows.
fn combination<S: Scalar>(rows: &[Vec<(usize, S)>], weights: &[S], length: usize) -> Vec<S> {
    let mut sum = vec![S::zero(); length];
    for (row, &weight) in rows.iter().zip(weights) {
        row.iter().for_each(|&(column, x)| sum[column] += x * weight);
    }
    sum
}

/// Entries of a square matrix: row, column and value, none twice.
type Entries<S> = Vec<(usize, usize, S)>;

/// Patterns that are kept: least multipliers' own and that of [`MinimumNormReactions::outside`].
const PATTERNS: usize = 2;

/// A pattern that was analysed.
struct Analysed {
    size: usize,
    /// Rows and columns of the entries, as they came.
    places: Vec<[usize; 2]>,
    /// Where each entry stands among the values.
    positions: Vec<usize>,
    count: usize,
    factors: Factorization,
}

impl Analysed {
    fn new<S>(size: usize, entries: &[(usize, usize, S)]) -> Option<Self> {
        let pattern = SparsePattern::from_entries(size, entries.iter().map(|&(row, column, _)| (column, row)).collect());
        let pattern = Arc::new(pattern);
        let factors = Factorization::new(&pattern, Backend::Multifrontal).ok()?;
        let positions = entries.iter().map(|&(row, column, _)| pattern.position(row, column)).collect::<Option<_>>()?;
        let places = entries.iter().map(|&(row, column, _)| [row, column]).collect();
        Some(Analysed { size, places, positions, count: pattern.rows.len(), factors })
    }

    fn is_of<S>(&self, size: usize, entries: &[(usize, usize, S)]) -> bool {
        let same = |(own, entry): (&[usize; 2], &(usize, usize, S))| *own == [entry.0, entry.1];
        self.size == size && self.places.len() == entries.len() && self.places.iter().zip(entries).all(same)
    }
}

thread_local! {
    /// Those used last first: one sample after another has the same.
    static ANALYSED: RefCell<Vec<Analysed>> = const { RefCell::new(Vec::new()) };
}

/// Solves a sparse system for some right-hand sides with derivative parts, by the factors of its values; not a number where it is singular.
fn solve<S: RunScalar>(size: usize, entries: &[(usize, usize, S)], right: &[Vec<S>]) -> Vec<Vec<S>> {
    let singular = || right.iter().map(|_| vec![S::from(f64::NAN); size]).collect();
    // taken out: while it works this thread may come by again
    let known = ANALYSED.with_borrow_mut(|all| {
        let place = all.iter().position(|known| known.is_of(size, entries))?;
        Some(all.remove(place))
    });
    let Some(mut analysed) = known.or_else(|| Analysed::new(size, entries)) else { return singular() };
    let mut values = vec![0.0; analysed.count];
    analysed.positions.iter().zip(entries).for_each(|(&place, entry)| values[place] = entry.2.value());
    analysed.factors.reset_scaling(false);
    let solved = match analysed.factors.factor(&values) {
        Ok(()) => right.iter().map(|rhs| corrected(&mut analysed.factors, entries, rhs)).collect(),
        Err(_) => singular(),
    };
    ANALYSED.with_borrow_mut(|all| {
        all.insert(0, analysed);
        all.truncate(PATTERNS);
    });
    solved
}

/// The solution of one right-hand side, corrected from zero.
fn corrected<S: RunScalar>(factors: &mut Factorization, entries: &[(usize, usize, S)], rhs: &[S]) -> Vec<S> {
    let (mut x, mut own) = (vec![S::zero(); rhs.len()], vec![0.0; rhs.len()]);
    // the first correction finds values, the second derivatives if there are any, the last one what round-off left
    let mut left = rhs.to_vec();
    for _ in 0..2 + usize::from(S::PARTS > 0) {
        left.copy_from_slice(rhs);
        entries.iter().for_each(|&(row, column, value)| left[row] -= value * x[column]);
        own.iter_mut().zip(&left).for_each(|(own, left)| *own = left.value());
        factors.solve(&mut own);
        x.iter_mut().zip(&own).for_each(|(x, &own)| x.add_to_value(own));
        for part in 0..S::PARTS {
            own.iter_mut().zip(&left).for_each(|(own, left)| *own = left.part(part));
            factors.solve(&mut own);
            x.iter_mut().zip(&own).for_each(|(x, &own)| x.add_to_part(part, own));
        }
    }
    x
}

/// Columns of the generalized forces on the moving nodes: force and moment of a body, the coordinates of others.
struct Columns {
    /// The first one of each node, if it moves and a joint holds it.
    first: Vec<Option<usize>>,
    count: usize,
    /// Those of moments.
    moments: Vec<Range<usize>>,
}

impl Columns {
    /// Of the nodes of some joints.
    fn of(model: &Model, joints: &[usize]) -> Self {
        let (mut count, mut moments) = (0, Vec::new());
        let mut is_held = vec![false; model.nodes.len()];
        let nodes = joints.iter().flat_map(|&joint| &model.constraints[joint].nodes);
        nodes.for_each(|node| is_held[node.0] = !model.nodes[node.0].fixed);
        let first: Vec<Option<usize>> = model
            .nodes
            .iter()
            .zip(is_held)
            .map(|(node, is_held)| {
                is_held.then(|| {
                    let first = count;
                    count += node.kind.forces();
                    moments.extend(node.kind.has_axes().then_some(first + 3..first + 6));
                    first
                })
            })
            .collect();
        Columns { first, count, moments }
    }
}

/// The length by which moments are measured, and the places of the parameters of which it is the root mean square.
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
}

impl Length<f64> {
    /// Adds its derivatives by the parameters, times a factor.
    fn add_by_parameters(&self, p: &[f64], factor: f64, seeds: &mut [f64]) {
        let sum: f64 = self.places.iter().map(|&place| p[place] * p[place]).sum();
        let count = self.places.len().max(1) as f64;
        let [by_sum] = derivatives([sum], |[sum]| (sum / Tangents::from(count)).sqrt());
        for &place in &self.places {
            let [by_parameter] = derivatives([p[place]], |[own]| own * own);
            seeds[place] += factor * by_sum * by_parameter;
        }
    }
}

/// Rows A of the equations of some joints towards `columns`; the moment on a body is G(e) f / 2 in its frame, with natural coordinates the
/// sum of axis x force on it in the world.
fn rows<S: RunScalar>(model: &Model, joints: &[usize], columns: &Columns, (p, q, t): (&[S], &[S], S)) -> Matrix<S> {
    let (mut all, mut work): (Matrix<S>, _) = (Vec::new(), FormulaWork::default());
    let (mut dofs, mut own) = (Vec::new(), Vec::new());
    for joint in joints.iter().map(|&joint| &model.constraints[joint]) {
        dofs.clear();
        dofs.extend(joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone()));
        own.clear();
        own.extend(dofs.iter().map(|&dof| q[dof]));
        let all_forces = joint.physics.rows_in(&own, &p[joint.parameters.clone()], t, &mut work);
        for force in all_forces.chunks_exact(own.len()) {
            let mut local = 0;
            let mut row: Vec<(usize, S)> = Vec::with_capacity(6 * joint.nodes.len());
            for node in &joint.nodes {
                let (kind, count) = (model.nodes[node.0].kind, model.nodes[node.0].dofs.len());
                let (force, place) = (&force[local..local + count], &own[local..local + count]);
                local += count;
                let Some(first) = columns.first[node.0] else { continue };
                if kind.has_axes() {
                    let moment = match kind {
                        NodeKind::Body => {
                            let e = Quaternion::from_slice(&place[3..]);
                            e.g_times(Quaternion::from_slice(&force[3..])) * S::from(0.5)
                        }
                        _ => NodeKind::Natural.moment(place, force),
                    };
                    row.extend((first..).zip(force[..3].iter().copied().chain(moment.components())));
                } else {
                    row.extend((first..).zip(force.iter().copied()));
                }
            }
            row.sort_by_key(|(column, _)| *column);
            row.dedup_by(|(column, x), (before, sum)| {
                let is_same = column == before;
                if is_same {
                    *sum += *x;
                }
                is_same
            });
            all.push(row);
        }
    }
    all
}

/// What stands between multipliers as solved and those of least norm.
struct MinimumNormReactions<S> {
    /// Joints that may share loads with those of a redundant equation.
    joints: Vec<usize>,
    /// Their equations, in the numbering of the model. All that follows has those of here.
    equations: Vec<usize>,
    columns: Columns,
    length: Length<S>,
    /// Which equations have moments as multipliers: their rows act on no translation.
    are_moments: Vec<bool>,
    /// A.
    rows: Matrix<S>,
    /// Kept rows.
    kept: Vec<usize>,
}

/// Part of the solution of the sparse system.
struct MinimumNormSolution<S> {
    /// The multipliers of least norm.
    mu: Vec<S>,
    /// y.
    along: Vec<S>,
    /// s.
    force: Vec<S>,
    /// w as weights of all equations, zero for dropped ones: y = sum of weights times rows.
    weights: Vec<S>,
}

impl<S: RunScalar> MinimumNormReactions<S> {
    fn new(model: &Model, dropped: &[usize], p: &[S], q: &[S], t: S) -> Self {
        let joints = joints_with_those_of(model, dropped, p);
        let equations: Vec<usize> = joints.iter().flat_map(|&joint| model.constraints[joint].equations.clone()).collect();
        let columns = Columns::of(model, &joints);
        let length = Length::of(model, p);
        let mut rows = rows(model, &joints, &columns, (p, q, t));
        let mut is_moment = vec![false; columns.count];
        columns.moments.iter().cloned().flatten().for_each(|column| is_moment[column] = true);
        let on_points = |row: &Vec<(usize, S)>| row.iter().any(|&(column, x)| x.value() != 0.0 && !is_moment[column]);
        let are_moments: Vec<bool> = rows.iter().map(|row| !on_points(row)).collect();
        // of an equation of moments the two lengths cancel
        for row in rows.iter_mut().zip(&are_moments).filter(|(_, is_moment)| !**is_moment).map(|(row, _)| row) {
            row.iter_mut().filter(|(column, _)| is_moment[*column]).for_each(|(_, x)| *x /= length.value);
        }
        let kept = (0..rows.len()).filter(|&row| dropped.binary_search(&equations[row]).is_err()).collect();
        MinimumNormReactions { joints, equations, columns, length, are_moments, rows, kept }
    }

    /// Of numbers of all equations those of its own.
    fn own(&self, all: &[S]) -> Vec<S> {
        self.equations.iter().map(|&equation| all[equation]).collect()
    }

    /// Multipliers times L^power where they are moments.
    fn measured(&self, mu: &[S], power: i32) -> Vec<S> {
        let factor = self.length.value.powi(power);
        mu.iter().zip(&self.are_moments).map(|(&mu, is_moment)| if *is_moment { mu * factor } else { mu }).collect()
    }

    /// Solves mu - A y = g, s - A^T mu = 0, y - K^T w = 0, -K s = h for each (g, h).
    fn shares<const N: usize>(&self, right: [[Vec<S>; 2]; N]) -> [MinimumNormSolution<S>; N] {
        let (equations, columns, kept) = (self.rows.len(), self.columns.count, self.kept.len());
        let (along, force, weight) = (equations, equations + columns, equations + 2 * columns);
        let mut entries: Entries<S> = (0..weight).map(|unknown| (unknown, unknown, S::one())).collect();
        for (equation, row) in self.rows.iter().enumerate() {
            for &(column, x) in row {
                entries.push((equation, along + column, -x));
                entries.push((force + column, equation, -x));
            }
        }
        for (number, &equation) in self.kept.iter().enumerate() {
            for &(column, x) in &self.rows[equation] {
                entries.push((along + column, weight + number, -x));
                entries.push((weight + number, force + column, -x));
            }
        }
        let zero = vec![S::zero(); 2 * columns];
        let right = right.map(|[g, h]| [&g[..], &zero, &h].concat());
        let solved = solve(weight + kept, &entries, &right);
        std::array::from_fn(|number| {
            let (solved, mut weights) = (&solved[number], vec![S::zero(); equations]);
            self.kept.iter().zip(&solved[weight..]).for_each(|(&equation, &own)| weights[equation] = own);
            MinimumNormSolution {
                mu: solved[..equations].to_vec(),
                along: solved[along..force].to_vec(),
                force: solved[force..weight].to_vec(),
                weights,
            }
        })
    }

    /// The right-hand sides of mu*, as forces.
    fn of_least(&self, mu: &[S]) -> [Vec<S>; 2] {
        let force = combination(&self.rows, mu, self.columns.count);
        [vec![S::zero(); self.rows.len()], self.kept.iter().map(|&row| -product(&self.rows[row], &force)).collect()]
    }

    /// mu*, as forces.
    fn least(&self, mu: &[S]) -> Vec<S> {
        let [MinimumNormSolution { mu, .. }] = self.shares([self.of_least(mu)]);
        mu
    }

    /// Forces in the model's units whose product with a row without measures is that of measured ones: moments by L.
    fn unmeasured_columns(&self, beta: &[S]) -> Vec<S> {
        let mut own = beta.to_vec();
        self.columns.moments.iter().cloned().flatten().for_each(|column| own[column] /= self.length.value);
        own
    }
}

impl MinimumNormReactions<f64> {
    /// d (alpha . A beta) / d L.
    fn by_length(&self, alpha: &[f64], beta: &[f64]) -> f64 {
        let mut of_moments = vec![0.0; self.columns.count];
        self.columns.moments.iter().cloned().flatten().for_each(|column| of_moments[column] = beta[column]);
        let rows = self.rows.iter().zip(alpha).zip(&self.are_moments).filter(|(_, is_moment)| !**is_moment);
        let turning: f64 = rows.map(|((row, &alpha), _)| alpha * product(row, &of_moments)).sum();
        let own = self.length.value;
        derivatives([own], |[length]| Tangents::from(turning * own) / length)[0]
    }
}

/// The multipliers of least norm with the same forces as `mu`, which are zero for `dropped` equations.
pub fn least_multipliers<S: RunScalar>(model: &Model, dropped: &[usize], p: &[S], q: &[S], mu: &[S], t: S) -> Vec<S> {
    let minimum = MinimumNormReactions::new(model, dropped, p, q, t);
    let own = minimum.measured(&minimum.least(&minimum.measured(&minimum.own(mu), -1)), 1);
    let mut all = mu.to_vec();
    minimum.equations.iter().zip(own).for_each(|(&equation, own)| all[equation] = own);
    all
}

/// Share of a multiplier without forces below which it is round-off.
const DETERMINED: f64 = 1e-9;

/// Multipliers that change no force, and can be added to those of least norm: a sum of all that there are, which has part in each equation
/// whose multiplier the forces leave open.
pub(crate) fn multipliers_without_forces(model: &Model, dropped: &[usize], p: &[f64], q: &[f64], t: f64) -> Vec<f64> {
    let minimum = MinimumNormReactions::new(model, dropped, p, q, t);
    let any: Vec<f64> = unrelated_numbers().take(minimum.rows.len()).collect();
    let least = minimum.least(&any);
    let open = |(any, least): (&f64, &f64)| if (any - least).abs() < DETERMINED { 0.0 } else { any - least };
    let own = minimum.measured(&any.iter().zip(&least).map(open).collect::<Vec<_>>(), 1);
    let mut all = vec![0.0; model.equations];
    minimum.equations.iter().zip(own).for_each(|(&equation, own)| all[equation] = own);
    all
}

/// Joints that may share loads with those of some equations.
fn joints_with_those_of<S: RunScalar>(model: &Model, equations: &[usize], p: &[S]) -> Vec<usize> {
    let part_of = parts_of_joints(model, &p.iter().map(|p| p.value()).collect::<Vec<f64>>());
    let has_one = |joint: &Attached<ConstraintPhysics>| {
        let next = equations.partition_point(|&equation| equation < joint.equations.start);
        equations.get(next).is_some_and(|equation| joint.equations.contains(equation))
    };
    let mut is_open = vec![false; part_of.len()];
    model.constraints.iter().zip(&part_of).filter(|(joint, _)| has_one(joint)).for_each(|(_, &part)| is_open[part] = true);
    (0..part_of.len()).filter(|&joint| is_open[part_of[joint]]).collect()
}

/// Where the adjoints of [`least_multipliers`] go.
pub(super) struct AdjointSeeds<'b> {
    pub q: &'b mut [f64],
    pub mu: &'b mut [f64],
    pub p: &'b mut [f64],
}

/// Adds (d mu*/d(q, mu, p))^T mu*_bar to `seeds`: the reverse of the sparse system.
///
/// Its matrix is its own transpose but for the order of blocks, so that the adjoint variables (l1, l2, l3, l4) of its four equations are the
/// solution (mu, y, s, w) with mu*_bar on the right, and
///
/// d f = l1 . dA y + (mu* - mu) . dA l2 + w . dK l3 + l4 . dK (s - F) - (A l2) . d mu
///
/// All of these are as forces: what is measured by L depends on it.
pub(super) fn add_least_multipliers_transposed(
    model: &Model,
    dropped: &[usize],
    (p, q, solved): (&[f64], &[f64], &[f64]),
    t: f64,
    least_bar: &[f64],
    seeds: AdjointSeeds,
) {
    let minimum = MinimumNormReactions::new(model, dropped, p, q, t);
    // what others bear is what was solved for them
    let mut of_others = least_bar.to_vec();
    minimum.equations.iter().for_each(|&equation| of_others[equation] = 0.0);
    seeds.mu.iter_mut().zip(of_others).for_each(|(bar, other)| *bar += other);
    let (solved, least_bar) = (&minimum.own(solved)[..], &minimum.own(least_bar)[..]);
    let mu = &minimum.measured(solved, -1)[..];
    let right = [minimum.measured(least_bar, 1), vec![0.0; minimum.kept.len()]];
    let [own, adjoint] = minimum.shares([minimum.of_least(mu), right]);
    let moved: Vec<f64> = minimum.rows.iter().map(|row| -product(row, &adjoint.along)).collect();
    let solved_bars = minimum.equations.iter().zip(minimum.measured(&moved, -1));
    solved_bars.for_each(|(&equation, moved)| seeds.mu[equation] += moved);
    let moments = (0..mu.len()).filter(|&row| minimum.are_moments[row]);
    let [mut length_bar] = derivatives([minimum.length.value], |[length]| {
        moments.map(|row| length * (least_bar[row] * own.mu[row]) + Tangents::from(moved[row] * solved[row]) / length).sum()
    });
    let less = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
    let force = combination(&minimum.rows, mu, minimum.columns.count);
    let pairs = [
        (&adjoint.mu, &own.along),
        (&less(&own.mu, mu), &adjoint.along),
        (&own.weights, &adjoint.force),
        (&adjoint.weights, &less(&own.force, &force)),
    ];
    for (alpha, beta) in pairs {
        length_bar += minimum.by_length(alpha, beta);
        let (alpha, beta) = (minimum.measured(alpha, 1), minimum.unmeasured_columns(beta));
        add_along_rows(model, &minimum, (p, q), t, (&alpha, &beta), (seeds.q, seeds.p));
    }
    minimum.length.add_by_parameters(p, length_bar, seeds.p);
}

/// Adds the derivatives of alpha . A(q, p) beta.
fn add_along_rows(
    model: &Model,
    minimum: &MinimumNormReactions<f64>,
    (p, q): (&[f64], &[f64]),
    t: f64,
    (alpha, beta): (&[f64], &[f64]),
    (q_bar, p_bar): (&mut [f64], &mut [f64]),
) {
    let mut first = 0;
    for joint in minimum.joints.iter().map(|&joint| &model.constraints[joint]) {
        let alpha = &alpha[first..][..joint.equations.len()];
        first += alpha.len();
        let nodes = || joint.nodes.iter().map(|node| (&model.nodes[node.0], minimum.columns.first[node.0]));
        let dofs: Vec<usize> = nodes().flat_map(|(node, _)| node.dofs.clone()).collect();
        let own: Vec<f64> = dofs.iter().map(|&dof| q[dof]).collect();
        // what stands still moves with nothing
        let columns = nodes().flat_map(|(node, first)| {
            let count = node.kind.forces();
            first.map_or_else(|| vec![0.0; count], |first| beta[first..first + count].to_vec())
        });
        let (columns, kinds): (Vec<f64>, Vec<NodeKind>) = (columns.collect(), nodes().map(|(node, _)| node.kind).collect());
        let point = (&own[..], &p[joint.parameters.clone()], t);
        let (of_q, of_p) = joint.physics.along_rows(point, alpha, (&kinds, &columns));
        dofs.iter().zip(&of_q).for_each(|(&dof, own)| q_bar[dof] += own);
        p_bar[joint.parameters.clone()].iter_mut().zip(&of_p).for_each(|(bar, own)| *bar += own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each of the points on a line is tied to the one before by two equal equations, of which one is kept.
    #[test]
    fn doubled_ties_bear_half_of_each_force_and_take_the_same_work_for_each() {
        let work = [50, 2000].map(|count| {
            let row = |i: usize| if i == 0 { vec![(0, 1.0)] } else { vec![(i - 1, -1.0), (i, 1.0)] };
            let minimum = MinimumNormReactions {
                joints: Vec::new(),
                equations: Vec::new(),
                columns: Columns { first: Vec::new(), count, moments: Vec::new() },
                length: Length { value: 1.0, places: Vec::new() },
                are_moments: vec![false; 2 * count],
                rows: (0..2 * count).map(|equation| row(equation / 2)).collect(),
                kept: (0..count).map(|tie| 2 * tie).collect(),
            };
            let mu: Vec<f64> = (0..2 * count).map(|row| if row % 2 == 0 { (row as f64).sin() } else { 0.0 }).collect();
            let [MinimumNormSolution { mu: least, along, weights, .. }] = minimum.shares([minimum.of_least(&mu)]);
            // the condition of the rows of a chain grows with its length
            for (equation, least) in least.iter().enumerate() {
                let off = (least - 0.5 * mu[equation / 2 * 2]).abs();
                assert!(off < 1e-14 * count as f64, "equation {equation} of {count}: {off:e}");
            }
            // y = K^T w
            let of_weights = combination(&minimum.rows, &weights, count);
            for (own, other) in along.iter().zip(&of_weights) {
                assert!((own - other).abs() < 1e-12 * count as f64, "{own} {other}");
            }
            let plan = ANALYSED.with_borrow(|analysed| analysed[0].factors.plan());
            plan.work.expect("sparse").multiplications / count as f64
        });
        assert!(work[1] < 1.5 * work[0], "{work:?}");
    }
}
