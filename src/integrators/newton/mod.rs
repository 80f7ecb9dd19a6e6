//! Newton's method for the nonlinear systems of a run, whose values and derivative parts it takes to round-off.

mod accelerations;
mod contraction;
mod convergence;
mod damped;
mod derivative_parts;
mod failure;
mod kept;
mod linearized;
mod relieved;
mod renewal;
mod round_off;
mod run_sizes;
mod sizes;
mod values;

pub use contraction::{Contraction, Contractions};
pub use failure::{Failure, NOT_HELD};
pub use kept::{FactoredAt, KeptFactorization};
pub use renewal::Renewal;
pub use round_off::Floor;
pub(crate) use round_off::kind;
pub(crate) use sizes::coordinate_scales;

use super::Counters;
use super::counters::Phase;
use crate::assembly::{Equations, Jacobian, Level, Residual, StageSystem, System, Unknowns, VectorsAvq};
use crate::elements::{FormulaWork, RunScalar};
use crate::linalg::{Backend, Factorization, Singular};
use run_sizes::RunSizes;
use std::sync::Arc;

/// When Newton's method is content.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum NewtonTolerance {
    /// Until the error left is below 1e-14 of the unknowns or below what the last bit of the state does to them: exact gradients.
    #[default]
    RoundOff,
    /// Until the residual is below 1e-9 of the first one or below 1e-12, as in Boopathy & Kennedy, or corrections are at round-off.
    Residual,
    /// Until the error left is below a hundredth of the estimated error of the step before, at round-off where there is none, and for
    /// equilibria: for motions that nobody differentiates.
    Scaled,
}

impl NewtonTolerance {
    /// All rules.
    pub const ALL: [NewtonTolerance; 3] = [NewtonTolerance::RoundOff, NewtonTolerance::Residual, NewtonTolerance::Scaled];

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            NewtonTolerance::RoundOff => "round-off",
            NewtonTolerance::Residual => "residual",
            NewtonTolerance::Scaled => "scaled",
        }
    }
}

const MOST_ITERATIONS: usize = 25;
/// Factorizations for which the size of round-off is taken as it was measured once: two evaluations for each kind of system.
const MEASURED_FOR: usize = 10;

/// Newton's method for the systems of one run, keeping its factorization while it converges fast.
pub struct Newton<'m, S> {
    pub system: Arc<System<'m>>,
    pub residual: Residual<S>,
    pub jacobian: Jacobian,
    pub counters: Counters,
    pub(super) factorization: Factorization,
    tolerance: NewtonTolerance,
    /// What searches may leave in coordinates \[m\], velocities \[m/s\], and projected coordinates \[m\], where round-off is not asked for.
    pub(in crate::integrators) allowed: Option<[f64; 3]>,
    pub(super) rhs: Vec<f64>,
    /// Right-hand side before an estimate.
    exact: Vec<f64>,
    /// Parameters without derivative parts, and time \[s\], of what was factored last.
    pub(super) p: Vec<f64>,
    pub(super) t: f64,
    /// Unknowns from which a search with an old matrix started.
    guess: Unknowns<S>,
    kept: KeptFactorization<S>,
    work: Unknowns<S>,
    /// State and row of a look at redundant equations.
    state: VectorsAvq<S>,
    row: Vec<f64>,
    formula_work: FormulaWork<f64>,
    /// Whether the matrix of stages is the same in all states; looked up when a step begins with one.
    is_constant: Option<bool>,
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
    /// The lever of the latter that stands there.
    pub(super) turning_length: f64,
    /// What has moved so far in a run with derivative parts.
    pub(in crate::integrators) run_sizes: RunSizes,
    /// Whether ranks that share a system share its matrix, too, of which none has all then, unless its stability is asked for.
    divides: bool,
}

/// Entries of L and U above which what is needed once is not kept: a few megabytes.
const LARGE_FILL: usize = 1_000_000;

impl<'m, S: RunScalar> Newton<'m, S> {
    pub fn new(system: Arc<System<'m>>, tolerance: NewtonTolerance, backend: Backend) -> Result<Self, Singular> {
        let factorization = Factorization::new(&system.pattern, backend)?;
        Ok(Self::of(system, tolerance, factorization))
    }

    /// Another one for the same system, whose pattern is analysed already.
    pub fn clone_analysis(&self) -> Result<Self, Singular> {
        let clone = Self::of(self.system.clone(), self.tolerance, self.factorization.clone_analysis()?);
        Ok(Newton { divides: self.divides, ..clone })
    }

    /// The same for systems whose matrix nobody looks at as a whole, but for [`Newton::stability`].
    pub(in crate::integrators) fn divided(self) -> Self {
        Newton { divides: true, ..self }
    }

    /// Gives all memory of a large system back: the next search finds what it sets itself and takes new memory; counts, measured round-off and
    /// rates stay.
    pub fn release(&mut self) -> Result<(), Singular> {
        if self.factorization.plan().work.is_some_and(|work| work.fill > LARGE_FILL) {
            let emptied = self.clone_analysis()?;
            let kept = KeptFactorization { factored: None, at: FactoredAt::default(), ..std::mem::take(&mut self.kept) };
            let Newton { counters, parameter_length, .. } = *self;
            *self = Newton { counters, kept, parameter_length, ..emptied };
        }
        Ok(())
    }

    fn of(system: Arc<System<'m>>, tolerance: NewtonTolerance, factorization: Factorization) -> Self {
        Newton {
            residual: Residual::shared(),
            jacobian: Jacobian::default(),
            rhs: Vec::new(),
            exact: Vec::new(),
            p: Vec::new(),
            t: 0.0,
            guess: Unknowns::default(),
            counters: Counters::default(),
            kept: KeptFactorization::default(),
            coordinate_scales: vec![1.0; system.model.dofs],
            turning_length: 1.0,
            run_sizes: RunSizes::default(),
            divides: false,
            nonholonomic: system.model.constraints.iter().any(|joint| joint.physics.is_nonholonomic()),
            is_constant: None,
            allowed: None,
            relievable: None,
            trusted: Vec::new(),
            length: 1.0,
            parameter_length: None,
            work: Unknowns::default(),
            state: VectorsAvq::default(),
            row: Vec::new(),
            formula_work: FormulaWork::default(),
            system,
            factorization,
            tolerance,
        }
    }

    /// Another step of a motion begins, with a stage of these equations: with a new matrix, where that is cheaper.
    pub(in crate::integrators) fn begin_step(&mut self, equations: &Equations) {
        // a matrix that never changes is new at all times
        let Newton { system, is_constant, .. } = &mut *self;
        let is_constant = *is_constant.get_or_insert_with(|| Jacobian::is_constant(system, equations));
        if !is_constant && self.kept.renewal.begin_step() {
            self.kept.factored = None;
        }
    }

    /// Solves for `unknowns`, starting from what they hold.
    pub fn solve(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let solved = self.search(stage, unknowns);
        solved.inspect_err(|_| self.keep_numbers(stage.p, stage.t))
    }

    fn search(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        let (equations, before) = (stage.equations, self.counters);
        self.counters.systems += 1;
        self.residual.start(&self.system, stage);
        self.set_coordinate_scales(stage.base, stage.p);
        // a matrix for other coefficients converges slowly or not at all
        if self.kept.factored.is_none_or(|old| !self.resembles(&old, equations)) {
            self.kept.factored = None;
        }
        self.guess.clone_from(unknowns);
        let searched =
            if equations.is_static() { self.solve_balanced(stage, unknowns) } else { self.solve_value(stage, unknowns) };
        self.kept.contractions.age += 1;
        self.kept.renewal.note(&before, &self.counters);
        if let Err(failure) = searched {
            let turns = !equations.metric && self.system.model.frictions.iter().any(|own| own.kept.len() == 2);
            unknowns.clone_from(&self.guess);
            if turns && self.approach_damped(stage, unknowns).is_ok() && self.solve_value(stage, unknowns).is_ok() {
                return self.restored(stage, unknowns);
            }
            if !self.can_relieve(equations) {
                return Err(failure);
            }
            unknowns.clone_from(&self.guess);
            if self.solve_relieved(stage, unknowns).is_err() {
                // the acceleration of what is light and stiff foretells nothing over a whole step
                self.begin_where_trusted(stage);
                unknowns.clone_from(&self.guess);
                self.solve_relieved(stage, unknowns).map_err(|_| failure)?;
            }
        }
        self.restored(stage, unknowns)
    }

    fn restored(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        self.residual.restore(&self.system, stage, unknowns);
        if S::PARTS > 0 {
            self.solve_parts(stage, unknowns)?;
        }
        Ok(())
    }

    fn solve_relieved(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Result<(), Failure> {
        self.approach_relieved(stage, unknowns)?;
        self.solve_balanced(stage, unknowns)
    }

    /// Lets the first guess leave coordinates where the step begins, whatever accelerations are known of earlier stages.
    fn begin_where_trusted(&mut self, StageSystem { equations, base, .. }: StageSystem<S>) {
        if self.trusted.len() != self.guess.x.len() {
            return;
        }
        let places = self.trusted.iter().zip(&base.q);
        for (x, (&from, &q)) in self.guess.x.iter_mut().zip(places) {
            *x = (S::from(from) - q) * (1.0 / equations.residual.alpha);
        }
    }

    fn keep_numbers(&mut self, p: &[S], t: f64) {
        self.p.clear();
        self.p.extend(p.iter().map(|p| p.value()));
        self.t = t;
    }

    pub(in crate::integrators) fn evaluate(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) {
        self.counters.residuals += 1;
        [&mut self.rhs, &mut self.exact].into_iter().for_each(|list| list.resize(self.system.size(), 0.0));
        // a factorization follows
        if self.kept.factored.is_none() && S::PARTS == 0 {
            self.kept.at.t = stage.t;
            self.kept.at.base.clone_from(stage.base);
            self.kept.at.unknowns.clone_from(unknowns);
        }
        let Newton { counters, residual, system, .. } = self;
        counters.timed(Phase::Residual, || residual.evaluate(system, stage, unknowns));
    }

    pub(in crate::integrators) fn factorize(
        &mut self,
        stage: StageSystem<S>,
        unknowns: &Unknowns<S>,
    ) -> Result<(), Singular> {
        let StageSystem { equations, p, t, .. } = stage;
        self.counters.factorizations += 1;
        let before = self.jacobian.evaluated;
        self.keep_numbers(p, t);
        let Newton { counters, residual, jacobian, factorization, system, p, divides, .. } = &mut *self;
        jacobian.divide(factorization.own_unknowns().filter(|_| *divides));
        jacobian.divide_by_threads(factorization.thread_owners());
        counters.timed(Phase::Matrix, || jacobian.assemble(system, equations, residual, unknowns, p, t));
        counters.blocks += jacobian.evaluated - before;
        counters.timed(Phase::Factorization, || jacobian.factor_in(factorization))?;
        let resembles_last = self.kept.measured.is_some_and(|old| self.resembles(&old, equations));
        self.kept.measured_for += 1;
        self.kept.contractions.age = 0;
        if !resembles_last {
            self.kept.contractions = Contractions::default();
        }
        if !resembles_last || self.kept.measured_for > MEASURED_FOR {
            (self.kept.measured, self.kept.measured_for, self.kept.floors) = (Some(*equations), 0, [None; 3]);
        }
        self.kept.factored = Some(*equations);
        Ok(())
    }

    fn step(&mut self, part: Option<usize>, unknowns: &mut Unknowns<S>) -> f64 {
        self.counters.solves += 1;
        self.jacobian.reduce(&self.system, &self.residual, part, &mut self.rhs);
        let Newton { counters, factorization, rhs, .. } = &mut *self;
        counters.timed(Phase::Solution, || factorization.solve(rhs));
        self.jacobian.add_step(&self.system, &self.rhs, part, unknowns, &self.coordinate_scales)
    }

    /// True if a matrix factored for one kind of equations serves the other: same coefficients of inertia, damping and stiffness. Stages
    /// at acceleration level and projections differ by the change of A within a step and by the curvature of the reactions; projections
    /// of coordinates alone are without nonholonomic constraints.
    fn resembles(&self, old: &Equations, new: &Equations) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= crate::tolerances::SAME_TIME * a.abs().max(b.abs());
        let rows = |e: &Equations| if e.metric { Level::Acceleration } else { e.level };
        let (own, other) = (old.residual, new.residual);
        let same = near(own.gamma, other.gamma) && near(own.beta, other.beta) && near(own.alpha, other.alpha);
        let free = |e: &Equations| self.nonholonomic && e.nonholonomic().is_none();
        rows(old) == rows(new) && same && free(old) == free(new) && old.variational.is_some() == new.variational.is_some()
    }

    /// What later systems depend on beside their own numbers.
    pub(in crate::integrators) fn keep_in(&self, kept: &mut KeptFactorization<S>) {
        kept.clone_from(&self.kept);
        if kept.factored.is_none() {
            kept.at.clear();
        }
    }

    /// The next matrix is factored, whatever was kept.
    pub(in crate::integrators) fn forget_factors(&mut self) {
        self.kept.factored = None;
    }

    /// Goes on as after the systems that left `kept`; the matrix is factored where it was then.
    pub(in crate::integrators) fn resume(&mut self, kept: &KeptFactorization<S>, p: &[S]) -> Result<(), Singular> {
        self.kept.factored = None;
        let FactoredAt { t, base, unknowns } = &kept.at;
        if let Some(equations) = &kept.factored {
            let stage = StageSystem { equations, base, p, t: *t };
            self.residual.start(&self.system, stage);
            let mut unknowns = unknowns.clone();
            self.evaluate(stage, &mut unknowns);
            self.factorize(stage, &unknowns)?;
        }
        self.kept.clone_from(kept);
        Ok(())
    }
}
