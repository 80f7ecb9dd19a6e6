//! Springs, dampers and loads.

pub(crate) mod applied_force;
pub(crate) mod applied_torque;
pub(crate) mod bushing;
mod coordinate_spring_damper;
pub(crate) mod gravity;
pub(crate) mod line_damper;
mod line_spring;
mod slide_spring_damper;
pub(crate) mod soft;
mod spring_law;
pub(crate) mod torsion_spring_damper;
pub(crate) mod vector_damper;

pub(crate) use applied_force::AppliedForce;
pub(crate) use applied_torque::AppliedTorque;
pub(crate) use bushing::Bushing;
pub(crate) use coordinate_spring_damper::CoordinateSpringDamper;
pub(crate) use gravity::Gravity;
pub(crate) use line_damper::LineDamper;
pub(crate) use line_spring::LineSpring;
pub(crate) use slide_spring_damper::SlideSpringDamper;
pub(crate) use soft::Soft;
pub(crate) use spring_law::{AngleLaw, LineLaw, SlideLaw, TorsionLaw};
pub(crate) use torsion_spring_damper::TorsionSpringDamper;
pub(crate) use vector_damper::VectorDamper;

use super::AnyElement;
use super::dyn_layer::instantiate_here;
use super::entries::{SpringPart, SpringVisitor, entries};

instantiate_here!(dyn AnyElement: AppliedForce, AppliedTorque, Gravity);

entries! {
    SpringPart, SpringVisitor;
    /// Springs by the names that scene files and programs use, each described in its own file.
    SPRINGS:
    LineSpring, TorsionSpringDamper, SlideSpringDamper, CoordinateSpringDamper, Bushing, LineLaw, TorsionLaw, SlideLaw, AngleLaw;
    /// Dampers, likewise.
    DAMPERS:
    LineDamper, VectorDamper;
}

/// The frame in which a load keeps its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadFrame {
    /// Dead load: constant direction in the world.
    World,
    /// Follower load: turns with the body.
    Body,
}
