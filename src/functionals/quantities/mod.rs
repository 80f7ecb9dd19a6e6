//! Quantities of points, joints, sections of beams and cables, and shells.

mod acceleration;
mod beam_section_force;
mod beam_von_mises;
mod cable_deflection;
mod cable_largest_stress;
mod cable_section;
mod cable_von_mises;
mod coordinate;
mod distance;
mod joint_angle;
mod joint_displacement;
mod joint_rate;
mod position;
mod reaction;
mod reaction_norm;
mod section;
mod target_distance;
mod tsai_wu;
mod velocity;
mod von_mises;

/// Quantities as types.
pub(crate) mod types {
    pub use super::{
        acceleration::Acceleration, beam_section_force::BeamSectionForce, beam_von_mises::BeamVonMises,
        cable_deflection::CableDeflection, cable_largest_stress::CableLargestStress, cable_section::CableQuantity,
        cable_von_mises::CableVonMises, coordinate::Coordinate, distance::Distance, joint_angle::JointAngle,
        joint_displacement::JointDisplacement, joint_displacement::JointSpeed, joint_rate::JointRate, position::Position,
        reaction::Reaction, reaction_norm::ReactionNorm, section::SectionQuantity, target_distance::TargetDistance,
        tsai_wu::TsaiWu, velocity::Velocity, von_mises::VonMises,
    };
}

pub use cable_section::CableMeasure;
pub use section::SectionMeasure;
pub(crate) use types::*;

use super::{AnyPointQuantity, AnyQuantity, ElementSum, OfBeams, OfShells, QuantityPart, QuantityVisitor};
use crate::elements::entries::entries;
use crate::elements::{Parameter, instantiate_here};

entries! {
    QuantityPart, QuantityVisitor;
    /// What is measured at nodes, by the names that scene files and programs use, each described in its own file.
    QUANTITIES:
    Position, Velocity, Acceleration, TargetDistance, Distance, Coordinate, JointAngle, JointRate, JointDisplacement, JointSpeed, CableDeflection;
}

instantiate_here!(dyn AnyQuantity: CableLargestStress, CableQuantity, Reaction, ReactionNorm, SectionQuantity);
instantiate_here!(dyn AnyPointQuantity: ElementSum, OfShells<TsaiWu>, OfShells<VonMises>);
instantiate_here!(dyn AnyPointQuantity: CableVonMises, OfBeams<BeamSectionForce>, OfBeams<BeamVonMises>);

/// A point of a body and a direction in the world: the parameters of projected point quantities.
fn point_and_direction() -> Vec<Parameter> {
    [Parameter::vectors(&["point"], "m"), Parameter::vectors(&["direction"], "-")].concat()
}
