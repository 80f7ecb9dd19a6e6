//! Value, first and second derivative of each elementary function, for any scalar: the one place where they are written.

use super::Scalar;

/// `[f(x), f'(x), f''(x)]`.
pub(crate) type Jet<S> = [S; 3];

#[inline]
pub(crate) fn sqrt<S: Scalar>(x: S) -> Jet<S> {
    let root = x.sqrt();
    let first = (root * 2.0).recip();
    [root, first, -first / (x * 2.0)]
}

#[inline]
pub(crate) fn exp<S: Scalar>(x: S) -> Jet<S> {
    let e = x.exp();
    [e, e, e]
}

#[inline]
pub(crate) fn ln<S: Scalar>(x: S) -> Jet<S> {
    let r = x.recip();
    [x.ln(), r, -(r * r)]
}

#[inline]
pub(crate) fn sin<S: Scalar>(x: S) -> Jet<S> {
    let (s, c) = x.sin_cos();
    [s, c, -s]
}

#[inline]
pub(crate) fn cos<S: Scalar>(x: S) -> Jet<S> {
    let (s, c) = x.sin_cos();
    [c, -s, -c]
}

#[inline]
pub(crate) fn tan<S: Scalar>(x: S) -> Jet<S> {
    let t = x.tan();
    let first = t * t + 1.0;
    [t, first, t * first * 2.0]
}

#[inline]
pub(crate) fn asin<S: Scalar>(x: S) -> Jet<S> {
    // (1 - x)(1 + x) keeps the digits that 1 - x^2 loses near the ends
    let complement = (-x + 1.0) * (x + 1.0);
    let first = complement.sqrt().recip();
    [x.asin(), first, x * first / complement]
}

#[inline]
pub(crate) fn acos<S: Scalar>(x: S) -> Jet<S> {
    let [_, first, second] = asin(x);
    [x.acos(), -first, -second]
}

#[inline]
pub(crate) fn atan<S: Scalar>(x: S) -> Jet<S> {
    let first = (x * x + 1.0).recip();
    [x.atan(), first, x * first * first * -2.0]
}

#[inline]
pub(crate) fn sinh<S: Scalar>(x: S) -> Jet<S> {
    let (s, c) = (x.sinh(), x.cosh());
    [s, c, s]
}

#[inline]
pub(crate) fn cosh<S: Scalar>(x: S) -> Jet<S> {
    let (s, c) = (x.sinh(), x.cosh());
    [c, s, c]
}

#[inline]
pub(crate) fn tanh<S: Scalar>(x: S) -> Jet<S> {
    let t = x.tanh();
    let first = -(t * t) + 1.0;
    [t, first, t * first * -2.0]
}

#[inline]
pub(crate) fn recip<S: Scalar>(x: S) -> Jet<S> {
    let r = x.recip();
    let first = -(r * r);
    [r, first, r * first * -2.0]
}

#[inline]
pub(crate) fn powi<S: Scalar>(x: S, exponent: i32) -> Jet<S> {
    let n = f64::from(exponent);
    // a factor of zero ends the chain: x^-1 at x = 0 must not turn 0 into NaN
    let power = |factor: f64, reduced: i32| if factor == 0.0 { S::zero() } else { x.powi(reduced) * factor };
    [x.powi(exponent), power(n, exponent - 1), power(n * (n - 1.0), exponent - 2)]
}

#[inline]
pub(crate) fn powf<S: Scalar>(x: S, exponent: f64) -> Jet<S> {
    let power = |factor: f64, reduced: f64| if factor == 0.0 { S::zero() } else { x.powf(reduced) * factor };
    [x.powf(exponent), power(exponent, exponent - 1.0), power(exponent * (exponent - 1.0), exponent - 2.0)]
}

/// The elementary functions of [`Scalar`](super::Scalar) for a type with `fn chain(self, Jet<Inner>) -> Self` and an inner
/// scalar `self.$inner`: all of them, or powers and those that are named.
macro_rules! functions_by_chain {
    ($inner:ident: $($name:ident),*) => {
        $(#[inline] fn $name(self) -> Self { self.chain($crate::scalar::jet::$name(self.$inner)) })*
        #[inline]
        fn powi(self, exponent: i32) -> Self { self.chain($crate::scalar::jet::powi(self.$inner, exponent)) }
        #[inline]
        fn powf(self, exponent: f64) -> Self { self.chain($crate::scalar::jet::powf(self.$inner, exponent)) }
    };
    ($inner:ident) => {
        $crate::scalar::jet::functions_by_chain!($inner: sqrt, exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, recip);
        #[inline(always)]
        fn sin_cos(self) -> (Self, Self) {
            let (s, c) = self.$inner.sin_cos();
            (self.chain([s, c, -s]), self.chain([c, -s, -c]))
        }
    };
}
pub(crate) use functions_by_chain;
