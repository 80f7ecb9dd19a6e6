//! Whether the equilibrium of a run stands, in words and as JSON.

use super::console::count;
use crate::io::number;
use costate::elements::NodeKind;
use costate::integrators::{Stability, StabilityCourse, Verdict};
use costate::scenes::Prepared;
use costate::sensitivity::Forward;
use serde_json::{Value, json};

/// What is said of an equilibrium.
pub enum Statement {
    Stable(String),
    /// It does not, or that is not known.
    Warning(String),
}

/// What is said of the last equilibrium of a run.
pub fn statement(prepared: &Prepared, forward: &Forward) -> Option<Statement> {
    let StabilityCourse { end, lost } = forward.stability?;
    let Stability { negative, determinant, turns, .. } = end;
    let is_start = prepared.plan.equilibrium.is_some();
    let which = match is_start {
        true => {
            let what = if turns { "steady turn" } else { "equilibrium" };
            // nothing is said of it once it is let go
            let held = if prepared.model().holds.is_empty() { "" } else { ", while it is held," };
            format!("the {what} at which the motion begins{held}")
        }
        false => format!("the equilibrium at the load factor {}", forward.grid.times[forward.grid.steps()]),
    };
    let lost = lost.map(|([from, to], step)| {
        let [from, to] = [from, to].map(number);
        format!("the path lost its stability between the load factors {from} and {to} (step {step})")
    });
    Some(match end.verdict() {
        Verdict::Stable => {
            let mut words = format!("{which} is stable");
            if determinant.is_some() {
                words += " against divergence (its loads or states follow the motion: `modes` tells whether it flutters, with --static at the end of load steps)";
            }
            if let Some(lost) = lost {
                words += &format!("; but {lost}, and what follows a snap depends on the motion");
            }
            Statement::Stable(words)
        }
        Verdict::Unstable => {
            let directions = match determinant {
                None => format!("{} of its stiffness", count(negative, "negative eigenvalue")),
                Some(_) => "a negative determinant of its stiffness, whose loads follow the motion".into(),
            };
            let lost = lost.map_or_else(String::new, |lost| format!("; {lost}"));
            Statement::Warning(format!(
                "{which} is UNSTABLE ({directions}): what is modelled does not stay there, and functionals and gradients are those of a {} that cannot \
                 last{lost}; {}",
                if is_start { "motion from a state" } else { "state" },
                way(prepared)
            ))
        }
        Verdict::Undecided => Statement::Warning(format!(
            "whether {which} is stable is not known: {}; `modes{}` tells more",
            match determinant {
                _ if turns => "its energy in the frame that turns is not the least, and Coriolis forces may hold it or not",
                None => "a direction has no stiffness but for round-off",
                Some(_) => "loads or states follow the motion, and signs of the stiffness do not decide",
            },
            if is_start { "" } else { " --static" }
        )),
    })
}

/// How a stable equilibrium is found.
fn way(prepared: &Prepared) -> String {
    let shorter = match prepared.control.is_some() || prepared.plan.equilibrium.is_some() {
        // these look for the stable branch already
        true => String::new(),
        false => format!(
            "let load steps be chosen (--tolerance 1e-6: those that lose stability are shortened) or take more (--steps above {}); ",
            prepared.grid.steps()
        ),
    };
    // the stretch that bending brings with it makes axial forces of alternating signs in coarse elements, which buckle them aside
    let finer = match prepared.model().nodes.iter().any(|node| node.kind == NodeKind::Slope) {
        true => {
            "cables of few elements that hardly stretch lose their stability by their mesh alone: take more of them, or `small` strains; "
        }
        false => "",
    };
    format!(
        "{shorter}{finer}a structure without imperfection stays on its straight path: give it a small side load or an initial bow; or simulate the \
         motion with dampers"
    )
}

pub fn json(course: &StabilityCourse) -> Value {
    let StabilityCourse { end, lost } = course;
    let verdict = match end.verdict() {
        Verdict::Stable => "stable",
        Verdict::Unstable => "unstable",
        Verdict::Undecided => "undecided",
    };
    json!({
        "verdict": verdict,
        "negative_eigenvalues": end.negative,
        "loads_follow_the_motion": end.determinant.is_some(),
        "lost_between": lost.map(|(loads, _)| loads),
        "lost_in_step": lost.map(|(_, step)| step),
    })
}
