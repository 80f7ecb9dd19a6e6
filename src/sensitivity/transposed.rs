//! One system of the sweep back.

use crate::assembly::{
    Adjoints, Clock, Equations, Jacobian, NodeSeeds, ProductPoint, ProductSeeds, Products, Residual, StageSystem, System,
    Term, TermPoint, Unknowns, VectorsAvq,
};
use crate::design::shortest;
use crate::elements::RunScalar;
use crate::integrators::{Counters, EndMoves, Method, Phase, RunError, SolveRecord, StepRecord, kind};
use crate::linalg::{Factorization, SMALL_FILL, Singular, SolverPlan, TransposedSolution};
use crate::scalar::Tangents;
use smallvec::SmallVec;
use std::sync::Arc;

/// Adjoint of the solution of one system, for one functional.
#[derive(Clone, Debug, Default)]
pub(super) struct SolutionSeed {
    pub x: Vec<f64>,
    pub mu: Vec<f64>,
}

impl SolutionSeed {
    pub fn zeros(unknowns: usize, multipliers: usize) -> Self {
        SolutionSeed { x: vec![0.0; unknowns], mu: vec![0.0; multipliers] }
    }

    pub fn is_zero(&self) -> bool {
        self.x.iter().chain(&self.mu).all(|&bar| bar == 0.0)
    }
}

/// What goes backwards from step to step, for one functional.
#[derive(Default)]
pub(super) struct Backward {
    pub carried: Vec<Vec<f64>>,
    /// Of the acceleration and multipliers carried into an explicit first stage.
    pub mu: Vec<f64>,
    pub p: Vec<f64>,
    /// Where the step begins and ends, if its length has derivatives, and what is known of those by its start and by its end.
    pub span: Option<[f64; 2]>,
    pub moves: [f64; 2],
    /// Whether it is Euler's, whose states are not measured by its length.
    pub is_euler: bool,
    /// The same by the time of the event before the step, of all steps that move with it.
    pub by_event: f64,
    /// The same by the times of the breakpoints that move.
    pub by_breakpoints: Vec<f64>,
    /// Whether its adjoint variables of motions are corrected: see [`TransposedSolver::refine`].
    pub refining: Trial,
}

/// Share of a correction from which on the systems of a motion that follow are corrected, too.
const OF_USE: f64 = 1e-13;

/// Adjoint variables smaller than this, in any unit, change no digit of a gradient. A damped motion forgets: going back, they fall below the
/// normal numbers, with which a processor calculates a hundred times slower.
const NEGLIGIBLE: f64 = 1e-250;

impl Backward {
    pub fn of_parameters(parameters: usize) -> Self {
        Backward { p: vec![0.0; parameters], ..Backward::default() }
    }

    /// How time goes in the stages of a step whose start has the first derivative part, and whose end the second.
    pub fn clock(&self) -> Clock<Tangents> {
        match self.span {
            Some(span) if !self.is_euler => moving_clock(span),
            _ => shifting_clock(0),
        }
    }

    /// Adds what the length of Euler's step, which ends at q + h v and v + h a, is worth.
    pub fn lengthen(&mut self, step: &StepRecord<f64>) {
        let rates = [&step.carried[1], &step.stages[0].solve.unknowns.x];
        let worth: f64 = self
            .carried
            .iter()
            .zip(rates)
            .flat_map(|(bars, rates)| bars.iter().zip(rates))
            .map(|(bar, rate)| bar * rate)
            .sum();
        self.moves[0] -= worth;
        self.moves[1] += worth;
    }

    /// Gives what is known by the ends of a step to what they move with.
    pub fn move_ends(&mut self, moves: &[EndMoves; 2]) {
        for (own, by_end) in moves.iter().zip(self.moves) {
            self.by_event += own.by_event * by_end;
            for (number, share) in own.by_breakpoints.into_iter().filter(|(_, share)| *share != 0.0) {
                self.by_breakpoints[number] += share * by_end;
            }
        }
    }

    pub fn drop_negligible(&mut self) {
        let carried = self.carried.iter_mut().flatten();
        for bar in carried.chain(&mut self.mu).filter(|bar| bar.abs() < NEGLIGIBLE) {
            *bar = 0.0;
        }
    }
}

/// Whether what is of use for some systems of one kind is tried: the more often it was of no use, the more of them go by before it is tried
/// again.
#[derive(Clone, Copy, Default)]
pub(super) struct Trial {
    /// Systems to go by.
    left: usize,
    waited: usize,
}

const LONGEST_WAIT: usize = 64;

impl Trial {
    fn is_due(&mut self) -> bool {
        let due = self.left == 0;
        self.left = self.left.saturating_sub(1);
        due
    }

    fn learn(&mut self, was_of_use: bool) {
        self.waited = if was_of_use { 0 } else { (2 * self.waited + 1).min(LONGEST_WAIT) };
        self.left = self.waited;
    }
}

/// Solves transposed systems of one numbering; several functionals share each factorization.
pub(super) struct TransposedSolver<'m> {
    pub system: Arc<System<'m>>,
    residual: Residual<f64>,
    jacobian: Jacobian,
    factorization: Factorization,
    /// The solution, with the multipliers inside nodes that follow from it.
    unknowns: Unknowns<f64>,
    active: &'m [bool],
    products: Products,
    /// The system that was factored, until its adjoint is asked for.
    factored: Option<Factored>,
    /// The equations of the factored matrix, and whether it is the same for all states and times.
    constant: Option<(Equations, bool)>,
    /// Of the factors of an earlier matrix: for projections of coordinates, of velocities, and for stages.
    pub trials: [Trial; 3],
    /// Whether one solver has all stages, on any number of threads: factors, and what is learned of them, go from each system to the next.
    /// Otherwise the numbers of a system must not depend on which one the solver had before, but for projections at the same time.
    pub is_alone: bool,
    /// Whether matrices need care to be scaled, once the first step has told: see [`Factorization::refined_scaling`].
    pub refined_scaling: bool,
    /// Whether the factors that are there are those of a projection, and at what time.
    has_projection: Option<(bool, f64)>,
    /// Whether an adjoint of the last system was not zero.
    pub needed: bool,
    work: Counters,
    /// Right-hand sides, then solutions, in the unknowns of the matrix.
    reduced: Vec<f64>,
    sweep: Sweep,
    bases: Vec<VectorsAvq<f64>>,
    /// Whether its systems stand at the end of a step, with the time of that.
    pub is_apart: bool,
    /// Of derivatives by the ends of a step.
    moved: Residual<Tangents>,
}

/// What one system takes on the way back, for one functional after the other.
#[derive(Default)]
struct Sweep {
    adjoints: Vec<Adjoints>,
    /// Products with the derivatives towards (a, v, q) of what is taken at each of [`TermPoint::ALL`]; empty where nothing is.
    at: [Vec<f64>; TermPoint::ALL.len()],
    /// Those towards parameters, for a metric that is a difference.
    own_p: Vec<f64>,
    /// A point that the unknowns do not move.
    moved: VectorsAvq<f64>,
}

struct Factored {
    t: f64,
    equations: Equations,
    outcome: Result<(), Singular>,
    /// Whether the factors are those of an earlier matrix, on trial.
    on_trial: bool,
}

impl<'m> TransposedSolver<'m> {
    pub fn new(system: Arc<System<'m>>, method: &Method, active: &'m [bool]) -> Result<Self, RunError> {
        let factorization =
            Factorization::new(&system.pattern, method.backend).map_err(|s| RunError::of_pattern("adjoint", s))?;
        let plan = factorization.plan();
        let is_alone = plan.unknowns < APART || is_large(plan) || Jacobian::is_constant_in_stages(&system);
        Ok(Self::of(system, factorization, active, is_alone, Counters::measuring(method.measures_phases)))
    }

    /// Whether the factors take more than a few megabytes.
    pub fn is_large(&self) -> bool {
        is_large(self.factorization.plan())
    }

    /// Multiplications of a factorization, as far as they are known.
    pub fn multiplications(&self) -> f64 {
        self.factorization.plan().work.map_or(0.0, |work| work.multiplications)
    }

    pub fn clone_analysis(&self) -> Result<Self, RunError> {
        let factorization = self.factorization.clone_analysis().map_err(|s| RunError::of_pattern("adjoint", s))?;
        let work = Counters::measuring(self.work.nanoseconds.is_some());
        Ok(Self::of(self.system.clone(), factorization, self.active, self.is_alone, work))
    }

    fn of(
        system: Arc<System<'m>>,
        factorization: Factorization,
        active: &'m [bool],
        is_alone: bool,
        work: Counters,
    ) -> Self {
        TransposedSolver {
            is_alone,
            // a small one may have its factors made ahead, at any time
            residual: if is_large(factorization.plan()) { Residual::shared() } else { Residual::default() },
            jacobian: Jacobian::default(),
            system,
            factorization,
            unknowns: Unknowns::default(),
            active,
            products: Products::new(active),
            factored: None,
            constant: None,
            trials: [Trial::default(); 3],
            refined_scaling: false,
            has_projection: None,
            needed: false,
            work,
            reduced: Vec::new(),
            sweep: Sweep::default(),
            bases: Vec::new(),
            is_apart: false,
            moved: Residual::default(),
        }
    }

    /// Factors the matrix of a system at its solution: all of the work that needs no adjoint.
    pub fn factor(&mut self, record: &SolveRecord<f64>, p: &[f64]) {
        let system = &*self.system;
        let SolveRecord { t, equations, base, unknowns } = record;
        // anew: the multipliers inside nodes follow from the solution
        self.unknowns.clone_from(unknowns);
        let stage = StageSystem { equations, base, p, t: *t };
        let TransposedSolver { residual, jacobian, unknowns: own, work, .. } = self;
        work.timed(Phase::Residual, || residual.move_to(system, stage, own));
        work.residuals += 1;
        if self.is_alone && self.constant.is_some_and(|(of, is_constant)| is_constant && of.is_nearly(equations)) {
            self.factored = Some(Factored { t: *t, equations: *equations, outcome: Ok(()), on_trial: false });
            return;
        }
        let before = jacobian.evaluated;
        jacobian.divide(self.factorization.own_unknowns());
        jacobian.divide_by_threads(self.factorization.thread_owners());
        work.timed(Phase::Matrix, || jacobian.assemble(system, equations, residual, own, p, *t));
        work.blocks += jacobian.evaluated - before;
        // those of a stage tell nothing of a projection
        let alike = self
            .has_projection
            .is_some_and(|(metric, at)| metric == equations.metric && (self.is_alone || metric && at == *t));
        let kept = match alike && self.trials[kind(equations)].is_due() {
            true => self.factorization.keep_factors(&self.jacobian.values),
            false => Ok(false),
        };
        let outcome = match kept {
            Ok(false) => {
                self.work.factorizations += 1;
                self.has_projection = Some((equations.metric, *t));
                if !self.is_alone {
                    self.factorization.reset_scaling(self.refined_scaling);
                }
                let TransposedSolver { work, jacobian, factorization, .. } = self;
                work.timed(Phase::Factorization, || jacobian.factor_in(factorization))
            }
            _ => kept.map(|_| ()),
        };
        self.factored = Some(Factored { t: *t, equations: *equations, outcome, on_trial: kept == Ok(true) });
        if self.constant.is_none_or(|(of, _)| !of.is_nearly(equations)) || outcome.is_err() {
            self.constant = Some((*equations, outcome.is_ok() && Jacobian::is_constant(system, equations)));
        }
    }

    /// Whether the last matrix needed care to be scaled, if any was factored.
    pub fn has_needed_care(&self) -> Option<bool> {
        self.has_projection.map(|_| self.factorization.refined_scaling())
    }

    /// Forgets a system for whose adjoint nobody has asked, and counts the work done so far.
    pub fn forget(&mut self, counters: &mut Counters) {
        self.factored = None;
        *counters += self.work.handed_over();
    }

    /// Goes back through one system, which is factored now unless it was before; returns the adjoint of its base point for each
    /// functional and adds to `p_bar`.
    pub fn through(
        &mut self,
        record: &SolveRecord<f64>,
        p: &[f64],
        seeds: &[SolutionSeed],
        back: &mut [Backward],
        counters: &mut Counters,
    ) -> Result<&[VectorsAvq<f64>], RunError> {
        let dofs = self.system.model.dofs;
        let asked: SmallVec<[usize; 8]> = (0..seeds.len()).filter(|&k| !seeds[k].is_zero()).collect();
        self.bases.resize_with(seeds.len(), VectorsAvq::default);
        // those that are asked for are written below
        let others = self.bases.iter_mut().enumerate().filter(|(k, _)| !asked.contains(k));
        others.for_each(|(_, base)| set_zero_vectors(base, dofs));
        self.needed = !asked.is_empty();
        if asked.is_empty() {
            if self.factored.is_some() {
                // as if it had not been factored ahead
                self.has_projection = None;
            }
            self.forget(counters);
            return Ok(&self.bases);
        }
        self.solve_factored(record, p, (&asked, seeds), counters)?;
        self.refine(record, p, (&asked, seeds), back, counters)?;
        self.add_products(record, p, &asked, back);
        self.add_inside_nodes(&record.equations, &asked, seeds);
        self.add_moves(record, p, &asked, back);
        self.write_bases(&record.equations, &asked);
        Ok(&self.bases)
    }

    /// Goes on back from the system gone through last, an impact behind which rows of G keep shares of their rates r before it, to these: returns the
    /// adjoints of its base point that this adds, and of each functional those of the shares, -lambda r.
    pub fn through_kept(
        &mut self,
        record: &SolveRecord<f64>,
        p: &[f64],
        (seeds, kept): (&[SolutionSeed], &[(usize, f64)]),
        back: &mut [Backward],
    ) -> (&[VectorsAvq<f64>], Vec<Vec<f64>>) {
        let asked: SmallVec<[usize; 8]> = (0..seeds.len()).filter(|&k| !seeds[k].is_zero()).collect();
        let unknowns = Residual::<f64>::unknowns(&self.system);
        let still = SolveRecord { unknowns, ..record.clone() };
        self.unknowns.clone_from(&still.unknowns);
        let stage = StageSystem { equations: &still.equations, base: &still.base, p, t: still.t };
        self.residual.start(&self.system, stage);
        self.residual.evaluate(&self.system, stage, &mut self.unknowns);
        let rates = &self.residual.g;
        let mut of_shares = vec![vec![0.0; kept.len()]; seeds.len()];
        for (&k, own) in asked.iter().zip(&mut self.sweep.adjoints) {
            of_shares[k] = kept.iter().map(|&(row, _)| -own.g[row] * rates[row]).collect();
            let rows: Vec<(usize, f64)> = kept.iter().map(|&(row, share)| (row, -share * own.g[row])).collect();
            set_zeros(&mut own.f, self.system.model.dofs);
            set_zeros(&mut own.g, self.system.multipliers());
            rows.into_iter().for_each(|(row, bar)| own.g[row] = bar);
        }
        self.add_products(&still, p, &asked, back);
        self.add_moves(&still, p, &asked, back);
        self.write_bases(&still.equations, &asked);
        (&self.bases, of_shares)
    }

    /// Corrects adjoint variables until they keep their equation as the formulas say it, not only the matrix. Its entries round, and what that
    /// makes of stiff members is a force on soft motions: a share eps omega^2 h^2 of their inertia at the highest frequency omega, in an
    /// equilibrium of their stiffness. Where it was nothing for a functional in a motion, systems go by before it is looked at again.
    fn refine(
        &mut self,
        record: &SolveRecord<f64>,
        p: &[f64],
        (asked, seeds): (&[usize], &[SolutionSeed]),
        back: &mut [Backward],
        counters: &mut Counters,
    ) -> Result<(), RunError> {
        let (dofs, equations) = (self.system.model.dofs, &record.equations);
        if !equations.is_static() && (equations.variational.is_some() || equations.metric || equations.is_of_accelerations())
        {
            return Ok(());
        }
        // shares of the last corrections; zero where nothing is left to correct, so that each has the numbers that it has alone
        let mut due = |k: usize| equations.is_static() || back[k].refining.is_due();
        let mut left: Vec<f64> = asked.iter().map(|&k| f64::from(u8::from(due(k)))).collect();
        // of parameters nothing is asked here
        let mut aside: Vec<Backward> = seeds.iter().map(|_| Backward::of_parameters(p.len())).collect();
        while left.iter().any(|&left| left > 0.0) {
            self.add_products(record, p, asked, &mut aside);
            self.add_inside_nodes(equations, asked, seeds);
            let [elements, _, _, constraints, _] = &self.sweep.at;
            let mut rest: Vec<SolutionSeed> = seeds.to_vec();
            for (place, &k) in asked.iter().enumerate() {
                rest[k].mu.fill(0.0);
                for (shift, products) in [(equations.residual, elements), (equations.constraint, constraints)] {
                    let of_functional = products[3 * place * dofs..][..3 * dofs].chunks_exact(dofs.max(1));
                    for (factor, products) in [shift.gamma, shift.beta, shift.alpha].into_iter().zip(of_functional) {
                        add(&mut rest[k].x, factor, products);
                    }
                }
            }
            let known = self.sweep.adjoints[..asked.len()].to_vec();
            self.solve(asked, &rest).map_err(|singular| self.singular_at(singular, record.t))?;
            counters.solves += asked.len();
            counters.products += asked.len();
            let size = |own: &Adjoints| own.f.iter().fold(f64::MIN_POSITIVE, |size, f| size.max(f.abs()));
            let corrections = self.sweep.adjoints.iter_mut().zip(known).zip(&mut left).zip(asked);
            for (((own, known), left), &k) in corrections {
                let correction = std::mem::replace(own, known);
                let share = size(&correction) / size(own);
                // in no unit: of what the seeds of the solution are multiplied by
                let effect = |of: &Adjoints| {
                    of.f.iter().zip(&seeds[k].x).fold(0.0, |effect: f64, (f, bar)| effect.max((f * bar).abs()))
                };
                let is_of_use = effect(&correction) > OF_USE * effect(own);
                let is_better = share < 0.5 * *left;
                if is_better {
                    own.add(&correction);
                }
                if *left == 1.0 && !equations.is_static() {
                    back[k].refining.learn(is_better && is_of_use);
                }
                // the next one is smaller by as much as this one was than the solution
                *left = if is_better && share * share > crate::tolerances::ROUND_OFF { share } else { 0.0 };
            }
        }
        Ok(())
    }

    /// Solves for the adjoint variables with the matrix of a system, which is factored now unless it was before.
    fn solve_factored(
        &mut self,
        record: &SolveRecord<f64>,
        p: &[f64],
        (asked, seeds): (&[usize], &[SolutionSeed]),
        counters: &mut Counters,
    ) -> Result<(), RunError> {
        let SolveRecord { t, equations, .. } = record;
        if self.factored.is_none() {
            self.factor(record, p);
        }
        let mut on_trial = false;
        if let Some(factored) = &self.factored {
            assert!(
                factored.t == *t && factored.equations == *equations,
                "the system at {t} s was not the one factored ahead"
            );
            factored.outcome.map_err(|singular| self.singular_at(singular, *t))?;
            on_trial = factored.on_trial;
        }
        let refactored = self.solve(asked, seeds).map_err(|singular| self.singular_at(singular, *t))?;
        self.forget(counters);
        counters.systems += 1;
        counters.solves += asked.len();
        counters.products += asked.len();
        if on_trial {
            self.trials[kind(equations)].learn(!refactored);
            counters.factorizations += usize::from(refactored);
        }
        Ok(())
    }

    /// Products of the adjoint variables with the derivatives of all terms, each at its point; those towards parameters are added to `back`.
    fn add_products(&mut self, record: &SolveRecord<f64>, p: &[f64], asked: &[usize], back: &mut [Backward]) {
        let SolveRecord { t, equations, base, .. } = record;
        let TransposedSolver { system, residual, products, unknowns, sweep, .. } = self;
        let Sweep { adjoints, at: avq, own_p, moved } = sweep;
        let (adjoints, dofs) = (&adjoints[..asked.len()], system.model.dofs);
        for (seeds, point) in avq.iter_mut().zip(TermPoint::ALL) {
            set_zeros(seeds, if equations.is_taken_at(point) { asked.len() * 3 * dofs } else { 0 });
        }
        // in a metric that is a difference what stiff elements give at both points cancels, and would take other digits along: gathered on its own
        let cancels = equations.is_taken_at(TermPoint::Base);
        set_zeros(own_p, if cancels { asked.len() * p.len() } else { 0 });
        let mut p_bars: Parameters = if cancels {
            let own = own_p.chunks_exact_mut(p.len().max(1)).chain(std::iter::repeat_with(Default::default));
            own.take(asked.len()).collect()
        } else {
            let needed = back.iter_mut().enumerate().filter(|(k, _)| asked.contains(k));
            needed.map(|(_, back)| back.p.as_mut_slice()).collect()
        };
        for (term, point) in equations.terms() {
            let at = match point {
                TermPoint::Solution => &residual.at,
                TermPoint::Constraints => residual.constraint_at(),
                TermPoint::Reactions => &residual.reaction_at,
                TermPoint::Base | TermPoint::Before => equations.point_of(point, base, moved),
            };
            let there = ProductPoint { at, p, t: equations.time_at(point, *t) };
            let mut into = product_bars(&mut avq[point as usize], &mut p_bars, dofs);
            match term {
                Term::Elements(force, factor) => {
                    products.add_elements(system, adjoints, (force, factor), there, &mut into);
                }
                Term::Constraints(part) => {
                    products.add_constraints(system, (equations, part), adjoints, unknowns, there, &mut into);
                }
            }
        }
        for (&k, own) in asked.iter().zip(own_p.chunks_exact(p.len().max(1))) {
            add(&mut back[k].p, 1.0, own);
        }
    }

    /// What the ends of the step do to F and G while its state stays, times the adjoint variables.
    fn add_moves(&mut self, record: &SolveRecord<f64>, p: &[f64], asked: &[usize], back: &mut [Backward]) {
        let Some(moved) = back.first().filter(|back| back.span.is_some()) else { return };
        let clock = if self.is_apart { shifting_clock(1) } else { moved.clock() };
        let lift = |values: &[f64]| values.iter().map(|&value| Tangents::from(value)).collect::<Vec<_>>();
        let SolveRecord { t, equations, base: VectorsAvq { a, v, q }, .. } = record;
        let Unknowns { x, mu, local_mu } = &self.unknowns;
        let (base, p) = (VectorsAvq { a: lift(a), v: lift(v), q: lift(q) }, lift(p));
        let mut unknowns = Unknowns { x: lift(x), mu: lift(mu), local_mu: lift(local_mu) };
        let stage = StageSystem { equations, base: &base, p: &p, t: *t };
        let Residual { clock: own, keep_values, .. } = &mut self.moved;
        (*own, *keep_values) = (Some(clock), true);
        self.moved.start(&self.system, stage);
        self.moved.evaluate(&self.system, stage, &mut unknowns);
        let Residual { f, g, .. } = &self.moved;
        for (&k, adjoints) in asked.iter().zip(&self.sweep.adjoints) {
            for (end, moves) in back[k].moves.iter_mut().enumerate() {
                let along = |values: &[Tangents], own: &[f64]| -> f64 {
                    values.iter().zip(own).map(|(value, own)| value.part(end) * own).sum()
                };
                *moves += along(f, &adjoints.f) + along(g, &adjoints.g);
            }
        }
    }

    fn add_inside_nodes(&mut self, equations: &Equations, asked: &[usize], seeds: &[SolutionSeed]) {
        let TransposedSolver { system, residual, products, unknowns, sweep, .. } = self;
        let all = 3 * system.model.dofs;
        let [elements, _, _, constraints, reactions] = &mut sweep.at;
        let mut reactions = reactions.chunks_exact_mut(all);
        let parts = elements.chunks_exact(all).zip(constraints.chunks_exact_mut(all));
        let at_nodes = asked.iter().zip(&sweep.adjoints).zip(parts);
        let at_nodes = at_nodes.map(|((&k, adjoints), (elements, constraints))| NodeSeeds {
            x: &seeds[k].x,
            adjoints,
            elements,
            constraints,
            reactions: reactions.next(),
        });
        let mut at_nodes = at_nodes.collect::<SmallVec<[_; 8]>>();
        products.add_inside_nodes(system, equations, unknowns, residual.constraint_at(), &mut at_nodes);
    }

    /// The adjoints of the base from those of all points.
    fn write_bases(&mut self, equations: &Equations, asked: &[usize]) {
        let dofs = self.system.model.dofs;
        for (place, &k) in asked.iter().enumerate() {
            let here = place * 3 * dofs..(place + 1) * 3 * dofs;
            let at = self.sweep.at.each_ref().map(|seeds| seeds.get(here.clone()).unwrap_or_default());
            if equations.parts_reactions() {
                write_moved_base(equations, at, &mut self.bases[k]);
            } else {
                write_base(equations, at, &mut self.bases[k]);
            }
        }
    }

    /// Solves J^T lambda = -x_bar for each x_bar that is not zero; returns whether the matrix had to be factored for it.
    fn solve(&mut self, asked: &[usize], seeds: &[SolutionSeed]) -> Result<bool, Singular> {
        let system = &*self.system;
        let size = system.size();
        self.reduced.resize(asked.len() * size, 0.0);
        for (&k, reduced) in asked.iter().zip(self.reduced.chunks_exact_mut(size.max(1))) {
            let SolutionSeed { x, mu } = &seeds[k];
            self.jacobian.reduce_adjoint(system, [x, mu], reduced);
        }
        let TransposedSolver { factorization, jacobian, reduced, work, .. } = self;
        let mut refactored = false;
        while work.timed(Phase::Solution, || factorization.solve_transposed(reduced))? == TransposedSolution::NeedsFactors {
            work.timed(Phase::Factorization, || jacobian.factor_in(factorization))?;
            refactored = true;
        }
        let all = &mut self.sweep.adjoints;
        all.resize_with(all.len().max(asked.len()), || Adjoints::zeros(system));
        for (adjoints, reduced) in all.iter_mut().zip(self.reduced.chunks_exact(size.max(1))) {
            self.jacobian.set_adjoints(system, reduced, adjoints);
        }
        Ok(refactored)
    }

    fn singular_at(&self, Singular { unknown }: Singular, t: f64) -> RunError {
        singular(&self.system.unknown_name(unknown, &self.jacobian), &format!("adjoint at t = {} s", shortest(t)))
    }
}

/// How time goes in a step whose start has the first derivative part, and whose end the second.
pub(super) fn moving_clock(span: [f64; 2]) -> Clock<Tangents> {
    let parts = [0, 1].map(|end| {
        let mut part = Tangents::from(0.0);
        part.add_to_part(end, 1.0);
        part
    });
    Clock::new(span, parts)
}

/// How time goes where all of it has one of these derivative parts.
pub(super) fn shifting_clock(end: usize) -> Clock<Tangents> {
    let mut part = Tangents::from(0.0);
    part.add_to_part(end, 1.0);
    Clock::shifted(part)
}

/// Length of Euler's step as a share of its real one, with its derivative parts.
pub(super) fn lengthened([start, end]: [f64; 2]) -> Tangents {
    let mut length = Tangents::from(1.0);
    [-1.0, 1.0].into_iter().enumerate().for_each(|(of, sign)| length.add_to_part(of, sign / (end - start)));
    length
}

/// Unknowns from which each stage of a step may have a solver of its own: below, waking other threads takes longer than a factorization.
const APART: usize = 20;
fn is_large(plan: SolverPlan) -> bool {
    plan.work.is_some_and(|work| work.fill > SMALL_FILL)
}

/// Adjoints of the parameters, for one functional after the other.
type Parameters<'p> = Vec<&'p mut [f64]>;

fn product_bars<'b>(avq: &'b mut [f64], p: &'b mut [&mut [f64]], dofs: usize) -> Vec<ProductSeeds<'b>> {
    avq.chunks_exact_mut(3 * dofs).zip(p).map(|(avq, p)| ProductSeeds { avq, p }).collect()
}

/// The adjoint of a base that is the point of all terms, before unknowns move it.
fn write_base(equations: &Equations, at: [&[f64]; 5], bar: &mut VectorsAvq<f64>) {
    let [elements, own, _, constraints, _] = at;
    let dofs = elements.len() / 3;
    for (vector, bar) in [&mut bar.a, &mut bar.v, &mut bar.q].into_iter().enumerate() {
        let range = vector * dofs..(vector + 1) * dofs;
        let (elements, constraints) = (&elements[range.clone()], &constraints[range.clone()]);
        bar.clear();
        if vector == 0 && equations.is_of_inertia() {
            bar.extend_from_slice(constraints);
        } else if own.is_empty() {
            bar.extend(elements.iter().zip(constraints).map(|(element, constraint)| element + constraint));
        } else {
            // first what cancels
            let own = own[range].iter().zip(elements).map(|(own, element)| own + element);
            bar.extend(own.zip(constraints).map(|(sum, constraint)| sum + constraint));
        }
    }
}

/// The same where points lie on from the base along its velocity; accelerations have no part in any of them.
fn write_moved_base(equations: &Equations, at: [&[f64]; 5], bar: &mut VectorsAvq<f64>) {
    let [elements, _, before, constraints, reactions] = at;
    let dofs = elements.len() / 3;
    let [of_before, of_constraints, of_reactions] =
        [TermPoint::Before, TermPoint::Constraints, TermPoint::Reactions].map(|point| equations.offset(point));
    set_zero_vectors(bar, dofs);
    for i in 0..dofs {
        let (in_v, in_q) = (dofs + i, 2 * dofs + i);
        bar.q[i] = elements[in_q] + before[in_q] + constraints[in_q] + reactions[in_q];
        let moved = of_constraints * constraints[in_q] + of_reactions * reactions[in_q];
        bar.v[i] = elements[in_v] + before[in_v] + of_before * before[in_q] + moved;
    }
}

/// So many zeros, in the memory that is there.
pub(super) fn set_zeros(values: &mut Vec<f64>, count: usize) {
    values.clear();
    values.resize(count, 0.0);
}

/// The same for accelerations, velocities and coordinates.
pub(super) fn set_zero_vectors(VectorsAvq { a, v, q }: &mut VectorsAvq<f64>, dofs: usize) {
    [a, v, q].into_iter().for_each(|values| set_zeros(values, dofs));
}

pub(super) fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    if factor != 0.0 {
        target.iter_mut().zip(values).for_each(|(target, value)| *target += factor * value);
    }
}

fn singular(unknown: &str, place: &str) -> RunError {
    RunError::singular(place, unknown, "the motion passes a singular pose: its gradient does not exist there")
}

#[cfg(test)]
mod tests {
    use super::Trial;

    #[test]
    fn factors_that_are_of_no_use_are_tried_more_and_more_seldom() {
        let mut trial = Trial::default();
        let mut next = |was_of_use: bool| {
            let by = (0..).take_while(|_| !trial.is_due()).count();
            trial.learn(was_of_use);
            by
        };
        let waits: Vec<usize> = (0..8).map(|_| next(false)).collect();
        assert_eq!(waits, [0, 1, 3, 7, 15, 31, 63, 64]);
        assert_eq!([next(true), next(true), next(false), next(false)], [64, 0, 0, 1]);
    }
}
