//! Elements of third order and higher, lowered to second: shells have faces with one node in the middle of an edge.

use super::kinds::Kind;
use std::collections::HashMap;

/// Middles of edges that no node of the file stands on, by the ends of their edges, the smaller first.
#[derive(Default)]
pub(super) struct Lowered {
    middles: HashMap<[usize; 2], usize>,
}

impl Lowered {
    /// The points of an element of second order through those of one of a higher order; the middle of an edge with an odd number of parts is
    /// a new point of the curve through its nodes, in common with the neighbours, and the middle of a quadrilateral one of its surface.
    ///
    /// Gmsh lists the corners, then the nodes inside each edge, then those inside as an element of an order that is less by 2 (by 3 in triangles).
    pub fn lower(&mut self, kind: Kind, own: &[usize], points: &mut Vec<[f64; 3]>) -> Vec<usize> {
        let Kind { corners, order, .. } = kind;
        let mut lowered = own[..corners].to_vec();
        let edges = if kind.dimension == 1 { 1 } else { corners };
        for k in 0..edges {
            let ends = [own[k], own[(k + 1) % corners]];
            let inside = &own[corners + k * (order - 1)..corners + (k + 1) * (order - 1)];
            lowered.push(if order % 2 == 0 {
                inside[order / 2 - 1]
            } else {
                let along = [&ends[..1], inside, &ends[1..]].concat();
                let weighed = along.into_iter().zip((0..=order).map(|i| at_middle(order, i)));
                let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                *self.middles.entry(key).or_insert_with(|| added(weighed, points))
            });
        }
        if kind.dimension == 2 && corners == 4 && kind.is_complete() {
            lowered.push(if order % 2 == 0 {
                own[own.len() - 1]
            } else {
                let weight = |[i, j]: [usize; 2]| at_middle(order, i) * at_middle(order, j);
                added(own.iter().copied().zip(places(order, 0).into_iter().map(weight)), points)
            });
        }
        lowered
    }
}

/// A new point, the weighed sum of others.
fn added(weighed: impl Iterator<Item = (usize, f64)>, points: &mut Vec<[f64; 3]>) -> usize {
    let sum = |sum: [f64; 3], (point, weight): (usize, f64)| [0, 1, 2].map(|axis| sum[axis] + weight * points[point][axis]);
    let place = weighed.fold([0.0; 3], sum);
    points.push(place);
    points.len() - 1
}

/// The polynomial that is 1 at node i of an edge with `order` equal parts and 0 at the others, at its middle.
fn at_middle(order: usize, i: usize) -> f64 {
    let other = (0..=order).filter(|j| *j != i).map(|j| j as f64);
    other.map(|j| (0.5 * order as f64 - j) / (i as f64 - j)).product()
}

/// Where the nodes of a complete quadrilateral stand in the grid of its nodes, in their order.
fn places(order: usize, from: usize) -> Vec<[usize; 2]> {
    let to = from + order;
    match order {
        0 => vec![[from; 2]],
        _ => {
            let corners = [[from, from], [to, from], [to, to], [from, to]];
            let edges = [
                (from + 1..to).map(|i| [i, from]).collect::<Vec<_>>(),
                (from + 1..to).map(|j| [to, j]).collect(),
                (from + 1..to).rev().map(|i| [i, to]).collect(),
                (from + 1..to).rev().map(|j| [from, j]).collect(),
            ];
            let inside = if order == 1 { Vec::new() } else { places(order - 2, from + 1) };
            corners.into_iter().chain(edges.into_iter().flatten()).chain(inside).collect()
        }
    }
}
