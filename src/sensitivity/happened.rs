//! When events happened in a run.

use super::{Analysis, Forward};
use crate::assembly::{JointFriction, VectorsAvq};
use crate::integrators::{Events, RunError, SideChange};
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
        let has_ended = |own: &EventTime| ends(&own.name) && own.t >= forward.grid.times[forward.grid.steps()];
        self.model.events.iter().any(|own| own.ends_run) && !self.events(forward).iter().any(has_ended)
    }

    /// That no surfaces began to slip from standstill in a direction of two that is that of a force which jumps: its derivatives are not taken along.
    pub(super) fn check_directions(&self, forward: &Forward) -> Result<(), RunError> {
        let both: Vec<_> = self.model.frictions.iter().enumerate().filter(|(_, own)| own.kept.len() == 2).collect();
        if both.is_empty() {
            return Ok(());
        }
        let (events, start) = (Events::new(self.model), forward.history.start_record());
        let from_rest = |friction: usize| {
            start.is_some_and(|start| {
                let (VectorsAvq { v, q, .. }, p) = (&start.acceleration.base, &forward.numbers.p);
                let slip = events.slip(friction, [v, q], 0.0, p);
                let speed = v.iter().fold(1.0, |most: f64, own| most.max(own.abs()));
                let is_slipping = events.direction(friction, &start.sides).iter().any(|own| *own != 0.0);
                is_slipping && slip.iter().all(|own| own.abs() <= CONSISTENT * speed)
            })
        };
        let happens = |friction: usize, event: usize, (place, changes): (usize, &[SideChange])| {
            let is_located = forward.grid.events.contains_key(&place) && events.is_condition(changes[0].switch, event);
            let mut sides = vec![0.0; events.sides_count()];
            changes.iter().for_each(|change| sides[change.switch] = change.sides[1]);
            let slips = events.direction(friction, &sides).iter().any(|own| *own != 0.0);
            !is_located && slips && events.happening(changes, &[]).contains(&event)
        };
        let jumps = |friction: usize, event: usize| forward.grid.changes().any(|change| happens(friction, event, change));
        let is_unknown = |(friction, own): &(usize, &JointFriction)| from_rest(*friction) || jumps(*friction, own.events[1]);
        let Some((_, own)) = both.into_iter().find(is_unknown) else { return Ok(()) };
        let name = &self.model.constraints[own.joints[0]].name;
        Err(RunError::Input(format!(
            "surfaces of \"{name}\" begin to slip from standstill in the direction of a force that jumps, or that it has at the start: derivatives of \
             that direction are not known; let the force grow, or guide the surfaces along a line by a joint with [[friction]]"
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
