use super::ConstraintKind;
use super::quadratic::{NoStep, QuadraticProgram, Step};

/// The quadratic program of an iteration: a model of the Lagrangian on linearized constraints, within bounds and a move limit.
pub(super) struct Subproblem<'s> {
    pub hessian: &'s [Vec<f64>],
    pub gradient: &'s [f64],
    pub rows: &'s [Vec<f64>],
    /// The constraints' values where they are linearized.
    pub offsets: &'s [f64],
    pub kinds: &'s [ConstraintKind],
    /// Constraints that hold and are linear stay so.
    pub linear_from: usize,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

/// A step, its multipliers, and the largest violation that the linearized constraints leave.
pub(super) struct Direction {
    pub step: Vec<f64>,
    pub multipliers: Vec<f64>,
    pub left: f64,
}

/// By how much the price of the violation grows with it, which makes the program strictly convex.
const CONVEXITY: f64 = 1e-3;
/// Share of the violation that the squared step of a restoration weighs.
const SHORTNESS: f64 = 1e-3;

impl Subproblem<'_> {
    /// The minimum on all linearized constraints.
    ///
    /// # Errors
    /// See [`NoStep`].
    pub fn strict(&self) -> Result<Direction, NoStep> {
        let Subproblem { hessian, gradient, rows, offsets, kinds, lower, upper, .. } = self;
        let program = QuadraticProgram { hessian, gradient, rows, offsets, kinds, lower, upper };
        let Step { step, multipliers } = program.solve()?;
        Ok(Direction { step, multipliers, left: 0.0 })
    }

    /// The step that leaves least violation, among those of about the same violation a short one.
    pub fn restoration(&self, violation: f64) -> Option<Direction> {
        let width = self.lower.iter().zip(&self.upper).map(|(lower, upper)| (upper - lower).min(2.0)).fold(0.0, f64::max);
        let size = SHORTNESS * violation / (width * width).max(f64::MIN_POSITIVE);
        let n = self.gradient.len();
        let hessian: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| if i == j { size } else { 0.0 }).collect()).collect();
        Subproblem {
            hessian: &hessian,
            gradient: &vec![0.0; n],
            lower: self.lower.clone(),
            upper: self.upper.clone(),
            ..*self
        }
        .priced(1.0, violation)
    }

    /// The minimum of the model plus `price` times the largest violation t of the linearized constraints: one more unknown.
    ///
    /// Source: Fletcher (1987), Practical Methods of Optimization, section 14.3, with the largest violation in place of the sum.
    pub fn priced(&self, price: f64, violation: f64) -> Option<Direction> {
        let n = self.gradient.len();
        let widened = |row: &[f64], sign: f64, relaxed: bool| -> Vec<f64> {
            row.iter().map(|entry| sign * entry).chain([if relaxed { -1.0 } else { 0.0 }]).collect()
        };
        let (mut rows, mut offsets, mut kinds, mut origins) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (k, (row, &c)) in self.rows.iter().zip(self.offsets).enumerate() {
            let holds = match self.kinds[k] {
                ConstraintKind::Equality => c.abs(),
                ConstraintKind::AtMostZero => c,
            } <= super::quadratic::ROUND_OFF;
            let kept = k >= self.linear_from && holds;
            let sides: &[f64] = if self.kinds[k] == ConstraintKind::AtMostZero || kept { &[1.0] } else { &[1.0, -1.0] };
            for &sign in sides {
                rows.push(widened(row, sign, !kept));
                offsets.push(sign * c);
                kinds.push(if kept { self.kinds[k] } else { ConstraintKind::AtMostZero });
                origins.push((k, sign));
            }
        }
        let mut hessian = self.hessian.to_vec();
        hessian.iter_mut().for_each(|row| row.push(0.0));
        hessian.push(vec![0.0; n + 1]);
        hessian[n][n] = CONVEXITY * price / violation.max(1.0);
        let gradient: Vec<f64> = self.gradient.iter().copied().chain([price]).collect();
        let lower: Vec<f64> = self.lower.iter().copied().chain([0.0]).collect();
        let upper: Vec<f64> = self.upper.iter().copied().chain([f64::INFINITY]).collect();
        let program = QuadraticProgram {
            hessian: &hessian,
            gradient: &gradient,
            rows: &rows,
            offsets: &offsets,
            kinds: &kinds,
            lower: &lower,
            upper: &upper,
        };
        let Step { mut step, multipliers: found } = program.solve().ok()?;
        let left = step.pop()?;
        let mut multipliers = vec![0.0; self.rows.len()];
        origins.iter().zip(found).for_each(|(&(k, sign), multiplier)| multipliers[k] += sign * multiplier);
        Some(Direction { step, multipliers, left })
    }
}
