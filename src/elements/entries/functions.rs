//! How tables of s and orientations are written.

use super::keys::{Forms, Key, Range::Any, Type, at_least, forms, may, need};
use Type::{Choice, Columns, Fixed, Number, Numbers, Text, Vector};

pub(crate) const VALUES: Key = may("values", at_least(1, &Number("", Any)), "values there; those of the file");
pub(crate) const FILE: Key = may("file", Text, "a text file with a line for each point (CSV), beside the scene file; none");
pub(crate) const COLUMNS: Key = may(
    "columns",
    Columns,
    "which columns of the file have the points and the values, by the names in its first line or by numbers from 1 on; the first two",
);
pub(crate) const INTERPOLATION: Key = may(
    "interpolation",
    Choice(&["monotone", "smooth", "lines", "steps"]),
    "between points: cubics that stay between neighbouring values, a natural spline, straight lines, or the value of the point before; \
     the first two go on with constant slope outside, the others are constant there; monotone",
);

/// The forms of a table of s.
pub const CHARACTERISTIC: Forms = forms!([
    may("points", at_least(0, &Fixed("m, rad", Any)), "values of s, increasing; those of the file"),
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
