//! Programs of elements: residual or impulse, its matrix along reduced columns, and products with adjoint variables.

use super::gather_map::GatherMap;
use super::lanes::Lanes;
use super::reduction::{Columns, NodeReduction};
use super::{Equations, VectorsAvq};
use crate::elements::{ElementPhysics, RunScalar};
use crate::program::{Formula, Graph, LinearForm, Node, Program, Stages};
use std::sync::Arc;

/// What an element adds to F.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Force {
    /// R(a, v, q, p, t).
    Residual,
    /// dR/da a of (a, v, q, p, t): M a, the metric of the projection of a start.
    Inertia,
    /// (de/dq)^T w, with the stresses w among the arguments: nothing for elements without strains.
    Stresses,
    /// w_P P + w_F F for a step of a variational integrator, with the weights among the arguments.
    Impulse([f64; 2]),
}

/// Arguments of an element's formulas: (a, v, q), parameters, time, and weights of an impulse or stresses; those of its programs follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementLayout {
    /// Number of coordinates.
    pub n: usize,
    /// Number of parameters.
    pub parameters: usize,
    /// Number of weights.
    weights: usize,
}

impl ElementLayout {
    pub fn new(physics: &ElementPhysics, force: Force) -> Self {
        let weights = match force {
            Force::Residual | Force::Inertia => 0,
            Force::Stresses => physics.stresses().map_or(0, |stresses| stresses.count),
            Force::Impulse(_) => 2,
        };
        ElementLayout { n: physics.dof_count(), parameters: physics.parameter_count(), weights }
    }
    /// Place of the parameters, behind (a, v, q).
    pub fn p(&self) -> usize {
        3 * self.n
    }
    pub fn t(&self) -> usize {
        self.p() + self.parameters
    }
    /// Place of the weights: two of an impulse, or stresses.
    pub fn weights(&self) -> usize {
        self.t() + 1
    }
    /// Place of what a program adds.
    pub fn extra(&self) -> usize {
        self.weights() + self.weights
    }
}

impl GatherMap {
    /// Writes the arguments of the formula for elements side by side; a momentum by the size of the step counts `pace` times.
    #[inline(always)]
    pub fn write_elements<S: RunScalar>(
        &self,
        lanes: &mut Lanes<S>,
        (at, p, t): (&VectorsAvq<S>, &[S], S),
        (force, pace): (Force, S),
    ) {
        lanes.gather_nodes(&self.nodes, [&at.a, &at.v, &at.q]);
        lanes.gather(&self.parameters, p);
        lanes.spread(t);
        if let Force::Impulse([momentum, force]) = force {
            lanes.spread(pace * momentum);
            lanes.spread(S::from(force));
        }
    }
}

impl Force {
    /// Number of kinds.
    pub(super) const KINDS: usize = 4;

    /// What elements add at the point of the unknowns.
    pub fn of(equations: &Equations) -> Self {
        match equations.variational {
            Some(step) => Force::Impulse(step.now()),
            None if equations.is_of_inertia() => Force::Inertia,
            None => Force::Residual,
        }
    }

    /// Number of its kind.
    pub(super) fn kind(self) -> usize {
        match self {
            Force::Residual => 0,
            Force::Inertia => 1,
            Force::Impulse(_) => 2,
            Force::Stresses => 3,
        }
    }

    /// The recorded formula; `None` where an element adds nothing.
    pub(super) fn formula(self, physics: &ElementPhysics) -> Option<&Arc<Formula>> {
        match self {
            Force::Residual => Some(physics.residual()),
            Force::Inertia => Some(physics.inertia()),
            Force::Stresses => physics.stresses().map(|stresses| stresses.force),
            Force::Impulse(_) => Some(physics.impulse()),
        }
    }
}

/// gamma dR/da + beta dR/dv + alpha dR/dq along the reduced columns of the nodes, reduced by the left bases: entries that are not zero,
/// numbered by row + column times size. Behind the formula's arguments: gamma, beta, alpha, and the numbers of the nodes' bases.
pub(super) fn matrix(formula: &Formula, layout: ElementLayout, nodes: &[NodeReduction], moves: [bool; 3]) -> Arc<Program> {
    let code = nodes.iter().map(|node| node.code()).chain(moves.map(u32::from));
    let columns = Columns::count(nodes);
    let extra = 3 + Columns::numbers(nodes);
    formula.sparse_program(("matrix", code.collect()), extra, |graph, inputs, outputs| {
        let rates = &inputs[layout.extra()..];
        let columns_of = Columns::new(graph, nodes, &rates[3..]);
        let zero = graph.zero();
        let mut block = vec![zero; columns * columns];
        let n = layout.n;
        if let Some(stages) = &formula.stages {
            let movements = Movements { n, rates: &rates[..3], moves };
            return in_stages(graph, (inputs, outputs, stages), nodes, &columns_of, movements);
        }
        let forms = graph.linear_forms(outputs, [0, n, 2 * n], n);
        let interpolated = forms.iter().any(|form| form.weights.len() > 1);
        let by_coordinates = interpolated.then(|| along_coordinates(graph, outputs, &forms, (n, &rates[..3], moves)));
        for column in 0..columns {
            let moved = match &by_coordinates {
                Some(by_coordinates) => columns_of.combine(graph, by_coordinates, column),
                None => {
                    let input = |kind: usize, dof: usize| inputs[kind * n + dof];
                    let seeds = columns_of.seeds(graph, column, [rates[0], rates[1], rates[2]], moves, input);
                    graph.forward(outputs, &seeds)
                }
            };
            columns_of.reduce(graph, &moved, &mut block[column * columns..][..columns]);
        }
        block
    })
}

/// How the coordinates of an element move with its unknowns.
struct Movements<'r> {
    /// Number of coordinates.
    n: usize,
    /// gamma, beta, alpha.
    rates: &'r [Node],
    /// Which of them are not zero.
    moves: [bool; 3],
}

/// The matrix of a residual R = (dy/dq)^T F(y) with a map y(q) of each node by itself: dF/dy once, then the maps of rows and columns, and
/// what F does along the turning of its own map.
fn in_stages(
    graph: &mut Graph,
    (inputs, outputs, stages): (&[Node], &[Node], &Stages<Node>),
    nodes: &[NodeReduction],
    columns_of: &Columns,
    Movements { n, rates, moves }: Movements,
) -> Vec<Node> {
    let (zero, one) = (graph.zero(), graph.constant(1.0));
    let (numbers, size) = (stages.numbers.concat(), Columns::count(nodes));
    let moving = |graph: &Graph, list: &[Node]| -> Vec<(Node, Node)> {
        list.iter().filter(|&&number| graph.constant_of(number).is_none()).map(|&number| (number, zero)).collect()
    };
    let (still, fixed) = (moving(graph, &numbers), moving(graph, &stages.forces));
    // N_L^T (dy/dq)^T: for each number the rows that its force enters, with weights
    let rows_of = |graph: &mut Graph, number: Node| -> Vec<(usize, Node)> {
        let gradient = graph.reverse(&[number], &[one], &inputs[2 * n..3 * n]);
        let mut rows = vec![zero; size];
        columns_of.reduce(graph, &gradient, &mut rows);
        rows.into_iter().enumerate().filter(|(_, weight)| !graph.is_zero(*weight)).collect()
    };
    let rows: Vec<_> = stages.numbers[2].iter().map(|&number| rows_of(graph, number)).collect();
    // dF towards each number that moves
    let mut along: Vec<Option<Vec<Node>>> = vec![None; numbers.len()];
    let mut block = vec![zero; size * size];
    // none where all nodes are clamped
    for (column, target) in block.chunks_exact_mut(size.max(1)).enumerate() {
        let input = |kind: usize, dof: usize| inputs[kind * n + dof];
        let seeds = columns_of.seeds(graph, column, [rates[0], rates[1], rates[2]], moves, input);
        // the maps turn while F stays
        let turning = graph.forward(outputs, &[&seeds[..], &fixed].concat());
        columns_of.reduce(graph, &turning, target);
        let mut force = vec![zero; stages.forces.len()];
        for (place, moved) in graph.forward(&numbers, &seeds).into_iter().enumerate() {
            if graph.is_zero(moved) {
                continue;
            }
            let by_number = along[place].get_or_insert_with(|| {
                let seeds = [&still[..], &[(numbers[place], one)]].concat();
                graph.forward(&stages.forces, &seeds)
            });
            for (force, &entry) in force.iter_mut().zip(&*by_number) {
                let term = graph.mul(entry, moved);
                *force = graph.add(*force, term);
            }
        }
        for (force, rows) in force.into_iter().zip(&rows) {
            for &(row, weight) in rows {
                let term = graph.mul(weight, force);
                target[row] = graph.add(target[row], term);
            }
        }
    }
    block
}

/// The matrix column by column, from derivatives along the interpolated numbers: of these a point has fewer than the element has
/// coordinates, and each touches that point alone.
fn along_coordinates(
    graph: &mut Graph,
    outputs: &[Node],
    forms: &[LinearForm],
    (n, rates, moves): (usize, &[Node], [bool; 3]),
) -> Vec<Vec<Node>> {
    let zero = graph.zero();
    let mut columns = vec![vec![zero; n]; n];
    for (index, form) in forms.iter().enumerate() {
        // the others stand still, also where they are made of this one
        let mut seeds = Vec::new();
        for (other, own) in forms.iter().enumerate() {
            for (kind, nodes) in own.nodes.iter().enumerate() {
                let rate = if other == index && moves[kind] { rates[kind] } else { zero };
                seeds.extend(nodes.iter().map(|&node| (node, rate)));
            }
        }
        let moved = graph.forward(outputs, &seeds);
        for &(dof, weight) in &form.weights {
            for (sum, &entry) in columns[dof].iter_mut().zip(&moved) {
                let term = graph.scaled(entry, weight);
                *sum = graph.add(*sum, term);
            }
        }
    }
    columns
}

/// Gradients of lambda . R towards (a, v, q) and those parameters that are asked for, for one lambda after the other: numbered as the arguments
/// of the formula before the time, and so many further for the next lambda. Behind the arguments: each lambda.
pub(super) fn products(formula: &Formula, layout: ElementLayout, asked: &[bool], count: usize) -> Arc<Program> {
    let code = asked.iter().map(|&asked| u32::from(asked)).chain([count as u32]).collect();
    formula.sparse_program(("products", code), count * layout.n, |graph, inputs, outputs| {
        let places = || (0..layout.p()).chain((layout.p()..layout.t()).filter(|place| asked[place - layout.p()]));
        let all = inputs[layout.extra()..].chunks_exact(layout.n.max(1)).take(count);
        all.flat_map(|lambda| gradient(graph, (outputs, lambda), inputs, (places(), layout.t()))).collect()
    })
}

/// The gradient of a weighted sum towards some of the first `size` inputs; zero towards the others.
pub(super) fn gradient(
    graph: &mut Graph,
    (outputs, weights): (&[Node], &[Node]),
    inputs: &[Node],
    (places, size): (impl Iterator<Item = usize>, usize),
) -> Vec<Node> {
    let places: Vec<usize> = places.collect();
    let towards: Vec<Node> = places.iter().map(|&place| inputs[place]).collect();
    let gradient = graph.reverse(outputs, weights, &towards);
    let mut all = vec![graph.zero(); size];
    places.iter().zip(gradient).for_each(|(&place, own)| all[place] = own);
    all
}
