use super::blocks::{Assembly, BlockWork, Constants, constants};
use super::numbering::{Contributor, NOWHERE, System};
use super::{Equations, Level, Residual, Unknowns, VectorsAvq};
use crate::elements::{RunScalar, State};
use rayon::prelude::*;
use std::ops::Range;

/// Fewer parts than this are differentiated on one thread.
const PARALLEL_JACOBIANS: usize = 64;

/// The matrix of one system at one point, with the bases along which the unknowns of each node move.
///
/// Columns come from dual numbers seeded along the bases with (gamma, beta, alpha): J N_R without forming J.
pub struct Jacobian {
    /// Values in the order of the system's pattern.
    pub values: Vec<f64>,
    bases: Vec<Bases>,
    blocks: Vec<Vec<f64>>,
    point: Point,
    /// Coordinates of one node combined with their rates.
    combined: Vec<f64>,
    work: BlockWork,
    works: Vec<BlockWork>,
    /// dR/da, dR/dv, dR/dq of elements where these are constant.
    constants: Vec<Option<Constants>>,
    /// Blocks of elements evaluated so far.
    pub evaluated: usize,
}

/// Pieces into which many blocks are divided, whatever the number of threads.
const PIECES: usize = 32;

/// Computes blocks with any number of threads, each piece with its own workspace.
fn in_pieces(
    blocks: &mut [Vec<f64>],
    works: &mut Vec<BlockWork>,
    compute: impl Fn(&mut BlockWork, (usize, &mut Vec<f64>)) + Sync,
) {
    let each = blocks.len().div_ceil(PIECES);
    works.resize_with(PIECES, BlockWork::default);
    blocks.par_chunks_mut(each).zip(works).enumerate().for_each(|(piece, (blocks, work))| {
        blocks.iter_mut().enumerate().for_each(|(index, block)| compute(work, (piece * each + index, block)));
    });
}

/// Real numbers at which the matrix is assembled.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    pub at: VectorsAvq<f64>,
    pub constraint_at: VectorsAvq<f64>,
    /// Where reactions act, if that is another point.
    pub reaction_at: VectorsAvq<f64>,
    pub unknowns: Unknowns<f64>,
}

impl Point {
    /// Where reactions act.
    pub fn reaction(&self, equations: &Equations) -> &VectorsAvq<f64> {
        if equations.variational.is_some() { &self.reaction_at } else { &self.constraint_at }
    }

    fn set<S: RunScalar>(&mut self, residual: &Residual<S>, unknowns: &Unknowns<S>) {
        let copy = |target: &mut Vec<f64>, values: &[S]| {
            target.clear();
            target.extend(values.iter().map(|value| value.value()));
        };
        let pairs = [
            (&mut self.at, &residual.at),
            (&mut self.constraint_at, &residual.constraint_at),
            (&mut self.reaction_at, &residual.reaction_at),
        ];
        for (own, given) in pairs {
            copy(&mut own.a, &given.a);
            copy(&mut own.v, &given.v);
            copy(&mut own.q, &given.q);
        }
        copy(&mut self.unknowns.mu, &unknowns.mu);
        copy(&mut self.unknowns.eta, &unknowns.eta);
        copy(&mut self.unknowns.local_mu, &unknowns.local_mu);
        copy(&mut self.unknowns.local_eta, &unknowns.local_eta);
    }
}

/// Bases of one node; empty where its unknowns are its coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Bases {
    /// N_L: coordinates by reduced rows, row-major, at right angles to the reaction.
    pub left: Vec<f64>,
    /// N_R: coordinates (x, then y) by reduced columns, row-major, at right angles to the node's equations.
    pub right: Vec<f64>,
    /// Number of coordinates at the front that are reduced columns themselves, in both.
    pub plain: usize,
}

/// How a reduced column of one node moves its coordinates.
pub(super) struct NodeSeeds<'a> {
    pub dofs: usize,
    pub columns: usize,
    right: &'a [f64],
    plain: usize,
    stabilized: bool,
}

impl NodeSeeds<'_> {
    /// Movement (x, y) of coordinate `dof` along the combination `z` of all columns.
    #[inline]
    fn combine(&self, dof: usize, z: &[f64]) -> (f64, f64) {
        let fixed = z.is_empty();
        if self.right.is_empty() {
            let y = if self.stabilized && !fixed { z[dof + self.dofs] } else { 0.0 };
            return (if fixed { 0.0 } else { z[dof] }, y);
        }
        if dof < self.plain {
            return (z[dof], 0.0);
        }
        let row = |row: usize| {
            let own = &self.right[row * self.columns + self.plain..(row + 1) * self.columns];
            own.iter().zip(&z[self.plain..]).fold(0.0, |sum, (r, z)| sum + r * z)
        };
        (row(dof), if self.stabilized { row(dof + self.dofs) } else { 0.0 })
    }

    /// Whether rate corrections y stand behind the coordinates x.
    pub fn stabilized(&self) -> bool {
        self.stabilized
    }

    /// Writes row `row` of N_R, (x, then y), for some columns.
    #[inline]
    pub fn write_row(&self, row: usize, columns: Range<usize>, target: &mut [f64]) {
        if self.right.is_empty() {
            if columns.contains(&row) {
                target[row - columns.start] = 1.0;
            }
        } else {
            let own = &self.right[row * self.columns..(row + 1) * self.columns];
            let count = columns.len();
            target[..count].copy_from_slice(&own[columns]);
        }
    }

    /// Adds `factor` times row `row` of N_R, (x, then y).
    #[inline]
    pub fn add_row(&self, row: usize, factor: f64, target: &mut [f64]) {
        if self.right.is_empty() || row < self.plain {
            // a node that is held has no columns
            target.iter_mut().skip(row).take(1).for_each(|target| *target += factor);
        } else {
            let own = &self.right[row * self.columns + self.plain..(row + 1) * self.columns];
            target[self.plain..].iter_mut().zip(own).for_each(|(target, entry)| *target += factor * entry);
        }
    }

    /// (d x, d y) of coordinate `dof` for column `column`.
    #[inline]
    pub fn direction(&self, dof: usize, column: usize) -> (f64, f64) {
        if self.right.is_empty() {
            let on = |active: bool| f64::from(u8::from(active));
            (on(column == dof), on(self.stabilized && column == dof + self.dofs))
        } else {
            let entry = |row: usize| self.right[row * self.columns + column];
            (entry(dof), if self.stabilized { entry(dof + self.dofs) } else { 0.0 })
        }
    }
}

impl Jacobian {
    /// Storage for a system.
    pub fn new(system: &System) -> Self {
        let storage =
            |list: &[Contributor]| -> Vec<Vec<f64>> { list.iter().map(|c| vec![0.0; c.positions.len()]).collect() };
        let mut blocks = storage(&system.element_blocks);
        blocks.extend(storage(&system.constraint_blocks));
        blocks.extend(system.node_blocks.iter().map(|(_, c)| vec![0.0; c.positions.len()]));
        Jacobian {
            values: vec![0.0; system.pattern.rows.len()],
            bases: vec![Bases::default(); system.nodes.len()],
            blocks,
            point: Point::default(),
            combined: Vec::new(),
            work: BlockWork::default(),
            works: Vec::new(),
            constants: Vec::new(),
            evaluated: 0,
        }
    }

    /// Differentiates the system at the point where `residual` was evaluated last.
    pub fn assemble<S: RunScalar>(
        &mut self,
        system: &System,
        equations: &Equations,
        residual: &Residual<S>,
        unknowns: &Unknowns<S>,
        p: &[f64],
        t: f64,
    ) {
        let mut point = std::mem::take(&mut self.point);
        point.set(residual, unknowns);
        self.set_bases(system, equations, &point);

        let (bases, blocks) = (&self.bases, &mut self.blocks);
        let assembly = Assembly { system, equations, bases, point: &point, p, t };
        if self.constants.is_empty() {
            self.constants = (0..system.element_blocks.len()).map(|index| constants(system, index, p)).collect();
            self.evaluated += 3 * self.constants.iter().flatten().count();
        }
        let constants = &self.constants;
        self.evaluated += constants.iter().filter(|constant| constant.is_none()).count();
        let (element_blocks, rest) = blocks.split_at_mut(system.element_blocks.len());
        let (constraint_blocks, node_blocks) = rest.split_at_mut(system.constraint_blocks.len());
        let element = |work: &mut BlockWork, (index, block): (usize, &mut Vec<f64>)| match &constants[index] {
            Some(matrices) if matrices.iter().all(Vec::is_empty) => {}
            Some(matrices) => {
                block.fill(0.0);
                assembly.constant_element(work, index, matrices, block);
            }
            None => assembly.element(work, index, block),
        };
        if element_blocks.len() < PARALLEL_JACOBIANS {
            element_blocks.iter_mut().enumerate().for_each(|job| element(&mut self.work, job));
        } else {
            in_pieces(element_blocks, &mut self.works, element);
        }
        let joint = |work: &mut BlockWork, (index, block): (usize, &mut Vec<f64>)| assembly.constraint(work, index, block);
        if constraint_blocks.len() < PARALLEL_JACOBIANS {
            constraint_blocks.iter_mut().enumerate().for_each(|job| joint(&mut self.work, job));
        } else {
            in_pieces(constraint_blocks, &mut self.works, joint);
        }
        for ((node, _), block) in system.node_blocks.iter().zip(node_blocks) {
            assembly.node(&mut self.work, *node, block);
        }
        self.point = point;

        self.values.fill(0.0);
        let contributors = system.element_blocks.iter().chain(&system.constraint_blocks);
        let contributors = contributors.chain(system.node_blocks.iter().map(|(_, c)| c)).zip(&self.blocks).enumerate();
        let is_zero = |index: usize| matches!(self.constants.get(index), Some(Some(all)) if all.iter().all(Vec::is_empty));
        for (_, (contributor, block)) in contributors.filter(|(index, _)| !is_zero(*index)) {
            for (&position, &value) in contributor.positions.iter().zip(block) {
                if position != NOWHERE {
                    self.values[position] += value;
                }
            }
        }
    }

    /// Constant matrices of an element, once a matrix has been assembled.
    pub(super) fn constants_of(&self, element: usize) -> Option<&Constants> {
        self.constants.get(element)?.as_ref()
    }

    fn set_bases(&mut self, system: &System, equations: &Equations, point: &Point) {
        let (at, reaction_at) = (&point.constraint_at, point.reaction(equations));
        for local in system.eliminated() {
            let dofs = system.model.nodes[local.node].dofs.clone();
            let bases = &mut self.bases[local.node];
            let (a, v, q) = (&at.a[dofs.clone()], &at.v[dofs.clone()], &at.q[dofs.clone()]);
            let reaction_q = &reaction_at.q[dofs.clone()];
            let stabilized = equations.level == Level::Stabilized;
            if let Some(turning) = local.form.turning().filter(|_| !stabilized) {
                turning.basis(reaction_q, &mut bases.left);
                // rows are linear in the coordinates: at this level those of a combination of them and their rates
                let [by_value, by_rate, by_second] = equations.row_weights();
                self.combined.clear();
                let moving = q.iter().zip(v.iter().zip(a));
                self.combined.extend(moving.map(|(q, (v, a))| by_value * q + by_rate * v + by_second * a));
                turning.basis(&self.combined, &mut bases.right);
                bases.plain = q.len() - turning.coordinates();
                continue;
            }
            let reaction = super::local::reaction_rows(local, reaction_q);
            super::local::complement(&reaction, local.equations.len(), q.len(), &mut bases.left);
            let rows = super::local::equation_rows(local, equations, State { a, v, q });
            let copies = if stabilized { 2 } else { 1 };
            super::local::complement(&rows, copies * local.equations.len(), copies * q.len(), &mut bases.right);
            bases.plain = 0;
        }
    }

    /// The coordinate that moves most with an unknown of a node.
    pub(super) fn leading_dof(&self, system: &System, node: usize, column: usize) -> usize {
        let dofs = system.model.nodes[node].dofs.clone();
        let seeds = node_seeds(system, &self.bases, node);
        let size = |i: &usize| {
            let (x, y) = seeds.direction(*i, column);
            x.abs().max(y.abs())
        };
        dofs.start + (0..dofs.len()).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(0)
    }

    /// Right-hand side of the matrix: minus the reduced rows of (F, Y, G), derivative part `part` or the value.
    pub fn reduce<S: RunScalar>(&self, system: &System, residual: &Residual<S>, part: Option<usize>, rhs: &mut [f64]) {
        let pick = |s: S| part.map_or(s.value(), |part| s.part(part));
        match part {
            None => self.restrict_left(system, |i| residual.f[i].value(), |i| residual.y[i].value(), rhs),
            Some(part) => self.restrict_left(system, |i| residual.f[i].part(part), |i| residual.y[i].part(part), rhs),
        }
        let rows = system.multiplier_columns.iter().zip(&residual.g);
        for (column, &g) in rows.chain(system.stabilizer_columns.iter().zip(&residual.g_second)) {
            if let Some(column) = *column {
                rhs[column] = pick(g);
            }
        }
        for value in rhs {
            *value = -*value;
        }
    }

    /// N_L^T (f, y) for every node.
    pub fn restrict_left(&self, system: &System, f: impl Fn(usize) -> f64, y: impl Fn(usize) -> f64, reduced: &mut [f64]) {
        let stabilized = system.options.stabilized;
        for (node, unknowns) in system.nodes.iter().enumerate().filter(|(_, u)| !u.columns.is_empty()) {
            let dofs = system.model.nodes[node].dofs.clone();
            let half = unknowns.columns.len() / if stabilized { 2 } else { 1 };
            let left = &self.bases[node].left;
            let (own, second) = reduced[unknowns.columns.clone()].split_at_mut(half);
            own.fill(0.0);
            second.fill(0.0);
            if left.is_empty() {
                own.iter_mut().zip(dofs.clone()).for_each(|(own, dof)| *own = f(dof));
                second.iter_mut().zip(dofs).for_each(|(second, dof)| *second = y(dof));
                continue;
            }
            let plain = self.bases[node].plain;
            own[..plain].iter_mut().zip(dofs.clone()).for_each(|(own, dof)| *own = f(dof));
            for (weights, dof) in left.chunks_exact(half).zip(dofs).skip(plain) {
                let value = f(dof);
                let turning = own[plain..].iter_mut().zip(&weights[plain..]);
                turning.for_each(|(own, weight)| *own += weight * value);
                if stabilized {
                    let value = y(dof);
                    second.iter_mut().zip(weights).for_each(|(second, weight)| *second += weight * value);
                }
            }
        }
    }

    /// N_R^T (x, y) for every node: the node part of the right-hand side of a transposed solve.
    pub fn restrict_right(&self, system: &System, x: &[f64], y: &[f64], reduced: &mut [f64]) {
        self.for_each_direction(system, |dof, column, dx, dy| {
            reduced[column] += dx * x[dof] + if dy == 0.0 { 0.0 } else { dy * y[dof] };
        });
    }

    /// (f, y) += N_L reduced for every node: the adjoint of F and Y from a transposed solve.
    pub fn prolong_left(&self, system: &System, reduced: &[f64], f: &mut [f64], y: &mut [f64]) {
        let stabilized = system.options.stabilized;
        for (node, unknowns) in system.nodes.iter().enumerate().filter(|(_, u)| !u.columns.is_empty()) {
            let dofs = system.model.nodes[node].dofs.clone();
            let half = unknowns.columns.len() / if stabilized { 2 } else { 1 };
            let left = &self.bases[node].left;
            for (i, dof) in dofs.enumerate() {
                for row in 0..half {
                    let weight = if left.is_empty() { f64::from(u8::from(i == row)) } else { left[i * half + row] };
                    f[dof] += weight * reduced[unknowns.columns.start + row];
                    if stabilized {
                        y[dof] += weight * reduced[unknowns.columns.start + half + row];
                    }
                }
            }
        }
    }

    /// Adds the step `reduced` to the unknowns: (x, y) += N_R z, multipliers directly. Returns the largest |d x + d y| times its
    /// lever.
    pub fn add_step<S: RunScalar>(
        &self,
        system: &System,
        reduced: &[f64],
        part: Option<usize>,
        unknowns: &mut Unknowns<S>,
        levers: &[f64],
    ) -> f64 {
        let add = |target: &mut S, increment: f64| match part {
            None => target.add_to_value(increment),
            Some(part) => target.add_to_part(part, increment),
        };
        let mut largest: f64 = 0.0;
        for (node, own) in system.nodes.iter().enumerate() {
            let seeds = node_seeds(system, &self.bases, node);
            let z = &reduced[own.columns.clone()];
            if seeds.right.is_empty() && !seeds.stabilized {
                for (dof, &dx) in system.model.nodes[node].dofs.clone().zip(z) {
                    add(&mut unknowns.x[dof], dx);
                    let size = dx.abs() * levers[dof];
                    largest = if size <= largest { largest } else { size };
                }
                continue;
            }
            for (i, dof) in system.model.nodes[node].dofs.clone().enumerate() {
                let (dx, dy) = seeds.combine(i, z);
                add(&mut unknowns.x[dof], dx);
                if dy != 0.0 {
                    add(&mut unknowns.y[dof], dy);
                }
                // a maximum that keeps NaN
                let size = (dx + dy).abs() * levers[dof];
                largest = if size <= largest { largest } else { size };
            }
        }
        let places = system.multiplier_columns.iter().zip(&mut unknowns.mu);
        for (column, target) in places.chain(system.stabilizer_columns.iter().zip(&mut unknowns.eta)) {
            if let Some(column) = *column {
                add(target, reduced[column]);
            }
        }
        largest
    }

    /// Calls `f(dof, column, dx, dy)` for every coordinate that a column moves.
    fn for_each_direction(&self, system: &System, mut f: impl FnMut(usize, usize, f64, f64)) {
        for (node, unknowns) in system.nodes.iter().enumerate() {
            let seeds = node_seeds(system, &self.bases, node);
            let dofs = system.model.nodes[node].dofs.clone();
            for (local, column) in unknowns.columns.clone().enumerate() {
                for (i, dof) in dofs.clone().enumerate() {
                    let (dx, dy) = seeds.direction(i, local);
                    if dx != 0.0 || dy != 0.0 {
                        f(dof, column, dx, dy);
                    }
                }
            }
        }
    }
}

pub(super) fn node_seeds<'a>(system: &System, bases: &'a [Bases], node: usize) -> NodeSeeds<'a> {
    NodeSeeds {
        dofs: system.model.nodes[node].dofs.len(),
        columns: system.nodes[node].columns.len(),
        right: &bases[node].right,
        plain: bases[node].plain,
        stabilized: system.options.stabilized,
    }
}
