use super::FreeMesh;
use super::shells::MeshedShell;
use crate::assembly::NodeId;
use crate::scalar::{Scalar, Vector3};

/// A mesh that a shell can be made of: a [grid](super::ShellMesh), or a [free](FreeMesh) one.
pub trait SurfaceMesh<S: Scalar> {
    /// The shell on it.
    type Member;
    /// What tells the place of a node, for what depends on it.
    type Place;

    /// Its points and faces.
    fn free(&self) -> FreeMesh<S>;
    /// Why it is no mesh, in words that follow its name.
    fn mistake(&self) -> Option<String> {
        None
    }
    /// What the node at a point is called behind the name of the mesh.
    fn node_name(&self, point: usize) -> String;
    /// What the element on a face is called.
    fn element_name(&self, face: usize) -> String;
    /// The same for messages, with its place in a file if it is from one.
    fn element_place(&self, face: usize) -> String {
        self.element_name(face)
    }
    /// Where a node of a face stands.
    fn place(&self, face: usize, node: usize) -> Self::Place;
    /// Lines of points that are drawn.
    fn lines(&self) -> Vec<Vec<usize>>;
    /// Lets a point be a node that is there, at its place, unless it is one already.
    fn take_over(&mut self, point: usize, node: NodeId, place: Vector3<S>);
    /// Keeps why it is no mesh that can be joined, in words that follow its name.
    fn refuse(&mut self, why: String);
    /// The shell, with what the mesh knows of it.
    fn member(self, shell: MeshedShell) -> Self::Member;
}
