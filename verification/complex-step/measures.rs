//! The list of functionals, and which design variables they cannot depend on.

use super::scenes::{Case, Subject};
use super::shell::ShellSubject;
use costate::elements::NodeKind;
use costate::elements::flexible::PlyStrength;
use costate::elements::forces::LoadFrame;
use costate::functionals::quantities::{CableMeasure, SectionMeasure};
use costate::functionals::{Aggregate, AggregateKind, LoadKind, Over, Times};
use costate::internals::{
    Coordinate, Distance, JointAngle, JointDisplacement, JointRate, JointSpeed, Position, TargetDistance, Velocity,
};
use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::{BeamMember, CableMember, ConstraintId, MechanismBuilder, NodeId, ShellMember};

/// A quantity of the library.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    Position,
    Velocity,
    TargetDistance,
    Coordinate,
    Reaction,
    ReactionNorm,
    JointAngle,
    JointRate,
    JointDisplacement,
    JointSpeed,
    JointLoad,
    Energy,
    Mass,
    SectionForce,
    SectionStrain,
    FibreStress,
    Distance,
    CableStrain,
    CableCurvature,
    CableStress,
    LargestCableStress,
    CableDeflection,
    InertiaMoment,
    StrainEnergy,
    VonMises,
    TsaiWu,
}

const NORMALIZED: Over = Over::smooth_maximum(3.0);
/// Forces reach tens of newtons: a sharper maximum would see one stage, or the negative weight of another.
const OF_FORCE: Over = Over::smooth_maximum(0.05);
const PLAIN: Over = Aggregate::new(AggregateKind::SmoothMaximum { normalized: false }, 0.5).at(Times::Run);

const STRESS: Aggregate = Aggregate::smooth_maximum(5.0);

/// Every quantity and every use of one over time; a new one is a line here.
const LIST: [(Measure, Over); 40] = [
    (Measure::Position, Over::Initial),
    (Measure::Position, Over::Terminal),
    (Measure::Position, Over::Integral),
    (Measure::Velocity, Over::Initial),
    (Measure::Velocity, PLAIN),
    (Measure::TargetDistance, Over::Integral),
    (Measure::TargetDistance, NORMALIZED),
    (Measure::Coordinate, Over::Terminal),
    (Measure::Energy, Over::Initial),
    (Measure::Energy, Over::Terminal),
    (Measure::Reaction, Over::Initial),
    (Measure::Reaction, Over::Terminal),
    (Measure::Reaction, Over::Integral),
    (Measure::Reaction, OF_FORCE),
    (Measure::ReactionNorm, Over::Terminal),
    (Measure::JointAngle, Over::Terminal),
    (Measure::JointRate, Over::Integral),
    (Measure::JointDisplacement, Over::Terminal),
    (Measure::JointSpeed, Over::Integral),
    (Measure::JointLoad, Over::Integral),
    (Measure::Mass, Over::Integral),
    (Measure::SectionForce, Over::Terminal),
    (Measure::SectionStrain, Over::Integral),
    (Measure::FibreStress, NORMALIZED),
    (Measure::Distance, Over::Integral),
    (Measure::CableStrain, Over::Terminal),
    (Measure::CableCurvature, Over::Integral),
    (Measure::CableStress, OF_FORCE),
    (Measure::LargestCableStress, OF_FORCE),
    (Measure::CableDeflection, Over::Terminal),
    (Measure::InertiaMoment, Over::Terminal),
    (Measure::StrainEnergy, Over::Integral),
    (Measure::VonMises, STRESS.at(Times::Run)),
    (Measure::VonMises, Aggregate::new(AggregateKind::Exponential, 5.0).continuous().at(Times::Run)),
    (Measure::VonMises, Aggregate::new(AggregateKind::SquaredPower, 4.0).at(Times::End)),
    (Measure::VonMises, Over::Terminal),
    (Measure::TsaiWu, STRESS.continuous().at(Times::Run)),
    (Measure::TsaiWu, Aggregate::new(AggregateKind::Power, 4.0).continuous().at(Times::Run)),
    (Measure::TsaiWu, Aggregate::new(AggregateKind::SquaredExponential, 5.0).at(Times::Run)),
    (Measure::TsaiWu, Over::Integral),
];

impl Case {
    /// The list: without energies where an element has none, without sections where there is no beam, and of equilibria what is
    /// neither given with the start nor a velocity.
    pub fn measures(&self) -> Vec<(Measure, Over)> {
        use Measure::*;
        let beam = matches!(self.subject, Subject::Beam(_));
        let cable = matches!(self.subject, Subject::Cable(_));
        let measured = |entry: &(Measure, Over)| match entry.0 {
            SectionForce | SectionStrain | FibreStress if !beam => false,
            CableStrain | CableCurvature | CableStress | LargestCableStress | CableDeflection if !cable => false,
            StrainEnergy if !(cable || self.is_of_beams() || self.is_of_shells()) => false,
            VonMises if !matches!(self.subject, Subject::Shell(ShellSubject::Isotropic)) => false,
            TsaiWu if !matches!(self.subject, Subject::Shell(ShellSubject::Laminate)) => false,
            Energy if !self.has_energies() => false,
            // the shell under it, or beside it, is made of the turned start: the same mass but for round-off
            Mass if matches!(self.subject, Subject::Shell(ShellSubject::Pressure(..) | ShellSubject::Face(_))) => false,
            Velocity | JointRate | JointSpeed if self.statics => false,
            _ => !self.statics || entry.1 != Over::Initial,
        };
        LIST.into_iter().filter(measured).collect()
    }
}

/// How far a design variable reaches: what does not lie on its way is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// The formula does not use it: the point of a point node.
    Nothing,
    /// Mass, inertia: kinetic energy and accelerations.
    Mass,
    Inertia,
    /// The same where the start is projected in the mass metric.
    ProjectedMass,
    ProjectedInertia,
    /// Potential energy and accelerations.
    Stored,
    /// Accelerations.
    Force,
    /// Nothing before some time after the start.
    Later,
    /// A number of a table, of which a motion reads the pieces that it comes to: zero or not, nothing is claimed.
    Piece,
    /// As [`Reach::Later`], and where steps end: what a functional that cannot depend on it changes by with each of them, all together cancel.
    LaterAndSteps,
    /// A constraint's number: it moves a projected start.
    Geometry,
    /// A driver's number that moves only the velocities of a projected start.
    Rate,
    /// The start itself.
    StartPosition,
    StartVelocity,
    /// Parameters of the functionals.
    Sensor,
}

/// True if the functional cannot depend on the variable.
pub fn is_zero((measure, over): (Measure, Over), reach: Reach) -> bool {
    use Measure::*;
    use Reach::*;
    match (measure, reach) {
        (_, Nothing) => true,
        (_, Sensor) => {
            let without_numbers =
                [Coordinate, ReactionNorm, Energy, Measure::Mass, SectionForce, SectionStrain, StrainEnergy];
            without_numbers.contains(&measure) || [CableStrain, CableCurvature, CableDeflection].contains(&measure)
        }
        (Measure::Mass, _) => !matches!(reach, Reach::Mass | ProjectedMass),
        _ if over != Over::Initial => false,
        (Reaction, _) => matches!(reach, Later | LaterAndSteps),
        (Energy, _) => matches!(reach, Force | Later | LaterAndSteps),
        (Velocity, _) => {
            !matches!(reach, ProjectedMass | ProjectedInertia | Geometry | Rate | StartPosition | StartVelocity)
        }
        _ => !matches!(reach, ProjectedMass | ProjectedInertia | Geometry | StartPosition),
    }
}

/// The highest time derivative that a functional reads from the steps.
pub enum Reads {
    /// Nothing: the start alone.
    Start,
    /// Coordinates.
    Coordinates,
    /// Velocities.
    Velocities,
    /// Multipliers: as accelerations.
    Multipliers,
}

/// What a functional reads.
pub fn reads((measure, over): (Measure, Over)) -> Reads {
    match measure {
        _ if over == Over::Initial => Reads::Start,
        Measure::Mass => Reads::Start,
        Measure::Reaction | Measure::ReactionNorm | Measure::JointLoad => Reads::Multipliers,
        Measure::Velocity | Measure::Energy | Measure::JointRate | Measure::JointSpeed | Measure::SectionForce => {
            Reads::Velocities
        }
        _ => Reads::Coordinates,
    }
}

/// Name of a functional of the list.
pub fn name((measure, over): (Measure, Over)) -> String {
    format!("{measure:?} {over:?}")
}

/// What the functionals of a scene look at.
pub struct Seen {
    /// A body.
    pub arm: NodeId,
    /// A body or a point.
    pub second: NodeId,
    /// Which of the two.
    pub second_is: NodeKind,
    /// Where nothing moves.
    pub ground: NodeId,
    /// The joint of whose force the size is measured.
    pub shoulder: ConstraintId,
    /// The joint whose reaction is measured.
    pub joint: ConstraintId,
    /// Its number of equations.
    pub equations: usize,
    /// Whose sections are measured.
    pub beam: Option<BeamMember>,
    /// Whose strains are measured.
    pub cable: Option<CableMember>,
    /// Whose stresses are measured.
    pub shell: Option<ShellMember>,
}

/// Adds the list to a scene; `sensor` scales all numbers of the functionals, which are parameters like any other.
pub fn add<S: Scalar>(m: &mut MechanismBuilder<S>, seen: &Seen, list: &[(Measure, Over)], sensor: S) {
    let numbers = |values: &[f64]| -> Vec<S> { values.iter().map(|&value| sensor * value).collect() };
    let point_and_direction = numbers(&[0.3, 0.1, -0.2, 0.5, -0.6, 0.4]);
    let point_and_target = numbers(&[0.1, 0.2, 0.1, 0.4, 0.9, -0.3]);
    let weights = numbers(&[0.7, -0.5, 0.6, 0.9, -0.8, 0.4][..seen.equations]);
    let (arm, second) = (&[seen.arm][..], &[seen.second][..]);
    // motions of the arm against a point that moves freely, or against the ground: the subject may keep what it joins from moving
    let tied = seen.joint != seen.shoulder && seen.equations == 3;
    let free_point = seen.second_is == NodeKind::Point && !tied;
    let other = if free_point { (seen.second, NodeKind::Point) } else { (seen.ground, NodeKind::Body) };
    let angle = numbers(&[0.3, 0.5, 0.8, 0.8, 0.2, -0.5, 0.4, -0.7, 0.3]);
    let slide = numbers(&[0.3, 0.1, -0.2, -0.1, 0.2, 0.1, 0.5, -0.6, 0.4]);
    for &entry in list {
        let (name, over) = (name(entry), entry.1);
        let of = NodeKind::Body;
        match entry.0 {
            Measure::Position => m.functional(&name, over, (arm, &[]), Position { of }, &point_and_direction),
            Measure::Velocity => m.functional(&name, over, (arm, &[]), Velocity { of }, &point_and_direction),
            Measure::TargetDistance => {
                let quantity = TargetDistance { of: seen.second_is };
                m.functional(&name, over, (second, &[]), quantity, &point_and_target);
            }
            Measure::Coordinate => m.functional(&name, over, (arm, &[]), Coordinate { of: 7, index: 4 }, &[]),
            Measure::Reaction => m.reaction_functional(&name, over, seen.joint, &weights),
            Measure::ReactionNorm => m.reaction_norm_functional(&name, over, seen.shoulder),
            Measure::JointAngle => m.functional(&name, over, (&[seen.arm, seen.ground], &[]), JointAngle([of; 2]), &angle),
            Measure::JointRate => {
                m.functional(&name, over, (&[seen.arm, seen.ground], &[]), JointRate([of; 2]), &point_and_target[..3]);
            }
            Measure::JointDisplacement => {
                let quantity = JointDisplacement([of, other.1]);
                m.functional(&name, over, (&[seen.arm, other.0], &[]), quantity, &slide);
            }
            Measure::JointSpeed => {
                let quantity = JointSpeed([of, other.1]);
                m.functional(&name, over, (&[seen.arm, other.0], &[]), quantity, &slide);
            }
            Measure::JointLoad => {
                let [direction, point] = [[0.4, -0.7, 0.5], [0.2, 0.1, -0.3]].map(|x| Vector3::<S>::from_f64(x) * sensor);
                let (on, load) = ((seen.shoulder, seen.arm), (LoadKind::Moment, LoadFrame::Body));
                m.joint_load_functional(&name, over, on, load, direction, point);
            }
            Measure::Energy => m.energy_functional(&name, over),
            Measure::Mass => m.mass_functional(&name, over),
            Measure::Distance => {
                let quantity = Distance([of; 2]);
                m.functional(&name, over, (&[seen.arm, seen.ground], &[]), quantity, &slide[..6]);
            }
            // in the first element, whose parameters are varied, and between both
            Measure::SectionForce => {
                if let Some(beam) = &seen.beam {
                    m.section_functional(&name, over, beam, 0.2, SectionMeasure::Force(1));
                }
            }
            Measure::SectionStrain => {
                if let Some(beam) = &seen.beam {
                    m.section_functional(&name, over, beam, 0.5, SectionMeasure::Strain(4));
                }
            }
            Measure::FibreStress => {
                if let Some(beam) = &seen.beam {
                    m.fibre_stress_functional(&name, over, (beam, 0.0), sensor * 40.0, [sensor * 0.2, sensor * -0.1]);
                }
            }
            Measure::CableStrain | Measure::CableCurvature => {
                let measure = if entry.0 == Measure::CableStrain { CableMeasure::Strain } else { CableMeasure::Curvature };
                if let Some(cable) = &seen.cable {
                    m.cable_strain_functional(&name, over, cable, 0.5, measure);
                }
            }
            Measure::CableStress => {
                if let Some(cable) = &seen.cable {
                    m.cable_stress_functional(&name, over, (cable, 0.2), sensor * 40.0, sensor * 0.2);
                }
            }
            Measure::LargestCableStress => {
                if let Some(cable) = &seen.cable {
                    m.largest_cable_stress_functional(&name, cable, sensor * 40.0, sensor * 0.2, 0.05);
                }
            }
            Measure::InertiaMoment => {
                let [point, axis] = [[0.2, 0.1, -0.3], [0.4, -0.7, 0.5]].map(|x| Vector3::<S>::from_f64(x) * sensor);
                m.inertia_moment_functional(&name, over, &m.all_elements(), point, axis);
            }
            Measure::StrainEnergy => m.strain_energy_functional(&name, over, &m.all_elements()),
            Measure::VonMises => {
                if let Some(shell) = &seen.shell {
                    m.von_mises_functional(&name, over, &shell.group(), sensor * 40.0);
                }
            }
            Measure::TsaiWu => {
                if let Some(shell) = &seen.shell {
                    let [tension, compression] = [[40.0, 20.0], [30.0, 25.0]].map(|pair| pair.map(|own| sensor * own));
                    let strength = PlyStrength { tension, compression, shear: sensor * 15.0 };
                    m.tsai_wu_functional(&name, over, &shell.group(), &ShellSubject::laminate(), &[strength; 2]);
                }
            }
            Measure::CableDeflection => {
                if let Some(cable) = &seen.cable {
                    let nodes = [cable.start(), cable.end()];
                    m.cable_deflection_functional(&name, over, nodes, Vector3::from_f64([0.2, 0.5, 0.8]));
                }
            }
        }
    }
}
