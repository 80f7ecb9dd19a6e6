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
    #[inline(always)]
    fn reals(values: &[f64]) -> Option<&[f64]> {
        Some(values)
    }
    #[inline(always)]
    fn reals_mut(values: &mut [f64]) -> Option<&mut [f64]> {
        Some(values)
    }
    forward!(sqrt, exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, recip);
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
