//! An optimization from its start to its end.

use super::design_program::{Combination, DesignProgram, sided};
use super::quadratic::QuadraticProgram;
use super::scaling::Scaling;
use super::{ConstraintKind, DesignPoint, Optimization, Optimized, Optimizer, Watcher, minimize};
use crate::design::check_design;
use crate::integrators::RunError;
use crate::scenes::LinearConstraint;

impl Optimization<'_> {
    /// Linear constraints in scaled variables, each of the order of 1; those variables that do not vary are constants.
    fn linear(&self, scaling: &Scaling, start: &[f64]) -> Vec<Combination> {
        let row = |constraint: &LinearConstraint| {
            let mut weights: Vec<(usize, f64)> = Vec::new();
            let mut constant = -constraint.limit.value();
            for (name, coefficient) in &constraint.coefficients {
                let index = self.variables.iter().position(|variable| variable.name == *name).unwrap_or_default();
                match scaling.varying.iter().position(|&varying| varying == index) {
                    Some(place) => {
                        let (offset, size) = scaling.measures[place];
                        weights.push((place, coefficient * size));
                        constant += coefficient * offset;
                    }
                    None => constant += coefficient * start[index],
                }
            }
            let largest = weights.iter().fold(0.0, |most: f64, (_, weight)| most.max(weight.abs()));
            let size = if largest > 0.0 { largest } else { constraint.limit.value().abs().max(1.0) };
            Combination { weights, constant, factor: sided(constraint.limit).1 / size }
        };
        self.problem.linear.iter().map(row).collect()
    }

    /// The nearest design, in scaled variables, that satisfies the linear constraints.
    fn linear_start(&self, start: &[f64]) -> Result<Vec<f64>, RunError> {
        let scaling = Scaling::new(&self.variables, start, self.varying());
        let linear = self.linear(&scaling, start);
        let y = scaling.scaled(start);
        let offsets: Vec<f64> = linear.iter().map(|row| row.value(&y)).collect();
        let kinds: Vec<ConstraintKind> = self.problem.linear.iter().map(|constraint| sided(constraint.limit).0).collect();
        if super::evaluations::violation(&kinds, &offsets) <= self.stopping.violation {
            return Ok(start.to_vec());
        }
        let rows: Vec<Vec<f64>> = linear.iter().map(|row| row.slopes(y.len())).collect();
        let names: Vec<&str> = self.problem.linear.iter().map(|constraint| constraint.name.as_str()).collect();
        let step = QuadraticProgram::shortest(&y, &scaling.bounds(), &kinds, (offsets, &rows)).map_err(|_| {
            RunError::Input(format!(
                "no design within the bounds satisfies the linear constraints {} together; the variables that may change: {}",
                names.join(", "),
                scaling.varying.iter().map(|&i| self.variables[i].name.as_str()).collect::<Vec<_>>().join(", ")
            ))
        })?;
        Ok(scaling.design(&y.iter().zip(&step).map(|(y, d)| y + d).collect::<Vec<_>>()))
    }

    /// Optimizes from a design. If that violates linear constraints, the nearest one which satisfies them is the start.
    ///
    /// # Errors
    /// A design out of bounds, linear constraints that contradict each other, a start that cannot be simulated, a problem that the
    /// optimizer does not treat. A later design that cannot be simulated is no error: the optimizer steps back from it, and it is
    /// counted.
    pub fn run(&self, optimizer: &dyn Optimizer, start: &[f64], watcher: &mut dyn Watcher) -> Result<Optimized, RunError> {
        self.go(optimizer, start, Vec::new(), watcher)
    }

    /// Goes on with an optimization that ended early, from the table of its history: as the unbroken one, bit for bit. The optimizer is led
    /// through the recorded values and gradients, which are not computed again but for the start, and so knows what it had learned.
    ///
    /// # Errors
    /// As for [`Optimization::run`]; a table of another optimization, which its columns, the functionals of the start, or a design to which
    /// the optimizer does not go tell.
    pub fn resume(
        &self,
        optimizer: &dyn Optimizer,
        (header, rows): (&[String], &[Vec<f64>]),
        watcher: &mut dyn Watcher,
    ) -> Result<Optimized, RunError> {
        let mut recorded = self.history();
        recorded.read(header, rows).map_err(RunError::Input)?;
        let first = recorded.points.first().map(|point| point.design.clone());
        let start = first.ok_or_else(|| RunError::Input("the history has no point to go on from".into()))?;
        let optimized = self.go(optimizer, &start, recorded.points, watcher)?;
        match optimized.failure {
            Some(RunError::Input(message))
                if optimized.ended.reason == super::Reason::Stopped && message.contains("of the history") =>
            {
                Err(RunError::Input(message))
            }
            failure => Ok(Optimized { failure, ..optimized }),
        }
    }

    fn go(
        &self,
        optimizer: &dyn Optimizer,
        start: &[f64],
        recorded: Vec<DesignPoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Optimized, RunError> {
        check_design(&self.variables, start).map_err(RunError::Input)?;
        let start = self.linear_start(start)?;
        let scaling = Scaling::new(&self.variables, &start, self.varying());
        let linear = self.linear(&scaling, &start);
        let y = scaling.scaled(&start);
        let mut program = DesignProgram::begin(self, scaling, linear, &start, recorded, watcher)?;
        let ended = minimize(optimizer, &mut program, &y, self.stopping).map_err(RunError::Input)?;
        let DesignProgram { history, failure, .. } = program;
        if ended.reason == super::Reason::StartFailed {
            return Err(failure.unwrap_or_else(|| RunError::Input("the start has no gradient".into())));
        }
        Ok(Optimized { ended, history, failure })
    }
}
