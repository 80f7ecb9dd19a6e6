//! Cables that hold the elbow of the arm: two elements clamped to the ground, a corner, two elements more, and an end on the arm.

use super::measures::Reach;
use costate::assembly::{ConstraintId, NodeId};
use costate::elements::flexible::CableSection;
use costate::elements::joints::HeldSlope;
use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::{CableLine, CableMember, MechanismBuilder};

/// What is tested of the cables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CableSubject {
    /// The parameters of the first element, with exact strains.
    Element,
    /// With the formulas for small strains: those of its stiffness, of its inertia, of its weight.
    SmallStrain,
    Inertia,
    Weight,
    /// Those of the corner.
    Corner,
    /// Those of the end on the arm.
    End(HeldSlope),
}

use Reach::{Geometry, ProjectedMass, Stored};

impl CableSubject {
    /// The part whose parameters are tested.
    pub fn part(self) -> &'static str {
        match self {
            CableSubject::Element | CableSubject::SmallStrain => "cable, element 1",
            CableSubject::Inertia => "inertia of cable, element 1",
            CableSubject::Weight => "weight of cable, element 1",
            CableSubject::Corner => "corner",
            CableSubject::End(_) => "end",
        }
    }

    /// What each of its numbers can reach.
    pub fn reaches(self) -> Vec<Reach> {
        match self {
            // length, stiffnesses, mass, gravity
            CableSubject::Element => {
                vec![ProjectedMass, Stored, Stored, ProjectedMass, Stored, Stored, Stored]
            }
            CableSubject::SmallStrain => vec![Stored; 3],
            CableSubject::Inertia => vec![ProjectedMass; 2],
            CableSubject::Weight => vec![Stored; 5],
            CableSubject::Corner => vec![Geometry],
            CableSubject::End(HeldSlope::Direction) => vec![Geometry; 9],
            CableSubject::End(_) => vec![Geometry; 6],
        }
    }

    /// Adds the cables from a clamp beside the shoulder to the elbow, which alone turns with the start: the second one changes its length.
    pub fn add<S: Scalar>(
        self,
        m: &mut MechanismBuilder<S>,
        [shoulder, elbow]: [Vector3<S>; 2],
        arm: NodeId,
    ) -> (CableMember, [ConstraintId; 2]) {
        let exact = CableSection::new(S::from(40.0), S::from(0.5), S::from(0.8));
        let section = match self {
            CableSubject::SmallStrain | CableSubject::Inertia | CableSubject::Weight => exact.small_strains(),
            _ => exact,
        };
        let [clamp, bend] = [[1.2, -0.5, 0.3], [1.1, 0.3, -0.4]].map(|x| shoulder + Vector3::from_f64(x));
        let first = m.cable("cable", CableLine::straight([clamp, bend], 2).clamped_start(), &section);
        let second = m.cable("second cable", CableLine::straight([bend, elbow], 2), &section);
        let corner = m.cable_corner("corner", [first.end(), second.start()]);
        let nodes = [arm, second.end()];
        let end = match self {
            CableSubject::End(HeldSlope::Plane) => {
                let across = (elbow - bend).unit().perpendiculars()[0];
                m.cable_hinge("end", nodes, across)
            }
            CableSubject::End(held) => m.cable_weld("end", nodes, held),
            _ => m.cable_weld("end", nodes, HeldSlope::Direction),
        };
        (first, [corner, end])
    }
}
