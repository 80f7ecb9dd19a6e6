//! Programs of constraints inside nodes, which never reach the matrix: corrections of the unknowns, multipliers, the curvature of reactions, and
//! products with adjoint variables.
//!
//! All of them come from g(q) alone, as those of joints do. G are the scaled equations of a level, and C is their derivative with respect to the
//! unknowns x of the node: at acceleration level A + 2 beta dA/dt + ..., so it is not A.

use super::constraint_programs::{Asked, ConstraintLayout, Parts};
use super::reduction::{Columns, NodeReduction};
use crate::elements::ConstraintPhysics;
use crate::program::{Codes, Graph, Node, Program, ProgramKey, Recorded, continued};
use crate::scalar::Scalar;
use std::sync::Arc;

/// A program of the coordinates that a constraint inside a node is about, those at its end: behind the arguments of the formula, which are not
/// read, stand those of a constraint of these alone.
fn program(
    physics: &ConstraintPhysics,
    layout: ConstraintLayout,
    key: ProgramKey,
    extra: usize,
    results: impl FnOnce(&mut Graph, &[Node], &[Node]) -> Vec<Node>,
) -> Arc<Program> {
    let (formula, dofs) = (physics.formula(), physics.dof_count());
    formula.dense_program(key, layout.extra() + extra, |graph, inputs, outputs| {
        let own = &inputs[formula.inputs..];
        let place = |i: usize| (i / layout.n + 1) * dofs - layout.n + i % layout.n;
        let same: Vec<(Node, Node)> = (0..2 * layout.n).map(|i| (inputs[place(i)], own[i])).collect();
        let outputs = graph.substitute(outputs, &same);
        results(graph, own, &outputs)
    })
}

/// What brings unknowns back onto the equations: what counts as round-off of G, G, then the correction -C^T (C C^T)^-1 G of x. Behind the
/// arguments, at the base: gamma, beta, alpha, x.
pub(super) fn correction(physics: &ConstraintPhysics, layout: ConstraintLayout, asked: Asked) -> Arc<Program> {
    let (n, key) = (layout.n, ("node correction", asked.code().collect()));
    program(physics, layout, key, 3 + n, |graph, inputs, outputs| {
        let equations = Parts::new(graph, (inputs, outputs), layout, (asked, physics)).equations;
        let motion = motion(inputs, layout);
        let (rates, unknowns) = inputs[layout.extra()..].split_at(3);
        let columns = columns_of(graph, (inputs, layout), &equations, rates);
        let multipliers = balancing(graph, &columns, &equations);
        let mut results = vec![round_off(graph, &motion, &equations)];
        results.extend(&equations);
        results.extend(columns.iter().map(|column| combined(graph, column, &multipliers)));
        // all of it at the point of the unknowns
        let moved: Vec<(Node, Node)> = (0..3 * n)
            .map(|place| {
                let change = graph.mul(unknowns[place % n], rates[place / n]);
                (motion[place], graph.add(motion[place], change))
            })
            .collect();
        graph.substitute(&results, &moved)
    })
}

/// The reaction A^T mu that leaves a force no part along reactions, A (f + A^T mu) = 0, and mu. In place of the acceleration: f.
pub(super) fn elimination(physics: &ConstraintPhysics, layout: ConstraintLayout) -> Arc<Program> {
    let (n, key) = (layout.n, ("node elimination", Codes::new()));
    program(physics, layout, key, 0, |graph, inputs, outputs| {
        let (q, f, one) = (&inputs[n..2 * n], &inputs[layout.a()..layout.mu()], graph.constant(1.0));
        let rows: Vec<_> = outputs.iter().map(|&output| graph.reverse(&[output], &[one], q)).collect();
        let columns: Vec<Vec<Node>> = (0..n).map(|dof| rows.iter().map(|row| row[dof]).collect()).collect();
        let along: Vec<Node> = rows.iter().map(|row| combined(graph, row, f)).collect();
        let multipliers = balancing(graph, &columns, &along);
        let reaction: Vec<Node> = columns.iter().map(|column| combined(graph, column, &multipliers)).collect();
        [reaction, multipliers].concat()
    })
}

/// Derivative of the reactions A^T mu along the reduced columns of a node: entries that are not zero, numbered by row + column times
/// size. Behind the arguments of a constraint: alpha, and the numbers of the node's bases.
pub(super) fn matrix(physics: &ConstraintPhysics, nodes: &[NodeReduction]) -> Arc<Program> {
    let layout = ConstraintLayout::of(physics);
    let code = nodes.iter().map(|node| node.code());
    let extra = layout.extra() - layout.a() + 1 + Columns::numbers(nodes);
    physics.formula().sparse_program(("node matrix", code.collect()), extra, |graph, inputs, outputs| {
        let (alpha, numbers) = (inputs[layout.extra()], &inputs[layout.extra() + 1..]);
        let columns_of = Columns::new(graph, nodes, numbers);
        let q = &inputs[layout.n..2 * layout.n];
        let reaction = graph.reverse(outputs, &inputs[layout.mu()..layout.scale()], q);
        let (zero, size) = (graph.zero(), Columns::count(nodes));
        let mut block = vec![zero; size * size];
        for (column, target) in block.chunks_exact_mut(size).enumerate() {
            let seeds = columns_of.seeds(graph, column, [zero, zero, alpha], [false, false, true], |_, dof| q[dof]);
            let moved = graph.forward(&reaction, &seeds);
            columns_of.reduce(graph, &moved, target);
        }
        block
    })
}

/// Gradients towards (a, v, q) of lambda_F . A^T mu and of the equations, whose adjoints are such that the gradient with
/// respect to the node's unknowns vanishes along the directions that were eliminated, x_bar + J^T lambda + C^T lambda_G = 0. The gradient of
/// reactions comes last and alone where these act at another point, which the unknowns do not move.
///
/// Behind the arguments of a constraint: (gamma, beta, alpha) of elements and of constraints; lambda_F, the adjoints of x, and
/// products towards (a, v, q) of elements and of constraints.
pub(super) fn products(
    physics: &ConstraintPhysics,
    layout: ConstraintLayout,
    asked: Asked,
    parts_reactions: bool,
) -> Arc<Program> {
    let n = layout.n;
    let key = ("node products", asked.code().chain([u32::from(parts_reactions)]).collect());
    program(physics, layout, key, 6 + 8 * n, |graph, inputs, outputs| {
        let Parts { reactions, equations } = Parts::new(graph, (inputs, outputs), layout, (asked, physics));
        let (rates, lists) = inputs[layout.extra()..].split_at(6);
        let (lambda, lists) = lists.split_at(n);
        let (unknowns, seeds) = lists.split_at(n);
        let curvature = graph.reverse(&reactions, lambda, &inputs[n..2 * n]);
        let mut seeds = seeds.to_vec();
        if !parts_reactions {
            (0..n).for_each(|dof| seeds[5 * n + dof] = graph.add(seeds[5 * n + dof], curvature[dof]));
        }
        // what is left of the adjoints along the eliminated directions belongs to the equations inside the node
        let mut left = Vec::new();
        for (place, &own) in unknowns.iter().enumerate() {
            let moved = (0..3).flat_map(|kind| [kind, 3 + kind]);
            left.push(moved.fold(own, |sum, kind| {
                let term = graph.mul(rates[kind], seeds[kind * n + place]);
                graph.add(sum, term)
            }));
        }
        let columns = columns_of(graph, (inputs, layout), &equations, &rates[3..]);
        let along: Vec<Node> = (0..equations.len())
            .map(|row| {
                let row: Vec<Node> = columns.iter().map(|column| column[row]).collect();
                combined(graph, &row, &left)
            })
            .collect();
        let multipliers = balancing(graph, &columns, &along);
        let mut results = graph.reverse(&equations, &multipliers, &motion(inputs, layout));
        if parts_reactions {
            results.extend(&curvature);
        } else {
            results[2 * n..].iter_mut().zip(&curvature).for_each(|(own, &more)| *own = graph.add(*own, more));
        }
        results
    })
}

/// (a, v, q).
fn motion(inputs: &[Node], layout: ConstraintLayout) -> Vec<Node> {
    [layout.a(), 0, layout.n].iter().flat_map(|&first| &inputs[first..first + layout.n]).copied().collect()
}

/// C, column by column.
fn columns_of(
    graph: &mut Graph,
    (inputs, layout): (&[Node], ConstraintLayout),
    equations: &[Node],
    rates: &[Node],
) -> Vec<Vec<Node>> {
    let (n, motion) = (layout.n, motion(inputs, layout));
    let column = |column: usize| {
        let seeds: Vec<_> = (0..3).map(|kind| (motion[kind * n + column], rates[kind])).collect();
        graph.forward(equations, &seeds)
    };
    (0..n).map(column).collect()
}

/// Sum of products.
fn combined(graph: &mut Graph, numbers: &[Node], weights: &[Node]) -> Node {
    let zero = graph.zero();
    numbers.iter().zip(weights).fold(zero, |sum, (&number, &weight)| {
        let term = graph.mul(number, weight);
        graph.add(sum, term)
    })
}

/// Multipliers m with C C^T m + r = 0, for C column by column.
fn balancing(graph: &mut Graph, columns: &[Vec<Node>], r: &[Node]) -> Vec<Node> {
    let count = r.len();
    let numbers: Vec<Node> = columns.iter().flatten().chain(r).copied().collect();
    continued(graph, &numbers, |numbers| {
        let (columns, r) = numbers.split_at(numbers.len() - count);
        let dot = |i: usize, j: usize| columns.chunks_exact(count).map(|column| column[i] * column[j]).sum::<Recorded>();
        let mut normal: Vec<Recorded> = (0..count * count).map(|place| dot(place / count, place % count)).collect();
        let mut multipliers: Vec<Recorded> = r.iter().map(|&r| -r).collect();
        solve_positive(&mut normal, &mut multipliers);
        multipliers
    })
}

/// Solves a small symmetric positive system in place by elimination.
fn solve_positive<S: Scalar>(matrix: &mut [S], rhs: &mut [S]) {
    let n = rhs.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = matrix[i * n + k] / matrix[k * n + k];
            for j in k..n {
                let above = matrix[k * n + j];
                matrix[i * n + j] -= factor * above;
            }
            let above = rhs[k];
            rhs[i] -= factor * above;
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            let known = rhs[j];
            rhs[k] -= matrix[k * n + j] * known;
        }
        rhs[k] /= matrix[k * n + k];
    }
}

/// The last bit of the terms of a set of equations, without their signs: of a constant and products of two each.
fn round_off(graph: &mut Graph, motion: &[Node], set: &[Node]) -> Node {
    let (zero, one) = (graph.zero(), graph.constant(1.0));
    let at_rest: Vec<(Node, Node)> = motion.iter().map(|&number| (number, zero)).collect();
    let constants = graph.substitute(set, &at_rest);
    let gradients: Vec<Node> = set.iter().flat_map(|&own| graph.reverse(&[own], &[one], motion)).collect();
    let numbers = [motion, &gradients, &constants].concat();
    let size = continued(graph, &numbers, |numbers| {
        let (motion, rest) = numbers.split_at(motion.len());
        let (gradients, constants) = rest.split_at(gradients.len());
        // both factors of a product have it in their derivative
        let terms = gradients.iter().zip(motion.iter().cycle()).map(|(&gradient, &number)| (gradient * number).abs());
        let constants = constants.iter().map(|constant| constant.abs()).sum::<Recorded>();
        vec![(terms.sum::<Recorded>() * 0.5 + constants) * f64::EPSILON]
    });
    size[0]
}

#[cfg(test)]
mod tests {
    use crate::assembly::reduction::RotationCoordinates;
    use crate::elements::NodeKind;

    #[test]
    fn turns_leave_the_equations_inside_nodes_and_rows_are_linear_in_coordinates() {
        let kinds = [NodeKind::Point, NodeKind::Body, NodeKind::Natural, NodeKind::Slope, NodeKind::Coordinates(7)];
        for kind in kinds {
            let (physics, turning) = (kind.local_constraint(), RotationCoordinates::of(kind));
            assert_eq!(physics.is_some(), turning.is_some(), "{kind:?}");
            let (Some(physics), Some(turning)) = (physics, turning) else { continue };
            let (n, count) = (kind.dofs(), physics.equation_count());
            assert_eq!(n - count, n - turning.coordinates() + 3, "as many unknowns as the equations leave");
            // for any coordinates, a pose or not: columns along rates follow from it
            let q: Vec<f64> = (0..n).map(|i| 0.3 + 0.7 * (i as f64 * 1.7).sin()).collect();
            let doubled: Vec<f64> = q.iter().map(|q| 2.0 * q).collect();
            let rows = physics.rows(&q, &[], 0.0);
            assert!(physics.rows(&doubled, &[], 0.0).iter().zip(&rows).all(|(twice, once)| *twice == 2.0 * once));
            let free = n - turning.coordinates();
            for row in rows.chunks_exact(n) {
                assert!(row[..free].iter().all(|&entry| entry == 0.0) && row[free..].iter().any(|&entry| entry != 0.0));
                for axis in 0..3 {
                    let turn = (free..n).map(|dof| row[dof] * turning.value(dof - free, axis, &q[free..]));
                    assert!(turn.sum::<f64>().abs() < 1e-15, "{kind:?}, axis {axis}");
                }
            }
        }
    }
}
