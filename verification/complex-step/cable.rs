//! Cables that hold the elbow of the arm: two elements clamped to the ground, a corner, two elements more, and an end on the arm.

use super::measures::Reach;
use costate::elements::flexible::CableSection;
use costate::elements::joints::HeldSlope;
use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::{CableLine, CableMember, ConstraintId, MechanismBuilder, NodeId};

/// What is tested of the cables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CableSubject {
    /// The parameters of the first element, with exact strains.
    Element,
    /// The same of a bowed one with damping.
    Damped,
    /// With the formulas for small strains: those of its stiffness, of its inertia, of its weight.
    SmallStrain,
    Inertia,
    Weight,
    /// Those of the corner.
    Corner,
    /// Those of the end on the arm.
    End(HeldSlope),
}

use Reach::{Force, Geometry, ProjectedMass, Stored};

impl CableSubject {
    /// The part whose parameters are tested.
    pub fn part(self) -> &'static str {
        match self {
            CableSubject::Element | CableSubject::Damped | CableSubject::SmallStrain => "cable, element 1",
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
            CableSubject::Damped => {
                vec![ProjectedMass, Stored, Stored, ProjectedMass, Stored, Stored, Stored, Force]
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
            CableSubject::Damped => exact.damped(S::from(DAMPING)),
            _ => exact,
        };
        let [clamp, bend] = [[1.2, -0.5, 0.3], [1.1, 0.3, -0.4]].map(|x| shoulder + Vector3::from_f64(x));
        let first = m.cable("cable", CableLine::straight([clamp, bend], 2).clamped_start(), &section);
        let second = m.cable("second cable", CableLine::straight([bend, elbow], 2), &section);
        if self == CableSubject::Damped {
            ["cable", "second cable"].into_iter().for_each(|name| bow(m, name));
        }
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

/// Damping of a cable [s].
const DAMPING: f64 = 0.0005;
/// Rise of a bowed cable by its length.
const RISE: f64 = 0.1;

/// Puts the nodes of a cable on a parabola: damping acts along the direction of the curvature, which a straight cable has none of.
fn bow<S: Scalar>(m: &mut MechanismBuilder<S>, name: &str) {
    let own = format!("{name}[");
    let nodes = m.model.nodes.iter().filter(|node| node.name.starts_with(&own));
    let places: Vec<usize> = nodes.map(|node| node.dofs.start).collect();
    let point = |place: usize| Vector3::first_three(&m.numbers.q[place..]);
    let chord = point(places[places.len() - 1]) - point(places[0]);
    let (side, length) = (chord.unit().perpendiculars()[0], chord.length());
    for (i, &place) in places.iter().enumerate() {
        let share = i as f64 / (places.len() - 1) as f64;
        let rise = side * (length * S::from(4.0 * RISE * share * (1.0 - share)));
        let slope = side * S::from(4.0 * RISE * (1.0 - 2.0 * share));
        for (own, added) in m.numbers.q[place..].iter_mut().zip(rise.components().into_iter().chain(slope.components())) {
            *own += added;
        }
    }
}
