use super::{Functional, Over, Sample};
use crate::assembly::Model;
use crate::elements::RunScalar;
use crate::integrators::{Combination, StartRecord, StepRecord, Table};

/// Values of functionals, accumulated while a run goes on: no step needs to be kept for them.
///
/// An integral z of f follows the table's own recursion for z' = f, z = sum of earlier z + h sum of weights f: a method that looks
/// further back keeps as many earlier integrals as it reads. [`QuadratureWeights`](super::QuadratureWeights) is its transpose.
///
/// A smooth maximum is summed relative to the largest value so far, c, and rescaled by exp(rho (c - c')) when a larger one, c',
/// comes: so one pass gives the value and its offset.
pub struct Values<'f, S> {
    functionals: &'f [Functional],
    model: &'f Model,
    table: &'f Table,
    p: &'f [S],
    /// Offsets follow the largest value; otherwise they are given.
    following: bool,
    offsets: Vec<Option<f64>>,
    /// For each functional its initial value, or its integral after the last step and before, latest first.
    sums: Vec<Vec<S>>,
    duration: f64,
    /// The end of the last step.
    last: Option<Sample<S>>,
    sample: Sample<S>,
    /// Whether any functional reads multipliers.
    reading: bool,
}

impl<'f, S: RunScalar> Values<'f, S> {
    /// For a real run: offsets of smooth maxima are found on the way.
    pub fn new(functionals: &'f [Functional], model: &'f Model, table: &'f Table, p: &'f [S]) -> Self {
        let offset = |functional: &Functional| match functional.over {
            Over::SmoothMaximum { .. } => Some(f64::NEG_INFINITY),
            _ => None,
        };
        let older = table.quadrature.carried.len().max(1);
        let sum = |functional: &Functional| match functional.over {
            Over::Initial | Over::Terminal => vec![S::from(f64::NAN)],
            _ => vec![S::zero(); older],
        };
        Values {
            functionals,
            model,
            table,
            p,
            following: true,
            offsets: functionals.iter().map(offset).collect(),
            sums: functionals.iter().map(sum).collect(),
            duration: 0.0,
            last: None,
            sample: Sample::empty(),
            reading: functionals.iter().any(Functional::reads_multipliers),
        }
    }

    /// For a run with derivative parts: offsets are those of the real run.
    pub fn along(
        functionals: &'f [Functional],
        model: &'f Model,
        table: &'f Table,
        p: &'f [S],
        offsets: &[Option<f64>],
    ) -> Self {
        Values { following: false, offsets: offsets.to_vec(), ..Self::new(functionals, model, table, p) }
    }

    /// The start of the run.
    pub fn start(&mut self, start: &StartRecord<S>) {
        for (functional, sum) in self.functionals.iter().zip(&mut self.sums) {
            if functional.over == Over::Initial {
                let mut sample = Sample::initial(start);
                if functional.reads_multipliers() {
                    sample.share(self.model, self.p);
                }
                sum[0] = functional.measured.value(self.model, &sample, self.p);
            }
        }
    }

    /// A finished step.
    pub fn step(&mut self, step: &StepRecord<S>) {
        self.duration += step.h;
        if self.functionals.iter().any(|functional| functional.over == Over::Terminal) {
            self.last.get_or_insert_with(Sample::empty).set_terminal(step);
        }
        if self.functionals.iter().all(|functional| matches!(functional.over, Over::Initial | Over::Terminal)) {
            return;
        }
        let Combination { carried, stages } = &self.table.scheme(step.scheme).quadrature;
        for (functional, sums) in self.functionals.iter().zip(&mut self.sums) {
            if matches!(functional.over, Over::Integral | Over::SmoothMaximum { .. }) {
                let latest = sums.iter().zip(carried).map(|(&sum, &factor)| sum * factor).sum();
                sums.rotate_right(1);
                sums[0] = latest;
            }
        }
        for (stage, weight) in stages.iter().enumerate() {
            self.sample.set_stage(step, stage, step.h * weight);
            if self.reading {
                self.sample.share(self.model, self.p);
            }
            let sample = &self.sample;
            for ((functional, sums), offset) in self.functionals.iter().zip(&mut self.sums).zip(&mut self.offsets) {
                let value = || functional.measured.value(self.model, sample, self.p);
                match functional.over {
                    Over::Initial | Over::Terminal => {}
                    Over::Integral => sums[0] += value() * sample.weight,
                    Over::SmoothMaximum { sharpness, .. } => {
                        let (y, c) = (value(), offset.get_or_insert(0.0));
                        if self.following && y.value() > *c {
                            if c.is_finite() {
                                let smaller = S::from((sharpness * (*c - y.value())).exp());
                                sums.iter_mut().for_each(|sum| *sum *= smaller);
                            }
                            *c = y.value();
                        }
                        sums[0] += ((y - *c) * sharpness).exp() * sample.weight;
                    }
                }
            }
        }
    }

    /// The values at the end of the last step, and the offsets of smooth maxima.
    pub fn finish(mut self) -> (Vec<S>, Vec<Option<f64>>) {
        if let Some(last) = self.last.as_mut().filter(|_| self.reading) {
            last.share(self.model, self.p);
        }
        let value = |((functional, sums), offset): ((&Functional, &Vec<S>), &Option<f64>)| match functional.over {
            Over::Initial | Over::Integral => sums[0],
            Over::Terminal => self.last.as_ref().map_or(sums[0], |last| functional.measured.value(self.model, last, self.p)),
            Over::SmoothMaximum { sharpness, normalized } => {
                let measure = if normalized { self.duration } else { 1.0 };
                (sums[0] / measure).ln() / sharpness + offset.unwrap_or(0.0)
            }
        };
        (self.functionals.iter().zip(&self.sums).zip(&self.offsets).map(value).collect(), self.offsets)
    }
}
