use super::ConstraintKind;
use super::quadratic::{QuadraticProgram, Step};
use nalgebra::{DMatrix, DVector};

/// The quadratic program of an iteration: a model of the Lagrangian on linearized constraints, within bounds and a move limit.
pub(super) struct Subproblem {
    pub program: QuadraticProgram,
    /// Constraints that hold and are linear stay so.
    pub linear_from: usize,
}

/// By how much the price of the violation grows with it, which makes the program strictly convex.
const CONVEXITY: f64 = 1e-3;
/// Share of the violation that the squared step of a restoration weighs.
const SHORTNESS: f64 = 1e-3;

impl Subproblem {
    /// The step that leaves least violation, among those of about the same violation a short one.
    pub fn restoration(&self, violation: f64) -> Option<Step> {
        let QuadraticProgram { lower, upper, .. } = &self.program;
        let width = lower.iter().zip(upper).map(|(lower, upper)| (upper - lower).min(2.0)).fold(0.0, f64::max);
        let size = SHORTNESS * violation / (width * width).max(f64::MIN_POSITIVE);
        let n = lower.len();
        let (hessian, gradient) = (DMatrix::from_diagonal_element(n, n, size), DVector::zeros(n));
        let program = QuadraticProgram { hessian, gradient, ..self.program.clone() };
        Subproblem { program, ..*self }.priced(1.0, violation)
    }

    /// The minimum of the model plus `price` times the largest violation t of the linearized constraints: one more unknown.
    ///
    /// Source: Fletcher (1987), Practical Methods of Optimization, section 14.3, with the largest violation in place of the sum.
    pub fn priced(&self, price: f64, violation: f64) -> Option<Step> {
        let QuadraticProgram { hessian, gradient, normals, offsets, kinds, lower, upper } = &self.program;
        let n = gradient.len();
        let (mut sides, mut sided_kinds) = (Vec::new(), Vec::new());
        for (k, (&kind, &c)) in kinds.iter().zip(offsets).enumerate() {
            let inequality = kind == ConstraintKind::AtMostZero;
            let kept = k >= self.linear_from && if inequality { c } else { c.abs() } <= crate::tolerances::LONG_SUM;
            for &sign in if inequality || kept { &[1.0][..] } else { &[1.0, -1.0] } {
                sides.push((k, sign, kept));
                sided_kinds.push(if kept { kind } else { ConstraintKind::AtMostZero });
            }
        }
        let mut hessian = hessian.clone().resize(n + 1, n + 1, 0.0);
        hessian[(n, n)] = CONVEXITY * price / violation.max(1.0);
        let program = QuadraticProgram {
            hessian,
            gradient: gradient.push(price),
            normals: DMatrix::from_fn(n + 1, sides.len(), |i, side| match sides[side] {
                (k, sign, _) if i < n => sign * normals[(i, k)],
                (_, _, kept) => {
                    if kept {
                        0.0
                    } else {
                        -1.0
                    }
                }
            }),
            offsets: sides.iter().map(|&(k, sign, _)| sign * offsets[k]).collect(),
            kinds: sided_kinds,
            lower: [&lower[..], &[0.0]].concat(),
            upper: [&upper[..], &[f64::INFINITY]].concat(),
        };
        let Step { step, multipliers: found, .. } = program.solve().ok()?;
        let mut multipliers = vec![0.0; kinds.len()];
        sides.iter().zip(found).for_each(|(&(k, sign, _), multiplier)| multipliers[k] += sign * multiplier);
        Some(Step { left: step[n], step: step.remove_row(n), multipliers })
    }
}
