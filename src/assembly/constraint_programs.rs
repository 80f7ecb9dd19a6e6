//! Programs of constraints: reactions and equations, their matrix along reduced columns, and products with adjoint variables.
//!
//! All of them come from g(q, p, t) or h(v, q, p, t) alone: the reaction A^T mu is the gradient of mu . g with respect to q (of mu . h with
//! respect to v), and time derivatives follow along the motion.

use super::element_programs::gradient;
use super::gather_map::GatherMap;
use super::lanes::Lanes;
use super::reduction::{Columns, NodeReduction};
use super::{Equations, Level, VectorsAvq};
use crate::elements::{ConstraintPhysics, RunScalar, motion_derivatives};
use crate::program::{Graph, Node, Program, ProgramKind};
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

/// Arguments of a constraint's programs: (v, q), parameters and time of the formula; then a, multipliers, those of rate corrections, and
/// the scales of both sets of equations.
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
        self.a() + self.n
    }
    pub fn eta(&self) -> usize {
        self.mu() + self.equations
    }
    pub fn scales(&self) -> usize {
        self.eta() + self.equations
    }
    /// Place of what a program adds.
    pub fn extra(&self) -> usize {
        self.scales() + 2
    }
    fn own(&self) -> usize {
        self.a()
    }
}

impl GatherMap {
    /// Writes the arguments for constraints side by side; those of rate corrections stay what they are where there are none.
    #[inline(always)]
    pub fn write_constraints<S: RunScalar>(
        &self,
        lanes: &mut Lanes<S>,
        (at, p, t): (&VectorsAvq<S>, &[S], S),
        ([mu, eta], stabilized): ([&[S]; 2], bool),
        scales: [f64; 2],
    ) {
        lanes.gather_nodes(&self.nodes, [&at.v, &at.q]);
        lanes.gather(&self.parameters, p);
        lanes.spread(t);
        lanes.gather_nodes(&self.nodes, [&at.a]);
        lanes.gather(&self.multipliers, mu);
        if stabilized {
            lanes.gather(&self.multipliers, eta);
        } else {
            lanes.skip(self.multipliers.length);
        }
        scales.into_iter().for_each(|scale| lanes.spread(S::from(scale)));
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

/// What is asked of a constraint: its two sets of equations, and whether reactions are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Asked {
    /// The one or two sets.
    pub equations: [Option<Order>; 2],
    /// A^T mu (and -A^T eta).
    pub reactions: bool,
}

impl Asked {
    /// At a level, with the scales of the two sets.
    pub fn at(equations: &Equations, nonholonomic: bool) -> (Self, [f64; 2]) {
        let scales = equations.row_scales();
        let second = equations.level == Level::Stabilized;
        if nonholonomic {
            let order = |second: bool| match equations.nonholonomic(second) {
                None => (Order::Multiplier, 1.0),
                Some((Level::Acceleration, scale)) => (Order::Second, scale),
                Some((_, scale)) => (Order::Rate, scale),
            };
            let ((first, scale), (other, other_scale)) = (order(false), order(true));
            let equations = [Some(first), second.then_some(other)];
            return (Asked { equations, reactions: true }, [scale, other_scale]);
        }
        let equations = match equations.level {
            Level::Position => [Some(Order::Value), None],
            Level::Velocity => [Some(Order::Rate), None],
            Level::Acceleration => [Some(Order::Second), None],
            Level::Stabilized => [Some(Order::Value), Some(Order::Rate)],
        };
        (Asked { equations, reactions: true }, scales)
    }

    /// The same of a part of the constraint.
    pub fn part(part: ConstraintPart, equations: &Equations, nonholonomic: bool) -> (Self, [f64; 2]) {
        let (mut asked, scales) = Self::at(equations, nonholonomic);
        match part {
            ConstraintPart::Both => {}
            ConstraintPart::Equations => asked.reactions = false,
            ConstraintPart::Reactions(_) => asked.equations = [None; 2],
        }
        (asked, scales)
    }

    /// Whether there are rate corrections.
    pub fn stabilized(&self) -> bool {
        self.equations[1].is_some()
    }

    /// A number for what is asked, and which of (a, v, q) move.
    pub fn short_code(&self, moves: [bool; 3]) -> u32 {
        self.code().chain(moves.map(u32::from)).fold(0, |code, own| 16 * code + own)
    }

    pub fn code(&self) -> impl Iterator<Item = u32> {
        let order = |order: Option<Order>| order.map_or(9, |order| order as u32);
        [order(self.equations[0]), order(self.equations[1]), u32::from(self.reactions)].into_iter()
    }
}

/// What a constraint's programs are made of.
pub(super) struct Parts {
    /// A^T mu, and -A^T eta with rate corrections; empty where no reactions are asked for.
    pub reactions: [Vec<Node>; 2],
    /// Both sets of equations, scaled.
    pub equations: [Vec<Node>; 2],
}

impl Parts {
    pub fn new(
        graph: &mut Graph,
        (inputs, outputs): (&[Node], &[Node]),
        layout: ConstraintLayout,
        (asked, nonholonomic): (Asked, bool),
    ) -> Self {
        let of = |first: usize, count: usize| &inputs[first..first + count];
        let (n, count) = (layout.n, layout.equations);
        let (v, q, a) = (of(0, n), of(n, n), of(layout.a(), n));
        let (mu, eta) = (of(layout.mu(), count), of(layout.eta(), count));
        let time = inputs[layout.t()];
        let derivatives = motion_derivatives(graph, outputs, [a, v, q], time);
        let sets = [(mu, 0), (eta, 1)].map(|(multipliers, set)| {
            let Some(order) = asked.equations[set] else { return Vec::new() };
            let values = match (order, nonholonomic) {
                (Order::Multiplier, _) => return multipliers.to_vec(),
                (Order::Value, _) | (Order::Rate, true) => &derivatives[0],
                (Order::Rate, false) | (Order::Second, true) => &derivatives[1],
                (Order::Second, false) => &derivatives[2],
            };
            let scale = inputs[layout.scales() + set];
            values.iter().map(|&value| graph.mul(value, scale)).collect()
        });
        let towards = if nonholonomic { v } else { q };
        let mut reactions = [Vec::new(), Vec::new()];
        if asked.reactions {
            reactions[0] = graph.reverse(outputs, mu, towards);
            if asked.stabilized() {
                let against: Vec<Node> = eta.iter().map(|&eta| graph.neg(eta)).collect();
                reactions[1] = graph.reverse(outputs, &against, towards);
            }
        }
        Parts { reactions, equations: sets }
    }
}

/// Reactions of both sets, then both sets of equations.
pub(super) fn values(physics: &ConstraintPhysics, asked: Asked) -> Arc<Program> {
    let (layout, nonholonomic) = (ConstraintLayout::of(physics), physics.is_nonholonomic());
    let extra = layout.extra() - layout.own();
    physics.formula().dense_program((ProgramKind::Equations, asked.code().collect()), extra, |graph, inputs, outputs| {
        let Parts { reactions, equations } = Parts::new(graph, (inputs, outputs), layout, (asked, nonholonomic));
        reactions.into_iter().chain(equations).flatten().collect()
    })
}

/// The matrix of a constraint: its columns are the reduced columns of its nodes, then its multipliers, then those of rate corrections;
/// entries that are not zero, numbered by row + column times size. Behind the other arguments: gamma, beta, alpha, and the numbers of the
/// nodes' bases.
pub(super) fn matrix(physics: &ConstraintPhysics, asked: Asked, nodes: &[NodeReduction], moves: [bool; 3]) -> Arc<Program> {
    let (layout, nonholonomic) = (ConstraintLayout::of(physics), physics.is_nonholonomic());
    let stabilized = asked.stabilized();
    let code = nodes.iter().map(|node| node.code()).chain(asked.code()).chain(moves.map(u32::from));
    let (own, sets) = (Columns::count(nodes, stabilized), if stabilized { 2 } else { 1 });
    let size = own + sets * layout.equations;
    let extra = layout.extra() - layout.own() + 3 + Columns::numbers(nodes, stabilized);
    physics.formula().sparse_program((ProgramKind::ConstraintMatrix, code.collect()), extra, |graph, inputs, outputs| {
        let rates = &inputs[layout.extra()..];
        let columns_of = Columns::new(graph, nodes, stabilized, &rates[3..]);
        let Parts { reactions, equations } = Parts::new(graph, (inputs, outputs), layout, (asked, nonholonomic));
        let zero = graph.zero();
        let mut block = vec![zero; size * size];
        let starts = [layout.a(), 0, layout.n];
        let one = graph.constant(1.0);
        let multipliers = (0..sets * layout.equations).map(|place| vec![(inputs[layout.mu() + place], one)]);
        let columns = (0..own).map(|column| {
            columns_of.seeds(graph, column, [rates[0], rates[1], rates[2]], moves, |kind, dof| inputs[starts[kind] + dof])
        });
        let all: Vec<Vec<(Node, Node)>> = columns.collect::<Vec<_>>().into_iter().chain(multipliers).collect();
        for (seeds, target) in all.iter().zip(block.chunks_exact_mut(size)) {
            for (set, reaction) in reactions.iter().enumerate().filter(|(_, reaction)| !reaction.is_empty()) {
                let moved = graph.forward(reaction, seeds);
                columns_of.reduce(graph, &moved, set == 1, target);
            }
            for (set, rows) in equations.iter().enumerate().filter(|(_, rows)| !rows.is_empty()) {
                let moved = graph.forward(rows, seeds);
                target[own + set * layout.equations..][..rows.len()].copy_from_slice(&moved);
            }
        }
        block
    })
}

/// Gradients of lambda_F . A^T mu - lambda_Y . A^T eta + lambda_G . G towards (a, v, q) and those parameters that are asked for, for one set of
/// adjoint variables after the other: numbered as the arguments before mu, and so many further for the next set. Behind the arguments:
/// lambda_F, lambda_Y and lambda_G of both sets of equations, each where it is asked for, of each set of adjoint variables.
pub(super) fn products(physics: &ConstraintPhysics, asked: Asked, parameters: &[bool], count: usize) -> Arc<Program> {
    let (layout, nonholonomic) = (ConstraintLayout::of(physics), physics.is_nonholonomic());
    let code = asked.code().chain(parameters.iter().map(|&asked| u32::from(asked))).chain([count as u32]);
    let extra = layout.extra() - layout.own() + count * weights(layout, asked);
    physics.formula().sparse_program((ProgramKind::ConstraintProducts, code.collect()), extra, |graph, inputs, outputs| {
        let Parts { reactions, equations } = Parts::new(graph, (inputs, outputs), layout, (asked, nonholonomic));
        let all: Vec<Node> = reactions.into_iter().chain(equations).flatten().collect();
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
    let sets = if asked.stabilized() { 2 } else { 1 };
    let equations = asked.equations.iter().flatten().count() * layout.equations;
    equations + if asked.reactions { sets * layout.n } else { 0 }
}
