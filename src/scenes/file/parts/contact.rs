//! Shapes of bodies, and contacts between them.

use crate::assembly::NodeId;
use crate::elements::NodeKind;
use crate::scenes::SoftLaw;
use crate::scenes::file::describing::*;
use crate::tolerances::CONSISTENT;

/// What of a node touches others.
#[derive(Clone)]
pub(in crate::scenes::file) enum Shape {
    /// Spheres, or points, whose radius is 0, by their centres; of several the hull is meant.
    Spheres(NodeId, Vec<Vector3<Recorded>>, Recorded),
    /// A plane, by a point and its normal.
    Plane(NodeId, [Vector3<Recorded>; 2]),
}

impl Shape {
    fn node(&self) -> NodeId {
        match self {
            Shape::Spheres(node, ..) | Shape::Plane(node, _) => *node,
        }
    }
}

const ON: Key = need("on", Node, "node, or ground");
const CENTRE: Key = may("centre", Vector("m"), "its centre in the world at the start; the place of the node");
const RADIUS: Key = need("radius", Number("m", Positive), "radius");

const FORMS: [Form; 5] = [
    Form { name: "point", doc: "a point", keys: &[ON, CENTRE] },
    Form { name: "sphere", doc: "a sphere", keys: &[ON, CENTRE, RADIUS] },
    Form {
        name: "capsule",
        doc: "a cylinder with a half sphere at each end: a contact with a plane is one of each of these",
        keys: &[
            ON,
            need("from", Vector("m"), "centre of its first half sphere in the world at the start"),
            need("to", Vector("m"), "that of its second one"),
            RADIUS,
        ],
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
            "plane" => Shape::Plane(node, [at("point")?, e.vector("normal")?]),
            "point" => Shape::Spheres(node, vec![at("centre")?], zero),
            "capsule" => {
                let [from, to] = [e.vector("from")?, e.vector("to")?];
                if (to - from).length().value() == 0.0 {
                    return e.wrong_key("to", "both ends are at one place: that is a sphere");
                }
                Shape::Spheres(node, vec![from, to], e.number("radius")?)
            }
            "box" => Shape::Spheres(node, corners(e, at("centre")?)?, zero),
            _ => Shape::Spheres(node, vec![at("centre")?], e.number("radius")?),
        };
        outline(&shape, m);
        Ok(Built::Shape(shape))
    },
    ..Section::listed("shape", "What of a node touches others: a contact is between two of them.")
};

/// Corners of a box in an order that passes along all of its edges.
const EDGES: [usize; 16] = [0, 1, 3, 2, 0, 4, 5, 1, 5, 7, 3, 7, 6, 2, 6, 4];
/// Lines of which a circle is drawn.
const LINES: usize = 24;

/// Draws a shape but a plane, which has no end: the edges of a box, circles of spheres, lines along capsules.
fn outline(shape: &Shape, m: &mut Builder) {
    let Shape::Spheres(node, centres, radius) = shape else { return };
    if centres.len() == 8 {
        m.draw(*node, &EDGES.map(|corner| centres[corner]));
    }
    if radius.value() == 0.0 {
        return;
    }
    let axes = match centres[..] {
        [first, second] => (second - first).perpendiculars(),
        _ => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from_f64),
    };
    let [u, w] = axes.map(|own| own * *radius);
    let third = axes[0].cross(&axes[1]) * *radius;
    let circle = |centre: Vector3<Recorded>, [u, w]: [Vector3<Recorded>; 2]| {
        let at = |k: usize| std::f64::consts::TAU * k as f64 / LINES as f64;
        (0..=LINES).map(|k| centre + u * Recorded::from(at(k).cos()) + w * Recorded::from(at(k).sin())).collect::<Vec<_>>()
    };
    for &centre in centres {
        [[u, w], [w, third], [third, u]].into_iter().for_each(|axes| m.draw(*node, &circle(centre, axes)));
    }
    if let [first, second] = centres[..] {
        [u, -u, w, -w].into_iter().for_each(|aside| m.draw(*node, &[first + aside, second + aside]));
    }
}

/// The corners of a box.
fn corners(e: Entry, centre: Vector3<Recorded>) -> Result<Vec<Vector3<Recorded>>> {
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
    let edges = [first * size[0], second * size[1], first.cross(&second) * size[2]];
    let corner = |k: usize| {
        let sides = (0..3).map(|axis| if k >> axis & 1 == 0 { -0.5 } else { 0.5 });
        edges.iter().zip(sides).fold(centre, |at, (edge, side)| at + *edge * Recorded::from(side))
    };
    Ok((0..8).map(corner).collect())
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
        need("between", exactly(2, &SHAPES), "two shapes: a plane and another one, or two spheres or points"),
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
        // the plane, or the sphere of a body, is first
        if matches!(shapes[..], [Shape::Spheres(..), Shape::Plane(..)]) {
            shapes.swap(0, 1);
        }
        if shapes[0].node() == shapes[1].node() {
            return e.wrong_key("between", "both shapes are on the same node: they never move against each other");
        }
        let law = law_of(e, &shapes)?;
        let nodes = [shapes[0].node(), shapes[1].node()];
        let mut made = Vec::new();
        match &shapes[..] {
            [Shape::Plane(_, [point, normal]), Shape::Spheres(_, centres, radius)] => {
                for (k, &centre) in centres.iter().enumerate() {
                    let name = if centres.len() == 1 { e.name().to_string() } else { format!("{}, {}", e.name(), k + 1) };
                    let (sphere, plane) = ((centre, *radius), (*point, *normal));
                    match law {
                        Law::Rigid(law, friction) => {
                            made.extend(m.sphere_on_plane(&name, nodes, sphere, plane, law, friction))
                        }
                        Law::Soft(law) => drop(m.soft_sphere_on_plane(&name, nodes, sphere, plane, law)),
                    }
                }
            }
            [Shape::Spheres(_, a, radius_a), Shape::Spheres(_, b, radius_b)]
                if a.len() + b.len() == 2 && radius_a.value() + radius_b.value() > 0.0 =>
            {
                let spheres = [(a[0], *radius_a), (b[0], *radius_b)];
                match law {
                    Law::Rigid(law, friction) => made.extend(m.sphere_on_sphere(e.name(), nodes, spheres, law, friction)),
                    Law::Soft(law) => drop(m.soft_sphere_on_sphere(e.name(), nodes, spheres, law)),
                }
            }
            _ => {
                let text = "a contact is between a plane and another shape, or between two spheres, of which one may be a point: write corners of a body \
                            as points, and other pairs as [[stop]]s by formulas";
                return e.wrong_key("between", text);
            }
        }
        Ok(match made[..] {
            [] if matches!(law, Law::Soft(_)) => Built::SoftJoint,
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

#[derive(Clone, Copy)]
enum Law {
    /// Restitution and rest speed, coefficients of friction.
    Rigid([Recorded; 2], Option<[Recorded; 2]>),
    Soft(SoftLaw<Recorded>),
}

fn law_of(e: Entry, shapes: &[Shape]) -> Result<Law> {
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
            let curvature = |shape: &Shape| match shape {
                Shape::Spheres(_, _, radius) if radius.value() > 0.0 => Ok(radius.recip()),
                Shape::Plane(..) => Ok(Recorded::from(0.0)),
                Shape::Spheres(..) => {
                    e.wrong_key("modulus", "Hertz's law is of round surfaces: corners and points have a stiffness")
                }
            };
            let all = curvature(&shapes[0])? + curvature(&shapes[1])?;
            (modulus * Recorded::from(4.0 / 3.0) / all.sqrt(), 1.5)
        }
        _ => return e.wrong_key("modulus", "stiffness is that of a linear law, modulus that of Hertz's: give one of them"),
    };
    Ok(Law::Soft(SoftLaw { stiffness, exponent, damping: e.number_or("damping", 0.0)?, friction }))
}
