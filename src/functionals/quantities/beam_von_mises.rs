use crate::elements::Parameter;
use crate::elements::flexible::{OutlineStress, STRAINS};
use crate::functionals::BeamQuantity;
use crate::scalar::Scalar;

/// The von Mises stress by the yield stress [-] at points on the [outline](OutlineStress) of beams, at both ends of
/// each element.
///
/// Parameters: the yield stress [N/m2], and the numbers of the outline at the start and at the end of the element.
#[derive(Hash)]
pub struct BeamVonMises {
    /// Whether the outline at the start and at the end is round.
    pub round: [bool; 2],
}

impl BeamQuantity for BeamVonMises {
    const NAME: &'static str = "the von Mises stress of a beam";

    fn parameters(&self) -> Vec<Parameter> {
        let ends = [OutlineStress::<f64>::parameters(), OutlineStress::<f64>::parameters()];
        [Parameter::positive("yield stress", "N/m2")].into_iter().chain(ends.into_iter().flatten()).collect()
    }
    fn in_section<S: Scalar>(&self, end: usize, forces: [S; STRAINS], own: &[S]) -> Vec<S> {
        let (yield_stress, outlines) = (own[0], &own[1..]);
        let numbers = outlines.chunks_exact(outlines.len() / 2).nth(end).unwrap_or_default();
        let outline = OutlineStress::from_numbers(self.round[end], numbers);
        outline.von_mises(forces).into_iter().map(|stress| stress / yield_stress).collect()
    }
}
