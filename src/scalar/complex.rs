use super::{Scalar, assign_operators};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A complex number for complex-step derivatives: f(x + i h) = f(x) + i h f'(x) + O(h^2).
///
/// Exponential, sine, cosine and hyperbolic functions are those of complex arithmetic; functions whose usual complex formulas
/// lose a tiny imaginary part or add one of their own (`sqrt`, `ln`, powers, inverse trigonometric ones) are continued to first
/// order, f + i f' im. So are products and quotients: the square of the step, left in the real part, would make x^2 negative
/// at x = 0 and its root NaN. The real part is thus the `f64` result. Nothing is ever conjugated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part: the value.
    pub re: f64,
    /// Imaginary part: the perturbation.
    pub im: f64,
}

impl Complex {
    /// Step for first derivatives; any other gives the same derivative as long as nothing underflows or overflows.
    pub const STEP: f64 = 1e-100;

    /// re + i im.
    pub fn new(re: f64, im: f64) -> Self {
        Complex { re, im }
    }

    #[inline]
    fn chain(self, [f, first, _]: [f64; 3]) -> Self {
        Complex { re: f, im: if self.im == 0.0 { 0.0 } else { first * self.im } }
    }
}

impl From<f64> for Complex {
    #[inline(always)]
    fn from(re: f64) -> Self {
        Complex { re, im: 0.0 }
    }
}
impl Neg for Complex {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Complex { re: -self.re, im: -self.im }
    }
}
impl Add for Complex {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Complex { re: self.re + other.re, im: self.im + other.im }
    }
}
impl Sub for Complex {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Complex { re: self.re - other.re, im: self.im - other.im }
    }
}
impl Mul for Complex {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Complex { re: self.re * other.re, im: self.re * other.im + self.im * other.re }
    }
}
impl Div for Complex {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.re / other.re;
        Complex { re: quotient, im: (self.im - quotient * other.im) / other.re }
    }
}
impl Add<f64> for Complex {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Complex { re: self.re + other, im: self.im }
    }
}
impl Sub<f64> for Complex {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Complex { re: self.re - other, im: self.im }
    }
}
impl Mul<f64> for Complex {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Complex { re: self.re * other, im: self.im * other }
    }
}
impl Div<f64> for Complex {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: f64) -> Self {
        Complex { re: self.re / other, im: self.im / other }
    }
}
assign_operators!([] Complex);

impl Scalar for Complex {
    #[inline(always)]
    fn value(self) -> f64 {
        self.re
    }
    #[inline(always)]
    fn is_constant(self) -> bool {
        self.im == 0.0
    }
    fn exp(self) -> Self {
        let modulus = self.re.exp();
        Complex { re: modulus * self.im.cos(), im: modulus * self.im.sin() }
    }
    fn sin(self) -> Self {
        Complex { re: self.re.sin() * self.im.cosh(), im: self.re.cos() * self.im.sinh() }
    }
    fn cos(self) -> Self {
        Complex { re: self.re.cos() * self.im.cosh(), im: -(self.re.sin() * self.im.sinh()) }
    }
    fn sinh(self) -> Self {
        Complex { re: self.re.sinh() * self.im.cos(), im: self.re.cosh() * self.im.sin() }
    }
    fn cosh(self) -> Self {
        Complex { re: self.re.cosh() * self.im.cos(), im: self.re.sinh() * self.im.sin() }
    }
    fn recip(self) -> Self {
        Complex::from(1.0) / self
    }
    super::jet::functions_by_chain!(re: sqrt, ln, tan, asin, acos, atan, tanh);
    fn atan2(self, other: Self) -> Self {
        let norm = self.re.hypot(other.re);
        // divided twice by the norm: its square may overflow where the angle does not
        let im = ((other.re / norm) * self.im - (self.re / norm) * other.im) / norm;
        Complex { re: self.re.atan2(other.re), im: if self.im == 0.0 && other.im == 0.0 { 0.0 } else { im } }
    }
}
