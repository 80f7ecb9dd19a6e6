use crate::elements::flexible::STRAINS;
use crate::functionals::BeamQuantity;
use crate::scalar::Scalar;

/// A section force N1, N2, N3 \[N\] or moment M1, M2, M3 [N m] of beams by its number from 0 on, at both ends of each
/// element.
#[derive(Hash)]
pub struct BeamSectionForce {
    /// Which, below 6.
    pub component: usize,
}

impl BeamQuantity for BeamSectionForce {
    const NAME: &'static str = "a section force of a beam";

    fn in_section<S: Scalar>(&self, _end: usize, forces: [S; STRAINS], _own: &[S]) -> Vec<S> {
        vec![forces[self.component]]
    }
}
