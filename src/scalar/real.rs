use super::Scalar;

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
    forward!(sqrt, exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, recip);
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        f64::powi(self, exponent)
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
