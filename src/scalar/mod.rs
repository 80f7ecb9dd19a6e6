//! The number types: one formula in, every derivative out.
//!
//! [`Scalar`] is implemented for a closed list of types, each for one purpose:
//!
//! | type | carries | used for |
//! |---|---|---|
//! | `f64` | value | simulation |
//! | [`Complex64`] | value and one complex perturbation | complex-step verification |
//! | [`Dual<S, N>`](Dual) | value and N directional derivatives | Jacobians, tangent runs |
//! | [`Taylor<S>`](Taylor) | value, first and second derivative in one direction | time derivatives of constraints |
//! | [`Reverse<S>`](Reverse) | value and a place on a tape | reactions A^T mu, adjoint products, the chain to design variables |
//!
//! `Dual` and `Taylor` nest over any scalar of the list, `Reverse` over `f64`, `Complex64` and eight dual lanes
//! ([`Rev`] is the first). A sixth, [`Curved`], is a tape with second derivatives for the Jacobian of reactions.
//! Branches look at [`Scalar::value`] only, so every type takes the same path through a formula. Complex numbers are
//! those of num-complex and vectors those of nalgebra, with [`SpatialVector`] beside them. The other types are our own
//! because two needs exclude the usual crates: a constraint's second time derivative inside a complex-step run is a
//! `Taylor<Complex64>`, and functions whose derivative is infinite at the point of evaluation (`sqrt` at 0) must not
//! turn a vanishing perturbation into NaN.

mod complex;
mod curved;
mod dual;
pub(crate) mod jet;
mod real;
mod reverse;
mod rotation;
mod taylor;
mod vector;
mod wide;

pub use complex::COMPLEX_STEP;
pub use curved::{Curved, Direction, curvature};
pub use dual::Dual;
pub use reverse::{Recordable, Records, Rev, Reverse, Tape, add_gradient, add_gradients};
pub use rotation::{Quaternion, angle_about, combine_columns, rotation_gradient_transposed, tensor_times};
pub(crate) use rotation::{RotationRows, g_form, g_rows, rotation_form, rotation_rows, tensor_gradient, tensor_times_rows};
pub use taylor::Taylor;
pub use vector::SpatialVector;
pub(crate) use wide::{Job, widest};

pub use nalgebra::{Matrix3, Vector3};
pub use num_complex::Complex64;

use num_traits::{One, Zero};

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// Number of derivative lanes evaluated together; 8 doubles fill the widest vector registers and unroll well on others.
pub const LANES: usize = 8;

/// Eight first derivatives at once: the type behind every Jacobian column and every tangent run.
pub type Lanes = Dual<f64, LANES>;

/// A number with which elements, constraints and functionals are evaluated.
///
/// Laws, held by `tests/scalar_laws.rs` for every type and function: the value part equals the `f64` result bit for bit
/// where the function is elementary (but for quotients of complex numbers, which round otherwise); derivative parts
/// follow the chain rule; a zero derivative part stays zero where the derivative of the function is infinite.
pub trait Scalar:
    Copy
    + Debug
    + Default
    + PartialEq
    + Zero
    + One
    + Send
    + Sync
    + 'static
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + Sum
{
    /// The real value, without any derivative part. For branches only: inside a formula it silently drops the
    /// derivative.
    fn value(self) -> f64;
    /// True if every derivative part is zero.
    fn is_constant(self) -> bool;

    fn sqrt(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn tan(self) -> Self;
    fn asin(self) -> Self;
    fn acos(self) -> Self;
    fn atan(self) -> Self;
    fn sinh(self) -> Self;
    fn cosh(self) -> Self;
    fn tanh(self) -> Self;
    /// 1 / x.
    fn recip(self) -> Self;
    /// x^n for an integer n.
    fn powi(self, exponent: i32) -> Self;
    /// x^r for a real exponent r; negative x only makes sense for integer r.
    fn powf(self, exponent: f64) -> Self;
    /// Angle of the point (x, y) with x = `other`: atan2(self, other), in (-pi, pi].
    fn atan2(self, other: Self) -> Self;

    /// |x|; the derivative follows the sign of the value, +1 at zero.
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
    /// The larger by value.
    fn max(self, other: Self) -> Self {
        if self.value() >= other.value() { self } else { other }
    }
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
    /// Runs work on numbers of this type, with wide instructions where that pays.
    #[doc(hidden)]
    #[inline(always)]
    fn run<J: Job>(job: J) -> J::Output {
        job.run()
    }
    /// Numbers of this type as real ones, if that is what they are.
    #[doc(hidden)]
    fn reals(_values: &[Self]) -> Option<&[f64]> {
        None
    }
    /// The same to write to.
    #[doc(hidden)]
    fn reals_mut(_values: &mut [Self]) -> Option<&mut [f64]> {
        None
    }
}

/// Assignment operators, `Sum`, zero and one, from the binary operators of a scalar type.
macro_rules! assign_operators {
    ([$($generics:tt)*] $type:ty) => {
        impl<$($generics)*> std::ops::AddAssign for $type {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) { *self = *self + other; }
        }
        impl<$($generics)*> std::ops::SubAssign for $type {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) { *self = *self - other; }
        }
        impl<$($generics)*> std::ops::MulAssign for $type {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) { *self = *self * other; }
        }
        impl<$($generics)*> std::ops::DivAssign for $type {
            #[inline(always)]
            fn div_assign(&mut self, other: Self) { *self = *self / other; }
        }
        impl<$($generics)*> std::iter::Sum for $type {
            #[inline(always)]
            fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
                let mut total = <$type>::from(0.0);
                for term in terms {
                    total += term;
                }
                total
            }
        }
        impl<$($generics)*> num_traits::Zero for $type {
            #[inline(always)]
            fn zero() -> Self { <$type>::from(0.0) }
            #[inline(always)]
            fn is_zero(&self) -> bool {
                use $crate::scalar::Scalar;
                self.value() == 0.0 && self.is_constant()
            }
        }
        impl<$($generics)*> num_traits::One for $type {
            #[inline(always)]
            fn one() -> Self { <$type>::from(1.0) }
        }
    };
}
pub(crate) use assign_operators;
