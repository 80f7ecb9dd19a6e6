//! Shapes of bodies, and contacts between them.

use crate::assembly::NodeId;
use crate::scenes::file::describing::*;

/// What of a body touches others.
pub(in crate::scenes::file) enum Shape {
    /// Spheres of one radius: a sphere, a point, the ends of a capsule, the corners of a box.
    Spheres(NodeId, Vec<Vector3<Recorded>>, Recorded),
    /// A plane, by a point and its normal.
    Plane(NodeId, [Vector3<Recorded>; 2]),
}

const ON: Key = need("on", Node, "node, or ground");
const CENTRE: Key = may("centre", Vector("m"), "its centre in the world at the start; the place of the node");

const FORMS: [Form; 5] = [
    Form { name: "point", doc: "a point", keys: &[ON, CENTRE] },
    Form { name: "sphere", doc: "a sphere", keys: &[ON, CENTRE, need("radius", Number("m", Positive), "radius")] },
    Form {
        name: "capsule",
        doc: "a cylinder with half spheres at both ends: on a plane, these touch",
        keys: &[
            ON,
            need("ends", exactly(2, &Vector("m")), "centres of the half spheres in the world at the start"),
            need("radius", Number("m", Positive), "radius"),
        ],
    },
    Form {
        name: "box",
        doc: "a box: on a plane, its corners touch",
        keys: &[
            ON,
            CENTRE,
            need(
                "axes",
                exactly(2, &Vector("-")),
                "directions of its first two edges in the world at the start, at right angles",
            ),
            need("size", Vector("m"), "lengths of its edges"),
        ],
    },
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
        let at = |key: &str| if e.has(key) { e.vector(key) } else { Ok(m.position(node)) };
        let shape = match e.form {
            "plane" => Shape::Plane(node, [at("point")?, e.vector("normal")?]),
            "point" => Shape::Spheres(node, vec![at("centre")?], Recorded::from(0.0)),
            "sphere" => Shape::Spheres(node, vec![at("centre")?], e.number("radius")?),
            "capsule" => Shape::Spheres(node, e.points("ends")?, e.number("radius")?),
            _ => {
                let (centre, size) = (at("centre")?, e.vector("size")?.components());
                let axes = e.points("axes")?;
                let [first, second] = [0, 1].map(|k| axes[k] * (Recorded::from(1.0) / axes[k].length()));
                if first.dot(&second).value().abs() > RIGHT_ANGLE {
                    return e.wrong_key("axes", "the edges of a box are at right angles");
                }
                let axes = [first, second, first.cross(&second)];
                let corner = |number: usize| {
                    (0..3).fold(centre, |corner, k| {
                        let half = if number >> k & 1 == 1 { 0.5 } else { -0.5 };
                        corner + axes[k] * (size[k] * half)
                    })
                };
                Shape::Spheres(node, (0..8).map(corner).collect(), Recorded::from(0.0))
            }
        };
        Ok(Built::Shape(shape))
    },
    ..Section::listed("shape", "What of a node touches others: a contact is between two of them.")
};

/// Cosine of two edges of a box that are at right angles.
const RIGHT_ANGLE: f64 = 1e-9;

const SHAPES: Type = Type::Item(&["shape"]);

pub(super) const CONTACT: Section = Section {
    forms: one_form![
        NAME,
        need("between", exactly(2, &SHAPES), "two shapes, of which one is a plane"),
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
        let shapes: Vec<&Shape> = e
            .list("between")
            .filter_map(|(_, value)| match value {
                Value::Item(item, _) => Some(&e.context.built[*item]),
                _ => None,
            })
            .filter_map(|built| if let Built::Shape(shape) = built { Some(shape) } else { None })
            .collect();
        let (plane, spheres) = match shapes[..] {
            [Shape::Plane(a, plane), Shape::Spheres(b, centres, radius)]
            | [Shape::Spheres(b, centres, radius), Shape::Plane(a, plane)] => ((*a, plane), (*b, centres, *radius)),
            _ => {
                return e.wrong_key(
                    "between",
                    "contacts are between a plane and a sphere, point, capsule or box: no others are known yet",
                );
            }
        };
        let friction = match (e.given("sliding", Entry::number)?, e.given("static", Entry::number)?) {
            (None, None) => None,
            (None, Some(_)) => return e.wrong_key("static", "static friction needs sliding friction beside it"),
            (Some(sliding), sticking) => {
                let sticking = sticking.unwrap_or(sliding);
                if sticking.value() < sliding.value() {
                    return e.wrong_key("static", "static friction is not below that of what slides");
                }
                Some([sliding, sticking])
            }
        };
        let law = ["restitution", "rest_speed"].map(|key| e.number_or(key, 0.0));
        let [restitution, rest_speed] = law;
        let (law, mut made) = ([restitution?, rest_speed?], Vec::new());
        let (b, centres, radius) = spheres;
        let count = centres.len();
        for (number, &centre) in centres.iter().enumerate() {
            let name = if count == 1 { e.name().to_string() } else { format!("{}, {}", e.name(), number + 1) };
            made.extend(m.sphere_on_plane(&name, [plane.0, b], (centre, radius), (plane.1[0], plane.1[1]), law, friction));
        }
        Ok(Built::Contacts(made))
    },
    ..Section::listed(
        "contact",
        "Two shapes that hit, push and leave each other, rigidly, with Coulomb friction: they stick and roll, or slip. Its reaction is that of a joint of its name.",
    )
};
