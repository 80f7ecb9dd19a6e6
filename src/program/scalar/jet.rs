//! Functions of one number, each with its slope.

use super::Scalar;

/// Functions of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unary {
    Neg,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    /// The largest integer that is not above x.
    Floor,
}

impl Unary {
    /// `[f(x), f'(x)]`.
    #[inline(always)]
    pub(crate) fn with_slope<S: Scalar>(self, x: S) -> [S; 2] {
        // (1 - x)(1 + x) keeps the digits that 1 - x^2 loses near the ends
        let slope_of_arc = || ((S::one() - x) * (S::one() + x)).sqrt().recip();
        match self {
            Unary::Neg => [-x, S::from(-1.0)],
            Unary::Sqrt => {
                let root = x.sqrt();
                [root, S::from(0.5) / root]
            }
            Unary::Exp => {
                let power = x.exp();
                [power, power]
            }
            Unary::Ln => [x.ln(), x.recip()],
            Unary::Sin => [x.sin(), x.cos()],
            Unary::Cos => [x.cos(), -x.sin()],
            Unary::Tan => {
                let tan = x.tan();
                [tan, tan * tan + 1.0]
            }
            Unary::Asin => [x.asin(), slope_of_arc()],
            Unary::Acos => [x.acos(), -slope_of_arc()],
            Unary::Atan => [x.atan(), (x * x + 1.0).recip()],
            Unary::Sinh => [x.sinh(), x.cosh()],
            Unary::Cosh => [x.cosh(), x.sinh()],
            Unary::Tanh => {
                let tanh = x.tanh();
                [tanh, S::one() - tanh * tanh]
            }
            Unary::Floor => [x.floor(), S::zero()],
        }
    }
}

/// 1 / x with its slope.
#[inline]
pub(super) fn recip<S: Scalar>(x: S) -> [S; 2] {
    let inverse = x.recip();
    [inverse, -(inverse * inverse)]
}

/// x^n with its slope. A factor of zero ends the chain: x^-1 at x = 0 must not turn 0 into no number.
#[inline]
pub(super) fn powi<S: Scalar>(x: S, exponent: i32) -> [S; 2] {
    let slope = if exponent == 0 { S::zero() } else { x.powi(exponent - 1) * f64::from(exponent) };
    [x.powi(exponent), slope]
}

/// x^r with its slope.
#[inline]
pub(super) fn powf<S: Scalar>(x: S, exponent: f64) -> [S; 2] {
    let slope = if exponent == 0.0 { S::zero() } else { x.powf(exponent - 1.0) * exponent };
    [x.powf(exponent), slope]
}

/// x^k and its first two derivatives; those that the exponent makes zero are zero, whatever x.
pub(super) fn derivatives_of_power(x: f64, exponent: f64) -> [f64; 3] {
    let mut factor = 1.0;
    [0.0, 1.0, 2.0].map(|order| {
        let derivative = if factor == 0.0 { 0.0 } else { factor * x.powf(exponent - order) };
        factor *= exponent - order;
        derivative
    })
}
