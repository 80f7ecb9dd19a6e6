//! All sections of a scene file with their keys.

use super::extended::EXTENDS;
use super::fit::FIT;
use super::keys::one_form;
use super::own_parts::{OwnParts, all_forms};
use super::parts::PARTS;
use super::section::Section;
use super::tables::TABLES;
use crate::design::repeated;
use crate::elements::entries::{Form, Forms, Key, Range, Type, at_least, joined, may, need};
use crate::integrators::{MOST_STEPS, NewtonTolerance};
use Range::{Any, Positive};
use Type::{Choice, Count, Fixed, Flag, Table, Text, Vector, Weights};

/// The version of the format that this program reads.
pub(super) const VERSION: usize = 1;

/// Keys at the top of a file.
pub(super) const TOP: Forms = one_form![
    need("version", Count(VERSION, VERSION), "version of the format: 1"),
    may(EXTENDS, Text, "scene file in the same folder that this one adds to and changes"),
    may("name", Text, "name of the scene; the name of the file"),
    may("summary", Text, "what the scene is, in a line"),
    may("gravity", Vector("m/s2"), "acceleration by weight of all masses, beams, cables and shells; none"),
];

const LINEAR: Forms = one_form![
    need("name", Text, "what it is for"),
    need("coefficients", Weights, "coefficients of design variables, by the names that are listed"),
    may("at_most", Fixed("", Any), "largest value of the sum"),
    may("at_least", Fixed("", Any), "least value of the sum"),
    may("equal", Fixed("", Any), "value of the sum"),
];

const LIMIT: Forms = one_form![
    need("functional", Text, "name of a functional, or of a mode"),
    may("at_most", Fixed("unit", Any), "largest value"),
    may("at_least", Fixed("unit", Any), "least value"),
    may("equal", Fixed("unit", Any), "value"),
    may("scale", Fixed("unit", Positive), "a violation of this size is of the order of 1; the size of the limit"),
];

/// All sections, in the order of the reference page.
pub(super) const SECTIONS: &[Section] = &joined::<Section, { PARTS.len() + OF_ALL.len() + 1 }>(&[&[TABLES], PARTS, OF_ALL]);

/// Sections of which nothing is made.
const OF_ALL: &[Section] = &[
    Section {
        forms: one_form![
            may(
                "end",
                Fixed("s", Positive),
                "duration, or with method static the last load factor; required but for `static`, where it is 1"
            ),
            may("steps", Count(1, MOST_STEPS), "steps of equal size; needed without tolerance"),
            may(
                "method",
                Text,
                "integrator: esdirk4, generalized-alpha:0.6, variational, static and others, as for --method; esdirk4"
            ),
            may(
                "tolerance",
                Fixed("-", Positive),
                "steps are chosen by their error: relative and absolute; steps of equal size"
            ),
            may("velocity_tolerance", Fixed("-", Positive), "the same for velocities; tolerance"),
            may("longest_step", Fixed("s", Positive), "longest step that tolerance may choose; any"),
            may(
                "constraint_level",
                Choice(&["position", "acceleration"]),
                "time derivative on which constraints are kept; acceleration"
            ),
            may(
                "newton",
                Choice(&[
                    NewtonTolerance::RoundOff.name(),
                    NewtonTolerance::Residual.name(),
                    NewtonTolerance::Scaled.name(),
                ]),
                "when Newton's method stops, as for --newton; round-off"
            ),
            may("solver", Choice(&["automatic", "dense", "multifrontal"]), "solver of the linear systems; automatic"),
            may(
                "start",
                Choice(&["given", "equilibrium", "steady"]),
                "where the motion begins: at the coordinates that the parts give, at the equilibrium near them under the loads of t = 0, or at that in \
                 the frame that turns with what `[[spin]]` names; given"
            ),
            may(
                "locate",
                Flag,
                "end steps where springs, loads and other elements pass from one piece of their formulas to another: values keep the order of the \
                 method, and gradients are exact; true"
            ),
            may("divide_steps", Flag, "halve steps that Newton's method cannot make; false"),
            may("drop_redundant", Flag, "leave out redundant constraint equations instead of refusing them; false"),
            may(
                "project_start",
                Flag,
                "project an inconsistent start onto the constraints instead of refusing it: a run prints what was given and what is used; false"
            ),
        ],
        ..Section::once("settings", "How a run is made where the command line does not say otherwise.")
    },
    Section {
        forms: one_form![
            may("step", Fixed("s", Positive), "histories at multiples of this time; at the steps"),
            may(
                "histories",
                at_least(0, &Text),
                "what has columns in them, by names: nodes (\"crank\", \"beam[4]\", \"beam.end\", \"plate[2,0]\"), members with all their \
                 nodes, joints, springs, dampers, elements, states, functionals, and \"energy\"; everything"
            ),
            may("vtk", Flag, "meshes for ParaView; false"),
        ],
        ..Section::once("output", "What a run writes where the command line does not say otherwise.")
    },
    Section {
        forms: one_form![
            may("minimize", Text, "name of a functional, or of a mode, that is to become small"),
            may("maximize", Text, "name of one that is to become large"),
            may("sense", Choice(&["minimize", "maximize"]), "of a sum; minimize"),
            may("weights", Weights, "weights of functionals in a sum, by name"),
            may("varying", at_least(0, &Text), "names of the design variables that may change, as they are listed; all"),
            may("scale", Fixed("unit", Positive), "size of the objective that is of the order of 1; its size at the start"),
            may(
                "screening",
                Fixed("-", Positive),
                "limits kept by more than this share need no gradient; every limit has one"
            ),
            may("constraint", at_least(0, &Table(&LIMIT)), "limits of functionals and modes"),
            may("linear", at_least(0, &Table(&LINEAR)), "limits of sums of design variables"),
        ],
        ..Section::once(
            "optimization",
            "What costate optimize does. The objective is minimize, maximize, or a sum with sense and weights.",
        )
    },
    Section {
        forms: FIT,
        ..Section::once(
            "fit",
            "How `costate fit` fits design variables within their bounds to what each `[[measurement]]` says.",
        )
    },
];

/// Keys for which no section is: `define`.
pub(super) const DEFINE: (&str, &str) = (
    "define",
    "Named numbers and vectors: `NAME = 2`, `NAME = \"0.5 * length\"`, `NAME = [0, \"length\", 0]`, in any order. Formulas use them by name. \
     `\"corner{k}\" = { for = { k = [0, 1, 2] }, value = \"platform * out{k}\" }` stands for three.",
);

/// A loop in the entries of lists and of sections with names.
pub(super) const FOR: Key = may(
    "for",
    Text,
    "the entry stands for many: `for = { i = { from = 1, to = 5 } }` makes five of it, `for = { i = [1, 3, 7] }` three, \
     `for = { side = [\"left\", \"right\"] }` two; in its name and all its texts stand the values of `{i}`, `{i + 1}` and `{side}`; several names \
     make all pairs",
);

impl OwnParts {
    /// Forms of the sections of joints, drivers, springs, dampers and functionals, with the names of these.
    #[doc(hidden)]
    pub fn listed(&self) -> Vec<(&'static str, Form)> {
        let sections = ["joint", "driver", "spring", "damper", "functional"];
        let own = SECTIONS.iter().filter(|own| sections.contains(&own.name));
        own.flat_map(|own| all_forms(&own.forms, self).into_iter().map(|form| (own.name, form))).collect()
    }

    /// Two parts of a section have different names.
    ///
    /// # Errors
    /// A name that a part of one's own and another have.
    #[doc(hidden)]
    pub fn check(&self) -> Result<(), String> {
        for section in SECTIONS {
            let forms = all_forms(&section.forms, self);
            if let Some(name) = repeated(forms.iter().map(|form| form.name)) {
                return Err(format!("two parts of the section [[{}]] are named \"{name}\"", section.name));
            }
        }
        Ok(())
    }
}
