use super::Variational;
use crate::scalar::Scalar;
use crate::tolerances;

/// Root of the smallest number that keeps all its digits: the square of a smaller one underflows.
const AT_REST: f64 = 1.5e-154;

/// How the unknown x moves accelerations, velocities and coordinates: (a, v, q) + (gamma, beta, alpha) x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageCoefficients {
    /// d a / d x.
    pub gamma: f64,
    /// d v / d x \[s\].
    pub beta: f64,
    /// d q / d x \[s2\].
    pub alpha: f64,
}

impl StageCoefficients {
    /// (gamma, beta, alpha).
    pub const fn new(gamma: f64, beta: f64, alpha: f64) -> Self {
        StageCoefficients { gamma, beta, alpha }
    }

    /// Whether the coefficients are those of the other but for round-off: steps are differences of times.
    pub(crate) fn is_nearly(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 10.0 * tolerances::ROUND_OFF * a.abs().max(b.abs());
        near(self.gamma, other.gamma) && near(self.beta, other.beta) && near(self.alpha, other.alpha)
    }
}

/// Which time derivative of the constraints is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// g = 0.
    Position,
    /// dg/dt = 0.
    Velocity,
    /// d2g/dt2 = 0.
    Acceleration,
}

/// One kind of nonlinear system: what moves with the unknowns, and which constraint level is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equations {
    /// Shift of the point at which R is evaluated.
    pub residual: StageCoefficients,
    /// Shift of the point at which constraints and reactions are evaluated.
    pub constraint: StageCoefficients,
    /// Constraint level.
    pub level: Level,
    /// The metric of a projection instead of the equation of motion: R less R at the base point, or M x where the unknowns move
    /// accelerations alone.
    pub metric: bool,
    /// Whether friction follows the multipliers: they are forces or impulses.
    pub friction: bool,
    /// A step of a variational integrator instead of the equation of motion.
    pub variational: Option<Variational>,
}

/// One nonlinear system of a run.
#[derive(Debug)]
pub struct StageSystem<'a, S> {
    /// What is asked for.
    pub equations: &'a Equations,
    /// (a, v, q) from which the unknowns move.
    pub base: &'a VectorsAvq<S>,
    /// Parameters of the model.
    pub p: &'a [S],
    /// Time \[s\].
    pub t: f64,
}

// derived ones would ask the same of S
impl<S> Clone for StageSystem<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for StageSystem<'_, S> {}

impl Equations {
    /// An equilibrium, whose unknowns are displacements.
    pub const EQUILIBRIUM: Self = {
        let shift = StageCoefficients::new(0.0, 0.0, 1.0);
        Equations {
            residual: shift,
            constraint: shift,
            level: Level::Position,
            metric: false,
            friction: true,
            variational: None,
        }
    };

    /// The equation of motion at a stage: both points move together.
    pub fn stage(shift: StageCoefficients, level: Level) -> Self {
        Equations { residual: shift, constraint: shift, level, metric: false, friction: true, variational: None }
    }

    /// A step of a variational integrator; the acceleration is what functionals read, in the first step that of half a step.
    pub fn variational(step: Variational) -> Self {
        let Variational { alpha, h, first } = step;
        let residual = StageCoefficients::new(if first { 2.0 } else { 1.0 }, h, alpha * h * h);
        let constraint = StageCoefficients::new(0.0, 0.0, h * h);
        Equations { residual, constraint, level: Level::Position, metric: false, friction: true, variational: Some(step) }
    }

    /// Whether they are the others but for the round-off of their steps.
    pub(crate) fn is_nearly(&self, other: &Self) -> bool {
        self.residual.is_nearly(&other.residual)
            && self.constraint.is_nearly(&other.constraint)
            && (self.level, self.metric, self.friction, self.variational)
                == (other.level, other.metric, other.friction, other.variational)
    }

    /// Whether constraints and reactions are evaluated at the point of R.
    pub(crate) fn has_one_point(&self) -> bool {
        self.residual == self.constraint && self.variational.is_none() && !self.is_of_inertia()
    }

    /// True for the mass metric, M x: the unknowns move accelerations alone.
    pub(crate) fn is_of_inertia(&self) -> bool {
        self.metric && self.is_of_accelerations()
    }

    /// Whether the unknowns move accelerations alone.
    pub(crate) fn is_of_accelerations(&self) -> bool {
        self.residual.beta == 0.0 && self.residual.alpha == 0.0
    }

    /// True for a metric that is the difference of R at two points.
    pub(crate) fn is_difference(&self) -> bool {
        self.metric && !self.is_of_accelerations()
    }

    /// The acceleration for given (v, q).
    pub fn acceleration() -> Self {
        Equations::stage(StageCoefficients::new(1.0, 0.0, 0.0), Level::Acceleration)
    }

    /// True for an equilibrium: neither accelerations nor velocities move with the unknowns.
    pub fn is_static(&self) -> bool {
        self.residual.gamma == 0.0 && self.residual.beta == 0.0
    }

    fn projection(residual: StageCoefficients, constraint: StageCoefficients, level: Level) -> Self {
        Equations { residual, constraint, level, metric: true, friction: false, variational: None }
    }

    /// Projection of q onto g = 0 in the metric of a stage's matrix.
    ///
    /// With (gamma, beta, alpha) of the stage and d = alpha x: R(a + gamma x, v + beta x, q + d) - R(a, v, q) + A^T nu = 0,
    /// g(q + d) = 0.
    pub fn position_projection(stage: StageCoefficients) -> Self {
        Self::projection(stage, StageCoefficients::new(0.0, 0.0, stage.alpha), Level::Position)
    }

    /// Projection of v onto dg/dt = 0 in the metric of a stage's matrix.
    ///
    /// With (gamma, beta, alpha) of the stage and w = beta x: R(a + gamma x, v + w, q + alpha x) - R(a, v, q) + A^T nu = 0,
    /// A (v + w) + g_t = 0.
    pub fn velocity_projection(stage: StageCoefficients) -> Self {
        Self::projection(stage, StageCoefficients::new(0.0, stage.beta, 0.0), Level::Velocity)
    }

    /// Projection of an initial q onto g = 0 in the mass metric, x = d: M d + A^T nu = 0, g(q + d) = 0.
    pub fn initial_position_projection() -> Self {
        Self::projection(StageCoefficients::new(1.0, 0.0, 0.0), StageCoefficients::new(0.0, 0.0, 1.0), Level::Position)
    }

    /// Projection of an initial v onto dg/dt = 0 in the mass metric, x = w: M w + A^T nu = 0, A (v + w) + g_t = 0.
    pub fn initial_velocity_projection() -> Self {
        Self::projection(StageCoefficients::new(1.0, 0.0, 0.0), StageCoefficients::new(0.0, 1.0, 0.0), Level::Velocity)
    }

    /// An impact: the same, with friction that follows its impulses nu.
    pub fn impact() -> Self {
        Equations { friction: true, ..Self::initial_velocity_projection() }
    }

    /// What a nonholonomic constraint h = 0 is asked for here, and the factor of its rows: h at every level but that of accelerations;
    /// nothing (its multiplier is zero) where coordinates are projected.
    pub(crate) fn nonholonomic(&self) -> Option<(Level, f64)> {
        match self.level {
            Level::Position if self.metric => None,
            Level::Acceleration => Some((Level::Acceleration, 1.0 / self.constraint.gamma)),
            Level::Position | Level::Velocity => Some((Level::Velocity, 1.0 / self.constraint.beta)),
        }
    }

    /// Weights of A and of its first and second derivative along the motion in the scaled rows of the constraints towards an unknown x that
    /// moves one coordinate.
    pub(crate) fn row_weights(&self) -> [f64; 3] {
        let StageCoefficients { gamma, beta, alpha } = self.constraint;
        match self.level {
            Level::Position => [1.0, 0.0, 0.0],
            Level::Velocity => [1.0, alpha / beta, 0.0],
            Level::Acceleration => [1.0, 2.0 * beta / gamma, alpha / gamma],
        }
    }

    /// Factor that gives the constraint rows the scale of A x.
    pub(crate) fn row_scale(&self) -> f64 {
        let StageCoefficients { gamma, beta, alpha } = self.constraint;
        match self.level {
            Level::Position => 1.0 / alpha,
            Level::Velocity => 1.0 / beta,
            Level::Acceleration => 1.0 / gamma,
        }
    }
}

/// Accelerations, velocities and coordinates of the whole model.
#[derive(Debug, PartialEq)]
pub struct VectorsAvq<S> {
    /// Accelerations.
    pub a: Vec<S>,
    /// Velocities.
    pub v: Vec<S>,
    /// Coordinates.
    pub q: Vec<S>,
}

impl<S: Scalar> VectorsAvq<S> {
    /// Zeros.
    pub fn zeros(dofs: usize) -> Self {
        let zero = || vec![S::zero(); dofs];
        VectorsAvq { a: zero(), v: zero(), q: zero() }
    }

    /// Writes base + shift x to `self`.
    pub fn set_shifted(&mut self, base: &Self, shift: StageCoefficients, unknowns: &Unknowns<S>) {
        let lists =
            [(&mut self.a, &base.a, shift.gamma), (&mut self.v, &base.v, shift.beta), (&mut self.q, &base.q, shift.alpha)];
        for (own, base, factor) in lists {
            if factor == 0.0 {
                own.iter_mut().zip(base).for_each(|(own, &base)| *own = base);
                continue;
            }
            own.iter_mut().zip(base).zip(&unknowns.x).for_each(|((own, &base), &x)| *own = base + x * factor);
        }
        // what comes to rest is at rest where its square underflows: there a speed has no derivative that numbers could hold
        for v in self.v.iter_mut().filter(|v| v.value().abs() < AT_REST) {
            *v -= v.value().into();
        }
    }

    /// base + shift x.
    pub fn shifted(base: &Self, shift: StageCoefficients, unknowns: &Unknowns<S>) -> Self {
        let mut point = Self::zeros(base.q.len());
        point.set_shifted(base, shift, unknowns);
        point
    }
}

/// Unknowns of one system, node-local multipliers included.
#[derive(Debug, PartialEq)]
pub struct Unknowns<S> {
    /// Accelerations (or scaled increments of a projection).
    pub x: Vec<S>,
    /// Multipliers, one for each constraint equation; zero for dropped ones.
    pub mu: Vec<S>,
    /// Multipliers of the constraints inside nodes.
    pub local_mu: Vec<S>,
}

/// A record that is empty at first, whatever its numbers are.
macro_rules! empty_fields {
    ($record:ident { $($field:ident),* $(,)? }) => {
        impl<S> Default for $record<S> {
            fn default() -> Self {
                $record { $($field: Default::default()),* }
            }
        }
    };
}
pub(crate) use empty_fields;

/// Empty at first, and copied field by field, into the memory that is there.
macro_rules! clone_fields {
    ($record:ident { $($field:ident),* $(,)? }) => {
        $crate::assembly::empty_fields!($record { $($field),* });
        impl<S: Clone> Clone for $record<S> {
            fn clone(&self) -> Self {
                $record { $($field: self.$field.clone()),* }
            }
            fn clone_from(&mut self, other: &Self) {
                $(self.$field.clone_from(&other.$field);)*
            }
        }
    };
}
pub(crate) use clone_fields;

impl Default for Equations {
    fn default() -> Self {
        Equations::acceleration()
    }
}

clone_fields!(VectorsAvq { a, v, q });
clone_fields!(Unknowns { x, mu, local_mu });

impl<S: Scalar> Unknowns<S> {
    /// Takes over the unknowns of another system, without multipliers inside nodes.
    pub fn set(&mut self, other: &Self) {
        self.x.clone_from(&other.x);
        self.mu.clone_from(&other.mu);
    }

    /// Takes over (end - start) factor, without multipliers inside nodes; from zero where there is no start.
    pub fn set_increment(&mut self, start: Option<&Self>, end: &Self, factor: f64) {
        let Unknowns { x, mu, .. } = self;
        let ends = [(x, &end.x), (mu, &end.mu)];
        let starts = start.map(|start| [&start.x, &start.mu]);
        for (i, (own, end)) in ends.into_iter().enumerate() {
            own.clear();
            match starts {
                Some(starts) => own.extend(end.iter().zip(starts[i]).map(|(&end, &start)| (end - start) * factor)),
                None => own.extend(end.iter().map(|&end| end * factor)),
            }
        }
    }

    /// The lists whose course over time first guesses go on, coordinates first.
    pub fn extrapolated(&self) -> [&[S]; 2] {
        [&self.x, &self.mu]
    }

    /// The same to be changed.
    pub fn extrapolated_mut(&mut self) -> [&mut [S]; 2] {
        [&mut self.x, &mut self.mu]
    }
}
