//! Shells on meshes.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::entries::entry;
use super::weights::Heavy;
use super::{Drawing, Edge, FreeMesh, MechanismBuilder, SurfaceMesh};
use crate::assembly::{ElementId, Node, NodeId};
use crate::elements::NodeKind;
use crate::elements::flexible::shape::weighed;
use crate::elements::flexible::{Laminate, Material, ShellKind, ShellSection};
use crate::elements::forces::{LOADS, LoadFrame};
use crate::functionals::ElementGroup;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{Drawn, Signal};
use crate::tolerances::{CONSISTENT, LONG_SUM};
use std::collections::{HashMap, HashSet};
use std::ops::Deref;

/// Factor k of the stiffness against turning about the director, see `elements::flexible::ShellField`.
pub const DRILLING: f64 = 1.0;

/// A shell of a mechanism on any mesh: its nodes and elements, and those that have a name.
#[derive(Clone, Debug)]
pub struct MeshedShell {
    /// Its name.
    pub name: String,
    /// In the order of the points of the mesh, without those that belong to no face.
    pub nodes: Vec<NodeId>,
    /// In the order of the faces.
    pub elements: Vec<ElementId>,
    /// Of each element its kind and its nodes.
    faces: Vec<(ShellKind, Vec<NodeId>)>,
    /// Of elements of plies where these begin and end along the normal, from the nodes on \[m\].
    layers: Vec<Option<[f64; 2]>>,
    /// Node at each point of the mesh, if a face has it.
    of_point: Vec<Option<NodeId>>,
    groups: Vec<(String, Vec<usize>)>,
    node_sets: Vec<(String, Vec<usize>)>,
}

impl MeshedShell {
    /// The node at a point of the mesh; `None` where no face has the point.
    pub fn node(&self, point: usize) -> Option<NodeId> {
        *self.of_point.get(point)?
    }
    /// All its elements.
    pub fn group(&self) -> ElementGroup {
        ElementGroup::new(&self.name, self.elements.iter().copied())
    }
    /// Names for a load on each element of a group, and the nodes of these.
    pub(in crate::scenes) fn carriers(&self, load: &str, group: &ElementGroup) -> Vec<(String, Vec<NodeId>)> {
        let loaded: HashSet<ElementId> = group.elements.iter().copied().collect();
        let faces = self.faces.iter().zip(&self.elements).enumerate().filter(|(_, (_, id))| loaded.contains(id));
        faces.map(|(place, ((_, nodes), _))| (format!("{load}, element {}", place + 1), nodes.clone())).collect()
    }
    /// The elements of a group of faces with a name.
    ///
    /// # Errors
    /// If no group has the name; says which there are.
    pub fn group_named(&self, name: &str) -> Result<ElementGroup, String> {
        let faces = self.named("group of faces", &self.groups, name)?;
        Ok(ElementGroup::new(name, faces.iter().filter_map(|&face| self.elements.get(face).copied())))
    }
    /// The nodes of a set of points with a name, in its order.
    ///
    /// # Errors
    /// If no set has the name; says which there are.
    pub fn node_set(&self, name: &str) -> Result<Vec<NodeId>, String> {
        let points = self.named("node set", &self.node_sets, name)?;
        Ok(points.iter().filter_map(|&point| self.node(point)).collect())
    }
    fn named<'l>(&self, what: &str, all: &'l [(String, Vec<usize>)], name: &str) -> Result<&'l [usize], String> {
        match all.iter().find(|(own, _)| own == name) {
            Some((_, numbers)) => Ok(numbers),
            None => {
                let there: Vec<String> = all.iter().map(|(own, _)| format!("\"{own}\"")).collect();
                let there = if there.is_empty() { "none".into() } else { there.join(", ") };
                Err(format!("\"{}\" has no {what} \"{name}\"; there are: {there}", self.name))
            }
        }
    }
    /// Of each element of plies where these begin and end along the normal, from the nodes on \[m\].
    pub(crate) fn layers(&self) -> impl Iterator<Item = Option<[f64; 2]>> {
        self.layers.iter().copied()
    }
    /// What each element is, with its nodes in their order.
    pub fn faces(&self) -> impl Iterator<Item = (ShellKind, &[NodeId])> {
        self.faces.iter().map(|(kind, nodes)| (*kind, &nodes[..]))
    }
}

/// A shell of a mechanism on a grid.
#[derive(Clone, Debug)]
pub struct ShellMember {
    /// Elements along both directions, of nine nodes or what stands in place of these.
    pub counts: [usize; 2],
    /// The first direction first; of a closed mesh those of its start stand at its end once more.
    pub nodes: Vec<NodeId>,
    /// Elements in place of each of nine nodes.
    pub(super) parts: usize,
    pub(super) shell: MeshedShell,
}

impl Deref for ShellMember {
    type Target = MeshedShell;
    fn deref(&self) -> &MeshedShell {
        &self.shell
    }
}

impl ShellMember {
    /// Node (i, j) of the grid.
    pub fn node(&self, i: usize, j: usize) -> NodeId {
        self.nodes[i + j * (2 * self.counts[0] + 1)]
    }
    /// Those of its elements for which `is_in` says so, from their places [along the first direction, along the second], counted from 0.
    pub fn part(&self, name: &str, is_in: impl Fn([usize; 2]) -> bool) -> ElementGroup {
        let (along, parts) = (self.counts[0].max(1), self.parts);
        let place = |element: usize| [element / parts % along, element / parts / along];
        let chosen = self.elements.iter().enumerate().filter(|&(element, _)| is_in(place(element)));
        ElementGroup::new(name, chosen.map(|(_, &element)| element))
    }
    /// Nodes of an edge, in the order of the grid.
    pub fn edge(&self, edge: Edge) -> Vec<NodeId> {
        edge.along(self.counts, |i, j| self.node(i, j))
    }
}

/// The section of some faces of a shell.
pub enum ShellPart<'p, S, P = usize> {
    /// One material, with the thickness \[m\] at the number of a face and the place of its node: of a grid the share (u, v) of both directions, of
    /// a free mesh the number of its point. Continuous if it does not depend on the face.
    Isotropic(Material<S>, &'p dyn Fn(usize, P) -> S),
    /// Plies, with the direction of their axis 1 in the world, projected on the surface.
    Laminate(&'p Laminate<S>, Vector3<S>),
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A shell of one material and thickness \[m\] on a mesh, its nodes in the middle of its thickness.
    ///
    /// Nodes of its own start with the rotation of the nodes that are given, or that of the world.
    pub fn shell<M: SurfaceMesh<S>>(&mut self, name: &str, mesh: M, material: &Material<S>, thickness: S) -> M::Member {
        self.tapered_shell(name, mesh, material, |_, _| thickness)
    }

    /// A shell whose thickness \[m\] depends on the number of the element and on the place of the node: see [`ShellPart::Isotropic`].
    pub fn tapered_shell<M: SurfaceMesh<S>>(
        &mut self,
        name: &str,
        mesh: M,
        material: &Material<S>,
        thickness: impl Fn(usize, M::Place) -> S,
    ) -> M::Member {
        self.shell_of_parts(name, mesh, &[ShellPart::Isotropic(*material, &thickness)], |_| 0)
    }

    /// A shell of plies; axis 1 of its surface lies along `direction` in the world, projected on it.
    pub fn laminate_shell<M: SurfaceMesh<S>>(
        &mut self,
        name: &str,
        mesh: M,
        laminate: &Laminate<S>,
        direction: Vector3<S>,
    ) -> M::Member {
        self.shell_of_parts(name, mesh, &[ShellPart::Laminate(laminate, direction)], |_| 0)
    }

    /// A shell whose faces have sections of their own: which of `parts`, from the number of the face.
    pub fn shell_of_parts<M: SurfaceMesh<S>>(
        &mut self,
        name: &str,
        mesh: M,
        parts: &[ShellPart<S, M::Place>],
        part_of: impl Fn(usize) -> usize,
    ) -> M::Member {
        let free = mesh.free();
        if let Some(face) = (0..free.faces.len()).find(|&face| part_of(face) >= parts.len()) {
            let (count, face_name, own) = (parts.len(), free.element_place(face), part_of(face));
            self.mistakes.push(format!("\"{name}\", {face_name} has part {own}, but there are {count}, counted from 0"));
        }
        let rotation = self.rotation_of(&free);
        let numbers: Vec<Vec<S>> = parts.iter().map(|part| self.part_numbers(name, part, rotation)).collect();
        let before = self.mistakes.len();
        let section = |face: usize, nodes: usize| match parts.get(part_of(face)) {
            Some(ShellPart::Isotropic(_, thickness)) => {
                let own = (0..nodes).map(|node| thickness(face, mesh.place(face, node)));
                (ShellSection::Isotropic, own.chain(numbers[part_of(face)].iter().copied()).collect(), None)
            }
            Some(ShellPart::Laminate(plies, _)) => (ShellSection::Laminate, numbers[part_of(face)].clone(), Some(*plies)),
            // a mechanism with mistakes is not made: its faces may have any section
            None => (ShellSection::Isotropic, vec![S::one(); nodes + 3], None),
        };
        let shell = self.add_shell(name, (&free, mesh.lines()), &section);
        if self.mistakes.len() == before {
            let directors = free.directors();
            for (number, part) in parts.iter().enumerate() {
                let ShellPart::Laminate(_, direction) = part else { continue };
                let axis = direction.unit();
                let mut own = directors.iter().enumerate().filter(|(face, _)| part_of(*face) == number);
                if own.any(|(_, all)| all.iter().any(|normal| !(normal.cross(&axis).length().value() > 1e-3))) {
                    self.mistakes.push(format!(
                        "the direction of axis 1 of \"{name}\" is normal to its surface at a node; give one that lies more along it everywhere"
                    ));
                }
            }
        }
        mesh.member(shell)
    }

    /// Parameters of a section beside thicknesses; refuses a Poisson's ratio with which a sheet has no stiffness.
    fn part_numbers<P>(&mut self, name: &str, part: &ShellPart<S, P>, rotation: Quaternion<S>) -> Vec<S> {
        match part {
            ShellPart::Isotropic(Material { young, poisson, density }, _) => {
                let value = poisson.value();
                if !(value > -1.0 && value < 1.0) {
                    self.mistakes
                        .push(format!("the Poisson's ratio of \"{name}\" is {value}; it must lie between -1 and 1"));
                }
                vec![*young, *poisson, *density]
            }
            ShellPart::Laminate(laminate, direction) => {
                self.mistakes.extend(laminate.mistake().map(|why| format!("the laminate of \"{name}\": {why}")));
                let axis = self.unit(name, *direction);
                [laminate.numbers(), rotation.rotate_back(axis).components().to_vec()].concat()
            }
        }
    }

    /// Rotation with which the nodes of a shell start.
    fn rotation_of(&self, mesh: &FreeMesh<S>) -> Quaternion<S> {
        mesh.given.first().map_or_else(Quaternion::identity, |&(_, node)| self.rotation(node))
    }

    /// A shell with the section of each element: what it is, its parameters, from its number and that of its nodes, and its plies if it has some.
    fn add_shell<'l>(
        &mut self,
        name: &str,
        (free, lines): (&FreeMesh<S>, Vec<Vec<usize>>),
        section: &dyn Fn(usize, usize) -> (ShellSection, Vec<S>, Option<&'l Laminate<S>>),
    ) -> MeshedShell
    where
        S: 'l,
    {
        let damped = free.damping.is_some();
        let (groups, node_sets) = (free.groups.clone(), free.node_sets.clone());
        let (nodes, elements, faces, layers) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let of_point = vec![None; free.points.len()];
        let mut shell = MeshedShell { name: name.into(), nodes, elements, faces, layers, of_point, groups, node_sets };
        let sound = self.check_mesh(name, free);
        let rotation = self.rotation_of(free);
        self.add_shell_nodes(free, &mut shell);
        if !sound {
            return shell;
        }
        // the first element of each kind is checked as any other, and what it records serves all
        let mut first: HashMap<ShellKind, ElementId> = HashMap::new();
        for (element, (face, directors)) in free.faces.iter().zip(free.directors()).enumerate() {
            let nodes: Vec<NodeId> = face.points.iter().filter_map(|&point| shell.of_point[point]).collect();
            let (section, numbers, laminate) = section(element, nodes.len());
            let kind = ShellKind { face: face.kind, section, damped };
            let mut p = Vec::new();
            for (&point, director) in face.points.iter().zip(directors) {
                for vector in [free.points[point], director] {
                    p.extend(rotation.rotate_back(vector).components());
                }
            }
            p.extend(numbers);
            p.push(S::from(DRILLING));
            p.extend([S::zero(); 3]);
            p.extend(free.damping);
            let own = format!("{name}, {}", free.element_name(element));
            let added = match first.get(&kind) {
                Some(&like)
                    if self.model.find_element(like).is_some()
                        && self.check_nodes(&own, &nodes, &vec![NodeKind::Body; nodes.len()]) =>
                {
                    self.numbers.p.extend_from_slice(&p);
                    let added = self.model.add_element_like(&own, &nodes, like);
                    self.numbers.p.resize(self.model.parameters, S::zero());
                    added
                }
                Some(_) => self.model.refused_element(),
                None => self.add_element(&own, &nodes, kind.element(), &p),
            };
            first.entry(kind).or_insert(added);
            shell.elements.push(added);
            shell.faces.push((kind, nodes));
            shell.layers.push(laminate.map(|own| [-0.5, 0.5].map(|side| (own.offset + own.thickness() * side).value())));
            self.heavy.push(Heavy::Own(added, kind.drilling() + 1));
        }
        for line in lines {
            let points = line.into_iter().filter_map(|point| Some((shell.node(point)?, [0.0; 3]))).collect();
            self.drawings.push(Drawing { drawn: Drawn::Shell, points });
        }
        self.shells.push(shell.clone());
        shell
    }

    /// The nodes of a shell, those of others among them.
    fn add_shell_nodes(&mut self, free: &FreeMesh<S>, shell: &mut MeshedShell) {
        let rotation = self.rotation_of(free);
        // of a mesh without faces, which is refused, all points may be asked for
        let mut used = vec![free.faces.is_empty(); free.points.len()];
        for &point in free.faces.iter().flat_map(|face| &face.points) {
            used.get_mut(point).into_iter().for_each(|used| *used = true);
        }
        let clamped: HashSet<usize> = free.clamped.iter().copied().collect();
        let given: HashMap<usize, NodeId> = free.given.iter().rev().copied().collect();
        for (point, place) in free.points.iter().enumerate().filter(|(point, _)| used[*point]) {
            let node = given.get(&point).copied().unwrap_or_else(|| {
                let q: Vec<S> = place.components().into_iter().chain(rotation.0).collect();
                let fixed = clamped.contains(&point);
                self.add_node(&format!("{}{}", shell.name, free.node_name(point)), NodeKind::Body, fixed, &q)
            });
            shell.nodes.push(node);
            shell.of_point[point] = Some(node);
        }
    }

    /// A pressure on a shell with its size over time [N/m2]: it pushes to where the normal points.
    ///
    /// A dead load (`LoadFrame::World`) keeps the normal and the area that the shell has at the start; a follower (`LoadFrame::Body`) stands
    /// normal to the deformed surface and acts on its area.
    pub fn pressure(&mut self, name: &str, shell: &MeshedShell, frame: LoadFrame, size: Signal<S>) {
        let keys = self.load_keys(name, frame, size).to_vec();
        self.load(entry(LOADS, "pressure"), &shell.carriers(name, &shell.group()), &keys);
    }

    fn check_mesh(&mut self, name: &str, free: &FreeMesh<S>) -> bool {
        let mistakes = self.mistakes.len();
        if let Some(mistake) = &free.unjoined {
            self.mistakes.push(format!("\"{name}\" {mistake}"));
            return false;
        }
        let of_mesh = free.mistakes();
        if !of_mesh.is_empty() {
            self.mistakes.extend(of_mesh.into_iter().map(|mistake| format!("\"{name}\": {mistake}")));
            return false;
        }
        for (element, (face, directors)) in free.faces.iter().zip(free.directors()).enumerate() {
            let points = free.places(face);
            for (node, (weights, director)) in face.kind.shape().at_nodes.iter().zip(directors).enumerate() {
                let normal = weighed(&points, weights.by_r).cross(&weighed(&points, weights.by_s));
                let cosine = normal.unit().dot(&director).value();
                if !(cosine > 0.5) {
                    let (element, node) = (free.element_place(element), node + 1);
                    self.mistakes.push(format!(
                        "\"{name}\", {element}: at its node {node} the surface and the normal enclose an angle whose cosine is \
                         {cosine:.3}; nodes must lie apart, and the normal points to where the first direction is turned to the second \
                         counterclockwise"
                    ));
                    return false;
                }
            }
        }
        self.check_given(name, free);
        self.mistakes.len() == mistakes
    }

    /// Nodes of others at points of a mesh: they are bodies, lie there and start alike.
    fn check_given(&mut self, name: &str, free: &FreeMesh<S>) {
        let size = free.size();
        let mut start = None;
        let clamped: HashSet<usize> = free.clamped.iter().copied().collect();
        let mut first: HashMap<usize, NodeId> = HashMap::new();
        for &(place, node) in &free.given {
            let Some(Node { name: own, fixed, .. }) = self.model.find_node(node).cloned() else {
                self.refuse_stranger(name, "a node");
                continue;
            };
            let at = format!("node {}", free.node_name(place));
            if clamped.contains(&place) && !fixed {
                self.mistakes.push(format!(
                    "\"{name}\" is clamped at its {at}, which is the node \"{own}\" that moves: clamp that one, or leave it out here"
                ));
            }
            let before = *first.entry(place).or_insert(node);
            if before != node {
                let before = &self.model.nodes[before.0].name;
                self.mistakes.push(format!("\"{name}\" is given two nodes for its {at}: \"{before}\" and \"{own}\""));
            }
            self.check_given_node(name, node, (free.points[place], size), &mut start);
        }
    }

    /// A node that a beam or shell of some size \[m\] is given: a body, which stands at its place and starts with the rotation of those before.
    pub(super) fn check_given_node(
        &mut self,
        name: &str,
        node: NodeId,
        (place, size): (Vector3<S>, f64),
        start: &mut Option<[f64; 4]>,
    ) {
        let Some(kind) = self.kind_of(name, node) else { return };
        let own = &self.model.nodes[node.0].name;
        if kind != NodeKind::Body {
            self.mistakes.push(format!(
                "\"{name}\" needs a body with Euler parameters, but node \"{own}\" is none: make it a body, or leave a node of \"{name}\" there and \
                 join both"
            ));
            return;
        }
        let gap = (self.position(node) - place).length().value();
        if !(gap <= CONSISTENT * size.max(f64::MIN_POSITIVE)) {
            self.mistakes.push(format!(
                "\"{name}\" lies {gap:.3e} m from its node \"{own}\": it takes hold of the origin of a body's frame; leave a node of its own there and \
                 add a fixed joint, or move the frame"
            ));
        }
        let e = self.rotation(node).0.map(Scalar::value);
        let before = *start.get_or_insert(e);
        if before.iter().zip(e).any(|(a, b)| (a - b).abs() > LONG_SUM) {
            self.mistakes.push(format!(
                "\"{name}\" joins nodes whose frames start with different Euler parameters {before:?} and {e:?}; let them start alike, \
                 or join nodes of its own by fixed joints"
            ));
        }
    }
}
