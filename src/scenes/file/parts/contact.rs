//! Shapes of bodies, and contacts between them.

use crate::assembly::NodeId;
use crate::elements::NodeKind;
use crate::scenes::file::describing::*;
use crate::scenes::{ContactShape, SoftLaw};
use crate::tolerances::CONSISTENT;

/// What of a node touches others.
#[derive(Clone)]
pub(in crate::scenes::file) struct Shape(NodeId, ContactShape<Recorded>);

const ON: Key = need("on", Node, "node, or ground");
const CENTRE: Key = may("centre", Vector("m"), "its centre in the world at the start; the place of the node");
const RADIUS: Key = need("radius", Number("m", Positive), "radius");

const ENDS: [Key; 2] = [
    need("from", Vector("m"), "middle of its first end in the world at the start"),
    need("to", Vector("m"), "that of its second one"),
];

const FORMS: [Form; 6] = [
    Form { name: "point", doc: "a point", keys: &[ON, CENTRE] },
    Form { name: "sphere", doc: "a sphere", keys: &[ON, CENTRE, RADIUS] },
    Form {
        name: "capsule",
        doc: "a cylinder with a half sphere at each end: a contact with a plane is one of each of these",
        keys: &[ON, ENDS[0], ENDS[1], RADIUS],
    },
    Form {
        name: "cylinder",
        doc: "a cylinder with flat ends: a contact with a plane is one of each of its rims, and has no derivatives where it stands on an end",
        keys: &[ON, ENDS[0], ENDS[1], RADIUS],
    },
    Form {
        name: "box",
        doc: "a box: a contact with a plane is one of each of its 8 corners",
        keys: &[
            ON,
            CENTRE,
            need("size", Vector("m"), "lengths of its edges along axis, second_axis, and at right angles to both"),
            may("axis", Vector("-"), "direction of its first edges in the world at the start; x"),
            may("second_axis", Vector("-"), "that of its second ones, at right angles to the first; y"),
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
        let of_more = ["centre", "point", "from", "size"].into_iter().find(|key| e.has(key));
        if let Some(key) = of_more.filter(|_| m.model.node(node).kind == NodeKind::Point) {
            return e.wrong_key(key, "this is on a point, which has no points but itself: leave it out");
        }
        let at = |key: &str| if e.has(key) { e.vector(key) } else { Ok(m.position(node)) };
        let zero = Recorded::from(0.0);
        let shape = match e.form {
            "plane" => ContactShape::Plane { point: at("point")?, normal: e.vector("normal")? },
            "point" => ContactShape::Sphere { middle: at("centre")?, radius: zero },
            "capsule" | "cylinder" => {
                let (ends, radius) = ([e.vector("from")?, e.vector("to")?], e.number("radius")?);
                if (ends[1] - ends[0]).length().value() == 0.0 {
                    return e.wrong_key("to", "both ends are at one place: that is a sphere");
                }
                match e.form {
                    "capsule" => ContactShape::Capsule { ends, radius },
                    _ => ContactShape::Cylinder { ends, radius },
                }
            }
            "box" => ContactShape::Box { middle: at("centre")?, edges: edges(e)? },
            _ => ContactShape::Sphere { middle: at("centre")?, radius: e.number("radius")? },
        };
        outline(node, &shape, m);
        Ok(Built::Shape(Shape(node, shape)))
    },
    ..Section::listed("shape", "What of a node touches others: a contact is between two of them.")
};

/// Corners of a box in an order that passes along all of its edges.
const EDGES: [usize; 16] = [0, 1, 3, 2, 0, 4, 5, 1, 5, 7, 3, 7, 6, 2, 6, 4];
/// Lines of which a circle is drawn.
const LINES: usize = 24;

/// Draws a shape but a plane, which has no end: the edges of a box, circles of spheres and ends, lines along what is long.
fn outline(node: NodeId, shape: &ContactShape<Recorded>, m: &mut Builder) {
    let (middles, radius) = shape.spheres();
    if let ContactShape::Box { .. } = shape {
        m.draw(node, &EDGES.map(|corner| middles[corner]));
    }
    if radius.value() == 0.0 {
        return;
    }
    let axes = match middles[..] {
        [first, second] => (second - first).perpendiculars(),
        _ => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from_f64),
    };
    let [u, w] = axes.map(|own| own * radius);
    let third = axes[0].cross(&axes[1]) * radius;
    let circle = |centre: Vector3<Recorded>, [u, w]: [Vector3<Recorded>; 2]| {
        let at = |k: usize| std::f64::consts::TAU * k as f64 / LINES as f64;
        (0..=LINES).map(|k| centre + u * Recorded::from(at(k).cos()) + w * Recorded::from(at(k).sin())).collect::<Vec<_>>()
    };
    let circles = if let ContactShape::Cylinder { .. } = shape { 1 } else { 3 };
    for &middle in &middles {
        let all = [[u, w], [w, third], [third, u]];
        all.into_iter().take(circles).for_each(|axes| m.draw(node, &circle(middle, axes)));
    }
    if let [first, second] = middles[..] {
        [u, -u, w, -w].into_iter().for_each(|aside| m.draw(node, &[first + aside, second + aside]));
    }
}

/// Halves of three edges of a box.
fn edges(e: Entry) -> Result<[Vector3<Recorded>; 3]> {
    let size = e.vector("size")?;
    if (0..3).any(|k| size[k].value() <= 0.0) {
        return e.wrong_key("size", "the edges of a box are longer than 0");
    }
    let axis = |key: &str, k: usize| {
        let mut own = [0.0; 3];
        own[k] = 1.0;
        e.vector_or(key, Vector3::from_f64(own))
    };
    let [first, second] = [axis("axis", 0)?, axis("second_axis", 1)?];
    let lengths = [first, second].map(|own| own.length());
    if lengths.iter().any(|own| own.value() == 0.0) {
        return e.wrong("axis and second_axis are directions: they have a length");
    }
    let [first, second] = [first * lengths[0].recip(), second * lengths[1].recip()];
    if first.dot(&second).value().abs() > CONSISTENT {
        return e.wrong("axis and second_axis of a box are at right angles to each other");
    }
    let half = |k: usize| size[k] * Recorded::from(0.5);
    Ok([first * half(0), second * half(1), first.cross(&second) * half(2)])
}

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
        need(
            "between",
            exactly(2, &SHAPES),
            "two shapes: a plane and another one, or two spheres, of which one may be a point; of those that give way also a sphere and another one, or two capsules"
        ),
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
        may("stiffness", Number("N/m", Positive), "k: they give way by the depth d under k d, instead of being rigid"),
        may(
            "modulus",
            Number("Pa", Positive),
            "E of Hertz's law instead, under 4/3 E sqrt(R) d^(3/2): 1/E is the sum of (1 - nu^2)/E of both, 1/R that of 1/radius"
        ),
        may(
            "damping",
            Number("s/m", AtLeastZero),
            "c of what gives way: its force is 1 + c dd/dt times as large, never below 0; 0"
        ),
        may(
            "slip_speed",
            Number("m/s", Positive),
            "s_0 of what gives way, with sliding: friction is |s| / sqrt(|s|^2 + s_0^2) times as large at a slip s, so that all creeps that would stick"
        ),
    ],
    space: "joint",
    build: |e, m| {
        let shape = |(_, value): (usize, &Value)| match value {
            Value::Item(item, _) => match &e.context.built[*item] {
                Built::Shape(shape) => Some(shape.clone()),
                _ => None,
            },
            _ => None,
        };
        let mut shapes: Vec<Shape> = e.list("between").filter_map(shape).collect();
        // the plane is first
        if matches!(shapes[..], [_, Shape(_, ContactShape::Plane { .. })]) {
            shapes.swap(0, 1);
        }
        let [Shape(a, first), Shape(b, second)] = shapes[..] else {
            return e.wrong_key("between", "two shapes are wanted");
        };
        if a == b {
            return e.wrong_key("between", "both shapes are on the same node: they never move against each other");
        }
        let (law, friction) = match law_of(e, &[first, second])? {
            Law::Rigid(law, friction) => (law, friction),
            Law::Soft(law) => {
                m.soft_contact(e.name(), [a, b], [first, second], law);
                return Ok(Built::SoftJoint);
            }
        };
        let mut made = Vec::new();
        match [first, second] {
            [ContactShape::Plane { .. }, ContactShape::Plane { .. } | ContactShape::Cylinder { .. }] => {
                return e.wrong_key("between", RIGID_PAIRS);
            }
            [ContactShape::Plane { point, normal }, other] => {
                let (middles, radius) = other.spheres();
                for (k, &middle) in middles.iter().enumerate() {
                    let name = if middles.len() == 1 { e.name().to_string() } else { format!("{}, {}", e.name(), k + 1) };
                    made.extend(m.sphere_on_plane(&name, [a, b], (middle, radius), (point, normal), law, friction));
                }
            }
            [ContactShape::Sphere { middle, radius }, ContactShape::Sphere { middle: other, radius: of_other }]
                if radius.value() + of_other.value() > 0.0 =>
            {
                made.extend(m.sphere_on_sphere(e.name(), [a, b], [(middle, radius), (other, of_other)], law, friction));
            }
            _ => return e.wrong_key("between", RIGID_PAIRS),
        }
        Ok(match made[..] {
            [] => Built::Nothing,
            [(joint, hit, friction)] => Built::Contact(joint, hit, friction),
            _ => Built::Stops(made.into_iter().map(|(joint, hit, _)| (joint, hit)).collect()),
        })
    },
    ..Section::listed(
        "contact",
        "Two shapes that hit, push and leave each other. Rigid ones have Coulomb friction: they stick and roll, or slip, and their reaction is that of a joint \
         of the same name. With `stiffness` or `modulus` they give way, and friction is a function of the slip.",
    )
};

const RIGID_PAIRS: &str = "a rigid contact is between a plane and a sphere, point, capsule or box, or between two spheres, of which one may be a point: give \
                           others a stiffness, write corners of a body as points, or pairs as [[stop]]s by formulas";

#[derive(Clone, Copy)]
enum Law {
    /// Restitution and rest speed, coefficients of friction.
    Rigid([Recorded; 2], Option<[Recorded; 2]>),
    Soft(SoftLaw<Recorded>),
}

fn law_of(e: Entry, shapes: &[ContactShape<Recorded>; 2]) -> Result<Law> {
    let is_soft = e.has("stiffness") || e.has("modulus");
    let others = if is_soft { &["restitution", "rest_speed", "static"][..] } else { &["damping", "slip_speed"] };
    if let Some(key) = others.iter().find(|key| e.has(key)) {
        return e.wrong_key(
            key,
            match is_soft {
                true => "this is of rigid contacts, not of one with stiffness or modulus: its damping takes energy, its friction has a slip_speed",
                false => "this is of a contact that gives way: give it stiffness or modulus, too",
            },
        );
    }
    if !is_soft {
        let law = [e.number_or("restitution", 0.0)?, e.number_or("rest_speed", 0.0)?];
        return Ok(Law::Rigid(law, coefficients(e)?));
    }
    let friction = match [e.given("sliding", Entry::number)?, e.given("slip_speed", Entry::number)?] {
        [Some(sliding), Some(speed)] => Some([sliding, speed]),
        [None, None] => None,
        [Some(_), None] => return e.wrong_key("sliding", "friction of a contact that gives way needs a slip_speed"),
        [None, Some(_)] => return e.wrong_key("slip_speed", "this is of friction: give sliding, too"),
    };
    let (stiffness, exponent) = match [e.given("stiffness", Entry::number)?, e.given("modulus", Entry::number)?] {
        [Some(stiffness), None] => (stiffness, 1.0),
        [None, Some(modulus)] => {
            let curvature = |shape: &ContactShape<Recorded>| match shape {
                ContactShape::Plane { .. } => Ok(Recorded::from(0.0)),
                ContactShape::Sphere { radius, .. } | ContactShape::Capsule { radius, .. } if radius.value() > 0.0 => {
                    Ok(radius.recip())
                }
                _ => e.wrong_key(
                    "modulus",
                    "Hertz's law is of spheres, capsules and planes: what has corners or rims has a stiffness",
                ),
            };
            let all = curvature(&shapes[0])? + curvature(&shapes[1])?;
            (modulus * Recorded::from(4.0 / 3.0) / all.sqrt(), 1.5)
        }
        _ => return e.wrong_key("modulus", "stiffness is that of a linear law, modulus that of Hertz's: give one of them"),
    };
    Ok(Law::Soft(SoftLaw { stiffness, exponent, damping: e.number_or("damping", 0.0)?, friction }))
}
