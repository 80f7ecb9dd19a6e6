use super::Scalar;
use nalgebra::Vector3;

/// What vectors in space need beside nalgebra's own operations, for every scalar.
///
/// nalgebra's `norm` is that of complex numbers, which conjugates: [`length`](SpatialVector::length) takes its place.
pub trait SpatialVector<S>: Sized {
    /// From real components.
    fn from_f64(components: [f64; 3]) -> Self;
    /// From the first three entries of a slice that may go on.
    fn first_three(entries: &[S]) -> Self;
    /// The components as an array.
    fn components(self) -> [S; 3];
    /// Euclidean length.
    fn length(self) -> S;
    /// Vector of length one in the same direction.
    fn unit(self) -> Self;
    /// Two unit vectors that complete the unit vector `self` to a right-handed triad.
    fn perpendiculars(self) -> [Self; 2];
}

impl<S: Scalar> SpatialVector<S> for Vector3<S> {
    fn from_f64(components: [f64; 3]) -> Self {
        Vector3::from(components.map(S::from))
    }
    #[inline(always)]
    fn first_three(entries: &[S]) -> Self {
        Vector3::new(entries[0], entries[1], entries[2])
    }
    #[inline(always)]
    fn components(self) -> [S; 3] {
        let [components] = self.data.0;
        components
    }
    #[inline(always)]
    fn length(self) -> S {
        self.dot(&self).sqrt()
    }
    fn unit(self) -> Self {
        self * self.length().recip()
    }
    fn perpendiculars(self) -> [Self; 2] {
        // the coordinate axis least along self is a safe start; which one it is does not depend on derivatives
        let smallest = (0..3).min_by(|&i, &j| self[i].value().abs().total_cmp(&self[j].value().abs())).unwrap_or(0);
        let mut start = [0.0; 3];
        start[smallest] = 1.0;
        let first = self.cross(&Vector3::from_f64(start)).unit();
        [first, self.cross(&first)]
    }
}
