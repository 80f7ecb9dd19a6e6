//! When a formula passes from one piece to another where the time alone decides.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::running::ProgramWork;
use super::switches::{Side, Switches};
use std::ops::Range;

/// A time at which a switch changes sides, g(t, p) = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct SwitchTime {
    /// The first number behind the switch \[s\].
    pub t: f64,
    /// dt/dp = -(dg/dp) / (dg/dt) by those arguments on which g depends, with their places.
    pub gradient: Vec<(usize, f64)>,
}

/// Parts of a run in each of which a number that tells a side has at most one turning point.
const SAMPLES: usize = 1000;
/// Most times that are looked for.
const MOST_TIMES: usize = 1_000_000;
/// Change of a number over neighbouring times, in units of what its rate and round-off make of it, from which on it jumps.
const LEAP: f64 = 1e6;

impl Switches {
    /// When the sides of switches that read the [time alone](super::Reads::TimeAlone) change behind a start and up to an end, in their order, for
    /// arguments of which those at the places `times` are the time; each found to the last digit.
    ///
    /// # Errors
    /// More than a million of them.
    pub fn times(&self, inputs: &[f64], times: &[usize], [start, end]: [f64; 2]) -> Result<Vec<SwitchTime>, String> {
        let (inputs, work) = (inputs.to_vec(), ProgramWork::default());
        let mut search = Search { switches: self, inputs, times, work, found: Vec::new() };
        let mut before = search.at(start);
        for sample in 1..=SAMPLES {
            let after =
                search.at(if sample == SAMPLES { end } else { start + (end - start) * (sample as f64 / SAMPLES as f64) });
            search.between(&before, &after)?;
            before = after;
        }
        Ok(search.found)
    }
}

/// The numbers that tell the sides at a time.
#[derive(Clone)]
struct At {
    t: f64,
    numbers: Vec<f64>,
}

/// Neighbouring times between two, of which the second is the first that is behind something.
fn neighbours([mut low, mut high]: [f64; 2], mut is_behind: impl FnMut(f64) -> bool) -> [f64; 2] {
    loop {
        let middle = 0.5 * (low + high);
        if !(low < middle && middle < high) {
            return [low, high];
        }
        *(if is_behind(middle) { &mut high } else { &mut low }) = middle;
    }
}

struct Search<'s> {
    switches: &'s Switches,
    inputs: Vec<f64>,
    times: &'s [usize],
    work: ProgramWork<f64>,
    found: Vec<SwitchTime>,
}

impl Search<'_> {
    fn at(&mut self, t: f64) -> At {
        self.times.iter().for_each(|&place| self.inputs[place] = t);
        let mut numbers = Vec::new();
        self.switches.evaluate(&self.inputs, &mut numbers, &mut self.work);
        At { t, numbers }
    }

    /// Derivatives of all numbers by the arguments at some places together.
    fn rates(&mut self, t: f64, places: &[usize]) -> Vec<f64> {
        self.times.iter().for_each(|&place| self.inputs[place] = t);
        let mut direction = vec![0.0; self.inputs.len()];
        places.iter().for_each(|&place| direction[place] = 1.0);
        self.switches.rates(&self.inputs, &direction, &mut self.work)
    }

    /// Finds what changes between two times.
    fn between(&mut self, before: &At, after: &At) -> Result<(), String> {
        let switches = self.switches;
        let changing: Vec<_> = switches.changing(&before.numbers, &after.numbers).collect();
        if changing.is_empty() {
            return match self.turning_point(before, after) {
                Some(turn) => self.between(before, &turn).and_then(|()| self.between(&turn, after)),
                None => Ok(()),
            };
        }
        let first_time = |(side, own): (&Side, Range<usize>)| {
            let at_start = &before.numbers[own.clone()];
            neighbours([before.t, after.t], |t| side.has_changed(at_start, &self.at(t).numbers[own.clone()]))[1]
        };
        let t = changing.into_iter().map(first_time).fold(f64::INFINITY, f64::min);
        let [last, first] = [t.next_down(), t].map(|t| self.at(t));
        self.between(before, &last)?;
        for (side, own) in switches.changing(&last.numbers, &first.numbers) {
            if let Some(gradient) = self.gradient(side, own, [&last, &first]) {
                self.found.push(SwitchTime { t, gradient });
            }
        }
        if self.found.len() > MOST_TIMES {
            return Err(format!("passes from one piece to another more than {MOST_TIMES} times within the run"));
        }
        self.between(&first, after)
    }

    /// A time between two at which a number turns back on another side.
    fn turning_point(&mut self, before: &At, after: &At) -> Option<At> {
        let switches = self.switches;
        let [at_start, at_end] = [before.t, after.t].map(|t| self.rates(t, self.times));
        for (side, own) in switches.sides() {
            let rate = |rates: &[f64]| side.number(&rates[own.clone()]);
            if !(rate(&at_start) * rate(&at_end) < 0.0) {
                continue;
            }
            let has_turned = |t: f64| !(rate(&self.rates(t, self.times)) * rate(&at_start) > 0.0);
            let turns = neighbours([before.t, after.t], has_turned);
            for turn in turns.map(|t| self.at(t)) {
                if turn.t > before.t && turn.t < after.t && switches.change(&before.numbers, &turn.numbers) {
                    return Some(turn);
                }
            }
        }
        None
    }

    /// dt/dp of a switch between two neighbouring times; `None` where its number does not pass through zero but leaps over it, because another
    /// switch changes sides then.
    fn gradient(&mut self, side: &Side, own: Range<usize>, ends: [&At; 2]) -> Option<Vec<(usize, f64)>> {
        let [before, after] = ends.map(|end| &end.numbers[own.clone()]);
        let rates = ends.map(|end| side.number(&self.rates(end.t, self.times)[own.clone()]));
        let place = usize::from(rates[1].abs() > rates[0].abs());
        let size = |numbers: &[f64]| numbers.iter().fold(0.0, |size: f64, number| size.max(number.abs()));
        let round_off = f64::EPSILON * size(before).min(size(after)) + rates[place].abs() * (ends[1].t - ends[0].t);
        if !((side.number(after) - side.number(before)).abs() <= LEAP * round_off) {
            return None;
        }
        let reads: Vec<usize> =
            (0..).zip(self.switches.reads()).filter_map(|(input, reads)| reads.then_some(input)).collect();
        let parameters = reads.into_iter().filter(|input| !self.times.contains(input)).collect::<Vec<_>>();
        let by = |search: &mut Self, input: usize| {
            let rate = side.number(&search.rates(ends[place].t, &[input])[own.clone()]);
            // what underflows is zero
            rate.is_normal().then(|| (input, -rate / rates[place]))
        };
        Some(parameters.into_iter().filter_map(|input| by(self, input)).collect())
    }
}

#[cfg(test)]
mod tests {
    use crate::scalar::{Curve, Interpolant, Scalar};
    use crate::{ArgumentKind, Formula, Reads, Recorded};

    /// A law of the time and a parameter, and its switches for a parameter of 0.3 with their derivatives by it.
    type Law = (&'static str, fn(Recorded, Recorded) -> Recorded, Vec<(f64, f64)>);

    fn laws() -> Vec<Law> {
        fn table(t: Recorded, p: Recorded) -> Recorded {
            let curve = Curve::new(&[0.1, 0.2, 0.9], &[0.0, 2.0, 1.0], Interpolant::Monotone).expect("knots");
            (t * p * (1.0 / 0.3)).on_curve(&curve, 0)
        }
        let one = |t: f64, rate: f64| vec![(t, rate)];
        let turn = 0.5 / 0.3;
        vec![
            ("comparison", |t, p| t.less(p).select(p, t), one(0.3, 1.0)),
            ("thin pulse", |t, p| (t - p).abs().less(Recorded::from(1e-7)).select(p, -p), {
                vec![(0.3 - 1e-7, 1.0), (0.3, 1.0), (0.3 + 1e-7, 1.0)]
            }),
            ("thin and smooth", |t, p| (t - p).powi(2).less(Recorded::from(1e-14)).select(p, -p), {
                vec![(0.3 - 1e-7, 1.0), (0.3 + 1e-7, 1.0)]
            }),
            ("saturation", |t, p| (t / p).max(Recorded::from(0.5)).min(Recorded::from(1.0)), vec![(0.15, 0.5), (0.3, 1.0)]),
            (
                "behind a saturation",
                |t, p| {
                    let ramp = (t / p).min(Recorded::from(1.0));
                    ramp.less(Recorded::from(1.0)).select(ramp, p)
                },
                one(0.3, 1.0),
            ),
            ("whole", |t, p| (t / p).floor() * t, vec![(0.3, 1.0), (0.6, 2.0), (0.9, 3.0)]),
            ("sawtooth by a tangent", |t, p| (t / p * std::f64::consts::PI).tan().atan(), {
                vec![(0.15, 0.5), (0.45, 1.5), (0.75, 2.5)]
            }),
            ("triangle by an arc sine", |t, p| (t / p * std::f64::consts::PI).sin().asin(), {
                vec![(0.15, 0.5), (0.45, 1.5), (0.75, 2.5)]
            }),
            ("pole", |t, p| ((t - p).powi(-1)).atan(), one(0.3, 1.0)),
            ("root", |t, p| ((t - p) * (t - p) * 4.0).sqrt(), one(0.3, 1.0)),
            ("power", |t, p| ((t - p) * (t - p)).powf(0.25), one(0.3, 1.0)),
            ("logarithm", |t, p| (((t - p) * (t - p)).ln() * 0.5).exp(), one(0.3, 1.0)),
            ("angle", |t, p| (t - p).atan2(Recorded::from(-1.0)), one(0.3, 1.0)),
            ("periodic", |t, p| (t * std::f64::consts::TAU * 1.5).sin().less(p).select(p, t), {
                let first = 0.3f64.asin() / (std::f64::consts::TAU * 1.5);
                let rate = 1.0 / (1.0f64 - 0.09).sqrt() / (std::f64::consts::TAU * 1.5);
                let third = 1.0 / 3.0;
                vec![(first, rate), (third - first, -rate), (2.0 * third + first, rate), (1.0 - first, -rate)]
            }),
            ("table", table, vec![(0.1, -0.1 / 0.3), (0.2, -0.2 / 0.3), (0.9, -3.0)]),
            ("none", |t, p| (t * t + p).sqrt() / (p * p + 1.0), vec![]),
            ("within the run, but for the parameter", |t, p| (t * p).less(Recorded::from(0.5)).select(t, p), {
                if turn < 1.0 { one(turn, -1.0) } else { vec![] }
            }),
        ]
    }

    #[test]
    fn times_of_switches_are_found_to_the_last_digit_with_their_derivatives() {
        for (name, law, expected) in laws() {
            let kinds = [(ArgumentKind::Coordinate, 1), (ArgumentKind::Parameter, 1), (ArgumentKind::Time, 1)];
            let formula = Formula::record(kinds, |x| vec![law(x[2], x[1]) + x[0]]).expect("does not branch");
            let mut found = match formula.switches(Reads::TimeAlone, true) {
                Some(switches) => switches.times(&[0.0, 0.3, 0.0], &[2], [0.0, 1.0]).expect("few"),
                None => Vec::new(),
            };
            // "less" and "not more" change sides a rounding apart
            found.dedup_by(|one, other| (one.t - other.t).abs() <= f64::EPSILON);
            assert_eq!(found.len(), expected.len(), "{name}: {found:?}");
            for (own, (t, rate)) in found.iter().zip(expected) {
                assert!((own.t - t).abs() < 1e-14, "{name}: {} for {t}", own.t);
                let [(1, derivative)] = own.gradient[..] else { panic!("{name}: {own:?}") };
                assert!((derivative - rate).abs() < 1e-7 * rate.abs(), "{name}: {derivative} for {rate}");
            }
            // what a state decides is none of them
            let mixed = Formula::record(kinds, |x| vec![law(x[2] + x[0], x[1])]).expect("does not branch");
            assert!(mixed.switches(Reads::TimeAlone, true).is_none(), "{name}");
            // the curvature of a table is watched in time alone
            assert_eq!(mixed.switches(Reads::Motion, true).is_none(), ["none", "table"].contains(&name), "{name}");
        }
    }
}
