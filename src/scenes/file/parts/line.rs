//! What beams and cables share: a line with its ends in nodes, and a motion at the start.

use crate::assembly::NodeId;
use crate::scenes::file::describing::*;

const MOTION: Forms = one_form![
    may("point", Vector("m"), "point with the velocity; the origin"),
    may("velocity", Vector("m/s"), "velocity of the point; 0"),
    may("angular_velocity", Vector("rad/s"), "angular velocity in the world; 0"),
];

pub(super) const LINE: [Key; 8] = [
    need("name", Text, "name; its nodes are NAME.start, NAME.end and NAME[i], counted from 0"),
    need("from", Vector("m"), "where it starts"),
    may("to", Vector("m"), "where it ends; required unless `arc` is given"),
    need("elements", Count(1, MOST), "equal elements"),
    may("start_node", Node, "node that it starts in; its own"),
    may("end_node", Node, "node that it ends in; its own"),
    may("clamped", OneOrMore(&Choice(&["start", "end"])), "ends that never move; none"),
    may("motion", Table(&MOTION), "rigid motion that it starts with; at rest"),
];

/// Nodes of a line.
pub(super) const LINE_NODES: Nodes = Nodes { edges: &["start", "end"], own: 1, of_edge: 0, known: OF_POINT };

/// Gives nodes of a member the motion that the entry says. Nodes of others that have a motion of their own must have the same.
pub(super) fn set_motion(e: Entry, nodes: &[NodeId], m: &mut Builder) -> Result<()> {
    let Some(own) = e.table("motion") else { return Ok(()) };
    let vector = |key| own.vector_or(key, Vector3::zeros());
    let moves = |key: &str| match e.get(key) {
        Some((_, Value::Node(NodePlace { item: Some(item), .. }))) => {
            let item = &e.context.items[*item];
            let has = |key: &&str| item.fields.values.iter().any(|own| own.0 == *key);
            ["velocity", "angular_velocity", "motion"].iter().any(has).then_some(item)
        }
        _ => None,
    };
    let shared = [("start_node", nodes.first()), ("end_node", nodes.last())];
    let rates = |node: NodeId, m: &Builder| -> Vec<f64> {
        let dofs = m.model.find_node(node).map_or(0..0, |own| own.dofs.clone());
        m.numbers.v[dofs].iter().map(|own| own.value()).collect()
    };
    let given = shared.into_iter().filter_map(|(key, node)| Some((moves(key)?, *node?)));
    let given: Vec<(&Item, NodeId, Vec<f64>)> = given.map(|(item, node)| (item, node, rates(node, m))).collect();
    m.set_rigid_motion(nodes, vector("point")?, vector("velocity")?, vector("angular_velocity")?);
    for (item, node, before) in given {
        let now = rates(node, m);
        let size = now.iter().chain(&before).fold(0.0, |most: f64, own| most.max(own.abs()));
        if now.iter().zip(&before).any(|(now, before)| (now - before).abs() > crate::tolerances::CONSISTENT * size) {
            let name = &item.name;
            return e.wrong_key("motion", format!(
                "this motion gives \"{name}\" another velocity than it has of its own: let both be the same, or one of them say it"
            ));
        }
    }
    Ok(())
}

/// A line with its ends in the nodes that are named, or clamped.
pub(super) fn with_ends<L>(
    e: Entry,
    mut line: L,
    joined: [fn(L, NodeId) -> L; 2],
    clamped: [fn(L) -> L; 2],
    m: &mut Builder,
) -> Result<L> {
    for (place, [key, end]) in [["start_node", "start"], ["end_node", "end"]].into_iter().enumerate() {
        let is_clamped = e.texts("clamped").any(|own| own == end);
        match e.given(key, |e, key| e.node(key, m))? {
            Some(_) if is_clamped => {
                let text =
                    format!("clamped = \"{end}\" has no effect beside {key}: hold that node, or leave one of them out");
                return e.wrong_key("clamped", text);
            }
            Some(node) => line = joined[place](line, node),
            None if is_clamped => line = clamped[place](line),
            None => {}
        }
    }
    Ok(line)
}
