//! Nodes of a kind that follow each other: what is done with each is done with all in one pass.

use super::numbering::{MultiplierRun, System};
use super::reduction::NodeReduction;
use crate::elements::{NodeKind, RunScalar};
use std::ops::Range;

/// Nodes that follow each other and whose coordinates follow from their unknowns in the same way: everything that they have stands at equal
/// distances.
pub(super) struct NodeRun {
    /// Numbers of the nodes.
    pub nodes: Range<usize>,
    /// Their kind.
    pub kind: NodeKind,
    /// The way.
    pub reduction: NodeReduction,
    /// First coordinate of the first node.
    pub first_dof: usize,
    /// Its first unknown, and the number of unknowns of each node.
    pub first_column: usize,
    pub columns: usize,
    /// Where the numbers of its bases begin, and how many each node has: as many of N_L as of N_R.
    pub first_number: usize,
    pub numbers: usize,
}

impl NodeRun {
    /// All nodes of a system.
    pub fn all(system: &System) -> Vec<NodeRun> {
        let mut runs: Vec<NodeRun> = Vec::new();
        for (node, unknowns) in system.nodes.iter().enumerate() {
            let (reduction, own) = (system.reduction(node), &system.model.nodes[node]);
            if let Some(last) = runs.last_mut()
                && last.reduction == reduction
                && last.takes(system, node)
            {
                last.nodes.end = node + 1;
                continue;
            }
            let first_number = runs.last().map_or(0, |run| run.all_numbers().end);
            runs.push(NodeRun {
                nodes: node..node + 1,
                kind: own.kind,
                reduction,
                first_dof: own.dofs.start,
                first_column: unknowns.columns.start,
                columns: unknowns.columns.len(),
                first_number,
                numbers: reduction.numbers(),
            });
        }
        runs
    }

    /// Whether a node that follows has the places that this run would give it.
    fn takes(&self, system: &System, node: usize) -> bool {
        let (unknowns, own) = (&system.nodes[node], &system.model.nodes[node]);
        own.kind == self.kind
            && own.dofs == self.dofs(node)
            && (unknowns.columns.is_empty() || unknowns.columns == self.columns_of(node))
    }

    /// First coordinate of each node.
    pub fn starts(&self) -> impl Iterator<Item = usize> {
        (self.first_dof..).step_by(self.reduction.dofs().max(1)).take(self.nodes.len())
    }

    pub fn dofs(&self, node: usize) -> Range<usize> {
        let (count, place) = (self.reduction.dofs(), node - self.nodes.start);
        self.first_dof + place * count..self.first_dof + (place + 1) * count
    }

    pub fn columns_of(&self, node: usize) -> Range<usize> {
        let first = self.first_column + (node - self.nodes.start) * self.columns;
        first..first + self.columns
    }

    /// Where the numbers of a node's bases stand.
    pub fn numbers_of(&self, node: usize) -> Range<usize> {
        let first = self.first_number + (node - self.nodes.start) * self.numbers;
        first..first + self.numbers
    }

    /// The same of all its nodes.
    pub fn all_numbers(&self) -> Range<usize> {
        self.first_number..self.numbers_of(self.nodes.end).start
    }

    /// Coordinates of all its nodes.
    pub fn all_dofs(&self) -> Range<usize> {
        self.first_dof..self.dofs(self.nodes.end).start
    }

    /// Unknowns of all its nodes.
    pub fn all_columns(&self) -> Range<usize> {
        self.first_column..self.columns_of(self.nodes.end).start
    }
}

impl System<'_> {
    /// Largest coordinate of a point among those of nodes.
    pub(crate) fn largest_length<S: RunScalar>(&self, q: &[S]) -> f64 {
        let of_points = self.node_runs.iter().filter(|run| run.kind.in_space().is_some());
        let places = of_points.flat_map(|run| run.starts()).flat_map(|start| start..start + 3);
        places.fold(0.0, |largest: f64, place| largest.max(q[place].value().abs()))
    }

    /// Writes the scale of coordinates that turn, behind the lengths of each node, to a list of all coordinates.
    pub(crate) fn set_turning_scales(&self, scale: f64, scales: &mut [f64]) {
        let turning = |run: &&NodeRun| matches!(run.kind, NodeKind::Body | NodeKind::Natural | NodeKind::Slope);
        for run in self.node_runs.iter().filter(turning) {
            for start in run.starts() {
                scales[start + 3..start + run.reduction.dofs()].fill(scale);
            }
        }
    }

    /// Multipliers of constraints that follow each other in the matrix, and where.
    pub(crate) fn multipliers_with_places<'v, S>(&self, mu: &'v [S]) -> impl Iterator<Item = (&'v [S], Range<usize>)> {
        self.multiplier_runs.iter().map(move |run| (&mu[run.equations.clone()], run.unknowns()))
    }

    /// The places alone.
    pub(crate) fn places_of_multipliers(&self) -> impl Iterator<Item = Range<usize>> {
        self.multiplier_runs.iter().map(MultiplierRun::unknowns)
    }
}
