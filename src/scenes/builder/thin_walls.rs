//! Members of thin walls: straight walls between the corners of a profile, drawn along a line.

use super::{Edge, MechanismBuilder, MeshedShell, ShellMember, ShellMesh};
use crate::assembly::NodeId;
use crate::elements::flexible::Material;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};

/// A profile of thin walls: the middle lines of its walls between corners, in the plane of two axes \[m\].
#[derive(Clone, Debug)]
pub struct Profile<S> {
    corners: Vec<[S; 2]>,
    /// From corner to corner, with the number of elements between.
    walls: Vec<([usize; 2], usize)>,
}

impl<S: Scalar> Profile<S> {
    /// Walls from corner to corner, each with its number of elements.
    pub fn new(corners: Vec<[S; 2]>, walls: Vec<([usize; 2], usize)>) -> Self {
        Profile { corners, walls }
    }
    /// A rectangular tube about the origin with two sizes of its middle lines, along axes 1 and 2; normals point outwards.
    pub fn box_tube([width, height]: [S; 2], [across, up]: [usize; 2]) -> Self {
        let (x, y) = (width * 0.5, height * 0.5);
        let corners = vec![[-x, -y], [x, -y], [x, y], [-x, y]];
        Self::new(corners, vec![([0, 1], across), ([1, 2], up), ([2, 3], across), ([3, 0], up)])
    }
    /// Two flanges of equal width along axis 1 and a web between their middles along axis 2.
    pub fn i_section([width, height]: [S; 2], [half_flange, web]: [usize; 2]) -> Self {
        let (x, y, zero) = (width * 0.5, height * 0.5, S::zero());
        let corners = vec![[-x, -y], [zero, -y], [x, -y], [-x, y], [zero, y], [x, y]];
        let flanges = [[0, 1], [1, 2], [3, 4], [4, 5]].map(|wall| (wall, half_flange));
        Self::new(corners, flanges.into_iter().chain([([1, 4], web)]).collect())
    }
}

/// How a profile is drawn along a straight line.
#[derive(Clone, Debug)]
pub struct Extrusion<S> {
    /// Where the origin of the profile starts \[m\].
    pub start: Vector3<S>,
    /// Its line, from there \[m\].
    pub along: Vector3<S>,
    /// Axis 1 of the profile at the start, at right angles to the line; axis 2 completes them.
    pub first_axis: Vector3<S>,
    /// Turn of the profile about the line from its start to its end, in proportion to the length \[rad\].
    pub twist: S,
    /// Elements along the line.
    pub elements: usize,
}

/// A member of thin walls.
#[derive(Clone, Debug)]
pub struct ThinWalls {
    /// The walls, in the order of the profile: their first direction goes from corner to corner, the second along the line.
    pub walls: Vec<ShellMember>,
}

impl ThinWalls {
    fn nodes(&self, edge: Edge) -> Vec<NodeId> {
        let mut nodes: Vec<NodeId> = Vec::new();
        for node in self.walls.iter().flat_map(|wall| wall.edge(edge)) {
            if !nodes.contains(&node) {
                nodes.push(node);
            }
        }
        nodes
    }
    /// Nodes of all walls where the line starts, each once.
    pub fn start(&self) -> Vec<NodeId> {
        self.nodes(Edge::SecondStart)
    }
    /// Nodes of all walls where the line ends, each once.
    pub fn end(&self) -> Vec<NodeId> {
        self.nodes(Edge::SecondEnd)
    }
}

impl<S: Scalar> Extrusion<S> {
    /// A wall from one point of the profile to another.
    ///
    /// x = start + v along + R(v twist) p(u), where R turns about the line; the normal is x,u cross x,v.
    pub fn wall(&self, [from, to]: [[S; 2]; 2], elements: usize) -> ShellMesh<S> {
        let direction = self.along.unit();
        let axes = [self.first_axis.unit(), direction.cross(&self.first_axis.unit())];
        let in_space = |[x, y]: [S; 2]| axes[0] * x + axes[1] * y;
        let (from, to) = (in_space(from), in_space(to));
        ShellMesh::on([elements, self.elements], |u, v| {
            let turn = Quaternion::about(direction, self.twist * v);
            let arm = turn.rotate(from + (to - from) * S::from(u));
            let (across, along) = (turn.rotate(to - from), self.along + direction.cross(&arm) * self.twist);
            [self.start + self.along * S::from(v) + arm, across.cross(&along)]
        })
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A profile drawn along a line, of one material, with the thickness \[m\] of each wall by its number and the share of the length.
    ///
    /// Walls that meet in a corner share nodes there: see [`joined`](MechanismBuilder::joined).
    pub fn thin_walls(
        &mut self,
        name: &str,
        profile: &Profile<S>,
        extrusion: &Extrusion<S>,
        material: &Material<S>,
        thickness: impl Fn(usize, f64) -> S,
    ) -> ThinWalls {
        let mut own = ThinWalls { walls: Vec::new() };
        let (direction, first) = (extrusion.along.unit(), extrusion.first_axis.unit());
        let cosine = direction.dot(&first).value();
        // what is not a number is no right angle, either
        if !cosine.abs().le(&crate::tolerances::CONSISTENT) {
            self.mistakes.push(format!(
                "axis 1 of the profile of \"{name}\" and its line enclose an angle whose cosine is {cosine:.3e}; they stand at right angles"
            ));
            return own;
        }
        for (number, &(ends, elements)) in profile.walls.iter().enumerate() {
            let [Some(&from), Some(&to)] = ends.map(|corner| profile.corners.get(corner)) else {
                let corners = profile.corners.len();
                self.mistakes.push(format!(
                    "wall {} of \"{name}\" goes from corner {ends:?}; there are {corners}, from 0 on",
                    number + 1
                ));
                return own;
            };
            let before: Vec<&MeshedShell> = own.walls.iter().map(|wall| &**wall).collect();
            let (mesh, _) = self.joined_where_met(extrusion.wall([from, to], elements), &before);
            let wall = self.tapered_shell(&format!("{name}, wall {}", number + 1), mesh, material, |_, [_, share]| {
                thickness(number, share)
            });
            own.walls.push(wall);
        }
        own
    }
}
