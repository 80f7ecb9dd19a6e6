//! Dense blocks of single elements, constraints and nodes, along the reduced columns of their nodes.

use super::jacobian::{Bases, Point, node_seeds};
use super::numbering::{Part, System};
use super::residual::Local3;
use super::{Equations, Impulse, Level, Shift};
use crate::elements::{AnyConstraint, ByPoints, PointWork, RunScalar, State, Wide, wide};
use crate::scalar::{Direction, Job, LANES, Lanes, Taylor, widest};

/// Where a matrix is assembled.
pub(super) struct Assembly<'s> {
    pub system: &'s System<'s>,
    pub equations: &'s Equations,
    pub bases: &'s [Bases],
    pub point: &'s Point,
    pub p: &'s [f64],
    pub t: f64,
}

/// Workspace for one block after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockWork {
    real: Local3<f64>,
    a: Vec<Lanes>,
    v: Vec<Lanes>,
    q: Vec<Lanes>,
    p: Vec<Lanes>,
    r: Vec<Lanes>,
    motion: Vec<Taylor<f64>>,
    gradients: Vec<f64>,
    directions: Vec<Direction>,
    products: Vec<Direction>,
    multipliers: Vec<f64>,
    points: PointWork,
    reduced: Vec<Wide>,
    /// Factors of the velocity, and one term of an impulse.
    scaled: [Vec<f64>; 2],
    term: Vec<f64>,
}

/// dR/da, dR/dv, dR/dq of an element where these are the same everywhere, row-major; empty where they are zero.
pub(super) type Constants = [Vec<f64>; 3];

/// Constant matrices of an element, by lanes at any point; `None` if it has none.
pub(super) fn constants(system: &System, index: usize, p: &[f64]) -> Option<Constants> {
    let (part, physics) = (&system.element_parts[index], &*system.model.elements[index].physics);
    if !physics.has_constant_matrices() {
        return None;
    }
    let n = part.dofs;
    let p: Vec<Lanes> = p[part.parameters.clone()].iter().map(|&p| Lanes::constant(p)).collect();
    let matrix = |argument: usize| {
        let mut matrix = vec![0.0; n * n];
        for first in (0..n).step_by(LANES) {
            let mut state = [vec![Lanes::default(); n], vec![Lanes::default(); n], vec![Lanes::default(); n]];
            let width = LANES.min(n - first);
            (0..width).for_each(|lane| state[argument][first + lane].eps[lane] = 1.0);
            let mut r = vec![Lanes::default(); n];
            let [a, v, q] = &state;
            Lanes::element(physics).add_residual(State { a, v, q }, &p, Lanes::default(), &mut r);
            for (row, r) in matrix.chunks_exact_mut(n).zip(&r) {
                row[first..first + width].copy_from_slice(&r.eps[..width]);
            }
        }
        if matrix.iter().all(|&entry| entry == 0.0) { Vec::new() } else { matrix }
    };
    Some([0, 1, 2].map(matrix))
}

/// Constants with lanes.
pub(super) fn load(target: &mut Vec<Lanes>, values: &[f64]) {
    target.clear();
    target.extend(values.iter().map(|&value| Lanes::constant(value)));
}

/// N_L^T K N_R of one element, K given column after column, in each [`wide`] vectors for every node.
struct Reduction<'j> {
    assembly: &'j Assembly<'j>,
    part: &'j Part,
    matrix: &'j [Wide],
    reduced: &'j mut Vec<Wide>,
    block: &'j mut [f64],
}

/// Coordinates of a node, and how many of them at the front are unknowns themselves: a position and Euler parameters.
const EULER: (usize, usize) = (7, 3);

impl Job for Reduction<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Reduction { assembly: Assembly { system, bases, .. }, part, matrix, reduced, block } = self;
        let n: usize = part.segments.iter().map(|segment| wide(segment.len())).sum();
        let size = part.columns.len();
        // K N_R, column after column
        reduced.resize(size * n, Wide::default());
        let (mut dof, mut first) = (0, 0);
        for (&node, segment) in part.nodes.iter().zip(&part.segments) {
            let columns = system.nodes[node].columns.len();
            let Bases { right, plain, .. } = &bases[node];
            let plain = if right.is_empty() { columns } else { *plain };
            reduced[first * n..(first + plain) * n].copy_from_slice(&matrix[dof * n..(dof + plain) * n]);
            let turning = &mut reduced[(first + plain) * n..(first + columns) * n];
            let sources = &matrix[(dof + plain) * n..(dof + segment.len()) * n];
            for (column, target) in turning.chunks_exact_mut(n).enumerate() {
                for (vector, target) in target.iter_mut().enumerate() {
                    let mut sum = Wide::default();
                    for (i, source) in sources.chunks_exact(n).enumerate() {
                        sum.add(right[(plain + i) * columns + plain + column], &source[vector]);
                    }
                    *target = sum;
                }
            }
            dof += segment.len();
            first += columns;
        }
        let (mut place, mut first) = (0, 0);
        for (&node, segment) in part.nodes.iter().zip(&part.segments) {
            let rows = system.nodes[node].columns.len();
            let Bases { left, plain, .. } = &bases[node];
            let columns = reduced.chunks_exact(n).zip(block.chunks_exact_mut(size));
            let columns =
                columns.map(|(own, target)| (&own[place..place + wide(segment.len())], &mut target[first..first + rows]));
            if left.is_empty() {
                columns.for_each(|(own, target)| copy_wide(own, target));
            } else if let (EULER, Some(left)) = ((segment.len(), *plain), left.first_chunk::<42>()) {
                // rows behind the position, their last number twice: the compiler takes whole vectors
                let mut turning = [[0.0; 4]; 4];
                for (turning, left) in turning.iter_mut().zip(left[18..].chunks_exact(6)) {
                    *turning = [left[3], left[4], left[5], left[5]];
                }
                for (own, target) in columns {
                    let (own, Some(target)) = (own[0].0, target.first_chunk_mut::<6>()) else { continue };
                    let mut sum = [0.0; 4];
                    for k in 0..4 {
                        for i in 0..4 {
                            sum[i] += turning[k][i] * own[3 + k];
                        }
                    }
                    *target = [own[0], own[1], own[2], sum[0], sum[1], sum[2]];
                }
            } else {
                for (own, target) in columns {
                    copy_wide(own, &mut target[..*plain]);
                    let own = own.iter().flat_map(|own| own.0);
                    for (value, weights) in own.zip(left.chunks_exact(rows)).skip(*plain) {
                        let turning = target[*plain..].iter_mut().zip(&weights[*plain..]);
                        turning.for_each(|(sum, weight)| *sum += weight * value);
                    }
                }
            }
            place += wide(segment.len());
            first += rows;
        }
    }
}

/// The first numbers of wide vectors.
#[inline(always)]
fn copy_wide(source: &[Wide], target: &mut [f64]) {
    for (target, source) in target.chunks_mut(8).zip(source) {
        target.copy_from_slice(&source.0[..target.len()]);
    }
}

impl Assembly<'_> {
    /// Calls `f(lane, dof, dx, dy)` for the coordinates that reduced columns `first..first + 8` of a part move; returns their number.
    fn for_lanes(&self, part: &Part, first: usize, mut f: impl FnMut(usize, usize, f64, f64)) -> usize {
        let mut lanes = 0;
        for (lane, &(place, column)) in part.columns.iter().skip(first).take(LANES).enumerate() {
            let seeds = node_seeds(self.system, self.bases, part.nodes[place]);
            let offset: usize = part.segments[..place].iter().map(ExactSizeIterator::len).sum();
            for dof in 0..seeds.dofs {
                let (x, y) = seeds.direction(dof, column);
                f(lane, offset + dof, x, y);
            }
            lanes = lane + 1;
        }
        lanes
    }

    /// Adds N_L^T times local rows to a block's columns `first_column..`; `second` selects the Y rows.
    fn add_reduced_rows<'r>(
        &self,
        part: &Part,
        row_of: impl Fn(usize) -> &'r Direction,
        second: bool,
        columns: std::ops::Range<usize>,
        size: usize,
        block: &mut [f64],
    ) {
        let copies = if self.system.options.stabilized { 2 } else { 1 };
        let (mut first_dof, mut first_row) = (0, 0);
        for (node, segment) in part.nodes.iter().zip(&part.segments) {
            let reduced = self.system.nodes[*node].columns.len();
            let half = reduced / copies;
            let Bases { left, plain, .. } = &self.bases[*node];
            for row in 0..half {
                let target = first_row + row + if second { half } else { 0 };
                let mut sum = [0.0; LANES];
                if left.is_empty() || row < *plain {
                    sum = *row_of(first_dof + row);
                } else {
                    for i in *plain..segment.len() {
                        let (weight, value) = (left[i * half + row], row_of(first_dof + i));
                        for (sum, e) in sum.iter_mut().zip(value) {
                            *sum += weight * e;
                        }
                    }
                }
                for (column, value) in columns.clone().zip(sum) {
                    block[target + column * size] += value;
                }
            }
            first_dof += segment.len();
            first_row += reduced;
        }
    }

    /// Adds N_L^T times the rows of each node to the columns of the same node.
    fn add_own_rows(&self, part: &Part, rows: &[Direction], second: bool, size: usize, block: &mut [f64]) {
        let copies = if self.system.options.stabilized { 2 } else { 1 };
        let (mut first_dof, mut first) = (0, 0);
        for (node, segment) in part.nodes.iter().zip(&part.segments) {
            let reduced = self.system.nodes[*node].columns.len();
            let half = reduced / copies;
            let left = &self.bases[*node].left;
            for row in 0..half {
                let target = first + row + if second { half } else { 0 };
                for (i, values) in rows[first_dof..first_dof + segment.len()].iter().enumerate() {
                    let weight = if left.is_empty() { f64::from(u8::from(i == row)) } else { left[i * half + row] };
                    for (column, value) in values.iter().take(reduced).enumerate() {
                        block[target + (first + column) * size] += weight * value;
                    }
                }
            }
            first_dof += segment.len();
            first += reduced;
        }
    }

    /// Columns gamma dR/da + beta dR/dv + alpha dR/dq along N_R, reduced by N_L.
    pub fn element(&self, work: &mut BlockWork, index: usize, block: &mut [f64]) {
        let part = &self.system.element_parts[index];
        block.fill(0.0);
        let mut real = std::mem::take(&mut work.real);
        let state = real.state(part, &self.point.at);
        match self.equations.variational {
            None => self.element_at(work, index, state, self.equations.residual, block),
            Some(step) => self.impulse(work, index, step.now(), state, block),
        }
        work.real = real;
    }

    /// The same for the impulse of an element.
    fn impulse(&self, work: &mut BlockWork, index: usize, impulse: Impulse, state: State<f64>, block: &mut [f64]) {
        let part = &self.system.element_parts[index];
        let Shift { beta, alpha, .. } = self.equations.residual;
        let (mut scaled, mut own) = (std::mem::take(&mut work.scaled), std::mem::take(&mut work.term));
        for term in impulse.terms() {
            for (scaled, factor) in scaled.iter_mut().zip([term.a, term.v]) {
                scaled.clear();
                scaled.extend(state.v.iter().map(|v| factor * v));
            }
            let [a, v] = &scaled;
            own.clear();
            own.resize(block.len(), 0.0);
            let shift = Shift::new(term.a * beta, term.v * beta, alpha);
            self.element_at(work, index, State { a, v, q: state.q }, shift, &mut own);
            block.iter_mut().zip(&own).for_each(|(sum, own)| *sum += term.weight * own);
        }
        (work.scaled, work.term) = (scaled, own);
        let physics = &*self.system.model.elements[index].physics;
        if physics.has_constant_mass() || impulse.force == 0.0 {
            return;
        }
        let BlockWork { v, q, p, r, .. } = work;
        let size = part.columns.len();
        load(p, &self.p[part.parameters.clone()]);
        for first in (0..size).step_by(LANES) {
            load(v, state.v);
            load(q, state.q);
            let lanes = self.for_lanes(part, first, |lane, dof, x, _| {
                v[dof].eps[lane] = beta * x;
                q[dof].eps[lane] = alpha * x;
            });
            r.clear();
            r.resize(part.dofs, Lanes::default());
            Lanes::element(physics).add_momentum_rate(v, q, p, r);
            r.iter_mut().for_each(|r| *r = *r * impulse.force);
            self.add_reduced_rows(part, |dof| &r[dof].eps, false, first..first + lanes, size, block);
        }
    }

    /// Columns of R at a point that moves by a shift, added to a block of zeros.
    fn element_at(&self, work: &mut BlockWork, index: usize, own: State<f64>, shift: Shift, block: &mut [f64]) {
        let part = &self.system.element_parts[index];
        let Shift { gamma, beta, alpha } = shift;
        let size = part.columns.len();
        let physics = &*self.system.model.elements[index].physics;
        if let Some(points) = physics.points().filter(|_| self.equations.level != Level::Stabilized) {
            return self.element_by_points(work, part, points, (own, shift), block);
        }
        let BlockWork { a, v, q, p, r, .. } = work;
        load(p, &self.p[part.parameters.clone()]);
        for first in (0..size).step_by(LANES) {
            load(a, own.a);
            load(v, own.v);
            load(q, own.q);
            let lanes = self.for_lanes(part, first, |lane, dof, x, y| {
                a[dof].eps[lane] = gamma * x;
                v[dof].eps[lane] = beta * x;
                q[dof].eps[lane] = alpha * (x + y);
            });
            r.clear();
            r.resize(part.dofs, Lanes::default());
            let state = State { a: &a[..], v: &v[..], q: &q[..] };
            Lanes::element(physics).add_residual(state, p, Lanes::from(self.t), r);
            self.add_reduced_rows(part, |dof| &r[dof].eps, false, first..first + lanes, size, block);
        }
    }

    /// The same for an element whose matrix comes from its points: N_L^T K N_R.
    fn element_by_points(
        &self,
        work: &mut BlockWork,
        part: &Part,
        points: &dyn ByPoints,
        (state, shift): (State<f64>, Shift),
        block: &mut [f64],
    ) {
        let Shift { gamma, beta, alpha } = shift;
        let p = &self.p[part.parameters.clone()];
        let matrix = points.matrix(state, [gamma, beta, alpha], p, self.t, &mut work.points);
        widest(Reduction { assembly: self, part, matrix, reduced: &mut work.reduced, block });
    }

    /// Adds to a block of zeros what constant matrices of an element are along N_R, reduced by N_L.
    pub fn constant_element(&self, work: &mut BlockWork, index: usize, constants: &Constants, block: &mut [f64]) {
        let part = &self.system.element_parts[index];
        let Shift { gamma, beta, alpha } = self.equations.linear_shift();
        let (size, n) = (part.columns.len(), part.dofs);
        let BlockWork { directions, products, .. } = work;
        for first in (0..size).step_by(LANES) {
            products.clear();
            products.resize(n, [0.0; LANES]);
            for (matrix, factors) in constants.iter().zip([[gamma, 0.0], [beta, 0.0], [alpha, alpha]]) {
                if matrix.is_empty() {
                    continue;
                }
                directions.clear();
                directions.resize(n, [0.0; LANES]);
                self.for_lanes(part, first, |lane, dof, x, y| directions[dof][lane] = factors[0] * x + factors[1] * y);
                for (row, product) in matrix.chunks_exact(n).zip(products.iter_mut()) {
                    for (entry, direction) in row.iter().zip(&*directions).filter(|(entry, _)| **entry != 0.0) {
                        product.iter_mut().zip(direction).for_each(|(sum, d)| *sum += entry * d);
                    }
                }
            }
            let lanes = LANES.min(size - first);
            self.add_reduced_rows(part, |dof| &products[dof], false, first..first + lanes, size, block);
        }
    }

    /// Rows of the equations along N_R, columns A^T of the multipliers, and the curvature of the reactions.
    pub fn constraint(&self, work: &mut BlockWork, index: usize, block: &mut [f64]) {
        let part = &self.system.constraint_parts[index];
        let Some(joint) = self.system.global_constraint(index) else { return };
        let count = joint.equations.len();
        let stabilized = self.equations.level == Level::Stabilized;
        let own_columns = part.columns.len();
        let size = own_columns + if stabilized { 2 * count } else { count };
        block.fill(0.0);
        let p = &self.p[part.parameters.clone()];
        let unknowns = &self.point.unknowns;
        let sets = [(false, &unknowns.mu, 1.0), (true, &unknowns.eta, -1.0)];
        for (second, multipliers, sign) in sets.into_iter().take(1 + usize::from(stabilized)) {
            work.multipliers.clear();
            work.multipliers.extend(multipliers[joint.equations.clone()].iter().map(|m| sign * m));
            self.add_curvature(joint.physics, part, work, p, second, size, block);
            let BlockWork { gradients, products, .. } = &mut *work;
            // columns of the multipliers: A^T, reduced
            let sign = sign * self.equations.variational.map_or(1.0, |step| step.reaction());
            products.resize(part.dofs, [0.0; LANES]);
            let place = own_columns + if second { count } else { 0 };
            for first in (0..count).step_by(LANES) {
                let width = LANES.min(count - first);
                for (dof, row) in products.iter_mut().enumerate().take(part.dofs) {
                    for lane in 0..width {
                        row[lane] = sign * gradients[(first + lane) * part.dofs + dof];
                    }
                }
                let columns = place + first..place + first + width;
                self.add_reduced_rows(part, |dof| &products[dof], second, columns, size, block);
            }
        }
        if self.equations.variational.is_some() {
            // the equations hold at another point than where the reactions act
            let BlockWork { real, gradients, multipliers, .. } = &mut *work;
            let q = real.state(part, &self.point.constraint_at).q;
            let at = (q, p, self.equations.constraint_time(self.t));
            joint.physics.linearize_reaction(at, multipliers, &[], gradients, &mut []);
        }
        self.add_equation_rows(joint.physics, part, work, p, count, size, block);
    }

    /// Derivative of A^T mu along the columns; leaves A in `gradients`.
    #[allow(clippy::too_many_arguments)]
    fn add_curvature(
        &self,
        physics: &dyn AnyConstraint,
        part: &Part,
        work: &mut BlockWork,
        p: &[f64],
        second: bool,
        size: usize,
        block: &mut [f64],
    ) {
        let BlockWork { real, gradients, directions, products, multipliers, .. } = work;
        let columns = part.columns.len();
        // a reaction at the start of a step does not move
        let alpha = if self.equations.variational.is_some() { 0.0 } else { self.equations.constraint.alpha };
        let q = real.state(part, self.point.reaction(self.equations)).q;
        let t = self.equations.reaction_time(self.t);
        // room for the first time that there are multipliers
        directions.clear();
        directions.reserve(columns.div_ceil(LANES) * part.dofs);
        products.clear();
        products.reserve(columns.div_ceil(LANES) * part.dofs);
        let most = part.nodes.iter().map(|&node| self.system.nodes[node].columns.len()).max().unwrap_or(0);
        if physics.is_separable() && most <= LANES && alpha != 0.0 {
            // columns of different nodes don't meet: the first of each node share a lane, and so on
            directions.resize(part.dofs, [0.0; LANES]);
            for first in (0..columns).step_by(LANES) {
                self.for_lanes(part, first, |lane, dof, x, y| {
                    if x != 0.0 || y != 0.0 {
                        directions[dof][part.columns[first + lane].1] = alpha * (x + y);
                    }
                });
            }
            products.clear();
            products.resize(part.dofs, [0.0; LANES]);
            gradients.resize(multipliers.len() * part.dofs, 0.0);
            physics.linearize_reaction((q, p, t), multipliers, directions, gradients, products);
            self.add_own_rows(part, products, second, size, block);
            return;
        }
        if alpha != 0.0 && multipliers.iter().any(|&m| m != 0.0) {
            directions.resize(columns.div_ceil(LANES) * part.dofs, [0.0; LANES]);
            for (group, directions) in directions.chunks_exact_mut(part.dofs).enumerate() {
                self.for_lanes(part, group * LANES, |lane, dof, x, y| directions[dof][lane] = alpha * (x + y));
            }
        }
        products.clear();
        products.resize(directions.len(), [0.0; LANES]);
        gradients.resize(multipliers.len() * part.dofs, 0.0);
        physics.linearize_reaction((q, p, t), multipliers, directions, gradients, products);
        for (group, rows) in products.chunks_exact(part.dofs).enumerate() {
            let own = group * LANES..columns.min((group + 1) * LANES);
            self.add_reduced_rows(part, |dof| &rows[dof], second, own, size, block);
        }
    }

    /// The scaled equations of a joint along N_R.
    #[allow(clippy::too_many_arguments)]
    fn add_equation_rows(
        &self,
        physics: &dyn AnyConstraint,
        part: &Part,
        work: &mut BlockWork,
        p: &[f64],
        count: usize,
        size: usize,
        block: &mut [f64],
    ) {
        let BlockWork { real, motion, gradients, .. } = work;
        motion.resize(count * part.dofs, Taylor::default());
        if physics.is_nonholonomic() {
            let accelerations = self.equations.level == Level::Acceleration;
            physics.rows(real.state(part, &self.point.constraint_at), p, self.t, accelerations, motion);
        } else if self.equations.level == Level::Position {
            motion.iter_mut().zip(&*gradients).for_each(|(row, &a)| *row = Taylor::from(a));
        } else {
            physics.rows(real.state(part, &self.point.constraint_at), p, self.t, true, motion);
        }
        let columns = part.columns.len();
        let stabilized = self.equations.level == Level::Stabilized;
        if physics.is_nonholonomic() {
            for second in [false, true].into_iter().take(1 + usize::from(stabilized)) {
                if self.equations.nonholonomic(second).is_none() {
                    // the equation is that the multiplier is zero
                    let own = columns + if second { count } else { 0 };
                    (own..own + count).for_each(|row| block[row + row * size] = 1.0);
                }
            }
        }
        let (mut offset, mut first) = (0, 0);
        for (&node, segment) in part.nodes.iter().zip(&part.segments) {
            let seeds = node_seeds(self.system, self.bases, node);
            for (row, motion) in motion.chunks_exact(part.dofs).enumerate() {
                for (dof, &entry) in motion[offset..offset + segment.len()].iter().enumerate() {
                    let [towards_x, towards_y] = if physics.is_nonholonomic() {
                        self.equations.nonholonomic_entries(entry)
                    } else {
                        self.equations.row_entries(entry)
                    };
                    if entry == Taylor::default() {
                        continue;
                    }
                    for column in 0..seeds.columns {
                        let (x, y) = seeds.direction(dof, column);
                        let at = columns + row + (first + column) * size;
                        block[at] += towards_x[0] * x + towards_y[0] * y;
                        if stabilized {
                            block[at + count] += towards_x[1] * x + towards_y[1] * y;
                        }
                    }
                }
            }
            offset += segment.len();
            first += seeds.columns;
        }
    }

    /// Curvature of the reaction inside a node, and the identity of its rate corrections.
    pub fn node(&self, work: &mut BlockWork, node: usize, block: &mut [f64]) {
        let part = &self.system.node_parts[node];
        let size = part.columns.len();
        block.fill(0.0);
        let local = self.system.nodes[node].local.map(|index| &self.system.locals[index]);
        let unknowns = &self.point.unknowns;
        let stabilized = self.equations.level == Level::Stabilized;
        let sets = [(false, &unknowns.local_mu, 1.0), (true, &unknowns.local_eta, -1.0)];
        if let Some(local) = local {
            for (second, multipliers, sign) in sets.into_iter().take(1 + usize::from(stabilized)) {
                work.multipliers.clear();
                work.multipliers.extend(multipliers[local.equations.clone()].iter().map(|m| sign * m));
                self.add_curvature(&*local.physics, part, work, &[], second, size, block);
            }
        }
        if stabilized {
            for first in (0..size).step_by(LANES) {
                let rows = &mut work.products;
                rows.clear();
                rows.resize(part.dofs, [0.0; LANES]);
                let lanes = self.for_lanes(part, first, |lane, dof, _, y| rows[dof][lane] = y);
                self.add_reduced_rows(part, |dof| &rows[dof], true, first..first + lanes, size, block);
            }
        }
    }
}
