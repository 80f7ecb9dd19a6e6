//! Words that files of other programs have, and what serves for them here.

use crate::scenes::unknown;

/// Words with what is to be written instead.
const ELSEWHERE: &[(&[&str], &str)] = &[
    (
        &["collision", "collider", "geom", "impact"],
        "what touches is [[shape]], and two of them are [[contact]]; what stays on one side of a formula is [[stop]]",
    ),
    (
        &["friction", "frictional", "coulomb", "mu"],
        "dry friction is [[friction]] of a joint, [[clutch]] between two coordinates, and sliding and static of [[contact]]",
    ),
    (
        &["stop", "stopper", "bumper", "limiter", "range"],
        "a rigid stop is [[stop]]; an elastic one is a law of a spring: [[spring]] of type \"slide_law\", \"torsion_law\" or \"angle_law\" with \
         energy = \"if_less(1, s, k * (s - 1)^2 / 2, 0)\"",
    ),
    (
        &["event", "latch", "lock", "trigger", "switch", "release", "break"],
        "what happens at an instant is [[event]], which sets numbers and rates, and removes and locks joints; what locks at a value is [[latch]]",
    ),
    (
        &["motor", "actuator", "servo"],
        "a motion is driven by [[driver]], a moment is [[torque]], a law of control [[state]] of type \"pid\"",
    ),
    (
        &["controller", "control", "pid"],
        "a law of control is [[state]] of type \"pid\", or of type \"formula\" with [[element]] for its forces",
    ),
    (&["gear"], "gears are [[joint]] of type \"gear\" on two [[joint_angle]]"),
    (&["link", "rigid", "rigidbody"], "rigid bodies are [[body]]"),
    (&["constraint"], "constraints are [[joint]], also by formulas of one's own, of type \"formula\""),
    (&["sensor", "measure", "measurement", "probe"], "what is measured is [[functional]]"),
    (&["parameter", "param", "constant"], "design variables are [variable], other numbers by names [define]"),
    (&["film", "movie", "video"], "the report of a run, report.html, plays its motion"),
    (&["solver", "simulation", "integrator", "integration"], "duration, steps and method stand in [settings]"),
];

/// What serves for a word of other programs; of longer words those between `_` count.
fn instead(given: &str) -> Option<&'static str> {
    let given = given.to_lowercase();
    let is_word =
        |word: &&str| given.split(['_', '-', ' ', '.']).any(|part| part.strip_suffix('s').unwrap_or(part) == *word);
    ELSEWHERE.iter().find(|(words, _)| words.iter().any(&is_word)).map(|own| own.1)
}

/// Says that `given` is no known `kind`, with what serves for it or the nearest name.
pub(super) fn unknown_or_elsewhere(kind: &str, given: &str, known: &[String]) -> String {
    match instead(given) {
        Some(instead) => format!("{kind} \"{given}\" is not known: {instead}"),
        None => unknown(kind, given, known),
    }
}
