//! Reduced columns of nodes inside programs: constraints inside a node never reach the matrix.
//!
//! With N_L orthogonal to a node's reaction and N_R to its equations, a block gets N_L^T J N_R: J is differentiated along the columns of
//! N_R, and its rows are combined by N_L. Bases are arguments of the programs, as the few numbers that they are made of.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use crate::elements::NodeKind;
use crate::program::{Graph, Node};

/// How the coordinates of a node follow from its unknowns in the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum NodeReduction {
    /// It does not move.
    Fixed {
        /// Number of coordinates.
        dofs: usize,
    },
    /// Unknowns are the coordinates.
    Free {
        /// Number of coordinates.
        dofs: usize,
    },
    /// Some coordinates are unknowns; behind them rigidly turning ones have three.
    RotationCoordinates {
        /// Number of coordinates that are unknowns.
        free: usize,
        /// How the others turn.
        turning: RotationCoordinates,
    },
}

/// Coordinates at the end of a node that turn rigidly: the directions N(q) in which the constraints let them move are known, and change
/// smoothly with the pose. Rows of the constraints are linear in the coordinates, and A(q) N(q) = 0 for all q.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum RotationCoordinates {
    /// Four Euler parameters.
    Euler,
    /// Three axes.
    Axes,
}

impl RotationCoordinates {
    /// Those of a kind of node with a constraint inside.
    pub fn of(kind: NodeKind) -> Option<Self> {
        match kind {
            NodeKind::Body => Some(RotationCoordinates::Euler),
            NodeKind::Natural => Some(RotationCoordinates::Axes),
            NodeKind::Point | NodeKind::Slope | NodeKind::Coordinates(_) | NodeKind::States(_) => None,
        }
    }

    /// Number of coordinates.
    pub fn coordinates(self) -> usize {
        match self {
            RotationCoordinates::Euler => 4,
            RotationCoordinates::Axes => 9,
        }
    }

    /// The factor of coordinates with which [`RotationCoordinates::entry`] makes columns of unit length of them where they are a pose.
    pub fn scale(self, turning: &[f64]) -> f64 {
        let square = turning.iter().fold(0.0, |sum, x| sum + x * x);
        // of three axes of length 1 every turn moves two
        if self == RotationCoordinates::Euler { 1.0 / square.sqrt() } else { (1.5 / square).sqrt() }
    }

    /// What each coordinate moves by in turns about three axes, from as many scaled coordinates as there are.
    #[inline(always)]
    pub fn rows<const COORDINATES: usize>(self, scaled: &[f64; COORDINATES]) -> [[f64; 3]; COORDINATES] {
        let mut rows = [[0.0; 3]; COORDINATES];
        for coordinate in 0..COORDINATES {
            for axis in 0..3 {
                rows[coordinate][axis] = self.value(coordinate, axis, scaled);
            }
        }
        rows
    }

    /// What a coordinate moves by in a turn about one of three axes, from the scaled coordinates.
    #[inline(always)]
    pub fn value(self, coordinate: usize, axis: usize, scaled: &[f64]) -> f64 {
        match self.entry(coordinate, axis) {
            Some((place, true)) => -scaled[place],
            Some((place, false)) => scaled[place],
            None => 0.0,
        }
    }

    /// What a coordinate moves by in a turn about one of three axes: the place of one of the scaled coordinates, and whether it is negated.
    #[inline(always)]
    pub fn entry(self, coordinate: usize, axis: usize) -> Option<(usize, bool)> {
        match self {
            RotationCoordinates::Euler => {
                const ROWS: [[(usize, bool); 3]; 4] = [
                    [(1, true), (2, true), (3, true)],
                    [(0, false), (3, true), (2, false)],
                    [(3, false), (0, false), (1, true)],
                    [(2, true), (1, false), (0, false)],
                ];
                Some(ROWS[coordinate][axis])
            }
            RotationCoordinates::Axes => {
                let (first, own) = (3 * (coordinate / 3), coordinate % 3);
                if own == axis {
                    return None;
                }
                // the cross product of the unit vector of the axis and (x, y, z)
                let other = 3 - own - axis;
                Some((first + other, (own + 1) % 3 != axis))
            }
        }
    }
}

impl NodeReduction {
    /// Number of coordinates.
    pub fn dofs(self) -> usize {
        match self {
            NodeReduction::Fixed { dofs } | NodeReduction::Free { dofs } => dofs,
            NodeReduction::RotationCoordinates { free, turning } => free + turning.coordinates(),
        }
    }

    /// Number of unknowns.
    pub fn unknowns(self) -> usize {
        match self {
            NodeReduction::Fixed { .. } => 0,
            NodeReduction::Free { dofs } => dofs,
            NodeReduction::RotationCoordinates { free, .. } => free + 3,
        }
    }

    /// A number for each kind.
    pub fn code(self) -> u32 {
        let (kind, size) = match self {
            NodeReduction::Fixed { dofs } => (0, dofs),
            NodeReduction::Free { dofs } => (1, dofs),
            NodeReduction::RotationCoordinates { free, turning: RotationCoordinates::Euler } => (2, free),
            NodeReduction::RotationCoordinates { free, turning: RotationCoordinates::Axes } => (3, free),
        };
        (kind + 4 * size) as u32
    }

    /// How many numbers each of its bases is made of.
    pub fn numbers(self) -> usize {
        match self {
            NodeReduction::Fixed { .. } | NodeReduction::Free { .. } => 0,
            NodeReduction::RotationCoordinates { turning, .. } => turning.coordinates(),
        }
    }
}

/// The bases of a part's nodes as nodes of a recording.
pub(super) struct Columns<'n> {
    nodes: &'n [NodeReduction],
    /// For each node the rows of N_L, and those of N_R.
    left: Vec<Vec<Vec<Node>>>,
    right: Vec<Vec<Vec<Node>>>,
    /// First unknown of each node.
    first: Vec<usize>,
}

impl<'n> Columns<'n> {
    /// Number of unknowns of some nodes together.
    pub fn count(nodes: &[NodeReduction]) -> usize {
        nodes.iter().map(|node| node.unknowns()).sum()
    }

    /// Numbers of their bases.
    pub fn numbers(nodes: &[NodeReduction]) -> usize {
        nodes.iter().map(|node| 2 * node.numbers()).sum()
    }

    /// From the numbers of all bases, node after node.
    pub fn new(graph: &mut Graph, nodes: &'n [NodeReduction], mut numbers: &[Node]) -> Self {
        let (mut left, mut right, mut first, mut unknown) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for node in nodes {
            let (own_left, rest) = numbers.split_at(node.numbers());
            let (own_right, rest) = rest.split_at(node.numbers());
            numbers = rest;
            left.push(rows(graph, *node, own_left));
            right.push(rows(graph, *node, own_right));
            first.push(unknown);
            unknown += node.unknowns();
        }
        Columns { nodes, left, right, first }
    }

    /// How the inputs move along a column: (a, v, q) by (gamma, beta, alpha) times its movement, where these are not zero.
    pub fn seeds(
        &self,
        graph: &mut Graph,
        column: usize,
        rates: [Node; 3],
        moves: [bool; 3],
        input: impl Fn(usize, usize) -> Node,
    ) -> Vec<(Node, Node)> {
        let place = self.first.iter().rposition(|&first| first <= column).unwrap_or(0);
        // nodes without unknowns start where the next one does
        let own = column - self.first[place];
        let first_dof: usize = self.nodes[..place].iter().map(|node| node.dofs()).sum();
        let mut seeds = Vec::new();
        for dof in 0..self.nodes[place].dofs() {
            let x = self.right[place][dof][own];
            for kind in (0..3).filter(|&kind| moves[kind]) {
                if !graph.is_zero(x) {
                    let moved = graph.mul(x, rates[kind]);
                    seeds.push((input(kind, first_dof + dof), moved));
                }
            }
        }
        seeds
    }

    /// Adds a matrix along the coordinates, column after column, times the movement of the coordinates along a reduced column.
    pub fn combine(&self, graph: &mut Graph, columns: &[Vec<Node>], column: usize) -> Vec<Node> {
        let place = self.first.iter().rposition(|&first| first <= column).unwrap_or(0);
        let own = column - self.first[place];
        let first_dof: usize = self.nodes[..place].iter().map(|node| node.dofs()).sum();
        let mut sum = vec![graph.zero(); columns.len()];
        for dof in 0..self.nodes[place].dofs() {
            let moved = self.right[place][dof][own];
            if !graph.is_zero(moved) {
                for (sum, &entry) in sum.iter_mut().zip(&columns[first_dof + dof]) {
                    let term = graph.mul(entry, moved);
                    *sum = graph.add(*sum, term);
                }
            }
        }
        sum
    }

    /// Adds N_L^T times values of all coordinates to the rows of a column.
    pub fn reduce(&self, graph: &mut Graph, values: &[Node], rows: &mut [Node]) {
        let mut dof = 0;
        for ((node, left), &first) in self.nodes.iter().zip(&self.left).zip(&self.first) {
            let unknowns = node.unknowns();
            for row in 0..unknowns {
                let mut sum = rows[first + row];
                for (weights, &value) in left.iter().zip(&values[dof..]) {
                    let term = graph.mul(weights[row], value);
                    sum = graph.add(sum, term);
                }
                rows[first + row] = sum;
            }
            dof += node.dofs();
        }
    }
}

/// Rows of one basis.
fn rows(graph: &mut Graph, node: NodeReduction, numbers: &[Node]) -> Vec<Vec<Node>> {
    let (zero, one) = (graph.zero(), graph.constant(1.0));
    let mut rows = vec![vec![zero; node.unknowns()]; node.dofs()];
    let (free, turning) = match node {
        NodeReduction::Fixed { .. } => (0, None),
        NodeReduction::Free { dofs } => (dofs, None),
        NodeReduction::RotationCoordinates { free, turning } => (free, Some(turning)),
    };
    (0..free).for_each(|i| rows[i][i] = one);
    let Some(turning) = turning else { return rows };
    for coordinate in 0..turning.coordinates() {
        for axis in 0..3 {
            let Some((place, negated)) = turning.entry(coordinate, axis) else { continue };
            rows[free + coordinate][free + axis] = if negated { graph.neg(numbers[place]) } else { numbers[place] };
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::RotationCoordinates;

    #[test]
    fn turns_keep_the_length_of_euler_parameters_and_the_angles_between_axes() {
        let mut e = [0.3, -0.5, 0.7, 0.2];
        let scale = RotationCoordinates::Euler.scale(&e);
        e.iter_mut().for_each(|e| *e *= scale);
        let basis = RotationCoordinates::Euler.rows(&e);
        for axis in 0..3 {
            let product: f64 = (0..4).map(|i| e[i] * basis[i][axis]).sum();
            let length: f64 = (0..4).map(|i| basis[i][axis] * basis[i][axis]).sum();
            assert!(product.abs() < 1e-15 && (length - 1.0).abs() < 1e-15);
        }
        let mut axes = [0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0];
        let scale = RotationCoordinates::Axes.scale(&axes);
        axes.iter_mut().for_each(|x| *x *= scale);
        let basis = RotationCoordinates::Axes.rows(&axes);
        for turn in 0..3 {
            for (first, second) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
                let product = |a: usize, b: usize| -> f64 { (0..3).map(|i| axes[3 * a + i] * basis[3 * b + i][turn]).sum() };
                assert!((product(first, second) + product(second, first)).abs() < 1e-15, "{first} {second} {turn}");
            }
            let length: f64 = basis.iter().map(|row| row[turn] * row[turn]).sum();
            assert!((length - 1.0).abs() < 1e-15);
        }
    }
}
