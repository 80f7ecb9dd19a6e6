//! What the tables of a formula are read at.

use super::arguments::ArgumentKind;
use super::formula::Formula;
use super::graph::Graph;
use super::operation::{Node, Operation};
use super::running::Program;
use smallvec::smallvec;
use std::sync::Arc;

/// The first and the last point of a table beyond which it is told to be left.
pub type TableRange = [f64; 2];

impl Formula {
    /// Ranges of its tables, and a program of the numbers at which these are read; `None` without tables.
    ///
    /// A table of time that stays constant beyond an end has none there: that is how loads are switched on and off.
    pub fn table_arguments(&self) -> Option<(Vec<TableRange>, Arc<Program>)> {
        let [is_time, is_side] = [self.arguments().of_time(), self.arguments().of_kinds(&[ArgumentKind::Side])];
        let found = self.inspect(|graph, outputs| arguments(graph, outputs, [&is_time, &is_side]));
        if found.is_empty() {
            return None;
        }
        let (nodes, ranges): (Vec<Node>, Vec<TableRange>) = found.into_iter().unzip();
        Some((ranges, self.dense_program(("table arguments", smallvec![]), 0, |_, _, _| nodes)))
    }
}

fn arguments(graph: &Graph, outputs: &[Node], [is_time, is_side]: [&[bool]; 2]) -> Vec<(Node, TableRange)> {
    let (needed, mut found) = (graph.needed(outputs), Vec::<(Node, [f64; 2], TableRange)>::new());
    for (_, &operation) in graph.operations().iter().enumerate().filter(|(place, _)| needed.get(*place) == Some(&true)) {
        let Operation::Curve { curve, at, .. } = operation else { continue };
        let curve = &graph.curves()[curve as usize];
        let (Some(&first), Some(&last)) = (curve.knots().first(), curve.knots().last()) else { continue };
        let at = unclamped(graph, at, [first, last]);
        let is = |kind: &[bool]| matches!(graph.operation(at), Operation::Input(index) if kind.get(index as usize) == Some(&true));
        if is(is_side) {
            continue;
        }
        let is_time = is(is_time);
        let [goes_on_before, goes_on_behind] = curve.slopes_beyond().map(|slope| !is_time || slope != 0.0);
        let range =
            [if goes_on_before { first } else { f64::NEG_INFINITY }, if goes_on_behind { last } else { f64::INFINITY }];
        // the curves of one table
        match found.iter_mut().find(|own| own.0 == at && own.1 == [first, last]) {
            Some(own) => own.2 = [own.2[0].max(range[0]), own.2[1].min(range[1])],
            None => found.push((at, [first, last], range)),
        }
    }
    found.retain(|own| own.2 != [f64::NEG_INFINITY, f64::INFINITY] && graph.constant_of(own.0).is_none());
    found.into_iter().map(|(at, _, range)| (at, range)).collect()
}

/// The number that is kept between the ends.
fn unclamped(graph: &Graph, mut at: Node, ends: TableRange) -> Node {
    let is_end = |node: Node| graph.constant_of(node).is_some_and(|value| ends.contains(&value));
    while let Operation::Select([_, x, y]) = graph.operation(at) {
        at = match [is_end(x), is_end(y)] {
            [true, false] => y,
            [false, true] => x,
            _ => break,
        };
    }
    at
}
