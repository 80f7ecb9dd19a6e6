// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::quadratic::{NoStep, QuadraticProgram, Step};
use super::{ConstraintKind, Evaluations, Gradients, NoValue, Optimizer, Reason, Values};

/// Sequential quadratic programming: each iteration minimizes a quadratic model of the Lagrangian on linearized constraints, and a
/// line search on f + sum of penalties times violations takes as much of the step as is good.
///
/// The model's matrix is made of steps and the changes of the gradient along them (BFGS) and kept positive definite; until there are as
/// many steps as variables, it has the size of the curvature seen last along directions that no step has taken, so that round-off there, as
/// in a symmetric problem's asymmetry, hardly grows; linearized constraints that contradict each other
/// are relaxed together; a full step that curved constraints spoil is corrected once. A point without values is one of infinite
/// merit, from which the line search steps back. Bounds are never left.
///
/// Source: Powell (1978), "A fast algorithm for nonlinearly constrained optimization calculations" (update, penalties); Kraft (1988),
/// DFVLR-FB 88-28 (relaxation); Nocedal & Wright (2006), sections 18.3 and 18.4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sqp;

/// Longest first step of a variable, in its scale: nothing is known about curvatures yet.
const FIRST_STEP: f64 = 0.2;
/// Share of the predicted decrease that a step must bring.
const ARMIJO: f64 = 1e-4;
/// Share of a step to a point without values that is tried next.
const SHORTER: f64 = 0.25;
/// By how much the longest step grows from search to search after that.
const LONGER: f64 = 2.0;
/// Points tried along one direction.
const TRIALS: usize = 16;
/// Share of [`Stopping::change`](super::Stopping) below which a predicted change says that the point is optimal.
const OPTIMAL_SHARE: f64 = 1e-3;
/// An objective smaller than this, in its scale, is as good as zero.
const SMALL_OBJECTIVE: f64 = 1e-6;
/// Penalty of relaxed constraints: first and last that is tried.
const RELAXATION: [f64; 2] = [1e2, 1e8];

/// Where the method stands.
struct State {
    x: Vec<f64>,
    values: Values,
    gradients: Gradients,
    /// Model of the second derivatives of the Lagrangian.
    hessian: Vec<Vec<f64>>,
    /// The first steps, as many as there are variables, and the changes of the Lagrangian's gradient along them; none: nothing was
    /// learned about curvatures yet.
    learned: Vec<(Vec<f64>, Vec<f64>)>,
    /// Of the constraints' violations in the merit.
    penalties: Vec<f64>,
    /// Longest step of a variable that is tried: finite near points without values, so that not every search runs into them.
    reach: f64,
}

/// A direction, with the share of the violations that the linearized constraints leave.
struct Direction {
    step: Vec<f64>,
    multipliers: Vec<f64>,
    left: f64,
}

impl Optimizer for Sqp {
    fn name(&self) -> &'static str {
        "sqp"
    }
    fn go(&self, evaluations: &mut Evaluations, start: &[f64]) -> Reason {
        let begun = evaluations.values(start).and_then(|values| Ok((values, evaluations.gradients(start)?)));
        let (values, gradients) = match begun {
            Ok(begun) => begun,
            Err(NoValue::Stop) => return Reason::Stopped,
            Err(NoValue::Failed) => return Reason::StartFailed,
        };
        let penalties = vec![0.0; evaluations.constraints().len()];
        let hessian = Vec::new();
        let (x, learned, reach) = (start.to_vec(), Vec::new(), f64::INFINITY);
        let mut state = State { x, values, gradients, hessian, learned, penalties, reach };
        state.forget();
        // points that are reached have values
        iterations(evaluations, &mut state).unwrap_or(Reason::Stopped)
    }
}

fn iterations(evaluations: &mut Evaluations, state: &mut State) -> Result<Reason, NoValue> {
    let kinds = evaluations.constraints().to_vec();
    let mut end = evaluations.accept(&state.x)?;
    while end.is_none() {
        let Some(direction) = state.direction(evaluations, &state.values.constraints) else {
            if state.learned.is_empty() {
                return Ok(Reason::Stalled);
            }
            state.forget();
            continue;
        };
        let satisfied = evaluations.violation(&state.values) <= evaluations.stopping().violation;
        let longest = direction.step.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        if !satisfied && direction.left > 0.99 && longest <= evaluations.stopping().violation {
            return Ok(Reason::Infeasible);
        }
        let predicted = dot(&state.gradients.objective, &direction.step).abs() + complementarity(state, &direction);
        let size = state.values.objective.abs().max(SMALL_OBJECTIVE);
        if satisfied && predicted <= OPTIMAL_SHARE * evaluations.stopping().change * size {
            return Ok(Reason::Optimal);
        }
        for (penalty, multiplier) in state.penalties.iter_mut().zip(&direction.multipliers) {
            *penalty = multiplier.abs().max(0.5 * (*penalty + multiplier.abs()));
        }
        match state.search(evaluations, &kinds, &direction)? {
            Some((x, values, gradients)) => {
                state.learn(&x, &gradients, &direction.multipliers);
                (state.x, state.values, state.gradients) = (x, values, gradients);
                end = evaluations.accept(&state.x)?;
            }
            None if state.learned.is_empty() => return Ok(Reason::Stalled),
            None => state.forget(),
        }
    }
    Ok(end.unwrap_or(Reason::Stalled))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// sum |lambda c|: what the constraints' values still weigh.
fn complementarity(state: &State, direction: &Direction) -> f64 {
    direction.multipliers.iter().zip(&state.values.constraints).map(|(m, c)| (m * c).abs()).sum()
}

/// Violation of one constraint.
fn violation(kind: ConstraintKind, c: f64) -> f64 {
    match kind {
        ConstraintKind::Equality => c.abs(),
        ConstraintKind::AtMostZero => c.max(0.0),
    }
}

impl State {
    /// Sets the matrix to a multiple of the identity from which the first step is short.
    fn forget(&mut self) {
        let n = self.x.len();
        let steepest = self.gradients.objective.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
        let size = (steepest / FIRST_STEP).max(1.0);
        self.learned.clear();
        self.hessian = multiple_of_identity(n, size);
    }

    /// The minimum of the model on linearized constraints of the values `offsets`, relaxed where they contradict each other.
    fn direction(&self, evaluations: &Evaluations, offsets: &[f64]) -> Option<Direction> {
        let bounds = evaluations.bounds().iter().zip(&self.x);
        let (mut lower, mut upper): (Vec<f64>, Vec<f64>) = bounds.map(|((low, high), x)| (low - x, high - x)).unzip();
        let kinds = evaluations.constraints();
        let program = QuadraticProgram {
            hessian: &self.hessian,
            gradient: &self.gradients.objective,
            rows: &self.gradients.constraints,
            offsets,
            kinds,
            lower: &lower,
            upper: &upper,
        };
        match program.solve() {
            Ok(Step { step, multipliers }) => return Some(Direction { step, multipliers, left: 0.0 }),
            Err(NoStep::IllConditioned) => return None,
            Err(NoStep::Infeasible) => {}
        }
        // one more unknown: the share of all violations that is left
        lower.push(0.0);
        upper.push(1.0);
        let n = self.x.len();
        let gradient: Vec<f64> = self.gradients.objective.iter().copied().chain([0.0]).collect();
        let relaxed = |((row, &c), &kind): ((&Vec<f64>, &f64), &ConstraintKind)| -> Vec<f64> {
            let share = if violation(kind, c) > 0.0 { -c } else { 0.0 };
            row.iter().copied().chain([share]).collect()
        };
        let rows: Vec<Vec<f64>> = self.gradients.constraints.iter().zip(offsets).zip(kinds).map(relaxed).collect();
        let mut hessian = self.hessian.clone();
        hessian.iter_mut().for_each(|row| row.push(0.0));
        hessian.push(vec![0.0; n + 1]);
        let largest = (0..n).fold(1.0, |most: f64, i| most.max(self.hessian[i][i]));
        let mut penalty = RELAXATION[0];
        loop {
            hessian[n][n] = penalty * largest;
            let (gradient, rows) = (&gradient[..], &rows[..]);
            let (lower, upper) = (&lower[..], &upper[..]);
            let program = QuadraticProgram { hessian: &hessian, gradient, rows, offsets, kinds, lower, upper };
            let Step { mut step, multipliers } = program.solve().ok()?;
            let left = step.pop()?;
            if left < 0.9 || penalty >= RELAXATION[1] {
                return Some(Direction { step, multipliers, left });
            }
            penalty *= 10.0;
        }
    }

    /// f + sum of penalties times violations.
    fn merit(&self, kinds: &[ConstraintKind], values: &Values) -> f64 {
        let violations = kinds.iter().zip(&values.constraints).map(|(&kind, &c)| violation(kind, c));
        values.objective + violations.zip(&self.penalties).map(|(violation, penalty)| violation * penalty).sum::<f64>()
    }

    /// A better point along a direction, with its values and gradients.
    fn search(
        &mut self,
        evaluations: &mut Evaluations,
        kinds: &[ConstraintKind],
        direction: &Direction,
    ) -> Result<Option<(Vec<f64>, Values, Gradients)>, NoValue> {
        let here = self.merit(kinds, &self.values);
        let penalty = here - self.values.objective;
        let slope = dot(&self.gradients.objective, &direction.step) - (1.0 - direction.left) * penalty;
        if !(slope < 0.0) {
            return Ok(None);
        }
        let longest = direction.step.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        let mut share = (self.reach / longest).min(1.0);
        self.reach *= LONGER;
        for trial in 0..TRIALS {
            let limit = here + ARMIJO * share * slope;
            let x = self.along(evaluations, &direction.step, share);
            if x == self.x {
                return Ok(None);
            }
            let merit = match self.taken(evaluations, kinds, x, limit)? {
                Tried::Taken(values, gradients, x) => return Ok(Some((x, values, gradients))),
                Tried::Failed => {
                    share *= SHORTER;
                    self.reach = share * longest;
                    continue;
                }
                Tried::Worse(merit, constraints) => {
                    if trial == 0 && share == 1.0 && !kinds.is_empty() {
                        // curved constraints: the same linearization, set right by their values at the full step
                        let moved = self.gradients.constraints.iter().zip(&constraints);
                        let offsets: Vec<f64> = moved.map(|(row, c)| c - dot(row, &direction.step)).collect();
                        if let Some(corrected) = self.direction(evaluations, &offsets) {
                            let x = self.along(evaluations, &corrected.step, 1.0);
                            if let Tried::Taken(values, gradients, x) = self.taken(evaluations, kinds, x, limit)? {
                                return Ok(Some((x, values, gradients)));
                            }
                        }
                    }
                    merit
                }
            };
            // the minimum of the parabola through both merits and the slope
            let parabola = -0.5 * slope * share * share / (merit - here - share * slope);
            share = parabola.clamp(0.1 * share, 0.5 * share);
        }
        Ok(None)
    }

    fn along(&self, evaluations: &Evaluations, step: &[f64], share: f64) -> Vec<f64> {
        let place = |((x, d), (lower, upper)): ((&f64, &f64), &(f64, f64))| match share * d {
            // to the last digit
            d if d == lower - x => *lower,
            d if d == upper - x => *upper,
            d => (x + d).clamp(*lower, *upper),
        };
        self.x.iter().zip(step).zip(evaluations.bounds()).map(place).collect()
    }

    /// Tries a point: it is taken if its merit is at most `limit` and it has gradients.
    fn taken(
        &self,
        evaluations: &mut Evaluations,
        kinds: &[ConstraintKind],
        x: Vec<f64>,
        limit: f64,
    ) -> Result<Tried, NoValue> {
        let values = match evaluations.values(&x) {
            Ok(values) => values,
            Err(NoValue::Failed) => return Ok(Tried::Failed),
            Err(stop) => return Err(stop),
        };
        let merit = self.merit(kinds, &values);
        if !(merit <= limit) {
            return Ok(Tried::Worse(merit, values.constraints));
        }
        match evaluations.gradients(&x) {
            Ok(gradients) => Ok(Tried::Taken(values, gradients, x)),
            Err(NoValue::Failed) => Ok(Tried::Failed),
            Err(stop) => Err(stop),
        }
    }

    /// Updates the matrix by what a step says about the curvature of the Lagrangian.
    fn learn(&mut self, x: &[f64], gradients: &Gradients, multipliers: &[f64]) {
        let n = x.len();
        let of_lagrangian = |gradients: &Gradients, i: usize| {
            let rows = gradients.constraints.iter().zip(multipliers);
            gradients.objective[i] + rows.map(|(row, multiplier)| row[i] * multiplier).sum::<f64>()
        };
        let step: Vec<f64> = x.iter().zip(&self.x).map(|(new, old)| new - old).collect();
        let mut change: Vec<f64> = (0..n).map(|i| of_lagrangian(gradients, i) - of_lagrangian(&self.gradients, i)).collect();
        let curvature = dot(&step, &change);
        let modelled = dot(&step, &turned(&self.hessian, &step));
        if !(modelled > 0.0) {
            return;
        }
        if curvature > 0.0 && self.learned.len() < n {
            // along directions that no step has taken yet: the mean of both usual estimates, |y|^2 / s . y and s . y / |s|^2
            let size = (dot(&change, &change) / dot(&step, &step)).sqrt();
            self.hessian = multiple_of_identity(n, size);
            for (step, change) in &self.learned {
                update(&mut self.hessian, step, change);
            }
        }
        let of_model = turned(&self.hessian, &step);
        let modelled = dot(&step, &of_model);
        if curvature < 0.2 * modelled {
            // mixed with the model's own so that the matrix stays positive definite
            let share = 0.8 * modelled / (modelled - curvature);
            for (change, turned) in change.iter_mut().zip(&of_model) {
                *change = share * *change + (1.0 - share) * turned;
            }
        }
        update(&mut self.hessian, &step, &change);
        if self.learned.len() < n {
            self.learned.push((step, change));
        }
    }
}

fn multiple_of_identity(n: usize, size: f64) -> Vec<Vec<f64>> {
    (0..n).map(|i| (0..n).map(|j| if i == j { size } else { 0.0 }).collect()).collect()
}

fn turned(matrix: &[Vec<f64>], step: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, step)).collect()
}

/// Updates a matrix so that it takes a step to a change of the gradient.
fn update(matrix: &mut [Vec<f64>], step: &[f64], change: &[f64]) {
    let turned = turned(matrix, step);
    let (modelled, curvature) = (dot(step, &turned), dot(step, change));
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += change[i] * change[j] / curvature - turned[i] * turned[j] / modelled;
        }
    }
}

/// What came of a trial point.
enum Tried {
    Taken(Values, Gradients, Vec<f64>),
    /// Its merit and its constraints.
    Worse(f64, Vec<f64>),
    Failed,
}
