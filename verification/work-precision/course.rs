//! Forces over a motion, and how far those of one run are from those of another.

use costate::history::Watch;
use costate::integrators::{RunError, StepRecord};
use costate::internals::{Run as End, march, march_adaptive};
use costate::scenes::Prepared;

/// Numbers at rising times.
#[derive(Clone, Debug, Default)]
pub struct Course {
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Course {
    fn add(&mut self, t: f64, values: Vec<f64>) {
        self.times.push(t);
        self.values.push(values);
    }

    /// Largest number of all; a NaN wins.
    pub fn largest(&self) -> f64 {
        self.values.iter().flatten().fold(0.0, |most: f64, x| if x.abs() <= most { most } else { x.abs() })
    }

    /// Cubic interpolation between the four times around `t`.
    fn at(&self, t: f64, entry: usize) -> f64 {
        let next = self.times.partition_point(|&time| time < t);
        let first = next.saturating_sub(2).min(self.times.len().saturating_sub(4));
        let near = first..(first + 4).min(self.times.len());
        let weight = |own: usize| -> f64 {
            let others = near.clone().filter(|&other| other != own);
            others.map(|other| (t - self.times[other]) / (self.times[own] - self.times[other])).product()
        };
        near.clone().map(|own| weight(own) * self.values[own][entry]).sum()
    }

    /// Largest difference from `exact` over all times, by the largest number there; 0 without numbers.
    pub fn error(&self, exact: &Course) -> f64 {
        let scale = exact.largest();
        let mut worst: f64 = 0.0;
        for (&t, values) in self.times.iter().zip(&self.values) {
            for (entry, value) in values.iter().enumerate() {
                let error = (value - exact.at(t, entry)).abs();
                worst = if error <= worst { worst } else { error };
            }
        }
        if scale > 0.0 { worst / scale } else { 0.0 }
    }
}

/// Forces of one run.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    /// Multipliers of the last stage of each step, at the time of that stage.
    pub multipliers: Course,
    /// Force in a stiff member at the end of each step; empty without one.
    pub member: Course,
}

impl Forces {
    /// The larger of both errors.
    pub fn error(&self, exact: &Forces) -> f64 {
        let (a, b) = (self.multipliers.error(&exact.multipliers), self.member.error(&exact.member));
        if a >= b || a.is_nan() { a } else { b }
    }
}

/// Force [N] in a stiff member for the coordinates of the model.
pub type Member = fn(&Prepared, &[f64]) -> f64;

/// Runs a motion; its forces are kept where they are asked for. Also the number of steps.
pub fn run(
    prepared: &Prepared,
    member: Option<Member>,
    mut forces: Option<&mut Forces>,
) -> Result<(End<f64>, usize), RunError> {
    let mut watch = Watch(|step: &StepRecord<f64>| {
        let Some(forces) = forces.as_mut() else { return true };
        if let Some(last) = step.stages.last() {
            forces.multipliers.add(last.solve.t, last.solve.unknowns.mu.clone());
        }
        if let Some(member) = member {
            forces.member.add(step.t + step.h, vec![member(prepared, &step.q)]);
        }
        true
    });
    let Prepared { method, grid, plan, .. } = prepared;
    match &prepared.control {
        Some(control) => {
            let (grid, end) = march_adaptive(&prepared.problem(), method, control, grid, plan, &mut watch);
            Ok((end?, grid.steps()))
        }
        None => Ok((march(&prepared.problem(), method, grid, plan, &mut watch)?, grid.steps())),
    }
}
