use crate::elements::flexible::CableStrain;
use crate::elements::flexible::hermite::{COMPONENTS, NODES, curvatures, slopes};
use crate::elements::{Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::hash::{Hash, Hasher};

/// What is read in a section of a cable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CableMeasure {
    /// Axial strain eps [-].
    Strain,
    /// Curvature kappa [1/m], zero or greater; at zero its derivative is taken as zero.
    Curvature,
    /// Axial stress E (eps + z kappa) [N/m2]: of the fibre farthest out at the distance z, on the inside of the bend for z < 0, and without
    /// bending for z = 0.
    Stress,
}

/// A strain or stress in one section of a cable; between two elements the mean of both sides.
///
/// * `length`  l of each element \[m\]
/// * `Young's modulus`  E [N/m2], `distance` z \[m\], for the stress
pub struct CableQuantity {
    /// What is read.
    pub measure: CableMeasure,
    /// Strains of the elements.
    pub strain: CableStrain,
    /// Place xi in each element that takes part.
    pub places: Vec<f64>,
}

impl Hash for CableQuantity {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let CableQuantity { measure, strain, places } = self;
        (measure, strain, places.iter().map(|xi| xi.to_bits()).collect::<Vec<_>>()).hash(state);
    }
}

/// eps and kappa at a place of an element.
pub(super) fn strains<S: Scalar>(strain: CableStrain, q: &[S], xi: f64, length: S) -> [S; 2] {
    let combined = |weights: [f64; 4]| {
        let vector = |i: usize| Vector3::first_three(&q[3 * i..]) * S::from(weights[i]);
        (vector(0) + vector(2)) * length.recip() + vector(1) + vector(3)
    };
    let (first, second) = (combined(slopes(xi)), combined(curvatures(xi)) * length.recip());
    let chord = Vector3::first_three(&q[COMPONENTS..]) - Vector3::first_three(q);
    strain.of(first, second, chord, length)
}

impl Quantity for CableQuantity {
    fn dofs(&self) -> usize {
        self.places.len() * NODES * COMPONENTS
    }
    fn unit(&self) -> &'static str {
        match self.measure {
            CableMeasure::Strain => "-",
            CableMeasure::Curvature => "1/m",
            CableMeasure::Stress => "N/m2",
        }
    }
    fn parameters(&self) -> Vec<Parameter> {
        let length = |element: usize| Parameter::named(format!("element {element}, length"), "m");
        let mut list: Vec<Parameter> = (1..=self.places.len()).map(length).collect();
        if self.measure == CableMeasure::Stress {
            list.extend([Parameter::new("Young's modulus", "N/m2"), Parameter::new("distance", "m")]);
        }
        list
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let count = self.places.len();
        let mut sum = S::zero();
        for (element, &xi) in self.places.iter().enumerate() {
            let [strain, curvature] = strains(self.strain, &s.q[element * NODES * COMPONENTS..], xi, p[element]);
            sum += match self.measure {
                CableMeasure::Strain => strain,
                CableMeasure::Curvature => curvature,
                CableMeasure::Stress => p[count] * (strain + p[count + 1] * curvature),
            };
        }
        sum / count as f64
    }
}
