//! Where a formula passes from one piece to another.

use super::formula::{Formula, ProgramKind};
use super::graph::Graph;
use super::operation::{Binary, Node, Operation, Unary};
use super::running::{Program, ProgramWork};
use crate::scalar::Curve;
use smallvec::smallvec;
use std::sync::Arc;

/// What tells on which side of a switch a formula is, from some results of the program of its switches.
#[derive(Clone, Debug, PartialEq)]
enum Side {
    /// The number itself: a comparison, or whole steps of a floor.
    Number,
    /// An angle, which leaps between -pi and pi.
    Angle,
    /// The piece of a table that jumps or bends at its knots.
    Piece(Arc<Curve>),
    /// Components of a vector whose length is taken: it passes through zero where its direction is reversed.
    Direction(usize),
}

/// The switches of a formula that depend on its state: comparisons that choose, whole numbers, angles, tables, lengths.
#[derive(Clone, Debug)]
pub struct Switches {
    sides: Vec<Side>,
    program: Arc<Program>,
    /// Results of the formula, and their rates along a change of all arguments.
    course: Arc<Program>,
}

/// How results change where a switch changes sides, the mildest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SwitchKind {
    /// The slope of a result jumps.
    Kink,
    /// A result jumps.
    Jump,
}

/// Change of an angle that is none of a motion whose steps resolve it \[rad\].
const LEAP: f64 = 3.0;
/// Cosine between two directions of a vector that has passed through zero or close to it.
const REVERSED: f64 = -0.9;
/// Change of results over neighbouring numbers, as a share of their size, that is a jump; and of their slopes.
const JUMP: f64 = 1e-7;
const KINK: f64 = 1e-6;
/// What counts of terms that cancel: times [`JUMP`] their round-off.
const ROUND_OFF: f64 = 1e-5;
/// Shares of a step within which a vector may pass zero.
const NEAR: [f64; 3] = [1e-9, 1e-6, 1e-3];

impl Formula {
    /// Its switches that depend on coordinates, their derivatives or multipliers, lengths of vectors among them if they are asked for; `None`
    /// where it has none.
    pub fn switches(&self, lengths: bool) -> Option<Switches> {
        let of_state = self.arguments().of_state();
        let (sides, nodes) = self.inspect(|graph, outputs| conditions(graph, outputs, &of_state, lengths));
        if sides.is_empty() {
            return None;
        }
        let program = self.dense_program((ProgramKind::Switches, smallvec![u32::from(lengths)]), 0, |_, _, _| nodes);
        let count = self.inputs;
        let course = self.dense_program((ProgramKind::Course, smallvec![]), count, |graph, x, outputs| {
            let seeds: Vec<(Node, Node)> = x[..count].iter().copied().zip(x[count..].iter().copied()).collect();
            let rates = graph.forward(outputs, &seeds);
            outputs.iter().copied().chain(rates).collect()
        });
        Some(Switches { sides, program, course })
    }
}

/// Sides of the switches that results depend on, and the numbers that tell them; of those alone that read an argument `of_state`.
fn conditions(graph: &Graph, outputs: &[Node], of_state: &[bool], lengths: bool) -> (Vec<Side>, Vec<Node>) {
    let (needed, mut moves) = (graph.needed(outputs), Vec::new());
    let (mut sides, mut nodes) = (Vec::new(), Vec::new());
    for (place, &operation) in graph.operations().iter().take(needed.len()).enumerate() {
        let is_of_state = |index: u32| of_state.get(index as usize).copied().unwrap_or(false);
        let mut any = matches!(operation, Operation::Input(index) if is_of_state(index));
        operation.for_each_operand(|operand| any |= moves[operand.0 as usize]);
        moves.push(any);
        if !any || !needed[place] {
            continue;
        }
        let node = Node(place as u32);
        match operation {
            Operation::Binary(Binary::Less, ..) | Operation::Unary(Unary::Floor, _) => {
                sides.push(Side::Number);
                nodes.push(node);
            }
            Operation::Binary(Binary::Atan2, ..) => {
                sides.push(Side::Angle);
                nodes.push(node);
            }
            Operation::Curve { curve, at, .. } if graph.curves()[curve as usize].has_kinks() => {
                let side = Side::Piece(Arc::clone(&graph.curves()[curve as usize]));
                if !sides.iter().zip(last_nodes(&sides, &nodes)).any(|(own, own_node)| *own == side && own_node == at) {
                    sides.push(side);
                    nodes.push(at);
                }
            }
            Operation::Unary(Unary::Sqrt, square) if lengths => add_length(graph, square, &mut sides, &mut nodes),
            Operation::Power(square, bits) if lengths && f64::from_bits(bits).fract() != 0.0 => {
                add_length(graph, square, &mut sides, &mut nodes);
            }
            _ => {}
        }
    }
    (sides, nodes)
}

/// The last number of each side.
fn last_nodes(sides: &[Side], nodes: &[Node]) -> Vec<Node> {
    let mut end = 0;
    let last = |side: &Side| {
        end += side.count();
        nodes[end - 1]
    };
    sides.iter().map(last).collect()
}

/// The vector whose squared length is taken the root of.
fn add_length(graph: &Graph, square: Node, sides: &mut Vec<Side>, nodes: &mut Vec<Node>) {
    let (mut open, mut components) = (vec![square], Vec::new());
    while let Some(node) = open.pop() {
        match graph.operation(node) {
            Operation::Binary(Binary::Add, x, y) => open.extend([x, y]),
            Operation::Binary(Binary::Mul, x, y) if x == y => components.push(x),
            _ => return,
        }
    }
    sides.push(Side::Direction(components.len()));
    nodes.extend(components);
}

impl Side {
    /// How many numbers tell it.
    fn count(&self) -> usize {
        if let Side::Direction(count) = self { *count } else { 1 }
    }

    /// Whether it is another one.
    fn changes(&self, before: &[f64], after: &[f64]) -> bool {
        match self {
            Side::Number => before[0] != after[0],
            Side::Angle => (after[0] - before[0]).abs() > LEAP,
            Side::Piece(curve) => curve.piece(before[0]) != curve.piece(after[0]),
            Side::Direction(_) => cosine(before, after) < REVERSED,
        }
    }
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

impl Switches {
    /// Numbers that tell the sides at some arguments.
    pub fn evaluate(&self, inputs: &[f64], numbers: &mut Vec<f64>, work: &mut ProgramWork<f64>) {
        numbers.resize(self.program.outputs(), 0.0);
        self.program.run(inputs, numbers, work);
    }

    /// Which arguments these numbers depend on.
    pub fn reads(&self) -> Vec<bool> {
        self.program.reads()
    }

    /// Whether any switch changes sides between two lists of such numbers.
    pub fn change(&self, before: &[f64], after: &[f64]) -> bool {
        self.changing(before, after).next().is_some()
    }

    fn changing<'s>(&'s self, before: &'s [f64], after: &'s [f64]) -> impl Iterator<Item = (&'s Side, usize)> {
        let mut first = 0;
        let places = self.sides.iter().map(move |side| {
            first += side.count();
            (side, first - side.count())
        });
        places.filter(|(side, first)| {
            let own = *first..first + side.count();
            side.changes(&before[own.clone()], &after[own])
        })
    }

    /// How the results change where switches change sides on the straight way between two lists of arguments: the worst; `None` if they go on
    /// smoothly, as where one series takes over from another.
    pub fn kind(&self, from: &[f64], to: &[f64]) -> Option<SwitchKind> {
        let mut work = ProgramWork::default();
        let (mut before, mut after) = (Vec::new(), Vec::new());
        self.evaluate(from, &mut before, &mut work);
        self.evaluate(to, &mut after, &mut work);
        let mut worst = None;
        for (side, first) in self.changing(&before, &after) {
            let own = first..first + side.count();
            let Some((low, high)) = self.place((from, to), (side, first), &before[own.clone()]) else { continue };
            let (change, at_low) = if let Side::Direction(_) = side {
                let middle = 0.5 * (low + high);
                let reversed = |near: &f64| {
                    let [a, b] = [middle - near, middle + near].map(|share| self.numbers_at((from, to), share));
                    side.changes(&a[own.clone()], &b[own.clone()])
                };
                let Some(near) = NEAR.into_iter().find(reversed) else { continue };
                let [mut short, long] =
                    [1.0, 2.0].map(|times| self.change_between((from, to), middle - times * near, middle + times * near));
                // what is smooth changes twice as much over twice the way
                for (short, long) in [(&mut short.value, long.value), (&mut short.slope, long.slope)] {
                    *short = if *short > 0.75 * long { *short } else { 0.0 };
                }
                (short, middle - near)
            } else {
                (self.change_between((from, to), low, high), low)
            };
            worst = worst.max(change.kind(worst, || self.terms(&at((from, to), at_low))));
            if worst == Some(SwitchKind::Jump) {
                break;
            }
        }
        worst
    }

    fn numbers_at(&self, way: (&[f64], &[f64]), share: f64) -> Vec<f64> {
        let (mut numbers, mut work) = (Vec::new(), ProgramWork::default());
        self.evaluate(&at(way, share), &mut numbers, &mut work);
        numbers
    }

    /// Neighbouring shares of the way between which a switch changes sides.
    fn place(&self, way: (&[f64], &[f64]), (side, first): (&Side, usize), before: &[f64]) -> Option<(f64, f64)> {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            if !(low < middle && middle < high) {
                break;
            }
            let own = &self.numbers_at(way, middle)[first..first + side.count()];
            let is_behind = match side {
                Side::Direction(_) => cosine(before, own) < 0.0,
                _ => side.changes(before, own),
            };
            if is_behind { high = middle } else { low = middle }
        }
        (high > low).then_some((low, high))
    }

    /// The largest change of a result by an argument of its own size: results that cancel have its round-off.
    fn terms(&self, inputs: &[f64]) -> f64 {
        let mut results = vec![0.0; self.course.outputs()];
        let mut terms = 0.0;
        for (place, &input) in inputs.iter().enumerate() {
            let direction = (0..inputs.len()).map(|own| if own == place { input } else { 0.0 });
            let all: Vec<f64> = inputs.iter().copied().chain(direction).collect();
            self.course.run(&all, &mut results, &mut ProgramWork::default());
            terms = f64::max(terms, largest(results[results.len() / 2..].iter().copied().filter(|rate| rate.is_finite())));
        }
        terms
    }

    /// Change and size of the results and of their slopes between two shares of the way.
    fn change_between(&self, way: (&[f64], &[f64]), low: f64, high: f64) -> Change {
        let direction = || way.0.iter().zip(way.1).map(|(from, to)| to - from);
        let [below, above] = [low, high].map(|share| {
            let inputs: Vec<f64> = at(way, share).into_iter().chain(direction()).collect();
            let mut results = vec![0.0; self.course.outputs()];
            self.course.run(&inputs, &mut results, &mut ProgramWork::default());
            results
        });
        let count = below.len() / 2;
        let change = |own: std::ops::Range<usize>| largest(own.map(|k| above[k] - below[k]));
        let size = |own: std::ops::Range<usize>| largest(own.flat_map(|k| [above[k], below[k]]));
        let (values, slopes) = (0..count, count..2 * count);
        Change {
            value: change(values.clone()),
            slope: change(slopes.clone()),
            value_size: size(values),
            slope_size: size(slopes),
        }
    }
}

/// Changes of results and of their slopes between two places, and sizes there.
struct Change {
    value: f64,
    slope: f64,
    value_size: f64,
    slope_size: f64,
}

impl Change {
    /// What it is, beside the terms of the results; next to a kink that is known only a jump is asked for. Where even without terms it is
    /// nothing, these are not asked for: they take a run for each argument.
    fn kind(&self, known: Option<SwitchKind>, terms: impl FnOnce() -> f64) -> Option<SwitchKind> {
        let kind = |values: f64| match () {
            () if self.value > JUMP * values => Some(SwitchKind::Jump),
            // slopes that are nothing beside their values are round-off
            () if self.slope > KINK * (self.slope_size + KINK * values) => Some(SwitchKind::Kink),
            () => None,
        };
        let values = self.value_size + self.slope_size;
        if kind(values) <= known { None } else { kind(values + ROUND_OFF * terms()) }
    }
}

fn at((from, to): (&[f64], &[f64]), share: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect()
}
