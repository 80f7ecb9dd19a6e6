//! Shells joined along edges to other shells and to bodies.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::{MechanismBuilder, MeshedShell, ShellMember, ShellMesh, SurfaceMesh};
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::flexible::Material;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Distance of two nodes that are one, as a share of the diagonal of the mesh.
const SAME_PLACE: f64 = 1e-9;

impl<S: Scalar> MechanismBuilder<S> {
    /// A mesh whose edges take over the nodes of shells that stand at the same places: walls that meet at any angle, which then stays.
    ///
    /// Each wall keeps the directors of its own normals, in the frame of the common nodes: turning one about the normal of a wall, which the
    /// penalty against drilling holds, bends the other. Where walls are sheared, the penalty adds to the stiffness as much as its share of
    /// their area by the nodes of the corners: half a percent of the torsional stiffness of a square tube with two elements across each wall,
    /// half of that with four.
    #[must_use]
    pub fn joined<M: SurfaceMesh<S>>(&self, mut mesh: M, shells: &[&impl AsRef<MeshedShell>]) -> M {
        let free = mesh.free();
        let size = free.size();
        for place in mesh.rim() {
            let point = free.points[place];
            let is_here = |node: &&NodeId| (self.position(**node) - point).length().value() <= SAME_PLACE * size;
            if let Some(&node) = shells.iter().flat_map(|shell| &shell.as_ref().nodes).find(is_here) {
                mesh.take_over(place, node);
            }
        }
        mesh
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
                let mesh = self.joined(mesh, &faces.iter().collect::<Vec<_>>());
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
