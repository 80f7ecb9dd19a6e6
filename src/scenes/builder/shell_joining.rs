//! Shells joined along edges to other shells and to bodies.

use super::carriers::Carriers;
use super::surface_search::{ALONG, PlaceIndex, Point, Surfaces, cosine, length, shown};
use super::{FreeMesh, MechanismBuilder, MeshedShell, ShellMember, ShellMesh, SurfaceMesh};
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::flexible::Material;
use crate::elements::flexible::faces::FaceKind;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::tolerances::SAME_VERTEX;
use std::collections::HashMap;

/// What divides neighbours otherwise is told with this remedy.
const REMEDY: &str = "divide both sides alike, so that all nodes there are common ones, or tie the edge instead (tie)";

/// Shells that a mesh is to be joined to.
struct Neighbours<'s, S> {
    shells: &'s [&'s MeshedShell],
    carriers: Carriers<S>,
    /// All their nodes with their places.
    places: HashMap<NodeId, Point>,
    /// Lines of nodes along which interpolations meet: edges, and the middle lines of faces of nine nodes.
    lines: HashMap<NodeId, Vec<Vec<NodeId>>>,
}

impl<'s, S: Scalar> Neighbours<'s, S> {
    fn new(m: &MechanismBuilder<S>, shells: &'s [&'s MeshedShell], near: f64) -> Self {
        let carriers = Carriers::new(m, shells, near);
        let places = carriers.nodes().map(|node| (node, m.position(node).map(Scalar::value))).collect();
        let mut lines: HashMap<NodeId, Vec<Vec<NodeId>>> = HashMap::new();
        for (kind, nodes) in shells.iter().flat_map(|shell| shell.faces()) {
            let middles: &[&[usize]] = if kind.face == FaceKind::Quad9 { &[&[1, 4, 7], &[3, 4, 5]] } else { &[] };
            for line in kind.face.shape().edges.iter().chain(middles) {
                let line: Vec<NodeId> = line.iter().map(|&place| nodes[place]).collect();
                line.iter().for_each(|node| lines.entry(*node).or_default().push(line.clone()));
            }
        }
        Neighbours { shells, carriers, places, lines }
    }
    fn shell_with(&self, node: NodeId) -> &str {
        self.shells.iter().find(|shell| shell.nodes.contains(&node)).map_or("", |own| &own.name)
    }
    fn has_line(&self, line: &[Option<NodeId>]) -> bool {
        let Some(nodes) = line.iter().copied().collect::<Option<Vec<NodeId>>>() else { return false };
        let is_it = |own: &Vec<NodeId>| own.len() == nodes.len() && (*own == nodes || own.iter().rev().eq(&nodes));
        self.lines.get(&nodes[0]).is_some_and(|lines| lines.iter().any(is_it))
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A mesh whose edges take over the nodes of shells that stand at the same places, to a millionth of the diagonal of the mesh: walls that
    /// meet at any angle, which then stays.
    ///
    /// The mesh is refused if it shares no node with one of the shells, and where edges run along each other with other divisions.
    ///
    /// Each wall keeps the directors of its own normals, in the frame of the common nodes: turning one about the normal of a wall, which the
    /// penalty against drilling holds, bends the other.
    #[must_use]
    pub fn joined<M: SurfaceMesh<S>>(&self, mesh: M, shells: &[&MeshedShell]) -> M {
        let each: Vec<Vec<&MeshedShell>> = shells.iter().map(|shell| vec![*shell]).collect();
        self.joined_to_each(mesh, &each)
    }

    /// The same, joined to at least one of the shells of each list.
    pub(crate) fn joined_to_each<M: SurfaceMesh<S>>(&self, mesh: M, lists: &[Vec<&MeshedShell>]) -> M {
        let (mut mesh, met) = self.joined_where_met(mesh, &lists.concat());
        let mut first = 0;
        for list in lists {
            let range = first..first + list.len();
            first = range.end;
            if !list.is_empty() && !met[range].contains(&true) {
                let why = self.gap_to(&mesh, list);
                mesh.free_mut().refuse(why);
            }
        }
        mesh
    }

    /// The mesh with the nodes of those shells that it meets, and which ones it meets.
    pub(super) fn joined_where_met<M: SurfaceMesh<S>>(&self, mut mesh: M, shells: &[&MeshedShell]) -> (M, Vec<bool>) {
        let free = mesh.free();
        let near = SAME_VERTEX * free.size();
        let neighbours = Neighbours::new(self, shells, near);
        let mut owners: HashMap<NodeId, Vec<usize>> = HashMap::new();
        for (number, shell) in shells.iter().enumerate() {
            shell.nodes.iter().for_each(|node| owners.entry(*node).or_default().push(number));
        }
        let mut nodes: HashMap<usize, NodeId> = free.given.iter().copied().collect();
        let mut met = vec![false; shells.len()];
        let mut by_place = PlaceIndex::new(near);
        neighbours.places.iter().for_each(|(node, place)| by_place.add(*node, *place));
        for point in free.outer_points() {
            let node = nodes.get(&point).copied().or_else(|| by_place.find(free.value_of(point)));
            let Some((node, own)) = node.and_then(|node| Some((node, owners.get(&node)?))) else { continue };
            own.iter().for_each(|&shell| met[shell] = true);
            if nodes.insert(point, node).is_none() {
                mesh.free_mut().take_over(point, node, self.position(node));
            }
        }
        if let Some(why) = divided_otherwise(&free, &nodes, &neighbours) {
            mesh.free_mut().refuse(why);
        }
        (mesh, met)
    }

    /// How far a mesh lies from shells that it does not meet, in words that follow its name.
    fn gap_to<M: SurfaceMesh<S>>(&self, mesh: &M, shells: &[&MeshedShell]) -> String {
        let (free, neighbours) = (mesh.free(), Neighbours::new(self, shells, 0.0));
        let pairs = free.outer_points().into_iter().flat_map(|point| {
            let place = free.value_of(point);
            neighbours.places.iter().map(move |(&node, &other)| (length(other - place), point, node))
        });
        let nearest = pairs.min_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2.0).cmp(&(b.1, b.2.0))));
        let name = &shells[0].name;
        let Some((distance, point, node)) = nearest else {
            return format!("is to be joined to \"{name}\", which has no nodes");
        };
        format!(
            "is to be joined to \"{name}\", but no node of its edges stands where one of \"{name}\" does: the nearest are its node {} at {} and \
             \"{}\", {distance:.3e} m apart, and up to {:.1e} m are one place; a tie follows faces between their nodes",
            free.node_name(point),
            shown(free.value_of(point)),
            self.model.nodes[node.0].name,
            SAME_VERTEX * free.size()
        )
    }

    /// A closed sphere of one material and thickness \[m\], made of the six faces of a cube with as many elements along each edge.
    pub fn sphere_shell(
        &mut self,
        name: &str,
        (centre, radius): (Vector3<S>, S),
        elements: usize,
        material: &Material<S>,
        thickness: S,
    ) -> Vec<ShellMember> {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::<S>::from_f64);
        let mut faces: Vec<ShellMember> = Vec::new();
        for (number, sign) in [1.0, -1.0].into_iter().enumerate() {
            for normal in 0..3 {
                let edges = [axes[(normal + 1) % 3] * S::from(sign), axes[(normal + 2) % 3]];
                let mesh = ShellMesh::sphere_face(centre, radius, edges, [elements; 2]);
                let (mesh, _) = self.joined_where_met(mesh, &faces.iter().map(|face| &**face).collect::<Vec<_>>());
                let name = format!("{name}, face {}", 3 * number + normal + 1);
                faces.push(self.shell(&name, mesh, material, thickness));
            }
        }
        faces
    }

    /// Nodes of an edge, or any others, that a body carries along as they stand at the start: a rigid link to each, 6 equations for its 6
    /// unknowns, so that none is redundant. A body that stands in one of the nodes may be that node, which is left out then.
    ///
    /// Source: Boopathy & Kennedy, rigid body interpolation elements (RBE2).
    pub fn rigid_interface(&mut self, name: &str, body: NodeId, nodes: &[NodeId]) -> Vec<ConstraintId> {
        if nodes.is_empty() {
            self.mistakes.push(format!("\"{name}\" joins no nodes to its body; give it the nodes of an edge"));
        }
        let mut links: Vec<ConstraintId> = Vec::new();
        let mut linked = vec![body];
        for &node in nodes {
            // corners belong to two edges
            if linked.contains(&node) {
                continue;
            }
            linked.push(node);
            let number = links.len() + 1;
            links.push(self.rigid_link(&format!("{name}, node {number}"), [body, node]));
        }
        links
    }
}

/// Where edges of a mesh and of its neighbours run along each other and are not one, in words that follow the name of the mesh.
fn divided_otherwise<S: Scalar>(
    free: &FreeMesh<S>,
    nodes: &HashMap<usize, NodeId>,
    neighbours: &Neighbours<S>,
) -> Option<String> {
    let near = SAME_VERTEX * free.size();
    let unequal = |place: Point, shell: &str| {
        format!(
            "is joined to \"{shell}\", but at {} their edges lie along each other with other nodes: {REMEDY}",
            shown(place)
        )
    };
    let edges = free.edges();
    for edge in edges.iter().filter(|edge| edge.faces.len() == 1) {
        let own: Vec<Option<NodeId>> = edge.points.iter().map(|point| nodes.get(point).copied()).collect();
        if neighbours.has_line(&own) {
            continue;
        }
        for (&point, node) in edge.points.iter().zip(&own) {
            let from = free.value_of(point);
            let Some(lines) = node.and_then(|node| neighbours.lines.get(&node)) else { continue };
            for other in lines.iter().flatten().filter(|other| Some(**other) != *node) {
                let along = neighbours.places[other] - from;
                let runs = |&&end: &&usize| end != point && cosine(free.value_of(end) - from, along) > ALONG.cos();
                if let Some(&end) = edge.points.iter().find(runs) {
                    return Some(unequal(free.value_of(end), neighbours.shell_with(*other)));
                }
            }
        }
        // across a face, from node to node
        if let [Some(_), .., Some(_)] = own[..] {
            let ends = [edge.points[0], edge.points[edge.points.len() - 1]].map(|point| free.value_of(point));
            let middle = match edge.points[..] {
                [_, middle, _] => free.value_of(middle),
                _ => (ends[0] + ends[1]) * 0.5,
            };
            if let Some(foot) = neighbours.carriers.surfaces.nearest(middle, |_| true) {
                return Some(unequal(middle, neighbours.carriers.shell_of(foot.face)));
            }
        }
    }
    // nodes on faces, of either
    for point in free.outer_points().into_iter().filter(|point| !nodes.contains_key(point)) {
        let place = free.value_of(point);
        if let Some(foot) = neighbours.carriers.surfaces.nearest(place, |_| true) {
            return Some(unequal(place, neighbours.carriers.shell_of(foot.face)));
        }
    }
    let own = Surfaces::new(free.placed(), near);
    let shared: std::collections::HashSet<NodeId> = nodes.values().copied().collect();
    let mut others: Vec<_> = neighbours.places.iter().filter(|(node, _)| !shared.contains(node)).collect();
    others.sort_unstable_by_key(|own| own.0.0);
    others.into_iter().find_map(|(node, &place)| {
        own.nearest(place, |_| true)?;
        Some(unequal(place, neighbours.shell_with(*node)))
    })
}
