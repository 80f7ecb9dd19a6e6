//! What a run says against itself.

use costate::integrators::{StepError, Verdict};
use costate::scenes::Prepared;
use costate::sensitivity::Forward;

/// A sentence for each reason to doubt a run or its gradients.
pub fn doubts(prepared: &Prepared, forward: &Forward) -> Vec<String> {
    let mut all = Vec::new();
    if let Some(StepError { share, step, t, .. }) = forward.error.filter(|error| error.share > StepError::COARSE) {
        all.push(format!(
            "step {step} (t = {t} s) has an estimated error of {:.1} %: the motion may be another one from there on; take smaller steps",
            100.0 * share
        ));
    }
    if let Some((t, step)) = forward.leap {
        all.push(format!(
            "step {step} (t = {t} s) leaps over a dead point: the drives determine the motion, and it goes on along another branch from \
             there on; take smaller steps, or let them be chosen"
        ));
    }
    let [_, functionals] = prepared.undetermined();
    if !functionals.is_empty() {
        all.push(format!(
            "the model does not determine {}: redundant joints share loads in many ways, of which the one of least norm is given",
            functionals.join(", ")
        ));
    }
    match forward.stability.map(|course| (course.end.verdict(), course.lost)) {
        Some((Verdict::Unstable, Some(([from, to], step)))) => all.push(format!(
            "the equilibrium is unstable: the path lost its stability between the load factors {from} and {to} (step {step})"
        )),
        Some((Verdict::Unstable, None)) => all.push("the equilibrium is unstable".into()),
        _ => {}
    }
    all.extend(forward.crossings.iter().map(ToString::to_string));
    all
}
