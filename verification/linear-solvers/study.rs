// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

#[cfg(feature = "mumps")]
mod faer_sparse;
#[cfg(feature = "mumps")]
mod mumps;
mod patterns;

use crate::memory::{forget_peak, memory_of_now, peak_memory};
use crate::{Clock, Noise, Report, Study, on_threads};
use costate::internals::{Factorization, Work};
use costate::linalg::Backend;
#[cfg(feature = "mumps")]
use costate::linalg::MultifrontalLu;
use patterns::{Matrix, chain, full, shell};
use std::time::Instant;

/// Makes a matrix with about a number of unknowns.
type Kind = fn(usize) -> Matrix;

/// Direct solvers on matrices of shells, chains and small mechanisms: time, memory and accuracy, on one and two threads.
pub struct LinearSolvers;

/// Unknowns from which a solver is left out: it would take minutes, or more memory than most machines have.
const MOST: [(Backend, usize); 2] = [(Backend::Dense, 2_000), (Backend::Multifrontal, usize::MAX)];
/// Largest backward error of a solution: some roundings more than the best.
const BACKWARD_ERROR: f64 = 1e-13;
/// Times of which the least counts, and the shortest that a clock is asked for [s].
const TIMES: usize = 3;
const SHORTEST: f64 = 2e-3;

impl Study for LinearSolvers {
    fn name(&self) -> &'static str {
        "linear-solvers"
    }
    fn summary(&self) -> &'static str {
        "direct solvers on matrices of shells, chains and small mechanisms: time, memory, accuracy, threads"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let sizes: [(Kind, usize); 7] =
            [(full, 30), (full, 100), (chain, 1_000), (chain, 10_000), (shell, 5_000), (shell, 50_000), (shell, 200_000)];
        for (make, unknowns) in sizes {
            let matrix = make(unknowns);
            eprintln!("{}: {} unknowns, {} entries", matrix.name, matrix.pattern.size, matrix.pattern.rows.len());
            for (backend, most) in MOST {
                if matrix.pattern.size > most {
                    continue;
                }
                for threads in [1, 2] {
                    // the other solvers have one thread
                    if threads > 1 && backend != Backend::Multifrontal {
                        continue;
                    }
                    on_threads(threads, || measure(report, &matrix, backend, threads))?;
                }
            }
            #[cfg(feature = "mumps")]
            measure_foreign(report, &matrix)?;
        }
        if !cfg!(feature = "mumps") {
            report.note("MUMPS and faer's sparse LU were not measured beside them: a program built with --features mumps does (it needs libmumps-dev and what ranks need).");
        }
        Ok(())
    }
}

/// A solver that others wrote, with one matrix.
#[cfg(feature = "mumps")]
trait Foreign {
    /// Factors the matrix.
    ///
    /// # Errors
    /// In words, with the error or code of the solver.
    fn factor(&mut self) -> Result<(), String>;
    /// Replaces a right-hand side by the solution.
    ///
    /// # Errors
    /// As for [`Self::factor`].
    fn solve(&mut self, transposed: bool, rhs: &mut [f64]) -> Result<(), String>;
}

/// Unknowns from which faer's sparse LU is left out.
#[cfg(feature = "mumps")]
const MOST_OF_FAER: usize = 60_000;

/// The same of MUMPS and of faer's sparse LU.
#[cfg(feature = "mumps")]
fn measure_foreign(report: &mut Report, matrix: &Matrix) -> Result<(), String> {
    if matrix.pattern.size <= MOST_OF_FAER {
        measure_one(report, matrix, "sparse (faer)", || faer_sparse::FaerSparse::new(matrix))?;
    }
    let own = MultifrontalLu::new(&matrix.pattern, 1);
    let mumps::Mumps { lu, .. } = measure_one(report, matrix, "MUMPS", || mumps::Mumps::new(matrix, own))?;
    let name = format!("{}, MUMPS, 1 thread", matrix.name);
    report.inform(format!("{name}/memory of the factorization [MB]"), lu.megabytes());
    report.inform(format!("{name}/multiplications [1e6]"), 0.5e-6 * lu.operations());
    report.note(format!("MUMPS ordered the {} by {}.", matrix.name, lu.ordering()));
    Ok(())
}

#[cfg(feature = "mumps")]
fn measure_one<F: Foreign>(
    report: &mut Report,
    matrix: &Matrix,
    solver: &str,
    analyse: impl FnOnce() -> Result<F, String>,
) -> Result<F, String> {
    let name = format!("{}, {solver}, 1 thread", matrix.name);
    let watch = Watch::start(1);
    let mut foreign = analyse()?;
    report.inform(format!("{name}/analysis [ms]"), 1e3 * watch.seconds());
    let factor = fastest(1, || foreign.factor())?;
    report.inform(format!("{name}/factorization [ms]"), 1e3 * factor);
    let rhs = right_hand_side(matrix.pattern.size);
    for transposed in [false, true] {
        let mut x = Vec::new();
        let solution = fastest(1, || {
            x.clone_from(&rhs);
            foreign.solve(transposed, &mut x)
        })?;
        let kind = if transposed { "transposed solution" } else { "solution" };
        report.inform(format!("{name}/{kind} [ms]"), 1e3 * solution);
        report.inform(format!("{name}/backward error of the {kind}"), backward_error(matrix, transposed, &x, &rhs));
    }
    Ok(foreign)
}

fn right_hand_side(size: usize) -> Vec<f64> {
    let mut noise = Noise::new(1);
    (0..size).map(|_| noise.next()).collect()
}

/// Time on the processor of one thread, or time of day of several.
enum Watch {
    One(Clock),
    Several(Instant),
}

impl Watch {
    fn start(threads: usize) -> Self {
        if threads == 1 { Watch::One(Clock::start()) } else { Watch::Several(Instant::now()) }
    }
    fn seconds(&self) -> f64 {
        match self {
            Watch::One(clock) => clock.seconds(),
            Watch::Several(begun) => begun.elapsed().as_secs_f64(),
        }
    }
}

/// Time of some work: the least of several times, in each of which it is repeated until a clock can tell how long it takes [s].
fn fastest(threads: usize, mut work: impl FnMut() -> Result<(), String>) -> Result<f64, String> {
    let (mut repetitions, mut least) = (1, f64::INFINITY);
    let mut times = 0;
    while times < TIMES {
        let watch = Watch::start(threads);
        for _ in 0..repetitions {
            work()?;
        }
        let seconds = watch.seconds();
        if seconds < SHORTEST {
            repetitions *= 4;
            continue;
        }
        least = least.min(seconds / repetitions as f64);
        times += 1;
    }
    Ok(least)
}

/// Times of a solver with a matrix, and the errors of its solutions.
fn measure(report: &mut Report, matrix: &Matrix, backend: Backend, threads: usize) -> Result<(), String> {
    let Matrix { name, pattern, values } = matrix;
    let name = format!("{name}, {}, {threads} thread{}", backend.name(), if threads > 1 { "s" } else { "" });
    let singular = |error: costate::linalg::Singular| format!("{name}: unknown {} is not determined", error.unknown);
    let before = memory_of_now();
    forget_peak();
    let watch = Watch::start(threads);
    let mut factorization = Factorization::new(pattern, backend).map_err(singular)?;
    report.inform(format!("{name}/analysis [ms]"), 1e3 * watch.seconds());
    factorization.factor(values).map_err(singular)?;
    if let (Some(before), Some(peak)) = (before, peak_memory()) {
        report.inform(format!("{name}/memory at its peak [MB]"), (peak - before) / 1e6);
    }
    let factor = fastest(threads, || factorization.factor(values).map_err(singular))?;
    report.inform(format!("{name}/factorization [ms]"), 1e3 * factor);
    if let Some(Work { multiplications, fill }) = factorization.plan().work {
        report.inform(format!("{name}/multiplications [1e6]"), 1e-6 * multiplications);
        report.inform(format!("{name}/entries of L and U [1e6]"), 1e-6 * fill as f64);
    }
    let rhs = right_hand_side(pattern.size);
    for transposed in [false, true] {
        let mut x = Vec::new();
        let solution = fastest(threads, || {
            x.clone_from(&rhs);
            if transposed {
                return factorization.solve_transposed(&mut x).map_err(singular).map(|_| ());
            }
            factorization.solve(&mut x);
            Ok(())
        })?;
        let kind = if transposed { "transposed solution, refined once" } else { "solution" };
        report.inform(format!("{name}/{kind} [ms]"), 1e3 * solution);
        report.at_most(
            format!("{name}/backward error of the {kind}"),
            backward_error(matrix, transposed, &x, &rhs),
            BACKWARD_ERROR,
        );
    }
    Ok(())
}

/// |b - A x| / (|A| |x| + |b|) in largest numbers.
fn backward_error(Matrix { pattern, values, .. }: &Matrix, transposed: bool, x: &[f64], b: &[f64]) -> f64 {
    let (mut residual, mut rows) = (b.to_vec(), vec![0.0; pattern.size]);
    for column in 0..pattern.size {
        for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
            let (row, value) = (pattern.rows[place] as usize, values[place]);
            let (row, column) = if transposed { (column, row) } else { (row, column) };
            residual[row] -= value * x[column];
            rows[row] += value.abs();
        }
    }
    let largest = |numbers: &[f64]| numbers.iter().fold(0.0, |largest: f64, number| largest.max(number.abs()));
    largest(&residual) / (largest(&rows) * largest(x) + largest(b))
}
