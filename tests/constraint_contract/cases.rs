//! The list of constraints and the configurations in which they are zero.

use super::support::motion::body_coordinates;
use super::support::time_functions::time_functions;
use costate::elements::joints::HeldSlope;
use costate::elements::{Constraint, NodeKind, Nonholonomic, NonholonomicConstraint, TimeFunction};
use costate::internals::{
    AngleCoordinate, CableCorner, CableEnd, ConstraintPhysics, CylindricalJoint, DistanceJoint, EulerParameterNorm,
    FixedJoint, GearJoint, HelicalJoint, OrthonormalAxes, PlanarJoint, PointInPlane, PointOnLine, PrescribedRotation,
    PrescribedTranslation, PrismaticJoint, RackAndPinion, RevoluteJoint, RigidLink, RollingDisc, RollingSphere,
    SphericalJoint, TiedNode, UniversalJoint,
};
use costate::scalar::{Quaternion, SpatialVector, Vector3};
use costate::testing::{self, Sample, check_constraint, check_nonholonomic};
use std::f64::consts::TAU;
use std::sync::Arc;

use NodeKind::{Body, Natural, Point, Slope};

/// Where the last body b stands relative to the first a: its turn, and the vector from the point of a to the point of b, both seen
/// from a.
#[derive(Clone, Copy)]
pub struct Placement {
    pub turn: Quaternion<f64>,
    pub offset: Vector3<f64>,
    /// Turn of a body between the two, seen from a, where there is one.
    pub pinion: Quaternion<f64>,
    /// Coordinates behind those of the bodies, as many as there are.
    pub scalars: [f64; 2],
}

impl Default for Placement {
    fn default() -> Self {
        let together = Quaternion::identity();
        Placement { turn: together, offset: Vector3::zeros(), pinion: together, scalars: [0.0; 2] }
    }
}

impl Placement {
    /// Turned on by `angle` [rad] about `axis` of a; the points stay where they are.
    pub fn turned(self, axis: Vector3<f64>, angle: f64) -> Placement {
        Placement { turn: Quaternion::about(axis, angle).times(self.turn), ..self }
    }
    /// Shifted by `by` [m] in the frame of a.
    pub fn shifted(self, by: Vector3<f64>) -> Placement {
        Placement { offset: self.offset + by, ..self }
    }
    /// With the first of the scalars moved.
    fn counted(self, by: f64) -> Placement {
        Placement { scalars: [self.scalars[0] + by, self.scalars[1]], ..self }
    }
}

/// A placement next to the consistent one, and the rows that must then be as large as the step away.
pub struct Move {
    pub what: &'static str,
    pub to: Placement,
    pub violated: Vec<usize>,
}

/// A constraint in other numbers than its recording.
pub trait Contract {
    /// Everything that is derived from the recording.
    fn check(&self, samples: &[Sample]) -> Result<(), String>;
}

impl<C: Constraint> Contract for Arc<C> {
    fn check(&self, samples: &[Sample]) -> Result<(), String> {
        check_constraint(self, samples)
    }
}

/// Checks a constraint at samples, or says what fails.
pub type ConstraintCheck = dyn Fn(&[Sample]) -> Result<(), String>;

/// A constraint on velocities with the number of its coordinates and sample parameters.
pub struct Rolling {
    pub name: String,
    pub constraint: Box<ConstraintCheck>,
    pub nodes: [NodeKind; 2],
    pub p: Vec<f64>,
}

fn rolling<C: NonholonomicConstraint>(name: &str, nodes: [NodeKind; 2], constraint: C) -> Rolling {
    let p = (0..constraint.parameters().len()).map(|i| 0.6 + 0.5 * (1.7 * i as f64 + 0.3).sin()).collect();
    let constraint = Arc::new(Nonholonomic(constraint));
    let check = move |samples: &[Sample]| check_nonholonomic(&constraint, samples);
    Rolling { name: format!("{name} {nodes:?}"), constraint: Box::new(check), nodes, p }
}

/// Constraints on velocities.
pub fn rollings() -> Vec<Rolling> {
    let pairs = BODIES.into_iter();
    pairs
        .flat_map(|nodes| {
            let [a, b] = nodes;
            [rolling("sphere", nodes, RollingSphere([a, b])), rolling("disc", nodes, RollingDisc([a, b]))]
        })
        .collect()
}

pub struct Case {
    pub name: String,
    pub constraint: ConstraintPhysics,
    pub contract: Box<dyn Contract>,
    pub nodes: Vec<NodeKind>,
    /// Nodes of one coordinate behind the others.
    pub scalars: usize,
    pub p: Vec<f64>,
    /// Consistent at time [`NOW`].
    pub placed: Placement,
    pub moves: Vec<Move>,
    /// Parameters that this topology takes and, as documented, does not read: the start of their names.
    pub ignored: Vec<&'static str>,
}

impl Case {
    pub fn new<C: Constraint>(name: impl Into<String>, constraint: C, p: &[f64], placed: Placement) -> Case {
        let (name, constraint) = (name.into(), Arc::new(constraint));
        let (nodes, others): (Vec<_>, Vec<_>) = constraint.nodes().into_iter().partition(|kind| kind.in_space().is_some());
        let scalars = others.iter().map(|kind| kind.dofs()).sum();
        let mut ignored = vec![];
        if let [a, b] = nodes[..] {
            ignored.extend((!a.has_axes()).then_some("point a"));
            ignored.extend((!b.has_axes()).then_some("point b"));
        }
        Case {
            name,
            constraint: testing::constraint_physics(&constraint),
            contract: Box::new(constraint),
            nodes,
            scalars,
            p: p.to_vec(),
            placed,
            moves: vec![],
            ignored,
        }
    }
    /// `to` violates the rows `violated` by [`STEP`] and no others.
    fn shows(mut self, what: &'static str, violated: &[usize], to: impl Fn(Placement) -> Placement) -> Case {
        self.moves.push(Move { what, to: to(self.placed), violated: violated.to_vec() });
        self
    }

    /// Coordinates of all nodes for a body a at `position` with the Euler parameters `turn`.
    pub fn coordinates(&self, position: Vector3<f64>, turn: Quaternion<f64>, placed: Placement) -> Vec<f64> {
        let mut q = Vec::new();
        if let Some(&a) = self.nodes.first() {
            q.extend(position.components());
            let mut point = position + placed.offset;
            let mut turn_b = placed.turn;
            let mut slope = AXIS;
            if a.has_axes() {
                q = body_coordinates(a, position, turn);
                point = position + turn.rotate(placed.offset + POINT_A);
                turn_b = turn.times(placed.turn);
                slope = turn_b.rotate(AXIS);
            } else if a == Slope {
                q.extend(slope.components());
                slope = turn_b.rotate(AXIS);
            }
            if let [_, pinion, _] = self.nodes[..] {
                q.extend(body_coordinates(pinion, position + turn.rotate(NORMAL_U), turn.times(placed.pinion)));
            }
            match self.nodes[1..].last() {
                Some(Point) => q.extend(point.components()),
                Some(Slope) => q.extend(point.components().into_iter().chain(slope.components())),
                Some(&body) => q.extend(body_coordinates(body, point - turn_b.rotate(POINT_B), turn_b)),
                None => {}
            }
        }
        q.extend(&placed.scalars[..self.scalars]);
        q
    }
}

pub const NOW: f64 = 0.3;
pub const STEP: f64 = 1e-3;
const POINT_A: Vector3<f64> = Vector3::new(0.3, -0.2, 0.5);
const POINT_B: Vector3<f64> = Vector3::new(-0.4, 0.1, 0.6);
/// A right-handed triad of a; the first is the axis of hinges and drives.
pub const AXIS: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);
pub const NORMAL_U: Vector3<f64> = Vector3::new(0.8, 0.0, -0.6);
pub const NORMAL_W: Vector3<f64> = Vector3::new(0.0, 1.0, 0.0);
const X: Vector3<f64> = Vector3::new(1.0, 0.0, 0.0);
const Y: Vector3<f64> = Vector3::new(0.0, 1.0, 0.0);
const Z: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);
const PAIRS: [[NodeKind; 2]; 10] = [
    [Point, Point],
    [Point, Body],
    [Body, Point],
    [Body, Body],
    [Natural, Natural],
    [Natural, Point],
    [Body, Natural],
    [Natural, Slope],
    [Slope, Body],
    [Slope, Slope],
];
/// Nodes of two bodies.
const BODIES: [[NodeKind; 2]; 4] = [[Body, Body], [Natural, Natural], [Body, Natural], [Natural, Body]];

/// A body and what it guides.
const GUIDED: [[NodeKind; 2]; 5] = [[Body, Point], [Body, Body], [Natural, Slope], [Natural, Natural], [Natural, Body]];

/// The name of a joint between two bodies.
fn between(name: &str, [a, b]: [NodeKind; 2]) -> String {
    if [a, b] == [Body, Body] { name.into() } else { format!("{name} {a:?} to {b:?}") }
}

/// Drives of motion: everything but jumps, which no motion can follow.
pub fn drives() -> Vec<(&'static str, TimeFunction, Vec<f64>)> {
    time_functions().into_iter().filter(|(name, ..)| !name.contains("step")).collect()
}

#[rustfmt::skip]
pub fn cases() -> Vec<Case> {
    let points = [POINT_A.components(), POINT_B.components()].concat();
    let skew = Quaternion::about(Vector3::new(0.36, 0.48, 0.8), 0.9);
    let together = Placement { turn: skew, ..Placement::default() };
    let hinged = Placement { turn: Quaternion::about(AXIS, 0.7), ..Placement::default() };
    let slid = hinged.shifted(AXIS * 1.3);
    let lying = hinged.shifted(NORMAL_U * 0.9 + NORMAL_W * -0.4);
    let (across, along) = ([NORMAL_U.components(), NORMAL_W.components()].concat(), [NORMAL_U.components(), NORMAL_W.components(), AXIS.components()].concat());
    let angle = [AXIS.components(), NORMAL_U.components(), NORMAL_U.components()].concat();
    let (pitch, radius) = (0.35, 0.21);
    let screwed = Placement { turn: Quaternion::about(AXIS, 1.3 * TAU / pitch), ..slid };
    let rolled = Placement { offset: NORMAL_W * (radius * 2.9), pinion: Quaternion::about(AXIS, 2.9), ..together };
    let mut list = vec![
        Case::new("Euler parameter norm", EulerParameterNorm, &[], together),
        Case::new("orthonormal axes", OrthonormalAxes, &[], together),
        Case::new("gear", GearJoint, &[0.5, -0.2, 0.31], Placement { scalars: [1.02, 1.0], ..together })
            .shows("roll", &[], |placed| Placement { scalars: [3.02, 6.0], ..placed })
            .shows("turn the first", &[0], |placed| placed.counted(2.0 * STEP)),
    ];
    for [a, b] in BODIES {
        list.extend([
        Case::new(between("fixed", [a, b]), FixedJoint([a, b]), &[&points[..], &skew.0].concat(), together)
            .shows("turn about x", &[3], |placed| placed.turned(X, STEP))
            .shows("turn about y", &[4], |placed| placed.turned(Y, STEP))
            .shows("turn about z", &[5], |placed| placed.turned(Z, STEP))
            .shows("shift along y", &[1], |placed| placed.shifted(Y * STEP))
            .shows("Euler parameters of the other sign", &[], |placed| Placement { turn: Quaternion(placed.turn.0.map(|e| -e)), ..placed }),
        Case::new(between("revolute", [a, b]), RevoluteJoint([a, b]), &[&points[..], &along].concat(), hinged)
            .shows("turn about the axis", &[], |placed| placed.turned(AXIS, 2.0))
            .shows("tilt about u", &[4], |placed| placed.turned(NORMAL_U, STEP))
            .shows("tilt about w", &[3], |placed| placed.turned(NORMAL_W, STEP))
            .shows("shift along x", &[0], |placed| placed.shifted(X * STEP)),
        Case::new(between("prismatic", [a, b]), PrismaticJoint([a, b]), &[&points[..], &across, &skew.0].concat(), together.shifted(AXIS * 1.3))
            .shows("shift along the axis", &[], |placed| placed.shifted(AXIS * 0.8))
            .shows("shift across", &[1], |placed| placed.shifted(NORMAL_W * STEP))
            .shows("turn about y", &[3], |placed| placed.turned(Y, STEP)),
        Case::new(between("cylindrical", [a, b]), CylindricalJoint([a, b]), &[&points[..], &along].concat(), slid)
            .shows("turn about and shift along the axis", &[], |placed| placed.turned(AXIS, 2.0).shifted(AXIS * 0.8))
            .shows("shift across", &[0], |placed| placed.shifted(NORMAL_U * STEP))
            .shows("tilt about u", &[3], |placed| placed.turned(NORMAL_U, STEP))
            .shows("tilt about w", &[2], |placed| placed.turned(NORMAL_W, STEP)),
        Case::new(between("planar", [a, b]), PlanarJoint([a, b]), &[&points[..], &along].concat(), lying)
            .shows("turn about the normal and slide", &[], |placed| placed.turned(AXIS, 2.0).shifted(NORMAL_U * 0.8))
            .shows("lift", &[0], |placed| placed.shifted(AXIS * STEP)),
        Case::new(between("planar where the points meet", [a, b]), PlanarJoint([a, b]), &[&points[..], &along].concat(), hinged)
            .shows("tilt about u", &[2], |placed| placed.turned(NORMAL_U, STEP))
            .shows("tilt about w", &[1], |placed| placed.turned(NORMAL_W, STEP)),
        Case::new(between("universal", [a, b]), UniversalJoint([a, b]), &[&points[..], &AXIS.components(), &NORMAL_U.components()].concat(), hinged)
            .shows("turn about the pin of a", &[], |placed| placed.turned(AXIS, 0.5))
            .shows("turn about the pin of b", &[], |placed| placed.turned(placed.turn.rotate(NORMAL_U), 0.5))
            .shows("turn about neither", &[3], |placed| placed.turned(AXIS.cross(&placed.turn.rotate(NORMAL_U)), STEP))
            .shows("shift along z", &[2], |placed| placed.shifted(Z * STEP)),
        Case::new(between("helical", [a, b]), HelicalJoint([a, b]), &[&points[..], &along, &NORMAL_U.components(), &[pitch]].concat(), screwed)
            .shows("six turns on", &[], |placed| placed.turned(AXIS, 6.0 * TAU).shifted(AXIS * (6.0 * 0.35)))
            .shows("shift along the axis", &[4], |placed| placed.shifted(AXIS * STEP))
            .shows("shift across", &[1], |placed| placed.shifted(NORMAL_W * STEP)),
        Case::new(between("rack and pinion", [a, b]), RackAndPinion { nodes: [a, b, b] }, &[&points[..], &angle, &NORMAL_W.components(), &[radius]].concat(), rolled)
            .shows("turn and lift the rack", &[], |placed| placed.turned(NORMAL_U, 0.4).shifted(AXIS * 0.3))
            .shows("shift the rack", &[0], |placed| placed.shifted(NORMAL_W * STEP)),
        Case::new(between("angle coordinate", [a, b]), AngleCoordinate([a, b]), &angle, hinged.counted(0.7))
            .shows("any shift", &[], |placed| placed.shifted(Vector3::new(0.4, -0.7, 1.9)))
            .shows("turn about the axis", &[0], |placed| placed.turned(AXIS, STEP))
            .shows("count on", &[0], |placed| placed.counted(STEP)),
        ]);
    }
    for [a, b] in GUIDED {
        let relative = if b.has_axes() { &skew.0[..] } else { &[] };
        let offset = POINT_A - if b.has_axes() { skew.rotate(POINT_B) } else { Vector3::zeros() };
        let rows = if b.has_axes() { vec![3] } else { vec![] };
        list.push(Case::new(format!("rigid link {a:?} to {b:?}"), RigidLink([a, b]), &[&offset.components(), relative].concat(), together)
            .shows("shift along y", &[1], |placed| placed.shifted(Y * STEP))
            .shows("turn about x with the node in place", &rows, |placed| {
                let turned = placed.turned(X, STEP);
                let point = if b.has_axes() { turned.turn.rotate(POINT_B) - placed.turn.rotate(POINT_B) } else { Vector3::zeros() };
                turned.shifted(point)
            }));
        if a == Body {
            list.push(Case::new(format!("tied {b:?}"), TiedNode { carriers: 1, b }, &[&[1.0], &offset.components()[..], relative].concat(), together)
                .shows("shift along y", &[1], |placed| placed.shifted(Y * STEP)));
        }
        list.push(Case::new(format!("{b:?} on line of {a:?}"), PointOnLine([a, b]), &[&points[..], &across].concat(), together.shifted(AXIS * 1.3))
            .shows("any turn and shift along the line", &[], |placed| placed.turned(NORMAL_W, 1.2).shifted(AXIS))
            .shows("shift along u", &[0], |placed| placed.shifted(NORMAL_U * STEP))
            .shows("shift along w", &[1], |placed| placed.shifted(NORMAL_W * STEP)));
        list.push(Case::new(format!("{b:?} in plane of {a:?}"), PointInPlane([a, b]), &[&points[..], &AXIS.components()].concat(), together.shifted(NORMAL_W))
            .shows("any turn and slide", &[], |placed| placed.turned(NORMAL_W, 1.2).shifted(NORMAL_U))
            .shows("lift", &[0], |placed| placed.shifted(AXIS * STEP)));
    }
    for [a, b] in PAIRS {
        list.push(Case::new(format!("spherical {a:?} to {b:?}"), SphericalJoint([a, b]), &points, together)
            .shows("any turn", &[], |placed| placed.turned(NORMAL_W, 1.2))
            .shows("shift along x", &[0], |placed| placed.shifted(X * STEP))
            .shows("shift along z", &[2], |placed| placed.shifted(Z * -STEP)));
        let length = 1.7;
        let apart = Placement { offset: AXIS * length, ..together };
        list.push(Case::new(format!("distance {a:?} to {b:?}"), DistanceJoint([a, b]), &[&points[..], &[length]].concat(), apart)
            .shows("any turn", &[], |placed| placed.turned(NORMAL_W, 1.2))
            .shows("another direction", &[], |placed| Placement { offset: Vector3::new(-1.7, 0.0, 0.0), ..placed })
            .shows("stretch", &[0], |placed| placed.shifted(AXIS * STEP)));
    }
    list.push(Case::new("cable corner", CableCorner, &[0.9], Placement::default().turned(NORMAL_W, 0.9))
        .shows("turn about one of the cables", &[], |placed| placed.turned(AXIS, 0.7))
        .shows("opened", &[3], |placed| placed.turned(NORMAL_W, STEP))
        .shows("shift along y", &[1], |placed| placed.shifted(Y * STEP)));
    for a in [Body, Natural] {
        let slope = AXIS.components();
        list.extend([
            Case::new(format!("cable clamped to {a:?}"), CableEnd { a, held: HeldSlope::Direction }, &[&POINT_A.components()[..], &across].concat(), Placement::default())
                .shows("turn about the cable", &[], |placed| placed.turned(AXIS, 0.7))
                .shows("tilt about u", &[4], |placed| placed.turned(NORMAL_U, STEP))
                .shows("tilt about w", &[3], |placed| placed.turned(NORMAL_W, STEP))
                .shows("shift along z", &[2], |placed| placed.shifted(Z * STEP)),
            Case::new(format!("cable welded to {a:?}"), CableEnd { a, held: HeldSlope::Vector }, &[&POINT_A.components()[..], &slope].concat(), Placement::default())
                .shows("turn about the cable", &[], |placed| placed.turned(AXIS, 0.7))
                .shows("shift along x", &[0], |placed| placed.shifted(X * STEP)),
            Case::new(format!("cable on a hinge of {a:?}"), CableEnd { a, held: HeldSlope::Plane }, &[POINT_A.components(), NORMAL_W.components()].concat(), Placement::default())
                .shows("turn about the hinge", &[], |placed| placed.turned(NORMAL_W, 0.7))
                .shows("tilt", &[3], |placed| placed.turned(NORMAL_U, STEP))
                .shows("shift along y", &[1], |placed| placed.shifted(Y * STEP)),
        ]);
    }
    for (of_time, function, own) in drives() {
        let now = function.value(NOW, &own);
        let driven = Placement { turn: Quaternion::about(AXIS, now), ..Placement::default() };
        let p = [&angle[..], &own].concat();
        for [a, b] in BODIES {
        list.push(Case::new(between(&format!("{of_time} rotation"), [a, b]), PrescribedRotation { nodes: [a, b], angle: function.clone() }, &p, driven)
            .shows("any shift", &[], |placed| placed.shifted(Vector3::new(0.4, -0.7, 1.9)))
            .shows("turn about the axis", &[0], |placed| placed.turned(AXIS, STEP))
            .shows("turn back about the axis", &[0], |placed| placed.turned(AXIS, -STEP)));
        }
        for [a, b] in GUIDED {
            let slid = Placement { offset: AXIS * now + NORMAL_W * 0.4, ..together };
            let drive = PrescribedTranslation { nodes: [a, b], displacement: function.clone() };
            list.push(Case::new(format!("{of_time} translation of {b:?} by {a:?}"), drive, &[&points[..], &AXIS.components(), &own].concat(), slid)
                .shows("any turn", &[], |placed| placed.turned(NORMAL_W, 1.2))
                .shows("shift across the axis", &[], |placed| placed.shifted(NORMAL_U * 0.8))
                .shows("shift along the axis", &[0], |placed| placed.shifted(AXIS * STEP)));
        }
    }
    list
}
