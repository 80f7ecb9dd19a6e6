//! Bases along which the unknowns of nodes move, for all nodes of a kind that follow each other at a time.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::Equations;
use super::jacobian::Point;
use super::node_runs::NodeRun;
use super::numbering::System;
use super::reduction::{NodeReduction, RotationCoordinates};
use std::ops::Range;

/// Bases of all nodes: N_L at right angles to the reaction inside a node, N_R to its equations.
#[derive(Default)]
pub(super) struct NullSpaces {
    /// The numbers that they are made of, node after node: scaled coordinates where some turn rigidly, with rate corrections their scaled rates,
    /// too; none where unknowns are coordinates.
    numbers: [Vec<f64>; 2],
}

/// The reaction's side: rows of the matrix.
pub(super) const LEFT: usize = 0;
/// The unknowns' side: columns of the matrix.
pub(super) const RIGHT: usize = 1;

impl NullSpaces {
    /// The numbers of all N_L, or of all N_R.
    pub fn numbers(&self, side: usize) -> &[f64] {
        &self.numbers[side]
    }

    /// The bases at a point.
    pub fn set(&mut self, system: &System, equations: &Equations, point: &Point) {
        let (at, reaction_at) = (point.constraint(), point.reaction(equations));
        let numbers = &mut self.numbers;
        for side in [LEFT, RIGHT] {
            numbers[side].resize(system.node_runs.last().map_or(0, |run| run.all_numbers(side).end), 0.0);
        }
        let [left, right] = numbers;
        // rows are linear in the coordinates: at this level those of a combination of them and their rates
        let [by_value, by_rate, by_second] = equations.row_weights();
        let combined = |i: usize| by_value * at.q[i] + by_rate * at.v[i] + by_second * at.a[i];
        let rate = equations.constraint.alpha / equations.constraint.beta;
        for run in &system.node_runs {
            let NodeReduction::RotationCoordinates { free, turning } = run.reduction else { continue };
            let (lefts, rights) = (&mut left[run.all_numbers(LEFT)], &mut right[run.all_numbers(RIGHT)]);
            let count = turning.coordinates();
            let both = lefts.chunks_exact_mut(count).zip(rights.chunks_exact_mut(run.numbers[RIGHT]));
            for ((left, right), start) in both.zip(run.starts().map(|start| start + free)) {
                left.copy_from_slice(&reaction_at.q[start..start + count]);
                let scale = turning.scale(left);
                left.iter_mut().for_each(|own| *own *= scale);
                let (right, rates) = right.split_at_mut(count);
                right.iter_mut().zip(start..).for_each(|(own, i)| *own = combined(i));
                let scale = turning.scale(right);
                right.iter_mut().for_each(|own| *own *= scale);
                rates.iter_mut().zip(&at.v[start..]).for_each(|(own, v)| *own = rate * v * scale);
            }
        }
    }

    /// Those of one node.
    pub fn of_node(&self, system: &System, node: usize) -> NodeNullSpaces<'_> {
        let run = &system.node_runs[system.node_runs.partition_point(|run| run.nodes.end <= node)];
        let of = |side: usize| &self.numbers[side][run.numbers_of(node, side)];
        NodeNullSpaces { reduction: run.reduction, left: of(LEFT), right: of(RIGHT), stabilized: system.options.stabilized }
    }

    /// N_L^T (f, y) of every node, times a factor, in place of its unknowns.
    pub fn restrict_left<S: Copy>(
        &self,
        system: &System,
        [f, y]: [&[S]; 2],
        (value, factor): (impl Fn(S) -> f64, f64),
        reduced: &mut [f64],
    ) {
        for run in &system.node_runs {
            if !system.options.stabilized {
                restrict_run(run, &self.numbers[LEFT][run.all_numbers(LEFT)], (f, &value), factor, reduced);
                continue;
            }
            for node in run.nodes.clone() {
                let (bases, dofs) = (self.of_node(system, node), run.dofs(node));
                let (own, second) = reduced[run.columns_of(node)].split_at_mut(run.columns / 2);
                for (values, own) in [(f, own), (y, second)] {
                    for (row, own) in own.iter_mut().enumerate() {
                        let along = dofs.clone().enumerate().map(|(i, dof)| bases.left(i, row) * value(values[dof]));
                        *own = along.sum::<f64>() * factor;
                    }
                }
            }
        }
    }

    /// N_R^T (x, y) of every node, times a factor, in place of its unknowns.
    pub fn restrict_right(&self, system: &System, [x, y]: [&[f64]; 2], factor: f64, reduced: &mut [f64]) {
        for run in &system.node_runs {
            if !system.options.stabilized {
                restrict_run(run, &self.numbers[RIGHT][run.all_numbers(RIGHT)], (x, &|x| x), factor, reduced);
                continue;
            }
            for node in run.nodes.clone() {
                let (bases, dofs) = (self.of_node(system, node), run.dofs(node));
                for (column, own) in reduced[run.columns_of(node)].iter_mut().enumerate() {
                    let mut sum = 0.0;
                    for (i, dof) in dofs.clone().enumerate() {
                        let (dx, dy) = bases.direction(i, column);
                        sum += dx * x[dof] + if dy == 0.0 { 0.0 } else { dy * y[dof] };
                    }
                    *own = sum * factor;
                }
            }
        }
    }

    /// (f, y) = N_L reduced for every node.
    pub fn prolong_left(&self, system: &System, reduced: &[f64], f: &mut [f64], y: &mut [f64]) {
        for run in &system.node_runs {
            if let NodeReduction::Fixed { .. } = run.reduction {
                f[run.all_dofs()].fill(0.0);
                y.get_mut(run.all_dofs()).into_iter().for_each(|y| y.fill(0.0));
                continue;
            }
            if !system.options.stabilized {
                let numbers = &self.numbers[LEFT][run.all_numbers(LEFT)];
                prolong_run(run, numbers, reduced, |first, own| f[first..first + own.len()].copy_from_slice(own));
                continue;
            }
            for node in run.nodes.clone() {
                let (bases, own) = (self.of_node(system, node), &reduced[run.columns_of(node)]);
                let (own, second) = own.split_at(run.columns / 2);
                for (i, dof) in run.dofs(node).enumerate() {
                    let along = |own: &[f64]| own.iter().enumerate().map(|(row, own)| bases.left(i, row) * own).sum::<f64>();
                    (f[dof], y[dof]) = (along(own), along(second));
                }
            }
        }
    }

    /// Gives out N_R reduced of every node: `change(first, (d x, ..), (d y, ..))` for coordinates that follow each other; d y is empty
    /// without rate corrections.
    pub fn prolong_right(&self, system: &System, reduced: &[f64], mut change: impl FnMut(usize, &[f64], &[f64])) {
        for run in &system.node_runs {
            if !system.options.stabilized {
                let numbers = &self.numbers[RIGHT][run.all_numbers(RIGHT)];
                prolong_run(run, numbers, reduced, |first, changes| change(first, changes, &[]));
                continue;
            }
            // fixed nodes do not move
            for node in run.nodes.clone().filter(|_| run.columns > 0) {
                let (bases, own) = (self.of_node(system, node), &reduced[run.columns_of(node)]);
                for (i, dof) in run.dofs(node).enumerate() {
                    let (mut x, mut y) = (0.0, 0.0);
                    for (column, own) in own.iter().enumerate() {
                        let (dx, dy) = bases.direction(i, column);
                        (x, y) = (x + dx * own, y + dy * own);
                    }
                    change(dof, &[x], &[y]);
                }
            }
        }
    }
}

/// Sets the unknowns of a run to N^T x, times a factor, with the numbers of its bases.
#[inline(always)]
fn restrict_run<S: Copy>(
    run: &NodeRun,
    numbers: &[f64],
    (x, value): (&[S], &impl Fn(S) -> f64),
    factor: f64,
    reduced: &mut [f64],
) {
    let (x, reduced) = (&x[run.all_dofs()], &mut reduced[run.all_columns()]);
    match run.reduction {
        NodeReduction::Fixed { .. } => {}
        NodeReduction::Free { .. } => reduced.iter_mut().zip(x).for_each(|(own, &x)| *own = value(x) * factor),
        NodeReduction::RotationCoordinates { free: 3, turning: RotationCoordinates::Euler } => {
            restrict_turning::<S, 4>((3, RotationCoordinates::Euler), numbers, (x, value), factor, reduced);
        }
        NodeReduction::RotationCoordinates { free, turning: RotationCoordinates::Euler } => {
            restrict_turning::<S, 4>((free, RotationCoordinates::Euler), numbers, (x, value), factor, reduced);
        }
        NodeReduction::RotationCoordinates { free, turning: RotationCoordinates::Axes } => {
            restrict_turning::<S, 9>((free, RotationCoordinates::Axes), numbers, (x, value), factor, reduced);
        }
    }
}

#[inline(always)]
fn restrict_turning<S: Copy, const COORDINATES: usize>(
    (free, turning): (usize, RotationCoordinates),
    numbers: &[f64],
    (x, value): (&[S], &impl Fn(S) -> f64),
    factor: f64,
    reduced: &mut [f64],
) {
    let nodes = x.chunks_exact(free + COORDINATES).zip(reduced.chunks_exact_mut(free + 3));
    for ((x, own), scaled) in nodes.zip(numbers.as_chunks::<COORDINATES>().0) {
        let rows = turning.rows(scaled);
        let ((moving, turned), (own, turns)) = (x.split_at(free), own.split_at_mut(free));
        own.iter_mut().zip(moving).for_each(|(own, &x)| *own = value(x) * factor);
        let mut sums = [0.0; 3];
        for (row, &x) in rows.iter().zip(turned) {
            let x = value(x);
            for axis in 0..3 {
                sums[axis] += row[axis] * x;
            }
        }
        turns.iter_mut().zip(sums).for_each(|(own, sum)| *own = sum * factor);
    }
}

/// Calls `change(first coordinate, changes)` with N times the unknowns of a run, for coordinates that follow each other.
#[inline(always)]
fn prolong_run(run: &NodeRun, numbers: &[f64], reduced: &[f64], mut change: impl FnMut(usize, &[f64])) {
    let (first, reduced) = (run.first_dof, &reduced[run.all_columns()]);
    match run.reduction {
        NodeReduction::Fixed { .. } => {}
        NodeReduction::Free { .. } => change(first, reduced),
        NodeReduction::RotationCoordinates { free: 3, turning: RotationCoordinates::Euler } => {
            prolong_turning::<4>((3, RotationCoordinates::Euler), numbers, reduced, first, change);
        }
        NodeReduction::RotationCoordinates { free, turning: RotationCoordinates::Euler } => {
            prolong_turning::<4>((free, RotationCoordinates::Euler), numbers, reduced, first, change);
        }
        NodeReduction::RotationCoordinates { free, turning: RotationCoordinates::Axes } => {
            prolong_turning::<9>((free, RotationCoordinates::Axes), numbers, reduced, first, change);
        }
    }
}

#[inline(always)]
fn prolong_turning<const COORDINATES: usize>(
    (free, turning): (usize, RotationCoordinates),
    numbers: &[f64],
    reduced: &[f64],
    first: usize,
    mut change: impl FnMut(usize, &[f64]),
) {
    let nodes = reduced.chunks_exact(free + 3).zip(numbers.as_chunks::<COORDINATES>().0);
    for ((own, scaled), dof) in nodes.zip((first..).step_by(free + COORDINATES)) {
        let (moving, turns) = own.split_at(free);
        change(dof, moving);
        let turned = turning.rows(scaled).map(|row| row[0] * turns[0] + row[1] * turns[1] + row[2] * turns[2]);
        change(dof + free, &turned);
    }
}

/// The bases of one node.
pub(super) struct NodeNullSpaces<'b> {
    pub reduction: NodeReduction,
    left: &'b [f64],
    right: &'b [f64],
    stabilized: bool,
}

impl NodeNullSpaces<'_> {
    /// An entry of N_L.
    pub fn left(&self, dof: usize, row: usize) -> f64 {
        self.entry(self.left, dof, row)
    }

    /// (d x, d y) of a coordinate along a column.
    pub fn direction(&self, dof: usize, column: usize) -> (f64, f64) {
        let unknowns = self.reduction.unknowns();
        if !self.stabilized {
            return (self.entry(self.right, dof, column), 0.0);
        }
        let (turns, rates) = self.right.split_at(self.right.len() / 2);
        let turn = self.entry(turns, dof, column % unknowns);
        let rate = match self.reduction {
            NodeReduction::RotationCoordinates { free, .. } if dof >= free && column % unknowns >= free => {
                self.entry(rates, dof, column % unknowns)
            }
            _ => 0.0,
        };
        if column < unknowns { (turn + rate, -rate) } else { (rate, turn - rate) }
    }

    fn entry(&self, numbers: &[f64], row: usize, column: usize) -> f64 {
        let unit = |row: usize| f64::from(u8::from(row == column));
        match self.reduction {
            NodeReduction::Fixed { .. } => 0.0,
            NodeReduction::Free { .. } => unit(row),
            NodeReduction::RotationCoordinates { free, .. } if row < free || column < free => unit(row),
            NodeReduction::RotationCoordinates { free, turning } => turning.value(row - free, column - free, numbers),
        }
    }
}

/// Where the numbers of each node's bases begin: N_L, N_R.
pub(super) fn starts_of_numbers(system: &System) -> Vec<[Range<usize>; 2]> {
    let runs = system.node_runs.iter();
    runs.flat_map(|run| run.nodes.clone().map(|node| [LEFT, RIGHT].map(|side| run.numbers_of(node, side)))).collect()
}
