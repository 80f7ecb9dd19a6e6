use super::graph::Graph;
use super::operation::{Binary, Node, Unary};
use super::undefined::Undefined;
use crate::scalar::{Curve, Scalar, assign_operators, gathered_place};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// A number of a formula that is being recorded: its place in the recording, and its value where the recording has values.
///
/// Constants have no place and are folded.
#[derive(Clone, Copy)]
pub struct Recorded {
    value: f64,
    place: u32,
}

/// Marks a constant.
const CONSTANT: u32 = u32::MAX;

/// A recording: the operations of a formula.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// The operations.
    pub graph: Graph,
    /// True if the formula asked for the value of a number that is not the same everywhere: it may have taken a branch that it would
    /// not take for other arguments.
    pub looked: bool,
    /// True if a residual was not written out, but is to follow from energies.
    pub from_energies: bool,
    /// What was folded to 0 and may be undefined.
    pub(super) undefined: Undefined,
}

thread_local! {
    static RECORDING: RefCell<Option<Recording>> = const { RefCell::new(None) };
}

/// Ends a recording on the way out, a panic included: the one around it goes on.
struct Around(Option<Recording>);

impl Drop for Around {
    fn drop(&mut self) {
        RECORDING.set(self.0.take());
    }
}

/// Records what `formula` does with its arguments, whose values are `values`; numbers that are not known are NaN.
pub fn record<T>(values: &[f64], formula: impl FnOnce(&[Recorded]) -> T) -> (T, Recording) {
    let (around, arguments) = begin(values);
    let result = formula(&arguments);
    (result, end(around))
}

// outside of the generic function: there is one for each formula
fn begin(values: &[f64]) -> (Around, Vec<Recorded>) {
    let around = Around(RECORDING.replace(Some(Recording::default())));
    let argument = |(index, &value)| Recorded { value, place: with_graph(|graph| graph.input(index)).0 };
    (around, values.iter().enumerate().map(argument).collect())
}

fn end(around: Around) -> Recording {
    let recording = RECORDING.take().unwrap_or_default();
    drop(around);
    recording
}

fn with_graph<T>(f: impl FnOnce(&mut Graph) -> T) -> T {
    RECORDING.with_borrow_mut(|recording| match recording {
        Some(recording) => f(&mut recording.graph),
        None => panic!("recorded numbers live inside a recording only"),
    })
}

/// Takes a note in the recording, if there is one.
fn note(f: impl FnOnce(&mut Recording)) {
    RECORDING.with_borrow_mut(|recording| recording.as_mut().map_or((), f));
}

impl Recorded {
    /// The number as a node of the recording it belongs to.
    pub fn node(self, graph: &mut Graph) -> Node {
        if self.place == CONSTANT { graph.constant(self.value) } else { Node(self.place) }
    }

    /// An argument of what is being recorded, whose value is not known.
    pub fn argument(index: usize) -> Self {
        Recorded { value: f64::NAN, place: with_graph(|graph| graph.input(index)).0 }
    }

    /// The value of a constant: what a recording is made of may depend on it, as it holds for all arguments.
    pub fn known(self) -> Option<f64> {
        (self.place == CONSTANT).then_some(self.value)
    }

    /// True for the constant 0.
    pub fn is_known_zero(self) -> bool {
        self.known() == Some(0.0)
    }

    /// Takes note that a formula looks at a number that is not the same everywhere.
    fn look(self) {
        if self.place == CONSTANT {
            return;
        }
        note(|recording| recording.looked = true);
    }

    /// The value at the recording's arguments: what scenes are built from.
    pub fn number(self) -> f64 {
        self.value
    }

    /// A node of the recording, whose value is not known unless it is a constant.
    fn of(graph: &Graph, node: Node) -> Self {
        match graph.constant_of(node) {
            Some(value) => Recorded::from(value),
            None => Recorded { value: f64::NAN, place: node.0 },
        }
    }

    fn made(value: f64, operation: impl FnOnce(&mut Graph) -> Node) -> Self {
        with_graph(|graph| {
            let node = operation(graph);
            match graph.constant_of(node) {
                Some(value) => Recorded::from(value),
                None => Recorded { value, place: node.0 },
            }
        })
    }

    /// A function of this number, whose value is known; that of a constant is one.
    fn function(self, value: f64, operation: impl FnOnce(&mut Graph, Node) -> Node) -> Self {
        if self.place == CONSTANT {
            return Recorded::from(value);
        }
        Self::made(value, |graph| operation(graph, Node(self.place)))
    }

    #[inline(never)]
    fn binary(self, function: Binary, other: Self) -> Self {
        let value = function.apply(self.value, other.value);
        if self.place == CONSTANT && other.place == CONSTANT {
            return Recorded::from(value);
        }
        let made = Self::made(value, |graph| {
            let (x, y) = (self.node(graph), other.node(graph));
            graph.binary(function, x, y)
        });
        // a factor or numerator 0, or two equal numbers
        if made.is_known_zero() && matches!(function, Binary::Sub | Binary::Mul | Binary::Div) {
            folded(function, if self.place == CONSTANT { other } else { self });
        }
        made
    }
}

fn folded(function: Binary, number: Recorded) {
    note(|Recording { graph, undefined, .. }| {
        let mut node = Node(number.place);
        // what is divided by may be 0, too
        if function == Binary::Div {
            let one = graph.constant(1.0);
            node = graph.div(one, node);
        }
        undefined.fold(node);
    });
}

/// A formula may branch by it: whether two numbers are equal is known of constants alone.
impl PartialEq for Recorded {
    fn eq(&self, other: &Self) -> bool {
        self.look();
        other.look();
        self.place == other.place && self.value == other.value
    }
}

/// Text that a formula may branch by.
impl std::fmt::Debug for Recorded {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        self.look();
        write!(f, "{}", self.value)
    }
}

impl Default for Recorded {
    fn default() -> Self {
        Recorded::from(0.0)
    }
}
impl From<f64> for Recorded {
    #[inline]
    fn from(value: f64) -> Self {
        Recorded { value, place: CONSTANT }
    }
}
impl Neg for Recorded {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Unary::Neg)
    }
}

/// Operators between recorded numbers, and with a real number on the right.
macro_rules! operators {
    ($($operator:ident, $method:ident);*) => {$(
        impl $operator for Recorded {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.binary(Binary::$operator, other)
            }
        }
        impl $operator<f64> for Recorded {
            type Output = Self;
            fn $method(self, other: f64) -> Self {
                self.binary(Binary::$operator, Recorded::from(other))
            }
        }
    )*};
}
operators!(Add, add; Sub, sub; Mul, mul; Div, div);
assign_operators!([] Recorded);

impl Scalar for Recorded {
    fn value(self) -> f64 {
        self.look();
        self.value
    }
    fn is_constant(self) -> bool {
        self.look();
        self.place == CONSTANT
    }
    // formulas of all elements are compiled with this: as a call it takes half the code
    #[inline(never)]
    fn unary(self, function: Unary) -> Self {
        self.function(self.value.unary(function), |graph, x| graph.unary(function, x))
    }
    fn recip(self) -> Self {
        Recorded::from(1.0) / self
    }
    fn powf(self, exponent: f64) -> Self {
        self.function(Scalar::powf(self.value, exponent), |graph, x| graph.power(x, exponent))
    }
    fn atan2(self, other: Self) -> Self {
        self.binary(Binary::Atan2, other)
    }
    fn less(self, other: Self) -> Self {
        self.binary(Binary::Less, other)
    }
    fn vanishing_times(self, other: Self) -> Self {
        self.binary(Binary::Vanishing, other)
    }
    fn select(self, then: Self, otherwise: Self) -> Self {
        if self.place == CONSTANT {
            return if self.value != 0.0 { then } else { otherwise };
        }
        let value = Scalar::select(self.value, then.value, otherwise.value);
        Self::made(value, |graph| {
            let (then, otherwise) = (then.node(graph), otherwise.node(graph));
            graph.select(Node(self.place), then, otherwise)
        })
    }
    fn from_energies() {
        note(|recording| recording.from_energies = true);
    }
    fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self {
        self.function(curve.value(order, self.value), |graph, x| graph.on_curve(curve, order, x))
    }
    fn gather(self, values: &[Self]) -> Self {
        let chosen = values[gathered_place(self.value, values.len())];
        if self.place == CONSTANT {
            return chosen;
        }
        Self::made(chosen.value, |graph| {
            let nodes: Vec<Node> = values.iter().map(|own| own.node(graph)).collect();
            graph.gather(&nodes, Node(self.place))
        })
    }
}

/// Goes on with a recording: `formula` gets nodes of it as numbers, without values.
pub fn continued(graph: &mut Graph, nodes: &[Node], formula: impl FnOnce(&[Recorded]) -> Vec<Recorded>) -> Vec<Node> {
    let numbers: Vec<Recorded> = nodes.iter().map(|&node| Recorded::of(graph, node)).collect();
    let own = Recording { graph: std::mem::take(graph), ..Recording::default() };
    let around = Around(RECORDING.replace(Some(own)));
    let results = formula(&numbers);
    *graph = end(around).graph;
    results.into_iter().map(|result| result.node(graph)).collect()
}

/// Whether a residual that was asked for is to follow from energies.
pub fn is_from_energies() -> bool {
    RECORDING.with_borrow(|recording| recording.as_ref().is_some_and(|recording| recording.from_energies))
}

/// Derivatives of recorded numbers along a motion: each of `seeds` is a number that moves, with its rate.
pub fn along_motion(outputs: &[Recorded], seeds: &[(Recorded, Recorded)]) -> Vec<Recorded> {
    derived(|graph| {
        let nodes: Vec<Node> = outputs.iter().map(|output| output.node(graph)).collect();
        let moving = seeds.iter().filter(|(number, _)| number.place != CONSTANT);
        let seeds: Vec<(Node, Node)> = moving.map(|(number, rate)| (number.node(graph), rate.node(graph))).collect();
        graph.forward(&nodes, &seeds)
    })
}

/// Gradient of a sum of recorded numbers times weights towards others.
pub fn gradient_of(outputs: &[Recorded], weights: &[Recorded], towards: &[Recorded]) -> Vec<Recorded> {
    derived(|graph| {
        let [outputs, weights, towards] =
            [outputs, weights, towards].map(|list| list.iter().map(|own| own.node(graph)).collect::<Vec<_>>());
        graph.reverse(&outputs, &weights, &towards)
    })
}

fn derived(derive: impl FnOnce(&mut Graph) -> Vec<Node>) -> Vec<Recorded> {
    // slopes of functions are recordings themselves, for which this one has to be free
    let mut graph = with_graph(std::mem::take);
    let numbers = derive(&mut graph).into_iter().map(|node| Recorded::of(&graph, node)).collect();
    with_graph(|own| *own = graph);
    numbers
}

/// Values of recorded numbers for values of the recording's arguments.
pub fn evaluate(values: &[f64], numbers: &[Recorded]) -> Vec<f64> {
    with_graph(|graph| {
        let nodes: Vec<Node> = numbers.iter().map(|number| number.node(graph)).collect();
        graph.values_of(&nodes, values)
    })
}
