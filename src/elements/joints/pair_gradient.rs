use crate::elements::{Anchor, Frame};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3, combine_columns};

/// The gradient of a sum of scalar products between two bodies towards their coordinates, gathered towards their frames first: what
/// mu . g of most joints is made of.
pub(crate) struct PairGradient<S> {
    ends: [Anchor; 2],
    frames: [Frame<S>; 2],
    /// Towards origins and axes.
    towards: [Frame<S>; 2],
}

impl<S: Scalar> PairGradient<S> {
    /// Of an empty sum.
    #[inline(always)]
    pub fn new(ends: [Anchor; 2], q: &[S]) -> Self {
        let zero = Frame { origin: Vector3::zeros(), axes: [Vector3::zeros(); 3] };
        PairGradient { ends, frames: Frame::pair(ends, q), towards: [zero; 2] }
    }

    /// R_a n in the world.
    #[inline(always)]
    pub fn of_a(&self, vector: Vector3<S>) -> Vector3<S> {
        combine_columns(&self.frames[0].axes, vector)
    }

    /// R_b d in the world.
    #[inline(always)]
    pub fn of_b(&self, vector: Vector3<S>) -> Vector3<S> {
        combine_columns(&self.frames[1].axes, vector)
    }

    /// R_b d in the frame of a.
    #[inline(always)]
    pub fn seen_from_a(&self, vector: Vector3<S>) -> Vector3<S> {
        self.frames[0].seen(self.of_b(vector))
    }

    /// World position of a point of a body [m]; a node without axes has no other point than itself.
    #[inline(always)]
    fn point(&self, body: usize, s: &[S]) -> Vector3<S> {
        let frame = &self.frames[body];
        if self.ends[body].has_axes() { frame.point(s) } else { frame.origin }
    }

    /// x_b - x_a for the points of the first six parameters [m].
    #[inline(always)]
    pub fn gap(&self, points: &[S]) -> Vector3<S> {
        self.point(1, &points[3..]) - self.point(0, points)
    }

    /// Adds f . R s of a body for a vector f of the world.
    #[inline(always)]
    fn add_direction(&mut self, body: usize, s: Vector3<S>, f: Vector3<S>) {
        let axes = &mut self.towards[body].axes;
        for k in 0..3 {
            axes[k] += f * s[k];
        }
    }

    /// Adds f . (x_b - x_a) for a vector f of the world.
    #[inline(always)]
    pub fn add_gap(&mut self, points: &[S], f: Vector3<S>) {
        self.towards[0].origin += -f;
        self.towards[1].origin += f;
        self.add_direction(0, Vector3::first_three(points), -f);
        self.add_direction(1, Vector3::first_three(&points[3..]), f);
    }

    /// Adds (R_a n) . (x_b - x_a).
    #[inline(always)]
    pub fn add_component(&mut self, points: &[S], n: Vector3<S>) {
        let (along, gap) = (self.of_a(n), self.gap(points));
        self.add_gap(points, along);
        self.add_direction(0, n, gap);
    }

    /// Adds (R_b d) . (x_b - x_a).
    #[inline(always)]
    pub fn add_component_of_b(&mut self, points: &[S], d: Vector3<S>) {
        let (along, gap) = (self.of_b(d), self.gap(points));
        self.add_gap(points, along);
        self.add_direction(1, d, gap);
    }

    /// Adds (R_a n) . (R_b d).
    #[inline(always)]
    pub fn add_product(&mut self, n: Vector3<S>, d: Vector3<S>) {
        let (of_a, of_b) = (self.of_a(n), self.of_b(d));
        self.add_direction(0, n, of_b);
        self.add_direction(1, d, of_a);
    }

    /// Adds (R_a n) . w for a vector w of the world.
    #[inline(always)]
    pub fn add_direction_of_a(&mut self, n: Vector3<S>, w: Vector3<S>) {
        self.add_direction(0, n, w);
    }

    /// Adds moment . w with the rotation w that b has beyond `relative`, as [`remaining_rotation`](super::remaining_rotation) writes it; what
    /// belongs to Euler parameters goes to `r`.
    #[inline(always)]
    pub fn add_remaining_rotation(&mut self, relative: &[S], moment: Vector3<S>, q: &[S], r: &mut [S]) {
        let relative = Quaternion::from_slice(relative);
        if self.ends == [Anchor::Body; 2] {
            return add_relative_turn([&q[3..], &q[10..]], [Quaternion::identity(), relative], moment, r);
        }
        let half = S::from(0.5);
        for (k, wanted) in relative.columns().into_iter().enumerate() {
            let mut unit = [S::zero(); 3];
            unit[k] = S::one();
            // moment . (c x R_a^T d) = (R_a (moment x c)) . d
            self.add_product(moment.cross(&wanted) * half, Vector3::from(unit));
        }
    }

    /// Adds `moment` times the angle about `axis` from `from` to `to`, the first two vectors of a, the last one of b.
    ///
    /// With y = R_a^T R_b to, m = axis x from: angle = atan2(m . y, from . y).
    #[inline(always)]
    pub fn add_angle(&mut self, [axis, from, to]: [Vector3<S>; 3], moment: S) {
        let y = self.seen_from_a(to);
        let across = axis.cross(&from);
        let (sine, cosine) = (across.dot(&y), from.dot(&y));
        let scale = moment / (sine * sine + cosine * cosine);
        self.add_product(across * (cosine * scale) - from * (sine * scale), to);
    }

    /// Adds what was gathered to the gradient towards the coordinates.
    #[inline(always)]
    pub fn write(&self, q: &[S], r: &mut [S]) {
        let [a, b] = self.ends;
        let (qa, qb) = q.split_at(a.dofs());
        let (ra, rb) = r.split_at_mut(a.dofs());
        a.add_gradient(qa, &self.towards[0], ra);
        b.add_gradient(qb, &self.towards[1], rb);
    }
}

/// Adds moment . 2 vec(f_a* f_b) towards the Euler parameters of two bodies with the frames f_a = e_a o_a, f_b = e_b o_b*.
///
/// With vec(x* y) = G(x) y = -G(y) x: 2 G(f_a)^T moment towards f_b, -2 G(f_b)^T moment towards f_a, both turned back by o.
#[inline(always)]
pub(crate) fn add_relative_turn<S: Scalar>(
    [ea, eb]: [&[S]; 2],
    [own_a, own_b]: [Quaternion<S>; 2],
    moment: Vector3<S>,
    r: &mut [S],
) {
    let fa = Quaternion::from_slice(ea).times(own_a);
    let fb = Quaternion::from_slice(eb).times(own_b.conjugate());
    let twice = moment + moment;
    let towards_b = Quaternion(fa.g_transposed_times(twice)).times(own_b);
    let towards_a = Quaternion(fb.g_transposed_times(twice)).times(own_a.conjugate());
    for i in 0..4 {
        r[3 + i] -= towards_a.0[i];
        r[10 + i] += towards_b.0[i];
    }
}
