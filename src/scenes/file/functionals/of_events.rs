//! When events happen, and how hard stops are hit.

use super::{Measurand, measurand};
use crate::functionals::Over;
use crate::scenes::file::describing::*;

pub(super) const EVENT_TIME: Measurand = measurand(
    "event_time",
    "the time at which an event happens [s]; over = \"terminal\"",
    &[
        need("event", Type::Item(&["event", "stop", "latch"]), "name of an event, or of a stop or latch that is hit"),
        may("number", Count(1, 1_000_000), "for which time it happens, counted from 1; 1"),
    ],
    |e, over, m| {
        if over != Over::Terminal {
            return e.wrong_key("over", "the time of an event is one number: write over = \"terminal\"");
        }
        let event = match e.built("event")? {
            Built::Event(event) => event,
            Built::Stops(own) if own.len() == 1 => &own[0].1,
            Built::Stops(_) => {
                return e.wrong_key("event", "this stop has two limits: write one stop for each to tell their hits apart");
            }
            _ => return Ok(()),
        };
        let number = if e.has("number") { e.count("number") } else { 1 };
        m.event_time_functional(e.name(), *event, number);
        Ok(())
    },
);

pub(super) const IMPULSE: Measurand = measurand(
    "impulse",
    "the sum of the sizes of all impulses with which a stop or latch is hit [N s, N m s]; over = \"terminal\"",
    &[need("event", Type::Item(&["stop", "latch"]), "name of a stop or latch")],
    |e, over, m| {
        if over != Over::Terminal {
            return e.wrong_key("over", "impulses of a run are one number: write over = \"terminal\"");
        }
        if let Built::Stops(own) = e.built("event")? {
            let hits: Vec<usize> = own.iter().map(|own| own.1).collect();
            m.impulse_functional(e.name(), &hits);
        }
        Ok(())
    },
);
