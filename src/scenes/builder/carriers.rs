//! Faces that carry nodes: the places on them that are nearest to points, with weights that follow moving nodes.

use super::surface_search::{Foot, PlacedFace, Surfaces, shape_functions};
use super::{MechanismBuilder, MeshedShell};
use crate::assembly::NodeId;
use crate::elements::flexible::faces::{FaceShape, MOST_NODES};
use crate::elements::flexible::shape::weighed;
use crate::scalar::{Scalar, Vector3};
use crate::tolerances::{ROUND_OFF, SAME_VERTEX};
use smallvec::SmallVec;
use std::collections::HashMap;

/// Weights of this size are those of nodes that a place has nothing to do with.
const NO_WEIGHT: f64 = 10.0 * ROUND_OFF;
/// Newton's corrections of a place that is nearly right.
const CORRECTIONS: usize = 6;

/// Weights of nodes.
pub(super) type Shares<S> = Vec<(NodeId, S)>;

/// Faces of shells that carry nodes of others.
pub(super) struct Carriers<S> {
    pub surfaces: Surfaces,
    /// Nodes of each face with their places.
    faces: Vec<Vec<(NodeId, Vector3<S>)>>,
    shells: Vec<String>,
    /// Place of its shell among `shells`, for each face.
    shell_of: Vec<usize>,
}

impl<S: Scalar> Carriers<S> {
    /// Those of some shells, which points find that are up to `reach` \[m\] away.
    pub fn new(m: &MechanismBuilder<S>, shells: &[&MeshedShell], reach: f64) -> Self {
        let (mut placed, mut faces, mut shell_of) = (Vec::new(), Vec::new(), Vec::new());
        for (number, shell) in shells.iter().enumerate() {
            for (kind, nodes) in shell.faces() {
                let own: Vec<(NodeId, Vector3<S>)> = nodes.iter().map(|&node| (node, m.position(node))).collect();
                let nodes = own.iter().map(|(_, place)| place.map(Scalar::value)).collect();
                placed.push(PlacedFace { shape: kind.face.shape(), nodes });
                faces.push(own);
                shell_of.push(number);
            }
        }
        let shells = shells.iter().map(|shell| shell.name.clone()).collect();
        Carriers { surfaces: Surfaces::new(placed, reach), faces, shells, shell_of }
    }
    /// Name of the shell of a face.
    pub fn shell_of(&self, face: usize) -> &str {
        &self.shells[self.shell_of[face]]
    }
    /// All their nodes.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> {
        self.faces.iter().flatten().map(|own| own.0)
    }
    /// Whether all of some nodes are nodes of a face.
    pub fn has(&self, face: usize, nodes: &[NodeId]) -> bool {
        nodes.iter().all(|node| self.faces[face].iter().any(|own| own.0 == *node))
    }

    /// Weights of the nodes of a face at its place nearest to a point, which was found to be near `foot`. They follow the place as the nodes and
    /// the point move: to first order, which is what derivatives need.
    pub fn shares(&self, foot: Foot, point: Vector3<S>) -> Shares<S> {
        let face = &self.surfaces.faces()[foot.face];
        let nodes: Vec<Vector3<S>> = self.faces[foot.face].iter().map(|own| own.1).collect();
        let fixed: Vec<Vector3<f64>> = nodes.iter().map(|node| node.map(Scalar::value)).collect();
        let mut at = snapped(face, foot.at);
        let directions = free_directions(face, at);
        for _ in 0..CORRECTIONS {
            let near = Near::new(face.shape, at, &directions);
            let by = near.correction(&fixed, &fixed, point.map(Scalar::value));
            let moved = directions.iter().zip(&by).fold(at, |at, (way, &by)| [at[0] + way[0] * by, at[1] + way[1] * by]);
            at = face.inside(moved);
        }
        let near = Near::new(face.shape, at, &directions);
        let by = near.correction(&nodes, &fixed, point);
        let mut shares = Vec::new();
        for (place, &(node, _)) in self.faces[foot.face].iter().enumerate() {
            let slopes = || near.slopes.iter().map(|own| own[place]);
            if near.values[place].abs() < NO_WEIGHT && slopes().all(|slope| slope.abs() < NO_WEIGHT) {
                continue;
            }
            let weight = slopes().zip(&by).fold(S::from(near.values[place]), |sum, (slope, &by)| sum + by * slope);
            shares.push((node, weight));
        }
        shares
    }
}

/// The place, on the edge if it is next to it: there it stays while nodes move.
fn snapped(face: &PlacedFace, [r, s]: [f64; 2]) -> [f64; 2] {
    if face.is_triangle() {
        let [r, s] = [r, s].map(|x| if x < SAME_VERTEX { 0.0 } else { x });
        return if 1.0 - r - s < SAME_VERTEX { [r / (r + s), s / (r + s)] } else { [r, s] };
    }
    [r, s].map(|x| if 1.0 - x.abs() < SAME_VERTEX { x.signum() } else { x })
}

/// Directions in (r, s) in which a place may move: along the edge where it is on one.
fn free_directions(face: &PlacedFace, [r, s]: [f64; 2]) -> SmallVec<[[f64; 2]; 2]> {
    let mut ways: SmallVec<[[f64; 2]; 2]> = SmallVec::new();
    if face.is_triangle() {
        let on = [s == 0.0, r == 0.0, 1.0 - r - s < SAME_VERTEX];
        match on {
            [false, false, false] => ways.extend([[1.0, 0.0], [0.0, 1.0]]),
            [true, false, false] => ways.push([1.0, 0.0]),
            [false, true, false] => ways.push([0.0, 1.0]),
            [false, false, true] => ways.push([-1.0, 1.0]),
            _ => {}
        }
    } else {
        [([1.0, 0.0], r), ([0.0, 1.0], s)].into_iter().filter(|own| own.1.abs() < 1.0).for_each(|own| ways.push(own.0));
    }
    ways
}

/// Shape functions at a place, with their derivatives along some directions.
struct Near {
    values: SmallVec<[f64; MOST_NODES]>,
    slopes: Vec<SmallVec<[f64; MOST_NODES]>>,
    /// Second derivatives along pairs of directions.
    bends: Vec<Vec<SmallVec<[f64; MOST_NODES]>>>,
}

impl Near {
    fn new(shape: &FaceShape, [r, s]: [f64; 2], directions: &[[f64; 2]]) -> Self {
        let [values, ..] = shape_functions(shape, [r, s]);
        // differences of polynomials of second degree are exact
        let slope_at = |r: f64, s: f64, way: &[f64; 2]| -> SmallVec<[f64; MOST_NODES]> {
            let [_, by_r, by_s] = shape_functions(shape, [r, s]);
            by_r.iter().zip(&by_s).map(|(r, s)| r * way[0] + s * way[1]).collect()
        };
        let bend = |first: &[f64; 2], second: &[f64; 2]| {
            let [after, before] = [1.0, -1.0].map(|step| slope_at(r + step * second[0], s + step * second[1], first));
            after.iter().zip(&before).map(|(a, b)| 0.5 * (a - b)).collect()
        };
        let bends = directions.iter().map(|first| directions.iter().map(|second| bend(first, second)).collect());
        let slopes = directions.iter().map(|way| slope_at(r, s, way)).collect();
        Near { slopes, bends: bends.collect(), values }
    }

    /// By how much along each direction the foot of a point is away; the matrix is that of the places where nodes stand.
    fn correction<T: Scalar>(&self, nodes: &[Vector3<T>], fixed: &[Vector3<f64>], point: Vector3<T>) -> SmallVec<[T; 2]> {
        let gap = weighed(nodes, &self.values) - point;
        let towards: SmallVec<[T; 2]> = self.slopes.iter().map(|own| weighed(nodes, own).dot(&gap)).collect();
        let (tangents, off): (Vec<Vector3<f64>>, _) =
            (self.slopes.iter().map(|own| weighed(fixed, own)).collect(), gap.map(Scalar::value));
        let entry = |i: usize, j: usize| tangents[i].dot(&tangents[j]) + weighed(fixed, &self.bends[i][j]).dot(&off);
        match towards[..] {
            [first] => SmallVec::from_slice(&[first * (-1.0 / entry(0, 0))]),
            [first, second] => {
                let [[a, b], [c, d]] = [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]];
                let factor = -1.0 / (a * d - b * c);
                SmallVec::from_slice(&[(first * d - second * b) * factor, (second * a - first * c) * factor])
            }
            _ => SmallVec::new(),
        }
    }
}

/// Adds shares to those that are there, in the order in which nodes come first.
pub(super) struct Sum<S> {
    pub shares: Shares<S>,
    places: HashMap<NodeId, usize>,
}

impl<S: Scalar> Default for Sum<S> {
    fn default() -> Self {
        Sum { shares: Vec::new(), places: HashMap::new() }
    }
}

impl<S: Scalar> Sum<S> {
    pub fn add(&mut self, node: NodeId, weight: S) {
        let place = *self.places.entry(node).or_insert(self.shares.len());
        match self.shares.get_mut(place) {
            Some(own) => own.1 += weight,
            None => self.shares.push((node, weight)),
        }
    }
    /// All of them with a factor.
    pub fn scaled(self, factor: S) -> Shares<S> {
        self.shares.into_iter().map(|(node, weight)| (node, weight * factor)).collect()
    }
}
