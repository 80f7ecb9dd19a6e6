//! Discrete Euler-Lagrange equations: what a step of a variational integrator solves instead of R = 0.

/// One step of the variational integrator with the discrete Lagrangian L_d(q_n, q_n+1) = h L(q_n + alpha (q_n+1 - q_n), (q_n+1 - q_n) / h).
///
/// With the discrete velocity v = (q_n+1 - q_n) / h, the momentum P = dL/dv and the force F = dL/dq + Q of the elements, and `before` for
/// the point of the step before, the equations divided by h are
///
/// P / h - (1 - alpha) F - (P / h + alpha F)_before + A(q_n)^T mu = 0,   g(q_n+1) = 0,
///
/// in the first step P(v_0, q_0) / h takes the place of the bracket (discrete Legendre transform) and the reaction acts for half a step.
/// A system's base holds (v_before, q_n + alpha h v_before), and its unknown x is (v - v_before) / h.
///
/// Source: Leyendecker, Marsden & Ortiz (2008); Ebrahimi et al. (2019), equations (10) to (17).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variational {
    /// Place of the quadrature point within the step, from 0 to 1.
    pub alpha: f64,
    /// Size of this step and of the one before \[s\].
    pub h: f64,
    /// True for the first step, which starts from a velocity.
    pub first: bool,
}

impl Variational {
    /// Weights of the momentum P = dL/dv and the force F = dL/dq + Q of elements in this step.
    pub fn now(self) -> [f64; 2] {
        [1.0 / self.h, -(1.0 - self.alpha)]
    }

    /// Those in what the step before left.
    pub fn before(self) -> [f64; 2] {
        [1.0 / self.h, if self.first { 0.0 } else { self.alpha }]
    }

    /// Share of a step for which reactions act.
    pub fn reaction(self) -> f64 {
        if self.first { 0.5 } else { 1.0 }
    }

    /// From the base's coordinates to those at the end of the step, before x moves them: times the base's velocity \[s\].
    pub fn to_end(self) -> f64 {
        (1.0 - self.alpha) * self.h
    }

    /// To those at the start of the step, where reactions act \[s\].
    pub fn to_start(self) -> f64 {
        -self.alpha * self.h
    }

    /// To those of the point before \[s\].
    pub fn to_before(self) -> f64 {
        if self.first { self.to_start() } else { -self.h }
    }
}
