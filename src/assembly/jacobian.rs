use super::numbering::{Contributor, Local, NOWHERE, System};
use super::residual::{LocalVec, gather, select, write_level};
use super::{Equations, Level, NodeId, Residual, Unknowns, VectorsAvq};
use crate::elements::{RunScalar, State};
use crate::scalar::{Direction, LANES, Lanes, Taylor};
use rayon::prelude::*;
use smallvec::SmallVec;

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
}

/// Bases of one node; empty where its unknowns are its coordinates.
#[derive(Clone, Debug, Default)]
struct Bases {
    /// N_L: coordinates by reduced rows, row-major, at right angles to the reaction.
    left: Vec<f64>,
    /// N_R: coordinates (x, then y) by reduced columns, row-major, at right angles to the node's equations.
    right: Vec<f64>,
}

/// How a reduced column of one node moves its coordinates.
struct NodeSeeds<'a> {
    dofs: usize,
    columns: usize,
    right: &'a [f64],
    stabilized: bool,
}

impl NodeSeeds<'_> {
    /// (d x, d y) of coordinate `dof` for column `column`.
    #[inline]
    fn direction(&self, dof: usize, column: usize) -> (f64, f64) {
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
        Jacobian { values: vec![0.0; system.pattern.rows.len()], bases: vec![Bases::default(); system.nodes.len()], blocks }
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
        let real = |x: &[S]| x.iter().map(|x| x.value()).collect::<Vec<f64>>();
        let point = |at: &VectorsAvq<S>| VectorsAvq { a: real(&at.a), v: real(&at.v), q: real(&at.q) };
        let (at, constraint_at) = (point(&residual.at), point(&residual.constraint_at));
        let unknowns = Unknowns {
            mu: real(&unknowns.mu),
            eta: real(&unknowns.eta),
            local_mu: real(&unknowns.local_mu),
            local_eta: real(&unknowns.local_eta),
            ..Unknowns::default()
        };
        self.set_bases(system, equations, &constraint_at, t);

        let (bases, blocks) = (&self.bases, &mut self.blocks);
        let (element_blocks, rest) = blocks.split_at_mut(system.element_blocks.len());
        let (constraint_blocks, node_blocks) = rest.split_at_mut(system.constraint_blocks.len());
        let element =
            |(index, block): (usize, &mut Vec<f64>)| element_block(system, bases, equations, &at, index, p, t, block);
        if element_blocks.len() < PARALLEL_JACOBIANS {
            element_blocks.iter_mut().enumerate().for_each(element);
        } else {
            element_blocks.par_iter_mut().with_min_len(16).enumerate().for_each(element);
        }
        let joints: Vec<_> = system.global_constraints().collect();
        let joint = |(joint, block): (&super::numbering::GlobalConstraint, &mut Vec<f64>)| {
            let multipliers = [&unknowns.mu, &unknowns.eta];
            constraint_block(system, bases, equations, &constraint_at, joint, multipliers, p, t, block);
        };
        if constraint_blocks.len() < PARALLEL_JACOBIANS {
            joints.iter().zip(constraint_blocks).for_each(joint);
        } else {
            joints.par_iter().zip(constraint_blocks).with_min_len(16).for_each(joint);
        }
        for ((node, _), block) in system.node_blocks.iter().zip(node_blocks) {
            node_block(system, bases, equations, &constraint_at, *node, &unknowns, t, block);
        }

        self.values.fill(0.0);
        let contributors = system.element_blocks.iter().chain(&system.constraint_blocks);
        for (contributor, block) in contributors.chain(system.node_blocks.iter().map(|(_, c)| c)).zip(&self.blocks) {
            for (&position, &value) in contributor.positions.iter().zip(block) {
                if position != NOWHERE {
                    self.values[position] += value;
                }
            }
        }
    }

    fn set_bases(&mut self, system: &System, equations: &Equations, at: &VectorsAvq<f64>, t: f64) {
        for local in system.eliminated() {
            let dofs = system.model.nodes[local.node].dofs.clone();
            let bases = &mut self.bases[local.node];
            let own = |x: &[f64]| LocalVec::from(&x[dofs.clone()]);
            let (a, v, q) = (own(&at.a), own(&at.v), own(&at.q));
            let reaction = super::local::reaction_rows(local, &q, t);
            super::local::complement(&reaction, local.equations.len(), q.len(), &mut bases.left);
            let rows = super::local::equation_rows(local, equations, State { a: &a, v: &v, q: &q }, t);
            let copies = if equations.level == Level::Stabilized { 2 } else { 1 };
            super::local::complement(&rows, copies * local.equations.len(), copies * q.len(), &mut bases.right);
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
        self.restrict_left(system, |i| pick(residual.f[i]), |i| pick(residual.y[i]), rhs);
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
            for row in 0..half {
                let weight = |dof: usize| {
                    if left.is_empty() { f64::from(u8::from(dof == row)) } else { left[dof * half + row] }
                };
                let combine = |values: &dyn Fn(usize) -> f64| {
                    dofs.clone().enumerate().map(|(i, dof)| weight(i) * values(dof)).sum::<f64>()
                };
                reduced[unknowns.columns.start + row] = combine(&f);
                if stabilized {
                    reduced[unknowns.columns.start + half + row] = combine(&y);
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

    /// Adds the step `reduced` to the unknowns: (x, y) += N_R z, multipliers directly. Returns the largest |d x| + |d y|.
    pub fn add_step<S: RunScalar>(
        &self,
        system: &System,
        reduced: &[f64],
        part: Option<usize>,
        unknowns: &mut Unknowns<S>,
    ) -> f64 {
        let add = |target: &mut S, increment: f64| match part {
            None => target.add_to_value(increment),
            Some(part) => target.add_to_part(part, increment),
        };
        let mut steps = vec![0.0; system.model.dofs];
        self.for_each_direction(system, |dof, column, dx, dy| {
            add(&mut unknowns.x[dof], dx * reduced[column]);
            steps[dof] += dx * reduced[column];
            if dy != 0.0 {
                add(&mut unknowns.y[dof], dy * reduced[column]);
                steps[dof] += dy * reduced[column];
            }
        });
        let places = system.multiplier_columns.iter().zip(&mut unknowns.mu);
        for (column, target) in places.chain(system.stabilizer_columns.iter().zip(&mut unknowns.eta)) {
            if let Some(column) = *column {
                add(target, reduced[column]);
            }
        }
        steps.iter().fold(0.0, |largest, step| f64::max(largest, step.abs()))
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

fn node_seeds<'a>(system: &System, bases: &'a [Bases], node: usize) -> NodeSeeds<'a> {
    NodeSeeds {
        dofs: system.model.nodes[node].dofs.len(),
        columns: system.nodes[node].columns.len(),
        right: &bases[node].right,
        stabilized: system.options.stabilized,
    }
}

/// Seeds of all reduced columns of some nodes: (dof in the local numbering, d x, d y) for each column.
type Columns = SmallVec<[SmallVec<[(usize, f64, f64); 8]>; 16]>;

fn columns_of(system: &System, bases: &[Bases], nodes: &[NodeId]) -> Columns {
    let mut columns = Columns::new();
    let mut first = 0;
    for node in nodes {
        let seeds = node_seeds(system, bases, node.0);
        for column in 0..seeds.columns {
            let entries = (0..seeds.dofs).map(|dof| (dof, seeds.direction(dof, column)));
            columns.push(entries.filter(|(_, d)| *d != (0.0, 0.0)).map(|(dof, (x, y))| (first + dof, x, y)).collect());
        }
        first += seeds.dofs;
    }
    columns
}

/// Adds N_L^T times local rows (coordinates by lanes) to a block's columns `first_column..`; `second` selects the Y rows.
#[allow(clippy::too_many_arguments)]
fn add_reduced_rows(
    system: &System,
    bases: &[Bases],
    nodes: &[NodeId],
    rows: &[Direction],
    second: bool,
    lanes: usize,
    first_column: usize,
    size: usize,
    block: &mut [f64],
) {
    let copies = if system.options.stabilized { 2 } else { 1 };
    let (mut first_dof, mut first_row) = (0, 0);
    for node in nodes {
        let dofs = system.model.nodes[node.0].dofs.len();
        let reduced = system.nodes[node.0].columns.len();
        let half = reduced / copies;
        let left = &bases[node.0].left;
        for row in 0..half {
            let target = first_row + row + if second { half } else { 0 };
            let mut sum = [0.0; LANES];
            if left.is_empty() {
                sum = rows[first_dof + row];
            } else {
                for (i, value) in rows[first_dof..first_dof + dofs].iter().enumerate() {
                    let weight = left[i * half + row];
                    if weight != 0.0 {
                        for (sum, e) in sum.iter_mut().zip(value) {
                            *sum += weight * e;
                        }
                    }
                }
            }
            for (lane, value) in sum.iter().take(lanes).enumerate() {
                block[target + (first_column + lane) * size] += value;
            }
        }
        first_dof += dofs;
        first_row += reduced;
    }
}

fn lanes_of(values: &[f64]) -> LocalVec<Lanes> {
    values.iter().map(|&value| Lanes::constant(value)).collect()
}

/// Local values with lanes: accelerations, velocities, coordinates.
struct Seeded {
    a: LocalVec<Lanes>,
    v: LocalVec<Lanes>,
    q: LocalVec<Lanes>,
}

impl Seeded {
    fn new(system: &System, nodes: &[NodeId], at: &VectorsAvq<f64>) -> Self {
        let local = |x: &[f64]| lanes_of(&gather(system.model, nodes, x));
        Seeded { a: local(&at.a), v: local(&at.v), q: local(&at.q) }
    }

    /// Sets the derivative lanes to the columns from `first` on, scaled by the shift, or back to zero.
    fn seed(&mut self, columns: &Columns, first: usize, shift: super::Shift, on: bool) -> usize {
        let lanes = LANES.min(columns.len() - first);
        let factor = f64::from(u8::from(on));
        for (lane, column) in columns[first..first + lanes].iter().enumerate() {
            for &(dof, x, y) in column {
                self.a[dof].eps[lane] = factor * shift.gamma * x;
                self.v[dof].eps[lane] = factor * shift.beta * x;
                self.q[dof].eps[lane] = factor * shift.alpha * (x + y);
            }
        }
        lanes
    }

    fn state(&self) -> State<'_, Lanes> {
        State { a: &self.a, v: &self.v, q: &self.q }
    }
}

#[allow(clippy::too_many_arguments)]
fn element_block(
    system: &System,
    bases: &[Bases],
    equations: &Equations,
    at: &VectorsAvq<f64>,
    index: usize,
    p: &[f64],
    t: f64,
    block: &mut [f64],
) {
    let element = &system.model.elements[index];
    let columns = columns_of(system, bases, &element.nodes);
    let size = columns.len();
    block.fill(0.0);
    let mut seeded = Seeded::new(system, &element.nodes, at);
    let p = lanes_of(&p[element.parameters.clone()]);
    let mut rows: LocalVec<Lanes> = SmallVec::from_elem(Lanes::default(), seeded.q.len());
    for first in (0..columns.len()).step_by(LANES) {
        let lanes = seeded.seed(&columns, first, equations.residual, true);
        rows.fill(Lanes::default());
        Lanes::element(&*element.physics).add_residual(seeded.state(), &p, Lanes::from(t), &mut rows);
        let directions: LocalVec<Direction> = rows.iter().map(|row| row.eps).collect();
        add_reduced_rows(system, bases, &element.nodes, &directions, false, lanes, first, size, block);
        seeded.seed(&columns, first, equations.residual, false);
    }
}

#[allow(clippy::too_many_arguments)]
fn constraint_block(
    system: &System,
    bases: &[Bases],
    equations: &Equations,
    at: &VectorsAvq<f64>,
    joint: &super::numbering::GlobalConstraint,
    [mu, eta]: [&Vec<f64>; 2],
    p: &[f64],
    t: f64,
    block: &mut [f64],
) {
    let columns = columns_of(system, bases, &joint.nodes);
    let count = joint.equations.len();
    let stabilized = equations.level == Level::Stabilized;
    let size = columns.len() + if stabilized { 2 * count } else { count };
    block.fill(0.0);
    let mut seeded = Seeded::new(system, &joint.nodes, at);
    let dofs = seeded.q.len();
    let lanes_p = lanes_of(&p[joint.parameters.clone()]);
    let physics = Lanes::constraint(joint.physics);
    let scales = equations.row_scales();
    let mut g: SmallVec<[Taylor<Lanes>; 6]> = SmallVec::from_elem(Taylor::default(), count);
    let mut directions: SmallVec<[Direction; 32]> = SmallVec::new();
    for first in (0..columns.len()).step_by(LANES) {
        let lanes = seeded.seed(&columns, first, equations.constraint, true);
        directions.extend(seeded.q.iter().map(|q| q.eps));
        write_level(physics, equations.level, seeded.state(), &lanes_p, Lanes::from(t), &mut g);
        for (row, g) in g.iter().enumerate() {
            let (value, second) = select(equations.level, *g);
            for lane in 0..lanes {
                block[columns.len() + row + (first + lane) * size] = value.eps[lane] * scales[0];
                if stabilized {
                    block[columns.len() + count + row + (first + lane) * size] = second.eps[lane] * scales[1];
                }
            }
        }
        seeded.seed(&columns, first, equations.constraint, false);
    }
    // rows F: curvature of mu . g along the columns, and A^T towards mu; rows Y: the same of -eta . g
    let q = gather(system.model, &joint.nodes, &at.q);
    let point = (&q[..], &p[joint.parameters.clone()], t);
    let mut gradients: SmallVec<[f64; 96]> = SmallVec::from_elem(0.0, count * dofs);
    let mut products: SmallVec<[Direction; 32]> = SmallVec::from_elem([0.0; LANES], directions.len());
    let mut transposed: LocalVec<Direction> = SmallVec::from_elem([0.0; LANES], dofs);
    for (second, multipliers, sign) in [(false, mu, 1.0), (true, eta, -1.0)].into_iter().take(1 + usize::from(stabilized)) {
        let multipliers: SmallVec<[f64; 6]> = multipliers[joint.equations.clone()].iter().map(|m| sign * m).collect();
        joint.physics.linearize_reaction(point, &multipliers, &directions, &mut gradients, &mut products);
        for (group, rows) in products.chunks_exact(dofs).enumerate() {
            let first = group * LANES;
            let lanes = LANES.min(columns.len() - first);
            add_reduced_rows(system, bases, &joint.nodes, rows, second, lanes, first, size, block);
        }
        let place = columns.len() + if second { count } else { 0 };
        for first in (0..count).step_by(LANES) {
            let width = LANES.min(count - first);
            for (dof, row) in transposed.iter_mut().enumerate() {
                for lane in 0..width {
                    row[lane] = sign * gradients[(first + lane) * dofs + dof];
                }
            }
            add_reduced_rows(system, bases, &joint.nodes, &transposed, second, width, place + first, size, block);
        }
    }
}

/// Curvature of the reaction inside a node, and the identity of its rate corrections.
#[allow(clippy::too_many_arguments)]
fn node_block(
    system: &System,
    bases: &[Bases],
    equations: &Equations,
    at: &VectorsAvq<f64>,
    node: usize,
    unknowns: &Unknowns<f64>,
    t: f64,
    block: &mut [f64],
) {
    let nodes = [NodeId(node)];
    let columns = columns_of(system, bases, &nodes);
    let size = columns.len();
    block.fill(0.0);
    let local = system.nodes[node].local.map(|index| &system.locals[index]);
    let mut seeded = Seeded::new(system, &nodes, at);
    let q = gather(system.model, &nodes, &at.q);
    let dofs = q.len();
    let mut rows: LocalVec<Direction> = SmallVec::from_elem([0.0; LANES], dofs);
    let curvature = |local: &Local, multipliers: &[f64], sign: f64, directions: &[Direction], rows: &mut [Direction]| {
        let multipliers: SmallVec<[f64; 6]> = multipliers[local.equations.clone()].iter().map(|m| sign * m).collect();
        let mut gradients: SmallVec<[f64; 96]> = SmallVec::from_elem(0.0, multipliers.len() * dofs);
        local.physics.linearize_reaction((&q, &[], t), &multipliers, directions, &mut gradients, rows);
    };
    for first in (0..size).step_by(LANES) {
        let lanes = seeded.seed(&columns, first, equations.constraint, true);
        let directions: LocalVec<Direction> = seeded.q.iter().map(|q| q.eps).collect();
        if let Some(local) = local {
            curvature(local, &unknowns.local_mu, 1.0, &directions, &mut rows);
            add_reduced_rows(system, bases, &nodes, &rows, false, lanes, first, size, block);
        }
        if equations.level == Level::Stabilized {
            rows.fill([0.0; LANES]);
            if let Some(local) = local {
                curvature(local, &unknowns.local_eta, -1.0, &directions, &mut rows);
            }
            for (lane, column) in columns[first..first + lanes].iter().enumerate() {
                for &(dof, _, y) in column {
                    rows[dof][lane] += y;
                }
            }
            add_reduced_rows(system, bases, &nodes, &rows, true, lanes, first, size, block);
        }
        seeded.seed(&columns, first, equations.constraint, false);
    }
}
