use super::{Conditions, ConstraintKind, Gradients, NoValue, NonlinearProgram, Values};
use std::fmt;

/// When an optimization ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopping {
    /// Largest relative change of the objective from iteration to iteration that counts as none.
    pub change: f64,
    /// How many iterations in a row must bring no change.
    pub in_a_row: usize,
    /// Most iterations.
    pub iterations: usize,
    /// Largest violation of a constraint, in the scale of the program, that counts as none.
    pub violation: f64,
}

impl Default for Stopping {
    /// Relative change below 1e-6 in five iterations, at most 60 of them.
    ///
    /// Source: Ebrahimi et al. (2019), section 6.
    fn default() -> Self {
        Stopping { change: 1e-6, in_a_row: 5, iterations: 60, violation: 1e-6 }
    }
}

/// Why an optimization ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The objective no longer changes, and the conditions of optimality hold.
    Change,
    /// The conditions of optimality hold.
    Optimal,
    /// The objective no longer changes, but the conditions of optimality do not hold.
    Creeping,
    /// The limit of iterations.
    Iterations,
    /// No better point was found along the search direction: the accuracy of values or gradients is used up.
    Stalled,
    /// The violation of the constraints has a minimum here that is not zero, and an optimizer that looks elsewhere found no less.
    Infeasible,
    /// Someone asked to stop.
    Stopped,
    /// There are no values or gradients at the start.
    StartFailed,
}

impl Reason {
    /// Whether the point reached is taken for an optimum.
    pub fn is_optimum(self) -> bool {
        matches!(self, Reason::Change | Reason::Optimal)
    }
    /// Its name in JSON, and a sentence.
    fn words(self) -> [&'static str; 2] {
        match self {
            Reason::Change => ["no-change", "the objective no longer changes and the conditions of optimality hold"],
            Reason::Optimal => ["optimal", "the conditions of optimality hold"],
            Reason::Creeping => {
                ["no-change-but-no-optimum", "the objective no longer changes, but the conditions of optimality do not hold"]
            }
            Reason::Iterations => ["iterations", "the limit of iterations is reached"],
            Reason::Stalled => {
                ["stalled", "no better point along the search direction: the accuracy of values or gradients is used up"]
            }
            Reason::Infeasible => {
                ["infeasible", "the constraints cannot be satisfied nearby, nor at points tried throughout the bounds"]
            }
            Reason::Stopped => ["stopped", "stopped by request"],
            Reason::StartFailed => ["start-failed", "there is no gradient at the start"],
        }
    }
    /// Name in JSON.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.words()[1])
    }
}

/// A point with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Variables.
    pub x: Vec<f64>,
    /// Objective and constraints.
    pub values: Values,
    /// Largest violation of a constraint.
    pub violation: f64,
}

/// What an optimization did and where it ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Why it ended.
    pub reason: Reason,
    /// The best point of all: that of least objective where the constraints hold, else that of least violation.
    pub best: Option<Point>,
    /// The conditions of optimality at the best point, where its gradients are known.
    pub conditions: Option<Conditions>,
    /// Iterations.
    pub iterations: usize,
    /// Points at which values were computed, failed ones included.
    pub evaluations: usize,
    /// Points at which gradients were computed.
    pub gradients: usize,
    /// Points without values or gradients.
    pub failed: usize,
}

struct EvaluatedPoint {
    x: Vec<f64>,
    values: Result<Values, NoValue>,
    gradients: Option<Result<Gradients, NoValue>>,
}

/// The evaluations of a program: what is known, what is best, when to end. Optimizers work on it.
pub struct Evaluations<'p> {
    program: &'p mut dyn NonlinearProgram,
    stopping: Stopping,
    bounds: Vec<(f64, f64)>,
    kinds: Vec<ConstraintKind>,
    /// Number of the first linear constraint.
    linear_from: usize,
    /// All points, so that an optimizer may ask for objective, constraints and gradients separately.
    known: Vec<EvaluatedPoint>,
    best_gradients: Option<Gradients>,
    /// Objective of the last iteration.
    last: Option<f64>,
    /// Iterations in a row that kept the constraints and changed the objective hardly.
    calm: usize,
    begun: bool,
    ended: Ended,
}

impl<'p> Evaluations<'p> {
    /// Those of a program from its start.
    pub fn new(program: &'p mut dyn NonlinearProgram, stopping: Stopping) -> Self {
        let (bounds, kinds, linear_from) = (program.bounds(), program.constraints(), program.linear_from());
        let (reason, best, conditions) = (Reason::Stopped, None, None);
        let ended = Ended { reason, best, conditions, iterations: 0, evaluations: 0, gradients: 0, failed: 0 };
        let (known, best_gradients, last) = (Vec::new(), None, None);
        Evaluations {
            program,
            stopping,
            bounds,
            kinds,
            linear_from,
            known,
            best_gradients,
            last,
            calm: 0,
            begun: false,
            ended,
        }
    }

    /// Bounds of the variables.
    pub fn bounds(&self) -> &[(f64, f64)] {
        &self.bounds
    }

    /// What the constraints are.
    pub fn constraints(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    /// Number of the first of the linear constraints, which come last.
    pub fn linear_from(&self) -> usize {
        self.linear_from
    }

    /// The conditions of optimality at a point with these values and gradients.
    pub(super) fn conditions(&self, x: &[f64], values: &Values, gradients: &Gradients) -> Conditions {
        Conditions::at((x, &self.bounds), &self.kinds, (values, gradients), &self.stopping)
    }

    /// When it ends.
    pub fn stopping(&self) -> &Stopping {
        &self.stopping
    }

    /// Largest violation of a constraint.
    pub fn violation(&self, values: &Values) -> f64 {
        violation(&self.kinds, &values.constraints)
    }

    /// Objective and constraints.
    ///
    /// # Errors
    /// See [`NoValue`]; a point with a value that is not finite is a failed one.
    pub fn values(&mut self, x: &[f64]) -> Result<Values, NoValue> {
        let place = self.known_place(x)?;
        self.known[place].values.clone()
    }

    /// Gradients of objective and constraints.
    ///
    /// # Errors
    /// As [`Evaluations::values`].
    pub fn gradients(&mut self, x: &[f64]) -> Result<Gradients, NoValue> {
        let place = self.known_place(x)?;
        self.known[place].values.clone()?;
        if let Some(gradients) = &self.known[place].gradients {
            return gradients.clone();
        }
        let gradients = self.program.gradients(x);
        if gradients == Err(NoValue::Stop) {
            return gradients;
        }
        let finite = |g: &Gradients| g.constraints.iter().chain([&g.objective]).flatten().all(|g| g.is_finite());
        let gradients = gradients.and_then(|g| if finite(&g) { Ok(g) } else { Err(NoValue::Failed) });
        self.ended.gradients += 1;
        self.ended.failed += usize::from(gradients.is_err());
        if let (Ok(gradients), true) = (&gradients, self.ended.best.as_ref().is_some_and(|best| best.x == x)) {
            self.best_gradients = Some(gradients.clone());
        }
        self.known[place].gradients = Some(gradients.clone());
        gradients
    }

    fn known_place(&mut self, x: &[f64]) -> Result<usize, NoValue> {
        if x.iter().any(|x| !x.is_finite()) {
            // no point at all
            return Err(NoValue::Failed);
        }
        if let Some(place) = self.known.iter().position(|known| known.x == x) {
            return Ok(place);
        }
        let values = self.program.values(x);
        if values == Err(NoValue::Stop) {
            return Err(NoValue::Stop);
        }
        let finite = |v: &Values| v.constraints.iter().chain([&v.objective]).all(|v| v.is_finite());
        let values = values.and_then(|v| if finite(&v) { Ok(v) } else { Err(NoValue::Failed) });
        self.ended.evaluations += 1;
        match &values {
            Ok(values) => {
                let violation = self.violation(values);
                let point = Point { x: x.to_vec(), values: values.clone(), violation };
                if self.ended.best.as_ref().is_none_or(|best| better(&point, best, self.stopping.violation)) {
                    self.ended.best = Some(point);
                    self.best_gradients = None;
                }
            }
            Err(_) => self.ended.failed += 1,
        }
        self.known.push(EvaluatedPoint { x: x.to_vec(), values, gradients: None });
        Ok(self.known.len() - 1)
    }

    /// An iteration has led to a point, or the start is known: says whether that is the end.
    ///
    /// # Errors
    /// A point without values.
    pub fn accept(&mut self, x: &[f64]) -> Result<Option<Reason>, NoValue> {
        let values = self.values(x)?;
        self.ended.iterations += usize::from(self.begun);
        self.begun = true;
        let (objective, satisfied) = (values.objective, self.violation(&values) <= self.stopping.violation);
        let small = |last: f64| (objective - last).abs() <= self.stopping.change * objective.abs().max(last.abs());
        let calm = satisfied && self.last.is_some_and(small);
        self.calm = if calm { self.calm + 1 } else { 0 };
        self.last = Some(objective);
        Ok(if !self.program.reached(x, self.ended.iterations) {
            Some(Reason::Stopped)
        } else if self.calm >= self.stopping.in_a_row {
            Some(Reason::Change)
        } else if self.ended.iterations >= self.stopping.iterations {
            Some(Reason::Iterations)
        } else {
            None
        })
    }

    /// The end, at the best point of all, whatever the optimizer took for its last one: what it claims is held against the conditions of
    /// optimality there.
    pub fn end(mut self, reason: Reason) -> Ended {
        let best = self.ended.best.clone();
        if let (Some(best), None, false) = (&best, &self.best_gradients, reason == Reason::Stopped) {
            // a trial point may be better than those that were taken
            self.gradients(&best.x).ok();
        }
        let conditions = best.zip(self.best_gradients.as_ref());
        let conditions = conditions.map(|(best, gradients)| self.conditions(&best.x, &best.values, gradients));
        let reason = match (reason, conditions.as_ref().is_some_and(Conditions::hold)) {
            (Reason::Change, false) => Reason::Creeping,
            (Reason::Optimal, false) => Reason::Stalled,
            (Reason::Stalled | Reason::Infeasible, true) => Reason::Optimal,
            (reason, _) => reason,
        };
        Ended { reason, conditions, ..self.ended }
    }
}

/// Largest violation of constraints with the values `c`.
pub(super) fn violation(kinds: &[ConstraintKind], c: &[f64]) -> f64 {
    let violation = |(kind, &c): (&ConstraintKind, &f64)| match kind {
        ConstraintKind::Equality => c.abs(),
        ConstraintKind::AtMostZero => c.max(0.0),
    };
    kinds.iter().zip(c).map(violation).fold(0.0, f64::max)
}

fn better(point: &Point, than: &Point, tolerance: f64) -> bool {
    match (point.violation <= tolerance, than.violation <= tolerance) {
        (true, true) => point.values.objective < than.values.objective,
        (false, false) => point.violation < than.violation,
        (feasible, _) => feasible,
    }
}
