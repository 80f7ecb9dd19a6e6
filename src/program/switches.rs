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
    /// Whether the first of two numbers is less than the second.
    Order,
    /// The largest whole number up to one.
    Whole,
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
/// Evaluations of numbers by which the place of a switch is looked for where these tell how far it is, and then by halves alone.
const BY_NUMBERS: usize = 24;
const BY_HALVES: usize = 60;
/// Width of a place, as a share of a step, at which what is smooth does not look like a jump: see [`JUMP`].
const ROUGHLY: f64 = 1e-9;
/// Share of a step within which round-off of the numbers hides their zero, at first.
const HIDDEN: f64 = 4.0 * f64::EPSILON;

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
            Operation::Binary(Binary::Less, x, y) => {
                sides.push(Side::Order);
                nodes.extend([x, y]);
            }
            Operation::Unary(Unary::Floor, x) => {
                sides.push(Side::Whole);
                nodes.push(x);
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
        match self {
            Side::Direction(count) => *count,
            Side::Order => 2,
            Side::Whole | Side::Angle | Side::Piece(_) => 1,
        }
    }

    /// Whether it is another one.
    fn changes(&self, before: &[f64], after: &[f64]) -> bool {
        match self {
            Side::Order => (before[0] < before[1]) != (after[0] < after[1]),
            Side::Whole => before[0].floor() != after[0].floor(),
            Side::Angle => (after[0] - before[0]).abs() > LEAP,
            Side::Piece(curve) => curve.piece(before[0]) != curve.piece(after[0]),
            Side::Direction(_) => cosine(before, after) < REVERSED,
        }
    }

    /// Whether numbers on the way are on another side than those at its start: of a vector, which turns over close to zero, beyond a right angle.
    fn has_changed(&self, before: &[f64], own: &[f64]) -> bool {
        match self {
            Side::Direction(_) => cosine(before, own) < 0.0,
            _ => self.changes(before, own),
        }
    }

    /// How far numbers are beyond the end of the side of those at the start of the way, below zero where they are not, on a way that leads to the
    /// numbers `after`; `None` where no number passes zero there.
    fn excess(&self, before: &[f64], own: &[f64], after: &[f64]) -> Option<f64> {
        let is_up = after[0] > before[0];
        let beyond = |end: f64| if is_up { own[0] - end } else { end - own[0] };
        match self {
            Side::Order if before[0] < before[1] => Some(own[0] - own[1]),
            Side::Order => Some(own[1] - own[0]),
            Side::Whole => Some(beyond(before[0].floor() + f64::from(u8::from(is_up)))),
            Side::Piece(curve) => {
                let piece = curve.piece(before[0]);
                let knot = if is_up { Some(piece) } else { piece.checked_sub(1) };
                knot.and_then(|knot| curve.knots().get(knot)).map(|&knot| beyond(knot))
            }
            Side::Direction(_) => Some(-cosine(before, own)),
            Side::Angle => None,
        }
    }
}

/// A straight way between two lists of arguments of a formula, and the numbers that tell its sides somewhere on it.
struct Way<'w> {
    switches: &'w Switches,
    from: &'w [f64],
    to: &'w [f64],
    inputs: Vec<f64>,
    numbers: Vec<f64>,
    work: ProgramWork<f64>,
}

impl Way<'_> {
    /// At a share of it.
    fn numbers_at(&mut self, share: f64) -> &[f64] {
        self.inputs.clear();
        self.inputs.extend(at(self.from, self.to, share));
        self.switches.evaluate(&self.inputs, &mut self.numbers, &mut self.work);
        &self.numbers
    }

    /// Shares of the way between which a switch changes sides, whose numbers stand from `first` on: no further apart than a width, or neighbours.
    ///
    /// Where numbers tell how far the switch is, the next share is that of the straight line through both ends, moved towards the middle so that it
    /// falls to either side; round-off hides the last digits of where that is, so that it is moved further each time it falls short.
    ///
    /// Source: Oliveira & Takahashi, ACM Trans. Math. Softw. 47 (2020), "An enhancement of the bisection method average performance preserving
    /// minmax optimality".
    fn place(&mut self, side: &Side, first: usize, [before, after]: [&[f64]; 2], most: f64) -> Option<(f64, f64)> {
        let own = first..first + side.count();
        let (mut ends, mut hidden) = ([0.0, 1.0], HIDDEN);
        let mut excess = [before, after].map(|numbers| side.excess(before, numbers, after));
        for evaluation in 0..BY_NUMBERS + BY_HALVES {
            let [low, high] = ends;
            let (width, middle) = (high - low, 0.5 * (low + high));
            if width <= most || !(low < middle && middle < high) {
                break;
            }
            let by_line = match excess {
                [Some(before), Some(behind)]
                    if evaluation < BY_NUMBERS && before <= 0.0 && behind >= 0.0 && before < behind =>
                {
                    let found = low - width * before / (behind - before);
                    let aside = (0.2 * width * width).max(hidden);
                    (aside < (middle - found).abs()).then(|| (found + aside.copysign(middle - found), found < middle))
                }
                _ => None,
            };
            let share = by_line.map_or(middle, |(share, _)| share);
            let numbers = &self.numbers_at(share)[own.clone()];
            let end = usize::from(side.has_changed(before, numbers));
            hidden = if by_line.is_some_and(|(_, is_low)| is_low == (end == 0)) { 8.0 * hidden } else { HIDDEN };
            excess[end] = side.excess(before, numbers, after);
            ends[end] = share;
        }
        (ends[1] > ends[0]).then_some((ends[0], ends[1]))
    }

    /// How the results change where a switch changes sides between two shares of the way, if that is worse than what is known.
    fn kind_at(
        &mut self,
        side: &Side,
        first: usize,
        (low, high): (f64, f64),
        known: Option<SwitchKind>,
    ) -> Option<SwitchKind> {
        let Way { switches, from, to, .. } = *self;
        let (change, at_low) = if let Side::Direction(count) = *side {
            let middle = 0.5 * (low + high);
            let reversed = |near: &f64| {
                let [a, b] =
                    [middle - near, middle + near].map(|share| self.numbers_at(share)[first..first + count].to_vec());
                side.changes(&a, &b)
            };
            let near = NEAR.into_iter().find(reversed)?;
            let [mut short, long] =
                [1.0, 2.0].map(|times| switches.change_between((from, to), middle - times * near, middle + times * near));
            // what is smooth changes twice as much over twice the way
            for (short, long) in [(&mut short.value, long.value), (&mut short.slope, long.slope)] {
                *short = if *short > 0.75 * long { *short } else { 0.0 };
            }
            (short, middle - near)
        } else {
            (switches.change_between((from, to), low, high), low)
        };
        change.kind(known, || switches.terms(&at(from, to, at_low).collect::<Vec<_>>()))
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

    /// How the results change where switches change sides on the straight way between two lists of arguments: the worst, if it is worse than what
    /// is known; `None` where they go on smoothly, as where one series takes over from another.
    pub fn kind(&self, from: &[f64], to: &[f64], known: Option<SwitchKind>) -> Option<SwitchKind> {
        let mut work = ProgramWork::default();
        let [before, after] = [from, to].map(|inputs| {
            let mut numbers = Vec::new();
            self.evaluate(inputs, &mut numbers, &mut work);
            numbers
        });
        let mut way = Way { switches: self, from, to, inputs: Vec::new(), numbers: Vec::new(), work };
        let mut worst = known;
        for (side, first) in self.changing(&before, &after) {
            let own = first..first + side.count();
            // next to a kink only jumps count, which show from further away, too
            let widths: &[f64] = if worst.is_some() { &[ROUGHLY, 0.0] } else { &[0.0] };
            let mut kind = None;
            for &width in widths {
                let place = way.place(side, first, [&before[own.clone()], &after[own.clone()]], width);
                kind = place.and_then(|place| way.kind_at(side, first, place, worst));
                if kind.is_none() {
                    break;
                }
            }
            worst = worst.max(kind);
            if worst == Some(SwitchKind::Jump) {
                break;
            }
        }
        worst.filter(|_| worst > known)
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
            let inputs: Vec<f64> = at(way.0, way.1, share).chain(direction()).collect();
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

fn at(from: &[f64], to: &[f64], share: f64) -> impl Iterator<Item = f64> {
    from.iter().zip(to).map(move |(from, to)| from + share * (to - from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::{ArgumentKind, Recorded};
    use crate::scalar::{Interpolant, Scalar};

    /// A law of x by its name, the place of a switch of it on the way from 0 to 1, and what that does.
    type Law = (&'static str, fn(Recorded) -> Recorded, f64, Option<SwitchKind>);

    fn laws() -> [Law; 8] {
        fn bent(x: Recorded) -> Recorded {
            x.on_curve(&Curve::new(&[-1.0, 0.375, 2.0], &[0.0, 2.0, 1.0], Interpolant::Lines).expect("knots"), 0)
        }
        [
            ("larger", |x| (x * x).max(Recorded::from(0.0625)), 0.25, Some(SwitchKind::Kink)),
            ("next to round-off", |x| (x + 1e9).max(x * 2.0 + (1e9 - 0.125)), 0.125, Some(SwitchKind::Kink)),
            ("jump", |x| x.exp().less(Recorded::from(1.5)).select(x, x + 0.5), 1.5f64.ln(), Some(SwitchKind::Jump)),
            ("smooth", |x| x.less(Recorded::from(0.1)).select(x * x, x * x * x / x), 0.1, None),
            ("curvature", |x| (x - 0.7).max(Recorded::from(0.0)).powi(2) + 1.0, 0.7, None),
            ("whole", |x| (x * 1.9).floor(), 1.0 / 1.9, Some(SwitchKind::Jump)),
            ("whole, downwards", |x| (x * -0.9 + 0.5).floor(), 0.5 / 0.9, Some(SwitchKind::Jump)),
            ("table", bent, 0.375, Some(SwitchKind::Kink)),
        ]
    }

    #[test]
    fn switches_are_placed_between_neighbours() {
        for (name, law, expected, kind) in laws() {
            let formula = Formula::record([(ArgumentKind::Coordinate, 1)], |x| vec![law(x[0])]).expect("does not branch");
            let switches = formula.switches(true).unwrap_or_else(|| panic!("{name} has a switch"));
            let mut work = ProgramWork::default();
            let [before, after] = [0.0, 1.0].map(|x| {
                let mut numbers = Vec::new();
                switches.evaluate(&[x], &mut numbers, &mut work);
                numbers
            });
            let mut way = Way { switches: &switches, from: &[0.0], to: &[1.0], inputs: vec![], numbers: vec![], work };
            let [(side, 0)] = switches.changing(&before, &after).collect::<Vec<_>>()[..] else { panic!("{name}: one side") };
            let (low, high) = way.place(side, 0, [&before, &after], 0.0).expect("a place");
            assert!(low < high && [low, high].contains(&(0.5 * (low + high))), "{name}: {low:e} {high:e}");
            let sides = [low, high].map(|share| side.has_changed(&before, way.numbers_at(share)));
            assert_eq!(sides, [false, true], "{name}");
            let round_off = if name == "next to round-off" { 1e-6 } else { 1e-14 };
            assert!((low - expected).abs() < round_off, "{name}: {low} for {expected}");
            assert_eq!(switches.kind(&[0.0], &[1.0], None), kind, "{name}");
            // beside a kink only a jump counts
            let worse = kind.filter(|kind| *kind == SwitchKind::Jump);
            assert_eq!(switches.kind(&[0.0], &[1.0], Some(SwitchKind::Kink)), worse, "{name}");
        }
    }
}
