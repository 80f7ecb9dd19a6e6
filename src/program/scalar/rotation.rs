use super::{Scalar, SpatialVector, Vector3};

/// Euler parameters e = (e0, e1, e2, e3) of a rotation, scalar part first.
///
/// R(e) = (e0^2 - |u|^2) I + 2 u u^T + 2 e0 u~ with u = (e1, e2, e3): a rotation for |e| = 1, quadratic in e everywhere, so that
/// its derivatives are polynomials. Body-frame angular velocity: omega = 2 G(e) de/dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion<S>(pub [S; 4]);

impl<S: Scalar> Quaternion<S> {
    /// No rotation.
    #[inline(always)]
    pub fn identity() -> Self {
        Quaternion([1.0, 0.0, 0.0, 0.0].map(S::from))
    }
    /// From the first four entries of a slice.
    #[inline(always)]
    pub fn from_slice(e: &[S]) -> Self {
        Quaternion([e[0], e[1], e[2], e[3]])
    }
    /// Rotation by `angle` \[rad\] about the unit vector `axis`.
    pub fn about(axis: Vector3<S>, angle: S) -> Self {
        let (s, c) = (angle * 0.5).sin_cos();
        let u = axis * s;
        Quaternion([c, u[0], u[1], u[2]])
    }
    /// The rotation that takes the x axis to the unit vector `direction`, without twist about it.
    ///
    /// # Panics
    /// Not for any unit vector: the direction -x is reached by half a turn about z.
    pub fn x_axis_to(direction: Vector3<S>) -> Self {
        let [x, y, z] = direction.components();
        if x.value() < -0.9 {
            // past the nearly opposite direction: half a turn about z first, then the small rest
            let rest = Self::x_axis_to(-direction);
            return rest.times(Quaternion([0.0, 0.0, 0.0, 1.0].map(S::from)));
        }
        // half-angle formulas: e ~ (1 + x, 0, -z, y)
        let norm = ((x + 1.0) * 2.0).sqrt();
        Quaternion([norm * 0.5, S::zero(), -z / norm, y / norm])
    }
    /// The product: first `other`, then `self`.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        let (a, u) = self.parts();
        let (b, w) = other.parts();
        let v = w * a + u * b + u.cross(&w);
        Quaternion([a * b - u.dot(&w), v[0], v[1], v[2]])
    }
    /// Opposite rotation (for unit length).
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        let [a, x, y, z] = self.0;
        Quaternion([a, -x, -y, -z])
    }
    /// Scalar and vector part.
    #[inline(always)]
    pub fn parts(self) -> (S, Vector3<S>) {
        let [a, x, y, z] = self.0;
        (a, Vector3::new(x, y, z))
    }
    /// R(e) s: a vector of the body frame in world components.
    #[inline(always)]
    pub fn rotate(self, s: Vector3<S>) -> Vector3<S> {
        let (a, u) = self.parts();
        s * (a * a - u.dot(&u)) + u * (u.dot(&s) * 2.0) + u.cross(&s) * (a * 2.0)
    }
    /// R(e) by columns: cheaper than [`rotate`](Quaternion::rotate) for two and more vectors.
    #[inline(always)]
    pub fn columns(self) -> [Vector3<S>; 3] {
        let [a, x, y, z] = self.0;
        let (a2, x2, y2, z2) = (a * a, x * x, y * y, z * z);
        let two = |s: S| s + s;
        let (xy, xz, yz) = (x * y, x * z, y * z);
        let (ax, ay, az) = (a * x, a * y, a * z);
        let (minus, plus) = (a2 - z2, x2 - y2);
        [
            Vector3::new(a2 + x2 - y2 - z2, two(xy + az), two(xz - ay)),
            Vector3::new(two(xy - az), minus - plus, two(yz + ax)),
            Vector3::new(two(xz + ay), two(yz - ax), a2 + z2 - x2 - y2),
        ]
    }
    /// R(e)^T s: a vector of the world in body-frame components.
    #[inline(always)]
    pub fn rotate_back(self, s: Vector3<S>) -> Vector3<S> {
        self.conjugate().rotate(s)
    }
    /// Derivative of R(e) s along de: the bilinear form B(e, s) de with B = d(R s)/de.
    #[inline(always)]
    pub fn rotate_rate(self, rate: Self, s: Vector3<S>) -> Vector3<S> {
        let (a, u) = self.parts();
        let (b, w) = rate.parts();
        let along = s * (a * b - u.dot(&w)) + u * w.dot(&s) + w * u.dot(&s) + w.cross(&s) * a + u.cross(&s) * b;
        along * S::from(2.0)
    }
    /// G(e) de: half the body-frame angular velocity of the rate `de`.
    #[inline(always)]
    pub fn g_times(self, rate: Self) -> Vector3<S> {
        let (a, u) = self.parts();
        let (b, w) = rate.parts();
        w * a - u * b - u.cross(&w)
    }
    /// G(e)^T m.
    #[inline(always)]
    pub fn g_transposed_times(self, m: Vector3<S>) -> [S; 4] {
        let (a, u) = self.parts();
        let w = m * a + u.cross(&m);
        [-u.dot(&m), w[0], w[1], w[2]]
    }
    /// de/dt for the body-frame angular velocity omega: G(e)^T omega / 2.
    pub fn rate_of_body_velocity(self, omega_body: Vector3<S>) -> [S; 4] {
        self.g_transposed_times(omega_body * S::from(0.5))
    }
    /// Euler parameters of the rotation with the given orthonormal columns; the largest of the four is taken positive and divides.
    ///
    /// Source: Shepperd (1978).
    pub fn of_columns(columns: &[Vector3<S>; 3]) -> Self {
        let entry = |i: usize, j: usize| columns[j][i];
        let (xx, yy, zz) = (entry(0, 0), entry(1, 1), entry(2, 2));
        // four times the squares
        let squares = [xx + yy + zz + 1.0, xx - yy - zz + 1.0, yy - xx - zz + 1.0, zz - xx - yy + 1.0];
        let largest = (0..4).max_by(|&i, &j| squares[i].value().total_cmp(&squares[j].value())).unwrap_or(0);
        let twice = squares[largest].sqrt();
        let with_scalar = |i: usize| entry((i + 2) % 3, (i + 1) % 3) - entry((i + 1) % 3, (i + 2) % 3);
        let together = |i: usize, j: usize| entry(i, j) + entry(j, i);
        let products: [S; 4] = std::array::from_fn(|k| match (largest, k) {
            (0, 0) | (1, 1) | (2, 2) | (3, 3) => squares[largest],
            (0, k) | (k, 0) => with_scalar(k - 1),
            (i, j) => together(i - 1, j - 1),
        });
        Quaternion(products.map(|product| product / (twice * 2.0)))
    }
    /// |e|^2.
    #[inline(always)]
    pub fn norm_squared(self) -> S {
        self.dot(self)
    }
    /// Scalar product of all four components.
    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        let ([a, x, y, z], [b, u, v, w]) = (self.0, other.0);
        a * b + x * u + y * v + z * w
    }
}

/// B(e, s)^T f with B = d(R(e) s)/de: the generalized force of a world force f at the body point s.
#[inline(always)]
pub fn rotation_gradient_transposed<S: Scalar>(e: Quaternion<S>, s: Vector3<S>, f: Vector3<S>) -> [S; 4] {
    let (a, u) = e.parts();
    let sf = s.dot(&f);
    let scalar = (a * sf + u.cross(&s).dot(&f)) * 2.0;
    let vector = (s * u.dot(&f) + f * s.dot(&u) - u * sf + s.cross(&f) * a) * S::from(2.0);
    [scalar, vector[0], vector[1], vector[2]]
}

/// J x for the six numbers (xx, yy, zz, xy, xz, yz) of the symmetric tensor J.
#[inline(always)]
pub fn tensor_times<S: Scalar>(j: &[S], x: Vector3<S>) -> Vector3<S> {
    let [x, y, z] = x.components();
    Vector3::new(j[0] * x + j[3] * y + j[4] * z, j[3] * x + j[1] * y + j[5] * z, j[4] * x + j[5] * y + j[2] * z)
}

/// Angle \[rad\] in (-pi, pi] by which `to` is turned from `from` about the unit vector `axis`.
#[inline(always)]
pub fn angle_about<S: Scalar>(axis: Vector3<S>, from: Vector3<S>, to: Vector3<S>) -> S {
    axis.dot(&from.cross(&to)).atan2(from.dot(&to))
}

/// Combination of three columns: R s for the columns of R.
#[inline(always)]
pub fn combine_columns<S: Scalar>(columns: &[Vector3<S>; 3], s: Vector3<S>) -> Vector3<S> {
    columns[0] * s[0] + columns[1] * s[1] + columns[2] * s[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn euler_parameters_come_back_from_columns_whichever_is_largest() {
        for largest in 0..4 {
            let mut e = [0.3, -0.2, 0.1, -0.25];
            e[largest] = 0.9;
            let norm = e.iter().map(|e| e * e).sum::<f64>().sqrt();
            let e = Quaternion(e.map(|e| e / norm));
            let back = Quaternion::of_columns(&e.columns());
            assert!(e.0.iter().zip(back.0).all(|(e, back)| (e - back).abs() < 1e-15), "{e:?} {back:?}");
        }
    }

    #[test]
    fn columns_rotate_like_the_formula_for_any_length() {
        let e = Quaternion([0.7, -0.4, 1.1, 0.3]);
        let s = Vector3::new(0.2, -1.3, 0.9);
        let difference = combine_columns(&e.columns(), s) - e.rotate(s);
        assert!(difference.length() < 1e-15);
    }
}
