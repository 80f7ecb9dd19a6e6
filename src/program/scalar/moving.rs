use super::{Curve, Scalar, Unary, assign_operators, jet};
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
    fn chain(self, [value, slope]: [S; 2]) -> Self {
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

/// Operators with a number of the same type, or a real one, on the right.
macro_rules! operators {
    ($($operator:ident<$other:ty>, $method:ident: |$x:ident, $y:ident| $result:expr;)*) => {$(
        impl<S: Scalar> $operator<$other> for Moving<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, $y: $other) -> Self {
                let $x = self;
                $result
            }
        }
    )*};
}
operators! {
    Add<Self>, add: |x, y| Moving { value: x.value + y.value, rate: x.rate + y.rate };
    Sub<Self>, sub: |x, y| Moving { value: x.value - y.value, rate: x.rate - y.rate };
    Mul<Self>, mul: |x, y| Moving { value: x.value * y.value, rate: x.rate * y.value + x.value * y.rate };
    Div<Self>, div: |x, y| {
        let value = x.value / y.value;
        Moving { value, rate: (x.rate - value * y.rate) / y.value }
    };
    Add<f64>, add: |x, y| Moving { value: x.value + y, rate: x.rate };
    Sub<f64>, sub: |x, y| Moving { value: x.value - y, rate: x.rate };
    Mul<f64>, mul: |x, y| Moving { value: x.value * y, rate: x.rate * y };
    Div<f64>, div: |x, y| Moving { value: x.value / y, rate: x.rate / y };
}
assign_operators!([S: Scalar] Moving<S>);

impl<S: Scalar> Scalar for Moving<S> {
    fn value(self) -> f64 {
        self.value.value()
    }
    fn is_constant(self) -> bool {
        self.value.is_constant() && self.rate.is_zero()
    }
    #[inline(always)]
    fn unary(self, function: Unary) -> Self {
        match function {
            Unary::Neg => -self,
            Unary::Floor => Moving { value: self.value.floor(), rate: S::zero() },
            _ => self.chain(function.with_slope(self.value)),
        }
    }
    fn recip(self) -> Self {
        self.chain(jet::recip(self.value))
    }
    fn powi(self, exponent: i32) -> Self {
        self.chain(jet::powi(self.value, exponent))
    }
    fn powf(self, exponent: f64) -> Self {
        self.chain(jet::powf(self.value, exponent))
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
    fn vanishing_times(self, other: Self) -> Self {
        Moving {
            value: self.value.vanishing_times(other.value),
            rate: self.rate.vanishing_times(other.value) + self.value.vanishing_times(other.rate),
        }
    }
    fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self {
        self.chain([order, order + 1].map(|order| self.value.on_curve(curve, order)))
    }
    fn gather(self, values: &[Self]) -> Self {
        let of = |part: fn(&Self) -> S| self.value.gather(&values.iter().map(part).collect::<Vec<S>>());
        Moving { value: of(|own| own.value), rate: of(|own| own.rate) }
    }
    fn from_energies() {
        S::from_energies();
    }
}
