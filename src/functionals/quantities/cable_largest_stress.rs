use super::cable_section::strains;
use crate::elements::flexible::CableStrain;
use crate::elements::flexible::hermite::{COMPONENTS, NODES};
use crate::elements::{Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::Scalar;
use smallvec::SmallVec;
use std::hash::{Hash, Hasher};

/// The largest axial stress of a cable, tension or compression, anywhere along it [N/m2]:
///
/// (1 / rho) ln sum exp(rho E (+-eps + z kappa)) over both ends of all elements and both signs.
///
/// In an element kappa is largest at an end. With the same rho a smooth maximum over time of it is the smooth maximum over places,
/// signs and times together.
///
/// * `length`  l of each element \[m\]
/// * `Young's modulus`  E [N/m2]
/// * `distance`  z of the outermost fibres from the axis \[m\]
///
/// Source: the aggregate of Kreisselmeier & Steinhauser (1979).
pub struct CableLargestStress {
    /// Strains of the elements.
    pub strain: CableStrain,
    /// Number of elements.
    pub elements: usize,
    /// rho [m2/N].
    pub sharpness: f64,
}

impl Hash for CableLargestStress {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let CableLargestStress { strain, elements, sharpness } = self;
        (strain, elements, sharpness.to_bits()).hash(state);
    }
}

impl Quantity for CableLargestStress {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::positive("length", "m"), Parameter::new("Young's modulus", "N/m2"), Parameter::new("distance", "m")];

    fn dofs(&self) -> usize {
        (self.elements + 1) * COMPONENTS
    }
    fn unit(&self) -> &'static str {
        "N/m2"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let mut stresses: SmallVec<[S; 16]> = SmallVec::new();
        for q in s.q.windows(NODES * COMPONENTS).step_by(COMPONENTS) {
            for xi in [0.0, 1.0] {
                let [strain, curvature] = strains(self.strain, q, xi, p[0]);
                stresses.extend([strain, -strain].map(|strain| p[1] * (strain + p[2] * curvature)));
            }
        }
        let largest = stresses.iter().skip(1).fold(stresses[0], |largest, &stress| largest.max(stress));
        let sum = stresses.iter().fold(S::zero(), |sum, &stress| sum + ((stress - largest) * self.sharpness).exp());
        sum.ln() / self.sharpness + largest
    }
}
