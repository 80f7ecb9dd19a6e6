//! Design variables.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        need("initial", OneOrMore(&Fixed("unit", Any)), "value of the initial design; with count one for all, or as many"),
        need("bounds", exactly(2, &Fixed("unit", Any)), "least and largest value"),
        may("unit", Text, "unit, for tables and charts; -"),
        may(
            "count",
            Count(*MANY.start(), *MANY.end()),
            "how many there are: NAME[0], NAME[1] and so on are numbers in formulas, spline(NAME, s) is a value between them, and where a \
             list of numbers is wanted NAME stands for all; one"
        ),
        may(
            "per_face",
            Text,
            "name of a mesh, or a group of its faces, PLATE.GROUP: the variable is one for each face, NAME[17] that of the face with \
             the number 17, and in formulas of the thickness NAME is that of the face; one for all"
        ),
        may("per_node", Text, "the same for each node of the faces; one for all"),
        may("name", Text, "how commands and results call it; NAME"),
    ],
    ..Section::named("variable", "A design variable. NAME is how formulas call it.")
};
