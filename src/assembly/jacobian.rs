use super::batches::{BatchWork, ElementBatch, LaneResults, run_lanes};
use super::constraint_programs::{self, Asked, ConstraintPart};
use super::element_programs::{self, Force};
use super::numbering::{ScatterMap, System, add_at};
use super::reduction::{Columns, NodeReduction};
use super::{Equations, Level, Residual, StageCoefficients, Unknowns, VectorsAvq};
use crate::elements::{FormulaWork, RunScalar, State};
use crate::program::Program;
use smallvec::SmallVec;
use std::sync::Arc;

/// The matrix of one system at one point, with the bases along which the unknowns of each node move.
///
/// Programs of elements and constraints give N_L^T J N_R of each without J.
pub struct Jacobian {
    /// Values in the order of the system's pattern.
    pub values: Vec<f64>,
    bases: Vec<NullSpaces>,
    point: Point,
    /// Coordinates of one node combined with their rates.
    combined: Vec<f64>,
    work: BatchWork<f64>,
    /// Elements evaluated so far.
    pub evaluated: usize,
    /// Stresses that a search keeps, less those at its point.
    relief: Relief,
    is_relieved: bool,
}

/// See [`Jacobian::relieve`].
#[derive(Default)]
struct Relief {
    /// Of all strains, element by element.
    stresses: Vec<f64>,
    /// Where those of an element begin.
    starts: Vec<usize>,
    /// What these stresses add to the multipliers inside nodes.
    local_mu: Vec<f64>,
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
pub(super) struct NullSpaces {
    /// N_L: coordinates by reduced rows, row-major, at right angles to the reaction.
    pub left: Vec<f64>,
    /// N_R: coordinates (x, then y) by reduced columns, row-major, at right angles to the node's equations.
    pub right: Vec<f64>,
    /// Number of coordinates at the front that are reduced columns themselves, in both.
    pub plain: usize,
    /// What both are made of where the other coordinates turn rigidly.
    scaled: [SmallVec<[f64; 9]>; 2],
}

impl NullSpaces {
    /// Appends the numbers that a program makes the bases of.
    fn push(&self, reduction: NodeReduction, numbers: &mut Vec<f64>) {
        let [left, right] = match reduction {
            NodeReduction::Fixed { .. } | NodeReduction::Free { .. } => return,
            NodeReduction::RotationCoordinates { .. } => [&self.scaled[0][..], &self.scaled[1]],
            NodeReduction::Dense { .. } => [&self.left[..], &self.right],
        };
        numbers.extend_from_slice(left);
        numbers.extend_from_slice(right);
    }
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
    /// Movement (x, y) of coordinate `dof` along the combination `z` of all columns of a stabilized system.
    #[inline]
    fn combine(&self, dof: usize, z: &[f64]) -> (f64, f64) {
        if self.right.is_empty() {
            return if z.is_empty() { (0.0, 0.0) } else { (z[dof], z[dof + self.dofs]) };
        }
        let row = |row: usize| {
            let own = &self.right[row * self.columns..(row + 1) * self.columns];
            own.iter().zip(z).fold(0.0, |sum, (r, z)| sum + r * z)
        };
        (row(dof), row(dof + self.dofs))
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

/// Unknowns of a node of three lengths and coordinates that turn rigidly.
const TURNING: usize = 6;

impl Jacobian {
    /// Storage for a system.
    pub fn new(system: &System) -> Self {
        Jacobian {
            values: vec![0.0; system.pattern.rows.len()],
            bases: vec![NullSpaces::default(); system.nodes.len()],
            point: Point::default(),
            combined: Vec::new(),
            work: BatchWork::default(),
            evaluated: 0,
            relief: Relief::default(),
            is_relieved: false,
        }
    }

    /// From now on the stresses in the matrix at the point of `residual` are those that a linear course of all strains along `change` from
    /// the coordinates `before` gives: a bent beam of great axial stiffness is stretched by the correction that bends it, which the next one
    /// takes back without fighting the stress that it makes. Once corrections vanish, so does the difference.
    ///
    /// Source: Magisano, Leonetti, Garcea, Comput. Methods Appl. Mech. Engrg. 313 (2017), "mixed integration points".
    pub fn relieve<S: RunScalar>(
        &mut self,
        system: &System,
        residual: &Residual<S>,
        [before, change]: [&[f64]; 2],
        p: &[f64],
        t: f64,
    ) {
        self.is_relieved = true;
        let relief = &mut self.relief;
        relief.stresses.clear();
        relief.starts.clear();
        let (mut work, mut course) = (FormulaWork::default(), Vec::new());
        let mut forces = vec![0.0; system.model.dofs];
        let mut still = Vec::new();
        for (element, part) in system.model.elements.iter().zip(&system.element_parts) {
            relief.starts.push(relief.stresses.len());
            let Some(formulas) = element.physics.stresses() else { continue };
            let own = || part.segments.iter().flat_map(|dofs| dofs.clone());
            let after = || own().map(|dof| residual.at.q[dof].value());
            let numbers = || p[part.parameters.clone()].iter().copied();
            let places = own().map(|dof| before[dof]).chain(own().map(|dof| change[dof])).chain(after());
            course.clear();
            course.extend_from_slice(work.run(formulas.course.values(), places.chain(numbers()).chain([t])));
            let first = relief.stresses.len();
            relief
                .stresses
                .extend_from_slice(work.run(formulas.deviation.values(), course.iter().copied().chain(numbers())));
            still.clear();
            still.resize(2 * own().count(), 0.0);
            let state = still.iter().copied().chain(after()).chain(numbers()).chain([t]);
            let force = work.run(formulas.force.values(), state.chain(relief.stresses[first..].iter().copied()));
            own().zip(force).for_each(|(dof, force)| forces[dof] += force);
        }
        relief.local_mu.clear();
        relief.local_mu.resize(system.local_equations, 0.0);
        for local in system.eliminated() {
            let dofs = system.model.nodes[local.node].dofs.clone();
            let q: SmallVec<[f64; 12]> = residual.constraint_at.q[dofs.clone()].iter().map(|q| q.value()).collect();
            let rows = super::local::reaction_rows(local, &q);
            let mu = super::local::least_squares(&rows, local.equations.len(), &forces[dofs]);
            relief.local_mu[local.equations.clone()].copy_from_slice(&mu);
        }
    }

    /// Stresses in the matrix are those at its point again.
    pub fn end_relief(&mut self) {
        self.is_relieved = false;
    }

    /// Whether any element has stresses to be relieved.
    pub fn can_relieve(system: &System) -> bool {
        system.model.elements.iter().any(|element| element.physics.has_strains())
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
        self.values.fill(0.0);
        self.add_elements(system, (equations, Force::of(equations)), &point, p, t);
        if self.is_relieved {
            point.unknowns.local_mu.iter_mut().zip(&self.relief.local_mu).for_each(|(mu, own)| *mu += own);
            self.add_elements(system, (equations, Force::Stresses), &point, p, t);
        }
        self.add_constraints(system, equations, &point, p, t);
        for (node, places) in &system.node_blocks {
            self.add_node(system, equations, (*node, places), &point.unknowns);
        }
        self.point = point;
    }

    /// Whether the matrix is the same at all states and times, as its programs show: a linear system without constraints.
    pub fn is_constant(system: &System, equations: &Equations) -> bool {
        let force = Force::of(equations);
        let (_, moves) = numbers_of(equations.residual);
        let stabilized = system.options.stabilized;
        system.constraint_batches().is_empty()
            && system.node_blocks.is_empty()
            && system.element_batches(force).iter().all(|batch| {
                let reads = element_matrix(batch, stabilized, moves).reads();
                let moving = reads[..batch.layout.p()].contains(&true) || reads[batch.layout.t()];
                !moving && Columns::numbers(&batch.nodes, stabilized) == 0
            })
    }

    fn add_elements(&mut self, system: &System, (equations, force): (&Equations, Force), point: &Point, p: &[f64], t: f64) {
        let (shift, moves) = numbers_of(equations.residual);
        for batch in system.element_batches(force) {
            let layout = batch.layout;
            let program = element_matrix(batch, system.options.stabilized, moves);
            self.evaluated += batch.parts.len();
            if program.outputs() == 0 {
                continue;
            }
            let Jacobian { values, bases, work, relief, .. } = self;
            let weights = layout.extra() - layout.weights();
            run_lanes(
                &program,
                batch.parts.len(),
                work,
                |mut lanes, numbers| {
                    batch.write(&mut lanes, (&point.at, p, t), force);
                    if force == Force::Stresses {
                        let stresses = |part: usize| &relief.stresses[relief.starts[batch.parts[part]]..][..weights];
                        lanes.each(numbers, |part, own| own.extend_from_slice(stresses(part)));
                    }
                    shift.into_iter().for_each(|coefficient| lanes.spread(coefficient));
                    let nodes = |part: usize| &system.element_parts[batch.parts[part]].nodes;
                    lanes.each(numbers, |part, own| push_bases(bases, nodes(part), &batch.nodes, own));
                },
                |results| {
                    let blocks = |part: usize| &system.element_blocks[batch.parts[part]];
                    add_entries(&results, blocks, program.labels(), 1.0, values);
                },
            );
        }
    }

    fn add_constraints(&mut self, system: &System, equations: &Equations, point: &Point, p: &[f64], t: f64) {
        let Some(step) = equations.variational else {
            return self.add_constraints_at(system, (equations, ConstraintPart::Both), point, p, t);
        };
        let time = equations.constraint_time(t);
        self.add_constraints_at(system, (equations, ConstraintPart::Equations), point, p, time);
        let reactions = ConstraintPart::Reactions(step.reaction());
        self.add_constraints_at(system, (equations, reactions), point, p, equations.reaction_time(t));
    }

    /// Equations, reactions or both at one point.
    fn add_constraints_at(
        &mut self,
        system: &System,
        (equations, which): (&Equations, ConstraintPart),
        point: &Point,
        p: &[f64],
        t: f64,
    ) {
        let (shift, mut moves) = numbers_of(equations.constraint);
        let mut at = &point.constraint_at;
        if let ConstraintPart::Reactions(_) = which {
            // a reaction at the start of a step does not move
            (moves, at) = ([false; 3], &point.reaction_at);
        }
        for batch in system.constraint_batches() {
            let physics = system.constraint_of(batch);
            let ((asked, scales), factor) = (Asked::part(which, equations, physics.is_nonholonomic()), which.factor());
            // behind those of residuals
            let code = asked.short_code(moves) | 1 << 31;
            let program = batch.programs.get(code, || constraint_programs::matrix(physics, asked, &batch.nodes, moves));
            if program.outputs() == 0 {
                continue;
            }
            let Jacobian { values, bases, work, .. } = self;
            let unknowns = (&point.unknowns, asked.stabilized());
            run_lanes(
                &program,
                batch.parts.len(),
                work,
                |mut lanes, numbers| {
                    batch.write(&mut lanes, (at, p, t), unknowns, scales);
                    shift.into_iter().for_each(|coefficient| lanes.spread(coefficient));
                    let nodes = |part: usize| &system.constraint_parts[batch.parts[part]].nodes;
                    lanes.each(numbers, |part, own| push_bases(bases, nodes(part), &batch.nodes, own));
                },
                |results| {
                    let blocks = |part: usize| &system.constraint_blocks[batch.parts[part]];
                    add_entries(&results, blocks, program.labels(), factor, values);
                },
            );
        }
    }

    /// Adds the curvature of the reaction inside a node, and the identity of its rate corrections.
    fn add_node(
        &mut self,
        system: &System,
        equations: &Equations,
        (node, places): (usize, &[u32]),
        unknowns: &Unknowns<f64>,
    ) {
        let (values, bases) = (&mut self.values, &self.bases);
        let seeds = node_seeds(system, bases, node);
        let (size, dofs) = (seeds.columns, seeds.dofs);
        let stabilized = system.options.stabilized;
        let rows = if stabilized { size / 2 } else { size };
        let left = |dof: usize, row: usize| {
            let left = &bases[node].left;
            if left.is_empty() { f64::from(u8::from(dof == row)) } else { left[dof * rows + row] }
        };
        let mut add = |row: usize, column: usize, value: f64| {
            if value != 0.0 {
                add_at(places[row + column * size], value, values);
            }
        };
        let local = system.nodes[node].local.map(|index| &system.locals[index]);
        if let (Some(local), 3, TURNING, false) = (local, seeds.plain, size, stabilized)
            && let (Some(unit), None) = (local.form.unit_length(), equations.variational)
        {
            let weight = equations.constraint.alpha * unknowns.local_mu[local.equations.start] * unit.second;
            let [left, right] = [&bases[node].left, &bases[node].right].map(|basis| basis.as_chunks::<TURNING>().0);
            for column in 3..TURNING {
                for row in 3..TURNING {
                    let sum = left[3..].iter().zip(&right[3..]).fold(0.0, |sum, (l, r)| sum + l[row] * r[column]);
                    add(row, column, weight * sum);
                }
            }
            return;
        }
        // a reaction at the start of a step does not move
        if let Some(local) = local.filter(|_| equations.variational.is_none()) {
            let alpha = equations.constraint.alpha;
            let sets = [(&unknowns.local_mu, 0, alpha), (&unknowns.local_eta, rows, -alpha)];
            for (multipliers, first, factor) in sets.into_iter().take(if stabilized { 2 } else { 1 }) {
                let mu = &multipliers[local.equations.clone()];
                for (equation, i, j, second) in local.form.second_derivatives() {
                    let weight = factor * mu[equation] * second;
                    for column in 0..size {
                        let (dx, dy) = seeds.direction(j, column);
                        let along = weight * (dx + dy);
                        if along != 0.0 {
                            (0..rows).for_each(|row| add(first + row, column, left(i, row) * along));
                        }
                    }
                }
            }
        }
        if stabilized {
            for dof in 0..dofs {
                for column in 0..size {
                    let (_, dy) = seeds.direction(dof, column);
                    if dy != 0.0 {
                        (0..rows).for_each(|row| add(rows + row, column, left(dof, row) * dy));
                    }
                }
            }
        }
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
                let free = q.len() - turning.coordinates();
                // rows are linear in the coordinates: at this level those of a combination of them and their rates
                let [by_value, by_rate, by_second] = equations.row_weights();
                self.combined.clear();
                let moving = q.iter().zip(v.iter().zip(a)).skip(free);
                self.combined.extend(moving.map(|(q, (v, a))| by_value * q + by_rate * v + by_second * a));
                let NullSpaces { left, right, scaled: [of_left, of_right], plain } = bases;
                for (own, given, basis) in [(of_left, &reaction_q[free..], left), (of_right, &self.combined[..], right)] {
                    own.clear();
                    own.extend_from_slice(given);
                    turning.scale(own);
                    turning.write_basis(free, own, basis);
                }
                *plain = free;
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
            if let (TURNING, 3, false) = (half, self.bases[node].plain, stabilized)
                && let Some(own) = reduced[unknowns.columns.clone()].first_chunk_mut()
            {
                let mut sums = [f(dofs.start), f(dofs.start + 1), f(dofs.start + 2), 0.0, 0.0, 0.0];
                for (weights, dof) in left.as_chunks::<TURNING>().0[3..].iter().zip(dofs.start + 3..) {
                    let value = f(dof);
                    (3..TURNING).for_each(|column| sums[column] += weights[column] * value);
                }
                *own = sums;
                continue;
            }
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

    /// Adds N_R^T (x, y) of every node: the node part of the right-hand side of a transposed solve.
    pub fn restrict_right(&self, system: &System, x: &[f64], y: &[f64], reduced: &mut [f64]) {
        for (node, unknowns) in system.nodes.iter().enumerate() {
            let seeds = node_seeds(system, &self.bases, node);
            let dofs = system.model.nodes[node].dofs.clone();
            let own = &mut reduced[unknowns.columns.clone()];
            if seeds.stabilized {
                for (local, own) in own.iter_mut().enumerate() {
                    for (i, dof) in dofs.clone().enumerate() {
                        let (dx, dy) = seeds.direction(i, local);
                        *own += dx * x[dof] + if dy == 0.0 { 0.0 } else { dy * y[dof] };
                    }
                }
                continue;
            }
            add_restricted(seeds.right, seeds.plain, &x[dofs], own);
        }
    }

    /// (f, y) += N_L reduced for every node: the adjoint of F and Y from a transposed solve.
    pub fn prolong_left(&self, system: &System, reduced: &[f64], f: &mut [f64], y: &mut [f64]) {
        let stabilized = system.options.stabilized;
        for (node, unknowns) in system.nodes.iter().enumerate().filter(|(_, u)| !u.columns.is_empty()) {
            let dofs = system.model.nodes[node].dofs.clone();
            let half = unknowns.columns.len() / if stabilized { 2 } else { 1 };
            let NullSpaces { left, plain, .. } = &self.bases[node];
            let (own, second) = reduced[unknowns.columns.clone()].split_at(half);
            add_prolonged(left, *plain, own, &mut f[dofs.clone()]);
            if stabilized {
                add_prolonged(left, *plain, second, &mut y[dofs]);
            }
        }
    }

    /// Adds the step `reduced` to the unknowns: (x, y) += N_R z, multipliers directly. Returns the largest |d x + d y|,
    /// each times the scale of its coordinate.
    pub fn add_step<S: RunScalar>(
        &self,
        system: &System,
        reduced: &[f64],
        part: Option<usize>,
        unknowns: &mut Unknowns<S>,
        coordinate_scales: &[f64],
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
                    let size = dx.abs() * coordinate_scales[dof];
                    largest = if size <= largest { largest } else { size };
                }
                continue;
            }
            if let (Some(z), 3, TURNING, false) = (z.first_chunk(), seeds.plain, seeds.columns, seeds.stabilized) {
                let [z0, z1, z2, z3, z4, z5]: [f64; TURNING] = *z;
                let dofs = system.model.nodes[node].dofs.clone();
                let rows = &seeds.right.as_chunks::<TURNING>().0[3..];
                let (lengths, turning) = unknowns.x[dofs.clone()].split_at_mut(3);
                let (scales, turning_scales) = coordinate_scales[dofs].split_at(3);
                let mut add_one = |x: &mut S, dx: f64, scale: f64| {
                    add(x, dx);
                    let size = dx.abs() * scale;
                    largest = if size <= largest { largest } else { size };
                };
                for ((x, dx), scale) in lengths.iter_mut().zip([z0, z1, z2]).zip(scales) {
                    add_one(x, dx, *scale);
                }
                for ((x, row), scale) in turning.iter_mut().zip(rows).zip(turning_scales) {
                    add_one(x, row[3] * z3 + row[4] * z4 + row[5] * z5, *scale);
                }
                continue;
            }
            if !seeds.stabilized {
                let (dofs, plain) = (system.model.nodes[node].dofs.clone(), seeds.plain);
                let places = unknowns.x[dofs.clone()].iter_mut().zip(&coordinate_scales[dofs]);
                let rows = seeds.right.chunks_exact(seeds.columns);
                for (i, ((x, scale), row)) in places.zip(rows).enumerate() {
                    let turning = || row[plain..].iter().zip(&z[plain..]).fold(0.0, |sum, (r, z)| sum + r * z);
                    let dx = if i < plain { z[i] } else { turning() };
                    add(x, dx);
                    let size = dx.abs() * scale;
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
                let size = (dx + dy).abs() * coordinate_scales[dof];
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
}

/// reduced += basis^T x; an empty basis is the identity, and so are the first `plain` rows and columns.
fn add_restricted(basis: &[f64], plain: usize, x: &[f64], reduced: &mut [f64]) {
    let plain = if basis.is_empty() { x.len() } else { plain };
    let columns = reduced.len();
    reduced[..plain.min(columns)].iter_mut().zip(x).for_each(|(own, x)| *own += x);
    for (row, x) in basis.chunks_exact(columns.max(1)).zip(x).skip(plain) {
        reduced[plain..].iter_mut().zip(&row[plain..]).for_each(|(own, weight)| *own += weight * x);
    }
}

/// x += basis reduced, for such a basis.
fn add_prolonged(basis: &[f64], plain: usize, reduced: &[f64], x: &mut [f64]) {
    let plain = if basis.is_empty() { x.len() } else { plain };
    x[..plain].iter_mut().zip(reduced).for_each(|(x, own)| *x += own);
    for (row, x) in basis.chunks_exact(reduced.len().max(1)).zip(x).skip(plain) {
        *x += row[plain..].iter().zip(&reduced[plain..]).fold(0.0, |sum, (weight, own)| sum + weight * own);
    }
}

pub(super) fn node_seeds<'a>(system: &System, bases: &'a [NullSpaces], node: usize) -> NodeSeeds<'a> {
    NodeSeeds {
        dofs: system.model.nodes[node].dofs.len(),
        columns: system.nodes[node].columns.len(),
        right: &bases[node].right,
        plain: bases[node].plain,
        stabilized: system.options.stabilized,
    }
}

/// The program of the matrices of a batch.
fn element_matrix(batch: &ElementBatch, stabilized: bool, moves: [bool; 3]) -> Arc<Program> {
    let code = moves.iter().fold(0, |code, &moves| 2 * code + u32::from(moves));
    batch.programs.get(code, || element_programs::matrix(&batch.formula, batch.layout, &batch.nodes, stabilized, moves))
}

/// Coefficients of a shift, and which of them are not zero.
pub(super) fn numbers_of(StageCoefficients { gamma, beta, alpha }: StageCoefficients) -> ([f64; 3], [bool; 3]) {
    let all = [gamma, beta, alpha];
    (all, all.map(|coefficient| coefficient != 0.0))
}

/// Appends the numbers of the bases of a part's nodes.
fn push_bases(bases: &[NullSpaces], nodes: &[usize], reductions: &[NodeReduction], numbers: &mut Vec<f64>) {
    nodes.iter().zip(reductions).for_each(|(&node, &reduction)| bases[node].push(reduction, numbers));
}

/// Adds the entries of blocks, times a factor, to their places in the matrix.
#[inline(always)]
fn add_entries<'b>(
    results: &LaneResults<f64>,
    blocks: impl Fn(usize) -> &'b ScatterMap,
    labels: &[u32],
    factor: f64,
    values: &mut [f64],
) {
    // part by part, so that sums have the same order whatever number of parts was evaluated side by side
    results.for_each_part(|part, entries| match blocks(part) {
        // equations that are left out have none
        ScatterMap::Entries(places) => {
            labels.iter().zip(entries).for_each(|(&label, entry)| add_at(places[label as usize], entry * factor, values));
        }
        ScatterMap::Columns(columns) if labels.len() == columns.size() * columns.size() && factor == 1.0 => {
            columns.for_each_run(|entry, places| entries.add_to(entry, &mut values[places]));
        }
        ScatterMap::Columns(columns) => {
            columns.for_each_place(labels, entries, |place, entry| add_at(place, entry * factor, values));
        }
    });
}
