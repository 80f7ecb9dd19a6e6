use super::builder::MechanismBuilder;
use crate::elements::NodeKind;
use crate::functionals::joint_force_and_moment;
use crate::scalar::{SpatialVector, Vector3};
use std::ops::Range;

/// The last node of a joint or driver that moves and has a place in space, with the point at which the joint acts on it.
#[derive(Clone, Debug)]
pub struct JointEnd {
    /// Place of the joint among the constraints of the model.
    pub joint: usize,
    /// Whether the node can turn, so that the joint can act on it by a moment.
    pub turns: bool,
    kind: NodeKind,
    /// Coordinates of the node among those of the joint.
    own: Range<usize>,
    /// In the frame of the node \[m\].
    point: [f64; 3],
}

impl MechanismBuilder<f64> {
    /// One for each joint that acts on something in space. The point is that of the joint where it has one, else the origin of the node.
    #[doc(hidden)]
    pub fn joint_ends(&self) -> Vec<JointEnd> {
        let end = |joint: usize| -> Option<JointEnd> {
            let constraint = &self.model.constraints[joint];
            let (mut first, mut found) = (0, None);
            for (place, &node) in constraint.nodes.iter().enumerate() {
                let node = &self.model.nodes[node.0];
                let own = first..first + node.dofs.len();
                first = own.end;
                if let Some(kind) = node.kind.in_space().filter(|_| !node.fixed) {
                    let list = constraint.physics.parameter_list();
                    let named = |name: &str| self.named_vector(&list, constraint.parameters.clone(), name);
                    let point = named(if place == 0 { "point a" } else { "point b" }).unwrap_or_default();
                    found = Some(JointEnd { joint, turns: kind.has_axes(), kind, own, point });
                }
            }
            found
        };
        (0..self.model.constraints.len()).filter_map(end).collect()
    }

    /// Force \[N\] in the world with which a joint acts on the node, and its moment about the point [N m], from coordinates and multipliers of
    /// the whole mechanism.
    pub fn joint_load(&self, end: &JointEnd, (q, mu): (&[f64], &[f64]), t: f64) -> [[f64; 3]; 2] {
        let joint = &self.model.constraints[end.joint];
        let nodes = joint.nodes.iter().flat_map(|&node| q[self.model.nodes[node.0].dofs.clone()].to_vec());
        let (q, p) = (nodes.collect::<Vec<f64>>(), &self.numbers.p[joint.parameters.clone()]);
        let generalized = joint.physics.reaction(&q, &mu[joint.equations.clone()], p, t);
        let (q, generalized) = (&q[end.own.clone()], &generalized[end.own.clone()]);
        joint_force_and_moment(end.kind, q, generalized, Vector3::from(end.point)).map(|vector| vector.components())
    }
}
