//! Switches whose sides are told from outside: steps of a run use those of their start, and end where one changes.

use super::arguments::ArgumentKind::{self, Coordinate, Side, Velocity};
use super::formula::Formula;
use super::graph::Graph;
use super::operation::{Binary, Node, Operation, Unary};
use super::switches::AHEAD;
use std::f64::consts::TAU;
use std::sync::Arc;

impl Formula {
    /// The formula with the sides of its comparisons, whole numbers, angles and tables with kinks as arguments behind the parameters of its part, for those that
    /// coordinates or velocities decide without accelerations. A side of 0 leaves the decision to the numbers, as in the formula itself. Of a comparison 1
    /// means that it holds, -1 that it does not; of the largest whole number n up to a number, n + 1 means n where it is not below zero, and n itself
    /// below; of a table a side is a place in the piece that counts; of the angle of a point 1 means that it is near pi or beyond, -1 near -pi, and 2 that it is neither.
    ///
    /// # Errors
    /// A formula that has no parameters of a part.
    pub fn with_sides(self: &Arc<Self>) -> Result<Arc<Formula>, String> {
        let switching = |formula: &Formula| {
            let [moving, excluded] = [&[Coordinate, Velocity][..], &[ArgumentKind::Acceleration, ArgumentKind::Multiplier]];
            let [moving, excluded] = [moving, excluded].map(|kinds| formula.arguments().of_kinds(kinds));
            formula.inspect(|graph, outputs| switching(graph, outputs, &moving, &excluded))
        };
        let count = switching(self).iter().map(|(_, side)| side + 1).max().unwrap_or(0);
        if count == 0 || self.stages.is_some() {
            return Ok(Arc::clone(self));
        }
        let widened = self.with_sides_unread(count)?;
        let nodes = switching(&widened);
        let sides = widened.arguments().of_kinds(&[Side]);
        let places: Vec<usize> = (0..sides.len()).filter(|&place| sides[place]).collect();
        Ok(widened.derived(|graph, x, outputs| {
            let mut replaced = Vec::new();
            let switched: Vec<Node> = nodes.iter().map(|own| own.0).collect();
            let roots = roots_of(graph, outputs, &switched).into_iter().map(|node| (node, None));
            let mut all: Vec<(Node, Option<usize>)> =
                nodes.iter().map(|&(node, side)| (node, Some(side))).chain(roots).collect();
            all.sort_unstable_by_key(|own| own.0.0);
            for (node, side) in all {
                let zero = graph.zero();
                let Some(side) = side.map(|side| x[places[side]]) else {
                    let root = root_beyond(graph, node, &replaced);
                    replaced.push((node, root));
                    continue;
                };
                let told = match graph.operation(node) {
                    Operation::Unary(Unary::Floor, _) => {
                        let is_above = graph.binary(Binary::Less, zero, side);
                        graph.sub(side, is_above)
                    }
                    Operation::Curve { curve, order, at } => {
                        // of degree 1
                        let at = graph.substitute(&[at], &replaced)[0];
                        let [value, slope] = [order, order + 1].map(|order| graph.on_own_curve(curve, order, side));
                        let beside = graph.sub(at, side);
                        let change = graph.mul(slope, beside);
                        graph.add(value, change)
                    }
                    Operation::Binary(Binary::Atan2, y, x) => {
                        let numbers = graph.substitute(&[node, y, x], &replaced);
                        let [own, y, x] = numbers[..] else { unreachable!("as many as were given") };
                        let (is_left, towards) = (graph.binary(Binary::Less, x, zero), graph.mul(side, y));
                        let has_passed = graph.binary(Binary::Less, towards, zero);
                        let (ahead, turn) = (graph.constant(AHEAD), graph.constant(TAU));
                        let is_turned = graph.binary(Binary::Less, side, ahead);
                        let mut turn = graph.mul(turn, side);
                        for factor in [is_turned, is_left, has_passed] {
                            turn = graph.mul(turn, factor);
                        }
                        graph.add(own, turn)
                    }
                    _ => graph.binary(Binary::Less, zero, side),
                };
                // what decides it may have sides itself
                let own = graph.substitute(&[node], &replaced)[0];
                replaced.push((node, graph.select(side, told, own)));
            }
            graph.substitute(outputs, &replaced)
        }))
    }

    /// The formula of one comparison, with its side as an argument behind the parameters, whatever decides it.
    ///
    /// # Errors
    /// As for [`Formula::with_sides`].
    pub fn with_side_of_result(&self) -> Result<Arc<Formula>, String> {
        let widened = self.with_sides_unread(1)?;
        let place = widened.arguments().of_kinds(&[Side]).iter().position(|is_side| *is_side);
        Ok(widened.derived(|graph, x, outputs| {
            let side = x[place.unwrap_or_default()];
            let zero = graph.zero();
            let holds = graph.binary(Binary::Less, zero, side);
            vec![graph.select(side, holds, outputs[0])]
        }))
    }

    /// The formula with so many sides among its arguments that it does not read.
    ///
    /// # Errors
    /// As for [`Formula::with_sides`].
    pub fn with_sides_unread(&self, count: usize) -> Result<Arc<Formula>, String> {
        self.widened((Side, count), |x, _| x.to_vec())
    }

    /// How many sides are among its arguments.
    pub fn sides(&self) -> usize {
        self.arguments().kinds().iter().filter(|(kind, _)| *kind == Side).map(|(_, count)| count).sum()
    }
}

/// Roots and powers with fractions of numbers that depend on what is switched.
fn roots_of(graph: &Graph, outputs: &[Node], switched: &[Node]) -> Vec<Node> {
    let needed = graph.needed(outputs);
    let operations = &graph.operations()[..needed.len()];
    let is_switched = (0..operations.len()).map(|place| switched.contains(&Node(place as u32))).collect();
    let depends = graph.depending_on(is_switched, &needed);
    let is_root = |place: &usize| match operations[*place] {
        Operation::Unary(Unary::Sqrt, x) => depends[x.0 as usize],
        Operation::Power(x, bits) => f64::from_bits(bits).fract() != 0.0 && depends[x.0 as usize],
        _ => false,
    };
    (0..operations.len()).filter(|place| needed[*place] && is_root(place)).map(|place| Node(place as u32)).collect()
}

/// A root or power of a number that sides which are told may leave below zero where numbers would not: it goes on there as an odd function.
fn root_beyond(graph: &mut Graph, node: Node, replaced: &[(Node, Node)]) -> Node {
    let (Operation::Unary(_, by_numbers) | Operation::Power(by_numbers, _)) = graph.operation(node) else { return node };
    let (base, zero) = (graph.substitute(&[by_numbers], replaced)[0], graph.zero());
    let [is_below, is_below_by_numbers] = [base, by_numbers].map(|own| graph.binary(Binary::Less, own, zero));
    let opposite = graph.neg(base);
    let kept = graph.select(is_below_by_numbers, base, opposite);
    let size = graph.select(is_below, kept, base);
    let root = match graph.operation(node) {
        Operation::Power(_, bits) => graph.power(size, f64::from_bits(bits)),
        _ => graph.unary(Unary::Sqrt, size),
    };
    let minus = graph.neg(root);
    graph.select(is_below, minus, root)
}

/// Comparisons, whole numbers, angles and tables with kinks that results depend on and that read `moving` arguments, and none that is excluded; each with the
/// number of its side, which tables of one number with the same knots share.
fn switching(graph: &Graph, outputs: &[Node], moving: &[bool], excluded: &[bool]) -> Vec<(Node, usize)> {
    let needed = graph.needed(outputs);
    let operations = &graph.operations()[..needed.len()];
    let depending = |arguments: &[bool]| {
        let is_among =
            |own: &Operation| matches!(*own, Operation::Input(input) if arguments.get(input as usize) == Some(&true));
        graph.depending_on(operations.iter().map(is_among).collect(), &needed)
    };
    let (moves, is_excluded) = (depending(moving), depending(excluded));
    let (mut all, mut tables, mut sides) = (Vec::new(), Vec::<((&[f64], Node), usize)>::new(), 0);
    for place in (0..operations.len()).filter(|&place| needed[place] && moves[place] && !is_excluded[place]) {
        let known = match operations[place] {
            Operation::Curve { curve, at, .. } if graph.curves()[curve as usize].has_kinks() => {
                let knots = graph.curves()[curve as usize].knots();
                let own = tables.iter().find(|own| own.0 == (knots, at)).map(|own| own.1);
                tables.extend(own.is_none().then_some(((knots, at), sides)));
                own
            }
            Operation::Binary(Binary::Less | Binary::Atan2, ..) | Operation::Unary(Unary::Floor, _) => None,
            _ => continue,
        };
        all.push((Node(place as u32), known.unwrap_or(sides)));
        sides += usize::from(known.is_none());
    }
    all
}

#[cfg(test)]
mod tests {
    use crate::scalar::{Curve, Interpolant, Scalar};
    use crate::{ArgumentKind, Formula, ProgramWork, Reads, Recorded};
    use std::f64::consts::{PI, TAU};

    fn table(x: Recorded) -> Recorded {
        x.on_curve(&Curve::new(&[-1.0, 0.0, 2.0], &[3.0, 0.0, 1.0], Interpolant::Lines).expect("knots"), 0)
    }

    fn nearest(x: Recorded) -> Recorded {
        let beyond = x.sin().atan2(x.cos()) - 1.0;
        beyond - (beyond / TAU + 0.5).floor() * TAU
    }

    /// With the sides of a place the formula goes on beyond their ends.
    #[test]
    fn formulas_go_on_beyond_their_sides() {
        type Case = (fn(Recorded) -> Recorded, f64, f64, f64);
        let cases: [Case; 7] = [
            (|x| x.sin().atan2(x.cos()), 3.0, PI + 0.5, PI + 0.5),
            (|x| x.sin().atan2(x.cos()), 3.5, 3.0, 3.0 - TAU),
            (|x| x.sin().atan2(x.cos()), 0.5, -0.5, -0.5),
            (nearest, 3.0, 4.5, 3.5),
            (table, 0.5, -0.5, -0.25),
            (|x| x.max(Recorded::from(1.0)), 0.5, 2.0, 1.0),
            (|x| (x - 1.0).max(Recorded::from(0.0)).powf(1.5), 2.0, 0.96, -0.008),
        ];
        for (number, (formula, from, to, expected)) in cases.into_iter().enumerate() {
            let kinds = vec![(ArgumentKind::Coordinate, 1), (ArgumentKind::Parameter, 1), (ArgumentKind::Time, 1)];
            let formula = Formula::record(kinds, |x| vec![formula(x[0])]).expect("recorded").with_sides().expect("sides");
            // whatever else is made of it
            formula.gradient(&[0]);
            let switches = formula.switches(Reads::Located, false).expect("switches");
            let count = formula.sides();
            assert_eq!(switches.count(), count, "{number}");
            let value = |x: f64, sides: &[f64]| {
                let mut values = [0.0];
                formula.values().run(&[&[x, 0.0], sides, &[0.0]].concat(), &mut values, &mut ProgramWork::default());
                values[0]
            };
            let mut numbers = Vec::new();
            switches.evaluate(
                &[from, 0.0, 0.0].into_iter().chain(vec![0.0; count]).collect::<Vec<_>>(),
                &mut numbers,
                &mut ProgramWork::default(),
            );
            let told: Vec<f64> = switches.told_by(&numbers).collect();
            assert!((value(from, &told) - value(from, &vec![0.0; count])).abs() < 1e-15, "{number}");
            assert!((value(to, &told) - expected).abs() < 1e-14, "{number}: {} for {expected}", value(to, &told));
        }
    }
}
