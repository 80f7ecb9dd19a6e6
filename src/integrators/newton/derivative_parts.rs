//! Derivative parts of the unknowns: linear systems, corrected with the matrix at the solution.

use super::failure::{Failure, FailureKind};
use super::{MOST_ITERATIONS, Newton};
use crate::assembly::{StageSystem, Unknowns};
use crate::elements::RunScalar;
use crate::tolerances::{NO_ROUND_OFF, ROUND_OFF, SAME_DERIVATIVE};

/// Corrections of derivative parts that are made before round-off is taken for the reason why they do not end.
const PASSES: usize = 4;
/// Share of a value, per relative change of a number, that is no derivative but round-off, with [`SAME_DERIVATIVE`] of it.
const ZERO_SHARE: f64 = 1e-3;
const STAGNATED: &str = "stagnated in the derivative parts";
/// Corrections of derivative parts that shrink less than this do not converge any more.
const SLOW_PARTS: f64 = 0.9;
/// Correction up to which a guide counts as the solution of the same problem, in effects of one rounding of the state: what a guide was content with, and
/// what its own state lost since.
const GUIDED_ROUNDINGS: f64 = 16.0;

impl<S: RunScalar> Newton<'_, S> {
    /// Solves for the derivative parts alone, the values being a solution already (that of a real run).
    pub fn solve_guided(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        self.counters.systems += 1;
        self.residual.start(&self.system, stage);
        self.set_coordinate_scales(stage.base, stage.p);
        self.residual.keep_values = true;
        self.solve_parts(stage, unknowns)?;
        let scale = self.size(&unknowns.x).max(f64::MIN_POSITIVE);
        let correction = self.step(None, &mut unknowns.clone());
        let near = match self.projected_size(stage) {
            Some((unit, size)) => unit * correction <= NO_ROUND_OFF * size,
            None => correction <= NO_ROUND_OFF * scale,
        };
        // what comes to rest has no size but that of the motion before; where nothing moves there is none to compare with
        let near = near || self.is_near_in_run(stage.equations, correction);
        if near || self.is_nothing(stage.equations, correction) || self.at_round_off(stage, unknowns, correction, scale) {
            return Ok(());
        }
        self.evaluate(stage, unknowns);
        if correction <= GUIDED_ROUNDINGS * self.round_off_of(None, stage, unknowns) {
            return Ok(());
        }
        Err(Failure { how: FailureKind::Stagnated, iterations: 0, correction: correction / scale })
    }

    /// With the value converged, the derivative parts solve one linear system each: factored there, they are exact.
    pub(super) fn solve_parts(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        self.evaluate(stage, unknowns);
        self.factorize(stage, unknowns).map_err(|singular| Failure::singular(singular, 0))?;
        self.refine_parts(stage, unknowns)?;
        self.note_sizes();
        Ok(())
    }

    /// Corrects the derivative parts with the factored matrix until they are round-off.
    fn refine_parts(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let mut previous = f64::INFINITY;
        for pass in 1..=MOST_ITERATIONS {
            if pass > 1 {
                self.evaluate(stage, unknowns);
            }
            let (mut largest, mut beyond) = (0.0_f64, 0.0_f64);
            for part in 0..S::PARTS {
                let step = self.step(Some(part), unknowns);
                let parts = unknowns.x.iter().zip(&self.coordinate_scales);
                // max() of floats would lose a NaN, a sum keeps it
                let (scale, sum) = parts.fold((0.0_f64, 0.0), |(scale, sum), (x, of_coordinate)| {
                    let size = x.part(part).abs() * of_coordinate;
                    (scale.max(size), sum + size)
                });
                if !(sum + step).is_finite() {
                    let how = FailureKind::Parts("met a derivative part that is not finite");
                    return Err(Failure { how, iterations: pass, correction: f64::NAN });
                }
                if scale > 0.0 {
                    largest = largest.max(step / scale);
                }
                let shrinks = scale == 0.0 || step <= ROUND_OFF * scale;
                if pass >= PASSES && !shrinks && !self.is_no_part(part, stage.equations, step) {
                    beyond = beyond.max(step / self.size_of_part(part, stage, unknowns));
                }
            }
            if pass > 1 && largest <= ROUND_OFF || pass >= PASSES && beyond <= SAME_DERIVATIVE {
                return Ok(());
            }
            if pass >= PASSES && beyond > SLOW_PARTS * previous {
                if self.parts_at_round_off(stage, unknowns) {
                    return Ok(());
                }
                return Err(Failure { how: FailureKind::Parts(STAGNATED), iterations: pass, correction: beyond });
            }
            previous = if pass >= PASSES { beyond } else { f64::INFINITY };
        }
        Err(Failure { how: FailureKind::Parts(STAGNATED), iterations: MOST_ITERATIONS, correction: previous })
    }

    /// Corrections no longer shrink: are they what the last bits of (a, v, q) and of their parts change? So it is with accelerations of stiff
    /// members, which are the small difference of large forces: a share eps omega^2 of what moves, omega the highest frequency.
    fn parts_at_round_off(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> bool {
        (0..S::PARTS).all(|part| {
            self.evaluate(stage, unknowns);
            let left = self.step(Some(part), &mut unknowns.clone());
            let round_off = self.round_off_of(Some(part), stage, unknowns);
            // accelerations of given coordinates and velocities are a sum of forces: where something stays at rest it cancels, and has no size
            let coefficients = stage.equations.residual;
            let is_sum_of_forces = coefficients.alpha == 0.0 && coefficients.beta == 0.0;
            let size = self.size_of_part(part, stage, unknowns);
            left <= 2.0 * round_off && (is_sum_of_forces || left <= NO_ROUND_OFF * size)
        })
    }

    /// What a correction of derivative part `part` is measured by: the unknowns' parts and those of the coordinates and velocities that
    /// they move; where all of these vanish but for round-off, a small share of the values, per relative change of the numbers.
    fn size_of_part(&self, part: usize, stage: StageSystem<S>, unknowns: &Unknowns<S>) -> f64 {
        let StageSystem { equations, base, p, .. } = stage;
        let coefficients = equations.residual;
        let size = |read: &dyn Fn(&S) -> f64| {
            let of = |values: &[S]| {
                values.iter().zip(&self.coordinate_scales).fold(0.0, |s: f64, (x, scale)| s.max(read(x).abs() * scale))
            };
            let moved = |values: &[S], by: f64| if by == 0.0 { 0.0 } else { of(values) / by.abs() };
            let own = of(&unknowns.x);
            own.max(moved(&base.v, coefficients.beta)).max(moved(&base.q, coefficients.alpha))
        };
        let relative = |x: &S| if x.value() == 0.0 { x.part(part).abs() } else { (x.part(part) / x.value()).abs() };
        let largest_q = base.q.iter().fold(0.0, |s: f64, q| s.max(q.value().abs())).max(f64::MIN_POSITIVE);
        let of_numbers = p.iter().map(relative).fold(0.0, f64::max);
        let of_start = base.q.iter().fold(0.0, |s: f64, q| s.max(q.part(part).abs())) / largest_q;
        let share = ZERO_SHARE * of_numbers.max(of_start);
        // where values vanish too, the same share of what moves: of the numbers' own parts
        let moves = p.iter().chain(&base.q).chain(&base.v).fold(0.0, |s: f64, x| s.max(x.part(part).abs()));
        size(&|x| x.part(part)).max(share * size(&|x| x.value())).max(ZERO_SHARE * moves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::{Equations, Model, Residual, VectorsAvq};
    use crate::elements::{Element, NodeKind, Parameter, State};
    use crate::integrators::{ConstraintLevel, Method, NewtonTolerance, table_by_name};
    use crate::linalg::Backend;
    use crate::scalar::{COMPLEX_STEP, Complex64, Scalar};
    use std::sync::Arc;

    #[derive(Hash)]
    struct PushedMass;

    impl Element for PushedMass {
        const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg"), Parameter::new("force", "N")];
        fn nodes(&self) -> Vec<NodeKind> {
            vec![NodeKind::Coordinates(1)]
        }
        fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
            r[0] += p[0] * s.a[0] - p[1];
        }
    }

    /// The derivative of the acceleration by the force, with a matrix that was factored for another mass.
    fn derivative(factored_for: f64, force_part: f64) -> Result<f64, String> {
        let mut model = Model::default();
        let node = model.add_node("mass", NodeKind::Coordinates(1), false);
        model.add_element("push", &[node], Arc::new(PushedMass));
        let method = Method::new(table_by_name("bdf2").ok_or("not listed")?, ConstraintLevel::default());
        let system = method.system(&model, &[]);
        let mut newton = Newton::<Complex64>::new(system, NewtonTolerance::default(), Backend::default())
            .map_err(|_| "a singular pattern".to_string())?;
        let equations = Equations::acceleration();
        let zero = || vec![Complex64::new(0.0, 0.0)];
        let base = VectorsAvq { a: zero(), v: zero(), q: zero() };
        let p = [Complex64::new(2.0, 0.0), Complex64::new(6.0, force_part * COMPLEX_STEP)];
        let others = [Complex64::new(factored_for, 0.0), p[1]];
        let mut unknowns = Unknowns::default();
        Residual::shape(&newton.system, &mut unknowns, true);
        let stage_of = |p| StageSystem { equations: &equations, base: &base, p, t: 0.0 };
        newton.residual.start(&newton.system, stage_of(&others));
        newton.evaluate(stage_of(&others), &mut unknowns);
        newton.factorize(stage_of(&others), &unknowns).map_err(|_| "a singular matrix".to_string())?;
        let stage = stage_of(&p);
        newton.residual.start(&newton.system, stage);
        unknowns.x[0].re = 3.0;
        newton.evaluate(stage, &mut unknowns);
        let refined = newton.refine_parts(stage, &mut unknowns);
        refined.map_err(|failure| newton.describe(&failure, &equations, "start").to_string())?;
        Ok(unknowns.x[0].im / COMPLEX_STEP)
    }

    #[test]
    fn derivative_parts_that_converge_are_exact_and_others_are_an_error() {
        assert!((derivative(2.0, 1.0).expect("its own matrix") - 0.5).abs() < 1e-15);
        assert!((derivative(2.2, 1.0).expect("a matrix that is nearly right") - 0.5).abs() < 1e-9);
        // too heavy: every correction takes a hundredth of what is left; too light: every one is 1.5 times as large as the one before
        for mass in [200.0, 0.8] {
            let message = derivative(mass, 1.0).expect_err("a matrix that is wrong");
            assert!(message.contains("start") && message.contains("derivative parts"), "{message}");
            assert!(message.contains("\"mass\", coordinate 0"), "{message}");
        }
        let message = derivative(2.0, f64::NAN).expect_err("no number");
        assert!(message.contains("derivative part that is not finite"), "{message}");
    }
}
