//! The values: corrections until what is left is round-off.

use super::failure::{Failure, FailureKind};
use super::round_off::{Floor, kind};
use super::sizes::{NEAR, NOTHING};
use super::{MOST_ITERATIONS, Newton, NewtonTolerance, ROUND_OFF};
use crate::assembly::{Equations, Level, StageSystem, Unknowns};
use crate::elements::RunScalar;

/// Corrections that shrink less than this ask for a fresh factorization.
const SLOW: f64 = 0.1;
/// A system whose corrections shrank less than this leaves no factorization for the next one: a new one costs as much as five to
/// ten corrections, and serves all systems that follow.
const AGED: f64 = 0.05;
/// Corrections that shrink less than this do not converge any more.
const STALLED: f64 = 0.3;
/// Smallest rate of convergence that two corrections, or earlier searches, can vouch for: the first one takes along what the matrix knows,
/// the second one meets directions in which an older matrix contracts less; and states change from search to search.
const FIRST_RATE: f64 = 1e-2;
/// Corrections with an old matrix that grow more than this lead where a new one finds no way back from: a stiff bar that they bend is
/// stretched by the square of it.
const ASTRAY: f64 = 2.0;
/// Corrections of which a matrix is new: a later one that stalls may be its age.
const NEW: usize = 2;
/// Relative correction that is accepted when corrections stall there, whatever the age of the matrix.
const NEARLY: f64 = 1e-13;
/// What an equilibrium may leave for Newton's method to correct, as a displacement by the model's length, where round-off is less.
const BALANCED: f64 = 1e-11;
/// Searches for one equilibrium, each from where the last one ended.
const MOST_SEARCHES: usize = 3;
/// Corrections in a row that may grow, with a new matrix each.
const MOST_GROWN: usize = 4;
/// The same where stresses can be relieved instead.
const MOST_GROWN_STRESSED: usize = 1;
/// Growth of a correction after which stresses are relieved at once.
const WILD: f64 = 100.0;

impl<S: RunScalar> Newton<'_, S> {
    pub(super) fn solve_value(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let equations = stage.equations;
        let fail = |how, iterations, correction| Err(Failure { how, iterations, correction });
        let mut previous = f64::INFINITY;
        let mut fresh = false;
        // the last correction, where it was one of a matrix of this search and small enough that the next one is of the same
        let mut comparable = false;
        // corrections of this search with the matrix that is there
        let mut corrections = 0;
        let mut first_residual = None;
        let mut growth = 0;
        let (mut worst_rate, mut is_first_rate) = (0.0_f64, true);
        let (mut previous_reaction, mut worst_reaction_rate) = (f64::INFINITY, 0.0_f64);
        for iteration in 1..=MOST_ITERATIONS {
            self.evaluate(stage, unknowns);
            // of a residual that is no number the correction is none either
            if self.factored.is_none() || self.tolerance == NewtonTolerance::Residual {
                let size = self.residual_size();
                if !size.is_finite() {
                    return fail(FailureKind::NotFinite, iteration, size);
                }
                let first = *first_residual.get_or_insert(size);
                if self.tolerance == NewtonTolerance::Residual && (size <= 1e-12 || size <= 1e-9 * first) {
                    return Ok(());
                }
            }
            if self.factored.is_none() {
                self.factorize(stage, unknowns).map_err(|singular| Failure::singular(singular, iteration))?;
                (fresh, corrections) = (true, 0);
            }
            corrections += 1;
            let kind = kind(equations);
            self.counters.iterations += 1;
            self.counters.projecting.get_mut(kind).into_iter().for_each(|count| *count += 1);
            let step = self.step(None, unknowns);
            let scale = self.size(&unknowns.x).max(self.size(&unknowns.y));
            // reactions with an old matrix converge by themselves; those of projections are read by nobody
            let reaction_step = if equations.metric { 0.0 } else { self.multiplier_step() };
            let reactions = self.multiplier_size(unknowns);
            let reaction_rate = reaction_step / previous_reaction;
            worst_reaction_rate = worst_reaction_rate.max(if reaction_rate < STALLED { reaction_rate } else { 0.0 });
            let reaction_share = if reaction_rate > 0.0 && reaction_rate < STALLED {
                worst_reaction_rate / (1.0 - worst_reaction_rate)
            } else {
                1.0
            };
            if !step.is_finite() {
                return fail(FailureKind::NotFinite, iteration, step);
            }
            let rate = step / previous;
            if rate < STALLED {
                worst_rate = worst_rate.max(rate);
            }
            // of the error that is left; the first correction says nothing about it
            let trusted = if is_first_rate { worst_rate.max(FIRST_RATE) } else { worst_rate };
            // a matrix from amid a search may be stiff with stresses that the first correction took away: the second one is then too small
            let is_vouched_for = !(fresh && is_first_rate && self.can_relieve(equations));
            is_first_rate &= previous.is_infinite();
            let expected = self.contractions.expected(kind).filter(|_| iteration == 1);
            let share = if rate > 0.0 && rate < STALLED && is_vouched_for {
                trusted / (1.0 - trusted)
            } else {
                // forces of stiff members are read to their last digits: there the second correction is seen
                expected.filter(|_| !self.has_stresses()).map_or(1.0, |rate| rate.max(FIRST_RATE))
            };
            // a matrix of earlier states may be too stiff for this one: its first correction counts where its rate is known
            let known = expected.unwrap_or(rate);
            let is_known = fresh || known > 0.0 && known < STALLED;
            if is_known && self.is_allowed(equations, step * share, scale, reaction_step * reaction_share / reactions) {
                self.contractions.note(kind, (worst_rate > 0.0).then_some(worst_rate));
                return Ok(());
            }
            // far from a solution, the last bits of large stresses would pass for those of the solution
            let is_near = self.displacement(equations, step) <= NEAR;
            let sizes = [scale, reactions];
            let mut floor = match self.floors[kind] {
                Some(floor) if is_near => floor,
                None if is_near => self.measure_floor(kind, stage, unknowns),
                _ => Floor::default(),
            };
            // a projection is as good as its correction of the state is small against the state
            let moved = self.projected_size(stage).map(|(unit, size)| unit * step / size);
            let settled = match moved {
                Some(moved) => moved * share <= 0.25 * f64::EPSILON,
                None => step * share <= ROUND_OFF * scale,
            } || self.is_nothing(equations, step);
            let reactions_settle = reaction_step * reaction_share <= ROUND_OFF * reactions
                || reaction_step <= NOTHING
                || self.is_no_reaction(equations, reaction_step, step);
            let is_round_off = |Floor { corrections: [floor, reaction_floor], .. }: Floor| {
                let reaction = reaction_step * reaction_share <= reaction_floor || reaction_step <= 2.0 * reaction_floor;
                (settled || step * share <= floor || step <= 2.0 * floor, reactions_settle || reaction)
            };
            let by_floor = [if settled { 0.0 } else { step }, if reactions_settle { 0.0 } else { reaction_step }];
            if is_near && is_round_off(floor).0 && !floor.speaks_for(sizes, by_floor) {
                floor = self.measure_floor(kind, stage, unknowns);
            }
            let (settled, reactions_settled) = is_round_off(floor);
            if settled {
                let stalled = reaction_rate >= STALLED && previous_reaction.is_finite();
                if reactions_settled || (stalled && (fresh || reaction_step <= NEARLY * reactions)) {
                    self.contractions.note(kind, (worst_rate > 0.0).then_some(worst_rate));
                    if !fresh && worst_rate.max(worst_reaction_rate) > AGED {
                        self.factored = None;
                    }
                    return Ok(());
                }
                if reaction_rate > SLOW && previous_reaction.is_finite() {
                    self.factored = None;
                }
                (previous, previous_reaction) = (step, reaction_step);
                continue;
            }
            if rate <= 1.0 {
                growth = 0;
            }
            if rate >= STALLED && previous.is_finite() {
                // with an old matrix this may be slow convergence: only a fresh one tells round-off from it
                let near = moved.map_or(step <= NEARLY * scale, |moved| moved <= 8.0 * f64::EPSILON);
                if near && (fresh || reaction_step <= NEARLY * reactions) {
                    return Ok(());
                }
                if !fresh && rate > ASTRAY {
                    unknowns.clone_from(&self.guess);
                    self.factored = None;
                    (previous, worst_rate, is_first_rate) = (f64::INFINITY, 0.0, true);
                    continue;
                }
                if comparable && is_near && self.at_round_off(stage, unknowns, step, scale) {
                    if corrections <= NEW {
                        let corrections = [step, floor.corrections[1].max(reaction_step)];
                        self.floors[kind] = Some(Floor { corrections, unknowns: sizes });
                        return Ok(());
                    }
                    // a new matrix tells
                    self.factored = None;
                    (previous, previous_reaction) = (step, reaction_step);
                    continue;
                }
                if fresh && rate > 1.0 {
                    // in a row: a slender beam that is bent is stretched by it, which the next correction takes back
                    growth += 1;
                    let is_wild = growth > MOST_GROWN_STRESSED || rate > WILD;
                    let most = if is_wild && self.can_relieve(equations) { 0 } else { MOST_GROWN };
                    if growth > most || step > 1e6 * scale.max(1.0) {
                        return fail(FailureKind::Diverged, iteration, step / scale);
                    }
                }
            }
            if rate > SLOW && iteration > 1 {
                self.factored = None;
            }
            comparable = fresh && is_near;
            (previous, previous_reaction) = (step, reaction_step);
        }
        let scale = self.size(&unknowns.x).max(f64::MIN_POSITIVE);
        fail(FailureKind::Stagnated, MOST_ITERATIONS, previous / scale)
    }

    /// Evaluates anew and measures what is round-off there.
    fn measure_floor(&mut self, kind: usize, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Floor {
        self.evaluate(stage, unknowns);
        let floor = self.round_off(stage, unknowns);
        *self.floors[kind].insert(floor)
    }

    /// Solves, and asks the matrix at the unknowns that were accepted what it would still correct: at most [`BALANCED`] of the model's
    /// length, or round-off there.
    pub(super) fn solve_balanced(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let equations = stage.equations;
        let mut left = f64::NAN;
        for _ in 0..MOST_SEARCHES {
            self.solve_value(stage, unknowns)?;
            self.factored = None;
            self.evaluate(stage, unknowns);
            self.factorize(stage, unknowns).map_err(|singular| Failure::singular(singular, 0))?;
            let floor = self.round_off(stage, unknowns);
            self.floors[kind(equations)] = Some(floor);
            self.rhs.copy_from_slice(&self.exact);
            self.factorization.solve(&mut self.rhs);
            self.counters.solves += 1;
            self.work.clone_from(unknowns);
            let step = self.jacobian.add_step(&self.system, &self.rhs, None, &mut self.work, &self.coordinate_scales);
            left = self.displacement(equations, step);
            let round_off = self.displacement(equations, floor.corrections[0]);
            if left <= BALANCED.max(4.0 * round_off) && round_off <= NEAR {
                return Ok(());
            }
        }
        Err(Failure { how: FailureKind::Unbalanced, iterations: MOST_SEARCHES, correction: left })
    }

    /// Whether a search may leave this much of its unknowns, whose size is given, and this share of the reactions; these are asked for as
    /// many digits as accelerations.
    fn is_allowed(&self, equations: &Equations, left: f64, size: f64, reactions: f64) -> bool {
        let Some([coordinates, velocities, projected]) = self.allowed else { return false };
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
}
