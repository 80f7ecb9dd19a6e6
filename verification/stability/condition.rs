//! Condition of a stage matrix.

use costate::integrators::ConstraintLevel;
use costate::internals::{Equations, Jacobian, Level, Residual, StageCoefficients, StageSystem, VectorsAvq};
use costate::linalg::{DenseLu, LinearSolver, SparsePattern};
use costate::scenes::Prepared;

/// Condition in the 1-norm of the first step's last stage matrix at the start, rows and columns scaled to a largest entry of 1.
pub fn condition(prepared: &Prepared) -> Result<f64, String> {
    let (problem, table) = (prepared.problem(), &prepared.method.table);
    let system = &*prepared.method.system(problem.model, &prepared.plan.dropped);
    let (t, end) = prepared.grid.span(0);
    let (h, last) = (end - t, table.stages.len() - 1);
    let row = &table.stages[last];
    let shift = StageCoefficients::new(row.a.stages[last], h * row.v.stages[last], h * h * row.q.stages[last]);
    let level = match prepared.method.level {
        ConstraintLevel::Position => Level::Position,
        ConstraintLevel::Acceleration => Level::Acceleration,
    };
    let equations = Equations::stage(shift, level);
    let base = VectorsAvq { a: vec![0.0; problem.model.dofs], v: problem.start.v.clone(), q: problem.start.q.clone() };
    let (mut residual, mut jacobian) = (Residual::default(), Jacobian::default());
    let mut unknowns = Residual::unknowns(system);
    let stage = StageSystem { equations: &equations, base: &base, p: &problem.p, t };
    residual.start(system, stage);
    residual.evaluate(system, stage, &mut unknowns);
    jacobian.assemble(system, &equations, &residual, &unknowns, &problem.p, t);
    of_scaled(&system.pattern, &jacobian.values)
}

fn of_scaled(pattern: &SparsePattern, values: &[f64]) -> Result<f64, String> {
    let n = pattern.size;
    let entries = |column: usize| pattern.column_starts[column]..pattern.column_starts[column + 1];
    let mut rows = vec![0.0_f64; n];
    for (&row, value) in pattern.rows.iter().zip(values) {
        let own = &mut rows[row as usize];
        *own = own.max(value.abs());
    }
    let mut scaled: Vec<f64> = pattern.rows.iter().zip(values).map(|(&row, value)| value / rows[row as usize]).collect();
    let mut norm = 0.0_f64;
    for column in 0..n {
        let largest = scaled[entries(column)].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        scaled[entries(column)].iter_mut().for_each(|value| *value /= largest);
        norm = norm.max(scaled[entries(column)].iter().map(|value| value.abs()).sum());
    }
    let mut solver = DenseLu::new(pattern);
    solver.factor(&scaled).map_err(|singular| format!("the stage matrix is singular at unknown {}", singular.unknown))?;
    let mut inverse_norm = 0.0_f64;
    for column in 0..n {
        let mut unit = vec![0.0; n];
        unit[column] = 1.0;
        solver.solve(&mut unit);
        inverse_norm = inverse_norm.max(unit.iter().map(|value| value.abs()).sum());
    }
    Ok(norm * inverse_norm)
}
