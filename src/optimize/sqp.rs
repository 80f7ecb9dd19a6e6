// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::curvature::Curvature;
use super::escape::Escape;
use super::program::unless_failed;
use super::quadratic::{NoStep, QuadraticProgram, Step, columns};
use super::subproblem::Subproblem;
use super::{Conditions, Evaluations, Gradients, NoValue, Optimizer, Reason, Values};
use nalgebra::{DVector, DVectorView};

/// Sequential quadratic programming within move limits: each iteration minimizes a quadratic model of the Lagrangian on linearized
/// constraints in a box around the point, and takes the step if f + price times the largest violation falls by a share of what the model
/// promises; otherwise the box shrinks, and after good steps it grows.
///
/// Linearized constraints that contradict each other within the box are given the least violation that they allow, and the price is as
/// high as it takes to go there (restoration). Where no step of the first box lessens the violation, the search goes on from a point of less
/// violation among some that fill the bounds evenly; the end is a minimum of the violation only if there is none. A step that curved constraints spoil is corrected once. A point without values is one of infinite merit. Bounds are never left. What ends at a
/// point is held against [`Conditions`], which know nothing of the model.
///
/// Source: Powell (1978) (update); Fletcher (1987), section 14.4 (exact penalty in a trust region); Byrd, Nocedal & Waltz (2008),
/// "Steering exact penalty methods" (price); Nocedal & Wright (2006), sections 18.3 and 18.5.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sqp;

/// Move limit of the first step, as a share of the range of a variable.
const FIRST_STEP: f64 = 0.2;
/// Range of a variable without bounds, by its size.
const UNBOUNDED: f64 = 5.0;
/// Share of the predicted decrease that a step must bring: Nocedal & Wright, section 3.1.
const TAKEN: f64 = 1e-4;
/// Share with which the box grows, by how much, and of a step to a point without values what is tried next: Nocedal & Wright, algorithm 4.1.
const GOOD: f64 = 0.75;
const SHORTER: f64 = 0.25;
const LONGER: f64 = 2.0;
/// Points tried from one point.
const TRIALS: usize = 16;
/// Share of [`Stopping::change`](super::Stopping) below which a predicted change says that the point may be optimal.
const OPTIMAL_SHARE: f64 = 1e-3;
/// An objective smaller than this, in its scale, is as good as zero.
const SMALL_OBJECTIVE: f64 = 1e-6;
/// Share of the best reduction of the violation that a priced step must bring.
const STEERED: f64 = 0.5;
/// Share of the violation that a step of the first box must take away; less is none.
const STATIONARY: f64 = 1e-3;
/// Least price of the violation, and the largest.
const PRICES: [f64; 2] = [1.0, 1e8];

/// Where the method stands.
struct State {
    x: Vec<f64>,
    values: Values,
    gradients: Gradients,
    curvature: Curvature,
    /// Of the largest violation in the merit.
    price: f64,
    /// Half the side of the box, as a share of the ranges.
    reach: f64,
    ranges: Vec<f64>,
}

/// A better point, and the multipliers of the step that led there.
struct BetterPoint {
    x: Vec<f64>,
    values: Values,
    gradients: Gradients,
    multipliers: Vec<f64>,
}

/// What came of a trial point.
enum TrialResult {
    Taken(Values, Gradients, Vec<f64>),
    Worse(Values),
    Failed,
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
        let range = |((lower, upper), x): (&(f64, f64), &f64)| match upper - lower {
            range if range.is_finite() => range,
            _ => UNBOUNDED * x.abs().max(1.0),
        };
        let ranges = evaluations.bounds().iter().zip(start).map(range).collect();
        let curvature = Curvature::of_size(0, 1.0);
        let (x, price, reach) = (start.to_vec(), PRICES[0], FIRST_STEP);
        let mut state = State { x, values, gradients, curvature, price, reach, ranges };
        state.forget();
        // points that are reached have values
        iterations(evaluations, &mut state).unwrap_or(Reason::Stopped)
    }
}

fn iterations(evaluations: &mut Evaluations, state: &mut State) -> Result<Reason, NoValue> {
    let mut end = evaluations.accept(&state.x)?;
    let mut escape = Escape::new(state.x.len());
    while end.is_none() {
        let violation = evaluations.violation(&state.values);
        let satisfied = violation <= evaluations.stopping().violation;
        let conditions = state.conditions(evaluations);
        let direction = state.direction(evaluations, state.reach, &state.values.constraints);
        if !satisfied && state.is_stationary(evaluations, violation) {
            match state.go_on_elsewhere(evaluations, &mut escape)? {
                true => end = evaluations.accept(&state.x)?,
                false => return Ok(Reason::Infeasible),
            }
            continue;
        }
        let size = state.values.objective.abs().max(SMALL_OBJECTIVE);
        let small = OPTIMAL_SHARE * evaluations.stopping().change * size;
        let step = match direction {
            Some(direction) if conditions.hold() && state.first_order(&direction) <= small => return Ok(Reason::Optimal),
            Some(direction) => state.search(evaluations, direction)?,
            None => None,
        };
        match step {
            Some(BetterPoint { x, values, gradients, multipliers }) => {
                state.learn(&x, &gradients, &multipliers);
                (state.x, state.values, state.gradients) = (x, values, gradients);
                end = evaluations.accept(&state.x)?;
            }
            None if conditions.hold() => return Ok(Reason::Optimal),
            None if state.curvature.is_new() => match !satisfied && state.go_on_elsewhere(evaluations, &mut escape)? {
                true => end = evaluations.accept(&state.x)?,
                false => return Ok(Reason::Stalled),
            },
            None => state.forget(),
        }
    }
    Ok(end.unwrap_or(Reason::Stalled))
}

impl State {
    /// Forgets what was learned of curvatures: the first step is then one of the first box.
    fn forget(&mut self) {
        let steepest = self.gradients.objective.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
        self.curvature = Curvature::of_size(self.x.len(), (steepest / FIRST_STEP).max(1.0));
        self.reach = FIRST_STEP;
    }

    /// Begins anew at a point of less violation somewhere within the bounds, if there is one among some that fill these evenly.
    fn go_on_elsewhere(&mut self, evaluations: &mut Evaluations, escape: &mut Escape) -> Result<bool, NoValue> {
        let here = (&self.x[..], &self.values, &self.gradients);
        let Some((x, values, gradients)) = escape.from(evaluations, here, &self.ranges)? else { return Ok(false) };
        (self.x, self.values, self.gradients, self.price) = (x, values, gradients, PRICES[0]);
        self.forget();
        Ok(true)
    }

    fn conditions(&self, evaluations: &Evaluations) -> Conditions {
        evaluations.conditions(&self.x, &self.values, &self.gradients)
    }

    /// df/dx . d.
    fn slope(&self, step: &DVector<f64>) -> f64 {
        DVectorView::from_slice(&self.gradients.objective, step.len()).dot(step)
    }

    /// What the first-order model says that a step and the constraints' values still weigh.
    fn first_order(&self, direction: &Step) -> f64 {
        let products = direction.multipliers.iter().zip(&self.values.constraints).map(|(m, c)| (m * c).abs());
        self.slope(&direction.step).abs() + products.sum::<f64>()
    }

    fn subproblem(&self, evaluations: &Evaluations, reach: f64, offsets: &[f64]) -> Subproblem {
        let limits = evaluations.bounds().iter().zip(&self.x).zip(&self.ranges);
        let (lower, upper) =
            limits.map(|(((low, high), x), range)| ((low - x).max(-reach * range), (high - x).min(reach * range))).unzip();
        let program = QuadraticProgram {
            hessian: self.curvature.matrix.clone(),
            gradient: self.gradients.objective.clone().into(),
            normals: columns(self.x.len(), &self.gradients.constraints),
            offsets: offsets.to_vec(),
            kinds: evaluations.constraints().to_vec(),
            lower,
            upper,
        };
        Subproblem { program, linear_from: evaluations.linear_from() }
    }

    /// The minimum of the model in a box, on linearized constraints of the values `offsets` or as near to these as they allow.
    fn direction(&self, evaluations: &Evaluations, reach: f64, offsets: &[f64]) -> Option<Step> {
        let problem = self.subproblem(evaluations, reach, offsets);
        match problem.program.solve() {
            Ok(direction) => return Some(direction),
            Err(NoStep::IllConditioned) if offsets.is_empty() => return None,
            Err(_) => {}
        }
        let violation = super::evaluations::violation(evaluations.constraints(), offsets);
        let nearest = problem.restoration(violation)?;
        let wanted = STEERED * (violation - nearest.left);
        let mut price = self.price;
        while price <= PRICES[1] {
            match problem.priced(price, violation) {
                Some(direction) if violation - direction.left >= wanted => return Some(direction),
                _ => price *= 10.0,
            }
        }
        Some(nearest)
    }

    /// Whether no step of the first box lessens the largest violation to first order.
    fn is_stationary(&self, evaluations: &Evaluations, violation: f64) -> bool {
        let problem = self.subproblem(evaluations, FIRST_STEP, &self.values.constraints);
        problem.restoration(violation).is_some_and(|direction| violation - direction.left <= STATIONARY * violation)
    }

    /// f + price times the largest violation.
    fn merit(&self, evaluations: &Evaluations, values: &Values) -> f64 {
        values.objective + self.price * evaluations.violation(values)
    }

    /// Decrease of the merit that the model promises; the price follows what the step needs.
    fn promised(&mut self, violation: f64, direction: &Step) -> f64 {
        let own: f64 = direction.multipliers.iter().map(|multiplier| multiplier.abs()).sum();
        self.price = PRICES[0].max(1.5 * own).max(0.5 * (self.price + 1.5 * own)).min(PRICES[1]);
        let of_objective = -self.slope(&direction.step) - 0.5 * self.curvature.along(&direction.step);
        let restored = violation - direction.left;
        if restored > 0.0 && of_objective + self.price * restored < 0.5 * self.price * restored {
            self.price = (-2.0 * of_objective / restored).max(self.price);
        }
        of_objective + self.price * restored
    }

    /// A better point, tried along steps in boxes that shrink.
    fn search(&mut self, evaluations: &mut Evaluations, mut direction: Step) -> Result<Option<BetterPoint>, NoValue> {
        let violation = evaluations.violation(&self.values);
        for trial in 0..TRIALS {
            let promised = self.promised(violation, &direction);
            let here = self.merit(evaluations, &self.values);
            let size = self.values.objective.abs() + self.price * violation;
            let x = self.along(evaluations, &direction.step);
            if !(promised > crate::tolerances::ROUND_OFF * size) || x == self.x {
                return Ok(None);
            }
            let share = self.share(&direction.step);
            match self.taken(evaluations, x, here - TAKEN * promised)? {
                TrialResult::Taken(values, gradients, x) => {
                    let good = here - self.merit(evaluations, &values) >= GOOD * promised;
                    if good && share > 0.5 * self.reach {
                        self.reach *= LONGER;
                    }
                    return Ok(Some(BetterPoint { x, values, gradients, multipliers: direction.multipliers }));
                }
                TrialResult::Failed => self.reach = SHORTER * share,
                TrialResult::Worse(values) => {
                    if trial == 0 && self.price * (evaluations.violation(&values) - direction.left) > 0.5 * promised {
                        // curved constraints: the same linearization, set right by their values at the full step
                        let normals = columns(self.x.len(), &self.gradients.constraints);
                        let offsets = DVector::from(values.constraints.clone()) - normals.tr_mul(&direction.step);
                        if let Some(corrected) = self.direction(evaluations, self.reach, offsets.as_slice()) {
                            let x = self.along(evaluations, &corrected.step);
                            let limit = here - TAKEN * promised;
                            if let TrialResult::Taken(values, gradients, x) = self.taken(evaluations, x, limit)? {
                                return Ok(Some(BetterPoint { x, values, gradients, multipliers: direction.multipliers }));
                            }
                        }
                    }
                    // the minimum of the parabola through both merits and the slope
                    let lost = self.merit(evaluations, &values) - here;
                    self.reach = share * (0.5 * promised / (lost + promised)).clamp(0.1, 0.5);
                }
            }
            match self.direction(evaluations, self.reach, &self.values.constraints) {
                Some(shorter) => direction = shorter,
                None => return Ok(None),
            }
        }
        Ok(None)
    }

    /// The longest part of a step as a share of the ranges.
    fn share(&self, step: &DVector<f64>) -> f64 {
        step.iter().zip(&self.ranges).fold(0.0, |most: f64, (d, range)| most.max(d.abs() / range.max(f64::MIN_POSITIVE)))
    }

    fn along(&self, evaluations: &Evaluations, step: &DVector<f64>) -> Vec<f64> {
        let place = |((x, &d), (lower, upper)): ((&f64, &f64), &(f64, f64))| match d {
            // to the last digit
            d if d == lower - x => *lower,
            d if d == upper - x => *upper,
            d => (x + d).clamp(*lower, *upper),
        };
        self.x.iter().zip(step).zip(evaluations.bounds()).map(place).collect()
    }

    /// Tries a point: it is taken if its merit is at most `limit` and it has gradients.
    fn taken(&self, evaluations: &mut Evaluations, x: Vec<f64>, limit: f64) -> Result<TrialResult, NoValue> {
        let Some(values) = unless_failed(evaluations.values(&x))? else { return Ok(TrialResult::Failed) };
        if !(self.merit(evaluations, &values) <= limit) {
            return Ok(TrialResult::Worse(values));
        }
        let gradients = unless_failed(evaluations.gradients(&x))?;
        Ok(gradients.map_or(TrialResult::Failed, |gradients| TrialResult::Taken(values, gradients, x)))
    }

    /// Learns what a step says about the curvature of the Lagrangian.
    fn learn(&mut self, x: &[f64], gradients: &Gradients, multipliers: &[f64]) {
        let of_lagrangian = |Gradients { objective, constraints }: &Gradients| {
            DVector::from(objective.clone())
                + columns(x.len(), constraints) * DVectorView::from_slice(multipliers, multipliers.len())
        };
        let step = DVector::from_fn(x.len(), |i, _| x[i] - self.x[i]);
        self.curvature.learn(step, of_lagrangian(gradients) - of_lagrangian(&self.gradients));
    }
}
