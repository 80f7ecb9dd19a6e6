use super::Counters;
use super::checkpoint::{FactoredAt, KeptFactorization};
use super::failure::{Failure, FailureKind};
use crate::assembly::{Equations, Jacobian, Level, Model, Node, Residual, System, Unknowns, VectorsAvq};
use crate::elements::{FormulaWork, NodeKind, RunScalar};
use crate::linalg::{Backend, Factorization, Singular};
use smallvec::SmallVec;
use std::sync::Arc;

/// When Newton's method is content.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum NewtonTolerance {
    /// Until the error left is below 1e-14 of the unknowns or below what the last bit of the state does to them: exact gradients.
    #[default]
    RoundOff,
    /// Until the residual is below 1e-9 of the first one or below 1e-12, as in Boopathy & Kennedy, or corrections are at round-off.
    Residual,
}

impl NewtonTolerance {
    /// Both rules.
    pub const ALL: [NewtonTolerance; 2] = [NewtonTolerance::RoundOff, NewtonTolerance::Residual];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            NewtonTolerance::RoundOff => "round-off",
            NewtonTolerance::Residual => "residual",
        }
    }
}

/// Most iterations for one system.
const MOST_ITERATIONS: usize = 25;
/// Relative correction at which the unknowns are as good as round-off allows.
pub(super) const ROUND_OFF: f64 = 1e-14;
/// Corrections that shrink less than this ask for a fresh factorization.
const SLOW: f64 = 0.1;
/// A system whose corrections shrank less than this leaves no factorization for the next one: a new one costs as much as five to
/// ten corrections, and serves all systems that follow.
const AGED: f64 = 0.05;
/// Corrections that shrink less than this do not converge any more.
const STALLED: f64 = 0.3;
/// Smallest rate of convergence that two corrections alone can vouch for: the first one takes along what the matrix knows, the second one
/// meets directions in which an older matrix contracts less.
const FIRST_RATE: f64 = 1e-2;
/// Factorizations for which the size of round-off is taken as it was measured once: two evaluations for each kind of system.
const MEASURED_FOR: usize = 10;
/// Corrections with an old matrix that grow more than this lead where a new one finds no way back from: a stiff bar that they bend is
/// stretched by the square of it.
const ASTRAY: f64 = 2.0;
/// Relative correction that is accepted when corrections stall there, whatever the age of the matrix.
const NEARLY: f64 = 1e-13;
/// Corrections of derivative parts that are made before round-off is taken for the reason why they do not end.
const PASSES: usize = 4;
/// Relative correction of derivative parts that may be round-off.
pub(super) const PARTS_LIMIT: f64 = 1e-9;
/// Share of a value, per relative change of a number, that is no derivative but round-off, with [`PARTS_LIMIT`] of it.
const ZERO_SHARE: f64 = 1e-3;
/// What is said of derivative parts that do not converge.
const STAGNATED: &str = "stagnated in the derivative parts";
/// Corrections of derivative parts that shrink less than this do not converge any more.
const SLOW_PARTS: f64 = 0.9;
/// Correction beyond which nothing is round-off, as a displacement by the model's length.
const NEAR: f64 = 1e-6;
/// Coordinates that are smaller than this share of the lengths among the parameters say nothing about the size of the model.
const NEGLIGIBLE: f64 = 1e-9;
/// Displacement in one system beyond which a search is lost, by the model's length.
const LOST: f64 = 1e6;
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
/// Corrections with relieved stresses for one system.
const MOST_RELIEVED: usize = 60;
/// Relative correction up to which a guide counts as the solution of the same problem.
const GUIDED: f64 = 1e-6;

/// Newton's method for the systems of one run, keeping its factorization while it converges fast.
pub struct Newton<'m, S> {
    /// The numbered equations.
    pub system: Arc<System<'m>>,
    /// Evaluations, with their workspace.
    pub residual: Residual<S>,
    /// The matrix.
    pub jacobian: Jacobian,
    /// Work done.
    pub counters: Counters,
    pub(super) factorization: Factorization,
    tolerance: NewtonTolerance,
    pub(super) rhs: Vec<f64>,
    /// Right-hand side before an estimate.
    exact: Vec<f64>,
    /// Parameters without derivative parts, and time \[s\], of what was factored last.
    pub(super) p: Vec<f64>,
    pub(super) t: f64,
    /// Unknowns from which a search with an old matrix started.
    guess: Unknowns<S>,
    /// Equations for which the matrix was factored last.
    factored: Option<Equations>,
    /// Where it was.
    factored_at: FactoredAt<S>,
    /// Size of corrections at round-off: of metrics (projections of coordinates, then of velocities) and of other systems.
    floors: [Option<[f64; 2]>; 3],
    /// Equations for which floors were measured, and factorizations since then.
    measured: Option<Equations>,
    measured_for: usize,
    /// Solution at the start of an estimate.
    work: Unknowns<S>,
    /// State and row of a look at redundant equations.
    state: VectorsAvq<S>,
    row: Vec<f64>,
    formula_work: FormulaWork<f64>,
    /// Whether any constraint restricts velocities only.
    nonholonomic: bool,
    /// Whether elements have stresses that a search can relieve; looked up when a search first fails.
    relievable: Option<bool>,
    /// Coordinates from which the searches of a step set out: stresses there are trusted.
    pub(super) trusted: Vec<f64>,
    /// Length of the model by which displacements are judged.
    pub(super) length: f64,
    /// Largest parameter that is a length, once a search has asked for it.
    parameter_length: Option<f64>,
    /// Lever by which each coordinate is measured: 1 for lengths, a length of the model for Euler parameters.
    pub(super) coordinate_scales: Vec<f64>,
}

impl<'m, S: RunScalar> Newton<'m, S> {
    /// Workspace for a system.
    ///
    /// # Errors
    /// A pattern that no numbers could make regular.
    pub fn new(system: Arc<System<'m>>, tolerance: NewtonTolerance, backend: Backend) -> Result<Self, Singular> {
        let factorization = Factorization::new(&system.pattern, backend)?;
        Ok(Newton {
            residual: Residual::new(&system),
            jacobian: Jacobian::new(&system),
            rhs: vec![0.0; system.size()],
            exact: vec![0.0; system.size()],
            p: Vec::new(),
            t: 0.0,
            guess: Unknowns::default(),
            counters: Counters::default(),
            factored: None,
            coordinate_scales: vec![1.0; system.model.dofs],
            nonholonomic: system.model.constraints.iter().any(|joint| joint.physics.is_nonholonomic()),
            relievable: None,
            trusted: Vec::new(),
            length: 1.0,
            parameter_length: None,
            factored_at: FactoredAt::default(),
            floors: [None; 3],
            measured: None,
            measured_for: 0,
            work: Unknowns::default(),
            state: VectorsAvq::default(),
            row: Vec::new(),
            formula_work: FormulaWork::default(),
            system,
            factorization,
            tolerance,
        })
    }

    /// Solves for `unknowns`, starting from what they hold.
    ///
    /// # Errors
    /// A `Failure`, to be described by [`Newton::describe`].
    pub fn solve(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        let solved = self.search(equations, base, unknowns, p, t);
        solved.inspect_err(|_| self.keep_numbers(p, t))
    }

    /// What a failure is described with.
    fn keep_numbers(&mut self, p: &[S], t: f64) {
        self.p.clear();
        self.p.extend(p.iter().map(|p| p.value()));
        self.t = t;
    }

    fn search(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        self.counters.systems += 1;
        self.residual.start(&self.system, equations, base, p, t);
        self.set_coordinate_scales(base, p);
        // a matrix for other coefficients converges slowly or not at all
        if self.factored.is_none_or(|old| !self.resembles(&old, equations)) {
            self.factored = None;
        }
        self.guess.clone_from(unknowns);
        let searched = if equations.is_static() {
            self.solve_balanced(equations, base, unknowns, p, t)
        } else {
            self.solve_value(equations, base, unknowns, p, t)
        };
        if let Err(failure) = searched {
            if !self.can_relieve(equations) {
                return Err(failure);
            }
            unknowns.clone_from(&self.guess);
            self.approach_relieved(equations, base, unknowns, p, t)?;
            self.solve_balanced(equations, base, unknowns, p, t)?;
        }
        self.residual.restore(&self.system, equations, base, unknowns);
        if S::PARTS > 0 {
            self.solve_parts(equations, base, unknowns, p, t)?;
        }
        Ok(())
    }

    /// Solves for the derivative parts alone, the values being a solution already (that of a real run).
    ///
    /// # Errors
    /// A `Failure` if the values are far from a solution: the guide belongs to another problem.
    pub fn solve_guided(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        self.counters.systems += 1;
        self.residual.start(&self.system, equations, base, p, t);
        self.set_coordinate_scales(base, p);
        self.residual.keep_values = true;
        self.solve_parts(equations, base, unknowns, p, t)?;
        let scale = self.size(&unknowns.x).max(f64::MIN_POSITIVE);
        let correction = self.step(None, &mut unknowns.clone());
        let near = match self.projected_size(equations, base) {
            Some((unit, size)) => unit * correction <= GUIDED * size,
            None => correction <= GUIDED * scale,
        };
        // where nothing moves yet there is no size to compare with
        if near || self.at_round_off(equations, unknowns, p, t, correction, scale) {
            return Ok(());
        }
        Err(Failure { how: FailureKind::Stagnated, iterations: 0, correction: correction / scale })
    }

    /// Sets the scales of coordinates from the largest coordinate of a point in the model: sizes then do not depend on the unit of length.
    pub(super) fn set_coordinate_scales(&mut self, base: &VectorsAvq<S>, p: &[S]) {
        let nodes = &self.system.model.nodes;
        let lengths = nodes.iter().filter(|node| node.kind != NodeKind::Coordinates(node.dofs.len()));
        let largest = lengths
            .flat_map(|node| &base.q[node.dofs.start..node.dofs.start + 3])
            .fold(0.0, |largest: f64, q| largest.max(q.value().abs()));
        // a body whose frame stays at the origin has its length among the parameters
        let own = *self.parameter_length.get_or_insert_with(|| parameter_length(self.system.model, p));
        let length = match own.max(largest) {
            0.0 => 1.0,
            _ if largest > NEGLIGIBLE * own => largest,
            _ => own,
        };
        let turning = |node: &&Node| matches!(node.kind, NodeKind::Body | NodeKind::Natural | NodeKind::Slope);
        for node in nodes.iter().filter(turning) {
            self.coordinate_scales[node.dofs.start + 3..node.dofs.end].fill(length);
        }
        self.length = self.size(&base.q).max(length);
    }

    /// A correction of the unknowns as a displacement, by the model's length; 0 where coordinates are given.
    fn displacement(&self, equations: &Equations, step: f64) -> f64 {
        step * equations.residual.alpha.abs().max(equations.constraint.alpha.abs()) / self.length
    }

    /// Whether stresses can be kept apart from displacements in a search for these unknowns.
    fn can_relieve(&mut self, equations: &Equations) -> bool {
        let displaces = equations.residual.alpha != 0.0 && !equations.metric && equations.variational.is_none();
        displaces && *self.relievable.get_or_insert_with(|| Jacobian::can_relieve(&self.system))
    }

    /// Comes near to a solution with stresses that follow the strains only as far as each correction foresees it
    /// ([`Jacobian::relieve`]): from coordinates whose stresses are trusted.
    fn approach_relieved(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        let mut before = std::mem::take(&mut self.trusted);
        let trusted = before.clone();
        let mut previous = f64::INFINITY;
        // at first stresses are those at the place that is trusted
        let mut change = vec![0.0; self.system.model.dofs];
        let mut approach = || {
            for iteration in 1..=MOST_RELIEVED {
                let fail = |how, correction| Err(Failure { how, iterations: iteration, correction });
                self.factored = None;
                self.evaluate(equations, base, unknowns, p, t);
                let size = self.residual_size();
                if !size.is_finite() {
                    return fail(FailureKind::NotFinite, size);
                }
                let values = |list: &[S]| list.iter().map(|x| x.value()).collect::<Vec<_>>();
                let after = values(&self.residual.at.q);
                if before.len() != after.len() {
                    before.clone_from(&after);
                }
                self.jacobian.relieve(&self.system, &self.residual, [&before, &change], &values(p), t);
                let factored = self.factorize(equations, unknowns, p, t);
                factored.or_else(|singular| fail(FailureKind::Singular(singular.unknown), f64::NAN))?;
                before = after;
                self.counters.iterations += 1;
                let alpha = equations.residual.alpha;
                change.iter_mut().zip(&unknowns.x).for_each(|(change, x)| *change = -alpha * x.value());
                let step = self.step(None, unknowns);
                change.iter_mut().zip(&unknowns.x).for_each(|(change, x)| *change += alpha * x.value());
                if !(step.is_finite() && self.displacement(equations, step) <= LOST) {
                    return fail(FailureKind::Diverged, step);
                }
                if self.displacement(equations, step) <= NEAR {
                    return Ok(());
                }
                previous = step;
            }
            Err(Failure { how: FailureKind::Stagnated, iterations: MOST_RELIEVED, correction: previous })
        };
        let result = approach();
        self.trusted = trusted;
        self.jacobian.end_relief();
        self.factored = None;
        result
    }

    /// Solves, and asks the matrix at the unknowns that were accepted what it would still correct: at most [`BALANCED`] of the model's
    /// length, or round-off there.
    fn solve_balanced(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        let mut left = f64::NAN;
        for _ in 0..MOST_SEARCHES {
            self.solve_value(equations, base, unknowns, p, t)?;
            self.factored = None;
            self.evaluate(equations, base, unknowns, p, t);
            self.factorize(equations, unknowns, p, t).map_err(|singular| Failure {
                how: FailureKind::Singular(singular.unknown),
                iterations: 0,
                correction: f64::NAN,
            })?;
            let floors = self.round_off(equations, base, unknowns, p, t);
            self.floors[kind(equations)] = Some(floors);
            self.rhs.copy_from_slice(&self.exact);
            self.factorization.solve(&mut self.rhs);
            self.counters.solves += 1;
            self.work.clone_from(unknowns);
            let step = self.jacobian.add_step(&self.system, &self.rhs, None, &mut self.work, &self.coordinate_scales);
            left = self.displacement(equations, step);
            let round_off = self.displacement(equations, floors[0]);
            if left <= BALANCED.max(4.0 * round_off) && round_off <= NEAR {
                return Ok(());
            }
        }
        Err(Failure { how: FailureKind::Unbalanced, iterations: MOST_SEARCHES, correction: left })
    }

    /// Largest number of a list of all coordinates, each scaled.
    pub(super) fn size(&self, values: &[S]) -> f64 {
        values.iter().zip(&self.coordinate_scales).fold(0.0, |s: f64, (x, scale)| s.max(x.value().abs() * scale))
    }

    fn solve_value(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        let fail = |how, iterations, correction| Err(Failure { how, iterations, correction });
        let mut previous = f64::INFINITY;
        let mut fresh = false;
        // the last correction, where it was one of a matrix of this search and small enough that the next one is of the same
        let mut comparable = false;
        let mut first_residual = None;
        let mut growth = 0;
        let (mut worst_rate, mut is_first_rate) = (0.0_f64, true);
        let (mut previous_reaction, mut worst_reaction_rate) = (f64::INFINITY, 0.0_f64);
        for iteration in 1..=MOST_ITERATIONS {
            self.evaluate(equations, base, unknowns, p, t);
            let size = self.residual_size();
            if !size.is_finite() {
                return fail(FailureKind::NotFinite, iteration, size);
            }
            if self.tolerance == NewtonTolerance::Residual {
                let first = *first_residual.get_or_insert(size);
                if size <= 1e-12 || size <= 1e-9 * first {
                    return Ok(());
                }
            }
            if self.factored.is_none() {
                self.factorize(equations, unknowns, p, t).map_err(|singular| Failure {
                    how: FailureKind::Singular(singular.unknown),
                    iterations: iteration,
                    correction: f64::NAN,
                })?;
                fresh = true;
            }
            let kind = kind(equations);
            self.counters.iterations += 1;
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
            // far from a solution, the last bits of large stresses would pass for those of the solution
            let is_near = self.displacement(equations, step) <= NEAR;
            let [floor, reaction_floor] = match self.floors[kind] {
                Some(floors) if is_near => floors,
                None if is_near => {
                    self.evaluate(equations, base, unknowns, p, t);
                    let floors = self.round_off(equations, base, unknowns, p, t);
                    *self.floors[kind].insert(floors)
                }
                _ => [0.0; 2],
            };
            let reactions_settled = reaction_step * reaction_share <= (ROUND_OFF * reactions).max(reaction_floor)
                || reaction_step <= 2.0 * reaction_floor;
            let rate = step / previous;
            if rate < STALLED {
                worst_rate = worst_rate.max(rate);
            }
            // of the error that is left; the first correction says nothing about it
            let trusted = if is_first_rate { worst_rate.max(FIRST_RATE) } else { worst_rate };
            // a matrix from amid a search may be stiff with stresses that the first correction took away: the second one is then too small
            let is_vouched_for = !(fresh && is_first_rate && self.can_relieve(equations));
            is_first_rate &= previous.is_infinite();
            let share = if rate > 0.0 && rate < STALLED && is_vouched_for { trusted / (1.0 - trusted) } else { 1.0 };
            // a projection is as good as its correction of the state is small against the state
            let moved = self.projected_size(equations, base).map(|(unit, size)| unit * step / size);
            let settled = match moved {
                Some(moved) => moved * share <= 0.25 * f64::EPSILON,
                None => step * share <= ROUND_OFF * scale,
            };
            if step == 0.0 || settled || step * share <= floor || step <= 2.0 * floor {
                let stalled = reaction_rate >= STALLED && previous_reaction.is_finite();
                if reactions_settled || (stalled && (fresh || reaction_step <= NEARLY * reactions)) {
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
                if comparable && is_near && self.at_round_off(equations, unknowns, p, t, step, scale) {
                    self.floors[kind] = Some([step, reaction_floor.max(reaction_step)]);
                    return Ok(());
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

    /// Largest multiplier, forces and moments alike in the scale of the factored matrix, which no unit changes.
    fn multiplier_size(&self, unknowns: &Unknowns<S>) -> f64 {
        let sets = [(self.system.multiplier_places(), &unknowns.mu), (self.system.stabilizer_places(), &unknowns.eta)];
        let all = sets.into_iter().flat_map(|(places, values)| places.iter().zip(values));
        let sizes = all.filter_map(|(place, value)| Some(self.factorization.scaled((*place)?, value.value()).abs()));
        sizes.fold(0.0, f64::max)
    }

    /// Largest correction of a multiplier in the last solution, in the same scale.
    fn multiplier_step(&self) -> f64 {
        let places = self.system.multiplier_places().iter().chain(self.system.stabilizer_places()).flatten();
        places.fold(0.0, |largest: f64, &place| largest.max(self.factorization.scaled(place, self.rhs[place]).abs()))
    }

    /// Sizes of a correction of coordinates and of multipliers that are round-off alone: what the last bits of (a, v, q) change in the
    /// residual, through the matrix.
    fn round_off(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> [f64; 2] {
        self.jacobian.reduce(&self.system, &self.residual, None, &mut self.exact);
        self.residual.last_bits = true;
        self.evaluate(equations, base, unknowns, p, t);
        self.residual.last_bits = false;
        self.jacobian.reduce(&self.system, &self.residual, None, &mut self.rhs);
        self.rhs.iter_mut().zip(&self.exact).for_each(|(other, exact)| *other -= exact);
        self.factorization.solve(&mut self.rhs);
        self.counters.solves += 1;
        self.work.clone_from(unknowns);
        let step = self.jacobian.add_step(&self.system, &self.rhs, None, &mut self.work, &self.coordinate_scales);
        [step, self.multiplier_step()]
    }

    /// Corrections no longer shrink: is that round-off, or a system that does not converge?
    fn at_round_off(
        &mut self,
        equations: &Equations,
        unknowns: &Unknowns<S>,
        p: &[S],
        t: f64,
        step: f64,
        scale: f64,
    ) -> bool {
        if step <= 1e-10 * scale {
            return true;
        }
        let force = self.residual.f.iter().fold(0.0, |s: f64, f| s.max(f.value().abs()));
        let length = self.residual.constraint_at.q.iter().fold(0.0, |s: f64, q| s.max(q.value().abs()));
        let gap = match equations.level {
            Level::Position | Level::Stabilized => equations.constraint.alpha,
            Level::Velocity | Level::Acceleration => 0.0,
        };
        let largest_gap = self.residual.g.iter().fold(0.0, |s: f64, g| s.max(g.value().abs())) * gap;
        let small_force = force <= self.residual.force_floor(&self.system, unknowns, p, t);
        let small_gap = largest_gap <= 1e-12 * length.max(f64::MIN_POSITIVE);
        small_force && small_gap
    }

    /// With the value converged, the derivative parts solve one linear system each: factored there, they are exact.
    fn solve_parts(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        self.evaluate(equations, base, unknowns, p, t);
        self.factorize(equations, unknowns, p, t).map_err(|s| Failure {
            how: FailureKind::Singular(s.unknown),
            iterations: 0,
            correction: f64::NAN,
        })?;
        self.refine_parts(equations, base, unknowns, p, t)
    }

    /// Corrects the derivative parts with the factored matrix until they are round-off.
    ///
    /// # Errors
    /// [`Failure`] with parts that are not finite, or whose corrections stop shrinking above [`PARTS_LIMIT`].
    fn refine_parts(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        let mut previous = f64::INFINITY;
        for pass in 1..=MOST_ITERATIONS {
            if pass > 1 {
                self.evaluate(equations, base, unknowns, p, t);
            }
            let (mut largest, mut beyond) = (0.0_f64, 0.0_f64);
            for part in 0..S::PARTS {
                let step = self.step(Some(part), unknowns);
                let twice = self.coordinate_scales.iter().chain(&self.coordinate_scales);
                let parts = unknowns.x.iter().chain(&unknowns.y).zip(twice);
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
                if pass >= PASSES && scale > 0.0 && step > ROUND_OFF * scale {
                    beyond = beyond.max(step / self.size_of_part(part, equations, base, unknowns, p));
                }
            }
            if pass > 1 && largest <= ROUND_OFF || pass >= PASSES && beyond <= PARTS_LIMIT {
                return Ok(());
            }
            if pass >= PASSES && beyond > SLOW_PARTS * previous {
                return Err(Failure { how: FailureKind::Parts(STAGNATED), iterations: pass, correction: beyond });
            }
            previous = if pass >= PASSES { beyond } else { f64::INFINITY };
        }
        Err(Failure { how: FailureKind::Parts(STAGNATED), iterations: MOST_ITERATIONS, correction: previous })
    }

    /// What a correction of derivative part `part` is measured by: the unknowns' parts and those of the coordinates and velocities that
    /// they move; where all of these vanish but for round-off, a small share of the values, per relative change of the numbers.
    fn size_of_part(
        &self,
        part: usize,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &Unknowns<S>,
        p: &[S],
    ) -> f64 {
        let coefficients = equations.residual;
        let size = |read: &dyn Fn(&S) -> f64| {
            let of = |values: &[S]| {
                values.iter().zip(&self.coordinate_scales).fold(0.0, |s: f64, (x, scale)| s.max(read(x).abs() * scale))
            };
            let moved = |values: &[S], by: f64| if by == 0.0 { 0.0 } else { of(values) / by.abs() };
            let own = of(&unknowns.x).max(of(&unknowns.y));
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

    /// For a projection: the factor from its unknowns to the projected state, and the size of that state.
    fn projected_size(&self, equations: &Equations, base: &VectorsAvq<S>) -> Option<(f64, f64)> {
        let largest = |values: &[S]| self.size(values).max(f64::MIN_POSITIVE);
        match equations.level {
            Level::Position if equations.metric => Some((equations.constraint.alpha, largest(&base.q))),
            Level::Velocity if equations.metric => Some((equations.constraint.beta, largest(&base.v))),
            _ => None,
        }
    }

    pub(super) fn evaluate(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) {
        self.counters.residuals += 1;
        // a factorization follows
        if self.factored.is_none() && S::PARTS == 0 {
            self.factored_at.t = t;
            self.factored_at.base.clone_from(base);
            self.factored_at.unknowns.clone_from(unknowns);
        }
        self.residual.evaluate(&self.system, equations, base, unknowns, p, t);
    }

    /// What later systems depend on beside their own numbers.
    pub(super) fn keep_in(&self, kept: &mut KeptFactorization<S>) {
        kept.factored = self.factored;
        if self.factored.is_some() {
            kept.at.clone_from(&self.factored_at);
        } else {
            kept.at.clear();
        }
        (kept.floors, kept.measured, kept.measured_for) = (self.floors, self.measured, self.measured_for);
    }

    /// Goes on as after the systems that left `kept`; the matrix is factored where it was then.
    pub(super) fn resume(&mut self, kept: &KeptFactorization<S>, p: &[S]) -> Result<(), Singular> {
        self.factored = None;
        let FactoredAt { t, base, unknowns } = &kept.at;
        if let Some(equations) = &kept.factored {
            self.residual.start(&self.system, equations, base, p, *t);
            let mut unknowns = unknowns.clone();
            self.evaluate(equations, base, &mut unknowns, p, *t);
            self.factorize(equations, &unknowns, p, *t)?;
        }
        (self.floors, self.measured, self.measured_for) = (kept.floors, kept.measured, kept.measured_for);
        Ok(())
    }

    pub(super) fn factorize(
        &mut self,
        equations: &Equations,
        unknowns: &Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Singular> {
        self.counters.factorizations += 1;
        let before = self.jacobian.evaluated;
        self.keep_numbers(p, t);
        self.jacobian.assemble(&self.system, equations, &self.residual, unknowns, &self.p, t);
        self.counters.blocks += self.jacobian.evaluated - before;
        self.factorization.factor(&self.jacobian.values)?;
        let resembles_last = self.measured.is_some_and(|old| self.resembles(&old, equations));
        self.measured_for += 1;
        if !resembles_last || self.measured_for > MEASURED_FOR {
            (self.measured, self.measured_for, self.floors) = (Some(*equations), 0, [None; 3]);
        }
        self.factored = Some(*equations);
        Ok(())
    }

    fn step(&mut self, part: Option<usize>, unknowns: &mut Unknowns<S>) -> f64 {
        self.counters.solves += 1;
        self.jacobian.reduce(&self.system, &self.residual, part, &mut self.rhs);
        self.factorization.solve(&mut self.rhs);
        self.jacobian.add_step(&self.system, &self.rhs, part, unknowns, &self.coordinate_scales)
    }

    /// True if a matrix factored for one kind of equations serves the other: same coefficients of inertia, damping and stiffness. Stages
    /// at acceleration level and projections differ by the change of A within a step and by the curvature of the reactions; projections
    /// of coordinates alone are without nonholonomic constraints.
    fn resembles(&self, old: &Equations, new: &Equations) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
        let rows = |e: &Equations| if e.metric { Level::Acceleration } else { e.level };
        let (own, other) = (old.residual, new.residual);
        let same = near(own.gamma, other.gamma) && near(own.beta, other.beta) && near(own.alpha, other.alpha);
        let free = |e: &Equations| self.nonholonomic && e.nonholonomic(false).is_none();
        rows(old) == rows(new) && same && free(old) == free(new) && old.variational.is_some() == new.variational.is_some()
    }

    /// Factors the matrix of accelerations at a state: rows A of the kept constraint equations beside inertia.
    pub(super) fn factor_accelerations(&mut self, (q, v): (&[S], &[S]), p: &[S], t: f64) -> Result<(), Singular> {
        let equations = Equations::acceleration();
        let (mut base, mut unknowns) = (std::mem::take(&mut self.state), std::mem::take(&mut self.guess));
        base.a.clear();
        base.a.resize(q.len(), S::zero());
        base.v.clear();
        base.v.extend_from_slice(v);
        base.q.clear();
        base.q.extend_from_slice(q);
        Residual::shape(&self.system, &mut unknowns, true);
        self.residual.start(&self.system, &equations, &base, p, t);
        self.factored = None;
        self.evaluate(&equations, &base, &mut unknowns, p, t);
        let factored = self.factorize(&equations, &unknowns, p, t);
        (self.state, self.guess) = (base, unknowns);
        factored
    }

    /// The kept constraint equation with the largest coefficient c in a_d = sum c_i a_i, where a_d is the row of a dropped one, and
    /// that coefficient: after [`Newton::factor_accelerations`].
    ///
    /// From M y + A^T c = a_d, A y = 0, where y = 0 because a_d depends on A.
    pub(super) fn largest_coefficient(&mut self, dropped: usize, q: &[S], p: &[S], t: f64) -> Option<(usize, f64)> {
        let model = self.system.model;
        let joint = model.constraints.iter().find(|joint| joint.equations.contains(&dropped))?;
        type Few = SmallVec<[f64; 32]>;
        let dofs = || joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone());
        let own: Few = dofs().map(|dof| q[dof].value()).collect();
        let numbers: Few = p[joint.parameters.clone()].iter().map(|p| p.value()).collect();
        let mut unit = Few::from_elem(0.0, joint.equations.len());
        unit[dropped - joint.equations.start] = 1.0;
        let row = joint.physics.reaction_in((&own, &numbers, t), &unit, &mut self.formula_work);
        self.row.clear();
        self.row.resize(model.dofs, 0.0);
        dofs().zip(row).for_each(|(dof, &entry)| self.row[dof] = entry);
        self.rhs.fill(0.0);
        self.jacobian.restrict_right(&self.system, &self.row, &[], &mut self.rhs);
        self.factorization.solve_transposed(&mut self.rhs);
        let kept = self.system.multiplier_places().iter().enumerate();
        let sizes = || kept.clone().filter_map(|(equation, place)| Some((equation, self.rhs[(*place)?].abs())));
        let largest = sizes().fold(0.0, |largest: f64, (_, size)| largest.max(size));
        // of equal ones, as symmetric loops have them, the first, whatever their last bits
        sizes().find(|(_, size)| *size >= 0.999 * largest)
    }

    fn residual_size(&self) -> f64 {
        let Residual { f, y, g, g_second, .. } = &self.residual;
        let mut size = 0.0_f64;
        for list in [f, y, g, g_second] {
            for own in list.iter().map(|f| f.value().abs()) {
                // max() of floats would lose a NaN
                size = if own <= size || size.is_nan() { size } else { own };
            }
        }
        size
    }
}

/// The largest of the parameters in metres: places of joints and masses, lengths.
fn parameter_length<S: RunScalar>(model: &Model, p: &[S]) -> f64 {
    let elements = model.elements.iter().map(|element| (element.physics.parameter_list(), &element.parameters));
    let joints = model.constraints.iter().map(|joint| (joint.physics.parameter_list(), &joint.parameters));
    let lengths = elements.chain(joints).flat_map(|(list, places)| {
        let places = places.clone().zip(list);
        places.filter(|(_, parameter)| parameter.unit == "m").map(|(place, _)| p[place].value().abs())
    });
    lengths.fold(0.0, f64::max)
}

/// Which of the three kinds of systems that share a matrix it is.
fn kind(equations: &Equations) -> usize {
    match (equations.metric, equations.level) {
        (true, Level::Position) => 0,
        (true, _) => 1,
        (false, _) => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ConstraintLevel, Method, Systems, table_by_name};
    use super::*;
    use crate::assembly::Model;
    use crate::elements::{Element, Parameter, State};
    use crate::scalar::{COMPLEX_STEP, Complex64, Scalar};

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
        model.add_element("push", &[node], Box::new(PushedMass));
        let method = Method::new(table_by_name("bdf2").ok_or("not listed")?, ConstraintLevel::default());
        let system = Systems::new(&model, &method, &[]).plain;
        let mut newton = Newton::<Complex64>::new(system, NewtonTolerance::default(), Backend::default())
            .map_err(|_| "a singular pattern".to_string())?;
        let equations = Equations::acceleration();
        let zero = || vec![Complex64::new(0.0, 0.0)];
        let base = VectorsAvq { a: zero(), v: zero(), q: zero() };
        let p = [Complex64::new(2.0, 0.0), Complex64::new(6.0, force_part * COMPLEX_STEP)];
        let others = [Complex64::new(factored_for, 0.0), p[1]];
        let mut unknowns = Unknowns::default();
        Residual::shape(&newton.system, &mut unknowns, true);
        newton.residual.start(&newton.system, &equations, &base, &others, 0.0);
        newton.evaluate(&equations, &base, &mut unknowns, &others, 0.0);
        newton.factorize(&equations, &unknowns, &others, 0.0).map_err(|_| "a singular matrix".to_string())?;
        newton.residual.start(&newton.system, &equations, &base, &p, 0.0);
        unknowns.x[0].re = 3.0;
        newton.evaluate(&equations, &base, &mut unknowns, &p, 0.0);
        let refined = newton.refine_parts(&equations, &base, &mut unknowns, &p, 0.0);
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
