//! Value and derivative of each elementary function of real numbers, for types that are continued to first order.

/// `[f(x), f'(x)]`.
pub(super) type Jet = [f64; 2];

#[inline]
pub(super) fn sqrt(x: f64) -> Jet {
    let root = x.sqrt();
    [root, 0.5 / root]
}

#[inline]
pub(super) fn exp(x: f64) -> Jet {
    [x.exp(), x.exp()]
}

#[inline]
pub(super) fn ln(x: f64) -> Jet {
    [x.ln(), 1.0 / x]
}

#[inline]
pub(super) fn sin(x: f64) -> Jet {
    [x.sin(), x.cos()]
}

#[inline]
pub(super) fn cos(x: f64) -> Jet {
    [x.cos(), -x.sin()]
}

#[inline]
pub(super) fn tan(x: f64) -> Jet {
    let t = x.tan();
    [t, t * t + 1.0]
}

#[inline]
pub(super) fn asin(x: f64) -> Jet {
    // (1 - x)(1 + x) keeps the digits that 1 - x^2 loses near the ends
    [x.asin(), 1.0 / ((1.0 - x) * (1.0 + x)).sqrt()]
}

#[inline]
pub(super) fn acos(x: f64) -> Jet {
    [x.acos(), -asin(x)[1]]
}

#[inline]
pub(super) fn atan(x: f64) -> Jet {
    [x.atan(), 1.0 / (x * x + 1.0)]
}

#[inline]
pub(super) fn sinh(x: f64) -> Jet {
    [x.sinh(), x.cosh()]
}

#[inline]
pub(super) fn cosh(x: f64) -> Jet {
    [x.cosh(), x.sinh()]
}

#[inline]
pub(super) fn tanh(x: f64) -> Jet {
    let t = x.tanh();
    [t, 1.0 - t * t]
}

#[inline]
pub(super) fn recip(x: f64) -> Jet {
    let r = 1.0 / x;
    [r, -(r * r)]
}

#[inline]
pub(super) fn powi(x: f64, exponent: i32) -> Jet {
    use super::Scalar;
    // a factor of zero ends the chain: x^-1 at x = 0 must not turn 0 into NaN
    let slope = if exponent == 0 { 0.0 } else { Scalar::powi(x, exponent - 1) * f64::from(exponent) };
    [Scalar::powi(x, exponent), slope]
}

#[inline]
pub(super) fn powf(x: f64, exponent: f64) -> Jet {
    let slope = if exponent == 0.0 { 0.0 } else { x.powf(exponent - 1.0) * exponent };
    [x.powf(exponent), slope]
}

/// x^k and its first three derivatives; those that the exponent makes zero are zero, whatever x.
pub(super) fn derivatives_of_power(x: f64, exponent: f64) -> [f64; 4] {
    let mut factor = 1.0;
    [0.0, 1.0, 2.0, 3.0].map(|order| {
        let derivative = if factor == 0.0 { 0.0 } else { factor * x.powf(exponent - order) };
        factor *= exponent - order;
        derivative
    })
}

/// Functions of [`Scalar`](super::Scalar) for a type with `fn chain(self, Jet) -> Self` and its value at `self.$value`.
macro_rules! functions_by_chain {
    ($value:ident: $($name:ident),*) => {
        $(#[inline] fn $name(self) -> Self { self.chain($crate::scalar::jet::$name(self.$value)) })*
    };
}
pub(super) use functions_by_chain;
