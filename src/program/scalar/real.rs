use super::{Curve, Scalar};
use std::sync::Arc;

/// Forwards the functions of one argument to the inherent ones of `f64`.
macro_rules! forward {
    ($($name:ident),*) => { $(#[inline(always)] fn $name(self) -> Self { f64::$name(self) })* };
}

impl Scalar for f64 {
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
    #[inline(always)]
    fn is_constant(self) -> bool {
        true
    }
    forward!(sqrt, exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, recip, floor);
    #[inline(always)]
    fn less(self, other: Self) -> Self {
        f64::from(u8::from(self < other))
    }
    #[inline(always)]
    fn select(self, then: Self, otherwise: Self) -> Self {
        if self != 0.0 { then } else { otherwise }
    }
    #[inline(always)]
    fn vanishing_times(self, other: Self) -> Self {
        if self == 0.0 { 0.0 } else { self * other }
    }
    fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self {
        curve.value(order, self)
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        // by squaring: the rounding of f64::powi depends on what the compiler knows of the exponent
        let (mut power, mut square, mut rest) = (1.0, self, exponent.unsigned_abs());
        while rest > 0 {
            if rest % 2 == 1 {
                power *= square;
            }
            square *= square;
            rest /= 2;
        }
        if exponent < 0 { 1.0 / power } else { power }
    }
    #[inline]
    fn powf(self, exponent: f64) -> Self {
        f64::powf(self, exponent)
    }
    #[inline]
    fn atan2(self, other: Self) -> Self {
        f64::atan2(self, other)
    }
}

/// The larger one, or what is no number: that is not hidden behind others.
pub fn larger(a: f64, b: f64) -> f64 {
    if b <= a || a.is_nan() { a } else { b }
}
