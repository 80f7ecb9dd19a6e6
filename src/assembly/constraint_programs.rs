//! Programs of constraints: reactions and equations, their matrix along reduced columns, and products with adjoint variables.
//!
//! All of them come from g(q, p, t) or h(v, q, p, t) alone: the reaction A^T mu is the gradient of mu . g with respect to q (of mu . h with
//! respect to v), and time derivatives follow along the motion.

use super::element_programs::gradient;
use super::gather_map::GatherMap;
use super::lanes::Lanes;
use super::reduction::{Columns, NodeReduction};
use super::{Equations, Level, VectorsAvq};
use crate::elements::{ConstraintPhysics, RunScalar, motion_derivatives, multipliers_behind};
use crate::program::{Graph, Node, Program};
use std::sync::Arc;

/// Which of a constraint's equations is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// g = 0.
    Value,
    /// dg/dt = 0, or h = 0.
    Rate,
    /// d2g/dt2 = 0, or dh/dt = 0.
    Second,
    /// None: the multiplier is zero.
    Multiplier,
}

/// Arguments of a constraint's programs: (v, q), parameters and time of the formula; then a, multipliers, and the scale of the equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConstraintLayout {
    /// Number of coordinates.
    pub n: usize,
    /// Number of parameters.
    pub parameters: usize,
    /// Number of equations.
    pub equations: usize,
}

impl ConstraintLayout {
    pub fn of(physics: &ConstraintPhysics) -> Self {
        let parameters = physics.parameter_count();
        ConstraintLayout { n: physics.dof_count(), parameters, equations: physics.equation_count() }
    }
    /// Place of the parameters, behind (v, q).
    pub fn p(&self) -> usize {
        2 * self.n
    }
    pub fn t(&self) -> usize {
        self.p() + self.parameters
    }
    pub fn a(&self) -> usize {
        self.t() + 1
    }
    pub fn mu(&self) -> usize {
        multipliers_behind(self.n, self.parameters)
    }
    pub fn scale(&self) -> usize {
        self.mu() + self.equations
    }
    /// Place of what a program adds.
    pub fn extra(&self) -> usize {
        self.scale() + 1
    }
}

impl GatherMap {
    /// Writes the arguments for constraints side by side.
    #[inline(always)]
    pub fn write_constraints<S: RunScalar>(
        &self,
        lanes: &mut Lanes<S>,
        (at, p, t): (&VectorsAvq<S>, &[S], S),
        mu: &[S],
        scale: f64,
    ) {
        lanes.gather_nodes(&self.nodes, [&at.v, &at.q]);
        lanes.gather(&self.parameters, p);
        lanes.spread(t);
        lanes.gather_nodes(&self.nodes, [&at.a]);
        lanes.gather(&self.multipliers, mu);
        lanes.spread(S::from(scale));
    }
}

/// What part of the constraints is taken at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConstraintPart {
    /// Equations and reactions, which are taken at the same point.
    Both,
    /// Equations alone.
    Equations,
    /// Reactions alone, with a factor.
    Reactions(f64),
}

impl ConstraintPart {
    /// The factor of reactions.
    pub(super) fn factor(self) -> f64 {
        match self {
            ConstraintPart::Reactions(factor) => factor,
            _ => 1.0,
        }
    }
}

/// What is asked of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Asked {
    /// Which of its equations, if any.
    pub equations: Option<Order>,
    /// A^T mu.
    pub reactions: bool,
    /// Whether friction follows mu.
    pub friction: bool,
}

impl Asked {
    /// Of a part of the constraint at a level, with the scale of the equations.
    pub fn of(part: ConstraintPart, equations: &Equations, physics: &ConstraintPhysics) -> (Self, f64) {
        Self::of_kind(part, equations, [physics.is_nonholonomic(), physics.has_friction()])
    }

    /// Of a part of a constraint inside a node.
    pub fn inside(part: ConstraintPart, equations: &Equations) -> (Self, f64) {
        Self::of_kind(part, equations, [false; 2])
    }

    fn of_kind(part: ConstraintPart, equations: &Equations, [nonholonomic, has_friction]: [bool; 2]) -> (Self, f64) {
        let (order, scale) = if nonholonomic {
            match equations.nonholonomic() {
                None => (Order::Multiplier, 1.0),
                Some((Level::Acceleration, scale)) => (Order::Second, scale),
                Some((_, scale)) => (Order::Rate, scale),
            }
        } else {
            let order = match equations.level {
                Level::Position => Order::Value,
                Level::Velocity => Order::Rate,
                Level::Acceleration => Order::Second,
            };
            (order, equations.row_scale())
        };
        let has_equations = !matches!(part, ConstraintPart::Reactions(_));
        let reactions = part != ConstraintPart::Equations;
        let friction = reactions && equations.friction && has_friction;
        (Asked { equations: has_equations.then_some(order), reactions, friction }, scale)
    }

    /// A number for what is asked, and which of (a, v, q) move.
    pub fn short_code(&self, moves: [bool; 3]) -> u32 {
        self.code().chain(moves.map(u32::from)).fold(0, |code, own| 16 * code + own)
    }

    pub fn code(&self) -> impl Iterator<Item = u32> {
        let reactions = u32::from(self.reactions) + u32::from(self.friction);
        [self.equations.map_or(9, |order| order as u32), reactions].into_iter()
    }
}

/// What a constraint's programs are made of.
pub(super) struct Parts {
    /// A^T mu; empty where no reactions are asked for.
    pub reactions: Vec<Node>,
    /// The equations, scaled; empty where they are not asked for.
    pub equations: Vec<Node>,
}

impl Parts {
    pub fn new(
        graph: &mut Graph,
        (inputs, outputs): (&[Node], &[Node]),
        layout: ConstraintLayout,
        (asked, physics): (Asked, &ConstraintPhysics),
    ) -> Self {
        let nonholonomic = physics.is_nonholonomic();
        let of = |first: usize, count: usize| &inputs[first..first + count];
        let n = layout.n;
        let (v, q, a) = (of(0, n), of(n, n), of(layout.a(), n));
        let mu = of(layout.mu(), layout.equations);
        let derivatives = motion_derivatives(graph, outputs, [a, v, q], inputs[layout.t()]);
        let mut scaled = |values: &[Node]| -> Vec<Node> {
            values.iter().map(|&value| graph.mul(value, inputs[layout.scale()])).collect()
        };
        let equations = match (asked.equations, nonholonomic) {
            (None, _) => Vec::new(),
            (Some(Order::Multiplier), _) => mu.to_vec(),
            (Some(Order::Value), _) | (Some(Order::Rate), true) => scaled(&derivatives[0]),
            (Some(Order::Rate), false) | (Some(Order::Second), true) => scaled(&derivatives[1]),
            (Some(Order::Second), false) => scaled(&derivatives[2]),
        };
        let towards = if nonholonomic { v } else { q };
        let mut reactions = if asked.reactions { graph.reverse(outputs, mu, towards) } else { Vec::new() };
        let friction = physics.formula().stages.iter().filter(|_| asked.friction).flat_map(|own| &own.forces);
        reactions.iter_mut().zip(friction).for_each(|(own, &friction)| *own = graph.add(*own, friction));
        Parts { reactions, equations }
    }
}

/// Reactions, then equations.
pub(super) fn values(physics: &ConstraintPhysics, asked: Asked) -> Arc<Program> {
    let layout = ConstraintLayout::of(physics);
    let extra = layout.extra() - layout.a();
    physics.formula().dense_program(("equations", asked.code().collect()), extra, |graph, inputs, outputs| {
        let Parts { reactions, equations } = Parts::new(graph, (inputs, outputs), layout, (asked, physics));
        [reactions, equations].concat()
    })
}

/// The matrix of a constraint: its columns are the reduced columns of its nodes, then its multipliers;
/// entries that are not zero, numbered by row + column times size. Behind the other arguments: gamma, beta, alpha, and the numbers of the
/// nodes' bases.
pub(super) fn matrix(physics: &ConstraintPhysics, asked: Asked, nodes: &[NodeReduction], moves: [bool; 3]) -> Arc<Program> {
    let layout = ConstraintLayout::of(physics);
    let code = nodes.iter().map(|node| node.code()).chain(asked.code()).chain(moves.map(u32::from));
    let own = Columns::count(nodes);
    let size = own + layout.equations;
    let extra = layout.extra() - layout.a() + 3 + Columns::numbers(nodes);
    physics.formula().sparse_program(("constraint matrix", code.collect()), extra, |graph, inputs, outputs| {
        let rates = &inputs[layout.extra()..];
        let columns_of = Columns::new(graph, nodes, &rates[3..]);
        let Parts { reactions, equations } = Parts::new(graph, (inputs, outputs), layout, (asked, physics));
        let zero = graph.zero();
        let mut block = vec![zero; size * size];
        let starts = [layout.a(), 0, layout.n];
        let one = graph.constant(1.0);
        let multipliers = (0..layout.equations).map(|place| vec![(inputs[layout.mu() + place], one)]);
        let columns = (0..own).map(|column| {
            columns_of.seeds(graph, column, [rates[0], rates[1], rates[2]], moves, |kind, dof| inputs[starts[kind] + dof])
        });
        let all: Vec<Vec<(Node, Node)>> = columns.collect::<Vec<_>>().into_iter().chain(multipliers).collect();
        for (seeds, target) in all.iter().zip(block.chunks_exact_mut(size)) {
            if asked.reactions {
                let moved = graph.forward(&reactions, seeds);
                columns_of.reduce(graph, &moved, target);
            }
            if !equations.is_empty() {
                target[own..].copy_from_slice(&graph.forward(&equations, seeds));
            }
        }
        block
    })
}

/// Gradients of lambda_F . A^T mu + lambda_G . G towards (a, v, q) and those parameters that are asked for, for one set of adjoint variables
/// after the other: numbered as the arguments before mu, and so many further for the next set. Behind the arguments: lambda_F and lambda_G,
/// each where it is asked for, of each set of adjoint variables.
pub(super) fn products(physics: &ConstraintPhysics, asked: Asked, parameters: &[bool], count: usize) -> Arc<Program> {
    let layout = ConstraintLayout::of(physics);
    let code = asked.code().chain(parameters.iter().map(|&asked| u32::from(asked))).chain([count as u32]);
    let extra = layout.extra() - layout.a() + count * weights(layout, asked);
    physics.formula().sparse_program(("constraint products", code.collect()), extra, |graph, inputs, outputs| {
        let Parts { reactions, equations } = Parts::new(graph, (inputs, outputs), layout, (asked, physics));
        let all = [reactions, equations].concat();
        let places = || {
            let asked_for = (layout.p()..layout.t()).filter(|place| parameters[place - layout.p()]);
            (0..layout.p()).chain(asked_for).chain(layout.a()..layout.mu())
        };
        let sets = inputs[layout.extra()..].chunks_exact(all.len().max(1)).take(count);
        sets.flat_map(|weights| gradient(graph, (&all, weights), inputs, (places(), layout.mu()))).collect()
    })
}

/// Number of adjoint variables of [`products`].
pub(super) fn weights(layout: ConstraintLayout, asked: Asked) -> usize {
    let equations = if asked.equations.is_some() { layout.equations } else { 0 };
    equations + if asked.reactions { layout.n } else { 0 }
}
