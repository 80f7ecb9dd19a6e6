use crate::elements::{Anchor, Element, Parameter, State};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// A spring along the line between two points: V = k (l - l0)^2 / 2 [J], l = |x_b - x_a|.
///
/// * `stiffness`  k [N/m], 0 or greater
/// * `rest length`  l0 [m], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies [m]
pub struct LineSpring {
    /// First end.
    pub a: Anchor,
    /// Second end.
    pub b: Anchor,
}

impl Element for LineSpring {
    const DOFS: usize = 24;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::non_negative("stiffness", "N/m"),
        Parameter::non_negative("rest length", "m"),
        Parameter::new("point a x", "m"),
        Parameter::new("point a y", "m"),
        Parameter::new("point a z", "m"),
        Parameter::new("point b x", "m"),
        Parameter::new("point b y", "m"),
        Parameter::new("point b z", "m"),
    ];
    const ENERGIES: bool = true;
    const CONSTANT_MASS: bool = true;

    fn dofs(&self) -> usize {
        self.a.dofs() + self.b.dofs()
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let (qa, qb) = q.split_at(self.a.dofs());
        let from = self.a.position(qa, Vector3::first_three(&p[2..]));
        let to = self.b.position(qb, Vector3::first_three(&p[5..]));
        let stretch = (to - from).length() - p[1];
        stretch * stretch * p[0] * 0.5
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let split = self.a.dofs();
        let (qa, qb) = s.q.split_at(split);
        let (point_a, point_b) = (Vector3::first_three(&p[2..]), Vector3::first_three(&p[5..]));
        let between = self.b.position(qb, point_b) - self.a.position(qa, point_a);
        let length = between.length();
        let tension = between * (p[0] * (length - p[1]) / length);
        let (force_a, force_b) = r.split_at_mut(split);
        self.a.add_force(qa, point_a, -tension, force_a);
        self.b.add_force(qb, point_b, tension, force_b);
    }
}
