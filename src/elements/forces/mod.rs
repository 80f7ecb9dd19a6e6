//! Springs, dampers and loads.

mod applied_force;
mod applied_torque;
mod bushing;
mod coordinate_spring_damper;
mod gravity;
mod line_damper;
mod line_spring;
mod slide_spring_damper;
mod soft;
mod spring_law;
mod torsion_spring_damper;
mod vector_damper;

pub use applied_force::AppliedForce;
pub use applied_torque::AppliedTorque;
pub use bushing::Bushing;
pub use coordinate_spring_damper::CoordinateSpringDamper;
pub use gravity::Gravity;
pub use line_damper::LineDamper;
pub use line_spring::LineSpring;
pub use slide_spring_damper::SlideSpringDamper;
pub use soft::Soft;
pub use spring_law::{AngleLaw, LineLaw, SlideLaw, SpringLaw, Stretch, TorsionLaw};
pub use torsion_spring_damper::TorsionSpringDamper;
pub use vector_damper::VectorDamper;

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
