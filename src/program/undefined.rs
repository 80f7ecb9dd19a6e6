//! Numbers that are undefined in some states, behind zeros that a recording has folded.

use super::graph::Graph;
use super::operation::{Binary, Node, Operation, Unary};
use std::collections::HashSet;

/// Where x - x, 0 x and 0/x of a formula of numbers would be undefined.
///
/// A recording has 0 for them: what x is made of is added to a result as [`Graph::nought`] where nothing else makes a result undefined with it.
#[derive(Clone, Debug, Default)]
pub struct Undefined {
    /// Of operations: whether an x is made of them.
    folded: Vec<bool>,
}

impl Undefined {
    /// Takes note of an x.
    pub fn fold(&mut self, x: Node) {
        let place = x.0 as usize;
        if self.folded.len() <= place {
            self.folded.resize(place + 1, false);
        }
        self.folded[place] = true;
    }

    /// Adds what is undefined with an x, where no result would be, to one of the results, and to one of `more`: one that is no constant
    /// where there is one.
    pub fn show(self, graph: &mut Graph, results: &mut [Node], more: &mut [Node]) {
        for x in self.unseen(graph, results) {
            for list in [&mut *results, &mut *more] {
                let moving = list.iter().position(|node| graph.constant_of(*node).is_none());
                if let Some(result) = list.get_mut(moving.unwrap_or(0)) {
                    let nought = graph.nought(x);
                    *result = graph.add(*result, nought);
                }
            }
        }
    }

    /// The operations that may make an x undefined, where no result would be.
    fn unseen(self, graph: &Graph, results: &[Node]) -> Vec<Node> {
        let operations = graph.operations();
        // what a choice may leave aside is undefined there with good reason
        let aside = graph.perhaps_left_aside(&vec![true; operations.len()]);
        let folded = graph.made_of(self.folded);
        let shown = [true, false].map(|infinite| shown(graph, results, infinite));
        let is_shown = |index: usize, infinite: bool| shown[1][index] && (shown[0][index] || !infinite);
        // quotients of the same denominator are undefined together
        let quotients = operations.iter().enumerate().filter(|(index, _)| is_shown(*index, true));
        let denominators: HashSet<Node> = quotients.filter_map(|(_, operation)| denominator(*operation)).collect();
        let is_unseen = |index: &usize| {
            let Some(infinite) = undefined(operations[*index], graph) else { return false };
            let is_seen =
                is_shown(*index, infinite) || denominator(operations[*index]).is_some_and(|own| denominators.contains(&own));
            folded[*index] && !aside[*index] && !is_seen
        };
        (0..folded.len()).filter(is_unseen).map(|index| Node(index as u32)).collect()
    }
}

fn denominator(operation: Operation) -> Option<Node> {
    match operation {
        Operation::Binary(Binary::Div, _, y) => Some(y),
        _ => None,
    }
}

/// Which operations make a result undefined where they are infinite, or where they are no number.
fn shown(graph: &Graph, results: &[Node], infinite: bool) -> Vec<bool> {
    let mut shown = vec![false; graph.operations().len()];
    results.iter().for_each(|result| shown[result.0 as usize] = true);
    for (index, &operation) in graph.operations().iter().enumerate().rev() {
        if shown[index] {
            passed_on(operation, infinite, |operand| shown[operand.0 as usize] = true);
        }
    }
    shown
}

/// Whether an operation of finite numbers, which are not so large that it overflows, may be no number, or even infinite.
fn undefined(operation: Operation, graph: &Graph) -> Option<bool> {
    match operation {
        Operation::Unary(Unary::Acos | Unary::Asin | Unary::Sqrt, _) => Some(false),
        Operation::Unary(Unary::Ln, _) => Some(true),
        Operation::Binary(Binary::Div, _, y) if graph.constant_of(y).is_none_or(|y| y == 0.0) => Some(true),
        Operation::Power(_, bits) => Some(f64::from_bits(bits) < 0.0),
        Operation::Constant(bits) if !f64::from_bits(bits).is_finite() => Some(true),
        _ => None,
    }
}

/// Calls `shown` for the operands which, infinite or no number, make the operation either of both.
fn passed_on(operation: Operation, infinite: bool, mut shown: impl FnMut(Node)) {
    match operation {
        Operation::Unary(Unary::Exp | Unary::Tanh | Unary::Atan, _) if infinite => {}
        Operation::Unary(_, x) => shown(x),
        Operation::Binary(Binary::Add | Binary::Sub | Binary::Mul, x, y) => [x, y].into_iter().for_each(shown),
        Operation::Binary(Binary::Div, x, y) => {
            shown(x);
            if !infinite {
                shown(y);
            }
        }
        Operation::Binary(Binary::Atan2, x, y) if !infinite => [x, y].into_iter().for_each(shown),
        Operation::Binary(Binary::Vanishing, x, _) => shown(x),
        Operation::Power(x, bits) if f64::from_bits(bits) > 0.0 || !infinite => shown(x),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use crate::scalar::Scalar;
    use crate::{Formula, ProgramWork, Recorded};

    /// A formula of one number, in two scalars.
    type Pair = (fn(f64) -> f64, fn(Recorded) -> Recorded);

    macro_rules! formulas {
        ($($formula:expr),* $(,)?) => {
            [$({
                fn own<S: Scalar>(x: S) -> S {
                    let formula: fn(S) -> S = $formula;
                    formula(x)
                }
                (own::<f64> as fn(f64) -> f64, own::<Recorded> as fn(Recorded) -> Recorded)
            }),*]
        };
    }

    #[test]
    fn a_recording_is_undefined_where_the_formula_is() {
        let formulas: [Pair; 12] = formulas![
            |x| x.recip() * 0.0,
            |x| x + x.ln() * 0.0,
            |x| x * x - (x.sqrt() - x.sqrt()),
            |x| S::zero() / x.sqrt() + x,
            |x| x.recip() - x.recip() + x * 2.0,
            |x| (x.recip() * 0.0 + x) * x.recip(),
            |x| (x * x).sqrt().recip() * 0.0 + x.sin(),
            // an infinite number that ends up below a line
            |x| x.recip() * 0.0 + x.recip().recip(),
            |x| x.acos() * 0.0 + x,
            // what a choice leaves aside
            |x| S::zero().less(x).select(x.ln() * 0.0 + x.ln(), x),
            |x| x * 0.0 + x,
            |x| x.powf(-0.5) * 0.0 + x,
        ];
        for (k, (of_numbers, recorded)) in formulas.into_iter().enumerate() {
            let formula = Formula::record(1, |x| vec![recorded(x[0])]).expect("does not branch");
            for x in [0.0, -2.0, 0.3, 3.0] {
                let mut value = [0.0];
                formula.values().run(&[x], &mut value, &mut ProgramWork::default());
                let expected = of_numbers(x);
                let is_same = (value[0] - expected).abs() < 1e-14
                    || value[0].is_finite() == expected.is_finite() && !expected.is_finite();
                assert!(is_same, "formula {k} at {x}: {} for {expected}", value[0]);
            }
        }
    }

    #[test]
    fn nothing_is_added_where_a_result_tells() {
        let count = |formula: fn(Recorded) -> Vec<Recorded>| {
            let formula = Formula::record(1, |x| formula(x[0])).expect("does not branch");
            formula.inspect(|graph, outputs| graph.needed(outputs).into_iter().filter(|needed| *needed).count())
        };
        let plain = count(|x| vec![x, x.recip()]);
        assert_eq!(count(|x| vec![x + x.recip() * 0.0, x.recip()]), plain);
        assert_eq!(count(|x| vec![x + (x - x) + x * 0.0, x.recip()]), plain);
        assert!(count(|x| vec![x + x.recip() * 0.0, x]) > 1);
    }
}
