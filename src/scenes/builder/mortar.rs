//! Edges that follow faces in the mean: weights from integrals along common segments, so that constant stresses pass from one side to the other.
//!
//! An edge with shape functions N_l follows the faces that it lies on where the integral of M_k (x_edge - x_faces) along it is zero for functions
//! M_k whose sum is 1. They are polynomials on each part of the edge with integral of M_k N_l = 0 for l other than k, so that each equation
//! has one node of the edge alone: D_k x_k = sum C_ki x_i with D_k the integral of N_k and C_ki that of M_k N_i. A constant force per length, as
//! constant stresses have it on both sides, is a sum of the M_k: its nodal forces on the faces are the integrals of N_i, exactly.
//!
//! Source: Wohlmuth (2000), dual Lagrange multipliers; with the ends left out as at cross points.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::carriers::{Carriers, Sum};
use super::surface_search::{Foot, PlacedFace, Point, length};
use crate::assembly::NodeId;
use crate::elements::flexible::shape::weighed;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use smallvec::SmallVec;
use std::collections::HashMap;

/// Places of five-point Gauss quadrature between -1 and 1, with their weights.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];
/// Corrections of the place where two edges cross.
const CORRECTIONS: usize = 20;
/// Square of the sine of the angle between edges that run along each other.
const PARALLEL: f64 = 1e-8;

type Row<S> = SmallVec<[S; 3]>;

/// An edge of a face: two nodes, or three with the one in the middle.
#[derive(Clone, Debug)]
pub(super) struct TiedEdge<S> {
    pub nodes: Vec<NodeId>,
    pub places: Vec<Vector3<S>>,
}

/// A point of an edge, the foot that it has on a face, and its weight in integrals from -1 to 1.
pub(super) struct EdgePoint {
    xi: f64,
    weight: f64,
    foot: Foot,
}

impl EdgePoint {
    pub fn foot(&self) -> Foot {
        self.foot
    }
}

/// Shape functions at a place of an edge, and their derivatives.
fn on_edge(count: usize, xi: f64) -> [SmallVec<[f64; 3]>; 2] {
    match count {
        2 => [SmallVec::from_slice(&[0.5 - 0.5 * xi, 0.5 + 0.5 * xi]), SmallVec::from_slice(&[-0.5, 0.5])],
        _ => [
            SmallVec::from_slice(&[0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)]),
            SmallVec::from_slice(&[xi - 0.5, -2.0 * xi, xi + 0.5]),
        ],
    }
}

/// Legendre's polynomials up to the second degree.
fn polynomial(degree: usize, xi: f64) -> f64 {
    [1.0, xi, 1.5 * xi * xi - 0.5][degree]
}

impl<S: Scalar> TiedEdge<S> {
    fn values(&self) -> Vec<Vector3<f64>> {
        self.places.iter().map(|place| place.map(Scalar::value)).collect()
    }

    /// Distance of its ends \[m\].
    pub fn span(&self) -> f64 {
        (self.places[self.places.len() - 1] - self.places[0]).length().value()
    }

    /// Where a point of it is.
    pub fn place(&self, point: &EdgePoint) -> Vector3<S> {
        weighed(&self.places, &on_edge(self.nodes.len(), point.xi)[0])
    }

    /// Places at which the face below changes: where edges of faces cross it.
    fn ends_of_segments(&self, faces: &[PlacedFace], reach: f64) -> Vec<f64> {
        let own = self.values();
        let bound = |pick: fn(f64, f64) -> f64, axis: usize| own.iter().map(|place| place[axis]).reduce(pick).unwrap_or(0.0);
        let bulge = reach + 0.1 * (own[own.len() - 1] - own[0]).length();
        let overlaps = |face: &&PlacedFace| {
            let [least, most] = face.box_around();
            (0..3).all(|axis| bound(f64::min, axis) - bulge <= most[axis] && least[axis] <= bound(f64::max, axis) + bulge)
        };
        let mut ends = vec![-1.0, 1.0];
        for face in faces.iter().filter(overlaps) {
            for edge in face.shape.edges {
                let other: Vec<Vector3<f64>> = edge.iter().map(|&place| face.nodes[place]).collect();
                ends.extend(crossing(&own, &other, reach));
            }
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|next, before| *next - *before < crate::tolerances::SAME_VERTEX);
        // the last one is the end of the edge, whatever lies next to it
        if let Some(last) = ends.last_mut() {
            *last = 1.0;
        }
        ends
    }

    /// Points for integrals along it, each with its foot.
    ///
    /// # Errors
    /// The place of a point that lies on no face.
    pub fn points(&self, carriers: &Carriers<S>) -> Result<Vec<EdgePoint>, Point> {
        let own = self.values();
        let ends = self.ends_of_segments(carriers.surfaces.faces(), carriers.surfaces.reach());
        let mut points = Vec::new();
        for segment in ends.windows(2) {
            let [half, middle] = [0.5 * (segment[1] - segment[0]), 0.5 * (segment[0] + segment[1])];
            for (place, weight) in GAUSS {
                let xi = middle + half * place;
                let point = weighed(&own, &on_edge(own.len(), xi)[0]);
                // a face that the edge belongs to does not carry it
                let foot = carriers.surfaces.nearest(point, |face| !carriers.has(face, &self.nodes)).ok_or(point)?;
                points.push(EdgePoint { xi, weight: weight * half, foot });
            }
        }
        Ok(points)
    }

    /// Adds the integrals along it to the rows of those of its nodes that follow: D_k, and shares of what carries node k.
    pub fn add_to(
        &self,
        points: &[EdgePoint],
        carriers: &Carriers<S>,
        follows: impl Fn(NodeId) -> bool,
        rows: &mut HashMap<NodeId, (S, Sum<S>)>,
    ) {
        let following: Vec<usize> = (0..self.nodes.len()).filter(|&place| follows(self.nodes[place])).collect();
        if following.is_empty() {
            return;
        }
        let at: Vec<_> = points.iter().map(|point| on_edge(self.nodes.len(), point.xi)).collect();
        let lengths: Vec<S> =
            points.iter().zip(&at).map(|(own, [_, by])| weighed(&self.places, by).length() * own.weight).collect();
        let integral = |f: &dyn Fn(usize) -> f64| -> S {
            lengths.iter().enumerate().fold(S::zero(), |sum, (point, &length)| sum + length * f(point))
        };
        let count = following.len();
        let products: Vec<Row<S>> = following
            .iter()
            .map(|&node| {
                (0..count).map(|n| integral(&|point| polynomial(n, points[point].xi) * at[point][0][node])).collect()
            })
            .collect();
        for (place, &node) in following.iter().enumerate() {
            let own = integral(&|point| at[point][0][node]);
            let wanted: Row<S> = (0..count).map(|other| if other == place { own } else { S::zero() }).collect();
            let coefficients = solved(products.clone(), wanted);
            let (diagonal, sum) = rows.entry(self.nodes[node]).or_insert_with(|| (S::zero(), Sum::default()));
            *diagonal += own;
            for (point, (EdgePoint { xi, foot, .. }, &length)) in points.iter().zip(&lengths).enumerate() {
                let multiplier = (0..count).fold(S::zero(), |sum, n| sum + coefficients[n] * polynomial(n, *xi)) * length;
                let [values, _] = &at[point];
                for (node, weight) in carriers.shares(*foot, weighed(&self.places, values)) {
                    sum.add(node, weight * multiplier);
                }
                // nodes that do not follow belong to the other side
                for other in (0..self.nodes.len()).filter(|other| !following.contains(other)) {
                    sum.add(self.nodes[other], multiplier * -values[other]);
                }
            }
        }
    }
}

/// Solution of a few equations.
fn solved<S: Scalar>(mut matrix: Vec<Row<S>>, mut right: Row<S>) -> Row<S> {
    let count = right.len();
    for k in 0..count {
        let size = |row: usize| matrix[row][k].value().abs();
        let pivot = (k..count).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(k);
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        for row in k + 1..count {
            let factor = matrix[row][k] / matrix[k][k];
            for column in k..count {
                let above = matrix[k][column];
                matrix[row][column] -= above * factor;
            }
            let above = right[k];
            right[row] -= above * factor;
        }
    }
    for k in (0..count).rev() {
        for column in k + 1..count {
            let known = right[column];
            right[k] -= matrix[k][column] * known;
        }
        right[k] /= matrix[k][k];
    }
    right
}

/// Where another edge crosses an edge, inside it.
fn crossing(own: &[Vector3<f64>], other: &[Vector3<f64>], reach: f64) -> Option<f64> {
    let at = |nodes: &[Vector3<f64>], xi: f64| on_edge(nodes.len(), xi).map(|weights| weighed(nodes, &weights));
    let (mut xi, mut eta) = (0.0, 0.0_f64);
    for _ in 0..CORRECTIONS {
        let ([x, first], [y, second]) = (at(own, xi), at(other, eta));
        let gap = x - y;
        let [a, b, d] = [first.dot(&first), -first.dot(&second), second.dot(&second)];
        let determinant = a * d - b * b;
        if determinant < PARALLEL * a * d {
            return None;
        }
        let [r, s] = [first.dot(&gap), -second.dot(&gap)];
        eta = (eta - (a * s - b * r) / determinant).clamp(-1.0, 1.0);
        // next to an end of the other one
        let [y, _] = at(other, eta);
        let [x, first] = at(own, xi);
        xi -= first.dot(&(x - y)) / first.dot(&first);
        xi = xi.clamp(-2.0, 2.0);
    }
    let gap = at(own, xi)[0] - at(other, eta)[0];
    (xi.abs() < 1.0 && length(gap) <= reach).then_some(xi)
}
