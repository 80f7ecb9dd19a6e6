//! `costate verify`: the command line of costate with the studies of this folder, a program of its own beside it. Each folder holds a problem,
//! its source and tolerance, and the code that measures it.

mod allocations;
mod andrews;
#[path = "beam-benchmarks/study.rs"]
mod beam_benchmarks;
#[path = "chain/study.rs"]
mod chain;
mod clock;
mod compared;
#[path = "complex-step/study.rs"]
mod complex_step;
#[path = "contact/study.rs"]
mod contact;
#[path = "element-cost/study.rs"]
mod element_cost;
#[path = "events/study.rs"]
mod events;
mod falling;
#[path = "fit/study.rs"]
mod fit;
#[path = "flexible-pendulum/study.rs"]
mod flexible_pendulum;
#[path = "four-bar/study.rs"]
mod four_bar;
#[path = "full-hub/study.rs"]
mod full_hub;
#[path = "functionals/study.rs"]
mod functionals;
#[path = "gradient-cost/study.rs"]
mod gradient_cost;
#[path = "lightest-blades/study.rs"]
mod lightest_blades;
#[path = "linear-solvers/study.rs"]
mod linear_solvers;
mod memory;
mod noise;
mod optimized;
#[path = "orders/study.rs"]
mod orders;
mod phases;
#[path = "plate-pendulum/study.rs"]
mod plate_pendulum;
mod program;
#[path = "random-scenes/study.rs"]
mod random_scenes;
#[path = "rigid-benchmarks/study.rs"]
mod rigid_benchmarks;
#[path = "rigid-spring-beam/study.rs"]
mod rigid_spring_beam;
#[path = "robustness/study.rs"]
mod robustness;
#[path = "rotor-hub/study.rs"]
mod rotor_hub;
mod rounding;
#[path = "scaling/study.rs"]
mod scaling;
#[path = "shell-benchmarks/study.rs"]
mod shell_benchmarks;
#[path = "signals/study.rs"]
mod signals;
#[path = "stability/study.rs"]
mod stability;
#[path = "suspension/study.rs"]
mod suspension;
#[path = "variational/study.rs"]
mod variational;
mod whole_runs;
#[path = "work-precision/study.rs"]
mod work_precision;

use clock::{Clock, PHASES, largest, median, with_phases};
use costate_cli::{CommandLine, Figure, Form, Report, Study};
use noise::{Lots, Noise};
use std::process::ExitCode;

fn main() -> ExitCode {
    let studies = all();
    CommandLine::new([]).with_built_in().with_studies(studies.iter().map(|study| &**study)).main()
}

/// Measures with one thread: that of a pool of its own.
fn on_one_thread(measure: impl FnOnce() -> Result<(), String> + Send) -> Result<(), String> {
    on_threads(1, measure)
}

/// Measures with some threads: those of a pool of their own.
fn on_threads(threads: usize, measure: impl FnOnce() -> Result<(), String> + Send) -> Result<(), String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())?;
    pool.install(measure)
}

/// All studies. A new one is a folder with `study.rs` and a line here.
fn all() -> Vec<Box<dyn Study>> {
    vec![
        Box::new(complex_step::ComplexStep),
        Box::new(orders::Orders),
        Box::new(rigid_benchmarks::RigidBenchmarks),
        Box::new(gradient_cost::GradientCost),
        Box::new(chain::ChainCost),
        Box::new(plate_pendulum::PlatePendulumStudy),
        Box::new(scaling::Scaling),
        Box::new(stability::Stability),
        Box::new(robustness::Robustness),
        Box::new(random_scenes::RandomScenes),
        Box::new(work_precision::WorkPrecision),
        Box::new(beam_benchmarks::BeamBenchmarks),
        Box::new(shell_benchmarks::ShellBenchmarks),
        Box::new(rotor_hub::RotorHub),
        Box::new(lightest_blades::LightestBlades),
        Box::new(full_hub::FullHub),
        Box::new(functionals::Functionals),
        Box::new(signals::Signals),
        Box::new(events::Events),
        Box::new(contact::Contact),
        Box::new(four_bar::FourBar),
        Box::new(element_cost::ElementCost),
        Box::new(linear_solvers::LinearSolvers),
        Box::new(variational::Variational),
        Box::new(rigid_spring_beam::RigidSpringBeamStudy),
        Box::new(suspension::SuspensionStudy),
        Box::new(flexible_pendulum::PendulumOfCable),
        Box::new(fit::FitToMeasurements),
    ]
}
