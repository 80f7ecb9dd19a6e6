//! Where in a step a switch first changes its side.

use super::events::SideChange;
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::{Checkpoint, RunError, Scheme};
use crate::design::shortest;
use crate::elements::RunScalar;
use crate::program::Excess;

/// Share of a step by which one is prolonged to an event, so that none is left over that is much shorter.
const PROLONGED: f64 = 0.1;
/// Share of a step up to which Euler's makes one that ends at an event, or that an event begins and something else ends: its error is round-off.
pub(super) const SHORTEST: f64 = 1e-6;
/// Most steps that are made to locate one event.
const MOST_TRIALS: usize = 200;
/// Trials behind which what joints leave of a number is taken for zero, and those behind which only halves of the bracket are tried.
const FEW: usize = 8;
const MANY: usize = 20;
/// Most doubles by which a step is made longer so that it ends beyond the end of a side.
const BEYOND: usize = 4;
/// Share of what a number moves in a step that it does not move within a rounding of the time.
const JUMPS: f64 = 1e-6;
/// Share of a step within which a switch that has just changed its side cannot change back: the motion goes along it.
const AT_ONCE: f64 = 1e-9;
/// Share of the time until which a number was expected on its side, up to which it is where it was not.
const BACK: f64 = 0.1;
/// Share of a step within which one that does so again and again is as good as that, and how often it may.
const CLOSE_BY: f64 = 1e-5;
const MOST_CLOSE_BY: usize = 50;

/// What else there is to do about switches of formulas.
const NOT_LOCATED: &str = "; take shorter steps where these do not resolve the motion; with locate = false in the settings steps do not end at switches";

/// A switch that may change its side, after some time of the step \[s\].
struct Candidate {
    switch: usize,
    after: f64,
    /// Times between which it does, where they are known, and which of them steps have shown.
    bracket: [f64; 2],
    is_shown: [bool; 2],
    /// Whether it changes at the end of the step.
    is_sure: bool,
}

/// The step made last was one from `t` to `end`; makes it end at the first switch that changes its side in it. `undefined` is an end up to which no step
/// could be made. Returns its end then, and all sides that change there, the first before the others.
pub(super) fn locate<S: RunScalar>(
    stepper: &mut Stepper<S>,
    before: &Checkpoint<S>,
    interval: &mut RunInterval,
    (t, end): (f64, f64),
    undefined: Option<f64>,
) -> Result<Option<(f64, Vec<SideChange>)>, RunError> {
    let (starts, mut ends) = (stepper.excesses(true), stepper.excesses(false));
    let h = end - t;
    let most = undefined.unwrap_or_else(|| (t + (1.0 + PROLONGED) * h).min(interval.next_breakpoint())) - t;
    let whole = ends.clone();
    // those that come near the end of their sides without passing it
    let mut passed = Vec::new();
    let scheme = stepper.method.table.starting_scheme();
    let is_made = stepper.record().scheme == scheme;
    let scheme_of = |length: f64| if length <= SHORTEST * h { Scheme::Euler } else { scheme };
    let first = |ends: &[Excess], h: f64, passed: &[usize]| {
        let all = starts.iter().zip(ends).enumerate().filter(|(switch, _)| !passed.contains(switch));
        let candidates = all.filter_map(|(switch, (start, end))| candidate(switch, (start, end), (t, h), most));
        let own = candidates.min_by(|one, other| one.after.total_cmp(&other.after))?;
        Some(Candidate { is_shown: [own.is_shown[0], own.is_shown[1] && is_made], ..own })
    };
    let Some(mut own) = first(&ends, h, &passed) else { return Ok(None) };
    let (mut made, mut trials) = (if is_made { h } else { f64::NAN }, 0);
    loop {
        let Candidate { switch, after, bracket: [low, high], .. } = own;
        trials += 1;
        if trials > MOST_TRIALS {
            if let Some(failure) = unresolved(stepper, switch, t + after) {
                return Err(failure);
            }
            return Err(RunError::Input(format!(
                "the time at which {} passes from one piece of its formula to another is not found: it jumps there by itself{NOT_LOCATED}",
                place(stepper, switch, t + after)
            )));
        }
        // the end of the step is what is rounded
        let next = (t + after) - t;
        let has_just = is_just_switched(stepper, switch);
        if next <= 0.0 || has_just && next <= AT_ONCE * h {
            // by round-off it may lie beyond where it begins to leave
            if whole[switch].by <= whole[switch].noise(t + h) {
                passed.push(switch);
                match first(&whole, h, &passed) {
                    Some(other) => own = other,
                    None => return unmade(stepper, before, interval, (t, end)),
                }
                continue;
            }
            if stepper.has_no_force(switch, &starts[switch]) && stepper.close_by < MOST_CLOSE_BY {
                // what has come to hold without a force, and would be torn off, holds no longer
                stepper.close_by += 1;
                stepper.planned = h;
                stepper.resume(before)?;
                let end = t.next_up();
                stepper.step_over(Scheme::Euler, (t, end), interval.at_breakpoint(), None)?;
                let ends = stepper.excesses(false);
                return Ok(Some((end, changes(stepper, switch, &ends, end))));
            }
            made = f64::NAN;
            let Some([low, high]) = back_again(stepper, before, interval, (switch, t, h))? else {
                return Err(goes_along(stepper, switch, t + next));
            };
            own = Candidate { after: 0.5 * (low + high), bracket: [low, high], is_shown: [true; 2], is_sure: true, ..own };
            continue;
        }
        if next != made {
            stepper.resume(before)?;
            match stepper.step_over(scheme_of(next), (t, t + next), interval.at_breakpoint(), None) {
                Ok(()) => {}
                // formulas need not be defined beyond the end of a side
                Err(failure) if failure.is_of_step() && next > low => {
                    // nothing is left of the step before
                    made = f64::NAN;
                    let is_shown = [own.is_shown[0], true];
                    own = Candidate { after: 0.5 * (low + next), bracket: [low, next], is_shown, is_sure: true, ..own };
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
        let is_shown = [own.is_shown[0] || !is_beyond, own.is_shown[1] || is_beyond];
        let newton = made - by / rate;
        let [low, high] = match if is_beyond { [low, made] } else { [made, high] } {
            // the course was another one
            [low, high] if !is_shown[0] && (newton <= low || newton.is_nan()) => [BACK * low, high],
            [low, high] if !is_shown[1] && newton >= high => [low, (2.0 * h).min(interval.next_breakpoint() - t).max(high)],
            bracket => bracket,
        };
        let is_closed = (t + low).next_up() >= t + high;
        let is_zero = by.abs() <= if trials > FEW { ends[switch].noise(t + made) } else { near };
        let is_last = is_zero || t + newton == t + made || is_closed;
        if !is_last {
            let is_within = newton > low && newton < high && rate > 0.0 && (trials < MANY || high.is_infinite());
            if !is_within && !own.is_sure && !is_beyond {
                passed.push(switch);
                match first(&whole, h, &passed) {
                    Some(other) => own = other,
                    None => return unmade(stepper, before, interval, (t, end)),
                }
                continue;
            }
            let after = if is_within { newton } else { 0.5 * (low + high) };
            own = Candidate { after, bracket: [low, high], is_shown, is_sure: own.is_sure || is_beyond, ..own };
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
        stepper.planned = h;
        stepper.close_by = if has_just && made <= CLOSE_BY * h { stepper.close_by + 1 } else { 0 };
        if stepper.close_by > MOST_CLOSE_BY {
            return Err(goes_along(stepper, switch, t + made));
        }
        if stepper.events.as_ref().is_some_and(|events| events.is_event(switch)) {
            let moved = starts[switch].by.abs().max(whole[switch].by.abs());
            if is_closed && by.abs() > JUMPS * moved {
                if let Some(failure) = unresolved(stepper, switch, t + made) {
                    return Err(failure);
                }
                return Err(RunError::Input(format!(
                    "the formula of {} jumps instead of passing zero: write it so that it passes zero",
                    place(stepper, switch, t + made)
                )));
            }
        } else if by < 0.0 {
            // formulas of the other side need not be defined on this one
            let (mut end, before_it) = (t + made, made);
            let scheme = scheme_of(made);
            let mut is_made = false;
            for _ in 0..BEYOND {
                end = end.next_up();
                stepper.resume(before)?;
                is_made = stepper.step_over(scheme, (t, end), interval.at_breakpoint(), None).is_ok();
                if !is_made || stepper.excesses(false)[switch].by >= 0.0 {
                    break;
                }
            }
            made = end - t;
            if !is_made || t + made != end {
                stepper.resume(before)?;
                stepper.step_over(scheme, (t, t + before_it), interval.at_breakpoint(), None)?;
                made = before_it;
            }
            ends = stepper.excesses(false);
        }
        return Ok(Some((t + made, changes(stepper, switch, &ends, t + made))));
    }
}

/// Whether a switch changed at the start of the step, or what its event holds let go there.
fn is_just_switched<S: RunScalar>(stepper: &Stepper<S>, switch: usize) -> bool {
    let Some(events) = &stepper.events else { return false };
    let opened = events.joint_closed_by(switch).map(|joint| events.presence(joint));
    stepper.record().switched.iter().any(|change| change.switch == switch || Some(change.switch) == opened)
}

/// Times of a step, the later one half of it or as much of a half of a half, between which a switch that has left the end of its side passes it.
fn back_again<S: RunScalar>(
    stepper: &mut Stepper<S>,
    before: &Checkpoint<S>,
    interval: &RunInterval,
    (switch, t, h): (usize, f64, f64),
) -> Result<Option<[f64; 2]>, RunError> {
    let scheme = stepper.method.table.starting_scheme();
    let mut high = h;
    while high > AT_ONCE * h && t + 0.5 * high > t {
        let low = 0.5 * high;
        stepper.resume(before)?;
        stepper.step_over(scheme, (t, t + low), interval.at_breakpoint(), None)?;
        let own = &stepper.excesses(false)[switch];
        if own.by < -own.noise(t + low) {
            return Ok(Some([low, high]));
        }
        high = low;
    }
    Ok(None)
}

fn place<S: RunScalar>(stepper: &Stepper<S>, switch: usize, t: f64) -> String {
    let part = stepper.events.as_ref().map_or("", |events| events.part_of(switch));
    format!("\"{part}\" at t = {} s", shortest(t))
}

/// Why an event by a force is not found, where the switch is one.
fn unresolved<S: RunScalar>(stepper: &Stepper<S>, switch: usize, t: f64) -> Option<RunError> {
    let is_release = stepper.events.as_ref().is_some_and(|events| events.is_release(switch));
    is_release.then(|| {
        RunError::Input(format!(
            "{} is not found: the force that tells it leaps from step to step, as vibrations do that these do not resolve; take shorter steps, or damp what is stiff",
            place(stepper, switch, t)
        ))
    })
}

fn goes_along<S: RunScalar>(stepper: &Stepper<S>, switch: usize, t: f64) -> RunError {
    if stepper.events.as_ref().is_some_and(|events| events.is_release(switch)) {
        return RunError::Input(format!(
            "{} happens again at once: the force that tells it is another one behind it, which these steps do not resolve; take shorter ones, or a method of \
             higher order",
            place(stepper, switch, t)
        ));
    }
    if stepper.events.as_ref().is_some_and(|events| events.is_event(switch)) {
        return RunError::Input(format!(
            "{} happens again at once: it follows itself ever faster, as the hits of what bounces do; give a stop a rest_speed, below which hits have no \
             restitution, and let what an event sets lead away from it",
            place(stepper, switch, t)
        ));
    }
    RunError::Input(format!(
        "{} changes back at once: the motion goes along the switch of its formula instead of passing it, as a body that sticks goes along the \
         change of sign of its velocity; say dry friction by [[friction]] or [[clutch]], or make the formula smooth there, by a slope over a small width{NOT_LOCATED}",
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

/// The course of a number in a step, by its values and rates at both ends: a polynomial of degree 3 in the share of the step.
struct Course([f64; 4]);

impl Course {
    fn new(h: f64, start: [f64; 2], end: [f64; 2]) -> Self {
        let ([first, end], [slope, end_slope]) = ([start[0], end[0]], [h * start[1], h * end[1]]);
        Course([first, slope, 3.0 * (end - first) - 2.0 * slope - end_slope, 2.0 * (first - end) + slope + end_slope])
    }

    fn at(&self, share: f64) -> f64 {
        let [a, b, c, d] = self.0;
        a + share * (b + share * (c + share * d))
    }

    /// Where its slope vanishes within the step, in their order.
    fn turns(&self) -> impl Iterator<Item = f64> + Clone + use<> {
        let [_, b, c, d] = self.0;
        // b + 2 c s + 3 d s^2
        let q = -(c + c.signum() * (c * c - 3.0 * b * d).max(0.0).sqrt());
        let both = if c * c >= 3.0 * b * d { [q / (3.0 * d), b / q] } else { [f64::NAN; 2] };
        let both = if both[0] > both[1] { [both[1], both[0]] } else { both };
        both.into_iter().filter(|share| *share > 0.0 && *share < 1.0)
    }

    /// Where it passes zero upwards between two shares, below zero at the first.
    fn root(&self, mut low: f64, mut high: f64) -> f64 {
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *(if self.at(middle) > 0.0 { &mut high } else { &mut low }) = middle;
        }
        0.5 * (low + high)
    }

    /// A share at which it is below zero, where it starts at zero and falls.
    fn below(&self) -> Option<f64> {
        (0..50).map(|k| 0.5f64.powi(k)).find(|&share| self.at(share) < 0.0)
    }
}

/// Share of what a number moves in a step by which its course may be off where it turns back.
const OFF: f64 = 0.01;

/// Whether a switch changes its side in a step from `t` that takes `h`, or shortly behind it, but within the `most` that it may take.
fn candidate(switch: usize, (start, end): (&Excess, &Excess), (t, h): (f64, f64), most: f64) -> Option<Candidate> {
    if start.is_held() && end.is_held() {
        return None;
    }
    let is_at_end = start.by.abs() <= start.noise(t);
    let by = if is_at_end { 0.0 } else { start.by };
    let course = Course::new(h, [by, start.rate], [end.by, end.rate]);
    if end.by > end.noise(t + h) {
        // it leaves the end of its side before it comes back
        let turn = course.turns().find(|&share| course.at(share) < 0.0);
        let low = if by < 0.0 { 0.0 } else { turn.or(if start.rate < 0.0 { course.below() } else { None }).unwrap_or(0.0) };
        let high = course.turns().find(|&share| share > low && course.at(share) > 0.0).unwrap_or(1.0);
        let after = if by < 0.0 || low > 0.0 { h * course.root(low, high) } else { 0.0 };
        return Some(Candidate { switch, after, bracket: [h * low, h], is_shown: [by < 0.0, true], is_sure: true });
    }
    if (by < 0.0 || is_at_end && start.rate < 0.0) && end.rate < 0.0 {
        // in between it may have been beyond
        let near = OFF * h * (start.rate.abs() + end.rate.abs());
        let beyond = course.turns().find(|&share| course.at(share) > -near && (by < 0.0 || course.at(share) > 0.0))?;
        return Some(Candidate {
            switch,
            after: h * beyond,
            bracket: [0.0, f64::INFINITY],
            is_shown: [true; 2],
            is_sure: false,
        });
    }
    let after = h - end.by / end.rate;
    let is_near = end.rate > 0.0 && after <= most;
    is_near.then_some(Candidate { switch, after, bracket: [0.0, most], is_shown: [true; 2], is_sure: false })
}
