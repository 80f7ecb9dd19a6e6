use super::adjoint::adjoint;
use crate::assembly::Model;
use crate::design::{DesignChain, DesignMap, ModelNumbers};
use crate::functionals::{Functional, FunctionalScalar};
use crate::history::History;
use crate::integrators::{Counters, InitialState, Method, Problem, RunError, StartPlan, TimeGrid, march, march_along};
use crate::scalar::{Complex, LANES, Lanes};

/// Everything that defines a functional's dependence on a design: model, map from the design, functionals, method, grid.
#[derive(Clone, Copy)]
pub struct Analysis<'m> {
    /// Topology.
    pub model: &'m Model,
    /// From design variables to numbers.
    pub map: &'m dyn DesignMap,
    /// What is asked for.
    pub functionals: &'m [Functional],
    /// How it is integrated.
    pub method: &'m Method,
    /// The steps, the same for every run.
    pub grid: &'m TimeGrid,
    /// Decisions about the start, the same for every run.
    pub plan: &'m StartPlan,
}

/// A real run with its functionals.
#[derive(Clone, Debug)]
pub struct Forward {
    /// The numbers of the design.
    pub numbers: ModelNumbers<f64>,
    /// All states.
    pub history: History<f64>,
    /// Values of the functionals.
    pub values: Vec<f64>,
    /// Offsets of the smooth maxima.
    pub offsets: Vec<Option<f64>>,
    /// Work done.
    pub counters: Counters,
}

/// df/dx for each functional: `rows[functional][variable]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// One row for each functional.
    pub rows: Vec<Vec<f64>>,
    /// Work done.
    pub counters: Counters,
}

/// Numbers of one of the scalars that carry derivatives, with how a design is perturbed and read off.
trait Perturbed: FunctionalScalar {
    fn numbers(map: &dyn DesignMap, x: &[Self]) -> Result<ModelNumbers<Self>, String>;
}
impl Perturbed for Complex {
    fn numbers(map: &dyn DesignMap, x: &[Self]) -> Result<ModelNumbers<Self>, String> {
        map.complex(x)
    }
}
impl Perturbed for Lanes {
    fn numbers(map: &dyn DesignMap, x: &[Self]) -> Result<ModelNumbers<Self>, String> {
        map.lanes(x)
    }
}

impl<'m> Analysis<'m> {
    fn problem<S>(&self, numbers: &ModelNumbers<S>) -> Problem<'m, S>
    where
        S: Clone,
    {
        let start = InitialState { q: numbers.q.clone(), v: numbers.v.clone() };
        Problem { model: self.model, p: numbers.p.clone(), start }
    }

    /// Simulates a design and evaluates its functionals.
    ///
    /// # Errors
    /// Those of the map and of the run.
    pub fn forward(&self, x: &[f64]) -> Result<Forward, RunError> {
        let numbers = self.map.real(x).map_err(RunError::Input)?;
        let mut history = History::default();
        let run = march(&self.problem(&numbers), self.method, self.grid, self.plan, &mut history)?;
        let table = &self.method.table;
        let offsets: Vec<_> = self.functionals.iter().map(|f| f.offset(self.model, table, &history, &numbers.p)).collect();
        let values = self
            .functionals
            .iter()
            .zip(&offsets)
            .map(|(f, &offset)| f.value(self.model, table, &history, &numbers.p, offset))
            .collect();
        let forward = Forward { numbers, history, values, offsets, counters: run.counters };
        self.check_values(&forward)?;
        Ok(forward)
    }

    fn check_values(&self, forward: &Forward) -> Result<(), RunError> {
        match forward.values.iter().position(|value| !value.is_finite()) {
            Some(k) => Err(RunError::Input(format!(
                "functional \"{}\" is {}: a smooth maximum needs steps that resolve its peak, all the more where a method has negative weights; try a smaller step or sharpness",
                self.functionals[k].name, forward.values[k]
            ))),
            None => Ok(()),
        }
    }

    /// Gradients of all functionals by the discrete adjoint, for any number of variables at the price of one sweep.
    ///
    /// # Errors
    /// Those of the map, and a singular pose on the way.
    pub fn adjoint(&self, x: &[f64], forward: &Forward) -> Result<Gradient, RunError> {
        let problem = self.problem(&forward.numbers);
        let run = adjoint(&problem, self.method, self.plan, &forward.history, self.functionals, &forward.values)?;
        let chain = DesignChain::record(self.map, x).map_err(RunError::Input)?;
        let rows = run.gradients.iter().map(|bar| chain.gradient(bar)).collect();
        Ok(Gradient { rows, counters: run.counters })
    }

    /// Gradients by tangent runs (direct differentiation), eight variables at a time.
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn tangent(&self, x: &[f64], forward: &Forward) -> Result<Gradient, RunError> {
        let mut gradient = self.empty_gradient();
        for first in (0..x.len()).step_by(LANES) {
            let lanes = LANES.min(x.len() - first);
            let mut seeded: Vec<Lanes> = x.iter().map(|&x| Lanes::constant(x)).collect();
            for lane in 0..lanes {
                seeded[first + lane].eps[lane] = 1.0;
            }
            let (values, counters) = self.perturbed_run(&seeded, forward)?;
            gradient.counters += counters;
            for (row, value) in gradient.rows.iter_mut().zip(values) {
                row.extend_from_slice(&value.eps[..lanes]);
            }
        }
        Ok(gradient)
    }

    /// Gradients by complex-step runs of the whole simulation, one for each variable.
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn complex_step(&self, x: &[f64], forward: &Forward) -> Result<Gradient, RunError> {
        let mut gradient = self.empty_gradient();
        for variable in 0..x.len() {
            let mut perturbed: Vec<Complex> = x.iter().map(|&x| Complex::from(x)).collect();
            perturbed[variable].im = Complex::STEP;
            let (values, counters) = self.perturbed_run(&perturbed, forward)?;
            gradient.counters += counters;
            for (row, value) in gradient.rows.iter_mut().zip(values) {
                row.push(value.im / Complex::STEP);
            }
        }
        Ok(gradient)
    }

    /// Derivatives along one direction by central differences of separate real runs, extrapolated once (error of order h^4).
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn central_difference(&self, x: &[f64], direction: &[f64], step: f64) -> Result<Vec<f64>, RunError> {
        let difference = |step: f64| -> Result<Vec<f64>, RunError> {
            let at = |sign: f64| -> Vec<f64> { x.iter().zip(direction).map(|(x, d)| x + sign * step * d).collect() };
            let (plus, minus) = (self.forward(&at(1.0))?, self.forward(&at(-1.0))?);
            Ok(plus.values.iter().zip(&minus.values).map(|(p, m)| (p - m) / (2.0 * step)).collect())
        };
        let (coarse, fine) = (difference(step)?, difference(step / 2.0)?);
        Ok(coarse.iter().zip(fine).map(|(c, f)| (4.0 * f - c) / 3.0).collect())
    }

    fn empty_gradient(&self) -> Gradient {
        Gradient { rows: vec![Vec::new(); self.functionals.len()], counters: Counters::default() }
    }

    /// A run with derivative parts along the states of the real run: round-off of a second solution would be magnified into
    /// derivatives at position level, and nothing converged is solved for again.
    fn perturbed_run<S: Perturbed>(&self, x: &[S], forward: &Forward) -> Result<(Vec<S>, Counters), RunError> {
        let numbers = S::numbers(self.map, x).map_err(RunError::Input)?;
        let mut history = History::default();
        let guide = forward.history.guide();
        let run = march_along(&self.problem(&numbers), self.method, self.grid, self.plan, guide, &mut history)?;
        let value = |(f, &offset): (&Functional, &Option<f64>)| {
            f.value(self.model, &self.method.table, &history, &numbers.p, offset)
        };
        Ok((self.functionals.iter().zip(&forward.offsets).map(value).collect(), run.counters))
    }
}
