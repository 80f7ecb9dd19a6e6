use super::aggregate::{SUMS, Totals, derivatives};
use super::measured_group::{GroupGradient, GroupWork};
use super::{Functional, Measured, Over, Sample};
use crate::assembly::{Clock, Model, VectorsAvq};
use crate::elements::RunScalar;
use crate::scalar::Tangents;

/// Where the gradient at a sample goes.
pub struct SampleSeeds<'b> {
    /// Accelerations, velocities, coordinates.
    pub at: &'b mut VectorsAvq<f64>,
    /// Multipliers.
    pub mu: &'b mut [f64],
    /// Parameters.
    pub p: &'b mut [f64],
}

/// Gives the gradient of a functional by what it reads at each sample, from the sums of its run.
pub struct FunctionalGradient<'f> {
    /// The functional.
    pub functional: &'f Functional,
    /// Derivatives of its value by its sums.
    seeds: [f64; SUMS],
    /// Offset of these sums.
    offset: f64,
    group: Option<GroupGradient>,
}

impl<'f> FunctionalGradient<'f> {
    /// For a run with these sums; derivatives towards parameters of a group are those that are `active`.
    pub fn new(functional: &'f Functional, model: &Model, totals: &Totals<f64>, active: &[bool]) -> Self {
        let Functional { over, measured, .. } = functional;
        let offset = totals.offset;
        let seeds = derivatives(totals.sums, |sums| over.value(Totals { offset, sums }));
        let group = match measured {
            Measured::Group(group) => Some(group.gradient(model, over, active)),
            Measured::Energy(group) => Some(group.gradient(model, &Over::Integral, active)),
            _ => None,
        };
        FunctionalGradient { functional, seeds, offset, group }
    }

    /// Adds the share of a sample with a weight in time.
    pub fn add(&mut self, model: &Model, sample: &Sample<f64>, p: &[f64], weight: f64, seeds: &mut SampleSeeds) {
        // where the value does not depend on its sums, no sample counts
        if weight == 0.0 || self.seeds == [0.0; SUMS] {
            return;
        }
        let Functional { over, measured, .. } = self.functional;
        let weighted = self.seeds.map(|bar| bar * weight);
        if let (Some(group), Measured::Group(_)) = (&mut self.group, measured) {
            group.add(sample, p, (weighted, self.offset), seeds.at, seeds.p);
            return;
        }
        // a sum is linear in what it adds up
        let value = if over.aggregate().is_some() { measured.value(model, sample, p) } else { 0.0 };
        let [factor] = derivatives([value], |[y]| {
            let terms = over.terms(y, Tangents::from(1.0), Tangents::from(self.offset));
            terms.into_iter().zip(weighted).map(|(term, bar)| term * bar).sum()
        });
        match &mut self.group {
            Some(group) => group.add(sample, p, ([factor, 0.0, 0.0], 0.0), seeds.at, seeds.p),
            None => measured.add_gradient(model, sample, p, factor, seeds),
        }
    }

    /// Derivatives of the share of a sample with a weight in time by the start and the end of its step, which a clock has as its first parts.
    pub fn moves(
        &self,
        model: &Model,
        sample: &Sample<f64>,
        p: &[f64],
        (weight, clock): (Tangents, Clock<Tangents>),
    ) -> [f64; 2] {
        let Functional { over, measured, .. } = self.functional;
        let lift = |values: &[f64]| values.iter().map(|&value| Tangents::from(value)).collect::<Vec<_>>();
        let (mut moving, p) = (sample.lifted(), lift(p));
        moving.follow(Some(clock));
        if self.functional.reads_multipliers() {
            moving.share(model, &p);
        }
        let (mut work, mut sums) = (GroupWork::default(), [Tangents::from(0.0); SUMS]);
        measured.write_values(model, &moving, &p, over.points(), &mut work);
        over.add_terms(&work.values, self.offset, weight, &mut sums);
        [0, 1].map(|end| sums.iter().zip(self.seeds).map(|(sum, bar)| sum.part(end) * bar).sum())
    }
}
