//! Friction of joints: how their surfaces slip, and what presses them together.

use crate::elements::{Constraint, Frame, Friction, NodeKind, NodePair, Parameter, State};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// How the surfaces of a joint slip whose first parameters are `point a`, `point b`, `normal u` and `normal w`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Surfaces {
    /// Along the axis u x w, through the point of b \[m/s\].
    Slide,
    /// About the axis u x w [rad/s].
    Bearing,
}

/// Coulomb friction of a joint: s is the velocity along its axis, or that of the turn about it, and the load the size F of its force. The limit is
/// mu (F + F0), in a bearing r mu (F + F0).
///
/// * `point a` .. `normal w`  of the joint
/// * `sliding`, `static`  coefficients mu [-]
/// * `preload`  F0 \[N\]
/// * `radius`  r of a bearing \[m\], 1 of a slide
#[derive(Hash)]
pub struct JointSurfaces {
    /// Nodes of the joint.
    pub nodes: NodePair,
    /// How they slip.
    pub surfaces: Surfaces,
    /// Which of its multipliers are forces.
    pub forces: Vec<usize>,
}

impl JointSurfaces {
    /// Number of parameters of the joint that tell its points and normals.
    pub const GEOMETRY: usize = 12;
}

/// Size of some numbers, with derivatives of zero where it is zero.
fn size<S: Scalar>(mut numbers: impl Iterator<Item = S>) -> S {
    let (first, second) = (numbers.next(), numbers.next());
    if let (Some(one), None) = (first, second) {
        return one.abs();
    }
    let squares = first.into_iter().chain(second).chain(numbers).map(|own| own * own).fold(S::zero(), |sum, own| sum + own);
    let is_zero = squares.less(S::from(f64::MIN_POSITIVE));
    is_zero.select(S::zero(), is_zero.select(S::one(), squares).sqrt())
}

impl Friction for JointSurfaces {
    fn nodes(&self) -> Vec<NodeKind> {
        self.nodes.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let geometry = super::points().into_iter().chain(super::vectors(&["normal u", "normal w"]));
        let own = [("sliding", "-"), ("static", "-"), ("preload", "N"), ("radius", "m")]
            .map(|(name, unit)| Parameter::new(name, unit));
        geometry.chain(own).collect()
    }
    fn slip<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, s: &mut [S]) {
        let [a, b] = self.nodes;
        let ((va, vb), (qa, qb)) = (v.split_at(a.dofs()), q.split_at(a.dofs()));
        let frame = Frame::of(a, qa);
        let axis = frame.direction(&p[6..]).cross(&frame.direction(&p[9..]));
        let turn = a.angular_velocity(va, qa);
        s[0] = axis.dot(&match self.surfaces {
            Surfaces::Bearing => b.angular_velocity(vb, qb) - turn,
            Surfaces::Slide => {
                let point = Vector3::first_three(&p[3..]);
                let arm = b.position(qb, point) - Vector3::first_three(qa);
                b.velocity(vb, qb, point) - (Vector3::first_three(va) + turn.cross(&arm))
            }
        });
    }
    fn load<S: Scalar>(&self, mu: &[S], _q: &[S], _p: &[S], _t: S) -> S {
        size(self.forces.iter().map(|&own| mu[own]))
    }
    fn limits<S: Scalar>(&self, load: S, _state: State<S>, p: &[S], _t: S) -> [S; 2] {
        let own = &p[Self::GEOMETRY..];
        let all = (load + own[2]) * own[3];
        [own[0] * all, own[1] * all]
    }
}

/// Nothing that holds nodes together: what rubs on them has no joint.
#[derive(Clone, Hash)]
pub struct Apart(pub Vec<NodeKind>);

impl Constraint for Apart {
    const EQUATIONS: usize = 0;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.clone()
    }
    fn g<S: Scalar>(&self, _q: &[S], _p: &[S], _t: S, _g: &mut [S]) {}
}
