//! Springs, dampers and loads.

mod applied_force;
mod applied_torque;
mod bushing;
mod coordinate_spring_damper;
mod gravity;
mod line_damper;
mod line_spring;
pub(crate) mod load_frame;
mod slide_spring_damper;
mod soft;
mod soft_contact;
mod spring_law;
mod torsion_spring_damper;
mod vector_damper;

/// Springs, dampers and loads as types.
pub(crate) mod types {
    pub use super::{
        applied_force::AppliedForce, applied_torque::AppliedTorque, bushing::Bushing,
        coordinate_spring_damper::CoordinateSpringDamper, gravity::Gravity, line_damper::LineDamper,
        line_spring::LineSpring, slide_spring_damper::SlideSpringDamper, soft::Soft, soft_contact::SoftContact,
        spring_law::AngleLaw, spring_law::LineLaw, spring_law::SlideLaw, spring_law::TorsionLaw,
        torsion_spring_damper::TorsionSpringDamper, vector_damper::VectorDamper,
    };
}

pub use load_frame::LoadFrame;
pub use soft_contact::Touching;
pub use spring_law::{AngleLaw, LineLaw, SlideLaw, TorsionLaw};
pub(crate) use types::*;

use super::AnyElement;
use super::dyn_layer::instantiate_here;
use super::entries::{SpringPart, SpringVisitor, entries};
use super::flexible::{DistributedLoad, PressureOnFace};

instantiate_here!(dyn AnyElement: AppliedForce, AppliedTorque, Gravity);

entries! {
    SpringPart, SpringVisitor;
    /// Springs by the names that scene files and programs use, each described in its own file.
    SPRINGS:
    LineSpring, TorsionSpringDamper, SlideSpringDamper, CoordinateSpringDamper, Bushing, LineLaw, TorsionLaw, SlideLaw, AngleLaw;
    /// Dampers, likewise.
    DAMPERS:
    LineDamper, VectorDamper;
    /// Loads on nodes and on elements of members: each is a section of scene files.
    LOADS:
    AppliedForce, AppliedTorque, DistributedLoad | PressureOnFace;
}
