//! Sensitivities over time: what functionals measure, and its derivatives, at every step.

use super::analysis::seeded_designs;
use super::{Analysis, Forward};
use crate::assembly::Model;
use crate::elements::RunScalar;
use crate::functionals::{Functional, Sample, StepEnds};
use crate::integrators::{Counters, Observer, RunError, StartRecord, StepRecord, unit_part};
use crate::scalar::{Complex64, Tangents};

/// What functionals measure, with its derivatives, at the start and at the end of each step; what they make of it over time is left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GradientCourse {
    /// The start and the ends of all steps \[s\].
    pub times: Vec<f64>,
    /// `values[functional][time]`.
    pub values: Vec<Vec<f64>>,
    /// `derivatives[functional][variable][time]`.
    pub derivatives: Vec<Vec<Vec<f64>>>,
    /// Work done.
    pub counters: Counters,
}

impl Analysis<'_> {
    /// What all functionals measure, with its derivatives, at every step, by tangent runs (direct differentiation): one run for eight
    /// variables, however many times are read. The adjoint would take a sweep for each time.
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn tangent_over_time(&self, x: &[f64], forward: &Forward) -> Result<GradientCourse, RunError> {
        self.over_time::<Tangents>(x, forward)
    }

    /// The same by complex-step runs of the whole simulation, one for each variable.
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn complex_step_over_time(&self, x: &[f64], forward: &Forward) -> Result<GradientCourse, RunError> {
        self.over_time::<Complex64>(x, forward)
    }

    fn over_time<S: RunScalar>(&self, x: &[f64], forward: &Forward) -> Result<GradientCourse, RunError> {
        self.check_forward(x, forward)?;
        let count = self.functionals.len();
        let (values, derivatives) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        let mut course = GradientCourse { values, derivatives, ..GradientCourse::default() };
        for (seeded, lanes) in seeded_designs::<S>(x, &(0..x.len()).collect::<Vec<_>>()) {
            let (measured, counters) = self.measured_over_time(&seeded, forward, &mut course.times)?;
            for (functional, measured) in measured.iter().enumerate() {
                course.values[functional] = measured.iter().map(|value| value.value()).collect();
                let of_lane = |lane: usize| measured.iter().map(|own| own.part(lane) / unit_part::<S>()).collect();
                course.derivatives[functional].extend((0..lanes).map(of_lane));
            }
            course.counters += counters;
        }
        Ok(course)
    }

    /// What all functionals measure at every step of a run with derivative parts; writes the times.
    fn measured_over_time<S: RunScalar>(
        &self,
        x: &[S],
        forward: &Forward,
        times: &mut Vec<f64>,
    ) -> Result<(Vec<Vec<S>>, Counters), RunError> {
        times.clear();
        let numbers = self.numbers_with_parts(x)?;
        let mut reading = Reading {
            functionals: self.functionals,
            model: self.model,
            p: &numbers.p,
            times,
            measured: vec![Vec::new(); self.functionals.len()],
            ends: StepEnds::new(&self.method.table),
        };
        let clocks = self.clocks(&numbers.p, forward)?;
        if !clocks.is_empty() || !forward.grid.events.is_empty() {
            return Err(RunError::Input(
                "a design variable moves a breakpoint of a load or driver, or the time at which an element passes from one piece of its formula to \
                 another, and the ends of steps with it: derivatives at given times are not known there; take functionals over the run"
                    .into(),
            ));
        }
        let counters = self.perturbed_run(&numbers, &clocks, forward, &mut reading)?;
        if let Some(last) = reading.ends.end() {
            reading.read(last);
        }
        Ok((reading.measured, counters))
    }
}

struct Reading<'f, S> {
    functionals: &'f [Functional],
    model: &'f Model,
    p: &'f [S],
    times: &'f mut Vec<f64>,
    measured: Vec<Vec<S>>,
    ends: StepEnds<'f, S>,
}

impl<S: RunScalar> Reading<'_, S> {
    fn read(&mut self, mut sample: Sample<S>) {
        if self.functionals.iter().any(Functional::reads_multipliers) {
            sample.share(self.model, self.p);
        }
        self.times.push(sample.t.value());
        for (functional, measured) in self.functionals.iter().zip(&mut self.measured) {
            measured.push(functional.measured_at(self.model, &sample, self.p));
        }
    }
}

impl<S: RunScalar> Observer<S> for Reading<'_, S> {
    fn start(&mut self, start: &StartRecord<S>) -> Result<(), RunError> {
        self.read(Sample::initial(start));
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<S>) -> Result<bool, RunError> {
        if let Some(sample) = self.ends.add(step) {
            self.read(sample);
        }
        Ok(true)
    }
}
