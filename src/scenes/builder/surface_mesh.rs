use super::FreeMesh;
use super::shells::MeshedShell;
use crate::scalar::Scalar;

/// A mesh that a shell can be made of: a [grid](super::ShellMesh), or a [free](FreeMesh) one.
pub trait SurfaceMesh<S: Scalar> {
    /// The shell on it.
    type Member;
    /// What tells the place of a node, for what depends on it.
    type Place;

    /// Its points and faces.
    fn free(&self) -> FreeMesh<S>;
    /// Its points with what is said of them, to be changed.
    fn free_mut(&mut self) -> &mut FreeMesh<S>;
    /// Where a node of a face stands.
    fn place(&self, face: usize, node: usize) -> Self::Place;
    /// Lines of points that are drawn.
    fn lines(&self) -> Vec<Vec<usize>> {
        self.free().edges().into_iter().map(|edge| edge.points).collect()
    }
    /// The shell, with what the mesh knows of it.
    fn member(self, shell: MeshedShell) -> Self::Member;
}
