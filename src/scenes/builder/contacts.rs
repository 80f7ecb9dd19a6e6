//! Shapes that touch by laws that give way.

use super::MechanismBuilder;
use crate::assembly::{ElementId, NodeId};
use crate::elements::forces::{SoftContact, Touching};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// The law of a [`SoftContact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftLaw<S> {
    /// k [N/m^n].
    pub stiffness: S,
    /// n: 1, or 3/2 of Hertz's law.
    pub exponent: f64,
    /// c [s/m].
    pub damping: S,
    /// Coefficient of friction mu [-] and the slip speed below which it is a damper [m/s].
    pub friction: Option<[S; 2]>,
}

/// What of a node touches others, by world points and directions \[m\].
#[derive(Clone, Copy, Debug)]
pub enum ContactShape<S> {
    /// A plane with what is behind it.
    Plane {
        /// A point of it.
        point: Vector3<S>,
        /// Away from it.
        normal: Vector3<S>,
    },
    /// A box.
    Box {
        /// Its middle.
        middle: Vector3<S>,
        /// Halves of three edges, from there, at right angles to each other.
        edges: [Vector3<S>; 3],
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Middles of its ends.
        ends: [Vector3<S>; 2],
        /// Its radius.
        radius: S,
    },
    /// A cylinder with half spheres as ends.
    Capsule {
        /// Middles of these.
        ends: [Vector3<S>; 2],
        /// Its radius.
        radius: S,
    },
    /// A sphere, or a point.
    Sphere {
        /// Its middle.
        middle: Vector3<S>,
        /// Its radius, 0 of a point.
        radius: S,
    },
}

impl<S: Scalar> ContactShape<S> {
    /// What is first of two that touch has the smaller number.
    fn order(&self) -> usize {
        match self {
            ContactShape::Plane { .. } => 0,
            ContactShape::Box { .. } => 1,
            ContactShape::Cylinder { .. } => 2,
            ContactShape::Capsule { .. } => 3,
            ContactShape::Sphere { .. } => 4,
        }
    }

    /// Whether there is a contact with another one that gives way.
    fn has_contact_with(&self, other: &ContactShape<S>) -> bool {
        use ContactShape::{Capsule, Plane, Sphere};
        match (self, other) {
            (Plane { .. }, Plane { .. }) => false,
            (Sphere { radius, .. }, Sphere { radius: other, .. }) => radius.value() + other.value() > 0.0,
            (Sphere { radius, .. }, ContactShape::Box { .. } | ContactShape::Cylinder { .. })
            | (ContactShape::Box { .. } | ContactShape::Cylinder { .. }, Sphere { radius, .. }) => radius.value() > 0.0,
            (Plane { .. } | Sphere { .. }, _) | (_, Plane { .. } | Sphere { .. }) | (Capsule { .. }, Capsule { .. }) => true,
            _ => false,
        }
    }

    /// The middles of spheres whose hull it is, with their radius; of a cylinder, whose hull is none, those of its ends.
    pub fn spheres(&self) -> (Vec<Vector3<S>>, S) {
        match self {
            ContactShape::Plane { .. } => (Vec::new(), S::zero()),
            ContactShape::Box { middle, edges } => {
                let side = |corner: usize, axis: usize| S::from(if corner >> axis & 1 == 0 { -1.0 } else { 1.0 });
                let corner = |k: usize| (0..3).fold(*middle, |at, axis| at + edges[axis] * side(k, axis));
                ((0..8).map(corner).collect(), S::zero())
            }
            ContactShape::Cylinder { ends, radius } | ContactShape::Capsule { ends, radius } => (ends.to_vec(), *radius),
            ContactShape::Sphere { middle, radius } => (vec![*middle], *radius),
        }
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// Contact of two shapes by a law that gives way: of a plane with anything, of a sphere with anything, one of which may be a point, and of two
    /// capsules. A box touches a plane with its 8 corners, a capsule with its 2 ends, a cylinder with the 2 rims: one element for each of these.
    pub fn soft_contact(
        &mut self,
        name: &str,
        mut nodes: [NodeId; 2],
        mut shapes: [ContactShape<S>; 2],
        law: SoftLaw<S>,
    ) -> Vec<ElementId> {
        if shapes[0].order() > shapes[1].order() {
            shapes.reverse();
            nodes.reverse();
        }
        let normal = match shapes[0] {
            ContactShape::Plane { normal, .. } => vec![("normal", normal.into())],
            _ => Vec::new(),
        };
        let mut given = self.given(name, &nodes, normal.clone());
        let (kinds, mut all) = (given.body_and_guided(), Vec::new());
        let normal = if normal.is_empty() { None } else { Some(given.unit("normal")) };
        let at = |node: usize, point: Vector3<S>| given.node(node).local_point(point).components().to_vec();
        let round = |node: usize, middle: Vector3<S>, radius: S| [at(node, middle), vec![radius]].concat();
        let long =
            |node: usize, ends: [Vector3<S>; 2], radius: S| [at(node, ends[0]), round(node, ends[1], radius)].concat();
        match shapes {
            [ContactShape::Plane { point, normal: given_normal }, second] => {
                let plane = [at(0, point), given.local_directions(0, [normal.unwrap_or(given_normal)])].concat();
                let (middles, radius) = second.spheres();
                for middle in middles {
                    let (touching, own) = match second {
                        ContactShape::Cylinder { ends: [from, to], .. } => {
                            let axis = (to - from) * (to - from).length().recip();
                            let axis = given.local_directions(1, [axis]);
                            (Touching::RimOnPlane, [at(1, middle), axis, vec![radius]].concat())
                        }
                        _ => (Touching::SphereOnPlane, round(1, middle, radius)),
                    };
                    all.push((touching, [&plane[..], &own].concat()));
                }
            }
            [ContactShape::Box { middle, edges }, ContactShape::Sphere { middle: centre, radius }] => {
                let first = [at(0, middle), given.local_directions(0, edges)].concat();
                all.push((Touching::SphereOnBox, [first, round(1, centre, radius)].concat()));
            }
            [ContactShape::Cylinder { ends, radius: first }, ContactShape::Sphere { middle, radius }] => {
                all.push((Touching::SphereOnCylinder, [long(0, ends, first), round(1, middle, radius)].concat()));
            }
            [ContactShape::Capsule { ends, radius: first }, ContactShape::Sphere { middle, radius }] => {
                all.push((Touching::SphereOnCapsule, [long(0, ends, first), round(1, middle, radius)].concat()));
            }
            [ContactShape::Capsule { ends, radius: first }, ContactShape::Capsule { ends: others, radius }] => {
                all.push((Touching::Capsules, [long(0, ends, first), long(1, others, radius)].concat()));
            }
            [ContactShape::Sphere { middle, radius: first }, ContactShape::Sphere { middle: other, radius }] => {
                all.push((Touching::Spheres, [at(0, middle), at(1, other), vec![first, radius]].concat()));
            }
            _ => {}
        }
        if !shapes[0].has_contact_with(&shapes[1]) {
            let pairs = "is between a plane and another shape, a sphere and another shape, a point and a plane, sphere or capsule, or two capsules";
            given.wrong(format!("a contact that gives way {pairs}: compose other bodies of these"));
        }
        let wrong = given.mistakes();
        if !wrong.is_empty() {
            self.keep_mistakes(name, wrong);
            return vec![self.model.refused_element()];
        }
        let SoftLaw { stiffness, exponent, damping, friction } = law;
        let count = all.len();
        let make = |(k, (touching, geometry)): (usize, (Touching, Vec<S>))| {
            let name = if count == 1 { name.to_string() } else { format!("{name}, {}", k + 1) };
            let law = SoftContact { nodes: kinds, touching, exponent, has_friction: friction.is_some() };
            let p = [vec![stiffness, damping], friction.map_or_else(Vec::new, Vec::from), geometry].concat();
            self.add_element(&name, &nodes, Box::new(law), &p)
        };
        all.into_iter().enumerate().map(make).collect()
    }
}
