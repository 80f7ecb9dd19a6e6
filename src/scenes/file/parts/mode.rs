//! Modes of vibration as what is measured.

use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        need("name", Text, "what results, objective and limits call it"),
        need(
            "number",
            Count(1, 200),
            "which mode, from 1, as costate modes numbers them: rigid motions and unstable ones count, and those that topple come first"
        ),
        may(
            "measure",
            Choice(&["frequency", "growth"]),
            "its omega in rad/s (of one that topples minus its growth), or its growth in 1/s; frequency"
        ),
        may(
            "damped",
            Flag,
            "with dampers, states of first order and what else depends on velocities, as about a steady turn always; false"
        ),
    ],
    space: "functional",
    ..Section::listed(
        "mode",
        "A number of a mode of small vibrations about the start or the equilibrium, measured by runs, gradients, sweeps and optimizations.",
    )
};
