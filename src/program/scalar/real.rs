use super::{Curve, Scalar, Unary};
use std::sync::Arc;

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
    fn unary(self, function: Unary) -> Self {
        match function {
            Unary::Neg => -self,
            Unary::Sqrt => self.sqrt(),
            Unary::Exp => self.exp(),
            Unary::Ln => self.ln(),
            Unary::Sin => self.sin(),
            Unary::Cos => self.cos(),
            Unary::Tan => self.tan(),
            Unary::Asin => self.asin(),
            Unary::Acos => self.acos(),
            Unary::Atan => self.atan(),
            Unary::Sinh => self.sinh(),
            Unary::Cosh => self.cosh(),
            Unary::Tanh => self.tanh(),
            Unary::Floor => self.floor(),
        }
    }
    #[inline(always)]
    fn recip(self) -> Self {
        f64::recip(self)
    }
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
