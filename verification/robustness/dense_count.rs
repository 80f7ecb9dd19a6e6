//! Negative eigenvalues of the stiffness of an equilibrium by a dense eigensolver, on a basis of the directions that its constraints leave.

use costate::history::Direction;
use costate::integrators::Stability;
use costate::internals::{Jacobian, Rerun, Residual, StageSystem};
use costate::scenes::Prepared;
use costate::sensitivity::Forward;
use nalgebra::{DMatrix, SymmetricEigen};

/// Eigenvalues up to this share of the largest one have no sign.
const OPEN: f64 = 1e-12;
/// Singular values of the constraints up to this share of the largest one are zero.
const DEPENDENT: f64 = 1e-13;

/// What a count says beside the dense one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    Right,
    /// Some sign is told as not known, though dense eigenvalues have it.
    Unknown,
    /// Both leave a sign open, or there is nothing to compare.
    Open,
    Wrong([usize; 3]),
}

/// The stability that a run tells of its last equilibrium, beside the dense count.
pub fn compare(prepared: &Prepared, forward: &Forward) -> Result<Told, String> {
    let Some(Stability { negative, neutral, determinant: None, .. }) = forward.stability.map(|course| course.end) else {
        return Ok(Told::Open);
    };
    let [surely, possibly] = negative_eigenvalues(prepared, forward)?;
    // a wrong word is a sign that is told and that no eigenvalue allows
    if negative > possibly || negative + neutral < surely {
        return Ok(Told::Wrong([negative, neutral, surely]));
    }
    Ok(if neutral == 0 {
        Told::Right
    } else if surely == possibly {
        Told::Unknown
    } else {
        Told::Open
    })
}

/// Numbers of eigenvalues that are negative, without and with those next to zero.
fn negative_eigenvalues(prepared: &Prepared, forward: &Forward) -> Result<[usize; 2], String> {
    let problem = prepared.problem();
    let rerun = Rerun::new(&problem, &prepared.method, &forward.grid, &prepared.plan);
    let mut steps = forward.history.read(&rerun, Direction::Forward).map_err(|error| error.to_string())?;
    let mut found = Err("no step to count in".to_string());
    while let Some(step) = steps.next().map_err(|error| error.to_string())? {
        let system = &*prepared.method.system(problem.model, &step.dropped);
        let Some(stage) = step.stages.iter().rfind(|stage| stage.known.is_none()) else { continue };
        let solve = &stage.solve;
        let at = StageSystem { equations: &solve.equations, base: &solve.base, p: &problem.p, t: solve.t };
        let mut residual = Residual::default();
        residual.start(system, at);
        let mut unknowns = solve.unknowns.clone();
        residual.evaluate(system, at, &mut unknowns);
        let mut jacobian = Jacobian::default();
        jacobian.assemble(system, &solve.equations, &residual, &unknowns, &problem.p, solve.t);
        let size = system.size();
        let mut matrix = DMatrix::zeros(size, size);
        for column in 0..size {
            for place in system.pattern.column_starts[column]..system.pattern.column_starts[column + 1] {
                matrix[(system.pattern.rows[place] as usize, column)] = jacobian.values[place];
            }
        }
        let nodes = system.multiplier_places().iter().flatten().min().copied().unwrap_or(size);
        found = Ok(count(&matrix, nodes));
    }
    found
}

/// The same of [K, A^T; A, 0] with K in the first rows.
fn count(matrix: &DMatrix<f64>, nodes: usize) -> [usize; 2] {
    // signs stay where unknowns are scaled
    let scales: Vec<f64> = (0..nodes).map(|i| matrix.column(i).amax().max(f64::MIN_POSITIVE).sqrt().recip()).collect();
    let stiffness = DMatrix::from_fn(nodes, nodes, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]) * scales[i] * scales[j]);
    let mut basis = DMatrix::identity(nodes, nodes);
    let constraints = matrix.nrows() - nodes;
    if constraints > 0 && nodes > 0 {
        // rows of zeros make all right singular vectors
        let mut rows = DMatrix::from_fn(nodes.max(constraints), nodes, |i, j| {
            if i < constraints { matrix[(nodes + i, j)] * scales[j] } else { 0.0 }
        });
        for mut row in rows.row_iter_mut() {
            let size = row.norm();
            if size > 0.0 {
                row /= size;
            }
        }
        let svd = rows.svd(false, true);
        let largest = svd.singular_values.amax();
        let free: Vec<usize> = (0..nodes).filter(|&k| svd.singular_values[k] <= DEPENDENT * largest).collect();
        let vectors = svd.v_t.unwrap_or_default();
        basis = DMatrix::from_fn(nodes, free.len(), |i, k| vectors[(free[k], i)]);
    }
    if basis.ncols() == 0 {
        return [0; 2];
    }
    let reduced = basis.transpose() * &stiffness * &basis;
    let eigenvalues = SymmetricEigen::new((&reduced + reduced.transpose()) * 0.5).eigenvalues;
    let open = OPEN * stiffness.amax();
    [-open, open].map(|bound| eigenvalues.iter().filter(|value| **value < bound).count())
}
