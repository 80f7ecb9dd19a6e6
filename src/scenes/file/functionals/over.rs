//! What a functional makes of the values over time.

use crate::functionals::{Aggregate, AggregateKind, Over, Times};
use crate::scenes::file::describing::*;

const AGGREGATE: Forms = one_form![
    need(
        "aggregate",
        Choice(&["smooth_maximum", "upper_maximum", "exponential", "squared_exponential", "power", "squared_power"]),
        "how many values become one near the largest; upper_maximum of n values is above it, by at most ln(n) / sharpness"
    ),
    need("sharpness", Fixed("1/unit", Positive), "rho: the larger, the nearer to the maximum; without unit beside size"),
    may(
        "size",
        Fixed("unit", Positive),
        "size of the quantity by which the sharpness is taken, rho = sharpness / size; not of powers; 1"
    ),
    may("times", Choice(&["start", "end", "run"]), "of which times; run"),
    may("normalized", Flag, "smooth_maximum divided by the measure of points and times; true"),
    may("continuous", Flag, "points count by the area for which they stand; false"),
];

/// Words for what is made over time, in the order of their meaning.
pub(super) const OVER: Key = need(
    "over",
    Type::Over(&["initial", "terminal", "integral"], &AGGREGATE),
    "value at the start, at the end, integral, or an aggregate",
);

/// What is made over time.
pub(super) fn over(e: &Fields) -> Over {
    let own = match e.get("over") {
        Some((_, Value::Fields(own))) => own,
        Some((_, Value::Text(word))) if word == "initial" => return Over::Initial,
        Some((_, Value::Text(word))) if word == "integral" => return Over::Integral,
        _ => return Over::Terminal,
    };
    let kind = match own.text("aggregate") {
        Some("upper_maximum") => AggregateKind::UpperMaximum,
        Some("exponential") => AggregateKind::Exponential,
        Some("squared_exponential") => AggregateKind::SquaredExponential,
        Some("power") => AggregateKind::Power,
        Some("squared_power") => AggregateKind::SquaredPower,
        _ => AggregateKind::SmoothMaximum { normalized: !own.has("normalized") || own.flag("normalized") },
    };
    let aggregate = Aggregate::new(kind, own.fixed("sharpness").unwrap_or(f64::NAN));
    let size = if kind.is_power() { None } else { own.fixed("size") };
    let aggregate = size.map_or(aggregate, |size| aggregate.relative_to(size));
    let aggregate = if own.flag("continuous") { aggregate.continuous() } else { aggregate };
    aggregate.at(match own.text("times") {
        Some("start") => Times::Start,
        Some("end") => Times::End,
        _ => Times::Run,
    })
}
