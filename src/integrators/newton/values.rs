//! The values: corrections until what is left is round-off.

use super::convergence::{Convergence, Correction, RateEstimate, Sizes, Verdict};
use super::failure::{Failure, FailureKind};
use super::round_off::{Floor, kind};
use super::{MOST_ITERATIONS, Newton, NewtonTolerance};
use crate::assembly::{Level, StageSystem, Unknowns};
use crate::elements::RunScalar;

/// What an equilibrium may leave for Newton's method to correct, as a displacement by the model's length, where round-off is less.
const BALANCED: f64 = 1e-11;
/// Searches for one equilibrium, each from where the last one ended.
const MOST_SEARCHES: usize = 3;

impl<S: RunScalar> Newton<'_, S> {
    pub(super) fn solve_value(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let by_residual = self.tolerance == NewtonTolerance::Residual;
        let mut convergence = Convergence::new(by_residual);
        for iteration in 1..=MOST_ITERATIONS {
            self.evaluate(stage, unknowns);
            // of a residual that is no number the correction is none either
            let mut verdict = if self.kept.factored.is_none() || by_residual {
                convergence.judge_residual(self.residual_size())
            } else {
                Verdict::GoOn
            };
            if verdict == Verdict::GoOn {
                if self.kept.factored.is_none() {
                    self.factorize(stage, unknowns).map_err(|singular| Failure::singular(singular, iteration))?;
                    convergence.begin_matrix();
                }
                let correction = self.correct(stage, unknowns);
                verdict = convergence.judge(correction, &mut Searched { newton: self, stage, unknowns });
            }
            let fail = |how, correction| Err(Failure { how, iterations: iteration, correction });
            match verdict {
                Verdict::Converged(lesson) => {
                    self.learn(kind(stage.equations), lesson, &convergence);
                    return Ok(());
                }
                Verdict::GoOn => {}
                Verdict::NewMatrix => self.kept.factored = None,
                Verdict::Restart => {
                    unknowns.clone_from(&self.guess);
                    self.kept.factored = None;
                }
                // by whoever has the first guess
                Verdict::Relieve(correction) => return fail(FailureKind::Diverged, correction),
                Verdict::Fail(how, correction) => return fail(how, correction),
            }
        }
        let correction = convergence.last() / self.size(&unknowns.x).max(f64::MIN_POSITIVE);
        Err(Failure { how: FailureKind::Stagnated, iterations: MOST_ITERATIONS, correction })
    }

    fn correct(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Correction {
        self.counters.iterations += 1;
        self.counters.projecting.get_mut(kind(stage.equations)).into_iter().for_each(|count| *count += 1);
        let step = self.step(None, unknowns);
        let scale = self.size(&unknowns.x);
        // reactions with an old matrix converge by themselves; those of projections are read by nobody
        let reaction_step = if stage.equations.metric { 0.0 } else { self.multiplier_step() };
        Correction { step, scale, reaction_step, reactions: self.multiplier_size(unknowns) }
    }

    /// Keeps what a search that has ended tells of later ones.
    fn learn(&mut self, kind: usize, lesson: RateEstimate, convergence: &Convergence) {
        match lesson {
            RateEstimate::Nothing => {}
            RateEstimate::Rates { is_aged } => {
                self.kept.contractions.note(kind, convergence.seen_rate());
                if is_aged {
                    self.kept.factored = None;
                }
            }
            RateEstimate::Floor(floor) => self.kept.floors[kind] = Some(floor),
        }
    }

    /// Solves, and asks the matrix at the unknowns that were accepted what it would still correct: at most [`BALANCED`] of the model's
    /// length, or round-off there.
    pub(super) fn solve_balanced(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let equations = stage.equations;
        let mut left = f64::NAN;
        for _ in 0..MOST_SEARCHES {
            self.solve_value(stage, unknowns)?;
            self.kept.factored = None;
            self.evaluate(stage, unknowns);
            self.factorize(stage, unknowns).map_err(|singular| Failure::singular(singular, 0))?;
            let floor = self.round_off(stage, unknowns);
            self.kept.floors[kind(equations)] = Some(floor);
            self.rhs.copy_from_slice(&self.exact);
            self.factorization.solve(&mut self.rhs);
            self.counters.solves += 1;
            self.work.clone_from(unknowns);
            let step = self.jacobian.add_step(&self.system, &self.rhs, None, &mut self.work, &self.coordinate_scales);
            left = self.displacement(equations, step);
            let round_off = self.displacement(equations, floor.corrections[0]);
            if left <= BALANCED.max(4.0 * round_off) && round_off <= crate::tolerances::NO_ROUND_OFF {
                return Ok(());
            }
        }
        Err(Failure { how: FailureKind::Unbalanced, iterations: MOST_SEARCHES, correction: left })
    }
}

struct Searched<'s, 'm, S> {
    newton: &'s mut Newton<'m, S>,
    stage: StageSystem<'s, S>,
    unknowns: &'s mut Unknowns<S>,
}

impl<S: RunScalar> Sizes for Searched<'_, '_, S> {
    fn expected_rate(&self) -> Option<f64> {
        self.newton.kept.contractions.expected(kind(self.stage.equations))
    }

    fn has_stresses(&mut self) -> bool {
        self.newton.has_stresses()
    }

    fn can_relieve(&mut self) -> bool {
        self.newton.can_relieve(self.stage.equations)
    }

    // reactions are asked for as many digits as accelerations
    fn allows(&self, left: f64, size: f64, reactions: f64) -> bool {
        let (Some([coordinates, velocities, projected]), equations) = (self.newton.allowed, self.stage.equations) else {
            return false;
        };
        let used = match (equations.metric, equations.level) {
            (true, Level::Position) => left * equations.constraint.alpha.abs() / projected,
            (true, _) => left * equations.constraint.beta.abs() / velocities,
            (false, _) => {
                let [of_coordinates, of_velocities] = [equations.residual.alpha, equations.residual.beta].map(f64::abs);
                (left * of_coordinates / coordinates).max(left * of_velocities / velocities)
            }
        };
        used <= 1.0 && (equations.metric || reactions.is_nan() || reactions * size * used <= left)
    }

    fn displacement(&self, step: f64) -> f64 {
        self.newton.displacement(self.stage.equations, step)
    }

    fn moved(&self, step: f64) -> Option<f64> {
        self.newton.projected_size(self.stage).map(|(unit, size)| unit * step / size)
    }

    fn is_nothing(&self, step: f64) -> bool {
        self.newton.is_nothing(self.stage.equations, step)
    }

    fn is_no_reaction(&mut self, reaction_step: f64, step: f64) -> bool {
        self.newton.is_no_reaction(self.stage.equations, reaction_step, step)
    }

    fn floor(&mut self) -> Floor {
        self.newton.kept.floors[kind(self.stage.equations)].unwrap_or_else(|| self.floor_here())
    }

    fn floor_here(&mut self) -> Floor {
        let Searched { newton, stage, unknowns } = self;
        newton.evaluate(*stage, unknowns);
        let floor = newton.round_off(*stage, unknowns);
        *newton.kept.floors[kind(stage.equations)].insert(floor)
    }

    fn at_round_off(&mut self, step: f64, scale: f64) -> bool {
        let Searched { newton, stage, unknowns } = self;
        newton.at_round_off(*stage, unknowns, step, scale)
    }
}
