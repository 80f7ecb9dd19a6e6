//! Every function of time, for the contract tests of all that holds one.

use costate::elements::{Parameter, Table, TimeFormula, TimeFunction};
use costate::scalar::{Interpolant, Scalar};
use std::sync::Arc;

use TimeFunction::SmoothStart;

/// A function of somebody's own: A sin(w t + r t^2 / 2).
#[derive(Hash)]
struct Chirp;

impl TimeFormula for Chirp {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("amplitude", "-"), Parameter::new("w", "rad/s"), Parameter::new("r", "rad/s2")];
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        p[0] * ((p[1] + p[2] * t * 0.5) * t).sin()
    }
}

/// A table with values as parameters.
fn table(name: &'static str, times: &[f64], values: &[f64], way: Interpolant) -> (&'static str, TimeFunction, Vec<f64>) {
    let table = Table::new(times, way).expect("increasing");
    let numbers = table.numbers(values);
    (name, TimeFunction::Table(table), numbers)
}

/// A table whose values stay.
fn curve(way: Interpolant) -> TimeFunction {
    TimeFunction::curve(&[-0.8, -0.3, 0.1, 0.6], &[0.2, 0.7, 0.4, -0.5], way).expect("increasing")
}

/// Name, function and sample parameters; nothing happens outside of times in [-1, 1].
pub fn time_functions() -> Vec<(&'static str, TimeFunction, Vec<f64>)> {
    vec![
        ("constant", TimeFunction::Constant, vec![1.3]),
        ("constant rate", TimeFunction::ConstantRate, vec![0.4, -1.1]),
        ("sine", TimeFunction::Sine, vec![0.2, 1.4, 2.3, 0.6]),
        ("smooth ramp", TimeFunction::SmoothRamp, vec![0.3, 1.7, -0.4, 0.9]),
        ("step", TimeFunction::Step { switch: 0.1 }, vec![0.8, -0.6]),
        ("smooth start of a sine", SmoothStart(Arc::new(TimeFunction::Sine)), vec![0.2, 1.4, 2.3, 0.6, 0.7]),
        ("smooth start of a ramp", SmoothStart(Arc::new(TimeFunction::SmoothRamp)), vec![0.3, 1.7, 0.1, 0.7, 0.3]),
        table("lines", &[-0.6, 0.2, 0.7], &[0.5, -0.3, 0.9], Interpolant::Lines),
        ("own", TimeFunction::own(Chirp).expect("no branch"), vec![1.2, 1.9, 0.7]),
        (
            "smooth start of one's own",
            SmoothStart(Arc::new(TimeFunction::own(Chirp).expect("no branch"))),
            vec![1.2, 1.9, 0.7, 0.4],
        ),
        table("smooth table", &[-0.7, -0.2, 0.1, 0.8], &[0.5, -0.3, 0.9, 0.2], Interpolant::Smooth),
        table("monotone table", &[-0.6, -0.1, 0.2, 0.7], &[0.5, -0.3, -0.1, 0.8], Interpolant::Monotone),
        table("steps", &[-0.6, 0.3], &[0.5, -0.3], Interpolant::Steps),
        ("monotone curve", curve(Interpolant::Monotone), Vec::new()),
        ("smooth curve", curve(Interpolant::Smooth), Vec::new()),
        ("curve of lines", curve(Interpolant::Lines), Vec::new()),
    ]
}
