//! So many moments of a run as a page can show.

use super::snapshot::{MOST_POINTS, Snapshot};
use costate::history::Observer;
use costate::integrators::{RunError, StartRecord, StepRecord};

/// Every so many-th moment, and the last one.
pub struct KeptMoments {
    moments: Vec<Snapshot>,
    /// How many moments come for one that is kept; doubles when too many are kept.
    stride: usize,
    last: Option<Snapshot>,
    count: usize,
}

impl Default for KeptMoments {
    fn default() -> Self {
        KeptMoments { moments: Vec::new(), stride: 1, last: None, count: 0 }
    }
}

impl KeptMoments {
    pub fn add(&mut self, moment: Snapshot) {
        if self.count.is_multiple_of(self.stride) {
            self.moments.push(moment.clone());
            if self.moments.len() > 2 * MOST_POINTS {
                let mut index = 0;
                self.moments.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.stride *= 2;
            }
        }
        self.last = Some(moment);
        self.count += 1;
    }

    pub fn finish(mut self) -> Vec<Snapshot> {
        self.moments.extend(self.last.filter(|last| self.moments.last() != Some(last)));
        self.moments
    }
}

/// Keeps the ends of steps of a run of which nothing else is wanted.
impl Observer for KeptMoments {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        let record = &start.acceleration;
        self.add(Snapshot { t: record.t, q: record.base.q.clone(), ..Snapshot::default() });
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.add(Snapshot { t: step.t + step.h, q: step.q.clone(), ..Snapshot::default() });
        Ok(true)
    }
}
