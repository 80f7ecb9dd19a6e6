use super::Scalar;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A vector of three components in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<S>(pub [S; 3]);

impl<S: Scalar> Vec3<S> {
    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Vec3([S::zero(); 3])
    }
    /// From real components.
    pub fn from_f64(components: [f64; 3]) -> Self {
        Vec3(components.map(S::from))
    }
    /// From the first three entries of a slice.
    #[inline(always)]
    pub fn from_slice(components: &[S]) -> Self {
        Vec3([components[0], components[1], components[2]])
    }
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        self.0[0] * other.0[0] + self.0[1] * other.0[1] + self.0[2] * other.0[2]
    }
    /// Vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Vec3([b * z - c * y, c * x - a * z, a * y - b * x])
    }
    /// Euclidean length.
    #[inline(always)]
    pub fn norm(self) -> S {
        self.dot(self).sqrt()
    }
    /// Vector of length one in the same direction.
    pub fn normalized(self) -> Self {
        self * self.norm().recip()
    }
    /// Two unit vectors that complete the unit vector `self` to a right-handed triad.
    pub fn perpendiculars(self) -> [Self; 2] {
        // the coordinate axis least along self is a safe start; which one it is does not depend on derivatives
        let smallest = (0..3).min_by(|&i, &j| self.0[i].value().abs().total_cmp(&self.0[j].value().abs())).unwrap_or(0);
        let mut start = [0.0; 3];
        start[smallest] = 1.0;
        let first = self.cross(Vec3::from_f64(start)).normalized();
        [first, self.cross(first)]
    }
}

impl<S: Scalar> Add for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Vec3([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}
impl<S: Scalar> Sub for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Vec3([self.0[0] - other.0[0], self.0[1] - other.0[1], self.0[2] - other.0[2]])
    }
}
impl<S: Scalar> Neg for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Vec3([-self.0[0], -self.0[1], -self.0[2]])
    }
}
impl<S: Scalar> Mul<S> for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: S) -> Self {
        // written out: `map` of an array is not inlined
        Vec3([self.0[0] * factor, self.0[1] * factor, self.0[2] * factor])
    }
}
impl<S: Scalar> AddAssign for Vec3<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
