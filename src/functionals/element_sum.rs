use super::AnyPointQuantity;
use super::measured_group::{Argument, GroupFormula};
use crate::elements::{ElementPhysics, Parameter};

/// A number of each element, whose sum is that of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementSum {
    /// Kinetic and potential energy \[J\].
    Energy,
    /// Mass \[kg\].
    Mass,
    /// What is stored in strains, half the compliance of a linear structure under the loads that strain it \[J\].
    StrainEnergy,
    /// Power of all that is not in its energies \[W\]: applied forces, losses, what drives it. The energy of a mechanism changes by it, and by
    /// the power of its drivers.
    Power,
    /// Moment of inertia about an axis: twice the kinetic energy of a turn about it at 1 rad/s [kg m2].
    ///
    /// Parameters: a point of the axis \[m\] and its direction of length 1, in the world.
    InertiaMoment,
}

/// Places of results among the energies of an element.
const KINETIC: usize = 0;
const POTENTIAL: usize = 1;
const MASS: usize = 2;
const STORED: usize = 3;

impl AnyPointQuantity for ElementSum {
    fn name(&self) -> &'static str {
        match self {
            ElementSum::Energy => "an energy",
            ElementSum::Mass => "a mass",
            ElementSum::StrainEnergy => "a strain energy",
            ElementSum::Power => "a power beside its energies (a load, a damper, an actuator)",
            ElementSum::InertiaMoment => "a moment of inertia",
        }
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        if *self != ElementSum::InertiaMoment {
            return Vec::new();
        }
        [Parameter::vectors(&["point"], "m"), Parameter::vectors(&["axis"], "-")].concat()
    }
    fn record(&self, element: &ElementPhysics) -> Option<Result<GroupFormula, String>> {
        let (n, m) = (element.dof_count(), element.parameter_count());
        let coordinates = (0..n).map(Argument::Q).chain((0..m).map(Argument::Parameter));
        let of_energies = |results: &[usize]| GroupFormula {
            formula: element.energies().clone(),
            arguments: (0..n).map(Argument::V).chain(coordinates.clone()).collect(),
            values: results.to_vec(),
            weights: Vec::new(),
        };
        let own = match self {
            ElementSum::Power if element.is_conservative() => return None,
            ElementSum::Energy => of_energies(&[KINETIC, POTENTIAL]),
            ElementSum::Mass => of_energies(&[MASS]),
            ElementSum::StrainEnergy => of_energies(&[STORED]),
            ElementSum::Power => GroupFormula {
                formula: element.power().clone(),
                arguments: (0..n)
                    .map(Argument::A)
                    .chain((0..n).map(Argument::V))
                    .chain(coordinates)
                    .chain([Argument::Time])
                    .collect(),
                values: vec![0],
                weights: Vec::new(),
            },
            ElementSum::InertiaMoment => GroupFormula {
                formula: element.inertia_moment().clone(),
                arguments: coordinates.chain((0..self.parameter_list().len()).map(Argument::Own)).collect(),
                values: vec![0],
                weights: Vec::new(),
            },
        };
        let is_there = *self == ElementSum::Power
            || own.formula.inspect(|graph, outputs| own.values.iter().any(|&value| !graph.is_zero(outputs[value])));
        is_there.then_some(Ok(own))
    }
}
