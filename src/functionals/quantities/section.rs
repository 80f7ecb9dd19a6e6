use crate::elements::flexible::shape::{AT_TYING_POINTS, NODES, TWO};
use crate::elements::flexible::{BeamField, STRAINS, TYING_POINTS};
use crate::elements::{Field, Parameter, interpolate};
use crate::functionals::Quantity;
use crate::scalar::Scalar;
use std::hash::{Hash, Hasher};

/// What is read in a section of a beam; components are counted as 0, 1, 2 for axial, 2, 3 and 3, 4, 5 for torsion, bending about 2, 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SectionMeasure {
    /// N1, N2, N3 \[N\], M1, M2, M3 [N m].
    Force(usize),
    /// gamma1 - 1, gamma2, gamma3 [-], kappa1, kappa2, kappa3 [1/m], from the reference on.
    Strain(usize),
    /// Axial stress of a fibre, E (gamma1 - 1 + x3 kappa2 - x2 kappa3) [N/m2].
    FibreStress,
}

/// A force, strain or stress in one section of a beam: from the tying points, between and beyond which it is linear.
///
/// Between two elements it is the mean of both sides.
///
/// Parameters: those of the tying points of each element; for a fibre E [N/m2], x2, x3 \[m\].
pub struct SectionQuantity {
    /// What is read.
    pub measure: SectionMeasure,
    /// The formulas of the beam's elements.
    pub beam: BeamField,
    /// Place xi in each element that takes part.
    pub places: Vec<f64>,
}

impl Hash for SectionQuantity {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let SectionQuantity { measure, beam, places } = self;
        (measure, beam, places.iter().map(|xi| xi.to_bits()).collect::<Vec<_>>()).hash(state);
    }
}

impl SectionQuantity {
    fn parameters_of_an_element(&self) -> usize {
        TYING_POINTS * self.beam.tying_parameters()
    }
}

impl Quantity for SectionQuantity {
    fn dofs(&self) -> usize {
        self.places.len() * NODES * BeamField::NODE.dofs()
    }
    fn unit(&self) -> &'static str {
        match self.measure {
            SectionMeasure::Force(0..3) => "N",
            SectionMeasure::Force(_) => "N m",
            SectionMeasure::Strain(0..3) => "-",
            SectionMeasure::Strain(_) => "1/m",
            SectionMeasure::FibreStress => "N/m2",
        }
    }
    fn parameters(&self) -> Vec<Parameter> {
        let mut list = Vec::new();
        for element in 1..=self.places.len() {
            let own = self.beam.parameters().into_iter().take(self.parameters_of_an_element());
            list.extend(
                own.map(|parameter| Parameter::named(format!("element {element}, {}", parameter.name), parameter.unit)),
            );
        }
        if self.measure == SectionMeasure::FibreStress {
            list.extend([Parameter::new("Young's modulus", "N/m2"), Parameter::new("x2", "m"), Parameter::new("x3", "m")]);
        }
        list
    }
    fn rated_count(&self) -> usize {
        self.places.len() * TYING_POINTS * STRAINS
    }
    /// The strains at the tying points of all elements.
    fn rated<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        let (dofs, own) = (NODES * BeamField::NODE.dofs(), self.parameters_of_an_element());
        for (place, e) in e.chunks_exact_mut(STRAINS).enumerate() {
            let (element, point) = (place / TYING_POINTS, place % TYING_POINTS);
            let h = interpolate::<BeamField, S>(&AT_TYING_POINTS[point], &q[element * dofs..]);
            e.copy_from_slice(&BeamField::strains(&h, &p[element * own + point * own / TYING_POINTS..]));
        }
    }
    fn value_with_rates<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S]) -> S {
        let own = self.parameters_of_an_element();
        let fibre = &p[self.places.len() * own..];
        let mut sum = S::zero();
        for (element, &xi) in self.places.iter().enumerate() {
            let [first, second]: [[S; STRAINS]; TYING_POINTS] = std::array::from_fn(|point| {
                let place = (element * TYING_POINTS + point) * STRAINS;
                let [strain, rate] = [e, rate].map(|all| std::array::from_fn(|i| all[place + i]));
                match self.measure {
                    SectionMeasure::Force(_) => {
                        self.beam.section_forces(strain, rate, &p[element * own + point * own / TYING_POINTS..])
                    }
                    SectionMeasure::Strain(_) | SectionMeasure::FibreStress => strain,
                }
            });
            let share = (xi - TWO[0]) / (TWO[1] - TWO[0]);
            let component = |i: usize| first[i] * (1.0 - share) + second[i] * share;
            sum += match self.measure {
                SectionMeasure::Force(i) | SectionMeasure::Strain(i) => component(i),
                SectionMeasure::FibreStress => fibre[0] * (component(0) + fibre[2] * component(4) - fibre[1] * component(5)),
            };
        }
        sum / self.places.len() as f64
    }
}
