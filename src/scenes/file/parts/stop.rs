//! Stops, latches and ropes: equations that come with an impact, and go where their force would pull.

use crate::assembly::NodeId;
use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scenes::StopLaw;
use crate::scenes::file::describing::*;
use crate::scenes::file::formula::Formula;
use std::sync::Arc;

const ON: Key = may("on", Node, "a coordinate, or the angle of a [[joint_angle]], x; or value with nodes");
const BY_NODES: [Key; 4] = [
    may("nodes", NAMED_NODES, "nodes, or points of them, by the names that value gives them"),
    DEFINITIONS,
    OWN_TABLES,
    may("value", OfNodes("m, rad"), "or x as a formula of places of its nodes and of the time"),
];
const LEAST: Key = may("least", Number("m, rad", Any), "least x; none");
const MOST: Key = may("most", Number("m, rad", Any), "largest x; none");
const RESTITUTION: Key = may(
    "restitution",
    Number("-", Range::Share),
    "e: behind a hit dx/dt is -e times what it was before, from 0, which stays, to 1, which loses nothing; 0",
);
const REST_SPEED: Key = may(
    "rest_speed",
    Number("m/s, rad/s", AtLeastZero),
    "hits with less than this have no restitution: what bounces comes to rest; 0",
);

pub(super) const STOP: Section = Section {
    forms: one_form![NAME, ON, BY_NODES[0], BY_NODES[1], BY_NODES[2], BY_NODES[3], LEAST, MOST, RESTITUTION, REST_SPEED],
    space: "joint",
    has_columns: true,
    build: |e, m| {
        let limits = [("least", false), ("most", true)].into_iter().filter(|own| e.has(own.0));
        let limits: Vec<(&str, bool)> = limits.collect();
        if limits.is_empty() {
            return e.wrong("a stop needs least, most, or both");
        }
        if limits.len() == 2 && e.number("least")?.value() >= e.number("most")?.value() {
            return e.wrong_key("most", "least must be below most");
        }
        let mut made = Vec::new();
        for &(key, is_upper) in &limits {
            let name = if limits.len() == 1 { e.name().to_string() } else { format!("{}, {key}", e.name()) };
            let [restitution, rest_speed] = ["restitution", "rest_speed"].map(|key| e.number_or(key, 0.0));
            let law = StopLaw::Stop { is_upper, restitution: restitution?, rest_speed: rest_speed? };
            let (nodes, value, p) = of_value(e, m, e.number(key)?)?;
            made.extend(m.stop(&name, &nodes, value, &p, law));
        }
        Ok(Built::Stops(made))
    },
    ..Section::listed(
        "stop",
        "A limit of a coordinate, of a joint angle, or of a formula of places: it is hit with an impact under all joints, pushes as long as it would be \
         left, and lets go then. Its reaction is that of a joint of its name.",
    )
};

pub(super) const LATCH: Section = Section {
    forms: one_form![
        NAME,
        ON,
        BY_NODES[0],
        BY_NODES[1],
        BY_NODES[2],
        BY_NODES[3],
        need("at", Number("m, rad", Any), "x that is held once it is reached, with an impact without restitution"),
        may("strength", Number("N, N m", Positive), "size of its reaction beyond which it opens for good; none"),
    ],
    space: "joint",
    has_columns: true,
    build: |e, m| {
        let strength = e.given("strength", Entry::number)?;
        let (nodes, value, p) = of_value(e, m, e.number("at")?)?;
        Ok(Built::Stops(m.stop(e.name(), &nodes, value, &p, StopLaw::Latch { strength }).into_iter().collect()))
    },
    ..Section::listed("latch", "What holds a coordinate, a joint angle, or a formula of places once it is reached.")
};

/// x less its limit.
#[derive(Clone, Hash)]
struct Limited(Arc<Formulas>);

impl Constraint for Limited {
    const EQUATIONS: usize = 1;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.kinds()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters().into_iter().chain([Parameter::named("limit".to_string(), "")]).collect()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        let still = vec![S::zero(); q.len()];
        let known = self.0.arguments([&still, q], t, p);
        g[0] = self.0.number(0, &known, p) - p[p.len() - 1];
    }
}

/// The value of an entry, less a limit.
fn of_value(e: Entry, m: &mut Builder, limit: Recorded) -> Result<(Vec<NodeId>, Limited, Vec<Recorded>)> {
    let mut reading = Reading::new(e, m)?;
    if let (Some((at, Value::Formula(formula, _))), false) = (e.get("value"), e.has("on"))
        && !formula.uses_from(e.context.numbers.len())
    {
        return Err(Mistake::new(at, "this depends on no node and not on the time t: it never reaches a limit"));
    }
    match (e.has("on"), reading.take_key(e, "value", [false, true])?) {
        (true, None) => {
            let node = e.node("on", m)?;
            let kind = m.model.node(node).kind;
            if !matches!(kind, NodeKind::Coordinates(_)) {
                return e.wrong_key("on", format!("this is {}, which has no value: give nodes and value", kind.words()));
            }
            reading.add("x", node, kind);
            let own = Formula::number(e.context.numbers.len());
            reading.add_formula(&own);
        }
        (false, Some(_)) => {}
        _ => return e.wrong("one of on and value is needed, and value needs nodes"),
    }
    let Reading { nodes, formulas, p, .. } = reading;
    Ok((nodes, Limited(Arc::new(formulas)), [p, vec![limit]].concat()))
}
