use super::TimeGrid;
use crate::assembly::StageCoefficients;

/// What a vector that goes from step to step is: how many times it has been differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// Coordinates.
    Q,
    /// Velocities.
    V,
    /// Accelerations.
    A,
}

impl Carried {
    /// Number of time derivatives: a term of order s enters one of order k with the factor h^(s - k).
    pub fn order(self) -> i32 {
        match self {
            Carried::Q => 0,
            Carried::V => 1,
            Carried::A => 2,
        }
    }
}

/// Coefficients of the carried vectors and of the stage accelerations; powers of h are implied by [`Carried::order`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Combination {
    /// One for each carried vector.
    pub carried: Vec<f64>,
    /// One for each stage.
    pub stages: Vec<f64>,
}

/// One stage: where (a, v, q) of the residual lie.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Time within the step, as a share of h.
    pub c: f64,
    /// Acceleration.
    pub a: Combination,
    /// Velocity.
    pub v: Combination,
    /// Coordinates.
    pub q: Combination,
    /// The stage's acceleration is this carried vector instead of an unknown (explicit first stage).
    pub known: Option<usize>,
}

/// Stage and update relations of an integrator.
///
/// For stages i and carried vectors Y (the first two are q and v):
///
/// q_i = sum U_q Y + h^2 sum A_q x_j,  v_i = sum U_v Y + h sum A_v x_j,  a_i = sum U_a Y + sum A_a x_j,
/// Y' = sum V Y + sum B x_j, with R(a_i, v_i, q_i, p, t_i) = 0 for the unknown x_i.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Name on the command line.
    pub name: String,
    /// Order for ordinary differential equations.
    pub order: usize,
    /// Vectors that go from step to step.
    pub carried: Vec<Carried>,
    /// Stages in the order of their solution.
    pub stages: Vec<Stage>,
    /// New carried vectors.
    pub update: Vec<Combination>,
    /// The integral z of a functional's quantity f at the end of a step, z = sum of earlier z (latest first) + h sum of stage f.
    pub quadrature: Combination,
    /// What takes the place of the quadrature's stages in aggregates, whose weights must not be negative; the same where none of those is.
    pub aggregate_weights: Vec<f64>,
    /// The last stage lies at the end of the step and is the new state.
    pub stiffly_accurate: bool,
    /// What a step leaves of what vibrates infinitely fast, as a share: where it is 1, reactions of constraints at position level are not damped.
    pub radius_at_infinity: f64,
    /// A second solution that measures the error of a step.
    pub embedded: Option<Embedded>,
    /// How a method that needs several steps behind it gets going.
    pub starter: Option<Starter>,
    /// The one stage solves discrete Euler-Lagrange equations instead of R = 0.
    pub variational: Option<Quadrature>,
    /// Euler's explicit step, for steps that events cut to less than a millionth.
    pub euler: Option<Box<Table>>,
}

/// How a variational integrator approximates the action of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadrature {
    /// Place of the only point within the step, from 0 to 1.
    pub alpha: f64,
    /// True for a step that starts from a velocity instead of a step before.
    pub first: bool,
}

/// The solution of a step minus a second one of lower order from the same stages.
#[derive(Clone, Debug, PartialEq)]
pub struct Embedded {
    /// Order of the second solution.
    pub order: usize,
    /// Difference of the coordinates.
    pub q: Combination,
    /// Difference of the velocities.
    pub v: Combination,
    /// The same of a solution without the explicit first stage, where there is one: in a step that begins with an acceleration of its own,
    /// which the steps before have not damped, that stage may count far too much for both of the others.
    pub implicit: Option<Box<Embedded>>,
}

/// A one-step table for the steps that have too few steps of their own size, without a breakpoint between, behind them.
#[derive(Clone, Debug, PartialEq)]
pub struct Starter {
    /// The one-step table; it carries what the other one carries.
    pub table: Box<Table>,
    /// Steps that must lie behind.
    pub steps: usize,
}

/// Which of a method's tables makes a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Scheme {
    /// The table itself.
    #[default]
    Main,
    /// Its one-step starter.
    Starter,
    /// Euler's explicit step.
    Euler,
}

/// Steps whose sizes differ relatively by less than this have the same size: each is the difference of two times, sums with round-off.
pub(super) const SAME_SIZE: f64 = 1e-8;

impl Table {
    /// True if nothing moves in any stage: its equations are those of an equilibrium, and time is a load factor.
    pub fn is_static(&self) -> bool {
        let zero = |combination: &Combination| combination.carried.iter().chain(&combination.stages).all(|&c| c == 0.0);
        self.stages.iter().all(|stage| zero(&stage.a) && zero(&stage.v))
    }

    /// (gamma, beta, alpha) of a stage: how its own unknown moves it.
    pub(crate) fn shift(&self, stage: usize, h: f64) -> StageCoefficients {
        let Stage { a, v, q, .. } = &self.stages[stage];
        StageCoefficients::new(a.stages[stage], h * v.stages[stage], h * h * q.stages[stage])
    }

    /// The table of a scheme.
    pub(crate) fn scheme(&self, scheme: Scheme) -> &Table {
        match (scheme, &self.starter) {
            (Scheme::Starter, Some(starter)) => &starter.table,
            (Scheme::Euler, _) => self.euler.as_deref().unwrap_or(self),
            _ => self,
        }
    }

    /// Adds Euler's step, q' = q + h v, v' = v + h a with the acceleration a at its start: without a division by its length h, as stages have it, so that
    /// derivatives by that keep their digits however short it is.
    pub(crate) fn with_euler(mut self) -> Table {
        if self.is_static() || self.variational.is_some() {
            return self;
        }
        let carried = self.carried.clone();
        let combine = |places: &[usize], stage: f64| {
            let of = |place: usize| f64::from(u8::from(places.contains(&place)));
            Combination { carried: (0..carried.len()).map(of).collect(), stages: vec![stage] }
        };
        let stage = Stage { c: 0.0, a: combine(&[], 1.0), v: combine(&[1], 0.0), q: combine(&[0], 0.0), known: None };
        let behind = |(place, kind): (usize, &Carried)| match (place, kind) {
            (0, _) => combine(&[0, 1], 0.0),
            (1, _) => combine(&[1], 1.0),
            (_, Carried::A) => combine(&[], 1.0),
            _ => combine(&[place], 0.0),
        };
        let mut integral = vec![0.0; self.quadrature.carried.len()];
        integral[0] = 1.0;
        let euler = Table {
            name: "euler".into(),
            order: 1,
            stages: vec![stage],
            update: carried.iter().enumerate().map(behind).collect(),
            quadrature: Combination { carried: integral, stages: vec![1.0] },
            aggregate_weights: vec![1.0],
            carried,
            ..Table::default()
        };
        self.euler = Some(Box::new(euler));
        self
    }

    /// Which table makes step `index` of a grid.
    pub fn scheme_at(&self, grid: &TimeGrid, index: usize) -> Scheme {
        if grid.shortest.contains(&index) {
            return Scheme::Euler;
        }
        let has_own_length =
            grid.events.contains_key(&(index + 1)) || grid.is_fixed(index + 1) && grid.is_behind_event(index);
        self.scheme_of(grid, index, has_own_length)
    }

    /// The same where it is known whether the length of the step depends on the motion, other than that of those before: then it does not go on
    /// from these, though it may happen to be as long.
    pub fn scheme_of(&self, grid: &TimeGrid, index: usize, has_own_length: bool) -> Scheme {
        let Some(starter) = self.starter.as_ref().filter(|_| !has_own_length) else { return self.starting_scheme() };
        let size = |index: usize| grid.times[index + 1] - grid.times[index];
        let own = size(index);
        let usable = |back: usize| {
            let point = index + 1 - back;
            !grid.is_interrupted(point) && (size(point - 1) - own).abs() <= SAME_SIZE * own
        };
        if index >= starter.steps && (1..=starter.steps).all(usable) { Scheme::Main } else { Scheme::Starter }
    }

    /// The scheme of steps that do not go on from those before.
    pub fn starting_scheme(&self) -> Scheme {
        if self.starter.is_some() { Scheme::Starter } else { Scheme::Main }
    }

    /// A one-step table that also carries what `carried` and the last rows of `update` add, for methods that look further back.
    pub(super) fn carrying(mut self, carried: &[Carried], update: &[Combination]) -> Table {
        let own = self.carried.len();
        assert_eq!(self.carried, carried[..own], "{}: a starter carries the same vectors first", self.name);
        let (stages, relations) = (self.stages.len(), self.stages.iter_mut().flat_map(|s| [&mut s.a, &mut s.v, &mut s.q]));
        let differences = self.embedded.iter_mut().flat_map(|embedded| {
            let Embedded { q, v, implicit, .. } = embedded;
            implicit.iter_mut().flat_map(|own| [&mut own.q, &mut own.v]).chain([q, v])
        });
        for combination in relations.chain(&mut self.update).chain(differences) {
            combination.carried.resize(carried.len(), 0.0);
        }
        for shift in &update[own..] {
            assert!(shift.stages.iter().all(|&weight| weight == 0.0), "{}: older vectors are only handed on", self.name);
            self.update.push(Combination { carried: shift.carried.clone(), stages: vec![0.0; stages] });
        }
        self.carried = carried.to_vec();
        self
    }
}
