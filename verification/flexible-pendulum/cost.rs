//! What a step of the flexible pendulum costs.

use super::path::{pendulum, prepare};
use crate::{Clock, Report};
use costate::integrators::{Counters, DEFAULT_TABLE, NewtonTolerance, RunError};
use costate::internals::{Nothing, march};
use costate::scenes::Prepared;

/// Numbers of elements, with the steps that are taken.
const SIZES: [(usize, usize); 4] = [(5, 800), (10, 400), (20, 200), (40, 100)];
/// Size of a step [s].
const STEP: f64 = 1e-3;
/// Runs of each; the fastest counts, since anything else on the machine only adds time.
const REPEATS: usize = 7;
/// Exudyn's cable in absolute nodal coordinates with generalized-alpha on a like machine [us per step]; half of it is the aim.
const EXUDYN: [f64; 4] = [34.0, 64.0, 120.0, 229.0];
/// The methods that are measured.
const METHODS: [&str; 3] = ["variational", "generalized-alpha", DEFAULT_TABLE];

/// Microseconds, Newton iterations and factorizations of a step.
pub fn costs(report: &mut Report) -> Result<(), RunError> {
    for method in METHODS {
        for tolerance in NewtonTolerance::ALL {
            for ((elements, steps), exudyn) in SIZES.into_iter().zip(EXUDYN) {
                let (us, counters) = cost(method, tolerance, elements, steps)?;
                let per_step = |count: usize| count as f64 / (steps + 1) as f64;
                let figure = |what: &str| format!("{method}/{}/{elements} elements/{what}", tolerance.name());
                report.inform(figure("time of a step [us]"), us);
                report.inform(figure("by the aim, half of Exudyn's time"), us / (0.5 * exudyn));
                report.inform(figure("Newton iterations/step"), per_step(counters.iterations));
                report.inform(figure("factorizations/step"), per_step(counters.factorizations));
            }
        }
    }
    Ok(())
}

fn cost(method: &str, tolerance: NewtonTolerance, elements: usize, steps: usize) -> Result<(f64, Counters), RunError> {
    let scene = pendulum(elements)?;
    let of = |steps: usize| -> Result<Prepared, RunError> {
        let mut prepared = prepare(&scene, method, STEP * steps as f64, steps)?;
        prepared.method.tolerance = tolerance;
        Ok(prepared)
    };
    // a first step alone costs what is set up once: it is subtracted
    let (one, all) = (of(1)?, of(steps + 1)?);
    let (mut least, mut counters) = (f64::INFINITY, Counters::default());
    for _ in 0..REPEATS {
        let mut timed = |prepared: &Prepared| -> Result<f64, RunError> {
            let clock = Clock::start();
            let run = march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut Nothing::default())?;
            counters = run.counters;
            Ok(clock.seconds() * 1e6)
        };
        let (first, all) = (timed(&one)?, timed(&all)?);
        least = least.min((all - first) / steps as f64);
    }
    Ok((least, counters))
}
