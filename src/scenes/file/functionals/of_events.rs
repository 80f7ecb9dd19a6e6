//! When events happen, and how hard stops are hit.

use super::{Measurand, measurand};
use crate::functionals::Over;
use crate::scenes::file::describing::*;

pub(super) const EVENT_TIME: Measurand = measurand(
    "event_time",
    "the time at which an event happens [s]; over = \"terminal\"",
    &[
        need(
            "event",
            Type::Item(&["event", "stop", "latch", "contact", "friction", "clutch"]),
            "name of an event, of a stop, latch or contact that is hit, of a friction or clutch",
        ),
        may(
            "which",
            Choice(&["stick", "slip"]),
            "where surfaces come to stick, or where they begin to slip; of a friction or clutch needed, of a contact where it is hit",
        ),
        may("number", Count(1, 1_000_000), "for which time it happens, counted from 1; 1"),
    ],
    |e, over, m| {
        if over != Over::Terminal {
            return e.wrong_key("over", "the time of an event is one number: write over = \"terminal\"");
        }
        let event = match e.built("event")? {
            Built::Event(event) => event,
            Built::Contact(_, hit, friction) => match (e.text("which"), friction) {
                (None, _) => hit,
                (Some("stick"), Some([stick, _])) => stick,
                (Some(_), Some([_, slip])) => slip,
                (Some(_), None) => return e.wrong_key("which", "this contact has no friction: it does not stick"),
            },
            Built::Friction([stick, slip]) => match e.text("which") {
                Some("stick") => stick,
                Some(_) => slip,
                None => return e.wrong_key("event", "of a friction, tell which: stick or slip"),
            },
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
    &[need("event", Type::Item(&["stop", "latch", "contact"]), "name of a stop, latch or contact")],
    |e, over, m| {
        if over != Over::Terminal {
            return e.wrong_key("over", "impulses of a run are one number: write over = \"terminal\"");
        }
        let hits: Vec<usize> = match e.built("event")? {
            Built::Stops(own) => own.iter().map(|own| own.1).collect(),
            Built::Contact(_, hit, _) => vec![*hit],
            _ => Vec::new(),
        };
        if !hits.is_empty() {
            m.impulse_functional(e.name(), &hits);
        }
        Ok(())
    },
);
