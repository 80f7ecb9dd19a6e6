//! What joints do to what they hold.

use super::{Measurand, measurand};
use crate::elements::entries::{Given, ON, PLACE};
use crate::elements::forces::load_frame::{FRAME, LoadFrame};
use crate::functionals::LoadKind;
use crate::scenes::file::describing::*;

/// The joint whose reactions are measured.
const OF_JOINT: Key = need("joint", Type::Item(WITH_MULTIPLIERS), "name of a joint or driver");

/// Which load, in which frame, along a direction and about a point of the world.
type Load = ((LoadKind, LoadFrame), [Vector3<Recorded>; 2]);

/// The load for which keys ask.
fn load(given: &mut Given<Recorded>) -> Load {
    let norms = [("force_norm", LoadKind::ForceNorm), ("moment_norm", LoadKind::MomentNorm)];
    let norm = norms.into_iter().find(|(word, _)| given.says("load", word));
    let kind = norm.map_or(if given.says("load", "moment") { LoadKind::Moment } else { LoadKind::Force }, |own| own.1);
    // a point may be named for a force, too, which is the same at all of them
    let point = given.point("point", 0);
    let frame = LoadFrame::given(given, LoadFrame::World);
    if norm.is_some() && given.has("frame") {
        given.wrong_key("frame", "frame has no effect on the size of a load: leave it out".into());
    }
    if norm.is_some() && given.has("direction") {
        let owner = given.owner();
        let text = format!("direction of the functional \"{owner}\" has no effect beside its other keys: leave it out");
        given.wrong_key("direction", text);
    }
    let direction = if norm.is_some() { Vector3::zeros() } else { given.vector("direction") };
    ((kind, frame), [direction, point])
}

const LOAD_KEYS: &[Key] = &[
    OF_JOINT,
    ON,
    PLACE,
    FRAME,
    need("load", Choice(&["force", "moment", "force_norm", "moment_norm"]), "which"),
    may("direction", Vector("-"), "direction in the world at the start; needed but for norms"),
];

pub(super) const OF_JOINTS: &[Measurand] = &[
    measurand(
        "reaction",
        "weighted sum of a joint's multipliers",
        &[OF_JOINT, need("weights", at_least(1, &Number("-", Any)), "a weight for each of its equations")],
        |e, over, m| {
            let joint = e.joint()?;
            m.reaction_functional(e.name(), over, joint, &e.series("weights")?);
            Ok(())
        },
    ),
    measurand(
        "reaction_norm",
        "length of the forces among a joint's multipliers [N]; of its moments [N m] where it has no force",
        &[OF_JOINT],
        |e, over, m| {
            m.reaction_norm_functional(e.name(), over, e.joint()?);
            Ok(())
        },
    ),
    measurand("joint_load", "force or moment of a joint on one of its nodes [N, N m]", LOAD_KEYS, |e, over, m| {
        let (joint, node) = (e.joint()?, e.node("on", m)?);
        let given = m.given(e.name(), &[node], values(e, LOAD_KEYS)?);
        let (load, [direction, point]) = built_from(e, given, load)?;
        m.joint_load_functional(e.name(), over, (joint, node), load, direction, point);
        Ok(())
    }),
    measurand(
        "joint_power",
        "power with which a joint or driver works on what it holds [W]: of a driver what it puts in; an integral is a work [J]",
        &[OF_JOINT, may("on", Node, "one of its nodes, to which the joint hands on so much; all")],
        |e, over, m| {
            let (joint, on) = (e.joint()?, e.given("on", |e, key| e.node(key, m))?);
            m.joint_power_functional(e.name(), over, joint, on);
            Ok(())
        },
    ),
];
