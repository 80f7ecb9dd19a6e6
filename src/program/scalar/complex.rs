use super::{Curve, Scalar, Unary, jet};
use num_complex::Complex64;
use std::sync::Arc;

/// Step of complex-step derivatives, f(x + i h) = f(x) + i h f'(x) + O(h^2).
///
/// Any other gives the same derivative as long as nothing underflows or overflows.
pub const COMPLEX_STEP: f64 = 1e-100;

/// Continues a function of a real argument to first order, f + i f' im: a zero imaginary part stays zero where f' is infinite.
#[inline]
fn chain(x: Complex64, [f, slope]: [f64; 2]) -> Complex64 {
    Complex64::new(f, if x.im == 0.0 { 0.0 } else { slope * x.im })
}

/// Zero in place of a real part that is nothing but the negative square of a step: (0 + i h)^2.
#[inline]
fn without_square(x: Complex64) -> Complex64 {
    let negligible = x.re < 0.0 && x.re > -(COMPLEX_STEP * COMPLEX_STEP * 1e20);
    Complex64::new(if negligible { 0.0 } else { x.re }, x.im)
}

/// Complex numbers for complex-step derivatives.
///
/// Sums, products, quotients, exponential, sine, cosine and their hyperbolic kin are those of complex arithmetic.
/// Functions whose usual complex formulas lose a tiny imaginary part or add one of their own (`sqrt`, `ln`, `tan`,
/// `tanh`, powers, inverse trigonometric ones, `recip`) are continued to first order, f + i f' im.
///
/// A product keeps the square of the step: (0 + i h)^2 is negative; roots and powers take it as zero. A quotient divides by the
/// squared modulus of the divisor, which overflows or underflows for moduli beyond 1e154 or below 1e-154, where `recip`
/// does not; its real part rounds otherwise than the quotient of real numbers.
///
/// Where the type is written out, the functions of `Complex64` itself come before these: call these as
/// `Scalar::sqrt(z)`.
impl Scalar for Complex64 {
    #[inline(always)]
    fn value(self) -> f64 {
        self.re
    }
    #[inline(always)]
    fn is_constant(self) -> bool {
        self.im == 0.0
    }
    #[inline(always)]
    fn unary(self, function: Unary) -> Self {
        match function {
            Unary::Neg => -self,
            Unary::Exp => self.exp(),
            Unary::Sin => self.sin(),
            Unary::Cos => self.cos(),
            Unary::Sinh => self.sinh(),
            Unary::Cosh => self.cosh(),
            Unary::Floor => Complex64::from(self.re.floor()),
            Unary::Sqrt => {
                let own = without_square(self);
                chain(own, function.with_slope(own.re))
            }
            _ => chain(self, function.with_slope(self.re)),
        }
    }
    fn powi(self, exponent: i32) -> Self {
        chain(self, jet::powi(self.re, exponent))
    }
    fn powf(self, exponent: f64) -> Self {
        let own = without_square(self);
        chain(own, jet::powf(own.re, exponent))
    }
    fn recip(self) -> Self {
        let inverse = self.re.recip();
        // one factor after the other: the square of the inverse may underflow where the whole does not
        Complex64::new(inverse, if self.im == 0.0 { 0.0 } else { -(self.im * inverse * inverse) })
    }
    fn atan2(self, other: Self) -> Self {
        let norm = self.re.hypot(other.re);
        // divided twice by the norm: its square may overflow where the angle does not
        let im = ((other.re / norm) * self.im - (self.re / norm) * other.im) / norm;
        Complex64::new(self.re.atan2(other.re), if self.im == 0.0 && other.im == 0.0 { 0.0 } else { im })
    }
    fn less(self, other: Self) -> Self {
        Complex64::from(f64::from(u8::from(self.re < other.re)))
    }
    fn select(self, then: Self, otherwise: Self) -> Self {
        if self.re != 0.0 { then } else { otherwise }
    }
    fn vanishing_times(self, other: Self) -> Self {
        if self == Complex64::ZERO { self } else { self * other }
    }
    fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self {
        chain(self, [order, order + 1].map(|order| curve.value(order, self.re)))
    }
}
