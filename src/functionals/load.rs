use crate::elements::forces::LoadFrame;
use crate::elements::{ConstraintPhysics, Frame, NodeKind, split_arguments};
use crate::program::ArgumentKind::{Coordinate, MeasureParameter, Multiplier, Parameter as OfPart, Time, Velocity};
use crate::program::{Digest, Formula};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Which load of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LoadKind {
    /// d . F \[N\].
    Force,
    /// d . M [N m].
    Moment,
    /// |F| \[N\].
    ForceNorm,
    /// |M| [N m].
    MomentNorm,
    /// -A^T mu . v, the power with which the joint works on what it holds \[W\]: for all its nodes that of its driver, mu . dg/dt at rest.
    Power,
}

/// Force F or moment M about a point, with which a joint or driver acts on one of its nodes, from -A^T mu whatever the joint.
///
/// For a body with generalized forces (f, f_e): F = f, and M = R(e) G(e) f_e / 2 - (x - r) x F about the point x; with natural
/// coordinates and forces f_u, f_v, f_w on the axes, M = u x f_u + v x f_v + w x f_w - (x - r) x F.
///
/// * `direction x, y, z`  d, in the world or in the frame of the body [-]; ignored by norms
/// * `point x, y, z`  in the frame of the body \[m\]; read by moments
pub struct JointLoad {
    kind: LoadKind,
    /// The frame of the direction.
    frame: LoadFrame,
    /// Coordinates of the node among those of the joint.
    pub(super) node: Range<usize>,
    /// What they are.
    pub(super) on: NodeKind,
    /// That of the joint for which it was first asked, and the law of that joint.
    formula: OnceLock<(Digest, Arc<Formula>)>,
}

/// Force and moment about a point of the node with which a joint acts on it, in the world, from the coordinates of the node and the
/// generalized forces A^T mu on them; for nodes without axes the moment is the force, as nothing there can turn.
pub fn joint_force_and_moment<S: Scalar>(on: NodeKind, q: &[S], generalized: &[S], point: Vector3<S>) -> [Vector3<S>; 2] {
    let force = -Vector3::first_three(generalized);
    if !on.has_axes() {
        return [force, force];
    }
    [force, -on.moment(q, generalized) - Frame::of(on, q).direction(&point.components()).cross(&force)]
}

impl JointLoad {
    /// Number of its parameters: a direction and a point.
    pub const PARAMETERS: usize = 6;

    /// A load of one of a joint's nodes: the place of the node's coordinates among those of the joint, and what they are.
    pub fn new(kind: LoadKind, frame: LoadFrame, node: Range<usize>, on: NodeKind) -> Self {
        JointLoad { kind, frame, node, on, formula: OnceLock::new() }
    }

    /// The power of a joint on some of its nodes that follow each other: the place of their coordinates among those of the joint.
    pub fn power(nodes: Range<usize>) -> Self {
        JointLoad::new(LoadKind::Power, LoadFrame::World, nodes, NodeKind::Point)
    }

    /// Whether it is a power.
    pub(super) fn is_power(&self) -> bool {
        self.kind == LoadKind::Power
    }

    /// The load as a function of (v, q) of the joint's nodes, its multipliers and parameters, the parameters of the load, and time.
    pub fn formula(&self, joint: &ConstraintPhysics) -> &Arc<Formula> {
        &self.of(joint).1
    }

    /// Whether it was made for a joint of this law.
    pub(super) fn is_of(&self, joint: &ConstraintPhysics) -> bool {
        self.of(joint).0 == joint.law()
    }

    fn of(&self, joint: &ConstraintPhysics) -> &(Digest, Arc<Formula>) {
        self.formula.get_or_init(|| {
            let (n, count, m) = (joint.dof_count(), joint.equation_count(), joint.parameter_count());
            let own = (MeasureParameter, Self::PARAMETERS);
            let of_joint = [(Velocity, n), (Coordinate, n), (Multiplier, count), (OfPart, m), own, (Time, 1)];
            let formula = Formula::once(&(joint.origin(), self.kind, self.frame, &self.node, self.on), || {
                Formula::record(of_joint, |x| {
                    let [v, q, mu, joint_p, p, t] = split_arguments(x, [n, n, count, m, Self::PARAMETERS, 1]);
                    let reaction = joint.recorded_reaction([v, q, mu, joint_p], t[0], self.is_power());
                    let [v, q, reaction] = [v, q, &reaction].map(|own| &own[self.node.clone()]);
                    vec![self.value([v, q], reaction, p)]
                })
            });
            (joint.law(), formula.expect("a load chooses nothing by values"))
        })
    }

    /// The load, from velocities and coordinates of its node, the generalized forces A^T mu on them, and its parameters.
    fn value<S: Scalar>(&self, [v, q]: [&[S]; 2], generalized: &[S], p: &[S]) -> S {
        if self.is_power() {
            return -generalized.iter().zip(v).map(|(&force, &rate)| force * rate).sum::<S>();
        }
        let [force, moment] = joint_force_and_moment(self.on, q, generalized, Vector3::first_three(&p[3..]));
        let load = if matches!(self.kind, LoadKind::Moment | LoadKind::MomentNorm) { moment } else { force };
        let mut direction = Vector3::first_three(p);
        if self.on.has_axes() && self.frame == LoadFrame::Body {
            direction = Frame::of(self.on, q).direction(p);
        }
        match self.kind {
            LoadKind::Force | LoadKind::Moment => load.dot(&direction),
            LoadKind::ForceNorm | LoadKind::MomentNorm | LoadKind::Power => load.length(),
        }
    }
}
