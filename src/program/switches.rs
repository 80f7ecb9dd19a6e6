//! Where a formula passes from one piece to another.

use super::arguments::ArgumentKind;
use super::formula::{Codes, Formula};
use super::graph::Graph;
use super::operation::{Binary, Node, Operation, Unary};
use super::running::{Program, ProgramWork};
use crate::scalar::{Curve, Scalar};
use smallvec::{SmallVec, smallvec};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// What tells on which side of a switch a formula is, from some results of the program of its switches.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Side {
    /// Whether the first of two numbers is less than the second.
    Order,
    /// Whether a number is below zero, through which a divisor or what a root is taken of may pass.
    Sign,
    /// The largest whole number up to one.
    Whole,
    /// Between which two zeros of its cosine, or of its sine, an angle is: poles of a tangent, turning points.
    HalfTurn { of_cosine: bool },
    /// The angle of a point with the coordinates (y, x), which leaps from pi to -pi where y changes its sign and x is negative.
    Angle,
    /// The piece of a table that jumps or bends at its knots.
    Piece(Arc<Curve>),
    /// Components of a vector whose length is taken: it passes through zero where its direction is reversed.
    Direction(usize),
}

/// Which switches of a formula are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reads {
    /// Those that read coordinates, their derivatives or multipliers: when they change sides a motion tells.
    Motion,
    /// Those of them whose sides are arguments, in the order of these: steps end where one changes.
    Located,
    /// The others of them.
    NotLocated,
    /// Those that read the time and none of these: when they change sides is known before the motion.
    TimeAlone,
}

/// Switches of a formula: comparisons that choose, whole numbers, angles, tables, lengths, poles.
#[derive(Clone, Debug)]
pub struct Switches {
    sides: Vec<Side>,
    program: Arc<Program>,
    /// Rates of the numbers along a change of all arguments.
    rates: Arc<Program>,
    /// Results of the formula, and their rates along a change of all arguments.
    course: Arc<Program>,
}

/// Room for what [`Switches::passed_over`] computes at every step.
#[derive(Default)]
pub struct PassBuffers {
    inputs: Vec<f64>,
    rates: [Vec<f64>; 2],
    work: ProgramWork<f64>,
}

/// How results change where a switch changes sides, the mildest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SwitchKind {
    /// The slope of a result jumps.
    Kink,
    /// A result jumps.
    Jump,
}

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
/// Parts of a run at whose ends the sizes of functions of time are looked at.
const TIMES: u32 = 16;
/// Share of a step within which round-off of the numbers hides their zero, at first.
const HIDDEN: f64 = 4.0 * f64::EPSILON;

impl Formula {
    /// Its switches of some kind, lengths of vectors among them if they are asked for; `None` where it has none.
    pub fn switches(&self, reads: Reads, lengths: bool) -> Option<Switches> {
        let (of_state, of_time) = (self.arguments().of_state(), self.arguments().of_time());
        let any = vec![true; self.inputs];
        let [moved_by, excluded] = match reads {
            Reads::TimeAlone => [&of_time[..], &of_state],
            // the condition of an event may be one of the time
            Reads::Located => [&any[..], &[]],
            _ => [&of_state[..], &[]],
        };
        let of_sides = self.arguments().of_kinds(&[ArgumentKind::Side]);
        let (sides, nodes) = self.inspect(|graph, outputs| {
            let mut own =
                Conditions { graph, located: located(graph, outputs, &of_sides), sides: Vec::new(), nodes: Vec::new() };
            own.find(outputs, [moved_by, excluded], (reads, lengths));
            (own.sides, own.nodes)
        });
        if sides.is_empty() {
            return None;
        }
        let code = [u32::from(lengths), reads as u32];
        let count = self.inputs;
        let along = |graph: &mut Graph, x: &[Node], results: &[Node]| {
            let seeds: Vec<(Node, Node)> = x[..count].iter().copied().zip(x[count..].iter().copied()).collect();
            graph.forward(results, &seeds)
        };
        let rates =
            self.dense_program(("switch rates", Codes::from_slice(&code)), count, |graph, x, _| along(graph, x, &nodes));
        let program = self.dense_program(("switches", Codes::from_slice(&code)), 0, |_, _, _| nodes);
        let course = self.dense_program(("course", smallvec![]), count, |graph, x, outputs| {
            let rates = along(graph, x, outputs);
            outputs.iter().copied().chain(rates).collect()
        });
        Some(Switches { sides, program, rates, course })
    }
}

/// Sides of the switches that results depend on, and the numbers that tell them.
struct Conditions<'g> {
    graph: &'g Graph,
    /// Of operations: which argument is their side, if one is.
    located: Vec<Option<u32>>,
    sides: Vec<Side>,
    nodes: Vec<Node>,
}

impl<'g> Conditions<'g> {
    /// Finds those that read an argument of `moved_by` and none that is `excluded`.
    fn find(&mut self, outputs: &[Node], [moved_by, excluded]: [&[bool]; 2], (reads, lengths): (Reads, bool)) {
        let graph = self.graph;
        let needed = graph.needed(outputs);
        let operations = &graph.operations()[..needed.len()];
        let depends_on = |arguments: &[bool]| {
            let is_among = |input: u32| arguments.get(input as usize) == Some(&true);
            let is_one = |own: &Operation| matches!(*own, Operation::Input(input) if is_among(input));
            graph.depending_on(operations.iter().map(is_one).collect(), &needed)
        };
        let (moves, is_excluded) = (depends_on(moved_by), depends_on(excluded));
        let counts = |node: Node| moves[node.0 as usize] && !is_excluded[node.0 as usize];
        let is_meant = |place: usize| match reads {
            Reads::Located => self.located[place].is_some(),
            Reads::NotLocated => self.located[place].is_none(),
            _ => true,
        };
        let mut meant: Vec<usize> = (0..operations.len()).filter(|&place| needed[place] && is_meant(place)).collect();
        if reads == Reads::Located {
            // in the order of their sides
            meant.sort_by_key(|&place| self.located[place]);
            meant.dedup_by_key(|place| self.located[*place]);
        }
        let own = self;
        for place in meant {
            match operations[place] {
                Operation::Binary(Binary::Less, x, y) if counts(Node(place as u32)) => own.add(Side::Order, &[x, y]),
                Operation::Unary(Unary::Floor, x) if counts(x) => own.add(Side::Whole, &[x]),
                Operation::Unary(Unary::Tan, x) if counts(x) => {
                    own.add(Side::HalfTurn { of_cosine: true }, &[x]);
                }
                // asin(sin u) and acos(cos u) bend where the inner slope vanishes
                Operation::Unary(Unary::Asin | Unary::Acos, x) if counts(x) => match graph.operation(x) {
                    Operation::Unary(Unary::Sin, u) => own.add(Side::HalfTurn { of_cosine: true }, &[u]),
                    Operation::Unary(Unary::Cos, u) => own.add(Side::HalfTurn { of_cosine: false }, &[u]),
                    _ => {}
                },
                Operation::Binary(Binary::Atan2, y, x) if counts(Node(place as u32)) => own.add(Side::Angle, &[y, x]),
                Operation::Curve { curve, at, .. } if counts(at) => {
                    let curve = &graph.curves()[curve as usize];
                    if curve.has_kinks() || reads == Reads::TimeAlone && curve.has_breakpoints() {
                        own.add(Side::Piece(Arc::clone(curve)), &[at]);
                    }
                }
                Operation::Binary(Binary::Div, _, divisor) => own.add_zeros(divisor, &counts),
                Operation::Unary(Unary::Ln, x) => own.add_zeros(x, &counts),
                Operation::Unary(Unary::Sqrt, square) if lengths && counts(square) => own.add_length(square),
                Operation::Power(base, bits) if f64::from_bits(bits).fract() != 0.0 && counts(base) => {
                    if lengths {
                        own.add_length(base);
                    }
                    own.add_zeros(base, &counts);
                }
                _ => {}
            }
        }
    }

    /// Adds a side, unless it is there.
    fn add(&mut self, side: Side, numbers: &[Node]) {
        let mut first = 0;
        let is_there = self.sides.iter().any(|own| {
            first += own.count();
            *own == side && self.nodes[first - own.count()..first] == *numbers
        });
        if !is_there {
            self.sides.push(side);
            self.nodes.extend(numbers);
        }
    }

    /// Adds the factors of a product that may pass through zero.
    fn add_zeros(&mut self, product: Node, counts: &impl Fn(Node) -> bool) {
        let mut open = vec![product];
        while let Some(node) = open.pop() {
            if !counts(node) {
                continue;
            }
            match self.graph.operation(node) {
                Operation::Binary(Binary::Mul, x, y) if x == y => open.push(x),
                Operation::Binary(Binary::Mul | Binary::Div, x, y) => open.extend([x, y]),
                Operation::Unary(Unary::Neg | Unary::Sqrt, x) => open.push(x),
                Operation::Unary(Unary::Cos, x) => self.add(Side::HalfTurn { of_cosine: true }, &[x]),
                Operation::Unary(Unary::Sin, x) => self.add(Side::HalfTurn { of_cosine: false }, &[x]),
                _ if self.is_not_negative(node) => {}
                _ => self.add(Side::Sign, &[node]),
            }
        }
    }

    /// Whether a number is zero or above whatever its arguments are.
    fn is_not_negative(&self, node: Node) -> bool {
        match self.graph.operation(node) {
            Operation::Constant(bits) => f64::from_bits(bits) >= 0.0,
            Operation::Unary(Unary::Sqrt | Unary::Exp | Unary::Cosh | Unary::Acos, _) | Operation::Power(..) => true,
            Operation::Binary(Binary::Less, ..) => true,
            Operation::Binary(Binary::Mul, x, y) if x == y => true,
            Operation::Binary(Binary::Add | Binary::Mul | Binary::Div, x, y) => {
                self.is_not_negative(x) && self.is_not_negative(y)
            }
            Operation::Select([_, then, otherwise]) => self.is_not_negative(then) && self.is_not_negative(otherwise),
            _ => false,
        }
    }

    /// Adds the vector whose squared length is taken the root of.
    fn add_length(&mut self, square: Node) {
        let (mut open, mut components) = (vec![square], Vec::new());
        while let Some(node) = open.pop() {
            match self.graph.operation(node) {
                Operation::Binary(Binary::Add, x, y) => open.extend([x, y]),
                Operation::Binary(Binary::Mul, x, y) if x == y => components.push(x),
                Operation::Binary(Binary::Mul, x, y) if self.graph.constant_of(x).is_some_and(|x| x > 0.0) => open.push(y),
                Operation::Binary(Binary::Mul, x, y) if self.graph.constant_of(y).is_some_and(|y| y > 0.0) => open.push(x),
                _ => return,
            }
        }
        match components[..] {
            [own] => self.add(Side::Sign, &[own]),
            _ => self.add(Side::Direction(components.len()), &components),
        }
    }
}

impl Side {
    /// How many numbers tell it.
    pub fn count(&self) -> usize {
        match self {
            Side::Direction(count) => *count,
            Side::Order | Side::Angle => 2,
            Side::Sign | Side::Whole | Side::HalfTurn { .. } | Side::Piece(_) => 1,
        }
    }

    /// The number that passes through an end of the side, and its rate where rates are given.
    pub fn number(&self, own: &[f64]) -> f64 {
        if *self == Side::Order { own[0] - own[1] } else { own[0] }
    }

    /// Whether it is another one.
    fn changes(&self, before: &[f64], after: &[f64]) -> bool {
        match self {
            Side::Order => (before[0] < before[1]) != (after[0] < after[1]),
            Side::Sign => (before[0] < 0.0) != (after[0] < 0.0),
            Side::Whole => before[0].floor() != after[0].floor(),
            Side::HalfTurn { of_cosine } => half_turn(before[0], *of_cosine) != half_turn(after[0], *of_cosine),
            Side::Angle => (before[0] < 0.0) != (after[0] < 0.0) && before[1].min(after[1]) < 0.0,
            Side::Piece(curve) => curve.piece(before[0]) != curve.piece(after[0]),
            Side::Direction(_) => cosine(before, after) < REVERSED,
        }
    }

    /// Whether numbers on the way are on another side than those at its start: of a vector, which turns over close to zero, beyond a right angle.
    pub fn has_changed(&self, before: &[f64], own: &[f64]) -> bool {
        match self {
            Side::Direction(_) => cosine(before, own) < 0.0,
            // on the way x may be above zero where y is not yet
            Side::Angle => (before[0] < 0.0) != (own[0] < 0.0),
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
            Side::Sign | Side::Angle if before[0] < 0.0 => Some(own[0]),
            Side::Sign | Side::Angle => Some(-own[0]),
            Side::Whole => Some(beyond(before[0].floor() + f64::from(u8::from(is_up)))),
            Side::HalfTurn { of_cosine } => {
                let turns = half_turn(before[0], *of_cosine) + f64::from(u8::from(is_up));
                Some(beyond((turns - if *of_cosine { 0.5 } else { 0.0 }) * PI))
            }
            Side::Piece(curve) => {
                let piece = curve.piece(before[0]);
                let knot = if is_up { Some(piece) } else { piece.checked_sub(1) };
                knot.and_then(|knot| curve.knots().get(knot)).map(|&knot| beyond(knot))
            }
            Side::Direction(_) => Some(-cosine(before, own)),
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
        self.inputs.extend(between(self.from, self.to, share));
        self.switches.evaluate(&self.inputs, &mut self.numbers, &mut self.work);
        &self.numbers
    }

    /// Shares of the way between which a switch changes sides, whose own numbers stand at some places: no further apart than a width, or neighbours.
    ///
    /// Where numbers tell how far the switch is, the next share is that of the straight line through both ends, moved towards the middle so that it
    /// falls to either side; round-off hides the last digits of where that is, so that it is moved further each time it falls short.
    ///
    /// Source: Oliveira & Takahashi, ACM Trans. Math. Softw. 47 (2020), "An enhancement of the bisection method average performance preserving
    /// minmax optimality".
    fn place(&mut self, side: &Side, own: Range<usize>, ends: [&[f64]; 2], most: f64) -> Option<(f64, f64)> {
        let [before, after] = ends.map(|numbers| &numbers[own.clone()]);
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
        own: Range<usize>,
        (low, high): (f64, f64),
        known: Option<SwitchKind>,
    ) -> Option<SwitchKind> {
        let Way { switches, from, to, .. } = *self;
        let (change, [at_low, at_high]) = if let Side::Direction(_) = side {
            let middle = 0.5 * (low + high);
            let reversed = |near: &f64| {
                let [a, b] = [middle - near, middle + near].map(|share| self.numbers_at(share)[own.clone()].to_vec());
                side.changes(&a, &b)
            };
            let near = NEAR.into_iter().find(reversed)?;
            let [mut short, long] =
                [1.0, 2.0].map(|times| switches.change_between((from, to), middle - times * near, middle + times * near));
            // what is smooth changes twice as much over twice the way
            for (short, long) in short.changes.iter_mut().zip(long.changes) {
                *short = if *short > 0.75 * long { *short } else { 0.0 };
            }
            (short, [middle - near, middle + near])
        } else {
            (switches.change_between((from, to), low, high), [low, high])
        };
        // one piece may be nothing
        let terms = |share: f64| switches.terms(&between(from, to, share).collect::<Vec<_>>());
        change.kind(known, || terms(at_low).max(terms(at_high)))
    }
}

/// Number of the half turn between two zeros of the cosine, or of the sine, in which an angle is: by its sign, as the functions have it.
fn half_turn(angle: f64, of_cosine: bool) -> f64 {
    let (turns, sign) = if of_cosine { (angle / PI + 0.5, angle.cos()) } else { (angle / PI, angle.sin()) };
    let whole = turns.floor();
    let is_positive = whole.rem_euclid(2.0) == 0.0;
    match sign {
        0.0 => whole,
        _ if (sign > 0.0) == is_positive => whole,
        // next to a zero, on the other side of it
        _ if turns - whole < 0.5 => whole - 1.0,
        _ => whole + 1.0,
    }
}

/// Which operations tell a side of results only where an argument of it does not, and that argument.
fn located(graph: &Graph, outputs: &[Node], of_sides: &[bool]) -> Vec<Option<u32>> {
    let mut located = vec![None; graph.operations().len()];
    let needed = graph.needed(outputs);
    for (operation, _) in graph.operations().iter().zip(&needed).filter(|(_, is_needed)| **is_needed) {
        if let Operation::Select([mask, _, otherwise]) = *operation
            && let Operation::Input(input) = graph.operation(mask)
            && of_sides.get(input as usize) == Some(&true)
        {
            located[otherwise.0 as usize] = Some(input);
        }
    }
    located
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

/// How far the number of a switch is beyond the end of the side that is told: below zero where it is on that side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    pub by: f64,
    /// Change of it by time.
    pub rate: f64,
    /// Size of the terms whose difference it is.
    pub terms: f64,
    /// Of a number that is close to zero, the size of the terms of which a formula made it.
    pub size: f64,
    /// The side beyond the end.
    pub other: f64,
}

/// Share of coordinates by which joints are kept.
const HELD: f64 = 1e-13;

/// Share of coordinates that they leave at most.
const LEFT: f64 = 1e-10;

/// Round-off of a sum, in units of that of its terms.
const ROUNDINGS: f64 = 4.0;

impl Excess {
    /// Round-off of the terms, and what the rounding of the time makes of the number.
    pub fn round_off(&self, t: f64) -> f64 {
        ROUNDINGS * f64::EPSILON * (self.terms + (self.rate * t).abs())
    }

    /// What joints and Newton's method leave of a number that they hold at zero, too.
    pub fn noise(&self, t: f64) -> f64 {
        self.round_off(t) + HELD * self.size
    }

    /// Whether the number is beyond the end, or at it on the way there.
    pub fn is_passed(&self, t: f64) -> bool {
        let noise = self.noise(t);
        self.by > noise || self.by.abs() <= noise && self.rate > 0.0 && self.rate * t >= LEFT * self.size
    }

    /// Whether joints hold the number at zero.
    pub fn is_held(&self) -> bool {
        self.by.abs() <= LEFT * self.size
    }
}

impl Side {
    /// What the number that passes through an end is made of, where it does.
    fn weights(&self, own: &[f64]) -> [f64; 2] {
        match self {
            Side::Order => [1.0, -1.0],
            Side::Angle => {
                let (y, x) = (own[0], own[1]);
                let ends = [[1.0, 0.0], [y.signum(), 1.0], [-y.signum(), 1.0]];
                let size = |[first, second]: &[f64; 2]| (first * y + second * x).abs();
                ends.into_iter().min_by(|one, other| size(one).total_cmp(&size(other))).unwrap_or([1.0, 0.0])
            }
            _ => [1.0, 0.0],
        }
    }

    /// The side as a number of [`Formula::with_sides`], by the numbers that tell it.
    fn told_by(&self, own: &[f64]) -> f64 {
        match self {
            Side::Whole => coded(own[0].floor()),
            Side::Piece(curve) => curve.within(curve.piece(own[0])),
            Side::Angle if own[1] > -own[0].abs() => AHEAD,
            Side::Angle => 1f64.copysign(own[0]),
            _ if own[0] < own[1] => 1.0,
            _ => -1.0,
        }
    }

    fn excess_over(&self, told: f64, own: &[f64], rates: &[f64]) -> Excess {
        let (number, rate) = (self.number(own), self.number(rates));
        match self {
            Side::Whole => {
                let whole = if told > 0.0 { told - 1.0 } else { told };
                let terms = number.abs() + 1.0;
                match number > whole + 0.5 {
                    true => Excess { by: number - (whole + 1.0), rate, terms, size: 0.0, other: coded(whole + 1.0) },
                    false => Excess { by: whole - number, rate: -rate, terms, size: 0.0, other: coded(whole - 1.0) },
                }
            }
            Side::Piece(curve) => {
                let (piece, knots) = (curve.piece(told), curve.knots());
                let before = piece.checked_sub(1).map(|before| (knots[before] - number, -rate, knots[before], before));
                let behind = knots.get(piece).map(|&knot| (number - knot, rate, knot, piece + 1));
                let ends = before.into_iter().chain(behind);
                let Some((by, rate, knot, other)) = ends.max_by(|one, other| one.0.total_cmp(&other.0)) else {
                    unreachable!("a table has knots")
                };
                Excess { by, rate, terms: number.abs() + knot.abs(), size: 0.0, other: curve.within(other) }
            }
            Side::Angle => {
                let ([y, x], terms) = ([own[0], own[1]], own[0].abs() + own[1].abs());
                let (by, rate, other) = if told == AHEAD {
                    (-x - y.abs(), -rates[1] - y.signum() * rates[0], y.signum())
                } else if x > 0.0 {
                    (x - told * y, rates[1] - told * rates[0], AHEAD)
                } else {
                    (-told * y, -told * rates[0], -told)
                };
                Excess { by, rate, terms, size: 0.0, other }
            }
            // a limit at infinity
            _ if number.is_infinite() => {
                Excess { by: told.signum() * number, rate: 0.0, terms: 0.0, size: 0.0, other: -told }
            }
            _ => {
                let sign = told.signum();
                let terms = own[0].abs() + own[1].abs();
                Excess { by: sign * number, rate: sign * rate, terms, size: 0.0, other: -told }
            }
        }
    }
}

/// Side of an angle within 3/4 pi of zero, or, once it was, up to 1/4 pi: there nothing leaps.
pub(super) const AHEAD: f64 = 2.0;

/// A whole number as a side, which is not 0.
fn coded(whole: f64) -> f64 {
    if whole < 0.0 { whole } else { whole + 1.0 }
}

impl Switches {
    /// The sides of [located](Reads::Located) switches by the numbers that tell them.
    pub fn told_by<'s>(&'s self, numbers: &'s [f64]) -> impl Iterator<Item = f64> + 's {
        self.sides().map(|(side, own)| side.told_by(&numbers[own]))
    }

    /// How many they are.
    pub fn count(&self) -> usize {
        self.sides.len()
    }

    /// How far numbers that change with some rates are beyond the ends of the sides that are told.
    pub fn excesses<'s>(
        &'s self,
        told: &'s [f64],
        numbers: &'s [f64],
        rates: &'s [f64],
    ) -> impl Iterator<Item = Excess> + 's {
        let all = self.sides().zip(told);
        all.map(|((side, own), &told)| side.excess_over(told, &numbers[own.clone()], &rates[own]))
    }

    /// The number of a switch, by its place, for arguments in any scalar.
    pub fn number_in<S: Scalar>(&self, place: usize, inputs: &[S]) -> S {
        let mut numbers = vec![S::zero(); self.program.outputs()];
        self.program.run_in(inputs, &mut numbers, &mut ProgramWork::default());
        let (side, own) = self.side(place);
        let own = &numbers[own];
        let values: SmallVec<[f64; 4]> = own.iter().map(|own| own.value()).collect();
        let [first, second] = side.weights(&values);
        if second == 0.0 { own[0] * S::from(first) } else { own[0] * S::from(first) + own[1] * S::from(second) }
    }

    /// Gradient of that number by all arguments.
    pub fn number_by_arguments(&self, place: usize, inputs: &[f64]) -> Vec<f64> {
        let (reads, mut direction, mut numbers) = (self.reads(), vec![0.0; inputs.len()], Vec::new());
        self.evaluate(inputs, &mut numbers, &mut ProgramWork::default());
        let (side, own) = self.side(place);
        let [first, second] = side.weights(&numbers[own.clone()]);
        let along = |input: usize| {
            if !reads[input] {
                return 0.0;
            }
            direction.fill(0.0);
            direction[input] = 1.0;
            let rates = &self.rates(inputs, &direction, &mut ProgramWork::default())[own.clone()];
            if second == 0.0 { first * rates[0] } else { first * rates[0] + second * rates[1] }
        };
        (0..inputs.len()).map(along).collect()
    }

    fn side(&self, place: usize) -> (&Side, Range<usize>) {
        self.sides().nth(place).unwrap_or_else(|| unreachable!("a switch of this formula"))
    }

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

    /// All sides, with the places of their numbers.
    pub(super) fn sides(&self) -> impl Iterator<Item = (&Side, Range<usize>)> {
        let mut end = 0;
        self.sides.iter().map(move |side| {
            end += side.count();
            (side, end - side.count()..end)
        })
    }

    /// Rates of the numbers at some arguments along a change of these.
    pub fn rates(&self, inputs: &[f64], direction: &[f64], work: &mut ProgramWork<f64>) -> Vec<f64> {
        let mut rates = vec![0.0; self.rates.outputs()];
        self.rates.run(&[inputs, direction].concat(), &mut rates, work);
        rates
    }

    pub(super) fn changing<'s>(
        &'s self,
        before: &'s [f64],
        after: &'s [f64],
    ) -> impl Iterator<Item = (&'s Side, Range<usize>)> {
        self.sides().filter(|(side, own)| side.changes(&before[own.clone()], &after[own.clone()]))
    }

    /// Shares of the straight way between two lists of arguments between which a switch is on another side that is on the same one at both ends:
    /// where its number turns back in between, or where another switch changes sides.
    pub fn passed_over(
        &self,
        [from, to]: [&[f64]; 2],
        [before, after]: [&[f64]; 2],
        buffers: &mut PassBuffers,
    ) -> Option<[f64; 2]> {
        let PassBuffers { inputs, rates, work } = buffers;
        for (place, end) in [from, to].into_iter().enumerate() {
            inputs.clear();
            inputs.extend_from_slice(end);
            inputs.extend(from.iter().zip(to).map(|(from, to)| to - from));
            rates[place].resize(self.rates.outputs(), 0.0);
            self.rates.run(inputs, &mut rates[place], work);
        }
        for (side, own) in self.sides() {
            let [start, end] = [0, 1].map(|place| side.number(&rates[place][own.clone()]));
            let first = &before[own.clone()];
            let number = side.number(first);
            // of a parabola
            let turn = start / (start - end);
            let [there, beyond] = [0.5 * start * turn, start].map(|change| [number + change, 0.0]);
            let excess = |numbers: &[f64]| side.excess(first, numbers, &beyond);
            let turn = match side.changes(first, &after[own.clone()]) {
                true => self.way(from, to).place(side, own, [before, after], ROUGHLY).map(|place| place.0),
                // it comes half as near again to the end of its side
                false if start * end < 0.0 && excess(&there)? > 0.5 * excess(&[number, 0.0])? => Some(turn),
                false => None,
            };
            if let Some(found) = turn.and_then(|turn| self.passed_at(turn, [from, to], [before, after])) {
                return Some(found);
            }
        }
        None
    }

    /// Where a switch is on another side about a share of the way, if it is there.
    fn passed_at(&self, turn: f64, [from, to]: [&[f64]; 2], [before, after]: [&[f64]; 2]) -> Option<[f64; 2]> {
        let mut way = self.way(from, to);
        let turned = way.numbers_at(turn).to_vec();
        let stays = |side: &Side, own: &Range<usize>| !side.changes(&before[own.clone()], &after[own.clone()]);
        let (side, own) = self.changing(before, &turned).find(|(side, own)| stays(side, own))?;
        let enters = self.way(from, &way.inputs).place(side, own.clone(), [before, &turned], ROUGHLY)?.0;
        let leaves = self.way(&way.inputs, to).place(side, own, [&turned, after], ROUGHLY)?.0;
        Some([enters * turn, turn + leaves * (1.0 - turn)])
    }

    fn way<'w>(&'w self, from: &'w [f64], to: &'w [f64]) -> Way<'w> {
        Way { switches: self, from, to, inputs: Vec::new(), numbers: Vec::new(), work: ProgramWork::default() }
    }

    /// How the results change where switches change sides on the straight way between two lists of arguments: the worst, if it is worse than what
    /// is known; `None` where they go on smoothly, as where one series takes over from another.
    pub fn kind(&self, from: &[f64], to: &[f64], known: Option<SwitchKind>) -> Option<SwitchKind> {
        let mut way = self.way(from, to);
        let [before, after] = [from, to].map(|inputs| {
            let mut numbers = Vec::new();
            self.evaluate(inputs, &mut numbers, &mut way.work);
            numbers
        });
        let mut worst = known;
        for (side, own) in self.changing(&before, &after) {
            let mut kind_within = |width: f64, known: Option<SwitchKind>| {
                let place = way.place(side, own.clone(), [&before, &after], width);
                place.and_then(|place| way.kind_at(side, own.clone(), place, known))
            };
            // jumps show from further away, too, where two that are round-off apart may be one; next to a kink nothing else counts
            let mut kind = kind_within(ROUGHLY, Some(SwitchKind::Kink));
            if kind.is_none() && worst.is_none() {
                kind = kind_within(0.0, None);
            }
            worst = worst.max(kind);
            if worst == Some(SwitchKind::Jump) {
                break;
            }
        }
        worst.filter(|_| worst > known)
    }

    /// How the results change at a time `t` of a run, beside what they are and change by from its start to its `end`, for arguments of which those
    /// at the places `times` are the time.
    pub fn kind_at_time(&self, inputs: &[f64], times: &[usize], (t, end): (f64, f64)) -> Option<SwitchKind> {
        let at = |t: f64| {
            let mut inputs = inputs.to_vec();
            times.iter().for_each(|&place| inputs[place] = t);
            inputs
        };
        let [before, after] = [t.next_down(), t].map(at);
        let mut direction = vec![0.0; inputs.len()];
        times.iter().for_each(|&place| direction[place] = 1.0);
        let mut change = self.change_from([&before, &after], &direction);
        // where a motion begins smoothly both are nothing
        for place in 0..=TIMES {
            let inputs = at(end * f64::from(place) / f64::from(TIMES));
            let sizes = self.change_from([&inputs, &inputs], &direction).sizes;
            if sizes.into_iter().all(f64::is_finite) {
                change.sizes = [0, 1].map(|k| change.sizes[k].max(sizes[k]));
            }
        }
        change.kind(None, || self.terms(&before))
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
        let direction: Vec<f64> = way.0.iter().zip(way.1).map(|(from, to)| to - from).collect();
        let [below, above] = [low, high].map(|share| between(way.0, way.1, share).collect::<Vec<f64>>());
        self.change_from([&below, &above], &direction)
    }

    /// Change and size of the results, and of their rates along a direction, between two lists of arguments.
    fn change_from(&self, ends: [&[f64]; 2], direction: &[f64]) -> Change {
        let [below, above] = ends.map(|inputs| {
            let mut results = vec![0.0; self.course.outputs()];
            self.course.run(&[inputs, direction].concat(), &mut results, &mut ProgramWork::default());
            results
        });
        let count = below.len() / 2;
        let parts = [0..count, count..2 * count];
        Change {
            changes: parts.clone().map(|own| largest(own.map(|k| above[k] - below[k]))),
            sizes: parts.map(|own| largest(own.flat_map(|k| [above[k], below[k]]))),
        }
    }
}

/// Changes of results and of their slopes between two places, and sizes there.
struct Change {
    changes: [f64; 2],
    sizes: [f64; 2],
}

impl Change {
    /// What it is, beside the terms of the results; next to a kink that is known only a jump is asked for. Where even without terms it is
    /// nothing, these are not asked for: they take a run for each argument.
    fn kind(&self, known: Option<SwitchKind>, terms: impl FnOnce() -> f64) -> Option<SwitchKind> {
        let ([value, slope], [value_size, slope_size]) = (self.changes, self.sizes);
        let kind = |values: f64| match () {
            () if value > JUMP * values => Some(SwitchKind::Jump),
            // slopes that are nothing beside their values are round-off
            () if slope > KINK * (slope_size + KINK * values) => Some(SwitchKind::Kink),
            () => None,
        };
        let values = value_size + slope_size;
        if kind(values) <= known { None } else { kind(values + ROUND_OFF * terms()) }
    }
}

/// Numbers at a share of the straight way between two lists.
pub fn between(from: &[f64], to: &[f64], share: f64) -> impl Iterator<Item = f64> {
    from.iter().zip(to).map(move |(from, to)| from + share * (to - from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Interpolant;
    use crate::{ArgumentKind, Recorded};

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
            let switches = formula.switches(Reads::Motion, true).unwrap_or_else(|| panic!("{name} has a switch"));
            let mut work = ProgramWork::default();
            let [before, after] = [0.0, 1.0].map(|x| {
                let mut numbers = Vec::new();
                switches.evaluate(&[x], &mut numbers, &mut work);
                numbers
            });
            let mut way = switches.way(&[0.0], &[1.0]);
            let changing: Vec<_> = switches.changing(&before, &after).collect();
            let [(side, own)] = &changing[..] else { panic!("{name}: one side") };
            let (low, high) = way.place(side, own.clone(), [&before, &after], 0.0).expect("a place");
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
