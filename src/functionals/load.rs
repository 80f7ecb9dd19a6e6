use super::FunctionalScalar;
use crate::elements::forces::LoadFrame;
use crate::elements::{Anchor, AnyConstraint, Frame, Parameter};
use crate::scalar::{SpatialVector, Vector3};
use std::ops::Range;

/// Which load of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadKind {
    /// d . F [N].
    Force,
    /// d . M [N m].
    Moment,
    /// |F| [N].
    ForceNorm,
    /// |M| [N m].
    MomentNorm,
}

/// Force F or moment M about a point, with which a joint or driver acts on one of its nodes, from -A^T mu whatever the joint.
///
/// For a body with generalized forces (f, f_e): F = f, and M = R(e) G(e) f_e / 2 - (x - r) x F about the point x; with natural
/// coordinates and forces f_u, f_v, f_w on the axes, M = u x f_u + v x f_v + w x f_w - (x - r) x F.
///
/// * `direction x, y, z`  d, in the world or in the frame of the body [-]; ignored by norms
/// * `point x, y, z`  in the frame of the body [m]; read by moments
pub struct JointLoad {
    /// Which one.
    pub kind: LoadKind,
    /// The frame of the direction.
    pub frame: LoadFrame,
    /// Coordinates of the node among those of the joint.
    pub node: Range<usize>,
    /// What they are.
    pub on: Anchor,
}

impl JointLoad {
    /// Its parameters.
    pub const PARAMETERS: [Parameter; 6] = [
        Parameter::new("direction x", "-"),
        Parameter::new("direction y", "-"),
        Parameter::new("direction z", "-"),
        Parameter::new("point x", "m"),
        Parameter::new("point y", "m"),
        Parameter::new("point z", "m"),
    ];

    /// The load, from the coordinates of the joint's nodes, its multipliers and parameters, and the parameters of the load.
    pub fn value<S: FunctionalScalar>(
        &self,
        joint: &dyn AnyConstraint,
        q: &[S],
        mu: &[S],
        joint_p: &[S],
        p: &[S],
        t: S,
    ) -> S {
        let mut reaction = vec![S::zero(); q.len()];
        S::constraint(joint).add_reaction(q, mu, joint_p, t, &mut reaction);
        let (q, generalized) = (&q[self.node.clone()], &reaction[self.node.clone()]);
        let mut load = -Vector3::first_three(generalized);
        let mut direction = Vector3::first_three(p);
        if self.on.has_axes() {
            let frame = Frame::of(self.on, q);
            if matches!(self.kind, LoadKind::Moment | LoadKind::MomentNorm) {
                load = -self.on.moment(q, generalized) - frame.direction(&p[3..]).cross(&load);
            }
            if self.frame == LoadFrame::Body {
                direction = frame.direction(p);
            }
        }
        match self.kind {
            LoadKind::Force | LoadKind::Moment => load.dot(&direction),
            LoadKind::ForceNorm | LoadKind::MomentNorm => load.length(),
        }
    }
}
