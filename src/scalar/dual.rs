use super::jet::Jet;
use super::{Job, Scalar, assign_operators};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with N directional derivatives (forward-mode dual number), over any scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S, const N: usize> {
    /// The value.
    pub re: S,
    /// Derivatives in N directions.
    pub eps: [S; N],
}

impl<S: Scalar, const N: usize> Dual<S, N> {
    /// A value whose derivative is 1 in direction `lane` and 0 in the others.
    #[inline]
    pub fn variable(re: S, lane: usize) -> Self {
        let mut eps = [S::zero(); N];
        eps[lane] = S::one();
        Dual { re, eps }
    }

    /// A value without derivatives.
    #[inline(always)]
    pub fn constant(re: S) -> Self {
        Dual { re, eps: [S::zero(); N] }
    }

    /// f(x) with the derivatives f' eps; a zero perturbation stays zero where f' is infinite.
    #[inline(always)]
    pub(crate) fn chain(self, [f, first, _]: Jet<S>) -> Self {
        // true if every part of f' is finite: an inner derivative may be infinite where the value is not (x^1.5 at 0)
        let vanishing = first * 0.0;
        if vanishing.value() == 0.0 && vanishing.is_constant() {
            self.each(f, |e| first * e)
        } else {
            let guarded = |e: S| if e.value() == 0.0 && e.is_constant() { S::zero() } else { first * e };
            self.each(f, guarded)
        }
    }

    /// Derivatives one by one: a plain loop is inlined and vectorized where arrays' `map` is not.
    #[inline(always)]
    fn each(mut self, re: S, f: impl Fn(S) -> S) -> Self {
        for e in &mut self.eps {
            *e = f(*e);
        }
        self.re = re;
        self
    }

    #[inline(always)]
    fn zip(self, other: Self, re: S, f: impl Fn(S, S) -> S) -> Self {
        let mut eps = self.eps;
        for (e, o) in eps.iter_mut().zip(&other.eps) {
            *e = f(*e, *o);
        }
        Dual { re, eps }
    }
}

impl<S: Scalar, const N: usize> Default for Dual<S, N> {
    fn default() -> Self {
        Self::constant(S::zero())
    }
}
impl<S: Scalar, const N: usize> From<f64> for Dual<S, N> {
    #[inline(always)]
    fn from(re: f64) -> Self {
        Self::constant(S::from(re))
    }
}
impl<S: Scalar, const N: usize> Neg for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(-self.re, |e| -e)
    }
}
impl<S: Scalar, const N: usize> Add for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, self.re + other.re, |a, b| a + b)
    }
}
impl<S: Scalar, const N: usize> Sub for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.re - other.re, |a, b| a - b)
    }
}
impl<S: Scalar, const N: usize> Mul for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, self.re * other.re, |a, b| a * other.re + self.re * b)
    }
}
impl<S: Scalar, const N: usize> Div for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.re / other.re;
        let inverse = other.re.recip();
        self.zip(other, quotient, |a, b| (a - quotient * b) * inverse)
    }
}
impl<S: Scalar, const N: usize> Add<f64> for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Dual { re: self.re + other, eps: self.eps }
    }
}
impl<S: Scalar, const N: usize> Sub<f64> for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Dual { re: self.re - other, eps: self.eps }
    }
}
impl<S: Scalar, const N: usize> Mul<f64> for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self.each(self.re * other, |e| e * other)
    }
}
impl<S: Scalar, const N: usize> Div<f64> for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: f64) -> Self {
        self.each(self.re / other, |e| e / other)
    }
}
assign_operators!([S: Scalar, const N: usize] Dual<S, N>);

impl<S: Scalar, const N: usize> Scalar for Dual<S, N> {
    #[inline(always)]
    fn value(self) -> f64 {
        self.re.value()
    }
    fn is_constant(self) -> bool {
        self.re.is_constant() && self.eps.iter().all(|e| e.value() == 0.0 && e.is_constant())
    }
    super::jet::functions_by_chain!(re);
    #[inline(always)]
    fn run<J: Job>(job: J) -> J::Output {
        super::wide::widest(job)
    }
    #[inline]
    fn atan2(self, other: Self) -> Self {
        let square = self.re * self.re + other.re * other.re;
        let (along, across) = (other.re / square, self.re / square);
        self.zip(other, self.re.atan2(other.re), |a, b| {
            if a.value() == 0.0 && b.value() == 0.0 && a.is_constant() && b.is_constant() {
                S::zero()
            } else {
                along * a - across * b
            }
        })
    }
}
