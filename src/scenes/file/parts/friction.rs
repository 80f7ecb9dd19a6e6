//! Friction of joints, clutches and brakes.

use super::contact::coefficients;
use crate::elements::{Friction, NodeKind, Parameter, State};
use crate::scenes::file::describing::*;
use std::sync::Arc;

pub(super) const FRICTION: Section = Section {
    forms: one_form![
        NAME,
        need("joint", Type::Item(&["joint"]), "name of a revolute, prismatic or point_on_line joint"),
        need("sliding", Number("-", AtLeastZero), "coefficient of friction where its surfaces slip"),
        may("static", Number("-", AtLeastZero), "the same where they stick, not below that; sliding"),
        may("preload", Number("N", AtLeastZero), "force that presses them together beside that of the joint; 0"),
        may("radius", Number("m", Positive), "radius of the bearing of a revolute joint, which needs it"),
    ],
    space: "friction",
    build: |e, m| {
        let &Built::Joint(joint) = e.built("joint")? else {
            return e.wrong_key("joint", "only a rigid joint has friction");
        };
        let Some([sliding, sticking]) = coefficients(e)? else { return Ok(Built::Nothing) };
        let radius = e.given("radius", Entry::number)?;
        let made = m.joint_friction(joint, [sliding, sticking, e.number_or("preload", 0.0)?], radius);
        Ok(made.map_or(Built::Nothing, Built::Friction))
    },
    ..Section::listed(
        "friction",
        "Coulomb friction of a joint, by the force that it carries: its surfaces stick, as long as the static limit holds them, or slip with a force \
         against it.",
    )
};

pub(super) const CLUTCH: Section = Section {
    forms: one_form![
        NAME,
        need(
            "between",
            at_least(1, &Node),
            "two coordinates whose rates it makes equal, as of a [[joint_angle]]; or one, which it brakes"
        ),
        may("nodes", NAMED_NODES, "nodes by the names that the formulas give them, as numbers that events change; none"),
        DEFINITIONS,
        OWN_TABLES,
        need(
            "capacity",
            OfNodes("N, N m"),
            "force or moment while it slips, a number or a formula of its nodes and of the time"
        ),
        may("static", OfNodes("N, N m"), "the largest that it holds while it sticks, not below that; capacity"),
    ],
    space: "friction",
    build: |e, m| {
        let mut reading = Reading::new(e, m)?;
        let capacity = reading.take_key(e, "capacity", [true, true])?;
        let sticking = reading.take_key(e, "static", [true, true])?;
        let mut between = Vec::new();
        for (at, own) in e.list("between") {
            let Value::Node(place) = own else { continue };
            let [node] = e.nodes_at(at, place, m)?[..] else { return Err(Mistake::new(at, "one node is wanted")) };
            let kind = m.model.node(node).kind;
            if kind != NodeKind::Coordinates(1) {
                return Err(Mistake::new(at, format!("this is {}: a clutch is between coordinates", kind.words())));
            }
            between.push(node);
        }
        let count = between.len();
        if count == 2 && between[0] == between[1] {
            return e.wrong_key("between", "both sides are the same coordinate");
        }
        if count > 2 {
            return e.wrong_key("between", "a clutch has two sides at most");
        }
        let Reading { nodes, formulas, p, .. } = reading;
        let capacity = capacity.unwrap_or_default();
        let own = Clutch { formulas: Arc::new(formulas), limits: [capacity, sticking.unwrap_or(capacity)], sides: count };
        Ok(m.clutch(e.name(), &[nodes, between].concat(), own, &p).map_or(Built::Nothing, Built::Friction))
    },
    ..Section::listed(
        "clutch",
        "Friction between two coordinates, or of one: a clutch or a brake with a capacity of its own, which slips, or sticks and holds both together.",
    )
};

/// Friction between one or two coordinates behind the nodes of its formulas, which give its limits.
#[derive(Hash)]
struct Clutch {
    formulas: Arc<Formulas>,
    limits: [usize; 2],
    sides: usize,
}

impl Friction for Clutch {
    fn nodes(&self) -> Vec<NodeKind> {
        let sides = std::iter::repeat_n(NodeKind::Coordinates(1), self.sides);
        self.formulas.kinds().into_iter().chain(sides).collect()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.formulas.parameters()
    }
    fn slip<S: Scalar>(&self, v: &[S], _q: &[S], _p: &[S], _t: S, s: &mut [S]) {
        let rates = &v[v.len() - self.sides..];
        s[0] = if let [a, b] = rates { *b - *a } else { rates[0] };
    }
    fn limits<S: Scalar>(&self, _load: S, state: State<S>, p: &[S], t: S) -> [S; 2] {
        let known = self.formulas.arguments([state.v, state.q], t, p);
        self.limits.map(|which| self.formulas.number(which, &known, p))
    }
}
