//! Which functionals the parameters of a subject can move.

use super::measures::Reach;
use super::scenes::{Case, Subject};
use costate::elements::{NodeKind, TimeFunction};

impl Case {
    /// What each design variable can reach.
    pub fn reaches(&self) -> Vec<Reach> {
        use Reach::*;
        let own = |count: usize, reach: Reach| vec![reach; count];
        let load = |function: &TimeFunction| match function {
            TimeFunction::Sine => vec![Force, Force, Later, Force],
            TimeFunction::Step { .. } | TimeFunction::ConstantRate => vec![Force, Later],
            TimeFunction::Table(_) => vec![Piece; self.function.len()],
            _ => vec![Force; self.function.len()],
        };
        let drive = |function: &TimeFunction| match function {
            TimeFunction::Sine => vec![Geometry, Geometry, Rate, Geometry],
            TimeFunction::ConstantRate => vec![Geometry, Rate],
            TimeFunction::SmoothRamp if !self.one_sided.is_empty() => vec![Geometry, Later, LaterAndSteps, LaterAndSteps],
            // at rest at the start, and without acceleration
            TimeFunction::SmoothStart(inner) => match **inner {
                TimeFunction::Sine => vec![Geometry, Geometry, Later, Geometry, LaterAndSteps],
                _ => vec![Geometry, Later, LaterAndSteps],
            },
            _ => vec![Geometry; self.function.len()],
        };
        let with_point = |points: &NodeKind, before: usize, after: usize| match points {
            NodeKind::Body | NodeKind::Natural => own(before + 3 + after, Geometry),
            _ => [own(before, Geometry), own(3, Nothing), own(after, Geometry)].concat(),
        };
        let inertia = if self.projected { ProjectedInertia } else { Inertia };
        let of_subject = match self.kind() {
            Subject::RigidBody | Subject::NaturalBody => {
                [vec![if self.projected { ProjectedMass } else { Mass }], own(9, inertia)].concat()
            }
            Subject::PointMass => vec![Mass],
            Subject::GravityOnBody => own(7, Stored),
            Subject::GravityOnPoint => [own(4, Stored), own(3, Nothing)].concat(),
            Subject::Spring("line") => own(8, Stored),
            Subject::Damper("line") => own(7, Force),
            Subject::Damper("vector") => [own(4, Force), own(3, Nothing)].concat(),
            Subject::Spring("torsion") => [vec![Stored, Force], own(10, Stored)].concat(),
            Subject::Spring("slide") => [vec![Stored, Force], own(10, Stored)].concat(),
            Subject::Spring("angle") => vec![Stored, Force, Stored],
            Subject::Spring("bushing") => [own(6, Stored), own(6, Force), own(14, Stored)].concat(),
            // two tables of four values with four slopes each
            Subject::Spring("line_law") => [own(7, Stored), own(16, Piece)].concat(),
            Subject::Spring("torsion_law") => [own(9, Stored), own(16, Piece)].concat(),
            Subject::Spring(name) | Subject::Damper(name) => unreachable!("no reaches are known of {name}"),
            Subject::Soft(_) => unreachable!("its kind is that of a joint"),
            Subject::Force(NodeKind::Body | NodeKind::Natural, _, f) => [own(6, Force), load(f)].concat(),
            Subject::Force(_, _, f) => [own(3, Force), own(3, Nothing), load(f)].concat(),
            Subject::Torque(_, f) => [own(3, Force), load(f)].concat(),
            Subject::Spherical(of) => with_point(of, 3, 0),
            Subject::TiedNode => own(9, Geometry),
            Subject::PointOnLine(of) => with_point(of, 3, 6),
            Subject::PointInPlane(of) => with_point(of, 3, 3),
            Subject::RigidLink(of) => own(if *of == NodeKind::Body { 7 } else { 3 }, Geometry),
            Subject::Revolute | Subject::Cylindrical | Subject::Planar => own(15, Geometry),
            Subject::Prismatic => own(16, Geometry),
            Subject::Universal => own(12, Geometry),
            Subject::Helical | Subject::RackAndPinion => own(19, Geometry),
            Subject::JointAngle => own(9, Geometry),
            Subject::Gear => own(3, Geometry),
            Subject::DiscOnPlane => own(13, Geometry),
            // they restrict velocities alone
            Subject::RollingDisc => own(16, Rate),
            Subject::RollingSphere => own(13, Rate),
            Subject::Fixed => own(10, Geometry),
            Subject::Distance => own(7, Geometry),
            Subject::Beam(subject) => subject.reaches(self.statics),
            Subject::Cable(subject) => subject.reaches(),
            Subject::Shell(subject) => subject.reaches(),
            Subject::Rotation(f) => [own(9, Geometry), drive(f)].concat(),
            Subject::Translation(f) => [own(9, Geometry), drive(f)].concat(),
        };
        let of_subject = match &self.subject {
            Subject::Soft(joint) => {
                let elastic = if self.has_energies() { Stored } else { Force };
                let softened = |(place, reach): (usize, Reach)| match reach {
                    // gears have not turned at the start: what multiplies the angle stores nothing there
                    Geometry if matches!(**joint, Subject::Gear) && place < 2 => Force,
                    Geometry => elastic,
                    Rate => Force,
                    other => other,
                };
                let geometry: Vec<Reach> = of_subject.into_iter().enumerate().map(softened).collect();
                let equations = (self.nominal().0.len() - geometry.len()) / 2;
                [own(equations, elastic), own(equations, Force), geometry].concat()
            }
            _ => of_subject,
        };
        let varied = of_subject.into_iter().enumerate().filter(|(place, _)| self.varies(*place));
        let of_subject = varied.map(|(_, reach)| reach).collect();
        let spin = if self.statics { Nothing } else { StartVelocity };
        // the turn stretches a beam or a cable, and with it its mass
        let turn = if matches!(self.subject, Subject::Beam(_) | Subject::Cable(_)) { ProjectedMass } else { StartPosition };
        [of_subject, vec![turn, spin, Sensor]].concat()
    }
}
