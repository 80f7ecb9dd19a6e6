use super::measured_group::GroupFormula;
use super::point_quantity::record_points;
use super::{AnyPointQuantity, PointParameters, PointValue};
use crate::elements::flexible::shape::{AT_TYING_POINTS, TWO};
use crate::elements::flexible::{Beam, BeamField, STRAINS, TYING_POINTS};
use crate::elements::{ElementPhysics, Parameter, State, interpolate, paired};
use crate::program::{Digest, Recorded, along_motion};
use crate::scalar::Scalar;
use std::hash::Hash;

/// A number, or several, of the section forces at both ends of each element of the beams of a group: one formula, and
/// nothing else. [`OfBeams`] makes it a quantity.
///
/// Section forces are linear in an element, from those at its tying points: with the same section from end to end a
/// norm of them is largest at an end. Each value stands for its share of the length: half of that of the element,
/// divided by the number of values of the section.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait BeamQuantity: Hash + Send + Sync + 'static {
    /// What it is, in a message.
    const NAME: &'static str;
    /// Its physical numbers beside those of the beam, in the order of `own`.
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    /// Values in the section at the start (0) or the end (1) of an element, from N1, N2, N3 \[N\], M1, M2, M3 [N m],
    /// damping included.
    fn in_section<S: Scalar>(&self, end: usize, forces: [S; STRAINS], own: &[S]) -> Vec<S>;
}

/// A quantity of the beams of a group; other elements are skipped.
#[derive(Hash)]
pub struct OfBeams<Q>(pub Q);

/// Section forces at both ends of an element.
fn end_forces(beam: BeamField, s: State<Recorded>, p: &[Recorded]) -> [[Recorded; STRAINS]; 2] {
    let own = beam.tying_parameters();
    let moving = paired(s.q, s.v);
    let at_points: [[Recorded; STRAINS]; TYING_POINTS] = std::array::from_fn(|point| {
        let p = &p[point * own..];
        let strain = BeamField::strains(&interpolate::<BeamField, _>(&AT_TYING_POINTS[point], s.q), p);
        let mut rate = [Recorded::from(0.0); STRAINS];
        if beam.damped {
            rate.copy_from_slice(&along_motion(&strain, &moving));
        }
        beam.section_forces(strain, rate, p)
    });
    [-1.0, 1.0].map(|xi| {
        let share = (xi - TWO[0]) / (TWO[1] - TWO[0]);
        std::array::from_fn(|i| at_points[0][i] * (1.0 - share) + at_points[1][i] * share)
    })
}

impl<Q: BeamQuantity> AnyPointQuantity for OfBeams<Q> {
    fn name(&self) -> &'static str {
        Q::NAME
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn record(&self, element: &ElementPhysics) -> Option<Result<GroupFormula, String>> {
        let beam = element.downcast::<Beam>()?.0;
        Some(record_points(
            Digest::of_typed(self),
            element,
            self.0.parameters().len(),
            |s, PointParameters { element: p, own }, _| {
                // two Gauss points of weight 1
                let half_length = (p[0] + p[beam.tying_parameters()]) * 0.5;
                let ends = end_forces(beam, s, p).into_iter().enumerate();
                let values = ends.map(|(end, forces)| self.0.in_section(end, forces, own));
                let weighted = values.flat_map(|values| {
                    let weight = half_length / values.len() as f64;
                    values.into_iter().map(move |value| PointValue { value, weight })
                });
                weighted.collect()
            },
        ))
    }
}
