use super::cable_section::strains;
use crate::elements::flexible::{Cable, CableStrain, SmallStrainCable};
use crate::elements::{ElementPhysics, Parameter};
use crate::functionals::point_quantity::record_points;
use crate::functionals::{AnyPointQuantity, GroupFormula, PointParameters, PointValue};
use crate::program::Digest;
use crate::scalar::Scalar;

/// The von Mises stress by the yield stress [-] of the outer fibres of cables, |E (eps +- z kappa)| / yield stress, at
/// both ends of each element. Each value stands for a quarter of the length.
///
/// Parameters: the yield stress [N/m2], E [N/m2], and the distance z of the outer fibres from the axis \[m\].
#[derive(Hash)]
pub struct CableVonMises;

fn strain_of(element: &ElementPhysics) -> Option<CableStrain> {
    let exact = element.downcast::<Cable>().map(|_| CableStrain::Exact);
    exact.or_else(|| element.downcast::<SmallStrainCable>().map(|_| CableStrain::Small))
}

impl AnyPointQuantity for CableVonMises {
    fn name(&self) -> &'static str {
        "the von Mises stress of a cable"
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        let own = [Parameter::positive("yield stress", "N/m2"), Parameter::positive("Young's modulus", "N/m2")];
        own.into_iter().chain([Parameter::positive("distance", "m")]).collect()
    }
    fn record(&self, element: &ElementPhysics) -> Option<Result<GroupFormula, String>> {
        let strain = strain_of(element)?;
        Some(record_points(
            Digest::of_typed(self),
            element,
            self.parameter_list().len(),
            |s, PointParameters { element: p, own }, _| {
                let (length, [yield_stress, young, distance]) = (p[0], [own[0], own[1], own[2]]);
                let ends = [0.0, 1.0].map(|xi| strains(strain, s.q, xi, length));
                let fibres = ends.into_iter().flat_map(|[strain, curvature]| {
                    [-1.0, 1.0].map(|side| young * (strain + distance * curvature * side) / yield_stress)
                });
                fibres.map(|stress| PointValue { value: stress.abs(), weight: length * 0.25 }).collect()
            },
        ))
    }
}
