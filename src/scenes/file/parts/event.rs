//! What happens at instants, and numbers that only this changes.

use crate::assembly::{EventArguments, Target};
use crate::elements::NodeKind;
use crate::program::Digest;
use crate::scalar::Quaternion;
use crate::scenes::file::describing::*;
use crate::scenes::file::state_entries::MADE;

pub(super) const NUMBER: Section = Section {
    forms: one_form![NAME, may("initial", Number("", Any), "value at the start; 0")],
    build: |e, m| Ok(Built::Node(m.number(e.name(), e.number_or("initial", 0.0)?))),
    ..Section::with_nodes(
        "number",
        "A number that only events change: a mode, a counter, a speed that is kept in mind. Formulas know a number c among their nodes as c.value.",
        Nodes::one(&[("value", false, true)]),
    )
};

pub(super) const EVENT: Section = Section {
    forms: one_form![
        NAME,
        may("nodes", NAMED_NODES, "nodes, or points of them, by the names that the formulas give them; none"),
        DEFINITIONS,
        OWN_TABLES,
        may("when", OfNodes("any"), "what passes zero there, of anything that elements know"),
        may("at", Number("s", Positive), "or the time at which it happens"),
        may("direction", Choice(&["rising", "falling", "both"]), "in which the formula passes zero; both"),
        may("once", Flag, "it happens no second time; false"),
        may(
            "set",
            Type::NamedFormulas("any"),
            "new values by names of what formulas know: the value of a number, coordinate or state, the rate of a coordinate, position and velocity of \
             a point or body, angular_velocity of a body, as in { \"ball.velocity\" = \"-e * ball.velocity\" }; all from the values before; none"
        ),
        may("remove", OneOrMore(&Type::Item(WITH_MULTIPLIERS)), "joints that are removed, as one that breaks; none"),
        may(
            "lock",
            OneOrMore(&Type::Item(WITH_MULTIPLIERS)),
            "joints that are not there at the start (`present = false`) or were removed, and come with an impact without restitution; none"
        ),
        may("end", Flag, "the run ends there; false"),
    ],
    space: "event",
    build,
    ..Section::listed(
        "event",
        "What happens where a formula passes zero, or at a time. Steps end there, whatever method makes them, and gradients go through the time of it.",
    )
};

/// How new values of a node are made of a formula's.
#[derive(Clone, Copy, Hash)]
enum Made {
    /// They are these.
    AsGiven,
    /// Rates of the Euler parameters at these places in q, by an angular velocity.
    Turning(usize),
}

fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let mut reading = Reading::new(e, m)?;
    let when = reading.take_key(e, "when", [true, true])?;
    let at = e.given("at", Entry::number)?;
    let mut resets = Vec::new();
    let own = match (when, at) {
        (Some(which), None) => {
            let first = e.context.numbers.len();
            if let Some((at, Value::Formula(formula, _))) = e.get("when")
                && !formula.uses_from(first)
            {
                return Err(Mistake::new(at, "this depends on no node and not on the time t: it passes zero never"));
            }
            which
        }
        (None, Some(_)) => 0,
        _ => return e.wrong("an event needs one of when and at"),
    };
    if let Some((_, Value::Formulas(given))) = e.get("set") {
        for (name, at, formula) in given {
            let (targets, made, is_vector) = targets(e, &reading, m, name).map_err(|what| Mistake::new(*at, what))?;
            if formula.is_vector() != is_vector {
                let wanted = if is_vector { "a vector" } else { "a number" };
                return Err(Mistake::new(*at, format!("{name} takes {wanted}")));
            }
            resets.push((targets, made, reading.take(*at, formula, [true, true])?));
        }
    }
    let Reading { nodes, formulas, p, .. } = reading;
    let p = [p, at.into_iter().collect()].concat();
    let number = |EventArguments { v, q, p, t, .. }: EventArguments| match at {
        Some(_) => t - p[p.len() - 1],
        None => formulas.number(own, &formulas.arguments([v, q], t, p), p),
    };
    let index = m.model.events.len();
    let Some(event) =
        m.add_event(e.name(), &nodes, &[], &p, Some(Digest::of(&("event", &formulas, own, at.is_some()))), number)
    else {
        return Ok(Built::Nothing);
    };
    event.directions = match e.text("direction") {
        Some("rising") => [true, false],
        Some("falling") => [false, true],
        _ => [true; 2],
    };
    (event.once, event.ends_run) = (e.flag("once"), e.flag("end"));
    let [removed, added] = ["remove", "lock"].map(|key| {
        let joints = e.list(key).filter_map(|(_, value)| match value {
            Value::Item(item, _) => Some(&e.context.built[*item]),
            _ => None,
        });
        joints
            .flat_map(|built| match built {
                Built::Joint(joint) | Built::Contact(joint, ..) => vec![*joint],
                Built::Stops(own) => own.iter().map(|own| own.0).collect(),
                _ => Vec::new(),
            })
            .collect::<Vec<_>>()
    });
    m.event_changes(&removed, &added);
    if !resets.is_empty() {
        let targets = resets.iter().flat_map(|own| own.0.clone()).collect();
        let made: Vec<(Made, usize)> = resets.iter().map(|own| (own.1, own.2)).collect();
        m.add_event_sets(
            &nodes,
            &p,
            targets,
            Some(Digest::of(&("event sets", &formulas, made))),
            |EventArguments { v, q, p, t, .. }| {
                let known = formulas.arguments([v, q], t, p);
                let values = resets.iter().flat_map(|(_, made, which)| match (*made, formulas.value(*which, &known, p)) {
                    (Made::Turning(place), omega) => {
                        let turned = Quaternion::from_slice(&q[place..]);
                        turned.rate_of_body_velocity(turned.rotate_back(omega.vector())).to_vec()
                    }
                    (Made::AsGiven, value) => value.components(),
                });
                values.collect()
            },
        );
    }
    Ok(Built::Event(index))
}

/// What a name under `set` stands for: numbers of the motion, how they are made, and whether of a vector.
fn targets(e: Entry, reading: &Reading, m: &Builder, name: &str) -> Result<(Vec<Target>, Made, bool), String> {
    let (alias, what) = name.rsplit_once('.').unwrap_or((name, "value"));
    let Some(node) = reading.names.iter().position(|own| *own == alias) else {
        return Err(format!("there is no \"{alias}\" among the nodes"));
    };
    let KnownNode { kind, has_point } = reading.formulas.nodes[node];
    let first = m.model.node(reading.nodes[node]).dofs.start;
    if m.model.node(reading.nodes[node]).fixed {
        return Err("the ground never moves".into());
    }
    let vector = |target: fn(usize) -> Target, from: usize, count: usize| (from..from + count).map(target).collect();
    let is_body = kind.has_axes();
    match (kind, what) {
        (NodeKind::States(_), _) => {
            let names = names_of_states(e, node);
            match names.iter().position(|own| *own == what) {
                Some(place) => Ok((vec![Target::Rate(first + place)], Made::AsGiven, false)),
                None => Err(format!("\"{alias}\" has no value \"{what}\"; it has: {}", names.join(", "))),
            }
        }
        (NodeKind::Coordinates(_), "value") => Ok((vec![Target::Coordinate(first)], Made::AsGiven, false)),
        (NodeKind::Coordinates(_), "rate") => Ok((vec![Target::Rate(first)], Made::AsGiven, false)),
        (NodeKind::Coordinates(_), _) => Err(format!("of \"{alias}\" value and rate can be set")),
        (_, "position" | "velocity") if has_point => {
            Err(format!("what is set is that of the node: name \"{alias}\" without a point"))
        }
        (_, "position") => Ok((vector(Target::Coordinate, first, 3), Made::AsGiven, true)),
        (_, "velocity") => Ok((vector(Target::Rate, first, 3), Made::AsGiven, true)),
        (NodeKind::Body, "angular_velocity") => {
            let place = reading.formulas.place(node).start + 3;
            Ok((vector(Target::Rate, first + 3, 4), Made::Turning(place), true))
        }
        _ if is_body => Err(format!("of \"{alias}\" position, velocity and angular_velocity can be set")),
        _ => Err(format!("of \"{alias}\" position and velocity can be set")),
    }
}

/// Names of the states of a node of an entry.
fn names_of_states<'k>(e: Entry<'k>, node: usize) -> Vec<&'k str> {
    let Some((_, Value::NamedNodes(given))) = e.get("nodes") else { return Vec::new() };
    let Some(item) = given.get(node).and_then(|own| own.place.item).map(|item| &e.context.items[item]) else {
        return Vec::new();
    };
    let keys = ["initial", MADE[0]];
    let states = keys.into_iter().find_map(|key| match item.fields.get(key) {
        Some((_, Value::Formulas(all))) => Some(all.iter().map(|own| &*own.0).collect()),
        _ => None,
    });
    states.unwrap_or_else(|| vec!["value"])
}
