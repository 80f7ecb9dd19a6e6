//! Nodes, joints and members belong to the mechanism that made them: another one refuses them by name.

use super::Drag;
use costate::elements::flexible::{CableSection, Section};
use costate::elements::forces::LoadFrame;
use costate::elements::joints::HeldSlope;
use costate::functionals::LoadKind;
use costate::functionals::quantities::{CableMeasure, SectionMeasure};
use costate::internals::ReactionNorm;
use costate::prelude::*;
use costate::scenes::{BeamLine, BeamMember, CableLine, CableMember, ConstraintId, NodeId};

/// What a builder is asked to do with a node of another one.
type WithStranger = (&'static str, fn(&mut MechanismBuilder<f64>, NodeId, NodeId));

#[test]
fn nodes_of_another_mechanism_are_refused_by_the_name_of_what_takes_hold_of_them() {
    let (zero, x) = (Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0));
    let mut other = MechanismBuilder::<f64>::default();
    let strangers: Vec<NodeId> = (0..9).map(|i| other.point(&format!("{i}"), zero)).collect();
    let calls: &[WithStranger] = &[
        ("element", |m, _, node| {
            m.element("element", &[node], Drag, &[]);
        }),
        ("mass", |m, _, node| {
            m.rigid_body("mass", node, 1.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        }),
        ("bob", |m, _, node| {
            m.point_mass("bob", node, 1.0);
        }),
        ("ball", |m, body, node| {
            m.spherical("ball", [body, node], Vector3::zeros());
        }),
        ("hinge", |m, body, node| {
            m.revolute("hinge", [node, body], Vector3::zeros(), Vector3::x());
        }),
        ("weld", |m, body, node| {
            m.fixed("weld", [node, body], Vector3::zeros());
        }),
        ("link", |m, body, node| {
            m.rigid_link("link", [node, body]);
        }),
        ("angle", |m, body, node| {
            m.joint_angle("angle", [node, body], Vector3::x());
        }),
        ("gear", |m, body, node| {
            m.gear("gear", [node, body], [1.0, 1.0]);
        }),
        ("screw", |m, body, node| {
            m.helical("screw", [body, node], Vector3::zeros(), Vector3::x(), 0.1);
        }),
        ("rack", |m, body, node| {
            m.rack_and_pinion("rack", [body, node, body], [Vector3::zeros(), Vector3::y()], Vector3::x());
        }),
        ("disc", |m, body, node| {
            m.rolling_disc(
                ["touch", "disc"],
                [body, node],
                (Vector3::y(), Vector3::x()),
                (Vector3::zeros(), Vector3::y()),
                1.0,
            );
        }),
        ("spring", |m, body, node| {
            m.line_spring("spring", [body, node], [Vector3::zeros(), Vector3::x()], 1.0, 1.0);
        }),
        ("bush", |m, body, node| {
            let [stiffness_along, stiffness_about, damping_along, damping_about] = [[1.0; 3]; 4];
            let rates = BushingRates { stiffness_along, stiffness_about, damping_along, damping_about };
            m.bushing("bush", [body, node], Vector3::zeros(), Quaternion::identity(), rates);
        }),
        ("coil", |m, _, node| {
            m.coordinate_spring_damper("coil", node, 0, SpringDamper { stiffness: 1.0, damping: 1.0, rest: 1.0 });
        }),
        ("arm", |m, _, node| {
            let line = BeamLine::straight([Vector3::zeros(), Vector3::x()], 1, Vector3::y()).from_node(node);
            m.beam("arm", line, &Section::new([1.0; 6]));
        }),
        ("rope", |m, _, node| {
            let line = CableLine::straight([Vector3::zeros(), Vector3::x()], 1).from_node(node);
            m.cable("rope", line, &CableSection::new(1.0, 1.0, 1.0));
        }),
        ("splice", |m, body, node| {
            m.cable_weld("splice", [body, node], HeldSlope::Direction);
        }),
        ("pin", |m, body, node| {
            m.cable_hinge("pin", [body, node], Vector3::x());
        }),
        ("corner", |m, _, node| {
            m.cable_corner("corner", [node, node]);
        }),
        ("set_velocity", |m, _, node| m.set_velocity(node, Vector3::x(), Vector3::zeros())),
        ("set_velocity", |m, body, node| m.set_rigid_motion(&[body, node], Vector3::zeros(), Vector3::x(), Vector3::x())),
        ("draw", |m, _, node| m.draw(node, &[Vector3::zeros(), Vector3::x()])),
        ("place", |m, _, node| m.position_functional("place", Over::Terminal, node, Vector3::zeros(), Vector3::x())),
        ("turn", |m, body, node| m.joint_angle_functional("turn", Over::Terminal, [body, node], Vector3::x())),
        ("slip", |m, body, node| {
            m.joint_speed_functional("slip", Over::Terminal, [body, node], Vector3::zeros(), Vector3::x());
        }),
        ("count", |m, _, node| m.coordinate_functional("count", Over::Terminal, node, 0)),
        ("sag", |m, _, node| m.cable_deflection_functional("sag", Over::Terminal, [node, node], Vector3::z())),
    ];
    // the last one has a number that this mechanism has not given to any node, the first one that of its own first node
    for stranger in [strangers[8], strangers[0]] {
        for (name, call) in calls {
            let mut m = MechanismBuilder::default();
            let body = m.body("body", zero, Quaternion::identity());
            m.gravity(x);
            call(&mut m, body, stranger);
            let message = m.finish().err().unwrap_or_else(|| panic!("\"{name}\": the stranger went unnoticed"));
            assert!(
                message.contains(&format!("\"{name}\"")) && message.contains("node of another mechanism"),
                "{name}: {message}"
            );
        }
    }
}

/// Two bodies, so many balls between them, a beam and a cable.
fn equipped(joints: usize) -> (MechanismBuilder<f64>, [NodeId; 2], ConstraintId, BeamMember, CableMember) {
    let zero = Vector3::zeros();
    let ends = [zero, Vector3::x()];
    let mut m = MechanismBuilder::<f64>::default();
    let bodies = [0, 1].map(|i| m.body(&format!("{i}"), zero, Quaternion::identity()));
    let joint = (0..joints).map(|i| m.spherical(&format!("{i}"), bodies, zero)).last().expect("at least one");
    let beam = m.beam("arm", BeamLine::straight(ends, 1, Vector3::y()), &Section::new([1.0; 6]));
    let cable = m.cable("rope", CableLine::straight(ends, 1), &CableSection::new(1.0, 1.0, 1.0));
    (m, bodies, joint, beam, cable)
}

/// What a mechanism says to a joint and members that are not its own.
fn refusal(
    mut m: MechanismBuilder<f64>,
    body: NodeId,
    joint: ConstraintId,
    beam: &BeamMember,
    cable: &CableMember,
) -> String {
    let (over, zero, x) = (Over::Terminal, Vector3::zeros(), Vector3::x());
    m.reaction_functional("reaction", over, joint, &[1.0; 3]);
    m.reaction_norm_functional("norm", over, joint);
    m.joint_load_functional("load", over, (joint, body), (LoadKind::Force, LoadFrame::World), x, zero);
    m.functional("own", over, (&[], &[joint]), ReactionNorm { equations: vec![0], unit: "N" }, &[]);
    m.section_functional("moment", over, beam, 0.5, SectionMeasure::Force(4));
    m.distributed_load("wind", beam, (LoadFrame::World, x), Signal::Constant(1.0));
    m.cable_strain_functional("strain", over, cable, 0.5, CableMeasure::Strain);
    m.largest_cable_stress_functional("stress", cable, 1.0, 0.1, 1.0);
    m.finish().err().expect("the strangers went unnoticed")
}

#[test]
fn joints_and_members_of_another_mechanism_are_refused() {
    let (_, _, joint, beam, cable) = equipped(9);
    let mut empty = MechanismBuilder::default();
    let body = empty.body("body", Vector3::zeros(), Quaternion::identity());
    // a mechanism without such numbers, and one with the same numbers
    let (twin, [own, _], ..) = equipped(9);
    for message in [refusal(empty, body, joint, &beam, &cable), refusal(twin, own, joint, &beam, &cable)] {
        for name in ["reaction", "norm", "load", "own", "moment", "wind", "strain", "stress"] {
            assert!(
                message.split("; ").any(|one| one.contains(&format!("\"{name}")) && one.contains("of another mechanism")),
                "{name}: {message}"
            );
        }
    }
}
