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
    /// The numbers that they are made of, node after node: scaled coordinates where some turn rigidly; none where unknowns are coordinates.
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
            numbers[side].resize(system.node_runs.last().map_or(0, |run| run.all_numbers().end), 0.0);
        }
        let [left, right] = numbers;
        // rows are linear in the coordinates: at this level those of a combination of them and their rates
        let [by_value, by_rate, by_second] = equations.row_weights();
        let combined = |i: usize| by_value * at.q[i] + by_rate * at.v[i] + by_second * at.a[i];
        for run in &system.node_runs {
            let NodeReduction::RotationCoordinates { free, turning } = run.reduction else { continue };
            let (lefts, rights) = (&mut left[run.all_numbers()], &mut right[run.all_numbers()]);
            let count = turning.coordinates();
            let both = lefts.chunks_exact_mut(count).zip(rights.chunks_exact_mut(count));
            for ((left, right), start) in both.zip(run.starts().map(|start| start + free)) {
                left.copy_from_slice(&reaction_at.q[start..start + count]);
                let scale = turning.scale(left);
                left.iter_mut().for_each(|own| *own *= scale);
                right.iter_mut().zip(start..).for_each(|(own, i)| *own = combined(i));
                let scale = turning.scale(right);
                right.iter_mut().for_each(|own| *own *= scale);
            }
        }
    }

    /// Those of one node.
    pub fn of_node(&self, system: &System, node: usize) -> NodeNullSpaces<'_> {
        let run = &system.node_runs[system.node_runs.partition_point(|run| run.nodes.end <= node)];
        NodeNullSpaces { reduction: run.reduction, right: &self.numbers[RIGHT][run.numbers_of(node)] }
    }

    /// N_L^T f of every node, times a factor, in place of its unknowns.
    pub fn restrict_left<S: Copy>(
        &self,
        system: &System,
        f: &[S],
        (value, factor): (impl Fn(S) -> f64, f64),
        reduced: &mut [f64],
    ) {
        for run in &system.node_runs {
            restrict_run(run, &self.numbers[LEFT][run.all_numbers()], (f, &value), factor, reduced);
        }
    }

    /// N_R^T x of every node, times a factor, in place of its unknowns.
    pub fn restrict_right(&self, system: &System, x: &[f64], factor: f64, reduced: &mut [f64]) {
        for run in &system.node_runs {
            restrict_run(run, &self.numbers[RIGHT][run.all_numbers()], (x, &|x| x), factor, reduced);
        }
    }

    /// f = N_L reduced for every node.
    pub fn prolong_left(&self, system: &System, reduced: &[f64], f: &mut [f64]) {
        for run in &system.node_runs {
            if let NodeReduction::Fixed { .. } = run.reduction {
                f[run.all_dofs()].fill(0.0);
                continue;
            }
            let numbers = &self.numbers[LEFT][run.all_numbers()];
            prolong_run(run, numbers, reduced, |first, own| f[first..first + own.len()].copy_from_slice(own));
        }
    }

    /// Gives out N_R reduced of every node: `change(first, (d x, ..))` for coordinates that follow each other.
    // lists of three and four coordinates: without their lengths `change` takes twice as long
    #[inline(always)]
    pub fn prolong_right(&self, system: &System, reduced: &[f64], mut change: impl FnMut(usize, &[f64])) {
        for run in &system.node_runs {
            prolong_run(run, &self.numbers[RIGHT][run.all_numbers()], reduced, &mut change);
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
    reduction: NodeReduction,
    right: &'b [f64],
}

impl NodeNullSpaces<'_> {
    /// Movement of a coordinate along a column: an entry of N_R.
    pub fn direction(&self, dof: usize, column: usize) -> f64 {
        let unit = f64::from(u8::from(dof == column));
        match self.reduction {
            NodeReduction::Fixed { .. } => 0.0,
            NodeReduction::Free { .. } => unit,
            NodeReduction::RotationCoordinates { free, .. } if dof < free || column < free => unit,
            NodeReduction::RotationCoordinates { free, turning } => turning.value(dof - free, column - free, self.right),
        }
    }
}

/// Where the numbers of each node's bases stand.
pub(super) fn places_of_numbers(system: &System) -> Vec<Range<usize>> {
    system.node_runs.iter().flat_map(|run| run.nodes.clone().map(|node| run.numbers_of(node))).collect()
}
