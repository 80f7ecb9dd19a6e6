//! One sweep back over the tables, for every integrator and every constraint level.
//!
//! Forward, a run is a chain of linear combinations and of systems F(X; base, p) = 0. Backwards, every system with the
//! adjoint X_bar of its solution solves (dF/dX)^T lambda = -X_bar and passes (dF/dbase)^T lambda and (dF/dp)^T lambda on.

use crate::assembly::{Adjoints, Jacobian, Residual, System, VectorsAvq};
use crate::design::ModelNumbers;
use crate::functionals::{Functional, Over, Sample};
use crate::history::History;
use crate::integrators::{
    Carried, Combination, ConstraintLevel, Counters, Method, Problem, RunError, SolveRecord, StartPlan, StepRecord, Table,
};
use crate::linalg::Factorization;

/// Gradients with respect to parameters and initial state, one for each functional, and the work done.
#[derive(Clone, Debug)]
pub struct AdjointRun {
    /// df/dp, df/dq0, df/dv0 for each functional.
    pub gradients: Vec<ModelNumbers<f64>>,
    /// Work done.
    pub counters: Counters,
}

/// Adjoint of the solution of one system, for one functional.
#[derive(Clone, Debug)]
struct SolutionBar {
    x: Vec<f64>,
    /// Of the rate correction w = beta y; empty unless stabilized.
    rate: Vec<f64>,
    mu: Vec<f64>,
}

impl SolutionBar {
    fn zeros(dofs: usize, multipliers: usize, rates: bool) -> Self {
        SolutionBar { x: vec![0.0; dofs], rate: vec![0.0; if rates { dofs } else { 0 }], mu: vec![0.0; multipliers] }
    }
    fn is_zero(&self) -> bool {
        self.x.iter().chain(&self.rate).chain(&self.mu).all(|&bar| bar == 0.0)
    }
}

/// What goes backwards from step to step, for one functional.
struct Backward {
    carried: Vec<Vec<f64>>,
    /// Of the rate correction carried into an explicit first stage.
    rate: Vec<f64>,
    /// Of the acceleration and multipliers carried into an explicit first stage.
    mu: Vec<f64>,
    p: Vec<f64>,
}

/// Solves transposed systems of one numbering; several functionals share each factorization.
struct TransposedSolver<'m> {
    system: &'m System<'m>,
    residual: Residual<f64>,
    jacobian: Jacobian,
    factorization: Factorization,
}

impl<'m> TransposedSolver<'m> {
    fn new(system: &'m System<'m>, method: &Method) -> Result<Self, RunError> {
        let factorization =
            Factorization::new(&system.pattern, method.backend).map_err(|s| singular(s.unknown, "adjoint"))?;
        Ok(TransposedSolver { system, residual: Residual::new(system), jacobian: Jacobian::new(system), factorization })
    }

    /// Goes back through one system; returns the adjoint of its base point for each functional and adds to `p_bar`.
    fn through(
        &mut self,
        record: &SolveRecord<f64>,
        p: &[f64],
        bars: &[SolutionBar],
        back: &mut [Backward],
        counters: &mut Counters,
    ) -> Result<Vec<VectorsAvq<f64>>, RunError> {
        let system = self.system;
        let dofs = system.model.dofs;
        let mut base_bars = vec![VectorsAvq::zeros(dofs); bars.len()];
        if bars.iter().all(SolutionBar::is_zero) {
            return Ok(base_bars);
        }
        let SolveRecord { t, equations, base, unknowns } = record;
        // evaluated anew: the multipliers inside nodes follow from the solution
        let mut unknowns = unknowns.clone();
        self.residual.start(system, equations, base, p, *t);
        self.residual.evaluate(system, equations, base, &mut unknowns, p, *t);
        self.jacobian.assemble(system, equations, &self.residual, &unknowns, p, *t);
        self.factorization.factor(&self.jacobian.values).map_err(|singular_at| {
            singular_named(system.unknown_name(singular_at.unknown, &self.jacobian), &format!("adjoint at t = {t} s"))
        })?;
        counters.systems += 1;
        counters.residuals += 1;
        counters.factorizations += 1;

        for ((bar, back), base_bar) in bars.iter().zip(back).zip(&mut base_bars) {
            if bar.is_zero() {
                continue;
            }
            let beta = equations.residual.beta;
            let y_bar: Vec<f64> = bar.rate.iter().map(|rate| rate * beta).collect();
            let mut reduced = vec![0.0; system.size()];
            self.jacobian.restrict_right(system, &bar.x, &y_bar, &mut reduced);
            for (place, mu) in system.multiplier_places().iter().zip(&bar.mu) {
                if let Some(place) = *place {
                    reduced[place] = *mu;
                }
            }
            reduced.iter_mut().for_each(|value| *value = -*value);
            self.factorization.solve_transposed(&mut reduced);
            counters.solves += 1;
            let mut adjoints = Adjoints::zeros(system);
            self.jacobian.prolong_left(system, &reduced, &mut adjoints.f, &mut adjoints.y);
            let places = system.multiplier_places().iter().zip(&mut adjoints.g);
            for (place, g) in places.chain(system.stabilizer_places().iter().zip(&mut adjoints.g_second)) {
                if let Some(place) = *place {
                    *g = reduced[place];
                }
            }

            counters.products += 1;
            let (mut at_bar, mut constraint_bar) = (VectorsAvq::zeros(dofs), VectorsAvq::zeros(dofs));
            let (at, constraint_at) = (&self.residual.at, &self.residual.constraint_at);
            system.add_element_products(&adjoints.f, at, p, *t, &mut at_bar, &mut back.p);
            if equations.metric {
                let negative: Vec<f64> = adjoints.f.iter().map(|f| -f).collect();
                system.add_element_products(&negative, base, p, *t, base_bar, &mut back.p);
            }
            system.add_constraint_products(
                equations,
                &adjoints,
                &unknowns,
                constraint_at,
                p,
                *t,
                &mut constraint_bar,
                &mut back.p,
            );
            system.add_local_products(false, equations, &adjoints, &unknowns, constraint_at, *t, &mut constraint_bar);
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
            let unbalanced_y: Vec<f64> = y_bar.iter().enumerate().map(|(i, y)| y + adjoints.y[i] + alpha_part(i)).collect();
            system.set_local_adjoints(equations, constraint_at, *t, &unbalanced_x, &unbalanced_y, &mut adjoints);
            system.add_local_products(true, equations, &adjoints, &unknowns, constraint_at, *t, &mut constraint_bar);
            for i in 0..dofs {
                base_bar.a[i] += at_bar.a[i] + constraint_bar.a[i];
                base_bar.v[i] += at_bar.v[i] + constraint_bar.v[i];
                base_bar.q[i] += at_bar.q[i] + constraint_bar.q[i];
            }
        }
        Ok(base_bars)
    }
}

fn singular(unknown: usize, place: &str) -> RunError {
    singular_named(format!("unknown {unknown}"), place)
}

fn singular_named(unknown: String, place: &str) -> RunError {
    let hint = "the motion passes a singular pose: its gradient does not exist there".to_string();
    RunError::Singular { place: place.into(), unknown, hint }
}

fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    if factor != 0.0 {
        target.iter_mut().zip(values).for_each(|(target, value)| *target += factor * value);
    }
}

/// Transposed linear combination: distributes the adjoint of a vector of `order` time derivatives.
fn distribute(
    table: &Table,
    order: i32,
    combination: &Combination,
    h: f64,
    bar: &[f64],
    carried: &mut [Vec<f64>],
    stages: &mut [SolutionBar],
) {
    for ((target, kind), coefficient) in carried.iter_mut().zip(&table.carried).zip(&combination.carried) {
        add(target, coefficient * h.powi(kind.order() - order), bar);
    }
    for (target, coefficient) in stages.iter_mut().zip(&combination.stages) {
        add(&mut target.x, coefficient * h.powi(2 - order), bar);
    }
}

/// Discrete adjoint of a recorded run for several functionals at once; `values` are theirs in that run.
///
/// # Errors
/// [`RunError::Singular`] if the motion passes a pose in which a system is singular; [`RunError::Input`] without a history.
pub fn adjoint(
    problem: &Problem<f64>,
    method: &Method,
    plan: &StartPlan,
    history: &History<f64>,
    functionals: &[Functional],
    values: &[f64],
) -> Result<AdjointRun, RunError> {
    let model = problem.model;
    let plain = System::new(model, method.system_options(&plan.dropped, false));
    let stabilized = method.level == ConstraintLevel::Velocity && plain.is_constrained();
    let with_rates = stabilized.then(|| System::new(model, method.system_options(&plan.dropped, true)));
    let mut sweep = Sweep {
        problem,
        table: &method.table,
        history,
        functionals,
        values,
        duration: history.duration(),
        stage: TransposedSolver::new(with_rates.as_ref().unwrap_or(&plain), method)?,
        other: TransposedSolver::new(&plain, method)?,
        counters: Counters::default(),
    };
    sweep.run()
}

struct Sweep<'m> {
    problem: &'m Problem<'m, f64>,
    table: &'m Table,
    history: &'m History<f64>,
    functionals: &'m [Functional],
    values: &'m [f64],
    duration: f64,
    stage: TransposedSolver<'m>,
    other: TransposedSolver<'m>,
    counters: Counters,
}

impl Sweep<'_> {
    fn run(&mut self) -> Result<AdjointRun, RunError> {
        let model = self.problem.model;
        let zeros = || vec![0.0; model.dofs];
        let multipliers = self.other.system.multipliers();
        let rates = if self.stage.system.options.stabilized { model.dofs } else { 0 };
        let mut back: Vec<Backward> = self
            .functionals
            .iter()
            .map(|_| Backward {
                carried: self.table.carried.iter().map(|_| zeros()).collect(),
                rate: vec![0.0; rates],
                mu: vec![0.0; multipliers],
                p: vec![0.0; model.parameters],
            })
            .collect();
        for index in (0..self.history.steps.len()).rev() {
            self.step(index, &mut back)?;
        }
        let missing = || RunError::Input("the run kept no history: a gradient needs one".into());
        let start = self.history.start.as_ref().ok_or_else(missing)?;
        let bars = self.start_bars(&mut back);
        self.acceleration(&start.acceleration, bars, &mut back)?;
        for (solve, place) in [(&start.velocity_projection, 1), (&start.position_projection, 0)] {
            if let Some(record) = solve {
                let bars: Vec<SolutionBar> = back
                    .iter()
                    .map(|back| SolutionBar { x: back.carried[place].clone(), rate: Vec::new(), mu: vec![0.0; multipliers] })
                    .collect();
                let bases = self.other.through(record, &self.problem.p, &bars, &mut back, &mut self.counters)?;
                for (back, base) in back.iter_mut().zip(bases) {
                    add(&mut back.carried[0], 1.0, &base.q);
                    add(&mut back.carried[1], 1.0, &base.v);
                }
            }
        }
        let gradients = back
            .into_iter()
            .map(|mut back| {
                let v = std::mem::take(&mut back.carried[1]);
                ModelNumbers { p: back.p, q: std::mem::take(&mut back.carried[0]), v }
            })
            .collect();
        Ok(AdjointRun { gradients, counters: self.counters })
    }

    /// Adds the gradient of functional `k` at a sample; returns the adjoints of (a, v, q) and mu.
    fn measure(&self, k: usize, sample: &Sample<f64>, factor: f64, p_bar: &mut [f64]) -> (VectorsAvq<f64>, Vec<f64>) {
        let model = self.problem.model;
        let mut at_bar = VectorsAvq::zeros(model.dofs);
        let mut mu_bar = vec![0.0; sample.mu.len()];
        if factor != 0.0 {
            let measured = &self.functionals[k].measured;
            measured.add_gradient(model, sample, &self.problem.p, factor, &mut at_bar, &mut mu_bar, p_bar);
        }
        (at_bar, mu_bar)
    }

    /// Adjoint of the first acceleration: what the first step carried over, and initial functionals.
    fn start_bars(&self, back: &mut [Backward]) -> Vec<SolutionBar> {
        let mut bars = take_carried_acceleration(self.table, back);
        if let Some(sample) = self.history.initial_sample() {
            for (k, (bar, back)) in bars.iter_mut().zip(back).enumerate() {
                if self.functionals[k].over == Over::Initial {
                    let (at, mu) = self.measure(k, &sample, 1.0, &mut back.p);
                    add(&mut back.carried[0], 1.0, &at.q);
                    add(&mut back.carried[1], 1.0, &at.v);
                    add(&mut bar.x, 1.0, &at.a);
                    add(&mut bar.mu, 1.0, &mu);
                }
            }
        }
        bars
    }

    /// Back through an acceleration that was solved for given (q, v).
    fn acceleration(
        &mut self,
        record: &SolveRecord<f64>,
        bars: Vec<SolutionBar>,
        back: &mut [Backward],
    ) -> Result<(), RunError> {
        let bases = self.other.through(record, &self.problem.p, &bars, back, &mut self.counters)?;
        for (back, base) in back.iter_mut().zip(bases) {
            add(&mut back.carried[0], 1.0, &base.q);
            add(&mut back.carried[1], 1.0, &base.v);
        }
        Ok(())
    }

    fn step(&mut self, index: usize, back: &mut [Backward]) -> Result<(), RunError> {
        let table = self.table;
        let history = self.history;
        let step = &history.steps[index];
        let dofs = self.problem.model.dofs;
        let (multipliers, rates) = (self.other.system.multipliers(), self.stage.system.options.stabilized);
        let last = table.stages.len() - 1;
        let mut stages: Vec<Vec<SolutionBar>> =
            back.iter().map(|_| vec![SolutionBar::zeros(dofs, multipliers, rates); table.stages.len()]).collect();
        // what the next step's explicit first stage took over from this step's last one
        for (stages, back) in stages.iter_mut().zip(back.iter_mut()) {
            add(&mut stages[last].mu, 1.0, &std::mem::replace(&mut back.mu, vec![0.0; multipliers]));
            let length = back.rate.len();
            add(&mut stages[last].rate, 1.0, &std::mem::replace(&mut back.rate, vec![0.0; length]));
        }
        if index + 1 == history.steps.len()
            && let Some(sample) = history.terminal_sample()
        {
            for (k, (stages, back)) in stages.iter_mut().zip(back.iter_mut()).enumerate() {
                if self.functionals[k].over == Over::Terminal {
                    let (at, mu) = self.measure(k, &sample, 1.0, &mut back.p);
                    add(&mut back.carried[0], 1.0, &at.q);
                    add(&mut back.carried[1], 1.0, &at.v);
                    add(&mut stages[last].x, 1.0, &at.a);
                    add(&mut stages[last].mu, 1.0, &mu);
                }
            }
        }
        self.projections(step, back, &mut stages)?;

        // the update
        for (stages, back) in stages.iter_mut().zip(back.iter_mut()) {
            for (stage, weight) in stages.iter_mut().zip(&table.rates[table.stages.len()]) {
                add(&mut stage.rate, step.h * weight, &back.carried[0]);
            }
            let updated: Vec<Vec<f64>> =
                back.carried.iter_mut().map(|bar| std::mem::replace(bar, vec![0.0; dofs])).collect();
            for ((bar, kind), combination) in updated.iter().zip(&table.carried).zip(&table.update) {
                distribute(table, kind.order(), combination, step.h, bar, &mut back.carried, stages);
            }
        }
        for stage in (0..table.stages.len()).rev() {
            self.stage(index, stage, back, &mut stages)?;
        }
        if let Some(restart) = &step.restart {
            let bars = take_carried_acceleration(table, back);
            self.acceleration(restart, bars, back)?;
        }
        Ok(())
    }

    fn projections(
        &mut self,
        step: &StepRecord<f64>,
        back: &mut [Backward],
        stages: &mut [Vec<SolutionBar>],
    ) -> Result<(), RunError> {
        let multipliers = self.other.system.multipliers();
        for (solve, place) in [(&step.velocity_projection, 1), (&step.position_projection, 0)] {
            let Some(record) = solve else { continue };
            let shift = record.equations.constraint;
            let factor = if place == 1 { shift.beta } else { shift.alpha };
            let bars: Vec<SolutionBar> = back
                .iter()
                .map(|back| {
                    let x = back.carried[place].iter().map(|bar| factor * bar).collect();
                    SolutionBar { x, rate: Vec::new(), mu: vec![0.0; multipliers] }
                })
                .collect();
            let bases = self.other.through(record, &self.problem.p, &bars, back, &mut self.counters)?;
            for ((back, base), stages) in back.iter_mut().zip(bases).zip(stages.iter_mut()) {
                add(&mut back.carried[0], 1.0, &base.q);
                add(&mut back.carried[1], 1.0, &base.v);
                if let Some(last) = stages.last_mut() {
                    add(&mut last.x, 1.0, &base.a);
                }
            }
        }
        Ok(())
    }

    fn stage(
        &mut self,
        index: usize,
        stage: usize,
        back: &mut [Backward],
        stages: &mut [Vec<SolutionBar>],
    ) -> Result<(), RunError> {
        let (table, history) = (self.table, self.history);
        let step = &history.steps[index];
        let record = &step.stages[stage];
        let shift = record.solve.equations.residual;
        let sample = history.stage_sample(table, index, stage);
        // functionals read (a, v, q) of the stage: the base directly, x through the shift
        let mut base_bars = Vec::with_capacity(back.len());
        for (k, (back, stages)) in back.iter_mut().zip(stages.iter_mut()).enumerate() {
            let functional = &self.functionals[k];
            let factor =
                functional.stage_factor(self.problem.model, &sample, &self.problem.p, self.values[k], self.duration);
            let (at, mu) = self.measure(k, &sample, factor, &mut back.p);
            let own = &mut stages[stage];
            add(&mut own.mu, 1.0, &mu);
            add(&mut own.x, shift.gamma, &at.a);
            add(&mut own.x, shift.beta, &at.v);
            add(&mut own.x, shift.alpha, &at.q);
            // alpha y = beta (beta y): the rate correction moves q by h a_ii w
            add(&mut own.rate, shift.beta, &at.q);
            base_bars.push(at);
        }
        if let Some(place) = record.known {
            for (back, stages) in back.iter_mut().zip(stages.iter_mut()) {
                let own = std::mem::replace(&mut stages[stage], SolutionBar::zeros(0, 0, false));
                add(&mut back.carried[place], 1.0, &own.x);
                add(&mut back.mu, 1.0, &own.mu);
                add(&mut back.rate, 1.0, &own.rate);
            }
        } else {
            let bars: Vec<SolutionBar> = stages
                .iter_mut()
                .map(|stages| std::mem::replace(&mut stages[stage], SolutionBar::zeros(0, 0, false)))
                .collect();
            let solved = self.stage.through(&record.solve, &self.problem.p, &bars, back, &mut self.counters)?;
            for (total, base) in base_bars.iter_mut().zip(solved) {
                add(&mut total.a, 1.0, &base.a);
                add(&mut total.v, 1.0, &base.v);
                add(&mut total.q, 1.0, &base.q);
            }
        }
        let relation = &table.stages[stage];
        for ((base, back), stages) in base_bars.iter().zip(back).zip(stages) {
            let (earlier, _) = stages.split_at_mut(stage);
            for (order, combination, bar) in [
                (Carried::A.order(), &relation.a, &base.a),
                (Carried::V.order(), &relation.v, &base.v),
                (Carried::Q.order(), &relation.q, &base.q),
            ] {
                distribute(table, order, combination, step.h, bar, &mut back.carried, earlier);
            }
            for (earlier, weight) in earlier.iter_mut().zip(&table.rates[stage]) {
                add(&mut earlier.rate, step.h * weight, &base.q);
            }
        }
        Ok(())
    }
}

/// Takes out the adjoints of the acceleration and multipliers that were carried into a step and solved for at its start.
fn take_carried_acceleration(table: &Table, back: &mut [Backward]) -> Vec<SolutionBar> {
    let place = table.carried.iter().position(|kind| *kind == Carried::A);
    back.iter_mut()
        .map(|back| {
            let zeros = vec![0.0; back.carried[0].len()];
            let x = match place {
                Some(place) => std::mem::replace(&mut back.carried[place], zeros),
                None => zeros,
            };
            let mu = std::mem::take(&mut back.mu);
            back.mu = vec![0.0; mu.len()];
            SolutionBar { x, rate: Vec::new(), mu }
        })
        .collect()
}
