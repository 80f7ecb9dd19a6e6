//! Quantities of points, joints, sections of beams and cables, and shells.

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

pub use beam_section_force::BeamSectionForce;
pub use beam_von_mises::BeamVonMises;
pub use cable_deflection::CableDeflection;
pub use cable_largest_stress::CableLargestStress;
pub use cable_section::{CableMeasure, CableQuantity};
pub use cable_von_mises::CableVonMises;
pub use coordinate::Coordinate;
pub use distance::Distance;
pub use joint_angle::JointAngle;
pub use joint_displacement::{JointDisplacement, JointSpeed};
pub use joint_rate::JointRate;
pub use position::Position;
pub use reaction::Reaction;
pub use reaction_norm::ReactionNorm;
pub use section::{SectionMeasure, SectionQuantity};
pub use target_distance::TargetDistance;
pub use tsai_wu::TsaiWu;
pub use velocity::Velocity;
pub use von_mises::VonMises;

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
