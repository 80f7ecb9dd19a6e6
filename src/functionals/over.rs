use super::aggregate::{SUMS, Totals};
use super::{Aggregate, AggregateKind, PointWeights, StageWeight};
use crate::scalar::Scalar;

/// What is made over time of the values that are measured, one or those of many points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Over {
    /// Value at the start; of points their sum by weights, as an integral over an area.
    Initial,
    /// The same at the end.
    Terminal,
    /// Its integral over time, with the integrator's own weights.
    Integral,
    /// One number near the largest value of all points and times.
    Aggregate {
        /// How it is made.
        aggregate: Aggregate,
        /// Of which times.
        times: Times,
    },
}

/// Times at which a functional reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Times {
    /// The start.
    Start,
    /// The end.
    End,
    /// All of the run, with the integrator's own weights.
    Run,
}

impl Aggregate {
    /// Of the values at some times.
    pub const fn at(self, times: Times) -> Over {
        Over::Aggregate { aggregate: self, times }
    }
}

impl Over {
    /// The smooth maximum over a run, normalized: see [`Aggregate`].
    pub const fn smooth_maximum(sharpness: f64) -> Self {
        Aggregate::smooth_maximum(sharpness).at(Times::Run)
    }

    /// The upper maximum over a run: see [`Aggregate`].
    pub const fn upper_maximum(sharpness: f64) -> Self {
        Aggregate::upper_maximum(sharpness).at(Times::Run)
    }

    /// Whether each sample in time counts 1, whatever the integrator's weights are.
    pub(crate) fn counts_samples(&self) -> bool {
        self.aggregate().is_some_and(|aggregate| aggregate.kind == AggregateKind::UpperMaximum)
    }

    /// How much a stage counts, in units of time unless samples are counted.
    pub(crate) fn time_weight(&self, weight: StageWeight) -> f64 {
        match self.aggregate() {
            None => weight.integral,
            Some(_) if self.counts_samples() => 1.0,
            Some(_) => weight.aggregate,
        }
    }

    /// When it reads.
    pub const fn times(&self) -> Times {
        match *self {
            Over::Initial => Times::Start,
            Over::Terminal => Times::End,
            Over::Integral => Times::Run,
            Over::Aggregate { times, .. } => times,
        }
    }

    /// The aggregate, if it is one.
    // the optimizer would read an aggregate's kind before it knows that there is one, and decide by it only afterwards, which a memory
    // checker takes for the use of a number that was never set
    #[inline(never)]
    pub const fn aggregate(&self) -> Option<&Aggregate> {
        match self {
            Over::Aggregate { aggregate, .. } => Some(aggregate),
            _ => None,
        }
    }

    /// How points count: in sums and integrals by what they stand for.
    pub(crate) fn points(&self) -> PointWeights {
        self.aggregate().map_or(PointWeights::Own, |aggregate| aggregate.points)
    }

    /// Offset before any value.
    pub(super) fn first_offset(&self) -> f64 {
        self.aggregate().map_or(0.0, Aggregate::first_offset)
    }

    /// What a value with a weight adds to the sums.
    pub(super) fn terms<S: Scalar>(&self, y: S, weight: S, offset: S) -> [S; SUMS] {
        match self.aggregate() {
            Some(aggregate) => aggregate.terms(y, weight, offset),
            None => [y * weight, S::zero(), S::zero()],
        }
    }

    /// Adds what values with their weights give, times a weight in time.
    pub(super) fn add_terms<S: Scalar>(&self, values: &[[S; 2]], offset: f64, weight: S, sums: &mut [S; SUMS]) {
        for &[y, own] in values {
            let terms = self.terms(y, own, S::from(offset));
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term * weight);
        }
    }

    /// The number that these sums make.
    pub(super) fn value<S: Scalar>(&self, totals: Totals<S>) -> S {
        self.aggregate().map_or(totals.sums[0], |aggregate| aggregate.value(totals))
    }
}
