//! Optimizations as studies measure them: what they cost, how the objective went, and quantities over time of a design.

use costate::functionals::Sample;
use costate::history::Watch;
use costate::integrators::{RunError, StepRecord};
use costate::internals::Measured;
use costate::optimize::{DesignHistory, GradientBy, Optimization, Optimized, Sqp};
use costate::scenes::{AnyScene, Prepared};
use costate_cli::{Series, Style};

/// Finite differences as in the source: one more simulation for each variable, at 1 % more of its value.
pub const DIFFERENCES: GradientBy = GradientBy::Difference { share: 0.01 };

/// Solves a scene's own problem from its own design.
pub fn optimize(scene: &dyn AnyScene, steps: usize, gradient: GradientBy, iterations: usize) -> Result<Optimized, RunError> {
    let initial = Optimization::of(scene)?.initial();
    optimize_from(&initial, scene, steps, gradient, iterations)
}

/// The same from another design.
pub fn optimize_from(
    start: &[f64],
    scene: &dyn AnyScene,
    steps: usize,
    gradient: GradientBy,
    iterations: usize,
) -> Result<Optimized, RunError> {
    let mut optimization = Optimization::of(scene)?;
    optimization.cases[0].settings.steps = steps;
    optimization.gradient = gradient;
    optimization.stopping.iterations = iterations;
    optimization.run(&Sqp, start, &mut ())
}

/// Time of all simulations and gradients [s].
pub fn seconds(history: &DesignHistory) -> f64 {
    let work = history.work();
    work.simulation_seconds + work.gradient_seconds
}

/// Time of a gradient with the simulations of its line search [s]: the first design and every iteration have one.
pub fn seconds_a_gradient(optimized: &Optimized) -> f64 {
    seconds(&optimized.history) / (optimized.ended.iterations + 1) as f64
}

/// What `value` is after each iteration.
pub fn by_iteration(name: &str, history: &DesignHistory, value: impl Fn(&[f64], f64) -> f64) -> Series {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for point in &history.points {
        points.extend(point.iteration.map(|k| (k as f64, value(&point.design, point.objective))));
    }
    Series { name: name.into(), points, style: Style::Both }
}

/// Quantities at the end of every step of a design.
pub fn over_time(prepared: &Prepared, measured: &[&Measured]) -> Result<Vec<Vec<(f64, f64)>>, RunError> {
    let (model, p) = (prepared.model(), &prepared.mechanism.numbers.p);
    let mut courses = vec![Vec::new(); measured.len()];
    let mut sample = Sample::empty();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        sample.set_terminal(step);
        for (course, measured) in courses.iter_mut().zip(measured) {
            course.push((step.t + step.h, measured.value(model, &sample, p)));
        }
        true
    });
    let (_, stopped) = prepared.analysis().observed(&prepared.x, &mut watch)?;
    stopped.map_or(Ok(courses), Err)
}

/// A scene's own settings and method at another design, with other steps.
pub fn prepare<'s>(scene: &'s dyn AnyScene, design: &[f64], steps: usize) -> Result<Prepared<'s>, RunError> {
    let mut settings = scene.settings();
    settings.steps = steps;
    Prepared::with(scene, design, Prepared::method_of(&settings)?, settings)
}
