//! Shapes of bodies, and contacts between them.

use crate::assembly::NodeId;
use crate::elements::NodeKind;
use crate::scenes::file::describing::*;

/// What of a node touches others.
#[derive(Clone, Copy)]
pub(in crate::scenes::file) enum Shape {
    /// A sphere, or a point, whose radius is 0.
    Sphere(NodeId, Vector3<Recorded>, Recorded),
    /// A plane, by a point and its normal.
    Plane(NodeId, [Vector3<Recorded>; 2]),
}

const ON: Key = need("on", Node, "node, or ground");
const CENTRE: Key = may("centre", Vector("m"), "its centre in the world at the start; the place of the node");

const FORMS: [Form; 3] = [
    Form { name: "point", doc: "a point", keys: &[ON, CENTRE] },
    Form { name: "sphere", doc: "a sphere", keys: &[ON, CENTRE, need("radius", Number("m", Positive), "radius")] },
    Form {
        name: "plane",
        doc: "a plane, with all that is behind it",
        keys: &[
            ON,
            may("point", Vector("m"), "point of it in the world at the start; the place of the node"),
            need("normal", Vector("-"), "direction away from it, in the world at the start"),
        ],
    },
];

pub(super) const SHAPE: Section = Section {
    forms: Forms { common: &[NAME], forms: &FORMS, own: None },
    space: "shape",
    build: |e, m| {
        let node = e.node("on", m)?;
        if let Some(key) = ["centre", "point"].into_iter().find(|key| e.has(key))
            && m.model.node(node).kind == NodeKind::Point
        {
            return e.wrong_key(key, "this is on a point, which has no points but itself: leave it out");
        }
        let at = |key: &str| if e.has(key) { e.vector(key) } else { Ok(m.position(node)) };
        let shape = match e.form {
            "plane" => Shape::Plane(node, [at("point")?, e.vector("normal")?]),
            "point" => Shape::Sphere(node, at("centre")?, Recorded::from(0.0)),
            _ => Shape::Sphere(node, at("centre")?, e.number("radius")?),
        };
        Ok(Built::Shape(shape))
    },
    ..Section::listed("shape", "What of a node touches others: a contact is between two of them.")
};

/// Coefficients of sliding and static friction, where they are given.
pub(super) fn coefficients(e: Entry) -> Result<Option<[Recorded; 2]>> {
    let Some(sliding) = e.given("sliding", Entry::number)? else {
        return if e.has("static") {
            e.wrong_key("static", "static friction needs sliding friction beside it")
        } else {
            Ok(None)
        };
    };
    let sticking = e.given("static", Entry::number)?.unwrap_or(sliding);
    if sticking.value() < sliding.value() {
        return e.wrong_key("static", "static friction is not below that of what slides");
    }
    Ok(Some([sliding, sticking]))
}

const SHAPES: Type = Type::Item(&["shape"]);

pub(super) const CONTACT: Section = Section {
    forms: one_form![
        NAME,
        need("between", exactly(2, &SHAPES), "two shapes, of which one at most is a plane"),
        may(
            "restitution",
            Number("-", Range::Share),
            "e: behind a hit they part at e times the speed at which they met, from 0, where they stay together, to 1; 0"
        ),
        may(
            "rest_speed",
            Number("m/s", AtLeastZero),
            "hits with less than this have no restitution: what bounces comes to rest; 0"
        ),
        may("sliding", Number("-", AtLeastZero), "coefficient of friction where they slip; no friction"),
        may("static", Number("-", AtLeastZero), "the same where they stick, not below that; sliding"),
    ],
    space: "joint",
    build: |e, m| {
        let shape = |(_, value): (usize, &Value)| match value {
            Value::Item(item, _) => match &e.context.built[*item] {
                Built::Shape(shape) => Some(*shape),
                _ => None,
            },
            _ => None,
        };
        let shapes: Vec<Shape> = e.list("between").filter_map(shape).collect();
        if let [Shape::Sphere(a, ..) | Shape::Plane(a, _), Shape::Sphere(b, ..) | Shape::Plane(b, _)] = shapes[..]
            && a == b
        {
            return e.wrong_key("between", "both shapes are on the same node: they never move against each other");
        }
        let friction = coefficients(e)?;
        let law = [e.number_or("restitution", 0.0)?, e.number_or("rest_speed", 0.0)?];
        let made = match shapes[..] {
            [Shape::Plane(a, plane), Shape::Sphere(b, centre, radius)]
            | [Shape::Sphere(b, centre, radius), Shape::Plane(a, plane)] => {
                m.sphere_on_plane(e.name(), [a, b], (centre, radius), (plane[0], plane[1]), law, friction)
            }
            [Shape::Sphere(a, centre_a, radius_a), Shape::Sphere(b, centre_b, radius_b)]
                if radius_a.value() + radius_b.value() > 0.0 =>
            {
                m.sphere_on_sphere(e.name(), [a, b], [(centre_a, radius_a), (centre_b, radius_b)], law, friction)
            }
            _ => {
                let text = "a contact is between two spheres, of which one may be a point, or one and a plane: write corners of a body as points, and other pairs as \
                            [[stop]]s by formulas";
                return e.wrong_key("between", text);
            }
        };
        Ok(made.map_or(Built::Nothing, |(joint, hit, friction)| Built::Contact(joint, hit, friction)))
    },
    ..Section::listed(
        "contact",
        "Two shapes that hit, push and leave each other, rigidly, with Coulomb friction: they stick and roll, or slip. Its reaction is that of a joint of its name.",
    )
};
