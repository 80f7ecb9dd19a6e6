//! The judgement of a search: what a series of corrections says, apart from the loop that makes them.

#[cfg(test)]
mod tests;

use super::failure::FailureKind;
use super::round_off::Floor;
use crate::tolerances::{NO_ROUND_OFF, NOTHING, ROUND_OFF};

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
/// Corrections in a row that may grow, with a new matrix each.
const MOST_GROWN: usize = 4;
/// The same where stresses can be relieved instead.
const MOST_GROWN_STRESSED: usize = 1;
/// Growth of a correction after which stresses are relieved at once.
const WILD: f64 = 100.0;
/// Beyond this a search is lost: a correction by the unknowns, or by 1 where these are smaller, or the displacement in one system by the model's length.
pub(super) const LOST: f64 = 1e6;
/// Residual, and its share of the first one, at which [`NewtonTolerance::Residual`](super::NewtonTolerance) is content.
const RESIDUAL: [f64; 2] = [1e-12, 1e-9];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    Converged(RateEstimate),
    /// Another correction with the same matrix.
    GoOn,
    /// Another correction, with the matrix at the unknowns.
    NewMatrix,
    /// The search begins again at its first guess, with the matrix there.
    Restart,
    /// Stresses stiffen every matrix: they are relieved. The correction by the unknowns.
    Relieve(f64),
    /// There is no solution near by. The correction by the unknowns, or what is no number.
    Fail(FailureKind, f64),
}

/// What a search that has ended tells of later ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RateEstimate {
    Nothing,
    /// The rates that were seen are those of the matrix; whether it has become too old for another system.
    Rates {
        is_aged: bool,
    },
    Floor(Floor),
}

/// Sizes of one correction, of the unknowns after it, and of both for multipliers, in the scales of the model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Correction {
    pub step: f64,
    pub scale: f64,
    pub reaction_step: f64,
    pub reactions: f64,
}

/// What a correction is compared with; each is worked out only when it is asked for.
pub(super) trait Sizes {
    /// The share of a first correction that the second one is expected to have at most.
    fn expected_rate(&self) -> Option<f64>;
    fn has_stresses(&mut self) -> bool;
    /// Whether they can be in a search for these unknowns.
    fn can_relieve(&mut self) -> bool;
    /// Whether a search may leave this much of its unknowns, whose size is given, and this share of the reactions.
    fn allows(&self, left: f64, size: f64, reactions: f64) -> bool;
    /// A correction as a displacement, by the length of the model.
    fn displacement(&self, step: f64) -> f64;
    /// Of a projection: what a correction moves the projected state by, as a share of it.
    fn moved(&self, step: f64) -> Option<f64>;
    fn is_nothing(&self, step: f64) -> bool;
    /// The same of multipliers.
    fn is_no_reaction(&mut self, reaction_step: f64, step: f64) -> bool;
    /// Corrections that are round-off, as they were measured last; measured here where they never were.
    fn floor(&mut self) -> Floor;
    fn floor_here(&mut self) -> Floor;
    /// Whether a correction that shrinks no more is what round-off of the residual leaves.
    fn at_round_off(&mut self, step: f64, scale: f64) -> bool;
}

#[derive(Default)]
pub(super) struct Convergence {
    by_residual: bool,
    first_residual: Option<f64>,
    iterations: usize,
    fresh: bool,
    /// Corrections of this search with the matrix that is there.
    with_matrix: usize,
    /// The last correction, and that of multipliers.
    previous: Option<f64>,
    previous_reaction: Option<f64>,
    /// The last correction was one of a matrix of this search and small enough that the next one is of the same.
    comparable: bool,
    worst_rate: f64,
    worst_reaction_rate: f64,
    has_rate: bool,
    growth: usize,
}

/// One correction against those before: rates, the shares of it that are reckoned to be left, and where it stands.
struct Seen {
    new: Correction,
    rate: f64,
    reaction_rate: f64,
    share: f64,
    reaction_share: f64,
    moved: Option<f64>,
    is_near: bool,
}

impl Convergence {
    pub fn new(by_residual: bool) -> Self {
        Convergence { by_residual, ..Convergence::default() }
    }

    /// The worst rate at which corrections shrank, if more than one was made.
    pub fn seen_rate(&self) -> Option<f64> {
        (self.worst_rate > 0.0).then_some(self.worst_rate)
    }

    pub fn last(&self) -> f64 {
        self.previous.unwrap_or(f64::INFINITY)
    }

    /// The next correction is the first one of a new matrix.
    pub fn begin_matrix(&mut self) {
        (self.fresh, self.with_matrix) = (true, 0);
    }

    pub fn judge_residual(&mut self, size: f64) -> Verdict {
        if !size.is_finite() {
            return Verdict::Fail(FailureKind::NotFinite, size);
        }
        let first = *self.first_residual.get_or_insert(size);
        let is_small = self.by_residual && (size <= RESIDUAL[0] || size <= RESIDUAL[1] * first);
        if is_small { Verdict::Converged(RateEstimate::Nothing) } else { Verdict::GoOn }
    }

    pub fn judge(&mut self, new: Correction, sizes: &mut impl Sizes) -> Verdict {
        self.iterations += 1;
        self.with_matrix += 1;
        if !new.step.is_finite() {
            return Verdict::Fail(FailureKind::NotFinite, new.step);
        }
        let expected = sizes.expected_rate().filter(|_| self.iterations == 1);
        let mut seen = self.compare(new, expected, sizes);
        // a matrix of earlier states may be too stiff for this one: its first correction counts where its rate is known
        let known = expected.unwrap_or(seen.rate);
        let is_known = self.fresh || known > 0.0 && known < STALLED;
        let Seen { share, reaction_share, .. } = seen;
        if is_known && sizes.allows(new.step * share, new.scale, new.reaction_step * reaction_share / new.reactions) {
            return Verdict::Converged(RateEstimate::Rates { is_aged: false });
        }
        // far from a solution, the last bits of large stresses would pass for those of the solution
        seen.is_near = sizes.displacement(new.step) <= NO_ROUND_OFF;
        let mut floor = if seen.is_near { sizes.floor() } else { Floor::default() };
        // a projection is as good as its correction of the state is small against the state
        seen.moved = sizes.moved(new.step);
        let [settled, reactions_settled] = seen.settles(&mut floor, sizes);
        let verdict =
            if settled { self.judge_settled(&seen, reactions_settled) } else { self.judge_unsettled(&seen, floor, sizes) };
        if verdict == Verdict::Restart {
            (self.previous, self.worst_rate, self.has_rate) = (None, 0.0, false);
        } else {
            (self.previous, self.previous_reaction) = (Some(new.step), Some(new.reaction_step));
        }
        verdict
    }

    /// Takes note of how much the correction has shrunk.
    fn compare(&mut self, new: Correction, expected: Option<f64>, sizes: &mut impl Sizes) -> Seen {
        let shrunk = |new: f64, previous: Option<f64>| new / previous.unwrap_or(f64::INFINITY);
        let (rate, reaction_rate) = (shrunk(new.step, self.previous), shrunk(new.reaction_step, self.previous_reaction));
        let noted = |rate: f64| if rate < STALLED { rate } else { 0.0 };
        self.worst_rate = self.worst_rate.max(noted(rate));
        self.worst_reaction_rate = self.worst_reaction_rate.max(noted(reaction_rate));
        // of the error that is left; the first correction says nothing about it
        let left = |worst: f64| worst / (1.0 - worst);
        let converges = |rate: f64| rate > 0.0 && rate < STALLED;
        let trusted = if self.has_rate { self.worst_rate } else { self.worst_rate.max(FIRST_RATE) };
        // a matrix from amid a search may be stiff with stresses that the first correction took away: the second one is then too small
        let share = if converges(rate) && !(self.fresh && !self.has_rate && sizes.can_relieve()) {
            left(trusted)
        } else {
            // forces of stiff members are read to their last digits: there the second correction is seen
            expected.filter(|_| !sizes.has_stresses()).map_or(1.0, |rate| rate.max(FIRST_RATE))
        };
        let reaction_share = if converges(reaction_rate) { left(self.worst_reaction_rate) } else { 1.0 };
        self.has_rate |= self.previous.is_some();
        Seen { new, rate, reaction_rate, share, reaction_share, moved: None, is_near: false }
    }

    /// The unknowns are what round-off allows: are their multipliers?
    fn judge_settled(&self, seen: &Seen, reactions_settled: bool) -> Verdict {
        let Seen { new: Correction { reaction_step, reactions, .. }, reaction_rate, .. } = *seen;
        let has_previous = self.previous_reaction.is_some_and(f64::is_finite);
        let stalled = reaction_rate >= STALLED && has_previous;
        if reactions_settled || stalled && (self.fresh || reaction_step <= NEARLY * reactions) {
            let is_aged = !self.fresh && self.worst_rate.max(self.worst_reaction_rate) > AGED;
            return Verdict::Converged(RateEstimate::Rates { is_aged });
        }
        if reaction_rate > SLOW && has_previous { Verdict::NewMatrix } else { Verdict::GoOn }
    }

    fn judge_unsettled(&mut self, seen: &Seen, floor: Floor, sizes: &mut impl Sizes) -> Verdict {
        if seen.rate <= 1.0 {
            self.growth = 0;
        }
        if seen.rate >= STALLED
            && self.previous.is_some()
            && let Some(verdict) = self.judge_stalled(seen, floor, sizes)
        {
            return verdict;
        }
        self.comparable = self.fresh && seen.is_near;
        if seen.rate > SLOW && self.iterations > 1 { Verdict::NewMatrix } else { Verdict::GoOn }
    }

    /// Corrections hardly shrink: round-off, an old matrix, or a search that leads nowhere?
    fn judge_stalled(&mut self, seen: &Seen, floor: Floor, sizes: &mut impl Sizes) -> Option<Verdict> {
        let Seen { new: Correction { step, scale, reaction_step, reactions }, rate, moved, is_near, .. } = *seen;
        // with an old matrix this may be slow convergence: only a fresh one tells round-off from it
        let near = moved.map_or(step <= NEARLY * scale, |moved| moved <= 8.0 * f64::EPSILON);
        if near && (self.fresh || reaction_step <= NEARLY * reactions) {
            return Some(Verdict::Converged(RateEstimate::Nothing));
        }
        if !self.fresh && rate > ASTRAY {
            return Some(Verdict::Restart);
        }
        if self.comparable && is_near && sizes.at_round_off(step, scale) {
            if self.with_matrix > NEW {
                // a new matrix tells
                return Some(Verdict::NewMatrix);
            }
            let corrections = [step, floor.corrections[1].max(reaction_step)];
            return Some(Verdict::Converged(RateEstimate::Floor(Floor { corrections, unknowns: [scale, reactions] })));
        }
        if !(self.fresh && rate > 1.0) {
            return None;
        }
        // in a row: a slender beam that is bent is stretched by it, which the next correction takes back
        self.growth += 1;
        let is_wild = self.growth > MOST_GROWN_STRESSED || rate > WILD;
        if is_wild && sizes.can_relieve() {
            return Some(Verdict::Relieve(step / scale));
        }
        let is_lost = self.growth > MOST_GROWN || step > LOST * scale.max(1.0);
        is_lost.then_some(Verdict::Fail(FailureKind::Diverged, step / scale))
    }
}

impl Seen {
    /// Whether what is left of the unknowns, and of the multipliers, is what round-off allows: by their own sizes, or by the floor, which is
    /// measured anew where it was found in a state unlike this one.
    fn settles(&self, floor: &mut Floor, sizes: &mut impl Sizes) -> [bool; 2] {
        let Seen { new: Correction { step, scale, reaction_step, reactions }, share, reaction_share, .. } = *self;
        let settles = match self.moved {
            Some(moved) => moved * share <= 0.25 * f64::EPSILON,
            None => step * share <= ROUND_OFF * scale,
        } || sizes.is_nothing(step);
        let reactions_settle = reaction_step * reaction_share <= ROUND_OFF * reactions
            || reaction_step <= NOTHING
            || sizes.is_no_reaction(reaction_step, step);
        let by = |Floor { corrections: [floor, reaction_floor], .. }: Floor| {
            let of_reactions = reaction_step * reaction_share <= reaction_floor || reaction_step <= 2.0 * reaction_floor;
            [settles || step * share <= floor || step <= 2.0 * floor, reactions_settle || of_reactions]
        };
        let by_floor = [if settles { 0.0 } else { step }, if reactions_settle { 0.0 } else { reaction_step }];
        if self.is_near && by(*floor)[0] && !floor.speaks_for([scale, reactions], by_floor) {
            *floor = sizes.floor_here();
        }
        by(*floor)
    }
}
