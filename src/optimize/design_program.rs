use super::evaluations::violation;
use super::optimization::{Optimization, Watcher};
use super::scaling::Scaling;
use super::simulated::{Differentiation, Simulated};
use super::{ConstraintKind, DesignHistory, DesignPoint, Gradients, NoValue, NonlinearProgram, Values, Work};
use crate::exchange::of_first;
use crate::integrators::RunError;
use crate::scenes::{Limit, Sense};
use std::collections::VecDeque;
use std::time::Instant;

/// What to do where a history cannot be gone on with.
const ANEW: &str = "begin anew from its best design with --restart";

/// factor (sum of weights times functionals) + constant.
pub(super) struct Combination {
    pub weights: Vec<(usize, f64)>,
    pub constant: f64,
    pub factor: f64,
}

impl Combination {
    pub fn value(&self, values: &[f64]) -> f64 {
        self.factor * (self.weights.iter().map(|&(index, weight)| weight * values[index]).sum::<f64>() + self.constant)
    }

    /// Its derivatives with respect to its own `n` quantities.
    pub fn slopes(&self, n: usize) -> Vec<f64> {
        let mut slopes = vec![0.0; n];
        self.weights.iter().for_each(|&(index, weight)| slopes[index] += self.factor * weight);
        slopes
    }

    /// Its gradient from those of its quantities.
    fn gradient(&self, rows: &[Vec<f64>]) -> Vec<f64> {
        let columns = rows.first().map_or(0, Vec::len);
        let entry = |j: usize| self.weights.iter().map(|&(index, weight)| weight * rows[index][j]).sum::<f64>();
        (0..columns).map(|j| self.factor * entry(j)).collect()
    }
}

/// Kind of a limit, and the sign with which the quantity enters c.
pub(super) fn sided(limit: Limit) -> (ConstraintKind, f64) {
    match limit {
        Limit::AtMost(_) => (ConstraintKind::AtMostZero, 1.0),
        Limit::AtLeast(_) => (ConstraintKind::AtMostZero, -1.0),
        Limit::Equal(_) => (ConstraintKind::Equality, 1.0),
    }
}

/// The program of a scene's optimization problem: one simulation for the values at a point, one sweep for its gradients.
pub(super) struct DesignProgram<'o, 'w> {
    optimization: &'o Optimization<'o>,
    scaling: Scaling,
    /// Of functionals.
    objective: Combination,
    /// Of functionals.
    nonlinear: Vec<Combination>,
    /// Of scaled variables.
    linear: Vec<Combination>,
    kinds: Vec<ConstraintKind>,
    /// The design that was simulated last.
    latest: Option<Simulated<'o>>,
    /// Times of one rank that each case has taken last; equal before.
    costs: Vec<f64>,
    pub history: DesignHistory,
    /// Points of an earlier run of the same optimization that are still to come, in their order: they are not simulated again.
    recorded: VecDeque<DesignPoint>,
    /// What the last design without values or gradients failed with.
    pub failure: Option<RunError>,
    watcher: &'w mut dyn Watcher,
    /// The watcher wants no more.
    stopped: bool,
}

impl<'o, 'w> DesignProgram<'o, 'w> {
    /// Simulates the start, which gives objective and constraints their scales.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn begin(
        optimization: &'o Optimization<'o>,
        scaling: Scaling,
        linear: Vec<Combination>,
        start: &[f64],
        recorded: Vec<DesignPoint>,
        watcher: &'w mut dyn Watcher,
    ) -> Result<Self, RunError> {
        let problem = &optimization.problem;
        let index = |name: &str| optimization.functionals.iter().position(|known| known.0 == name).unwrap_or_default();
        let weights = problem.objective.iter().map(|(name, weight)| (index(name), *weight)).collect();
        let objective =
            Combination { weights, constant: 0.0, factor: if problem.sense == Sense::Maximize { -1.0 } else { 1.0 } };
        let nonlinear = problem.constraints.iter().map(|constraint| Combination {
            weights: vec![(index(&constraint.functional), 1.0)],
            constant: -constraint.limit.value(),
            factor: sided(constraint.limit).1,
        });
        let kinds = problem.constraints.iter().map(|c| c.limit).chain(problem.linear.iter().map(|c| c.limit));
        let mut program = DesignProgram {
            optimization,
            scaling,
            objective,
            nonlinear: nonlinear.collect(),
            linear,
            kinds: kinds.map(|limit| sided(limit).0).collect(),
            latest: None,
            costs: vec![1.0; optimization.cases.len()],
            history: optimization.history(),
            recorded: recorded.into(),
            failure: None,
            watcher,
            stopped: false,
        };
        let begun = Instant::now();
        program.check_begin(start)?;
        let simulated = program.simulate(start)?;
        let values = &simulated.values;
        let size = |wanted: Option<f64>, natural: &[f64]| {
            wanted.or(natural.iter().map(|n| n.abs()).find(|&n| n > 0.0 && n.is_finite())).unwrap_or(1.0)
        };
        program.objective.factor /= size(problem.scale, &[program.objective.value(values)]);
        for (row, constraint) in program.nonlinear.iter_mut().zip(&problem.constraints) {
            row.factor /= size(constraint.scale, &[constraint.limit.value(), row.value(values)]);
        }
        let y = program.scaling.scaled(start);
        program.check_values(values)?;
        if program.replayed(&y, start).is_some() {
            program.latest = Some(simulated);
            return Ok(program);
        }
        program.keep(&y, start.to_vec(), Ok(simulated), begun.elapsed().as_secs_f64()).ok();
        Ok(program)
    }

    /// Whether the recorded optimization begins with the start, and its points follow from what this one simulates.
    fn check_begin(&self, start: &[f64]) -> Result<(), RunError> {
        let Some(first) = self.recorded.front() else { return Ok(()) };
        if first.design != start {
            let there = &first.design;
            return Err(RunError::Input(format!(
                "the history begins with the design {there:?}, but here it is {start:?}; {ANEW}"
            )));
        }
        let is_other = |point: &&DesignPoint| {
            let [there, here] = [point.fingerprint, self.optimization.fingerprint(&point.design)];
            there != here && !(there.is_nan() && here.is_nan())
        };
        match self.recorded.iter().find(is_other) {
            Some(point) => Err(RunError::Input(format!(
                "evaluation {} of the history follows from other formulas, numbers, methods or settings than it would here: it is of another scene or \
                 version of the program; {ANEW}",
                point.evaluation
            ))),
            None => Ok(()),
        }
    }

    /// Whether the start has the recorded values: the same laws and numbers on the same machine give the same bits.
    fn check_values(&self, values: &[f64]) -> Result<(), RunError> {
        match self.recorded.front() {
            Some(DesignPoint { functionals, .. }) if values != functionals => Err(RunError::Input(format!(
                "the history begins with the functionals {functionals:?}, but here they are {values:?}: it is of another machine; {ANEW}"
            ))),
            _ => Ok(()),
        }
    }

    /// Builds a design and simulates it.
    fn simulate(&mut self, design: &[f64]) -> Result<Simulated<'o>, RunError> {
        let DesignProgram { optimization, watcher, costs, .. } = self;
        optimization.simulate(design, costs, &|| watcher.wants_to_stop())
    }

    fn values_at(&self, y: &[f64], functionals: &[f64]) -> Values {
        let constraints = self.nonlinear.iter().map(|row| row.value(functionals));
        let constraints = constraints.chain(self.linear.iter().map(|row| row.value(y))).collect();
        Values { objective: self.objective.value(functionals), constraints }
    }

    /// Adds a point to the history, makes it the latest one, and tells the watcher.
    fn keep(
        &mut self,
        y: &[f64],
        design: Vec<f64>,
        run: Result<Simulated<'o>, RunError>,
        seconds: f64,
    ) -> Result<Values, NoValue> {
        let mut work = Work { simulation_seconds: seconds, ..Work::default() };
        let nothing = vec![f64::NAN; self.history.functionals.len()];
        let place = self.history.points.len();
        let (functionals, extremes, events, values) = match run {
            Ok(simulated) => {
                simulated.add_counters(&mut work);
                let values = self.values_at(y, &simulated.values);
                let (functionals, extremes) = (simulated.values.clone(), simulated.extremes.clone());
                let events = Some(simulated.events.clone());
                self.latest = Some(simulated);
                (functionals, extremes, events, Ok(values))
            }
            Err(error) => {
                work.simulations = 1;
                self.failure = Some(error);
                (nothing, Vec::new(), None, Err(NoValue::Failed))
            }
        };
        let weighted = |&(index, weight): &(usize, f64)| weight * functionals[index];
        let (objective, violation) = match &values {
            Ok(values) => (self.objective.weights.iter().map(weighted).sum(), violation(&self.kinds, &values.constraints)),
            Err(_) => (f64::NAN, f64::NAN),
        };
        let fingerprint = self.optimization.fingerprint(&design);
        self.history.points.push(DesignPoint {
            evaluation: place,
            iteration: None,
            design,
            functionals,
            extremes,
            events,
            gradients: None,
            objective,
            violation,
            work,
            fingerprint,
        });
        self.notify_watcher();
        values
    }

    fn known_values(&self, y: &[f64], point: &DesignPoint) -> Result<Values, NoValue> {
        if point.failed() { Err(NoValue::Failed) } else { Ok(self.values_at(y, &point.functionals)) }
    }

    /// The values of the next recorded point if it is this one; none is recorded any more once the optimizer goes elsewhere.
    fn replayed(&mut self, y: &[f64], design: &[f64]) -> Option<Result<Values, NoValue>> {
        let point = self.recorded.pop_front()?;
        if point.design != design {
            self.failure = Some(RunError::Input(format!(
                "evaluation {} of the history is at the design {:?}, but this optimization goes to {design:?}: its limits, bounds or optimizer \
                 have changed; {ANEW}",
                point.evaluation, point.design
            )));
            self.stopped = true;
            return Some(Err(NoValue::Stop));
        }
        let values = self.known_values(y, &point);
        self.history.points.push(point);
        Some(values)
    }

    /// Tells the watcher of a change.
    fn notify_watcher(&mut self) {
        let stops = !self.watcher.changed(&self.history) || self.watcher.wants_to_stop();
        // that of the first rank alone has files, whose disk may be full
        self.stopped |= of_first(f64::from(u8::from(stops))) != 0.0;
    }

    /// Functionals whose gradients count: those of the objective, and those near or beyond their limits.
    fn wanted(&self, functionals: &[f64]) -> Vec<bool> {
        let mut wanted = vec![false; functionals.len()];
        let margin = self.optimization.problem.screening.unwrap_or(f64::INFINITY);
        let near = |(row, kind): &(&Combination, &ConstraintKind)| {
            **kind == ConstraintKind::Equality || row.value(functionals) >= -margin
        };
        let limits = self.nonlinear.iter().zip(&self.kinds).filter(near).map(|(row, _)| row);
        for row in limits.chain([&self.objective]) {
            row.weights.iter().for_each(|&(index, _)| wanted[index] = true);
        }
        wanted
    }

    /// Gradients of objective and constraints by `n` scaled variables from those of the functionals.
    fn gradients_of(&self, n: usize, rows: &[Vec<f64>]) -> Gradients {
        let constraints = self.nonlinear.iter().map(|row| self.scaling.gradient(&row.gradient(rows)));
        let constraints = constraints.chain(self.linear.iter().map(|row| row.slopes(n))).collect();
        Gradients { objective: self.scaling.gradient(&self.objective.gradient(rows)), constraints }
    }

    /// What an error means for the optimizer.
    fn failed(&mut self, error: RunError) -> NoValue {
        if matches!(error, RunError::Interrupted { .. }) {
            return NoValue::Stop;
        }
        self.failure = Some(error);
        NoValue::Failed
    }

    /// Place of a design in the history.
    fn place_of(&self, design: &[f64]) -> Option<usize> {
        self.history.points.iter().rposition(|point| point.design == design)
    }

    /// Simulates a design unless its values are known.
    fn simulated(&mut self, y: &[f64]) -> Result<Values, NoValue> {
        if self.stopped || self.watcher.wants_to_stop() {
            return Err(NoValue::Stop);
        }
        let design = self.scaling.design(y);
        if let Some(place) = self.place_of(&design) {
            return self.known_values(y, &self.history.points[place]);
        }
        if let Some(values) = self.replayed(y, &design) {
            return values;
        }
        let begun = Instant::now();
        let run = self.simulate(&design);
        if matches!(run, Err(RunError::Interrupted { .. })) {
            return Err(NoValue::Stop);
        }
        self.keep(y, design, run, begun.elapsed().as_secs_f64())
    }
}

impl NonlinearProgram for DesignProgram<'_, '_> {
    fn bounds(&self) -> Vec<(f64, f64)> {
        self.scaling.bounds()
    }
    fn constraints(&self) -> Vec<ConstraintKind> {
        self.kinds.clone()
    }
    fn linear_from(&self) -> usize {
        self.nonlinear.len()
    }
    fn values(&mut self, y: &[f64]) -> Result<Values, NoValue> {
        self.simulated(y)
    }
    fn gradients(&mut self, y: &[f64]) -> Result<Gradients, NoValue> {
        // an optimizer may have gone on to other points since
        self.simulated(y)?;
        let design = self.scaling.design(y);
        let Some(place) = self.place_of(&design) else { return Err(NoValue::Failed) };
        if let Some(rows) = &self.history.points[place].gradients {
            return Ok(self.gradients_of(y.len(), rows));
        }
        let latest = match self.latest.take().filter(|latest| latest.design == design) {
            Some(latest) => latest,
            // recorded, but without its gradients, or left since: simulated once more
            None => self.simulate(&design).map_err(|error| self.failed(error))?,
        };
        let (begun, mut work) = (Instant::now(), Work::default());
        let (wanted, watcher) = (self.wanted(&latest.values), &self.watcher);
        let how = Differentiation { scaling: &self.scaling, wanted: &wanted, wants_to_stop: &|| watcher.wants_to_stop() };
        let rows = self.optimization.rows(&latest, &how, &mut work);
        work.gradient_seconds = begun.elapsed().as_secs_f64();
        self.history.points[place].work += work;
        // a design that cannot be differentiated is no place to go on from
        let rows = rows.map_err(|error| self.failed(error))?;
        self.history.points[place].gradients = Some(rows.clone());
        self.latest = Some(latest);
        self.notify_watcher();
        Ok(self.gradients_of(y.len(), &rows))
    }
    fn reached(&mut self, y: &[f64], iteration: usize) -> bool {
        if let Some(place) = self.place_of(&self.scaling.design(y)) {
            self.history.points[place].iteration = Some(iteration);
        }
        self.notify_watcher();
        !self.stopped
    }
}
