use super::aggregate::{SUMS, Totals};
use super::extremes::{Extreme, Extremes, Seen, follow};
use super::measured_group::GroupWork;
use super::{Functional, Measured, RunParameters, Sample, StageWeight, Times};
use crate::assembly::Model;
use crate::elements::RunScalar;
use crate::integrators::{Combination, StartRecord, StepRecord, Table};

/// Ends of steps of which is known how they alternate.
const LATEST: usize = 5;

/// Values of functionals, accumulated while a run goes on: no step needs to be kept for them.
///
/// An integral z of f follows the table's own recursion for z' = f, z = sum of earlier z + h sum of weights f: a method that looks
/// further back keeps as many earlier integrals as it reads. [`QuadratureWeights`](super::QuadratureWeights) is its transpose.
///
/// An aggregate is summed relative to the largest value so far, c, and rescaled when a larger one comes: so one pass gives the value and
/// its offset.
pub struct Values<'f, S> {
    functionals: &'f [Functional],
    model: &'f Model,
    table: &'f Table,
    parameters: RunParameters<S>,
    /// Offsets follow the largest value; otherwise they are given.
    following: bool,
    /// Of aggregates: c, to which their sums are relative.
    offsets: Vec<f64>,
    /// Of aggregates: smallest and largest value.
    seen: Vec<Option<[Seen; 2]>>,
    /// For each functional its sums after the last step and before, latest first.
    sums: Vec<Vec<[S; SUMS]>>,
    /// The end of the last step.
    last: Option<Sample<S>>,
    sample: Sample<S>,
    /// Whether any functional reads multipliers.
    reading: bool,
    /// Of those that do at the end, with constraints at position level: the largest so far, times and values at the ends of the last steps.
    latest: Option<Vec<(f64, Vec<[f64; 2]>)>>,
    work: GroupWork<S>,
}

impl<'f, S: RunScalar> Values<'f, S> {
    /// For a real run: offsets of aggregates are found on the way.
    pub fn new(functionals: &'f [Functional], model: &'f Model, table: &'f Table, p: &'f [S]) -> Self {
        let older = table.quadrature.carried.len().max(1);
        let sums = |functional: &Functional| match functional.over.times() {
            // until it is read
            Times::Start | Times::End => vec![[S::from(f64::NAN); SUMS]],
            Times::Run => vec![[S::zero(); SUMS]; older],
        };
        Values {
            functionals,
            model,
            table,
            parameters: RunParameters::new(model, p),
            following: true,
            offsets: functionals.iter().map(|functional| functional.over.first_offset()).collect(),
            seen: vec![None; functionals.len()],
            sums: functionals.iter().map(sums).collect(),
            last: None,
            sample: Sample::empty(),
            reading: functionals.iter().any(Functional::reads_multipliers),
            latest: None,
            work: GroupWork::shared(),
        }
    }

    /// For a run with derivative parts: offsets are those of the real run.
    pub fn along(
        functionals: &'f [Functional],
        model: &'f Model,
        table: &'f Table,
        p: &'f [S],
        totals: &[Totals<f64>],
    ) -> Self {
        let offsets = totals.iter().map(|totals| totals.offset).collect();
        Values { following: false, offsets, ..Self::new(functionals, model, table, p) }
    }

    /// Watches whether what is read at the end swings from step to step.
    pub fn watch_swings(&mut self) {
        self.latest = self.reading.then(|| vec![(0.0, Vec::new()); self.functionals.len()]);
    }

    /// With which share of their largest value functionals that read multipliers at the end alternate from each of the last steps to the next: a
    /// quarter of the least change of their slope, times the step, where these changes alternate, too. A jump changes the slope twice.
    pub fn swings(&self) -> Vec<f64> {
        let of = |(largest, own): &(f64, Vec<[f64; 2]>)| {
            let slopes: Vec<f64> =
                own.windows(2).map(|ends| (ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0])).collect();
            let changes: Vec<f64> = slopes.windows(2).map(|pair| pair[1] - pair[0]).collect();
            match (&own[..], &changes[..]) {
                ([.., c, d], [first, second, third]) if first * second < 0.0 && second * third < 0.0 => {
                    let least = first.abs().min(second.abs()).min(third.abs());
                    least * (d[0] - c[0]) / (4.0 * largest)
                }
                _ => 0.0,
            }
        };
        self.latest.iter().flatten().map(of).collect()
    }

    /// Adds what functional `k` reads at a sample with a weight in time.
    fn add(&mut self, k: usize, sample: &Sample<S>, weight: S) {
        let Functional { measured, over, .. } = &self.functionals[k];
        let (sums, offset, work) = (&mut self.sums[k], &mut self.offsets[k], &mut self.work);
        measured.write_values(self.model, sample, self.parameters.p(), over.points(), work);
        if let Some(aggregate) = over.aggregate() {
            if self.following {
                follow(&mut self.seen[k], sample.t.value(), work.values.iter().map(|[y, _]| y.value()));
            }
            if weight.value() == 0.0 {
                // far above all others it would make nothing of them as the offset, and infinity of itself without
                return;
            }
            let before = *offset;
            if self.following {
                *offset = aggregate.following(before, &work.values);
            }
            if *offset > before {
                let smaller = aggregate.kernel(before, *offset);
                sums.iter_mut().for_each(|sums| sums[..2].iter_mut().for_each(|sum| *sum *= S::from(smaller)));
            }
        }
        over.add_terms(&work.values, *offset, weight, &mut sums[0]);
    }

    /// Reads functional `k` at its only sample.
    fn read(&mut self, k: usize, sample: &Sample<S>) {
        self.sums[k][0] = [S::zero(); SUMS];
        self.add(k, sample, S::one());
    }

    /// Functionals that read at some times.
    fn at(&self, times: Times) -> impl Iterator<Item = usize> + use<'f, S> {
        let functionals = self.functionals;
        (0..functionals.len()).filter(move |&k| functionals[k].over.times() == times)
    }

    /// The start of the run.
    pub fn start(&mut self, start: &StartRecord<S>) {
        self.parameters.start(start);
        for k in self.at(Times::Start) {
            let mut sample = Sample::initial(start);
            sample.follow(start.clock);
            if self.functionals[k].reads_multipliers() {
                sample.share(self.model, self.parameters.p());
            }
            self.read(k, &sample);
        }
    }

    /// A finished step.
    pub fn step(&mut self, step: &StepRecord<S>) {
        let clock = step.clock;
        self.parameters.step(step);
        if self.at(Times::End).next().is_some() {
            let last = self.last.get_or_insert_with(Sample::empty);
            last.set_end(step);
            last.follow_events(step, self.parameters.p());
        }
        if self.latest.is_some() {
            self.note_latest();
        }
        if self.at(Times::Run).next().is_none() {
            return;
        }
        let scheme = self.table.scheme(step.scheme);
        let Combination { carried, stages } = &scheme.quadrature;
        for k in self.at(Times::Run) {
            if self.functionals[k].over.counts_samples() {
                continue;
            }
            let sums = &mut self.sums[k];
            let latest = std::array::from_fn(|i| sums.iter().zip(carried).map(|(sum, &factor)| sum[i] * factor).sum());
            sums.rotate_right(1);
            sums[0] = latest;
        }
        let mut sample = std::mem::replace(&mut self.sample, Sample::empty());
        for (stage, (integral, aggregate)) in stages.iter().zip(&scheme.aggregate_weights).enumerate() {
            sample.set_stage(step, stage);
            sample.follow(clock);
            if self.reading {
                sample.share(self.model, self.parameters.p());
            }
            let weight = StageWeight { integral: step.h * integral, aggregate: step.h * aggregate };
            for k in self.at(Times::Run) {
                let over = &self.functionals[k].over;
                let mut in_time = S::from(over.time_weight(weight));
                if !over.counts_samples() {
                    in_time *= step.length();
                }
                self.add(k, &sample, in_time);
            }
        }
        self.sample = sample;
    }

    fn note_latest(&mut self) {
        let (Some(mut last), Some(mut latest)) = (self.last.take(), self.latest.take()) else { return };
        last.share(self.model, self.parameters.p());
        for k in self.at(Times::End).filter(|&k| self.functionals[k].reads_multipliers()).collect::<Vec<_>>() {
            self.read(k, &last);
            let ((largest, own), value) = (&mut latest[k], self.so_far(k).value());
            *largest = largest.max(value.abs());
            if own.len() == LATEST {
                own.remove(0);
            }
            own.push([last.t.value(), value]);
        }
        (self.last, self.latest) = (Some(last), Some(latest));
    }

    /// What an integral is so far.
    pub fn so_far(&self, k: usize) -> S {
        self.functionals[k].over.value(Totals { offset: self.offsets[k], sums: self.sums[k][0] })
    }

    /// The values at the end of the last step, the sums of which they are made, and smallest and largest values of aggregates.
    pub fn finish(mut self) -> (Vec<S>, Vec<Totals<S>>, Vec<Option<Extremes>>) {
        if let Some(mut last) = self.last.take() {
            if self.reading {
                last.share(self.model, self.parameters.p());
            }
            for k in self.at(Times::End) {
                self.read(k, &last);
            }
        }
        let totals = |(sums, &offset): (&Vec<[S; SUMS]>, &f64)| Totals { offset, sums: sums[0] };
        let totals: Vec<Totals<S>> = self.sums.iter().zip(&self.offsets).map(totals).collect();
        let values = self.functionals.iter().zip(&totals).map(|(functional, &totals)| functional.over.value(totals));
        let extremes = self.functionals.iter().zip(&self.seen).map(|(functional, &seen)| {
            let [smallest, largest] = seen?.map(|(value, t, place)| {
                let element = match &functional.measured {
                    Measured::Group(group) => group.element_of(self.model, place),
                    _ => None,
                };
                Extreme { value, t, element: element.map(|id| self.model.elements[id.0].name.clone()) }
            });
            Some(Extremes { smallest, largest })
        });
        (values.collect(), totals, extremes.collect())
    }
}
