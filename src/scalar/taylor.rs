use super::jet::Jet;
use super::{Scalar, assign_operators};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A function of one parameter with its first and second derivative there: (f, f', f'').
///
/// Along q(t) = (q, v, a) a constraint g turns into (g, dg/dt, d2g/dt2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taylor<S> {
    /// f.
    pub value: S,
    /// f'.
    pub first: S,
    /// f''.
    pub second: S,
}

impl<S: Scalar> Taylor<S> {
    /// (f, f', f'').
    #[inline(always)]
    pub fn new(value: S, first: S, second: S) -> Self {
        Taylor { value, first, second }
    }

    /// Faa di Bruno to second order: (f, f' x', f'' x'^2 + f' x'').
    #[inline]
    fn chain(self, [f, first, second]: Jet<S>) -> Self {
        let times = |derivative: S, e: S| {
            if e.value() == 0.0 && e.is_constant() { S::zero() } else { derivative * e }
        };
        Taylor {
            value: f,
            first: times(first, self.first),
            second: times(second, self.first * self.first) + times(first, self.second),
        }
    }
}

impl<S: Scalar> From<f64> for Taylor<S> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Taylor { value: S::from(value), first: S::zero(), second: S::zero() }
    }
}
impl<S: Scalar> Neg for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Taylor::new(-self.value, -self.first, -self.second)
    }
}
impl<S: Scalar> Add for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Taylor::new(self.value + other.value, self.first + other.first, self.second + other.second)
    }
}
impl<S: Scalar> Sub for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Taylor::new(self.value - other.value, self.first - other.first, self.second - other.second)
    }
}
impl<S: Scalar> Mul for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Taylor {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value + self.first * other.first * 2.0 + self.value * other.second,
        }
    }
}
impl<S: Scalar> Div for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = other.value.recip();
        let value = self.value / other.value;
        let first = (self.first - value * other.first) * inverse;
        let second = (self.second - first * other.first * 2.0 - value * other.second) * inverse;
        Taylor { value, first, second }
    }
}
impl<S: Scalar> Add<f64> for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Taylor::new(self.value + other, self.first, self.second)
    }
}
impl<S: Scalar> Sub<f64> for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Taylor::new(self.value - other, self.first, self.second)
    }
}
impl<S: Scalar> Mul<f64> for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Taylor::new(self.value * other, self.first * other, self.second * other)
    }
}
impl<S: Scalar> Div<f64> for Taylor<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: f64) -> Self {
        Taylor::new(self.value / other, self.first / other, self.second / other)
    }
}
assign_operators!([S: Scalar] Taylor<S>);

impl<S: Scalar> Scalar for Taylor<S> {
    #[inline(always)]
    fn value(self) -> f64 {
        self.value.value()
    }
    fn is_constant(self) -> bool {
        let zero = |s: S| s.value() == 0.0 && s.is_constant();
        self.value.is_constant() && zero(self.first) && zero(self.second)
    }
    super::jet::functions_by_chain!(value);
    #[inline]
    fn atan2(self, other: Self) -> Self {
        // theta' = (x y' - y x') / (x^2 + y^2), and once more by the quotient rule
        let (y, x) = (self, other);
        let square = x.value * x.value + y.value * y.value;
        let times = |numerator: S| {
            if numerator.value() == 0.0 && numerator.is_constant() { S::zero() } else { numerator / square }
        };
        let first = times(x.value * y.first - y.value * x.first);
        let half_rate = x.value * x.first + y.value * y.first;
        let second = times(x.value * y.second - y.value * x.second - first * half_rate * 2.0);
        Taylor { value: y.value.atan2(x.value), first, second }
    }
}
