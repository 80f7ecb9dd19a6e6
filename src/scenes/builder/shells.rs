//! Shells on meshes of nine-node elements.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::{Drawing, Edge, MechanismBuilder, ShellMesh};
use crate::assembly::{ElementId, NodeId};
use crate::elements::flexible::biquadratic::{AT_NODES, GAUSS, NODES, gauss_weight};
use crate::elements::flexible::{Laminate, Material, ShellField, ShellPressureField, ShellSection};
use crate::elements::forces::LoadFrame;
use crate::elements::{Flexible, NodeKind, TimeFunction};
use crate::functionals::ElementGroup;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::Drawn;

/// Stiffness against turning about the director, as a share of that against shear in the surface.
pub const DRILLING: f64 = 0.1;

/// A shell of a mechanism: its nodes and elements.
#[derive(Clone, Debug)]
pub struct ShellMember {
    /// Its name.
    pub name: String,
    /// Elements along both directions.
    pub counts: [usize; 2],
    /// The first direction first; of a closed mesh those of its start stand at its end once more.
    pub nodes: Vec<NodeId>,
    /// The first direction first.
    pub elements: Vec<ElementId>,
    field: ShellField,
}

impl ShellMember {
    /// Node (i, j) of the grid.
    pub fn node(&self, i: usize, j: usize) -> NodeId {
        self.nodes[i + j * (2 * self.counts[0] + 1)]
    }
    /// All its elements.
    pub fn group(&self) -> ElementGroup {
        ElementGroup::new(&self.name, self.elements.iter().copied())
    }
    /// Those of its elements for which `is_in` says so, from their places [along the first direction, along the second], counted from 0.
    pub fn part(&self, name: &str, is_in: impl Fn([usize; 2]) -> bool) -> ElementGroup {
        let along = self.counts[0].max(1);
        let chosen = self.elements.iter().enumerate().filter(|(place, _)| is_in([place % along, place / along]));
        ElementGroup::new(name, chosen.map(|(_, &element)| element))
    }
    /// What its elements are.
    pub fn field(&self) -> ShellField {
        self.field
    }
    /// Places (i, j) of the nodes of an element.
    fn places_of(&self, element: usize) -> [[usize; 2]; NODES] {
        let (column, row) = (element % self.counts[0], element / self.counts[0]);
        std::array::from_fn(|node| [2 * column + node % 3, 2 * row + node / 3])
    }
    /// Nodes of an element.
    pub fn nodes_of(&self, element: usize) -> [NodeId; NODES] {
        self.places_of(element).map(|[i, j]| self.node(i, j))
    }
    /// Nodes of an edge, in the order of the grid.
    pub fn edge(&self, edge: Edge) -> Vec<NodeId> {
        let [first, second] = self.counts.map(|count| 2 * count);
        match edge {
            Edge::FirstStart => (0..=second).map(|j| self.node(0, j)).collect(),
            Edge::FirstEnd => (0..=second).map(|j| self.node(first, j)).collect(),
            Edge::SecondStart => (0..=first).map(|i| self.node(i, 0)).collect(),
            Edge::SecondEnd => (0..=first).map(|i| self.node(i, second)).collect(),
        }
    }
}

/// Sum of points with weights.
fn tangent<S: Scalar>(points: &[Vector3<S>; NODES], weights: &[f64; NODES]) -> Vector3<S> {
    points.iter().zip(weights).fold(Vector3::zeros(), |sum, (&point, &weight)| sum + point * S::from(weight))
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A shell of one material and thickness \[m\] on a mesh, its nodes in the middle of its thickness.
    ///
    /// Nodes of its own start with the rotation of the nodes that are given, or that of the world.
    pub fn shell(&mut self, name: &str, mesh: ShellMesh<S>, material: &Material<S>, thickness: S) -> ShellMember {
        self.tapered_shell(name, mesh, material, |_, _| thickness)
    }

    /// A shell whose thickness \[m\] depends on the number of the element and on the share (u, v) of both directions: continuous if it
    /// does not depend on the element.
    pub fn tapered_shell(
        &mut self,
        name: &str,
        mesh: ShellMesh<S>,
        material: &Material<S>,
        thickness: impl Fn(usize, [f64; 2]) -> S,
    ) -> ShellMember {
        let Material { young, poisson, density } = *material;
        let last = mesh.elements.map(|count| (2 * count).max(1) as f64);
        if !(poisson.value() > -1.0 && poisson.value() < 1.0) {
            let value = poisson.value();
            self.mistakes.push(format!("the Poisson's ratio of \"{name}\" is {value}; it must lie between -1 and 1"));
        }
        self.add_shell(name, mesh, ShellSection::Isotropic, |element, nodes| {
            let own = nodes.map(|[i, j]| thickness(element, [i as f64 / last[0], j as f64 / last[1]]));
            own.into_iter().chain([young, poisson, density]).collect()
        })
    }

    /// A shell of plies; axis 1 of its surface lies along `direction` in the world, projected on it.
    pub fn laminate_shell(
        &mut self,
        name: &str,
        mesh: ShellMesh<S>,
        laminate: &Laminate<S>,
        direction: Vector3<S>,
    ) -> ShellMember {
        if let Some(why) = laminate.mistake() {
            self.mistakes.push(format!("the laminate of \"{name}\": {why}"));
        }
        let axis = self.unit(name, direction);
        if mesh.normals.iter().any(|normal| !(normal.cross(&axis).length().value() > 1e-3)) {
            self.mistakes.push(format!(
                "the direction of axis 1 of \"{name}\" is normal to its surface at a node; give one that lies more along it everywhere"
            ));
        }
        let rotation = mesh.given.first().map_or_else(Quaternion::identity, |&(_, node)| self.rotation(node));
        let numbers = [laminate.numbers(), rotation.rotate_back(axis).components().to_vec()].concat();
        self.add_shell(name, mesh, ShellSection::Laminate, |_, _| numbers.clone())
    }

    /// A shell with the section's parameters of each element, from its number and the places (i, j) of its nodes.
    pub(super) fn add_shell(
        &mut self,
        name: &str,
        mesh: ShellMesh<S>,
        kind: ShellSection,
        section: impl Fn(usize, [[usize; 2]; NODES]) -> Vec<S>,
    ) -> ShellMember {
        let [first, second] = mesh.elements;
        let field = ShellField { section: kind, damped: mesh.damping.is_some() };
        let (counts, nodes, elements) = (mesh.elements, Vec::new(), Vec::new());
        let mut member = ShellMember { name: name.into(), counts, nodes, elements, field };
        let sound = self.check_mesh(name, &mesh);
        let rotation = mesh.given.first().map_or_else(Quaternion::identity, |&(_, node)| self.rotation(node));
        for j in 0..=2 * second {
            for i in 0..=2 * first {
                let place = mesh.place(i, j);
                let given = mesh.given.iter().find(|(own, _)| *own == place);
                member.nodes.push(match given {
                    Some(&(_, node)) => node,
                    None if mesh.closed && i == 2 * first => member.nodes[j * (2 * first + 1)],
                    None => {
                        let q: Vec<S> = mesh.points[place].components().into_iter().chain(rotation.0).collect();
                        let fixed = mesh.clamped.contains(&place);
                        self.add_node(&format!("{name}, node {i}, {j}"), NodeKind::Body, fixed, &q)
                    }
                });
            }
        }
        if !sound {
            return member;
        }
        for element in 0..first * second {
            let (column, row) = (element % first, element / first);
            let places = member.places_of(element);
            let nodes = places.map(|[i, j]| member.node(i, j));
            let mut p = Vec::new();
            for [i, j] in places {
                let place = mesh.place(i, j);
                for vector in [mesh.points[place], mesh.normals[place]] {
                    p.extend(rotation.rotate_back(vector).components());
                }
            }
            p.extend(section(element, places));
            p.push(S::from(DRILLING));
            p.extend([S::zero(); 3]);
            p.extend(mesh.damping);
            let own = format!("{name}, element {}, {}", column + 1, row + 1);
            // the first element is checked as any other, and what it records serves all
            let added = match member.elements.first() {
                Some(&like)
                    if self.model.find_element(like).is_some()
                        && self.check_nodes(&own, &nodes, &[NodeKind::Body; NODES]) =>
                {
                    self.numbers.p.extend_from_slice(&p);
                    self.model.add_element_like(&own, &nodes, like)
                }
                Some(_) => self.model.refused_element(),
                None => self.add_element(&own, &nodes, Flexible(field).into(), &p),
            };
            member.elements.push(added);
            self.heavy_shells.push((member.elements[element], field.drilling() + 1));
        }
        self.draw_grid(&member);
        self.shells.push(member.clone());
        member
    }

    /// A pressure on a shell with its size over time [N/m2], one value for each number of `size`: it pushes to where the normal points.
    ///
    /// A dead load (`LoadFrame::World`) keeps the normal and the area that the shell has at the start; a follower (`LoadFrame::Body`) stands
    /// normal to the deformed surface and acts on its area.
    pub fn pressure(&mut self, name: &str, shell: &ShellMember, frame: LoadFrame, size: TimeFunction, values: &[S]) {
        for (element, &id) in shell.elements.iter().enumerate() {
            // an element that was refused has been reported already
            if id == self.model.refused_element() {
                continue;
            }
            let nodes = shell.nodes_of(element);
            let points = nodes.map(|node| self.position(node));
            let mut p = Vec::new();
            if frame == LoadFrame::World {
                for (weights, point) in GAUSS.iter().zip(0..) {
                    let area = tangent(&points, &weights.by_r).cross(&tangent(&points, &weights.by_s));
                    p.extend((area * S::from(gauss_weight(point))).components());
                }
            }
            p.extend_from_slice(values);
            let load = Flexible(ShellPressureField { frame, size: size.clone() });
            self.add_element(&format!("{name}, element {}", element + 1), &nodes, load.into(), &p);
        }
    }

    /// Lines between elements.
    fn draw_grid(&mut self, member: &ShellMember) {
        let [first, second] = member.counts.map(|count| 2 * count);
        let lines = (0..=second).step_by(2).map(|j| (0..=first).map(|i| member.node(i, j)).collect::<Vec<_>>());
        let across = (0..=first).step_by(2).map(|i| (0..=second).map(|j| member.node(i, j)).collect::<Vec<_>>());
        for line in lines.chain(across) {
            let points = line.into_iter().map(|node| (node, [0.0; 3])).collect();
            self.drawings.push(Drawing { drawn: Drawn::Shell, points });
        }
    }

    fn check_mesh(&mut self, name: &str, mesh: &ShellMesh<S>) -> bool {
        let mistakes = self.mistakes.len();
        let [first, second] = mesh.elements;
        if first == 0 || second == 0 {
            self.mistakes.push(format!("\"{name}\" has {first} x {second} elements; a shell needs at least 1 x 1"));
            return false;
        }
        for element in 0..first * second {
            let (column, row) = (element % first, element / first);
            let place = |node: usize| mesh.place(2 * column + node % 3, 2 * row + node / 3);
            let points: [Vector3<S>; NODES] = std::array::from_fn(|node| mesh.points[place(node)]);
            for (node, weights) in AT_NODES.iter().enumerate() {
                let normal = tangent(&points, &weights.by_r).cross(&tangent(&points, &weights.by_s));
                let cosine = normal.unit().dot(&mesh.normals[place(node)]).value();
                if !(cosine > 0.5) {
                    let (column, row, node) = (column + 1, row + 1, node + 1);
                    self.mistakes.push(format!(
                        "\"{name}\", element {column}, {row}: at its node {node} the surface and the normal enclose an angle whose cosine is \
                         {cosine:.3}; nodes must lie apart, and the normal points to where the first direction is turned to the second \
                         counterclockwise"
                    ));
                    return false;
                }
            }
        }
        let size = (mesh.points[mesh.points.len() - 1] - mesh.points[0]).length().value();
        let mut rotation: Option<[f64; 4]> = None;
        for &(place, node) in &mesh.given {
            let Some(kind) = self.kind_of(name, node) else { continue };
            let own = self.model.nodes[node.0].name.clone();
            if kind != NodeKind::Body {
                self.mistakes.push(format!("\"{name}\" needs a body with Euler parameters, but node \"{own}\" is none"));
                continue;
            }
            let gap = (self.position(node) - mesh.points[place]).length().value();
            if !(gap <= 1e-9 * size.max(f64::MIN_POSITIVE)) {
                self.mistakes.push(format!(
                    "\"{name}\" lies {gap:.3e} m from its node \"{own}\": a shell takes hold of the origin of a body's frame"
                ));
            }
            let e = self.rotation(node).0.map(Scalar::value);
            let before = *rotation.get_or_insert(e);
            if before.iter().zip(e).any(|(a, b)| (a - b).abs() > 1e-12) {
                self.mistakes.push(format!(
                    "\"{name}\" joins nodes whose frames start with different Euler parameters {before:?} and {e:?}; let them start alike, \
                     or join nodes of its own by fixed joints"
                ));
            }
        }
        self.mistakes.len() == mistakes
    }

    /// Weight of the elements of shells from one of them on.
    pub(super) fn shell_gravity(&mut self, gravity: Vector3<S>, first: usize) {
        for &(element, place) in &self.heavy_shells[first..] {
            // an element that was refused has been reported already
            let Some(element) = self.model.find_element(element) else { continue };
            let first = element.parameters.start + place;
            for (own, component) in self.numbers.p[first..first + 3].iter_mut().zip(gravity.components()) {
                *own += component;
            }
        }
    }
}
