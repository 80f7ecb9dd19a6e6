//! Quantities of points, joints, sections of beams and cables, and shells.

mod beam_section_force;
mod beam_von_mises;
mod cable_deflection;
pub(crate) mod cable_largest_stress;
mod cable_section;
mod cable_von_mises;
pub(crate) mod coordinate;
pub(crate) mod distance;
pub(crate) mod joint_angle;
pub(crate) mod joint_displacement;
pub(crate) mod joint_rate;
pub(crate) mod position;
pub(crate) mod reaction;
pub(crate) mod reaction_norm;
mod section;
pub(crate) mod target_distance;
mod tsai_wu;
pub(crate) mod velocity;
mod von_mises;

pub(crate) use beam_section_force::BeamSectionForce;
pub(crate) use beam_von_mises::BeamVonMises;
pub(crate) use cable_deflection::CableDeflection;
pub(crate) use cable_largest_stress::CableLargestStress;
pub use cable_section::CableMeasure;
pub(crate) use cable_section::CableQuantity;
pub(crate) use cable_von_mises::CableVonMises;
pub(crate) use coordinate::Coordinate;
pub(crate) use distance::Distance;
pub(crate) use joint_angle::JointAngle;
pub(crate) use joint_displacement::{JointDisplacement, JointSpeed};
pub(crate) use joint_rate::JointRate;
pub(crate) use position::Position;
pub(crate) use reaction::Reaction;
pub(crate) use reaction_norm::ReactionNorm;
pub use section::SectionMeasure;
pub(crate) use section::SectionQuantity;
pub(crate) use target_distance::TargetDistance;
pub(crate) use tsai_wu::TsaiWu;
pub(crate) use velocity::Velocity;
pub(crate) use von_mises::VonMises;

use super::{AnyPointQuantity, AnyQuantity, ElementSum, OfBeams, OfShells, QuantityPart, QuantityVisitor};
use crate::elements::entries::entries;
use crate::elements::{Parameter, instantiate_here};

entries! {
    QuantityPart, QuantityVisitor;
    /// What is measured at nodes, by the names that scene files and programs use, each described in its own file.
    QUANTITIES:
    Position, Velocity, TargetDistance, Distance, Coordinate, JointAngle, JointRate, JointDisplacement, JointSpeed, CableDeflection;
}

instantiate_here!(dyn AnyQuantity: CableLargestStress, CableQuantity, Reaction, ReactionNorm, SectionQuantity);
instantiate_here!(dyn AnyPointQuantity: ElementSum, OfShells<TsaiWu>, OfShells<VonMises>);
instantiate_here!(dyn AnyPointQuantity: CableVonMises, OfBeams<BeamSectionForce>, OfBeams<BeamVonMises>);

/// A point of a body and a direction in the world: the parameters of projected point quantities.
const POINT_AND_DIRECTION: [Parameter; 6] = [
    Parameter::new("point x", "m"),
    Parameter::new("point y", "m"),
    Parameter::new("point z", "m"),
    Parameter::new("direction x", "-"),
    Parameter::new("direction y", "-"),
    Parameter::new("direction z", "-"),
];
