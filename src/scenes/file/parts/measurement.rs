//! Curves that were measured.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        need("name", Text, "what results call it"),
        need(
            "functional",
            Text,
            "name of the functional whose quantity was measured, of a scenario as in \"stress [hover]\"; what it makes of that over time counts for \
             nothing here"
        ),
        need("file", Text, "a text file with a line for each time (CSV), beside the scene file"),
        may(
            "columns",
            Type::Columns,
            "which columns of the file have the times and the values, by the names in its first line or by numbers from 1 on; the first two. A unit \
             behind a name, as in `angle [rad]` or `angle (rad)`, must be that of the functional, and may be left out here"
        ),
        may(
            "deviation",
            Fixed("unit", Positive),
            "standard deviation of the errors of all values; without it and `deviations` errors of all measurements are alike, and their size follows \
             from what the fit leaves"
        ),
        may("deviations", Text, "name of a column with the standard deviation of the error of each value; deviation"),
        may(
            "delay",
            Text,
            "name of a design variable [s]: what is measured at t is what the motion has at t less this; none"
        ),
    ],
    space: "measurement",
    ..Section::listed(
        "measurement",
        "A measured curve to which `costate fit` fits the design variables: the quantity of a functional at given times.",
    )
};
