//! The list of elements with sample parameters.

use super::Contract;
use super::support::time_functions::time_functions;
use super::users::users_own;
use costate::elements::entries::{Entry, Given, GivenValue, JointVisitor, Placed, SpringVisitor};
use costate::elements::flexible::ShellSection;
use costate::elements::forces::{self, LoadFrame};
use costate::elements::{Constraint, Element, Field, Flexible, NodeKind, TimeFunction, joints};
use costate::internals::{
    AngleCoordinate, BeamField, BeamGravityField, Cable, CableGravity, CableInertia, ElementPhysics, Face, Gravity,
    NODE_PARAMETERS, NaturalBody, PointMass, Quad4, Quad9, RigidBody, ShellField, ShellPressureField, SmallStrainCableField,
    Soft, Triangle6,
};
use costate::scalar::{Quaternion, SpatialVector, Vector3};
use costate::testing::element_physics;
use std::sync::Arc;

use NodeKind::{Body, Natural, Point, Slope};

/// What a rigid motion of all nodes does to the element.
#[derive(Clone, Copy, PartialEq)]
pub enum UnderRigidMotion {
    /// The energies stay and the residual moves along.
    Invariant,
    /// It knows a direction of the world: weight and dead loads.
    BoundToWorld,
}
use UnderRigidMotion::{BoundToWorld, Invariant};

pub struct Case {
    pub name: String,
    pub element: Arc<dyn Contract>,
    pub physics: ElementPhysics,
    pub nodes: Vec<NodeKind>,
    /// Coordinates behind those of the nodes.
    pub scalars: usize,
    pub p: Vec<f64>,
    pub motion: UnderRigidMotion,
    /// Its nodes are turned against each other by less than a right angle, as those of one flexible element are.
    pub neighbours: bool,
    /// Parameters that this topology takes and, as documented, does not read: the start of their names.
    pub ignored: Vec<&'static str>,
    /// Its residual is written out, and its energies are not.
    pub without_energies: bool,
}

impl Case {
    pub fn new(name: impl Into<String>, element: impl Element, p: &[f64]) -> Case {
        let (nodes, others): (Vec<_>, Vec<_>) = element.nodes().into_iter().partition(|kind| kind.in_space().is_some());
        let scalars = others.iter().map(|kind| kind.dofs()).sum();
        let (name, element, p) = (name.into(), Arc::new(element), p.to_vec());
        let physics = element_physics(&element);
        Case {
            name,
            element,
            physics,
            nodes,
            scalars,
            p,
            motion: Invariant,
            neighbours: false,
            ignored: vec![],
            without_energies: false,
        }
    }
    /// A soft joint with the same coefficients for all rows, since rows along the axes of the world are among them.
    fn soft<J: Constraint>(name: &str, joint: J, p: &[f64]) -> Case {
        let coefficients = [vec![3.1; joint.equations()], vec![0.7; joint.equations()]].concat();
        let kind = if ["rotation", "translation"].contains(&name) { "drive" } else { "spring damper" };
        let nodes = joint.nodes();
        let mut case = Case::new(format!("soft {name} {kind}"), Soft(joint), &[&coefficients[..], p].concat());
        if let [a, b] = nodes[..] {
            case = case.ignoring("point a", a).ignoring("point b", b);
        }
        case
    }
    /// A flexible element of three bodies' nodes; each parameter differs from the others.
    fn flexible<F: Field>(name: String, field: F) -> Case {
        let p: Vec<f64> = (0..field.parameters().len()).map(|i| 0.6 + 0.5 * (1.7 * i as f64 + 0.3).sin()).collect();
        Case { neighbours: true, ..Case::new(name, Flexible(field), &p) }
    }
    /// An element of a cable between two nodes.
    fn cable(name: &str, element: impl Element, p: &[f64]) -> Case {
        Case { neighbours: true, ..Case::new(name, element, p) }
    }
    pub fn without_energies(self) -> Case {
        Case { without_energies: true, ..self }
    }
    pub fn bound_to_world(self, bound: bool) -> Case {
        Case { motion: if bound { BoundToWorld } else { Invariant }, ..self }
    }
    /// `name` is not read if its node has no axes.
    fn ignoring(mut self, name: &'static str, node: NodeKind) -> Case {
        if !node.has_axes() && node.in_space().is_some() {
            self.ignored.push(name);
        }
        self
    }
}

/// Soft versions of all joints and drivers, and all springs and dampers, on all nodes that they take.
struct Entries(Vec<Case>);

impl JointVisitor for Entries {
    fn visit<J: Entry<Law: Constraint>>(&mut self) {
        self.0.extend(made::<J>().into_iter().map(|(law, p)| Case::soft(J::NAME, law, &p)));
    }
}

impl SpringVisitor for Entries {
    fn visit<E: Entry<Law: Element>>(&mut self) {
        if E::KEYS.iter().any(|key| key.name == "size") {
            return self.0.extend(loads::<E>());
        }
        let is_given = |wanted: &str| E::EXAMPLE.1.iter().any(|(key, _)| *key == wanted);
        let kind = match [is_given("stiffness"), is_given("damping")] {
            [true, true] => "spring damper",
            [true, false] => "spring",
            [false, true] => "damper",
            [false, false] => "by a law",
        };
        for (law, p) in made::<E>() {
            let nodes = law.nodes();
            let case = Case::new(format!("{} {kind} {nodes:?}", E::NAME), law, &p);
            self.0.push(match nodes[..] {
                [a, b] => case.ignoring("point a", a).ignoring("point b", b),
                _ => case,
            });
        }
    }
}

/// A load in both frames, with each function of time.
fn loads<E: Entry<Law: Element>>() -> Vec<Case> {
    let mut list = Vec::new();
    for (of_time, size, own) in time_functions() {
        for frame in FRAMES {
            let word = GivenValue::Word(format!("{frame:?}").to_lowercase());
            let more = [("frame", word), ("size", GivenValue::Function(size.clone(), own.clone()))];
            for (law, p) in made_with::<E>(&more) {
                let nodes = law.nodes();
                let name = format!("{of_time} {} in {frame:?} on {nodes:?}", E::NAME);
                // a node without axes has no frame of its own, so its loads are all dead ones
                let bound = frame == LoadFrame::World || !nodes[0].has_axes();
                let case = Case::new(name, law, &p).bound_to_world(bound).ignoring("point", nodes[0]);
                list.push(Case { neighbours: nodes.len() > 1, ..case });
            }
        }
    }
    list
}

/// What the example of an entry makes, on all nodes that it takes.
fn made<E: Entry>() -> Vec<(E::Law, Vec<f64>)> {
    made_with::<E>(&[])
}

/// The same with other values of some keys.
fn made_with<E: Entry>(more: &[(&'static str, GivenValue<f64>)]) -> Vec<(E::Law, Vec<f64>)> {
    let (nodes, example) = E::EXAMPLE;
    let mut all: Vec<Vec<NodeKind>> = vec![nodes.to_vec()];
    if nodes.iter().all(|kind| kind.in_space().is_some()) {
        let as_many = |[a, b]: [NodeKind; 2]| [a, b].into_iter().chain([a; 8]).take(nodes.len()).collect();
        all = PAIRS.into_iter().chain(BODIES).chain(GUIDED).chain([[Slope, Slope], [Body, Slope]]).map(as_many).collect();
        all.sort_by_key(|kinds| format!("{kinds:?}"));
        all.dedup();
    }
    let one = |kinds: Vec<NodeKind>| {
        let q: Vec<Vec<f64>> = kinds.iter().enumerate().map(|(place, kind)| somewhere(place, *kind)).collect();
        let placed = kinds.iter().zip(&q).map(|(&kind, q)| ("node", Placed { kind, q }));
        let axes = kinds.iter().all(|kind| kind.has_axes());
        let values = example.iter().filter(|(key, _)| axes || !["point", "points", "origin"].contains(key));
        let turn = Quaternion::about(Vector3::new(0.36, 0.48, 0.8), 0.9);
        let values = values.filter(|(key, _)| more.iter().all(|own| own.0 != *key));
        let values = values.map(|(key, sample)| (*key, sample.placed(Vector3::new(0.2, -0.1, 0.4), turn)));
        let values = values.chain(more.iter().cloned()).collect();
        let mut given = Given::new("any", placed, values);
        let made = E::make(&mut given);
        given.mistakes().is_empty().then_some(made)
    };
    all.into_iter().filter_map(one).collect()
}

/// Coordinates of a node where it may stand.
fn somewhere(place: usize, kind: NodeKind) -> Vec<f64> {
    let (shift, turn) = (0.3 * place as f64, Quaternion::about(Vector3::new(0.6, 0.0, 0.8), 0.4 + 0.5 * place as f64));
    let position = [0.1 + shift, -0.2 + shift, 0.3 - shift];
    match kind {
        Point => position.to_vec(),
        Body => [&position[..], &turn.0].concat(),
        Natural => [&position[..], &turn.columns().map(|axis| axis.components()).concat()].concat(),
        Slope => [position, turn.rotate(Vector3::new(1.1, 0.0, 0.0)).components()].concat(),
        NodeKind::Coordinates(count) | NodeKind::States(count) => vec![0.3 + shift; count],
    }
}

const ANCHORS: [NodeKind; 4] = [Point, Body, Natural, Slope];
pub const PAIRS: [[NodeKind; 2]; 8] = [
    [Point, Point],
    [Point, Body],
    [Body, Point],
    [Body, Body],
    [Natural, Natural],
    [Natural, Slope],
    [Slope, Body],
    [Point, Natural],
];
/// Nodes of two bodies.
const BODIES: [[NodeKind; 2]; 4] = [[Body, Body], [Natural, Natural], [Body, Natural], [Natural, Body]];
/// A body and what it guides.
const GUIDED: [[NodeKind; 2]; 5] = [[Body, Point], [Body, Body], [Natural, Slope], [Natural, Natural], [Natural, Body]];
pub const FRAMES: [LoadFrame; 2] = [LoadFrame::World, LoadFrame::Body];

#[rustfmt::skip]
pub fn cases() -> Vec<Case> {
    let mut list = vec![
        Case::new("point mass", PointMass, &[1.7]),
        Case::new("rigid body", RigidBody, &[1.7, 0.2, -0.3, 0.4, 1.1, 1.3, 0.9, 0.1, -0.2, 0.15]),
        Case::new("natural body", NaturalBody, &[1.7, 0.2, -0.3, 0.4, 1.1, 1.3, 0.9, 0.1, -0.2, 0.15]),
        Case::cable("inertia of a cable", CableInertia, &[0.8, 1.3]),
        Case::cable("weight of a cable", CableGravity, &[0.8, 1.3, 0.4, -0.9, -9.8]).bound_to_world(true),
        Case::cable("cable", Cable { damped: false }, &[0.8, 5.0, 2.0, 1.3, 0.0, 0.0, 0.0]),
        Case::cable("cable with weight", Cable { damped: false }, &[0.8, 5.0, 2.0, 1.3, 0.4, -0.9, -9.8]).bound_to_world(true),
        Case::cable("cable, internal damper", Cable { damped: true }, &[0.8, 5.0, 2.0, 1.3, 0.0, 0.0, 0.0, 0.3]),
        Case::cable("cable for small strains", Flexible(SmallStrainCableField), &[0.8, 5.0, 2.0]),
    ];
    list.extend(users_own());
    let (u, w, axis) = ([0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]);
    let angle = [axis, u, w].concat();
    let mut entries = Entries(Vec::new());
    joints::visit_all(&mut entries);
    forces::visit_all(&mut entries);
    list.extend(entries.0);
    for [a, b] in BODIES {
    list.extend([
        Case::soft("angle coordinate", AngleCoordinate([a, b]), &angle),
    ]);
    }
    for (coupled, damped, eccentric) in [(false, false, false), (true, false, true), (false, true, false), (true, true, true)] {
        let name = format!("beam{}{}{}", if coupled { ", coupled" } else { "" }, if damped { ", internal damper" } else { "" },
            if eccentric { ", eccentric" } else { "" });
        let field = BeamField { coupled, damped, eccentric };
        let mut case = Case::flexible(name, field);
        for (parameter, value) in field.parameters().iter().zip(&mut case.p) {
            // small off the diagonal: a stiffness is positive definite, and only then is its damping a loss
            let (stiffness, digits) = (parameter.name.contains("stiffness"), parameter.name.as_bytes());
            if stiffness && digits[digits.len() - 1] != digits[digits.len() - 2] {
                *value *= 0.1;
            }
        }
        if !eccentric {
            case.ignored.extend(["Gauss point 1: first", "Gauss point 2: first", "Gauss point 3: first"]);
        }
        list.push(case);
    }
    list.extend(shells(Quad9, |node| [(node % 3) as f64 - 1.0, (node / 3) as f64 - 1.0]));
    list.extend(shells(Quad4, |node| [(node % 2) as f64 * 2.0 - 1.0, (node / 2) as f64 * 2.0 - 1.0]));
    list.extend(shells(Triangle6, |node| {
        [[-0.8, -0.7], [1.1, -0.5], [-0.4, 1.0], [0.1, -0.6], [0.4, 0.3], [-0.6, 0.2]][node]
    }));
    for eccentric in [false, true] {
        let mut case = Case::flexible(format!("weight of a beam, eccentric: {eccentric}"), BeamGravityField { eccentric }).bound_to_world(true);
        if !eccentric {
            case.ignored.extend(["Gauss point 1: first", "Gauss point 2: first", "Gauss point 3: first"]);
        }
        list.push(case);
    }
    for (of_time, size, own) in time_functions() {
        for frame in FRAMES {
            list.push(pressure(Quad9, frame, &size, (of_time, &own)));
            list.push(pressure(Quad4, frame, &size, (of_time, &own)));
            list.push(pressure(Triangle6, frame, &size, (of_time, &own)));
        }
    }
    for on in ANCHORS {
        list.push(Case::new(format!("gravity on {on:?}"), Gravity { on }, &[1.7, 0.4, -0.9, -9.8, 0.2, -0.3, 0.4])
            .bound_to_world(true).ignoring("centre", on));
    }
    list
}

/// Shells of one face, whose nodes stand about some places (r, s).
fn shells<F: Face>(face: F, place: fn(usize) -> [f64; 2]) -> Vec<Case> {
    let sections = [
        (ShellSection::Isotropic, true, false),
        (ShellSection::Laminate, false, false),
        (ShellSection::Isotropic, false, true),
        (ShellSection::Laminate, true, true),
    ];
    let case = |(section, heavy, damped)| {
        let field = ShellField { face, section, damped };
        // stiffnesses of plies are any numbers here, and only where they are positive definite is damping a loss
        let kind = match (damped, section) {
            (true, ShellSection::Isotropic) => ", internal damper",
            (true, ShellSection::Laminate) => ", damped",
            _ => "",
        };
        let name = format!("shell, {}, {section:?}{kind}", F::SHAPE.name);
        let mut case = Case::flexible(name, field).bound_to_world(heavy);
        for (node, p) in case.p[..F::SHAPE.section()].chunks_exact_mut(NODE_PARAMETERS).enumerate() {
            // a curved and distorted surface, and directors beside its normal
            let [r, s] = place(node);
            let start = [r + 0.3 * s, 0.8 * s, 0.2 * r * s - 0.1 * r * r, 0.2 * r, 0.1 - 0.2 * s, 0.8];
            p.iter_mut().zip(start).for_each(|(p, start)| *p = start + 0.1 * *p);
        }
        if section == ShellSection::Isotropic {
            // far from the ratio at which plane stress has no stiffness
            case.p[F::SHAPE.poisson()] = 0.3;
        }
        let gravity = field.drilling() + 1;
        if !heavy {
            case.p[gravity..gravity + 3].fill(0.0);
        }
        case
    };
    sections.into_iter().map(case).collect()
}

/// A pressure on a shell of one face.
fn pressure<F: Face>(face: F, frame: LoadFrame, size: &TimeFunction, (of_time, own): (&str, &[f64])) -> Case {
    let name = format!("{of_time} pressure in {frame:?} on a {}", F::SHAPE.name);
    let mut case = Case::flexible(name, ShellPressureField { face, frame, size: size.clone() })
        .bound_to_world(frame == LoadFrame::World);
    let areas = case.p.len() - own.len();
    case.p[areas..].copy_from_slice(own);
    case
}
