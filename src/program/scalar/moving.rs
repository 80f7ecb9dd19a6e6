use super::{Curve, Scalar, assign_operators};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// A number of any type with its rate along a motion: what turns the map x = m(q) of a formula into dx/dt = dm/dq dq/dt.
///
/// A rate that is zero stays zero where the slope of a function is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving<S> {
    /// The number.
    pub value: S,
    /// Its rate.
    pub rate: S,
}

impl<S: Scalar> Moving<S> {
    /// A number with its rate.
    pub fn new(value: S, rate: S) -> Self {
        Moving { value, rate }
    }
    /// f(x) with the rate f'(x) dx/dt.
    fn chain(self, value: S, slope: S) -> Self {
        Moving { value, rate: self.rate.vanishing_times(slope) }
    }
}

impl<S: Scalar> From<f64> for Moving<S> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Moving { value: S::from(value), rate: S::zero() }
    }
}
impl<S: Scalar> Neg for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Moving { value: -self.value, rate: -self.rate }
    }
}
impl<S: Scalar> Add for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Moving { value: self.value + other.value, rate: self.rate + other.rate }
    }
}
impl<S: Scalar> Sub for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Moving { value: self.value - other.value, rate: self.rate - other.rate }
    }
}
impl<S: Scalar> Mul for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Moving { value: self.value * other.value, rate: self.rate * other.value + self.value * other.rate }
    }
}
impl<S: Scalar> Div for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Moving { value, rate: (self.rate - value * other.rate) / other.value }
    }
}
impl<S: Scalar> Add<f64> for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Moving { value: self.value + other, rate: self.rate }
    }
}
impl<S: Scalar> Sub<f64> for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Moving { value: self.value - other, rate: self.rate }
    }
}
impl<S: Scalar> Mul<f64> for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Moving { value: self.value * other, rate: self.rate * other }
    }
}
impl<S: Scalar> Div<f64> for Moving<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: f64) -> Self {
        Moving { value: self.value / other, rate: self.rate / other }
    }
}
assign_operators!([S: Scalar] Moving<S>);

impl<S: Scalar> Scalar for Moving<S> {
    fn value(self) -> f64 {
        self.value.value()
    }
    fn is_constant(self) -> bool {
        self.value.is_constant() && self.rate.is_zero()
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, S::from(0.5) / root)
    }
    fn exp(self) -> Self {
        let power = self.value.exp();
        self.chain(power, power)
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }
    fn tan(self) -> Self {
        let tan = self.value.tan();
        self.chain(tan, tan * tan + 1.0)
    }
    fn asin(self) -> Self {
        // (1 - x)(1 + x) keeps the digits that 1 - x^2 loses near the ends
        let slope = ((-self.value + 1.0) * (self.value + 1.0)).sqrt().recip();
        self.chain(self.value.asin(), slope)
    }
    fn acos(self) -> Self {
        let slope = ((-self.value + 1.0) * (self.value + 1.0)).sqrt().recip();
        self.chain(self.value.acos(), -slope)
    }
    fn atan(self) -> Self {
        self.chain(self.value.atan(), (self.value * self.value + 1.0).recip())
    }
    fn sinh(self) -> Self {
        self.chain(self.value.sinh(), self.value.cosh())
    }
    fn cosh(self) -> Self {
        self.chain(self.value.cosh(), self.value.sinh())
    }
    fn tanh(self) -> Self {
        let tanh = self.value.tanh();
        self.chain(tanh, -(tanh * tanh) + 1.0)
    }
    fn recip(self) -> Self {
        let inverse = self.value.recip();
        self.chain(inverse, -(inverse * inverse))
    }
    fn powi(self, exponent: i32) -> Self {
        // a factor of zero ends the chain: x^-1 at x = 0 must not turn 0 into no number
        let slope = if exponent == 0 { S::zero() } else { self.value.powi(exponent - 1) * f64::from(exponent) };
        self.chain(self.value.powi(exponent), slope)
    }
    fn powf(self, exponent: f64) -> Self {
        let slope = if exponent == 0.0 { S::zero() } else { self.value.powf(exponent - 1.0) * exponent };
        self.chain(self.value.powf(exponent), slope)
    }
    fn atan2(self, other: Self) -> Self {
        let square = self.value * self.value + other.value * other.value;
        let rate = self.rate.vanishing_times(other.value / square) - other.rate.vanishing_times(self.value / square);
        Moving { value: self.value.atan2(other.value), rate }
    }
    fn less(self, other: Self) -> Self {
        Moving { value: self.value.less(other.value), rate: S::zero() }
    }
    fn select(self, then: Self, otherwise: Self) -> Self {
        Moving { value: self.value.select(then.value, otherwise.value), rate: self.value.select(then.rate, otherwise.rate) }
    }
    fn floor(self) -> Self {
        Moving { value: self.value.floor(), rate: S::zero() }
    }
    fn vanishing_times(self, other: Self) -> Self {
        Moving {
            value: self.value.vanishing_times(other.value),
            rate: self.rate.vanishing_times(other.value) + self.value.vanishing_times(other.rate),
        }
    }
    fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self {
        self.chain(self.value.on_curve(curve, order), self.value.on_curve(curve, order + 1))
    }
    fn gather(self, values: &[Self]) -> Self {
        let of = |part: fn(&Self) -> S| self.value.gather(&values.iter().map(part).collect::<Vec<S>>());
        Moving { value: of(|own| own.value), rate: of(|own| own.rate) }
    }
    fn from_energies() {
        S::from_energies();
    }
}
