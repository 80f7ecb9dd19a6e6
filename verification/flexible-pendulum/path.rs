//! The way of the tip and the energy in one run.

use costate::functionals::Sample;
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, RunError, StepRecord};
use costate::internals::{Measured, march, table_named};
use costate::scenes::{AnyScene, FileScene, Prepared, built_in};

/// Moments at which runs are compared, in equal distances; every number of steps is a multiple of it.
pub const MOMENTS: usize = 400;

/// One run.
pub struct Path {
    /// Place (x, y) of the tip at the start and at all moments [m].
    pub tip: Vec<[f64; 2]>,
    /// The scene's first functional, if it has one, at the same times.
    pub quantity: Vec<f64>,
    /// Largest change of kinetic and potential energy from the start, which is at rest with zero energy [J].
    pub energy: f64,
}

impl Path {
    /// Largest distance of the tips at the same time [m].
    pub fn distance(&self, other: &Path) -> f64 {
        let apart = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
        // a maximum that keeps NaN
        self.tip.iter().zip(&other.tip).map(apart).fold(0.0, |most, d| if d <= most { most } else { d })
    }

    /// Their distance at the end [m].
    pub fn distance_at_end(&self, other: &Path) -> f64 {
        let [a, b] = [self, other].map(|path| path.tip[path.tip.len() - 1]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    }
}

/// The pendulum of so many elements.
pub fn pendulum(elements: usize) -> Result<FileScene, String> {
    built_in::changed("flexible-pendulum", &format!("cable.pendulum.elements = {elements}"))
}

/// A scene at its initial design, with a method by its name.
pub fn prepare<'s>(scene: &'s dyn AnyScene, method: &str, end: f64, steps: usize) -> Result<Prepared<'s>, RunError> {
    let mut settings = scene.settings().without_method();
    (settings.end, settings.steps) = (end, steps);
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let table = table_named(method).map_err(RunError::Input)?;
    let table = table.ok_or_else(|| RunError::Input(format!("no method {method}")))?;
    Prepared::with(scene, &x, Method::new(table, ConstraintLevel::default()), settings)
}

/// Runs a scene whose last node is the tip.
pub fn path(scene: &dyn AnyScene, method: &str, end: f64, steps: usize) -> Result<Path, RunError> {
    let prepared = prepare(scene, method, end, steps)?;
    let (model, p, q) = (prepared.model(), &prepared.mechanism.numbers.p, &prepared.mechanism.numbers.q);
    let tip = model.nodes.last().map_or(0, |node| node.dofs.start);
    let quantity = prepared.functionals().first().map(|functional| &functional.measured);
    let mut path = Path { tip: vec![[q[tip], q[tip + 1]]], quantity: vec![0.0], energy: 0.0 };
    let (mut index, mut sample) = (0, Sample::empty());
    let energy = Measured::energy();
    let variational = prepared.method.table.variational.is_some();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        index += 1;
        // a variational integrator has its velocities at the quadrature points
        if variational {
            sample.set_stage(step, 0)
        } else {
            sample.set_terminal(step)
        }
        path.energy = path.energy.max(energy.value(model, &sample, p).abs());
        if index % (steps / MOMENTS) == 0 {
            sample.set_terminal(step);
            path.tip.push([step.q[tip], step.q[tip + 1]]);
            path.quantity.push(quantity.map_or(0.0, |measured| measured.value(model, &sample, p)));
        }
        true
    });
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch)?;
    Ok(path)
}
