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
    /// Movements (x, y) of coordinates along columns.
    directions: Vec<Direction>,
    second: Vec<Direction>,
    products: Vec<Direction>,
    multipliers: Vec<f64>,
    points: PointWork,
    reduced: Vec<Wide>,
    row_sums: Vec<f64>,
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

/// Numbers that move by a factor times a direction.
fn load_along(target: &mut Vec<Lanes>, values: &[f64], directions: &[Direction], factor: f64) {
    target.clear();
    for (&re, direction) in values.iter().zip(directions) {
        let mut eps = *direction;
        eps.iter_mut().for_each(|e| *e *= factor);
        target.push(Lanes { re, eps });
    }
}

/// x += y, where there is a y.
fn add_directions(x: &mut [Direction], y: &[Direction]) {
    for (x, y) in x.iter_mut().zip(y) {
        x.iter_mut().zip(y).for_each(|(x, y)| *x += y);
    }
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
    /// How the coordinates of a part move along its reduced columns `first..first + 8`: writes x and, if stabilized, y; returns the number of
    /// columns.
    fn seed(&self, part: &Part, first: usize, x: &mut Vec<Direction>, y: &mut Vec<Direction>) -> usize {
        let last = part.columns.len().min(first + LANES);
        x.clear();
        x.resize(part.dofs, [0.0; LANES]);
        y.clear();
        if self.system.options.stabilized {
            y.resize(part.dofs, [0.0; LANES]);
        }
        let (mut column, mut dof) = (0, 0);
        for (&node, segment) in part.nodes.iter().zip(&part.segments) {
            let seeds = node_seeds(self.system, self.bases, node);
            let own = first.max(column)..last.min(column + seeds.columns);
            if !own.is_empty() {
                let (lane, own) = (own.start - first, own.start - column..own.end - column);
                for (i, x) in x[dof..dof + segment.len()].iter_mut().enumerate() {
                    seeds.write_row(i, own.clone(), &mut x[lane..]);
                }
                for (i, y) in y.iter_mut().skip(dof).take(segment.len()).enumerate() {
                    seeds.write_row(segment.len() + i, own.clone(), &mut y[lane..]);
                }
            }
            column += seeds.columns;
            dof += segment.len();
        }
        last - first
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
        let BlockWork { v, q, p, r, directions, second, .. } = work;
        let size = part.columns.len();
        load(p, &self.p[part.parameters.clone()]);
        for first in (0..size).step_by(LANES) {
            let lanes = self.seed(part, first, directions, second);
            load_along(v, state.v, directions, beta);
            load_along(q, state.q, directions, alpha);
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
        let BlockWork { a, v, q, p, r, directions, second, .. } = work;
        load(p, &self.p[part.parameters.clone()]);
        for first in (0..size).step_by(LANES) {
            let lanes = self.seed(part, first, directions, second);
            load_along(a, own.a, directions, gamma);
            load_along(v, own.v, directions, beta);
            add_directions(directions, second);
            load_along(q, own.q, directions, alpha);
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
        let BlockWork { directions, second, products, .. } = work;
        for first in (0..size).step_by(LANES) {
            products.clear();
            products.resize(n, [0.0; LANES]);
            let lanes = self.seed(part, first, directions, second);
            for (kind, (matrix, factor)) in constants.iter().zip([gamma, beta, alpha]).enumerate() {
                if kind == 2 {
                    add_directions(directions, second);
                }
                for (row, product) in matrix.chunks_exact(n).zip(products.iter_mut()) {
                    for (entry, direction) in row.iter().zip(&*directions).filter(|(entry, _)| **entry != 0.0) {
                        product.iter_mut().zip(direction).for_each(|(sum, d)| *sum += factor * entry * d);
                    }
                }
            }
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
        self.set_rows(joint.physics, part, work, p, count);
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
        self.add_equation_rows(joint.physics, part, work, count, size, block);
    }

    /// Rows A along the motion where the equations hold, and A where the reactions act.
    fn set_rows(&self, physics: &dyn AnyConstraint, part: &Part, work: &mut BlockWork, p: &[f64], count: usize) {
        let BlockWork { real, motion, gradients, .. } = work;
        motion.resize(count * part.dofs, Taylor::default());
        gradients.resize(count * part.dofs, 0.0);
        let own = real.state(part, &self.point.constraint_at);
        if self.equations.level == Level::Position && !physics.is_nonholonomic() {
            physics.gradients((own.q, p, self.equations.constraint_time(self.t)), gradients);
            motion.iter_mut().zip(&*gradients).for_each(|(row, &a)| *row = Taylor::from(a));
        } else {
            let accelerations = self.equations.level == Level::Acceleration || !physics.is_nonholonomic();
            physics.rows(own, p, self.t, accelerations, motion);
            gradients.iter_mut().zip(&*motion).for_each(|(a, row)| *a = row.value);
        }
        if self.equations.variational.is_some() {
            let q = real.state(part, &self.point.reaction_at).q;
            physics.gradients((q, p, self.equations.reaction_time(self.t)), gradients);
        }
    }

    /// Derivative of A^T mu along the columns.
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
        let BlockWork { real, directions, second: moved_second, products, multipliers, .. } = work;
        let columns = part.columns.len();
        // a reaction at the start of a step does not move
        let alpha = if self.equations.variational.is_some() { 0.0 } else { self.equations.constraint.alpha };
        // room for the first time that there are multipliers
        for directions in [&mut *directions, &mut *moved_second] {
            directions.clear();
            directions.reserve(part.dofs);
        }
        if alpha == 0.0 || multipliers.iter().all(|&m| m == 0.0) {
            return;
        }
        let q = real.state(part, self.point.reaction(self.equations)).q;
        let at = (q, p, self.equations.reaction_time(self.t));
        let most = part.nodes.iter().map(|&node| self.system.nodes[node].columns.len()).max().unwrap_or(0);
        products.clear();
        products.resize(part.dofs, [0.0; LANES]);
        if physics.is_separable() && most <= LANES {
            // columns of different nodes don't meet: the first of each node share a lane, and so on
            directions.clear();
            directions.resize(part.dofs, [0.0; LANES]);
            let mut dof = 0;
            for (&node, segment) in part.nodes.iter().zip(&part.segments) {
                let seeds = node_seeds(self.system, self.bases, node);
                for (i, direction) in directions[dof..dof + segment.len()].iter_mut().enumerate() {
                    seeds.write_row(i, 0..seeds.columns, direction);
                    if seeds.stabilized() {
                        let mut moved = [0.0; LANES];
                        seeds.write_row(segment.len() + i, 0..seeds.columns, &mut moved);
                        add_directions(std::slice::from_mut(direction), &[moved]);
                    }
                }
                dof += segment.len();
            }
            multipliers.iter_mut().for_each(|m| *m *= alpha);
            physics.curvature(at, multipliers, directions, products);
            self.add_own_rows(part, products, second, size, block);
            return;
        }
        multipliers.iter_mut().for_each(|m| *m *= alpha);
        for first in (0..columns).step_by(LANES) {
            let lanes = self.seed(part, first, directions, moved_second);
            add_directions(directions, moved_second);
            physics.curvature(at, multipliers, directions, products);
            self.add_reduced_rows(part, |dof| &products[dof], second, first..first + lanes, size, block);
        }
    }

    /// The scaled equations of a joint along N_R.
    fn add_equation_rows(
        &self,
        physics: &dyn AnyConstraint,
        part: &Part,
        work: &mut BlockWork,
        count: usize,
        size: usize,
        block: &mut [f64],
    ) {
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
        let BlockWork { motion, row_sums, .. } = work;
        let (mut offset, mut first) = (0, 0);
        for (&node, segment) in part.nodes.iter().zip(&part.segments) {
            let seeds = node_seeds(self.system, self.bases, node);
            for (row, motion) in motion.chunks_exact(part.dofs).enumerate() {
                // both sets of equations, towards the columns of the node
                row_sums.clear();
                row_sums.resize(2 * seeds.columns, 0.0);
                let (sums, second_sums) = row_sums.split_at_mut(seeds.columns);
                for (dof, &entry) in motion[offset..offset + segment.len()].iter().enumerate() {
                    if entry == Taylor::default() {
                        continue;
                    }
                    let [towards_x, towards_y] = if physics.is_nonholonomic() {
                        self.equations.nonholonomic_entries(entry)
                    } else {
                        self.equations.row_entries(entry)
                    };
                    seeds.add_row(dof, towards_x[0], sums);
                    if stabilized {
                        seeds.add_row(segment.len() + dof, towards_y[0], sums);
                        seeds.add_row(dof, towards_x[1], second_sums);
                        seeds.add_row(segment.len() + dof, towards_y[1], second_sums);
                    }
                }
                for (column, (sum, second_sum)) in sums.iter().zip(&*second_sums).enumerate() {
                    let at = columns + row + (first + column) * size;
                    block[at] += sum;
                    if stabilized {
                        block[at + count] += second_sum;
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
        if self.equations.level != Level::Stabilized {
            // a reaction at the start of a step does not move
            if let Some(local) = local.filter(|_| self.equations.variational.is_none()) {
                let Bases { left, right, plain } = &self.bases[node];
                let mu = &unknowns.local_mu[local.equations.clone()];
                let alpha = self.equations.constraint.alpha;
                for (equation, row, column, second) in local.form.second_derivatives() {
                    let weight = alpha * mu[equation] * second;
                    // columns that a coordinate is itself have no others
                    let own = |place: usize| if place < *plain { place..place + 1 } else { *plain..size };
                    for j in own(column) {
                        let along = weight * right[column * size + j];
                        for i in own(row) {
                            block[i + j * size] += left[row * size + i] * along;
                        }
                    }
                }
            }
            return;
        }
        if let Some(local) = local {
            for (second, multipliers, sign) in [(false, &unknowns.local_mu, 1.0), (true, &unknowns.local_eta, -1.0)] {
                work.multipliers.clear();
                work.multipliers.extend(multipliers[local.equations.clone()].iter().map(|m| sign * m));
                self.add_curvature(&*local.physics, part, work, &[], second, size, block);
            }
        }
        for first in (0..size).step_by(LANES) {
            let BlockWork { directions, second, .. } = &mut *work;
            let lanes = self.seed(part, first, directions, second);
            self.add_reduced_rows(part, |dof| &second[dof], true, first..first + lanes, size, block);
        }
    }
}
