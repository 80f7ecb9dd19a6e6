//! Meshes of shells: a grid of nodes on a surface, two for each element and one, along each of its two directions.

use super::SurfaceMesh;
use super::free_mesh::{FreeMesh, Grid, MeshFace};
use super::shells::{MeshedShell, ShellMember};
use crate::assembly::NodeId;
use crate::elements::flexible::faces::FaceKind;
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

impl Edge {
    /// Their names, in this order.
    pub(crate) const NAMES: [&str; 4] = ["first_start", "first_end", "second_start", "second_end"];

    /// What stands along it on a grid of so many elements, from places (i, j).
    pub(super) fn along<T>(self, elements: [usize; 2], at: impl Fn(usize, usize) -> T) -> Vec<T> {
        let [first, second] = elements.map(|count| 2 * count);
        match self {
            Edge::FirstStart => (0..=second).map(|j| at(0, j)).collect(),
            Edge::FirstEnd => (0..=second).map(|j| at(first, j)).collect(),
            Edge::SecondStart => (0..=first).map(|i| at(i, 0)).collect(),
            Edge::SecondEnd => (0..=first).map(|i| at(i, second)).collect(),
        }
    }

    /// The one of a name.
    #[cfg(feature = "files")]
    pub(crate) fn named(name: &str) -> Self {
        let all = [Edge::FirstStart, Edge::FirstEnd, Edge::SecondStart, Edge::SecondEnd];
        all[Self::NAMES.iter().position(|own| *own == name).unwrap_or(3)]
    }
}

/// A grid of nine-node elements on a surface at t = 0, in the world: positions \[m\] and unit normals of its nodes. With
/// [`with_faces`](ShellMesh::with_faces) each makes room for four quadrilaterals of four nodes or for two triangles of six.
///
/// Node (i, j) is the i-th along the first direction and the j-th along the second; elements lie between nodes of even numbers. The normal
/// points to where the first direction is turned to the second counterclockwise.
#[derive(Clone, Debug)]
pub struct ShellMesh<S> {
    /// Elements along both directions.
    elements: [usize; 2],
    /// What each nine nodes are made of.
    kind: FaceKind,
    /// The first direction ends in the nodes where it starts.
    closed: bool,
    /// Points and what is said of them; their faces follow from the grid.
    free: FreeMesh<S>,
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
        let mut free = FreeMesh::of_points(points);
        free.normals = Some(normals);
        ShellMesh { elements, kind: FaceKind::Quad9, closed: false, free }
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
    /// The same nodes with faces of another kind: in place of each nine-node element four quadrilaterals of four nodes, or two triangles of
    /// six, divided from its first node to its last.
    #[must_use]
    pub fn with_faces(mut self, kind: FaceKind) -> Self {
        self.kind = kind;
        self
    }
    /// Damping proportional to stiffness: strain rates times eta \[s\] add to the strains in all stresses.
    #[must_use]
    pub fn damped(mut self, damping: S) -> Self {
        self.free.damping = Some(damping);
        self
    }
    /// The nodes of an edge never move.
    #[must_use]
    pub fn clamped(mut self, edge: Edge) -> Self {
        let nodes = self.places(edge);
        self.free.clamped.extend(nodes);
        self
    }
    /// Node (i, j) is one that is there: of another shell, a beam or a rigid body, with its frame at this place.
    #[must_use]
    pub fn with_node(mut self, i: usize, j: usize, node: NodeId) -> Self {
        let place = self.place(i, j);
        self.free.given.push((place, node));
        self
    }
    /// Nodes may stand at the same place, or on other elements, where these are not to be joined: a slit.
    #[must_use]
    pub fn with_coincident_points(mut self) -> Self {
        self.free.may_coincide = true;
        self
    }
    /// The nodes of an edge are those that are there, in this order.
    #[must_use]
    pub fn with_edge(mut self, edge: Edge, nodes: &[NodeId]) -> Self {
        let places = self.places(edge);
        if places.len() != nodes.len() {
            let why = format!("has {} nodes on an edge that is given {}; give one for each", places.len(), nodes.len());
            self.free.refuse(why);
        }
        self.free.given.extend(places.into_iter().zip(nodes.iter().copied()));
        self
    }
    /// Moves the nodes, from position and number (i, j) to another position \[m\]; normals stay.
    #[must_use]
    pub fn moved(mut self, to: impl Fn(Vector3<S>, usize, usize) -> Vector3<S>) -> Self {
        let width = 2 * self.elements[0] + 1;
        for (place, point) in self.free.points.iter_mut().enumerate() {
            *point = to(*point, place % width, place / width);
        }
        self
    }

    /// Number of node (i, j) in the lists.
    fn place(&self, i: usize, j: usize) -> usize {
        let last = 2 * self.elements[0];
        let i = if self.closed && i == last { 0 } else { i };
        i + j * (last + 1)
    }
    /// Numbers of the nodes of an edge.
    fn places(&self, edge: Edge) -> Vec<usize> {
        edge.along(self.elements, |i, j| self.place(i, j))
    }
    /// Nodes (a, b) of the faces among nine.
    fn division(&self) -> &'static [&'static [[usize; 2]]] {
        match self.kind {
            FaceKind::Quad9 => &[&[[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [0, 2], [1, 2], [2, 2]]],
            FaceKind::Quad4 => &[
                &[[0, 0], [1, 0], [0, 1], [1, 1]],
                &[[1, 0], [2, 0], [1, 1], [2, 1]],
                &[[0, 1], [1, 1], [0, 2], [1, 2]],
                &[[1, 1], [2, 1], [1, 2], [2, 2]],
            ],
            FaceKind::Triangle6 => {
                &[&[[0, 0], [2, 0], [2, 2], [1, 0], [2, 1], [1, 1]], &[[0, 0], [2, 2], [0, 2], [1, 1], [1, 2], [0, 1]]]
            }
        }
    }
    /// Place (i, j) of a node of a face.
    fn grid_place(&self, face: usize, node: usize) -> [usize; 2] {
        let division = self.division();
        let (cell, part) = (face / division.len(), face % division.len());
        let [a, b] = division[part][node];
        [2 * (cell % self.elements[0]) + a, 2 * (cell / self.elements[0]) + b]
    }
}

impl<S: Scalar> SurfaceMesh<S> for ShellMesh<S> {
    type Member = ShellMember;
    type Place = [f64; 2];

    fn free(&self) -> FreeMesh<S> {
        let mut free = self.free.clone();
        let ([first, second], parts) = (self.elements, self.division().len());
        free.grid = Some(Grid { columns: first, parts });
        if first == 0 || second == 0 {
            free.unjoined = Some(format!("has {first} x {second} elements; a shell needs at least 1 x 1"));
        }
        let face = |face: usize| {
            let point = |node: usize| {
                let [i, j] = self.grid_place(face, node);
                self.place(i, j)
            };
            MeshFace { kind: self.kind, points: (0..self.kind.shape().nodes).map(point).collect() }
        };
        free.faces = (0..first * second * parts).map(face).collect();
        free
    }
    fn free_mut(&mut self) -> &mut FreeMesh<S> {
        &mut self.free
    }
    fn place(&self, face: usize, node: usize) -> [f64; 2] {
        let last = self.elements.map(|count| (2 * count).max(1) as f64);
        let [i, j] = self.grid_place(face, node);
        [i as f64 / last[0], j as f64 / last[1]]
    }
    fn lines(&self) -> Vec<Vec<usize>> {
        if self.kind != FaceKind::Quad9 {
            return self.free().lines();
        }
        let [first, second] = self.elements.map(|count| 2 * count);
        let lines = (0..=second).step_by(2).map(|j| (0..=first).map(|i| self.place(i, j)).collect());
        let across = (0..=first).step_by(2).map(|i| (0..=second).map(|j| self.place(i, j)).collect());
        lines.chain(across).collect()
    }
    fn member(self, shell: MeshedShell) -> ShellMember {
        let [first, second] = self.elements.map(|count| 2 * count);
        let places = (0..=second).flat_map(|j| (0..=first).map(move |i| (i, j)));
        let nodes = places.filter_map(|(i, j)| shell.node(self.place(i, j))).collect();
        ShellMember { counts: self.elements, nodes, parts: self.division().len(), shell }
    }
}
