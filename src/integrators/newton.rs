use super::RunError;
use crate::assembly::{Equations, Jacobian, Level, Residual, System, Unknowns, VectorsAvq};
use crate::elements::RunScalar;
use crate::linalg::{Backend, Factorization, Singular};

/// When Newton's method is content.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum NewtonTolerance {
    /// Until the estimated correction is below 1e-14 of the unknowns or corrections no longer shrink: exact gradients.
    #[default]
    RoundOff,
    /// Until the residual is below 1e-9 of the first one or below 1e-12, as in Boopathy & Kennedy.
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

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Systems solved: stages, projections, accelerations.
    pub systems: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Evaluations of the residual of the whole model.
    pub residuals: usize,
    /// Jacobians assembled and factored.
    pub factorizations: usize,
    /// Solutions with a factored matrix, transposed or not.
    pub solves: usize,
    /// Transposed products with all elements (adjoint only).
    pub products: usize,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.systems += other.systems;
        self.iterations += other.iterations;
        self.residuals += other.residuals;
        self.factorizations += other.factorizations;
        self.solves += other.solves;
        self.products += other.products;
    }
}

/// Most iterations for one system.
const MOST_ITERATIONS: usize = 25;
/// Relative correction at which the unknowns are as good as round-off allows.
const ROUND_OFF: f64 = 1e-14;
/// Corrections that shrink less than this ask for a fresh factorization.
const SLOW: f64 = 0.1;
/// Corrections that shrink less than this do not converge any more.
const STALLED: f64 = 0.3;
/// Relative correction that is accepted when corrections stall there, whatever the age of the matrix.
const NEARLY: f64 = 1e-13;
/// Relative correction up to which a guide counts as the solution of the same problem.
const GUIDED: f64 = 1e-6;
/// Share of the largest force below which a stalled residual counts as round-off.
const FORCE_FLOOR: f64 = 1e-10;

/// Newton's method for the systems of one run, keeping its factorization while it converges fast.
pub struct Newton<'m, S> {
    /// The numbered equations.
    pub system: &'m System<'m>,
    /// Evaluations, with their workspace.
    pub residual: Residual<S>,
    /// The matrix.
    pub jacobian: Jacobian,
    /// Work done.
    pub counters: Counters,
    factorization: Factorization,
    tolerance: NewtonTolerance,
    rhs: Vec<f64>,
    /// Equations for which the matrix was factored last.
    factored: Option<Equations>,
    /// Size of corrections at which the last stalled system ended.
    floor: f64,
}

/// Why one system was not solved; the caller knows where in the run it was.
pub struct Failure {
    how: FailureKind,
    iterations: usize,
    correction: f64,
}

enum FailureKind {
    Singular(usize),
    Diverged,
    Stagnated,
    NotFinite,
}

impl<'m, S: RunScalar> Newton<'m, S> {
    /// Workspace for a system.
    ///
    /// # Errors
    /// A pattern that no numbers could make regular.
    pub fn new(system: &'m System<'m>, tolerance: NewtonTolerance, backend: Backend) -> Result<Self, Singular> {
        let factorization = Factorization::new(&system.pattern, backend)?;
        Ok(Newton {
            residual: Residual::new(system),
            jacobian: Jacobian::new(system),
            rhs: vec![0.0; system.size()],
            counters: Counters::default(),
            factored: None,
            floor: 0.0,
            system,
            factorization,
            tolerance,
        })
    }

    /// Solves for `unknowns`, starting from what they hold.
    ///
    /// # Errors
    /// [`Failure`], to be described by [`Newton::describe`].
    pub fn solve(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        self.counters.systems += 1;
        self.residual.start(self.system, equations, base, p, t);
        // a matrix for other coefficients converges slowly or not at all
        if self.factored.is_none_or(|old| !resembles(&old, equations)) {
            self.factored = None;
        }
        self.solve_value(equations, base, unknowns, p, t)?;
        self.residual.restore(self.system, equations, base, unknowns);
        if S::PARTS > 0 {
            self.solve_parts(equations, base, unknowns, p, t)?;
        }
        Ok(())
    }

    /// Solves for the derivative parts alone, the values being a solution already (that of a real run).
    ///
    /// # Errors
    /// [`Failure`] if the values are far from a solution: the guide belongs to another problem.
    pub fn solve_guided(
        &mut self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) -> Result<(), Failure> {
        self.counters.systems += 1;
        self.residual.start(self.system, equations, base, p, t);
        self.residual.keep_values = true;
        self.solve_parts(equations, base, unknowns, p, t)?;
        let scale = unknowns.x.iter().fold(f64::MIN_POSITIVE, |s: f64, x| s.max(x.value().abs()));
        let correction = self.step(None, &mut unknowns.clone());
        let near = match projected_size(equations, base) {
            Some((unit, size)) => unit * correction <= GUIDED * size,
            None => correction <= GUIDED * scale || self.at_round_off(equations, correction, scale),
        };
        if near {
            return Ok(());
        }
        Err(Failure { how: FailureKind::Stagnated, iterations: 0, correction: correction / scale })
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
        let mut first_residual = None;
        let mut growth = 0;
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
            self.counters.iterations += 1;
            let step = self.step(None, unknowns);
            let scale = unknowns.x.iter().chain(&unknowns.y).fold(0.0, |s: f64, x| s.max(x.value().abs()));
            if !step.is_finite() {
                return fail(FailureKind::NotFinite, iteration, step);
            }
            if self.tolerance == NewtonTolerance::Residual {
                previous = step;
                continue;
            }
            let rate = step / previous;
            // the first correction says nothing about the next one
            let expected = if rate > 0.0 && rate < STALLED { step * rate / (1.0 - rate) } else { step };
            // a projection is as good as its correction of the state is small against the state
            let moved = projected_size(equations, base).map(|(unit, size)| unit * step / size);
            let settled = match moved {
                // the first correction says nothing about the next one
                Some(moved) => moved * if rate > 0.0 { rate.min(1.0) } else { 1.0 } <= 0.25 * f64::EPSILON,
                None => expected <= ROUND_OFF * scale || step <= 2.0 * self.floor,
            };
            if step == 0.0 || settled {
                return Ok(());
            }
            if rate >= STALLED && previous.is_finite() {
                // with an old matrix this may be slow convergence: only a fresh one tells round-off from it
                if moved.map_or(step <= NEARLY * scale, |moved| moved <= 8.0 * f64::EPSILON) {
                    return Ok(());
                }
                if fresh && self.at_round_off(equations, step, scale) {
                    self.floor = step;
                    return Ok(());
                }
                if fresh && rate > 1.0 {
                    growth += 1;
                    if growth > 4 || step > 1e6 * scale.max(1.0) {
                        return fail(FailureKind::Diverged, iteration, step / scale);
                    }
                }
            }
            if rate > SLOW && iteration > 1 {
                self.factored = None;
            }
            previous = step;
        }
        let scale = unknowns.x.iter().fold(f64::MIN_POSITIVE, |s, x| s.max(x.value().abs()));
        fail(FailureKind::Stagnated, MOST_ITERATIONS, previous / scale)
    }

    /// Corrections no longer shrink: is that round-off, or a system that does not converge?
    fn at_round_off(&self, equations: &Equations, step: f64, scale: f64) -> bool {
        let force = self.residual.f.iter().fold(0.0, |s: f64, f| s.max(f.value().abs()));
        let length = self.residual.constraint_at.q.iter().fold(0.0, |s: f64, q| s.max(q.value().abs()));
        let gap = match equations.level {
            Level::Position | Level::Stabilized => equations.constraint.alpha,
            Level::Velocity | Level::Acceleration => 0.0,
        };
        let largest_gap = self.residual.g.iter().fold(0.0, |s: f64, g| s.max(g.value().abs())) * gap;
        let small_force = force <= FORCE_FLOOR * self.residual.force_scale;
        let small_gap = largest_gap <= 1e-12 * length.max(f64::MIN_POSITIVE);
        (small_force && small_gap) || step <= 1e-10 * scale
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
        for pass in 0..4 {
            if pass > 0 {
                self.evaluate(equations, base, unknowns, p, t);
            }
            let mut largest: f64 = 0.0;
            for part in 0..S::PARTS {
                let step = self.step(Some(part), unknowns);
                let scale = unknowns.x.iter().chain(&unknowns.y).fold(0.0, |s: f64, x| s.max(x.part(part).abs()));
                if scale > 0.0 {
                    largest = largest.max(step / scale);
                }
            }
            if pass > 0 && largest <= 1e-14 {
                break;
            }
        }
        Ok(())
    }

    fn evaluate(&mut self, equations: &Equations, base: &VectorsAvq<S>, unknowns: &mut Unknowns<S>, p: &[S], t: f64) {
        self.counters.residuals += 1;
        self.residual.evaluate(self.system, equations, base, unknowns, p, t);
    }

    fn factorize(&mut self, equations: &Equations, unknowns: &Unknowns<S>, p: &[S], t: f64) -> Result<(), Singular> {
        self.counters.factorizations += 1;
        let p: Vec<f64> = p.iter().map(|p| p.value()).collect();
        self.jacobian.assemble(self.system, equations, &self.residual, unknowns, &p, t);
        self.factorization.factor(&self.jacobian.values)?;
        self.factored = Some(*equations);
        Ok(())
    }

    fn step(&mut self, part: Option<usize>, unknowns: &mut Unknowns<S>) -> f64 {
        self.counters.solves += 1;
        self.jacobian.reduce(self.system, &self.residual, part, &mut self.rhs);
        self.factorization.solve(&mut self.rhs);
        self.jacobian.add_step(self.system, &self.rhs, part, unknowns)
    }

    /// Rows of the constraint equations in the matrix assembled last, towards the unknowns of nodes.
    pub(super) fn constraint_rows(&self) -> Vec<Vec<f64>> {
        let pattern = &self.system.pattern;
        let places = self.system.multiplier_places();
        let nodes = places.iter().flatten().min().copied().unwrap_or(pattern.size);
        let mut rows = vec![vec![0.0; nodes]; places.len()];
        for column in 0..nodes {
            for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                if let Some(row) = places.iter().position(|&own| own == Some(pattern.rows[place])) {
                    rows[row][column] = self.jacobian.values[place];
                }
            }
        }
        rows
    }

    fn residual_size(&self) -> f64 {
        let all = self.residual.f.iter().chain(&self.residual.y).chain(&self.residual.g).chain(&self.residual.g_second);
        // max() of floats would lose a NaN
        all.map(|f| f.value().abs()).fold(0.0, |s: f64, f| if f <= s { s } else { f })
    }

    /// The failure in words.
    pub fn describe(&self, failure: &Failure, place: &str) -> RunError {
        let model = self.system.model;
        let how = match failure.how {
            FailureKind::Singular(unknown) => {
                let unknown = self.system.unknown_name(unknown, &self.jacobian);
                let hint = if unknown.starts_with("joint") {
                    "its reaction is not determined: the joint is redundant or the mechanism is in a singular pose"
                } else {
                    "it has no inertia, or nothing holds it: give it a mass or a constraint"
                };
                return RunError::Singular { place: place.into(), unknown, hint: hint.into() };
            }
            FailureKind::Diverged => "diverged",
            FailureKind::Stagnated => "stagnated",
            FailureKind::NotFinite => "met a number that is not finite",
        };
        let size = |value: f64| if value.is_nan() { f64::INFINITY } else { value.abs() };
        let largest = |values: &[S]| {
            (0..values.len())
                .max_by(|&i, &j| size(values[i].value()).total_cmp(&size(values[j].value())))
                .map(|i| (i, values[i].value()))
        };
        let force = largest(&self.residual.f).map(|(i, f)| (model.dof_name(i), f));
        let gap = largest(&self.residual.g).map(|(i, g)| (model.equation_name(i), g));
        let (row, residual) = match (force, gap) {
            (Some(force), Some(gap)) => {
                if size(gap.1) > size(force.1) {
                    gap
                } else {
                    force
                }
            }
            (force, gap) => force.or(gap).unwrap_or_default(),
        };
        RunError::NoConvergence {
            place: place.into(),
            how,
            iterations: failure.iterations,
            correction: failure.correction,
            limit: ROUND_OFF,
            row,
            residual,
        }
    }
}

/// For a projection: the factor from its unknowns to the projected state, and the size of that state.
fn projected_size<S: RunScalar>(equations: &Equations, base: &VectorsAvq<S>) -> Option<(f64, f64)> {
    let largest = |values: &[S]| values.iter().fold(f64::MIN_POSITIVE, |s: f64, x| s.max(x.value().abs()));
    match equations.level {
        Level::Position if equations.metric => Some((equations.constraint.alpha, largest(&base.q))),
        Level::Velocity if equations.metric => Some((equations.constraint.beta, largest(&base.v))),
        _ => None,
    }
}

/// True if a matrix factored for one kind of equations serves the other: same inertia and stiffness coefficients.
fn resembles(old: &Equations, new: &Equations) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    old.level == new.level
        && near(old.residual.gamma, new.residual.gamma)
        && near(old.residual.beta, new.residual.beta)
        && near(old.residual.alpha, new.residual.alpha)
        && near(old.constraint.gamma, new.constraint.gamma)
}
