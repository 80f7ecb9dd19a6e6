//! Meshes of shells: a grid of nodes on a surface, two for each element and one, along each of its two directions.

use crate::assembly::NodeId;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use std::f64::consts::FRAC_PI_4;

/// One of the four edges of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Where the first direction starts.
    FirstStart,
    /// Where it ends.
    FirstEnd,
    /// Where the second direction starts.
    SecondStart,
    /// Where it ends.
    SecondEnd,
}

/// A grid of nine-node elements on a surface at t = 0, in the world: positions \[m\] and unit normals of its nodes.
///
/// Node (i, j) is the i-th along the first direction and the j-th along the second; elements lie between nodes of even numbers. The normal
/// points to where the first direction is turned to the second counterclockwise.
#[derive(Clone, Debug)]
pub struct ShellMesh<S> {
    /// Elements along both directions.
    pub(super) elements: [usize; 2],
    pub(super) points: Vec<Vector3<S>>,
    pub(super) normals: Vec<Vector3<S>>,
    /// The first direction ends in the nodes where it starts.
    pub(super) closed: bool,
    /// Nodes that never move.
    pub(super) clamped: Vec<usize>,
    /// Nodes that are there already.
    pub(super) given: Vec<(usize, NodeId)>,
    /// Damping proportional to stiffness \[s\].
    pub(super) damping: Option<S>,
}

impl<S: Scalar> ShellMesh<S> {
    /// Nodes on a surface: positions \[m\] and normals, not zero, for shares (u, v) of both directions, from 0 to 1.
    pub fn on(elements: [usize; 2], surface: impl Fn(f64, f64) -> [Vector3<S>; 2]) -> Self {
        let last = elements.map(|count| 2 * count);
        let share = |place: usize, last: usize| place as f64 / last.max(1) as f64;
        let places = (0..=last[1]).flat_map(|j| (0..=last[0]).map(move |i| (i, j)));
        let (points, normals) = places
            .map(|(i, j)| {
                let [point, normal] = surface(share(i, last[0]), share(j, last[1]));
                (point, normal.unit())
            })
            .unzip();
        ShellMesh { elements, points, normals, closed: false, clamped: Vec::new(), given: Vec::new(), damping: None }
    }

    /// A flat plate: a corner \[m\] and the edges that start there \[m\].
    pub fn plate(corner: Vector3<S>, [first, second]: [Vector3<S>; 2], elements: [usize; 2]) -> Self {
        let normal = first.cross(&second);
        Self::on(elements, |u, v| [corner + first * S::from(u) + second * S::from(v), normal])
    }

    /// A part of a circular cylinder: an edge line starts at `from` and goes along `along` \[m\] in the second direction, and is turned
    /// about the unit vector `axis` through `centre` by `angle` \[rad\] in the first. Its normal points away from the axis if
    /// `along` points along it and the angle is positive.
    pub fn cylinder(
        [from, along]: [Vector3<S>; 2],
        [centre, axis]: [Vector3<S>; 2],
        angle: S,
        elements: [usize; 2],
    ) -> Self {
        Self::on(elements, |u, v| {
            let turn = Quaternion::about(axis, angle * u);
            let arm = from - centre;
            let radial = arm - axis * axis.dot(&arm);
            let tangent = axis.cross(&radial) * angle;
            [centre + turn.rotate(arm) + along * S::from(v), turn.rotate(tangent.cross(&along))]
        })
    }

    /// A patch of a sphere about `centre` \[m\] between two longitudes and two latitudes \[rad\] about z; normals point outwards.
    pub fn sphere(centre: Vector3<S>, radius: S, longitude: [S; 2], latitude: [S; 2], elements: [usize; 2]) -> Self {
        let between = |[from, to]: [S; 2], share: f64| from + (to - from) * share;
        Self::on(elements, |u, v| {
            let ((sin_u, cos_u), (sin_v, cos_v)) = (between(longitude, u).sin_cos(), between(latitude, v).sin_cos());
            let direction = Vector3::new(cos_u * cos_v, sin_u * cos_v, sin_v);
            [centre + direction * radius, direction]
        })
    }

    /// One of the six parts of a sphere that the faces of a cube make, seen from its centre \[m\]: two unit vectors at right angles along
    /// the edges of the face, by equal angles; normals point outwards. [`joined`](super::MechanismBuilder::joined), six make a sphere without poles.
    pub fn sphere_face(centre: Vector3<S>, radius: S, [first, second]: [Vector3<S>; 2], elements: [usize; 2]) -> Self {
        let outwards = first.cross(&second);
        let tangent = |share: f64| S::from((FRAC_PI_4 * (2.0 * share - 1.0)).tan());
        Self::on(elements, |u, v| {
            let direction = (outwards + first * tangent(u) + second * tangent(v)).unit();
            [centre + direction * radius, direction]
        })
    }

    /// The first direction goes around and ends in the nodes where it started: a tube.
    #[must_use]
    pub fn closed(mut self) -> Self {
        self.closed = true;
        self
    }
    /// Damping proportional to stiffness: strain rates times eta \[s\] add to the strains in all stresses.
    #[must_use]
    pub fn damped(mut self, damping: S) -> Self {
        self.damping = Some(damping);
        self
    }
    /// The nodes of an edge never move.
    #[must_use]
    pub fn clamped(mut self, edge: Edge) -> Self {
        let nodes = self.places(edge);
        self.clamped.extend(nodes);
        self
    }
    /// Node (i, j) is one that is there: of another shell, a beam or a rigid body, with its frame at this place.
    #[must_use]
    pub fn with_node(mut self, i: usize, j: usize, node: NodeId) -> Self {
        let place = self.place(i, j);
        self.given.push((place, node));
        self
    }
    /// The nodes of an edge are those that are there, in this order.
    #[must_use]
    pub fn with_edge(mut self, edge: Edge, nodes: &[NodeId]) -> Self {
        let places = self.places(edge);
        self.given.extend(places.into_iter().zip(nodes.iter().copied()));
        self
    }
    /// Moves the nodes, from position and number (i, j) to another position \[m\]; normals stay.
    #[must_use]
    pub fn moved(mut self, to: impl Fn(Vector3<S>, usize, usize) -> Vector3<S>) -> Self {
        let width = 2 * self.elements[0] + 1;
        for (place, point) in self.points.iter_mut().enumerate() {
            *point = to(*point, place % width, place / width);
        }
        self
    }

    /// Number of node (i, j) in the lists.
    pub(super) fn place(&self, i: usize, j: usize) -> usize {
        let last = 2 * self.elements[0];
        let i = if self.closed && i == last { 0 } else { i };
        i + j * (last + 1)
    }
    /// Numbers of the nodes of an edge.
    pub(super) fn places(&self, edge: Edge) -> Vec<usize> {
        let [first, second] = self.elements.map(|count| 2 * count);
        match edge {
            Edge::FirstStart => (0..=second).map(|j| self.place(0, j)).collect(),
            Edge::FirstEnd => (0..=second).map(|j| self.place(first, j)).collect(),
            Edge::SecondStart => (0..=first).map(|i| self.place(i, 0)).collect(),
            Edge::SecondEnd => (0..=first).map(|i| self.place(i, second)).collect(),
        }
    }
}
