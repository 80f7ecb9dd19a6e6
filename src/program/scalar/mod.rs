//! The number types: one formula in, every derivative out.
//!
//! [`Scalar`] is implemented for a closed list of types, each for one purpose:
//!
//! | type | carries | used for |
//! |---|---|---|
//! | `f64` | value | simulation |
//! | [`Complex64`] | value and one complex perturbation | complex-step verification |
//! | [`Tangents`], num-dual's `DualSVec64` | value and eight first derivatives | tangent runs |
//! | num-dual's `Dual64`, `Dual2_64`, `HyperDual64` | derivatives of first and second order | an independent check of what is derived from recordings |
//! | `Moving` over any of them | value and rate along a motion | node maps of flexible elements |
//! | `Recorded` | a place in a recording | everything else |
//!
//! A formula chooses by [`Scalar::select`], [`Scalar::max`], [`Scalar::abs`] and the like, which are right for every type; a formula
//! that looks at [`Scalar::value`] is refused where it is recorded. Complex numbers are those of num-complex and vectors those of
//! nalgebra, with [`SpatialVector`] beside them.

mod complex;
mod curve;
mod duals;
mod jet;
pub mod moving;
mod real;
pub mod rotation;
mod slopes;
mod vector;

pub use complex::COMPLEX_STEP;
pub use curve::check_knots;
pub use curve::{Curve, Interpolant, MOST_BREAKPOINTS};
pub use duals::{TANGENTS, Tangents};
#[doc(hidden)]
pub use jet::Unary;
pub use moving::Moving;
pub use real::larger;
pub use rotation::Quaternion;
pub use rotation::{angle_about, combine_columns, rotation_gradient_transposed, tensor_times};
pub use vector::SpatialVector;

pub use nalgebra::{Matrix3, Vector3};
pub use num_complex::Complex64;

use num_traits::{One, Zero};

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use std::sync::Arc;

/// Functions of one number by their names.
macro_rules! functions {
    ($($name:ident $function:ident),*) => {
        $(#[inline(always)] fn $name(self) -> Self { self.unary(Unary::$function) })*
    };
}

/// A number with which elements, constraints and functionals are evaluated.
///
/// A bare number stands on the right: `x * 0.5`, `-x + 1.0`, or becomes a scalar by `S::from(0.5)`. On the left it would need operators
/// of `f64` with num-dual's types, which only num-dual can add.
///
/// Laws, held by `tests/systems/scalar_laws.rs` for every type and function: the value part equals the `f64` result bit for bit
/// where the function is elementary (but for quotients of complex and dual numbers, and num-dual's own functions in its types of higher
/// order, which round otherwise); derivative parts
/// follow the chain rule; a zero derivative part stays zero where the derivative of the function is infinite.
pub trait Scalar:
    Copy
    + Debug
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

    /// A function of one number, by its name.
    #[doc(hidden)]
    fn unary(self, function: Unary) -> Self;
    functions!(sqrt Sqrt, exp Exp, ln Ln, sin Sin, cos Cos, tan Tan, asin Asin, acos Acos, atan Atan);
    functions!(sinh Sinh, cosh Cosh, tanh Tanh);
    /// The largest integer that is not above x; its derivative is zero.
    #[inline(always)]
    fn floor(self) -> Self {
        self.unary(Unary::Floor)
    }
    /// 1 / x.
    fn recip(self) -> Self;
    /// x^n for an integer n, by squaring: the rounding of `f64::powi` depends on what the compiler knows of the exponent.
    fn powi(self, exponent: i32) -> Self {
        let (mut power, mut square, mut rest) = (None, self, exponent.unsigned_abs());
        while rest > 0 {
            if rest % 2 == 1 {
                power = Some(power.map_or(square, |power: Self| power * square));
            }
            rest /= 2;
            if rest > 0 {
                square *= square;
            }
        }
        let power = power.unwrap_or_else(Self::one);
        if exponent < 0 { power.recip() } else { power }
    }
    /// x^r for a real exponent r; negative x only makes sense for integer r.
    fn powf(self, exponent: f64) -> Self;
    /// Angle of the point (x, y) with x = `other`: atan2(self, other), in (-pi, pi].
    fn atan2(self, other: Self) -> Self;

    /// 1 where `self` is less than `other`, otherwise 0: a mask for [`select`](Scalar::select).
    fn less(self, other: Self) -> Self;
    /// `then` where `self` is not 0, otherwise `otherwise`; what is not taken leaves no trace in any derivative.
    fn select(self, then: Self, otherwise: Self) -> Self;
    /// self times other, but 0 where self is 0, whatever the other is.
    #[doc(hidden)]
    fn vanishing_times(self, other: Self) -> Self;
    /// The derivative of order `order` of a curve at x, its value for 0.
    fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self;
    /// The number at place x of a list, counted from 0; x, a whole number as a curve gives it, has no derivative.
    fn gather(self, values: &[Self]) -> Self {
        values[gathered_place(self.value(), values.len())]
    }

    /// |x|; the derivative follows the sign of the value, +1 at zero.
    fn abs(self) -> Self {
        self.less(Self::zero()).select(-self, self)
    }
    /// The larger of two numbers; the first where they are equal.
    fn max(self, other: Self) -> Self {
        self.less(other).select(other, self)
    }
    /// The smaller of two numbers; the first where they are equal.
    fn min(self, other: Self) -> Self {
        other.less(self).select(other, self)
    }
    /// -1, 0 or 1.
    fn sign(self) -> Self {
        Self::zero().less(self) - self.less(Self::zero())
    }
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
    /// Marks a residual that is not written out, but follows from energies.
    #[doc(hidden)]
    fn from_energies() {
        panic!("a residual that follows from energies is evaluated by its program: see `costate::testing`");
    }
}

/// Which of `count` numbers stands at place `x`.
#[inline(always)]
pub fn gathered_place(x: f64, count: usize) -> usize {
    // what is no number counts as 0
    (x as usize).min(count - 1)
}

/// Assignment operators, `Sum`, zero and one, from the binary operators of a scalar type.
macro_rules! assign_operators {
    ([$($generics:tt)*] $type:ty, $operator:ident $method:ident $sign:tt) => {
        impl<$($generics)*> std::ops::$operator for $type {
            #[inline(always)]
            fn $method(&mut self, other: Self) { *self = *self $sign other; }
        }
    };
    ([$($generics:tt)*] $type:ty) => {
        $crate::scalar::assign_operators!([$($generics)*] $type, AddAssign add_assign +);
        $crate::scalar::assign_operators!([$($generics)*] $type, SubAssign sub_assign -);
        $crate::scalar::assign_operators!([$($generics)*] $type, MulAssign mul_assign *);
        $crate::scalar::assign_operators!([$($generics)*] $type, DivAssign div_assign /);
        impl<$($generics)*> std::iter::Sum for $type {
            #[inline(always)]
            fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
                terms.fold(<$type>::from(0.0), |total, term| total + term)
            }
        }
        impl<$($generics)*> num_traits::Zero for $type {
            #[inline(always)]
            fn zero() -> Self { <$type>::from(0.0) }
            #[inline(always)]
            fn is_zero(&self) -> bool {
                use $crate::scalar::Scalar;
                self.is_constant() && self.value() == 0.0
            }
        }
        impl<$($generics)*> num_traits::One for $type {
            #[inline(always)]
            fn one() -> Self { <$type>::from(1.0) }
        }
    };
}
pub(crate) use assign_operators;
