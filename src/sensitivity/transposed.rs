//! One system of the sweep back.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use crate::assembly::{
    Adjoints, ConstraintPart, Equations, Force, Jacobian, ProductBars, ProductPoint, Products, Residual, StageSystem,
    System, Unknowns, Variational, VectorsAvq,
};
use crate::integrators::{Counters, Method, RunError, SolveRecord};
use crate::linalg::{Factorization, Singular, SolverPlan};
use std::sync::Arc;

/// Adjoint of the solution of one system, for one functional.
#[derive(Clone, Debug)]
pub(super) struct SolutionBar {
    pub x: Vec<f64>,
    /// Of the rate correction w while it is gathered, of its unknown y in a system; empty unless stabilized.
    pub rate: Vec<f64>,
    pub mu: Vec<f64>,
}

impl SolutionBar {
    pub fn zeros(dofs: usize, multipliers: usize, rates: bool) -> Self {
        SolutionBar { x: vec![0.0; dofs], rate: vec![0.0; if rates { dofs } else { 0 }], mu: vec![0.0; multipliers] }
    }
    pub fn is_zero(&self) -> bool {
        self.x.iter().chain(&self.rate).chain(&self.mu).all(|&bar| bar == 0.0)
    }
}

/// What goes backwards from step to step, for one functional.
pub(super) struct Backward {
    pub carried: Vec<Vec<f64>>,
    /// Of the rate correction carried into an explicit first stage.
    pub rate: Vec<f64>,
    /// Of the acceleration and multipliers carried into an explicit first stage.
    pub mu: Vec<f64>,
    pub p: Vec<f64>,
}

/// Adjoint variables smaller than this, in any unit, change no digit of a gradient. A damped motion forgets: going back, they fall below the
/// normal numbers, with which a processor calculates a hundred times slower.
const NEGLIGIBLE: f64 = 1e-250;

impl Backward {
    /// Sets what is negligible to zero.
    pub fn drop_negligible(&mut self) {
        let carried = self.carried.iter_mut().flatten();
        for bar in carried.chain(&mut self.rate).chain(&mut self.mu).filter(|bar| bar.abs() < NEGLIGIBLE) {
            *bar = 0.0;
        }
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
    /// Parameters whose derivatives are asked for.
    active: &'m [bool],
    products: Products,
    /// The system that was factored, until its adjoint is asked for.
    factored: Option<Factored>,
    /// The equations of the factored matrix, and whether it is the same for all states and times.
    constant: Option<(Equations, bool)>,
    /// Whether an adjoint of the last system was not zero.
    needed: bool,
    /// Work that is not counted yet.
    work: Counters,
}

/// A system that was factored.
struct Factored {
    t: f64,
    equations: Equations,
    outcome: Result<bool, Singular>,
}

impl<'m> TransposedSolver<'m> {
    pub fn new(system: Arc<System<'m>>, method: &Method, active: &'m [bool]) -> Result<Self, RunError> {
        let factorization =
            Factorization::new(&system.pattern, method.backend).map_err(|s| singular(s.unknown, "adjoint"))?;
        Ok(Self::of(system, factorization, active))
    }

    /// Another one for the same system.
    pub fn another(&self) -> Result<Self, RunError> {
        let factorization = self.factorization.another().map_err(|s| singular(s.unknown, "adjoint"))?;
        Ok(Self::of(self.system.clone(), factorization, self.active))
    }

    fn of(system: Arc<System<'m>>, factorization: Factorization, active: &'m [bool]) -> Self {
        TransposedSolver {
            residual: Residual::new(&system),
            jacobian: Jacobian::new(&system),
            system,
            factorization,
            unknowns: Unknowns::default(),
            active,
            products: Products::new(active),
            factored: None,
            constant: None,
            needed: false,
            work: Counters::default(),
        }
    }

    /// Solver of the linear systems.
    pub fn plan(&self) -> SolverPlan {
        self.factorization.plan()
    }

    /// Factors the matrix of a system at its solution: all of the work that needs no adjoint.
    pub fn factor(&mut self, record: &SolveRecord<f64>, p: &[f64]) {
        let system = &*self.system.clone();
        let SolveRecord { t, equations, base, unknowns } = record;
        // evaluated anew: the multipliers inside nodes follow from the solution
        self.unknowns.clone_from(unknowns);
        let stage = StageSystem { equations, base, p, t: *t };
        self.residual.start(system, stage);
        self.residual.evaluate(system, stage, &mut self.unknowns);
        self.work.residuals += 1;
        if self.constant.is_some_and(|(of, is_constant)| is_constant && of.is_nearly(equations)) {
            self.factored = Some(Factored { t: *t, equations: *equations, outcome: Ok(false) });
            return;
        }
        let before = self.jacobian.evaluated;
        self.jacobian.assemble(system, equations, &self.residual, &self.unknowns, p, *t);
        let outcome = self.factorization.factor_or_reuse(&self.jacobian.values);
        self.work.blocks += self.jacobian.evaluated - before;
        self.work.factorizations += usize::from(outcome == Ok(true));
        self.factored = Some(Factored { t: *t, equations: *equations, outcome });
        if self.constant.is_none_or(|(of, _)| !of.is_nearly(equations)) || outcome.is_err() {
            self.constant = Some((*equations, outcome.is_ok() && Jacobian::is_constant(system, equations)));
        }
    }

    /// Whether an adjoint of the last system was not zero.
    pub fn was_needed(&self) -> bool {
        self.needed
    }

    /// Forgets a system for whose adjoint nobody has asked, and counts the work done so far.
    pub fn forget(&mut self, counters: &mut Counters) {
        self.factored = None;
        *counters += std::mem::take(&mut self.work);
    }

    /// Goes back through one system, which is factored now unless it was before; returns the adjoint of its base point for each
    /// functional and adds to `p_bar`.
    pub fn through(
        &mut self,
        record: &SolveRecord<f64>,
        p: &[f64],
        bars: &[SolutionBar],
        back: &mut [Backward],
        counters: &mut Counters,
    ) -> Result<Vec<VectorsAvq<f64>>, RunError> {
        let system = &*self.system.clone();
        let dofs = system.model.dofs;
        let mut base_bars = vec![VectorsAvq::zeros(dofs); bars.len()];
        let asked: Vec<usize> = (0..bars.len()).filter(|&k| !bars[k].is_zero()).collect();
        self.needed = !asked.is_empty();
        if asked.is_empty() {
            self.forget(counters);
            return Ok(base_bars);
        }
        let SolveRecord { t, equations, base, .. } = record;
        if self.factored.is_none() {
            self.factor(record, p);
        }
        if let Some(factored) = &self.factored {
            assert!(
                factored.t == *t && factored.equations == *equations,
                "the system at {t} s was not the one factored ahead"
            );
            factored.outcome.map_err(|singular| self.singular_at(singular, *t))?;
        }
        self.forget(counters);
        counters.systems += 1;
        let unknowns = std::mem::take(&mut self.unknowns);

        let mut all = self.solve(asked.iter().map(|&k| &bars[k]));
        counters.solves += asked.len();
        counters.products += asked.len();

        let mut at_bars = vec![VectorsAvq::zeros(dofs); asked.len()];
        let mut constraint_bars = at_bars.clone();
        let mut before = VectorsAvq::default();
        // in a metric that is a difference what stiff elements give at both points cancels, and would take other digits along: gathered on its own
        let mut own_p = vec![vec![0.0; if equations.is_difference() { p.len() } else { 0 }]; asked.len()];
        let mut p_bars: Vec<&mut Vec<f64>> = if equations.is_difference() {
            own_p.iter_mut().collect()
        } else {
            back.iter_mut().enumerate().filter(|(k, _)| asked.contains(k)).map(|(_, back)| &mut back.p).collect()
        };
        let point = |at, t| ProductPoint { at, p, t };
        let (constraint_at, products) = (&self.residual.constraint_at, &mut self.products);
        // where reactions act, and what the step before left: other points in a step of a variational integrator
        let [mut reaction_bars, mut before_bars] = [Vec::new(), Vec::new()];
        if let Some(step) = equations.variational {
            reaction_bars.resize(asked.len(), VectorsAvq::zeros(dofs));
            before_bars.resize(asked.len(), VectorsAvq::zeros(dofs));
            let mut into = product_bars(&mut at_bars, &mut p_bars);
            products.add_elements(system, &all, (Force::Impulse(step.now()), 1.0), point(&self.residual.at, *t), &mut into);
            Variational::write_moved(base, step.to_before(), &mut before);
            let mut into = product_bars(&mut before_bars, &mut p_bars);
            let there = point(&before, t + step.to_before());
            products.add_elements(system, &all, (Force::Impulse(step.before()), -1.0), there, &mut into);
            let mut into = product_bars(&mut constraint_bars, &mut p_bars);
            let there = point(constraint_at, equations.constraint_time(*t));
            products.add_constraints(system, (equations, ConstraintPart::Equations), &all, &unknowns, there, &mut into);
            let mut into = product_bars(&mut reaction_bars, &mut p_bars);
            let there = point(&self.residual.reaction_at, equations.reaction_time(*t));
            let which = ConstraintPart::Reactions(step.reaction());
            products.add_constraints(system, (equations, which), &all, &unknowns, there, &mut into);
        } else {
            let mut into = product_bars(&mut at_bars, &mut p_bars);
            products.add_elements(system, &all, (Force::of(equations), 1.0), point(&self.residual.at, *t), &mut into);
            let mut into = product_bars(&mut constraint_bars, &mut p_bars);
            let there = point(constraint_at, *t);
            products.add_constraints(system, (equations, ConstraintPart::Both), &all, &unknowns, there, &mut into);
        }
        if equations.is_difference() {
            let mut own: Vec<VectorsAvq<f64>> = vec![VectorsAvq::zeros(dofs); asked.len()];
            let mut into = product_bars(&mut own, &mut p_bars);
            products.add_elements(system, &all, (Force::Residual, -1.0), point(base, *t), &mut into);
            for (&k, own) in asked.iter().zip(own) {
                base_bars[k] = own;
            }
        }
        for (&k, own) in asked.iter().zip(&own_p) {
            back[k].p.iter_mut().zip(own).for_each(|(bar, own)| *bar += own);
        }
        for (place, ((&k, adjoints), (at_bar, constraint_bar))) in
            asked.iter().zip(&mut all).zip(at_bars.iter().zip(&mut constraint_bars)).enumerate()
        {
            let (bar, base_bar) = (&bars[k], &mut base_bars[k]);
            let reaction_bar = reaction_bars.get_mut(place).unwrap_or(&mut *constraint_bar);
            system.add_local_products(false, equations, adjoints, &unknowns, constraint_at, reaction_bar);
            // what is left of x_bar + J^T lambda along the eliminated directions belongs to the equations inside nodes
            let (shift, inner) = (equations.residual, equations.constraint);
            let alpha_part = |i: usize| shift.alpha * at_bar.q[i] + inner.alpha * constraint_bar.q[i];
            let unbalanced_x: Vec<f64> = (0..dofs)
                .map(|i| {
                    let rates = shift.gamma * at_bar.a[i] + shift.beta * at_bar.v[i];
                    let inner_rates = inner.gamma * constraint_bar.a[i] + inner.beta * constraint_bar.v[i];
                    bar.x[i] + rates + inner_rates + alpha_part(i)
                })
                .collect();
            let rate_bars = bar.rate.iter().enumerate();
            let unbalanced_y: Vec<f64> = rate_bars.map(|(i, y)| y + adjoints.y[i] + alpha_part(i)).collect();
            system.set_local_adjoints(equations, constraint_at, &unbalanced_x, &unbalanced_y, adjoints);
            system.add_local_products(true, equations, adjoints, &unknowns, constraint_at, constraint_bar);
            if let Some(step) = equations.variational {
                let (reaction, before) = (&reaction_bars[place].q, &before_bars[place]);
                for i in 0..dofs {
                    let of_constraint = constraint_bar.q[i];
                    base_bar.q[i] = at_bar.q[i] + before.q[i] + of_constraint + reaction[i];
                    let moved = step.to_end() * of_constraint + step.to_start() * reaction[i];
                    base_bar.v[i] = at_bar.v[i] + before.v[i] + step.to_before() * before.q[i] + moved;
                }
                continue;
            }
            for i in 0..dofs {
                // first what cancels
                let of_elements = if equations.is_of_inertia() { 0.0 } else { at_bar.a[i] };
                base_bar.a[i] = (base_bar.a[i] + of_elements) + constraint_bar.a[i];
                base_bar.v[i] = (base_bar.v[i] + at_bar.v[i]) + constraint_bar.v[i];
                base_bar.q[i] = (base_bar.q[i] + at_bar.q[i]) + constraint_bar.q[i];
            }
        }
        self.unknowns = unknowns;
        Ok(base_bars)
    }

    /// lambda with J^T lambda = -x_bar for each x_bar, with the matrix factored last.
    fn solve<'b>(&mut self, bars: impl Iterator<Item = &'b SolutionBar>) -> Vec<Adjoints> {
        let system = &*self.system.clone();
        let (mut all, mut count) = (Vec::new(), 0);
        for bar in bars {
            count += 1;
            let first = all.len();
            all.resize(first + system.size(), 0.0);
            let reduced = &mut all[first..];
            self.jacobian.restrict_right(system, &bar.x, &bar.rate, reduced);
            for (place, mu) in system.multiplier_places().iter().zip(&bar.mu) {
                if let Some(place) = *place {
                    reduced[place] = *mu;
                }
            }
            reduced.iter_mut().for_each(|value| *value = -*value);
        }
        self.factorization.solve_transposed(&mut all);
        let adjoints = |reduced: &[f64]| {
            let mut adjoints = Adjoints::zeros(system);
            self.jacobian.prolong_left(system, reduced, &mut adjoints.f, &mut adjoints.y);
            let places = system.multiplier_places().iter().zip(&mut adjoints.g);
            for (place, g) in places.chain(system.stabilizer_places().iter().zip(&mut adjoints.g_second)) {
                if let Some(place) = *place {
                    *g = reduced[place];
                }
            }
            adjoints
        };
        (0..count).map(|k| adjoints(&all[k * system.size()..][..system.size()])).collect()
    }

    fn singular_at(&self, Singular { unknown }: Singular, t: f64) -> RunError {
        singular_named(self.system.unknown_name(unknown, &self.jacobian), &format!("adjoint at t = {t} s"))
    }
}

fn product_bars<'b>(at: &'b mut [VectorsAvq<f64>], p: &'b mut [&mut Vec<f64>]) -> Vec<ProductBars<'b>> {
    at.iter_mut().zip(p).map(|(at, p)| ProductBars { at, p: p.as_mut_slice() }).collect()
}

fn singular(unknown: usize, place: &str) -> RunError {
    singular_named(format!("unknown {unknown}"), place)
}

fn singular_named(unknown: String, place: &str) -> RunError {
    let hint = "the motion passes a singular pose: its gradient does not exist there".to_string();
    RunError::Singular { place: place.into(), unknown, hint }
}
