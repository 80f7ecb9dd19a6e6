//! How functions of time and orientations are written.

use super::keys::{Forms, Key, Range, Type, forms, may, need};
use Range::{Any, Positive};
use Type::{Choice, Columns, Count, Fixed, Fixeds, Number, Numbers, OfTime, Series, Text, Vector};

const TIMES: Key = may("times", Fixeds(0, "s"), "times of the points, increasing; those of the file");
const VALUES: Key = may("values", Series(""), "values there; those of the file");
const FILE: Key = may("file", Text, "a text file with a line for each point (CSV), beside the scene file; none");
const COLUMNS: Key = may(
    "columns",
    Columns,
    "which columns of the file have the points and the values, by the names in its first line or by numbers from 1 on; the first two",
);
const INTERPOLATION: Key = may(
    "interpolation",
    Choice(&["monotone", "smooth", "lines", "steps"]),
    "between points: cubics that stay between neighbouring values, a natural spline, straight lines, or the value of the point before; \
     the first two go on with constant slope outside, the others are constant there; monotone",
);

/// The forms of a [`TimeFunction`](crate::elements::TimeFunction).
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
    may("breakpoints", Fixeds(0, "s"), "times at which it or one of its first two derivatives jumps: steps end there; needed, if only as [], \
        where abs, min, max or if_less choose"),
    may("start", Fixed("s", Any), "from the times when formulas were splines: not needed, at most 0"),
    may("end", Fixed("s", Any), "likewise, at least the end of the run"),
    may("intervals", Count(1, 10_000), "likewise, any"),
]);

/// The forms of a table of s.
pub const CHARACTERISTIC: Forms = forms!([
    may("points", Fixeds(0, "m, rad"), "values of s, increasing; those of the file"),
    VALUES,
    FILE,
    COLUMNS,
]
"lines" "straight lines between the points, constant outside" []
"table" "values at the points" [INTERPOLATION]
);

/// The forms of the axes of a frame.
pub const ORIENTATION: Forms = forms!([]
"angle" "turned about an axis of the world" [
    need("axis", Vector("-"), "axis in the world, of any length"),
    need("angle", Number("rad", Any), "angle"),
]
"x_axis" "the x axis of the frame along a direction of the world, by the shortest turn" [
    need("along", Vector("-"), "direction in the world, of any length"),
]
"euler_parameters" "as they stand" [
    need("values", Numbers(&[4], "-", Any), "e0, e1, e2, e3 with unit length"),
]);
