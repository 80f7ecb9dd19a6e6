//! Where in a step a switch first changes its side.

use super::events::SideChange;
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::{Checkpoint, RunError};
use crate::design::shortest;
use crate::elements::RunScalar;
use crate::program::Excess;

/// Share of a step by which one is prolonged to an event, so that none is left over that is much shorter.
const PROLONGED: f64 = 0.1;
/// Most steps that are made to locate one event.
const MOST_TRIALS: usize = 60;
/// Share of a step within which a switch that has just changed its side cannot change back: the motion goes along it.
const AT_ONCE: f64 = 1e-9;

/// A switch that may change its side, after some time of the step \[s\].
struct Candidate {
    switch: usize,
    after: f64,
    /// Times between which it does, where they are known.
    bracket: [f64; 2],
    /// Whether it changes at the end of the step.
    is_sure: bool,
}

/// The step made last was one from `t` to `end`; makes it end at the first switch that changes its side in it. Returns its end then, and all sides
/// that change there, the first before the others.
pub(super) fn locate<S: RunScalar>(
    stepper: &mut Stepper<S>,
    before: &Checkpoint<S>,
    interval: &mut RunInterval,
    (t, end): (f64, f64),
) -> Result<Option<(f64, Vec<SideChange>)>, RunError> {
    let (starts, mut ends) = (stepper.excesses(true), stepper.excesses(false));
    let (h, most) = (end - t, interval.next_breakpoint() - t);
    let whole = ends.clone();
    // those that come near the end of their sides without passing it
    let mut passed = Vec::new();
    let first = |ends: &[Excess], h: f64, passed: &[usize]| {
        let all = starts.iter().zip(ends).enumerate().filter(|(switch, _)| !passed.contains(switch));
        let candidates = all.filter_map(|(switch, (start, end))| candidate(switch, (start, end), (t, h), most));
        candidates.min_by(|one, other| one.after.total_cmp(&other.after))
    };
    let Some(mut own) = first(&ends, h, &passed) else { return Ok(None) };
    let scheme = stepper.method.table.starting_scheme();
    let is_made = stepper.record().scheme == scheme;
    let (mut made, mut trials) = (if is_made { h } else { f64::NAN }, 0);
    loop {
        let Candidate { switch, after, bracket: [low, high], .. } = own;
        trials += 1;
        if trials > MOST_TRIALS {
            return Err(RunError::Input(format!(
                "the time at which {} passes from one piece of its formula to another is not found: it jumps there by itself",
                place(stepper, switch, t + made)
            )));
        }
        // the end of the step is what is rounded
        let next = (t + after) - t;
        if next <= 0.0 {
            return Err(goes_along(stepper, switch, t));
        }
        if next != made {
            stepper.resume(before)?;
            match stepper.step_over(scheme, (t, t + next), interval.at_breakpoint(), None) {
                Ok(()) => {}
                // formulas need not be defined beyond the end of a side
                Err(failure) if failure.is_of_step() && next > low => {
                    own = Candidate { after: 0.5 * (low + next), bracket: [low, next], is_sure: true, ..own };
                    continue;
                }
                Err(failure) => return Err(failure),
            }
            made = next;
            ends = stepper.excesses(false);
        }
        let Excess { by, rate, .. } = ends[switch];
        let near = ends[switch].round_off(t + made);
        let is_beyond = by > 0.0;
        let [low, high] = if is_beyond { [low, made] } else { [made, high] };
        let newton = made - by / rate;
        let is_last = by.abs() <= near || t + newton == t + made || (t + low).next_up() >= t + high;
        if !is_last {
            let is_within = newton > low && newton < high && rate > 0.0;
            if !is_within && !own.is_sure && !is_beyond {
                passed.push(switch);
                match first(&whole, h, &passed) {
                    Some(other) => own = other,
                    None => return unmade(stepper, before, interval, (t, end)),
                }
                continue;
            }
            let after = if is_within { newton } else { 0.5 * (low + high) };
            own = Candidate { after, bracket: [low, high], is_sure: own.is_sure || is_beyond, ..own };
            continue;
        }
        // another one may have changed before, and even back again
        let is_earlier = |other: &Candidate| {
            let Excess { by, .. } = ends[other.switch];
            other.switch != switch && other.after < made && !(other.is_sure && by <= ends[other.switch].round_off(t + made))
        };
        if let Some(earlier) = first(&ends, made, &passed).filter(is_earlier) {
            own = earlier;
            continue;
        }
        if made <= AT_ONCE * h && stepper.record().switched.iter().any(|change| change.switch == switch) {
            return Err(goes_along(stepper, switch, t + made));
        }
        return Ok(Some((t + made, changes(stepper, switch, &ends, t + made))));
    }
}

fn place<S: RunScalar>(stepper: &Stepper<S>, switch: usize, t: f64) -> String {
    let part = stepper.events.as_ref().map_or("", |events| events.part_of(switch));
    format!("\"{part}\" at t = {} s", shortest(t))
}

fn goes_along<S: RunScalar>(stepper: &Stepper<S>, switch: usize, t: f64) -> RunError {
    RunError::Input(format!(
        "{} changes back at once: the motion goes along the switch of its formula instead of passing it, as a body that sticks goes along the \
         change of sign of its velocity; make the formula smooth there, by a slope over a small width",
        place(stepper, switch, t)
    ))
}

/// The whole step again: no switch changes in it.
fn unmade<S: RunScalar>(
    stepper: &mut Stepper<S>,
    before: &Checkpoint<S>,
    interval: &mut RunInterval,
    (t, end): (f64, f64),
) -> Result<Option<(f64, Vec<SideChange>)>, RunError> {
    stepper.resume(before)?;
    let scheme = interval.scheme_to(&stepper.method.table, end);
    stepper.step_over(scheme, (t, end), interval.at_breakpoint(), None)?;
    Ok(None)
}

/// All sides that change with that of a switch: those beyond their ends, or on the way there.
fn changes<S: RunScalar>(stepper: &Stepper<S>, switch: usize, ends: &[Excess], t: f64) -> Vec<SideChange> {
    let sides = &stepper.between.sides;
    let change = |switch: usize| SideChange { switch, sides: [sides[switch], ends[switch].other] };
    let others = (0..ends.len()).filter(|&other| other != switch && ends[other].is_passed(t));
    [switch].into_iter().chain(others).map(change).collect()
}

/// Whether a switch changes its side in a step from `t` that takes `h`, or shortly behind it, but within the `most` that it may take.
fn candidate(switch: usize, (start, end): (&Excess, &Excess), (t, h): (f64, f64), most: f64) -> Option<Candidate> {
    let is_at_end = start.by.abs() <= start.round_off(t);
    let by = if is_at_end { 0.0 } else { start.by };
    // of the cubic through both ends
    let cubic = |share: f64| {
        let rest = 1.0 - share;
        rest * rest * ((1.0 + 2.0 * share) * by + share * h * start.rate)
            + share * share * ((3.0 - 2.0 * share) * end.by - rest * h * end.rate)
    };
    let root = |mut low: f64, mut high: f64| {
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *(if cubic(middle) > 0.0 { &mut high } else { &mut low }) = middle;
        }
        0.5 * (low + high)
    };
    let is_beyond = end.by > end.round_off(t + h);
    let mut shares = (1..16).map(|k| f64::from(k) / 16.0);
    if is_beyond {
        // it leaves the end of its side before it comes back
        let low = if by < 0.0 { 0.0 } else { shares.clone().find(|&share| cubic(share) < 0.0).unwrap_or(0.0) };
        let high = shares.into_iter().find(|&share| share > low && cubic(share) > 0.0).unwrap_or(1.0);
        let after = if by < 0.0 || low > 0.0 { h * root(low, high) } else { 0.0 };
        let bracket = [if by < 0.0 { 0.0 } else { h * low }, h];
        return Some(Candidate { switch, after, bracket, is_sure: true });
    }
    if (by < 0.0 || is_at_end && start.rate < 0.0) && end.rate < 0.0 {
        // in between it may have been beyond
        let beyond = shares.find(|&share| cubic(share) > 0.0)?;
        return Some(Candidate { switch, after: h * beyond, bracket: [0.0, f64::INFINITY], is_sure: false });
    }
    let prolonged = (1.0 + PROLONGED) * h;
    let after = h - end.by / end.rate;
    (end.rate > 0.0 && after <= prolonged.min(most)).then_some(Candidate {
        switch,
        after,
        bracket: [0.0, prolonged.min(most)],
        is_sure: false,
    })
}
