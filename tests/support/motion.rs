//! Random coordinates of nodes, and rigid motions of all nodes together.

use super::Random;
use costate::elements::NodeKind;
use costate::scalar::{Quaternion, SpatialVector, Vector3};

/// Positions in [-1, 1) and, for bodies, Euler parameters or axes of the length that `norm` gives, for cables' nodes slopes of it.
pub fn random_coordinates(nodes: &[NodeKind], random: &mut Random, norm: impl Fn(&mut Random) -> f64) -> Vec<f64> {
    let mut q = Vec::new();
    for node in nodes {
        q.extend(random.vector(3));
        let size = if *node == NodeKind::Body { 4 } else { 3 };
        for _ in 0..(node.dofs() - 3) / size {
            let mut e = random.vector(size);
            if e.iter().all(|&e| e == 0.0) {
                e[0] = 1.0;
            }
            let scale = norm(random) / e.iter().map(|e| e * e).sum::<f64>().sqrt();
            q.extend(e.iter().map(|e| e * scale));
        }
    }
    q
}

/// A turn about the origin, then a shift [m].
pub struct RigidMotion {
    /// Of any length but zero.
    pub rotation: Quaternion<f64>,
    pub translation: Vector3<f64>,
}

impl RigidMotion {
    /// Coordinates of the nodes after the motion.
    pub fn of_coordinates(&self, nodes: &[NodeKind], q: &[f64]) -> Vec<f64> {
        let mut moved = self.of_rates(nodes, q);
        let mut first = 0;
        for node in nodes {
            (0..3).for_each(|i| moved[first + i] += self.translation[i]);
            first += node.dofs();
        }
        moved
    }

    /// Velocities, accelerations or generalized forces after the motion: turned, not shifted.
    pub fn of_rates(&self, nodes: &[NodeKind], rates: &[f64]) -> Vec<f64> {
        let norm = self.rotation.norm_squared().sqrt();
        let turn = Quaternion(self.rotation.0.map(|e| e / norm));
        let mut turned = Vec::new();
        for node in nodes {
            let rate = &rates[turned.len()..][..node.dofs()];
            if *node == NodeKind::Body {
                turned.extend(turn.rotate(Vector3::first_three(rate)).components());
                turned.extend(turn.times(Quaternion::from_slice(&rate[3..])).0);
            } else {
                turned
                    .extend(rate.chunks_exact(3).flat_map(|vector| turn.rotate(Vector3::first_three(vector)).components()));
            }
        }
        turned
    }
}

/// Coordinates of a body's node at a place with the given rotation.
pub fn body_coordinates(node: NodeKind, position: Vector3<f64>, turn: Quaternion<f64>) -> Vec<f64> {
    let rotation = match node {
        NodeKind::Body => turn.0.to_vec(),
        NodeKind::Natural => turn.columns().iter().flat_map(|axis| axis.components()).collect(),
        _ => panic!("{node:?} is no body"),
    };
    [&position.components()[..], &rotation].concat()
}
