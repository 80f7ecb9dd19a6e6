//! The list of elements with sample parameters.

use super::Contract;
use super::support::time_functions::time_functions;
use super::users::users_own;
use costate::elements::bodies::{NaturalBody, PointMass, RigidBody};
use costate::elements::flexible::faces::{Face, NODE_PARAMETERS, Quad4, Quad9, Triangle6};
use costate::elements::flexible::{
    BeamField, BeamGravityField, Cable, CableGravity, CableInertia, DistributedLoadField, ShellField, ShellPressureField,
    ShellSection, SmallStrainCableField,
};
use costate::elements::forces::{
    AppliedForce, AppliedTorque, Bushing, CoordinateSpringDamper, Gravity, LineDamper, LineSpring, LoadFrame,
    SlideSpringDamper, Soft, TorsionSpringDamper, VectorDamper,
};
use costate::elements::joints::{
    AngleCoordinate, CylindricalJoint, DistanceJoint, FixedJoint, GearJoint, HelicalJoint, PlanarJoint, PointInPlane,
    PointOnLine, PrescribedRotation, PrescribedTranslation, PrismaticJoint, RackAndPinion, RevoluteJoint, RigidLink,
    SphericalJoint, UniversalJoint,
};
use costate::elements::{Constraint, Element, ElementPhysics, Field, Flexible, NodeKind, TimeFunction};
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
        Case::new(format!("soft {name} {kind}"), Soft(joint), &[&coefficients[..], p].concat())
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
        if !node.has_axes() {
            self.ignored.push(name);
        }
        self
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
    let ends = [0.3, -0.2, 0.5, -0.4, 0.1, 0.6];
    let torsion = [3.1, 0.7, 0.2, 0.6, 0.0, 0.8, 0.8, 0.0, -0.6, 0.0, 1.0, 0.0];
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
    let (u, w, axis, turned) = ([0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8], [0.8, 0.36, 0.48, 0.0]);
    let guide = [&ends[..], &u, &w, &axis].concat();
    let angle = [axis, u, w].concat();
    let six = [3.0, 5.0, 7.0, 2.0, 4.0, 6.0];
    list.push(Case::new("coordinate spring damper", CoordinateSpringDamper { of: NodeKind::Coordinates(3), index: 1 }, &[3.1, 0.7, 0.2]));
    list.push(Case::soft("gear", GearJoint, &[0.5, -0.2, 0.3]));
    for [a, b] in BODIES {
    list.extend([
        Case::new("torsion spring damper", TorsionSpringDamper { a, b }, &torsion),
        Case::new("bushing spring damper", Bushing { a, b }, &[&six[..], &six, &ends, &turned, &[0.6, 0.0, 0.0, 0.8]].concat()),
        Case::soft("fixed", FixedJoint { a, b }, &[&ends[..], &turned].concat()),
        Case::soft("revolute", RevoluteJoint { a, b }, &guide),
        Case::soft("cylindrical", CylindricalJoint { a, b }, &guide),
        Case::soft("planar", PlanarJoint { a, b }, &guide),
        Case::soft("prismatic", PrismaticJoint { a, b }, &[&guide[..12], &turned].concat()),
        Case::soft("universal", UniversalJoint { a, b }, &guide[..12]),
        Case::soft("helical", HelicalJoint { a, b }, &[&guide[..], &u, &[2.5]].concat()),
        Case::soft("rack and pinion", RackAndPinion { nodes: [a, b, a] }, &[&ends[..], &angle, &w, &[0.4]].concat()),
        Case::soft("angle coordinate", AngleCoordinate { a, b }, &angle),
        // with 0.2 rad a sample is so near half a turn that differences reach over its jump
        Case::soft("rotation", PrescribedRotation { a, b, angle: TimeFunction::Sine }, &[&angle[..], &[0.3, 1.4, 2.3, 0.6]].concat()),
    ]);
    }
    for [a, b] in GUIDED {
        let slide = [&[3.1, 0.7, 0.2], &ends[..], &axis].concat();
        let link = if b.has_axes() { &[0.3, -0.2, 0.5, 0.8, 0.36, 0.48, 0.0][..] } else { &ends[..3] };
        list.extend([
            Case::new(format!("slide spring damper of {b:?} on {a:?}"), SlideSpringDamper { a, b }, &slide),
            Case::soft("point on line", PointOnLine { a, b }, &guide[..12]),
            Case::soft("point in plane", PointInPlane { a, b }, &guide[..9]),
            Case::soft("rigid link", RigidLink { a, b }, link),
            Case::soft("translation", PrescribedTranslation { a, b, displacement: TimeFunction::Sine },
                &[&ends[..], &axis, &[0.2, 1.4, 2.3, 0.6]].concat()),
        ].map(|case| case.ignoring("point b", b)));
    }
    for [a, b] in PAIRS {
        list.push(Case::soft("spherical", SphericalJoint { a, b }, &ends).ignoring("point a", a).ignoring("point b", b));
        list.push(Case::soft("distance", DistanceJoint { a, b }, &[&ends[..], &[0.9]].concat())
            .ignoring("point a", a).ignoring("point b", b));
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
            let mut case = Case::flexible(format!("{of_time} load in {frame:?} along a beam"), DistributedLoadField { frame, size: size.clone() })
                .bound_to_world(frame == LoadFrame::World);
            let each = case.p.len() / 3;
            case.p.chunks_exact_mut(each).for_each(|p| p[4..].copy_from_slice(&own));
            list.push(case);
            list.push(pressure(Quad9, frame, &size, (of_time, &own)));
            list.push(pressure(Quad4, frame, &size, (of_time, &own)));
            list.push(pressure(Triangle6, frame, &size, (of_time, &own)));
        }
    }
    for on in ANCHORS {
        list.push(Case::new(format!("gravity on {on:?}"), Gravity { on }, &[1.7, 0.4, -0.9, -9.8, 0.2, -0.3, 0.4])
            .bound_to_world(true).ignoring("centre", on));
    }
    for [a, b] in PAIRS {
        let mut add = |name: &str, case: fn(String, [NodeKind; 2], &[f64]) -> Case, own: &[f64]| {
            list.push(case(format!("{name} {a:?} to {b:?}"), [a, b], &[own, &ends].concat()).ignoring("point a", a).ignoring("point b", b));
        };
        add("line spring", |name, [a, b], p| Case::new(name, LineSpring { a, b }, p), &[5.0, 0.7]);
        add("line damper", |name, [a, b], p| Case::new(name, LineDamper { a, b }, p), &[2.3]);
        add("vector damper", |name, [a, b], p| Case::new(name, VectorDamper { a, b }, p), &[2.3]);
    }
    for (of_time, size, own) in time_functions() {
        for frame in FRAMES {
            for on in [Body, Natural] {
                let torque = AppliedTorque { on, frame, size: size.clone() };
                list.push(Case::new(format!("{of_time} torque in {frame:?} on {on:?}"), torque, &[&[0.3, -0.5, 0.7], &own[..]].concat())
                    .bound_to_world(frame == LoadFrame::World));
            }
            for on in ANCHORS {
                let force = AppliedForce { on, frame, size: size.clone() };
                let p = [&[0.3, -0.5, 0.7, 0.2, 0.4, -0.1], &own[..]].concat();
                // a node without axes has no frame of its own, so its loads are all dead ones
                list.push(Case::new(format!("{of_time} force in {frame:?} on {on:?}"), force, &p)
                    .bound_to_world(frame == LoadFrame::World || !on.has_axes()).ignoring("point", on));
            }
        }
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
