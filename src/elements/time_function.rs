use super::entries::Range::{Any, Positive};
use super::entries::Type::{Count, Fixed, Number, OfTime};
use super::entries::{COLUMNS, FILE, Forms, INTERPOLATION, Key, VALUES, at_least, forms, may, need};
use super::{Parameter, RecordedFunction, Table, TimeFormula};
use crate::program::{ArgumentKind, Formula, Reads};
use crate::scalar::{Curve, Interpolant, Scalar};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

const TIMES: Key = may("times", at_least(0, &Fixed("s", Any)), "times of the points, increasing; those of the file");

/// The forms of a [`TimeFunction`].
pub const FUNCTION: Forms = forms!([
    may("smooth_start", Number("s", Positive), "the function starts from rest within this time, and is late by half of it from then on; at once"),
]
"constant" "f = value" [need("value", Number("", Any), "value")]
"constant_rate" "f = offset + rate t" [
    may("offset", Number("", Any), "value at t = 0; 0"),
    need("rate", Number("1/s", Any), "rate"),
]
"sine" "f = offset + amplitude sin(angular_frequency t + phase)" [
    may("offset", Number("", Any), "mean; 0"),
    need("amplitude", Number("", Any), "amplitude"),
    need("angular_frequency", Number("rad/s", Any), "angular frequency"),
    may("phase", Number("rad", Any), "phase; 0"),
]
"smooth_ramp" "from one value to another along 10 s^3 - 15 s^4 + 6 s^5" [
    may("from", Number("", Any), "value before; 0"),
    need("to", Number("", Any), "value after"),
    may("start", Number("s", Any), "when it begins; 0"),
    need("duration", Number("s", Positive), "how long it takes"),
]
"step" "a jump, for loads only" [
    may("before", Number("", Any), "value before; 0"),
    need("after", Number("", Any), "value from the jump on"),
    need("at", Fixed("s", Any), "time of the jump"),
]
"lines" "straight lines between points, constant outside, for loads only" [
    TIMES,
    VALUES,
    FILE,
    COLUMNS,
]
"table" "values at times; interpolated by lines or steps for loads only" [
    TIMES,
    VALUES,
    FILE,
    COLUMNS,
    INTERPOLATION,
]
"formula" "a formula of the time t, exact at all times with all its derivatives" [
    need("value", OfTime, "formula with t, the time in s, as in \"0.2 * sin(5 * t) * exp(-t)\""),
    may("breakpoints", at_least(0, &Fixed("s", Any)), "from the times when these were not found from the formula: not needed, any"),
    may("start", Fixed("s", Any), "from the times when formulas were splines: not needed, at most 0"),
    may("end", Fixed("s", Any), "likewise, at least the end of the run"),
    may("intervals", Count(1, 10_000), "likewise, any"),
]);

/// A function of time f(t) for motion drivers and loads; its numbers are parameters of the element that holds it.
#[derive(Clone, Debug)]
pub enum TimeFunction {
    /// f = c. Parameters: value.
    Constant,
    /// f = f0 + r t. Parameters: offset, rate.
    ConstantRate,
    /// f = f0 + A sin(w t + phi). Parameters: offset, amplitude, angular frequency, phase.
    Sine,
    /// From f0 at t0 to f1 at t1 along 10 s^3 - 15 s^4 + 6 s^5, twice continuously differentiable. Parameters: from, to,
    /// start, duration.
    SmoothRamp,
    /// f = c before the switch, d from it on; for loads only. Parameters: before, after; the switch time is topology.
    Step {
        /// Time of the jump \[s\].
        switch: f64,
    },
    /// Any of the others, started from rest: f(s(t)), with ds/dt going from 0 to 1 along 10 x^3 - 15 x^4 + 6 x^5, x = t / T.
    ///
    /// s = T (5/2 x^4 - 3 x^5 + x^6) until T, t - T/2 from there on, 0 before 0. Parameters: those of f, start duration T. If f jumps,
    /// T moves the jump, and the ends of steps with it.
    SmoothStart(Arc<TimeFunction>),
    /// Values at times, which both are topology: no parameters. Lines and steps are for loads only.
    Curve(Arc<Curve>, Interpolant),
    /// Values at times. Parameters: those of the [`Table`]; the times are topology. Lines and steps are for loads only.
    Table(Table),
    /// One's own. Parameters: its own.
    Own(RecordedFunction),
}

impl Hash for TimeFunction {
    fn hash<H: Hasher>(&self, state: &mut H) {
        std::mem::discriminant(self).hash(state);
        match self {
            TimeFunction::Constant | TimeFunction::ConstantRate | TimeFunction::Sine | TimeFunction::SmoothRamp => {}
            TimeFunction::Step { switch } => switch.to_bits().hash(state),
            TimeFunction::SmoothStart(inner) => inner.hash(state),
            TimeFunction::Curve(curve, _) => curve.hash(state),
            TimeFunction::Table(table) => table.hash(state),
            TimeFunction::Own(own) => own.hash(state),
        }
    }
}

impl TimeFunction {
    /// The function of a form of [`FUNCTION`] whose numbers are parameters, in the order of its keys; a jump has a time, too.
    pub(crate) fn of_form(form: &str, switch: Option<f64>) -> Option<TimeFunction> {
        Some(match form {
            "constant" => TimeFunction::Constant,
            "constant_rate" => TimeFunction::ConstantRate,
            "sine" => TimeFunction::Sine,
            "smooth_ramp" => TimeFunction::SmoothRamp,
            "step" => TimeFunction::Step { switch: switch? },
            _ => return None,
        })
    }

    /// A table whose values are parameters.
    ///
    /// # Errors
    /// Fewer than two times, or times that are not finite or do not increase; the message shows which.
    pub fn table(times: &[f64], interpolant: Interpolant) -> Result<TimeFunction, String> {
        Table::new(times, interpolant).map(TimeFunction::Table)
    }

    /// A table whose values are always the same.
    ///
    /// # Errors
    /// As for [`TimeFunction::table`], and values that are not finite or not as many as times.
    pub fn curve(times: &[f64], values: &[f64], interpolant: Interpolant) -> Result<TimeFunction, String> {
        Ok(TimeFunction::Curve(Curve::new(times, values, interpolant)?, interpolant))
    }

    /// A function of one's own.
    ///
    /// # Errors
    /// If it branches on a value.
    pub fn own(formula: impl TimeFormula) -> Result<TimeFunction, String> {
        RecordedFunction::of(formula).map(TimeFunction::Own)
    }

    /// The parameters, their unit being `unit` for values of f.
    pub fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let new = Parameter::new;
        match self {
            TimeFunction::Constant => vec![new("value", unit)],
            TimeFunction::ConstantRate => vec![new("offset", unit), new("rate", "per s")],
            TimeFunction::Sine => {
                vec![new("offset", unit), new("amplitude", unit), new("angular frequency", "rad/s"), new("phase", "rad")]
            }
            TimeFunction::SmoothRamp => {
                vec![new("from", unit), new("to", unit), new("start", "s"), Parameter::positive("duration", "s")]
            }
            TimeFunction::Step { .. } => vec![new("before", unit), new("after", unit)],
            TimeFunction::SmoothStart(inner) => {
                inner.parameters(unit).into_iter().chain([Parameter::positive("start duration", "s")]).collect()
            }
            TimeFunction::Curve(..) => Vec::new(),
            TimeFunction::Table(table) => table.parameters(unit),
            TimeFunction::Own(own) => own.parameters().to_vec(),
        }
    }

    /// f(t) for parameters `p`.
    pub fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        match self {
            TimeFunction::Constant => p[0],
            TimeFunction::ConstantRate => p[0] + p[1] * t,
            TimeFunction::Sine => p[0] + p[1] * (p[2] * t + p[3]).sin(),
            TimeFunction::SmoothRamp => {
                let s = ((t - p[2]) / p[3]).max(S::zero()).min(S::one());
                p[0] + (p[1] - p[0]) * (s * s * s * ((s * 6.0 - 15.0) * s + 10.0))
            }
            TimeFunction::Step { switch } => t.less(S::from(*switch)).select(p[0], p[1]),
            TimeFunction::SmoothStart(inner) => match p {
                [own @ .., duration] => inner.value(started_time(t, *duration), own),
                [] => unreachable!("the start duration is the last parameter"),
            },
            TimeFunction::Curve(curve, _) => t.on_curve(curve, 0),
            TimeFunction::Table(table) => table.value(t, p),
            TimeFunction::Own(own) => own.value(&[t], p),
        }
    }

    /// Times behind a start and up to an end at which the value or one of its first two derivatives may jump: where a switch of it changes sides.
    ///
    /// # Errors
    /// More than a million of them.
    pub fn breakpoints(&self, p: &[f64], within: [f64; 2]) -> Result<Vec<f64>, String> {
        let formula = Formula::record([(ArgumentKind::Time, 1), (ArgumentKind::Parameter, p.len())], |x| {
            vec![self.value(x[0], &x[1..])]
        })?;
        let Some(switches) = formula.switches(Reads::TimeAlone, true) else { return Ok(Vec::new()) };
        let mut times: Vec<f64> = switches.times(&[&[0.0], p].concat(), &[0], within)?.iter().map(|own| own.t).collect();
        times.dedup();
        Ok(times)
    }
}

/// s(t) of a smooth start \[s\].
fn started_time<S: Scalar>(t: S, duration: S) -> S {
    let time = t.max(S::zero());
    let x = time / duration;
    x.less(S::one()).select(duration * (x.powi(4) * ((x - 3.0) * x + 2.5)), time - duration * 0.5)
}
