//! When events happen.

use super::{Measurand, measurand};
use crate::functionals::Over;
use crate::scenes::file::describing::*;

pub(super) const EVENT_TIME: Measurand = measurand(
    "event_time",
    "the time at which an event happens [s]; over = \"terminal\"",
    &[
        need("event", Type::Item(&["event"]), "name of an event"),
        may("number", Count(1, 1_000_000), "for which time it happens, counted from 1; 1"),
    ],
    |e, over, m| {
        if over != Over::Terminal {
            return e.wrong_key("over", "the time of an event is one number: write over = \"terminal\"");
        }
        let Built::Event(event) = e.built("event")? else { return Ok(()) };
        let number = if e.has("number") { e.count("number") } else { 1 };
        m.event_time_functional(e.name(), *event, number);
        Ok(())
    },
);
