//! Everything that is measured: each element, joint, driver, spring and load of the library, and what a user wrote.

use super::user::{UserBeam, UserRevolute};
use ShellSection::{Isotropic, Laminate};
use costate::elements::NodeKind::{self, Body, Coordinates, Natural, Point, Slope};
use costate::elements::entries::{Entry, Given, JointVisitor, Placed, SpringVisitor};
use costate::elements::flexible::ShellSection;
use costate::elements::forces::{LoadFrame, Touching};
use costate::elements::joints::Freedom;
use costate::elements::{
    AnyConstraint, AnyElement, Constraint, Element, Flexible, Nonholonomic, TimeFunction, forces, joints,
};
use costate::internals::{
    AngleCoordinate, BeamField, BeamGravityField, Cable, CableGravity, CableInertia, DiscOnPlane, EulerParameterNorm, Face,
    Gravity, HeldNode, NaturalBody, OrthonormalAxes, PointMass, Quad4, Quad9, RevoluteJoint, RigidBody, RollingDisc,
    RollingSphere, ShellField, ShellPressureField, SmallStrainCableField, Soft, SoftContact, TiedNode, Triangle6,
};
use costate::scalar::{Quaternion, SpatialVector, Vector3};

/// An element or a constraint with its type erased.
pub enum Physics {
    Element(Box<dyn AnyElement>),
    Constraint(Box<dyn AnyConstraint>),
}

/// What is measured.
pub struct Item {
    pub name: String,
    pub nodes: &'static [NodeKind],
    pub physics: Box<dyn Fn() -> Physics>,
}

fn element<T: Into<Box<dyn AnyElement>>>(
    name: impl Into<String>,
    nodes: &'static [NodeKind],
    own: impl Fn() -> T + 'static,
) -> Item {
    Item { name: name.into(), nodes, physics: Box::new(move || Physics::Element(own().into())) }
}

fn constraint<T: Into<Box<dyn AnyConstraint>>>(
    name: impl Into<String>,
    nodes: &'static [NodeKind],
    own: impl Fn() -> T + 'static,
) -> Item {
    Item { name: name.into(), nodes, physics: Box::new(move || Physics::Constraint(own().into())) }
}

const BODIES: &[NodeKind] = &[Body, Body];
const NATURAL: &[NodeKind] = &[Natural, Natural];
const NATURAL_END: NodeKind = NodeKind::Natural;
const BEAM: &[NodeKind] = &[Body, Body, Body];
const CABLE: &[NodeKind] = &[Slope, Slope];
const SHELL: &[NodeKind] = &[Body; 9];
const SHELL_OF_FOUR: &[NodeKind] = &[Body; 4];
const SHELL_OF_SIX: &[NodeKind] = &[Body; 6];

fn beam(coupled: bool, damped: bool) -> Flexible<BeamField> {
    Flexible(BeamField { coupled, damped, eccentric: coupled })
}

fn shell<F: Face>(face: F, section: ShellSection, damped: bool) -> Flexible<ShellField<F>> {
    Flexible(ShellField { face, section, damped })
}

/// Kinds of elements.
fn elements() -> Vec<Item> {
    let (on, a, b) = (NodeKind::Body, NodeKind::Body, NodeKind::Body);
    let pressure = |frame: LoadFrame| Flexible(ShellPressureField { face: Quad9, frame, size: TimeFunction::Constant });
    vec![
        element("rigid body", &[Body], move || RigidBody),
        element("rigid body in natural coordinates", &[Natural], move || NaturalBody),
        element("point mass", &[Point], move || PointMass),
        element("beam", BEAM, move || beam(false, false)),
        element("beam damped", BEAM, move || beam(false, true)),
        element("beam coupled and eccentric", BEAM, move || beam(true, false)),
        element("weight of a beam", BEAM, move || Flexible(BeamGravityField { eccentric: true })),
        element("cable", CABLE, move || Cable { damped: false }),
        element("cable damped", CABLE, move || Cable { damped: true }),
        element("cable of small strain", CABLE, move || Flexible(SmallStrainCableField)),
        element("shell", SHELL, move || shell(Quad9, Isotropic, false)),
        element("shell damped", SHELL, move || shell(Quad9, Isotropic, true)),
        element("shell of plies", SHELL, move || shell(Quad9, Laminate, false)),
        element("shell of four nodes", SHELL_OF_FOUR, move || shell(Quad4, Isotropic, false)),
        element("shell of six nodes", SHELL_OF_SIX, move || shell(Triangle6, Isotropic, false)),
        element("dead pressure on a shell", SHELL, move || pressure(LoadFrame::World)),
        element("follower pressure on a shell", SHELL, move || pressure(LoadFrame::Body)),
        element("inertia of a cable", CABLE, move || CableInertia),
        element("weight of a cable", CABLE, move || CableGravity),
        element("weight", &[Body], move || Gravity { on }),
        element("contact of spheres that gives way", BODIES, move || -> Box<dyn AnyElement> {
            Box::new(SoftContact { nodes: [a, b], touching: Touching::Spheres, exponent: 1.5, has_friction: true })
        }),
        element("soft revolute joint", BODIES, move || -> Box<dyn AnyElement> { Box::new(Soft(RevoluteJoint([a, b]))) }),
    ]
}

/// Kinds of joints.
fn joints() -> Vec<Item> {
    let (a, b) = (NodeKind::Body, NodeKind::Body);
    let mut entries = Entries(Vec::new());
    joints::visit_all(&mut entries);
    let others = vec![
        constraint("revolute between natural coordinates", NATURAL, move || RevoluteJoint([NATURAL_END; 2])),
        constraint("tied node", &[Body; 4], move || TiedNode { carriers: 3, b }),
        constraint("held node", &[Body], move || HeldNode { kind: a, held: Freedom::ALL.to_vec() }),
        constraint("angle coordinate", &[Body, Body, Coordinates(1)], move || AngleCoordinate([a, b])),
        constraint("disc on plane", BODIES, move || DiscOnPlane([a, b])),
        constraint("rolling disc", BODIES, move || Nonholonomic(RollingDisc([a, b]))),
        constraint("rolling sphere", BODIES, move || Nonholonomic(RollingSphere([a, b]))),
        constraint("unit length of Euler parameters", &[Coordinates(7)], move || -> Box<dyn AnyConstraint> {
            Box::new(EulerParameterNorm)
        }),
        constraint("orthonormal axes", &[Coordinates(12)], move || -> Box<dyn AnyConstraint> { Box::new(OrthonormalAxes) }),
    ];
    entries.0.into_iter().chain(others).collect()
}

/// Joints, drivers, springs, dampers and loads by their entries, as their examples make them.
struct Entries(Vec<Item>);

impl JointVisitor for Entries {
    fn visit<J: Entry<Law: Constraint>>(&mut self) {
        let driven = if Constraint::is_driver(&example::<J>()) { "driven " } else { "" };
        let name = format!("{driven}{}", J::NAME.replace('_', " "));
        self.0.push(constraint(name, J::EXAMPLE.0, || -> Box<dyn AnyConstraint> { Box::new(example::<J>()) }));
    }
}

impl SpringVisitor for Entries {
    fn visit<E: Entry<Law: Element>>(&mut self) {
        // springs and dampers of one name are told apart by their types; what is interpolated is a field
        let path = std::any::type_name::<E>().trim_end_matches('>').trim_end_matches("Field");
        let of_type = path.rsplit("::").next().unwrap_or(path);
        let word = |c: char| if c.is_uppercase() { format!(" {}", c.to_lowercase()) } else { c.into() };
        let name: String = of_type.chars().map(word).collect();
        self.0.push(element(name.trim_start(), E::EXAMPLE.0, || -> Box<dyn AnyElement> { Box::new(example::<E>()) }));
    }
}

/// The formula that the example of an entry makes.
fn example<E: Entry>() -> E::Law {
    let (nodes, example) = E::EXAMPLE;
    let q: Vec<Vec<f64>> = nodes.iter().enumerate().map(|(place, kind)| standing(place, *kind)).collect();
    let placed = nodes.iter().zip(&q).map(|(&kind, q)| ("node", Placed { kind, q }));
    let values = example.iter().map(|(key, sample)| (*key, sample.placed(Vector3::zeros(), Quaternion::identity())));
    E::make::<f64>(&mut Given::new(E::NAME, placed, values.collect())).0
}

/// Coordinates of a node, each at a place and a turn of its own.
fn standing(place: usize, kind: NodeKind) -> Vec<f64> {
    let turn = Quaternion::about(Vector3::new(0.0, 1.0, 0.0), place as f64);
    match kind {
        Body => [&[place as f64, 0.0, 0.0][..], &turn.0].concat(),
        Slope => [[place as f64, 0.0, 0.0], turn.rotate(Vector3::new(1.0, 0.0, 0.0)).components()].concat(),
        kind => vec![0.0; kind.dofs()],
    }
}

/// What a user wrote, each with the name of its model in the library.
pub fn of_users() -> Vec<(Item, &'static str)> {
    let beam = || -> Box<dyn AnyElement> { Box::new(Flexible(UserBeam)) };
    let joint = || -> Box<dyn AnyConstraint> { Box::new(UserRevolute) };
    vec![(element("a user's beam", BEAM, beam), "beam"), (constraint("a user's revolute", BODIES, joint), "revolute")]
}

/// Springs and dampers.
fn springs() -> Vec<Item> {
    let mut entries = Entries(Vec::new());
    forces::visit_all(&mut entries);
    entries.0
}

/// All of the library, then those of users.
pub fn all() -> Vec<Item> {
    elements().into_iter().chain(springs()).chain(joints()).chain(of_users().into_iter().map(|(item, _)| item)).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn no_two_items_have_one_name() {
        let items = super::all();
        let mut names: Vec<&str> = items.iter().map(|item| &*item.name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count, "{names:?}");
    }

    #[test]
    fn every_element_and_constraint_of_the_library_is_measured() {
        let list = include_str!("items.rs");
        let mut found = 0;
        for folder in ["bodies", "flexible", "forces", "joints"] {
            let path = format!("{}/../src/elements/{folder}", env!("CARGO_MANIFEST_DIR"));
            for file in std::fs::read_dir(path).expect("a folder of the library") {
                let path = file.expect("a file").path();
                // the faces of shells are tables, without formulas
                if path.is_dir() {
                    continue;
                }
                let text = std::fs::read_to_string(path).expect("text");
                for line in text.lines().filter(|line| line.starts_with("impl")) {
                    let Some((of, name)) = line.split_once(" for ") else { continue };
                    let is_physics = ["Element", "Constraint", "NonholonomicConstraint", "Field"]
                        .iter()
                        .any(|own| of.trim_start_matches("impl").split("> ").last().map(str::trim) == Some(own));
                    let name = name.trim_end_matches('{').trim().split('<').next().unwrap_or_default();
                    // Displacement and Slide are what a bushing and a slide spring are made of; Apart has no equation
                    if is_physics && !["Displacement", "Slide", "Apart"].contains(&name) {
                        // those with an entry are in the list of entries
                        let entry = text.contains("impl Entry for");
                        assert!(entry || list.contains(name), "{name} is not measured");
                        found += 1;
                    }
                }
            }
        }
        assert!(found > 40, "only {found} found");
    }
}
