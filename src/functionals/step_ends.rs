use super::Sample;
use crate::assembly::TermPoint;
use crate::elements::RunScalar;
use crate::integrators::{StepRecord, Table};

/// Samples at the ends of steps, one after the other. A method whose last stage lies there has accelerations and multipliers of its own; those of
/// the others are means over steps, and what stands at the end of a step is between those of two.
pub struct StepEnds<'t, S> {
    table: &'t Table,
    /// What was handed out last, and before that.
    handed: [Option<Mean<S>>; 2],
    /// The end of the latest step, whose next one is awaited, and its mean.
    latest: Option<(Sample<S>, Mean<S>)>,
}

/// Acceleration and multipliers of a step, and the time at which they stand.
struct Mean<S> {
    t: f64,
    a: Vec<S>,
    mu: Vec<S>,
}

impl<S: RunScalar> Mean<S> {
    /// The mean over the stages by their weights: where their times have their mean. A variational integrator's reactions act at the start of a step.
    fn of(table: &Table, step: &StepRecord<S>) -> Self {
        let mut mean = Mean { t: 0.0, a: Vec::new(), mu: Vec::new() };
        let (mut a, mut total) = (Vec::new(), 0.0);
        for (stage, &weight) in step.stages.iter().zip(&table.scheme(step.scheme).quadrature.stages) {
            let solve = &stage.solve;
            solve.write_acceleration(&mut a);
            if let Some(clock) = step.clock {
                a.iter_mut().for_each(|a| *a *= clock.pace() * clock.pace());
            }
            mean.t += weight * solve.equations.time_at(TermPoint::Reactions, solve.t);
            total += weight;
            for (sum, own) in [(&mut mean.a, &a), (&mut mean.mu, &solve.unknowns.mu)] {
                sum.resize(own.len(), S::zero());
                sum.iter_mut().zip(own).for_each(|(sum, &own)| *sum += own * weight);
            }
        }
        mean.t /= total;
        mean
    }

    /// On the straight line through two at the time of a sample.
    fn write_between(first: &Self, second: &Self, sample: &mut Sample<S>) {
        let share = (sample.t.value() - first.t) / (second.t - first.t);
        let lists = [(&mut sample.at.a, &first.a, &second.a), (&mut sample.mu, &first.mu, &second.mu)];
        for (to, first, second) in lists {
            to.clear();
            to.extend(first.iter().zip(second).map(|(&first, &second)| first + (second - first) * share));
        }
    }
}

impl<'t, S: RunScalar> StepEnds<'t, S> {
    /// Before the first step of a method.
    pub fn new(table: &'t Table) -> Self {
        StepEnds { table, handed: [None, None], latest: None }
    }

    /// Takes note of a step; returns the end of a step that is known now: its own, or that of the step before.
    pub fn add(&mut self, step: &StepRecord<S>) -> Option<Sample<S>> {
        let mut end = Sample::empty();
        end.set_end(step);
        if self.table.stiffly_accurate {
            return Some(end);
        }
        let mean = Mean::of(self.table, step);
        let (mut sample, own) = self.latest.replace((end, mean))?;
        let (next, mean) = self.latest.as_ref()?;
        // other equations left out, or other forces behind an event: other multipliers
        if next.dropped == sample.dropped && step.switched.is_empty() {
            Mean::write_between(&own, mean, &mut sample);
            let known = Mean { t: sample.t.value(), a: sample.at.a.clone(), mu: sample.mu.clone() };
            self.handed = [Some(known), self.handed[0].take()];
        } else {
            self.handed = [None, None];
        }
        Some(sample)
    }

    /// The end of the last step, where it was not handed out yet: as the ends of the two before go on, in which what oscillates from step to step
    /// has its mean.
    pub fn end(&mut self) -> Option<Sample<S>> {
        let (mut sample, own) = self.latest.take()?;
        match &std::mem::take(&mut self.handed) {
            [Some(known), Some(before)] => Mean::write_between(before, known, &mut sample),
            [Some(known), None] if own.t > known.t => Mean::write_between(known, &own, &mut sample),
            _ => {}
        }
        Some(sample)
    }
}
