//! When events happened in a run.

use super::{Analysis, Forward};
use crate::integrators::Events;

/// An event that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct EventTime {
    /// Name of the event, stop or latch.
    pub name: String,
    /// When \[s\].
    pub t: f64,
}

impl Analysis<'_> {
    /// Whether a run that an event should end has come to the end that was laid.
    #[doc(hidden)]
    pub fn runs_beyond_its_end(&self, forward: &Forward) -> bool {
        let ends = |name: &str| self.model.events.iter().any(|own| own.ends_run && own.condition.name == name);
        self.model.events.iter().any(|own| own.ends_run)
            && self
                .events(forward)
                .last()
                .is_none_or(|last| !ends(&last.name) || last.t < forward.grid.times[forward.grid.steps()])
    }

    /// The events of a run in the order of their times.
    pub fn events(&self, forward: &Forward) -> Vec<EventTime> {
        if self.model.events.is_empty() {
            return Vec::new();
        }
        let (events, mut all) = (Events::new(self.model), Vec::new());
        let mut sides = vec![0.0; events.sides_count()];
        for (&place, changes) in &forward.grid.events {
            for event in events.happening(changes, &sides) {
                let name = self.model.events[event].condition.name.clone();
                all.push(EventTime { name, t: forward.grid.times[place] });
            }
            changes.iter().for_each(|change| sides[change.switch] = change.sides[1]);
        }
        all
    }
}
