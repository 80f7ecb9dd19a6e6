//! When events happened in a run.

use super::{Analysis, Forward};
use crate::assembly::{JointFriction, VectorsAvq};
use crate::integrators::{Events, RunError};
use crate::tolerances::CONSISTENT;

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

    /// That no surfaces began to slip from standstill in a direction of two that is that of a force: its derivatives are not taken along.
    pub(super) fn check_directions(&self, forward: &Forward) -> Result<(), RunError> {
        let both: Vec<_> = self.model.frictions.iter().enumerate().filter(|(_, own)| own.kept.len() == 2).collect();
        if both.is_empty() {
            return Ok(());
        }
        let (events, start) = (Events::new(self.model), forward.history.start_record());
        let begins = |own: &JointFriction| &self.model.events[own.events[1]].condition.name;
        let happened = self.events(forward);
        let turned = both.into_iter().find(|(friction, own)| {
            let from_rest = start.is_some_and(|start| {
                let (VectorsAvq { v, q, .. }, p) = (&start.acceleration.base, &forward.numbers.p);
                let slip = events.slip(*friction, [v, q], 0.0, p);
                let speed = v.iter().fold(1.0, |most: f64, own| most.max(own.abs()));
                let is_slipping = events.direction(*friction, &start.sides).iter().any(|own| *own != 0.0);
                is_slipping && slip.iter().all(|own| own.abs() <= CONSISTENT * speed)
            });
            from_rest || happened.iter().any(|event| event.name == *begins(own))
        });
        let Some((_, own)) = turned else { return Ok(()) };
        let name = &self.model.constraints[own.joints[0]].name;
        Err(RunError::Input(format!(
            "surfaces of \"{name}\" begin to slip from standstill, in the direction of the force that breaks them away, which a change of the design turns: \
             derivatives of that direction are not known; where they slip along a line, guide them by a joint with [[friction]]"
        )))
    }

    /// The events of a run in the order of their times.
    pub fn events(&self, forward: &Forward) -> Vec<EventTime> {
        if self.model.events.is_empty() {
            return Vec::new();
        }
        let (events, mut all) = (Events::new(self.model), Vec::new());
        let mut sides = vec![0.0; events.sides_count()];
        for (place, changes) in forward.grid.changes() {
            for event in events.happening(changes, &sides) {
                let name = self.model.events[event].condition.name.clone();
                all.push(EventTime { name, t: forward.grid.times[place] });
            }
            changes.iter().for_each(|change| sides[change.switch] = change.sides[1]);
        }
        all
    }
}
