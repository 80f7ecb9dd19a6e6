//! num-dual's types among the scalars.
//!
//! First-order types follow the chain rule of [`jet`], where a zero derivative stays zero though the slope of the function is
//! infinite; types of higher order take num-dual's own functions, which makes them independent of everything else here, but for roots,
//! powers and angles, whose derivatives at zero are not numbers there.

use super::{Curve, Scalar, Unary, jet};
use num_dual::{Derivative, Dual2_64, Dual64, DualNum, DualSVec64, HyperDual64};
use std::sync::Arc;

/// Derivatives that are carried together in a tangent run.
pub const TANGENTS: usize = 8;

/// A value with eight first derivatives.
pub type Tangents = DualSVec64<TANGENTS>;

/// A type that carries first derivatives.
trait FirstOrder: Sized {
    /// f(x) with the derivatives f' dx; zero ones stay zero where f' is infinite.
    fn chain(self, jet: [f64; 2]) -> Self;
}

/// f' dx, zero where dx is.
#[inline(always)]
fn along(slope: f64, dx: f64) -> f64 {
    if dx == 0.0 { 0.0 } else { slope * dx }
}

impl FirstOrder for Dual64 {
    #[inline]
    fn chain(self, [f, slope]: [f64; 2]) -> Self {
        Dual64::new(f, along(slope, self.eps))
    }
}

impl<const N: usize> FirstOrder for DualSVec64<N> {
    #[inline]
    fn chain(self, [f, slope]: [f64; 2]) -> Self {
        DualSVec64::new(f, Derivative::new(self.eps.0.map(|eps| eps.map(|dx| along(slope, dx)))))
    }
}

/// What is the same for all of them: choices look at the value.
macro_rules! choices {
    () => {
        #[inline(always)]
        fn value(self) -> f64 {
            self.re
        }
        #[inline]
        fn less(self, other: Self) -> Self {
            Self::from(f64::from(u8::from(self.re < other.re)))
        }
        #[inline]
        fn select(self, then: Self, otherwise: Self) -> Self {
            if self.re != 0.0 { then } else { otherwise }
        }
        #[inline]
        fn vanishing_times(self, other: Self) -> Self {
            if self.re == 0.0 && self.is_constant() { self } else { self * other }
        }
    };
}

/// Types that carry first derivatives.
macro_rules! first_order {
    ([$($generics:tt)*] $type:ty, $x:ident => $constant:expr) => {
        impl<$($generics)*> Scalar for $type {
            choices!();
            fn is_constant(self) -> bool {
                let $x = self;
                $constant
            }
            #[inline(always)]
            fn unary(self, function: Unary) -> Self {
                match function {
                    Unary::Neg => -self,
                    Unary::Floor => Self::from(self.re.floor()),
                    _ => self.chain(function.with_slope(self.re)),
                }
            }
            fn recip(self) -> Self {
                self.chain(jet::recip(self.re))
            }
            fn powi(self, exponent: i32) -> Self {
                self.chain(jet::powi(self.re, exponent))
            }
            fn powf(self, exponent: f64) -> Self {
                self.chain(jet::powf(self.re, exponent))
            }
            fn atan2(self, other: Self) -> Self {
                let norm = self.re.hypot(other.re);
                // divided twice by the norm: its square may overflow where the angle does not
                let slopes = [other.re / norm / norm, -(self.re / norm / norm)];
                self.chain([self.re.atan2(other.re), slopes[0]]) + other.chain([-0.0, slopes[1]])
            }
            fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self {
                self.chain([order, order + 1].map(|order| curve.value(order, self.re)))
            }
        }
    };
}
first_order!([] Dual64, x => x.eps == 0.0);
first_order!([const N: usize] DualSVec64<N>, x => x.eps.0.is_none_or(|eps| eps.iter().all(|&dx| dx == 0.0)));

/// Types that carry second derivatives.
macro_rules! higher_order {
    ($($type:ty, $x:ident => $constant:expr, $chain:expr);*) => {$(
        impl Scalar for $type {
            choices!();
            fn is_constant(self) -> bool {
                let $x = self;
                $constant
            }
            fn unary(self, function: Unary) -> Self {
                match function {
                    Unary::Neg => -self,
                    Unary::Sqrt => {
                        let derivatives = jet::derivatives_of_power(self.re, 0.5);
                        $chain(self, [self.re.sqrt(), derivatives[1], derivatives[2]])
                    }
                    Unary::Exp => DualNum::exp(&self),
                    Unary::Ln => DualNum::ln(&self),
                    Unary::Sin => DualNum::sin(&self),
                    Unary::Cos => DualNum::cos(&self),
                    Unary::Tan => DualNum::tan(&self),
                    Unary::Asin => DualNum::asin(&self),
                    Unary::Acos => DualNum::acos(&self),
                    Unary::Atan => DualNum::atan(&self),
                    Unary::Sinh => DualNum::sinh(&self),
                    Unary::Cosh => DualNum::cosh(&self),
                    Unary::Tanh => DualNum::tanh(&self),
                    Unary::Floor => Self::from(self.re.floor()),
                }
            }
            fn recip(self) -> Self {
                DualNum::recip(&self)
            }
            fn powi(self, exponent: i32) -> Self {
                DualNum::powi(&self, exponent)
            }
            fn powf(self, exponent: f64) -> Self {
                $chain(self, jet::derivatives_of_power(self.re, exponent))
            }
            fn atan2(self, other: Self) -> Self {
                let angle = self.re.atan2(other.re);
                if self.is_constant() && other.is_constant() {
                    return angle.into();
                }
                // seen from axes of which one points there: the angle of a quotient whose denominator is the distance
                let (sin, cos) = angle.sin_cos();
                let mut quotient = (self * cos - other * sin) / (other * cos + self * sin);
                quotient.re = 0.0;
                let mut turned = DualNum::atan(&quotient);
                turned.re = angle;
                turned
            }
            fn on_curve(self, curve: &Arc<Curve>, order: usize) -> Self {
                $chain(self, [0, 1, 2].map(|more| curve.value(order + more, self.re)))
            }
        }
    )*};
}
higher_order!(
    Dual2_64, x => x.v1 == 0.0 && x.v2 == 0.0,
    |x: Dual2_64, [f, f1, f2]: [f64; 3]| Dual2_64::new(f, along(f1, x.v1), along(f2, x.v1 * x.v1) + along(f1, x.v2));
    HyperDual64, x => x.eps1 == 0.0 && x.eps2 == 0.0 && x.eps1eps2 == 0.0,
    |x: HyperDual64, [f, f1, f2]: [f64; 3]| {
        let mixed = along(f2, x.eps1 * x.eps2) + along(f1, x.eps1eps2);
        HyperDual64::new(f, along(f1, x.eps1), along(f1, x.eps2), mixed)
    }
);
