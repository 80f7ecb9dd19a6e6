//! What is measured of groups of elements.

use super::MechanismBuilder;
use crate::assembly::ElementId;
use crate::elements::flexible::{Laminate, PlyStrength};
use crate::functionals::quantities::TsaiWu;
use crate::functionals::{
    AnyPointQuantity, ElementGroup, ElementSum, Functional, GroupPart, Measured, MeasuredGroup, OfShells, Over,
};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;

impl<S: Scalar> MechanismBuilder<S> {
    /// The elements that were added so far.
    pub fn all_elements(&self) -> ElementGroup {
        ElementGroup::new("all elements", self.model.element_ids())
    }

    /// A functional of any quantity of the elements of a group, with its own parameters; elements without the quantity are skipped.
    pub fn group_functional(
        &mut self,
        name: &str,
        unit: &'static str,
        over: Over,
        group: &ElementGroup,
        quantity: impl AnyPointQuantity + 'static,
        p: &[S],
    ) {
        self.add_group_functional(name, unit, over, group, Box::new(quantity), p);
    }

    pub(super) fn add_group_functional(
        &mut self,
        name: &str,
        unit: &'static str,
        over: Over,
        group: &ElementGroup,
        quantity: Box<dyn AnyPointQuantity>,
        p: &[S],
    ) {
        if !self.check_over(name, over) || !self.check_parameters(name, quantity.parameter_list().len(), p.len()) {
            return;
        }
        if !self.check_elements(name, &group.elements) {
            return;
        }
        let is_there = |element: &ElementId| self.model.find_element(*element).is_some();
        let elements: Vec<ElementId> = group.elements.iter().copied().filter(is_there).collect();
        let mut all = elements.iter().filter_map(|&element| self.model.find_element(element));
        let complete = elements.len() == group.elements.len();
        if complete && !all.any(|element| quantity.record(&element.physics).is_some()) {
            let (group, what) = (&group.name, quantity.name());
            self.mistakes.push(format!(
                "\"{name}\": none of the {} elements of the group \"{group}\" has {what}; take a group with elements that have it",
                elements.len()
            ));
            return;
        }
        self.measure_group(name, unit, over, Some(elements), quantity, p);
    }

    fn measure_group(
        &mut self,
        name: &str,
        unit: &'static str,
        over: Over,
        elements: Option<Vec<ElementId>>,
        quantity: Box<dyn AnyPointQuantity>,
        p: &[S],
    ) {
        let parameters = self.add_numbers(p);
        self.measure_parts(name, unit, over, vec![GroupPart { elements, quantity, of_elements: 0..0 }], parameters);
    }

    /// Adds parameters to the model.
    pub(super) fn add_numbers(&mut self, p: &[S]) -> Range<usize> {
        self.numbers.p.extend_from_slice(p);
        self.model.add_parameters(p.len())
    }

    pub(super) fn measure_parts(
        &mut self,
        name: &str,
        unit: &'static str,
        over: Over,
        parts: Vec<GroupPart>,
        parameters: Range<usize>,
    ) {
        let measured = Measured::Group(MeasuredGroup::of_parts(parts, parameters));
        self.functionals.push(Functional { name: name.into(), unit, measured, over });
    }

    /// Whether elements are those of this mechanism; one that was refused has been reported already.
    pub(super) fn check_elements(&mut self, name: &str, elements: &[ElementId]) -> bool {
        let refused = self.model.refused_element();
        let mut strangers = elements.iter().filter(|&&own| own != refused && self.model.find_element(own).is_none());
        let sound = strangers.next().is_none();
        if !sound {
            self.refuse_stranger(name, "an element");
        }
        sound
    }

    /// Whether what is made over time has a value.
    pub(super) fn check_over(&mut self, name: &str, over: Over) -> bool {
        let mistake = over.aggregate().and_then(|aggregate| aggregate.mistake());
        self.mistakes.extend(mistake.iter().map(|why| format!("\"{name}\" has {why}")));
        mistake.is_none()
    }

    /// A functional of the mass of all elements, those that are added later included \[kg\].
    pub fn mass_functional(&mut self, name: &str, over: Over) {
        self.measure_group(name, "kg", over, None, ElementSum::Mass.into(), &[]);
    }

    /// A functional of the mass of a group \[kg\].
    pub fn group_mass_functional(&mut self, name: &str, over: Over, group: &ElementGroup) {
        self.add_group_functional(name, "kg", over, group, ElementSum::Mass.into(), &[]);
    }

    /// A functional of the energy that is stored in the strains of a group, half its compliance \[J\].
    pub fn strain_energy_functional(&mut self, name: &str, over: Over, group: &ElementGroup) {
        self.add_group_functional(name, "J", over, group, ElementSum::StrainEnergy.into(), &[]);
    }

    /// A functional of the power of all that is not in the energies of a group \[W\]: loads, dampers, actuators, losses of members. Its integral is a
    /// work \[J\], negative of what is lost.
    pub fn power_functional(&mut self, name: &str, over: Over, group: &ElementGroup) {
        self.add_group_functional(name, "W", over, group, ElementSum::Power.into(), &[]);
    }

    /// The same of all elements, those that are added later included.
    pub fn total_power_functional(&mut self, name: &str, over: Over) {
        self.measure_group(name, "W", over, None, ElementSum::Power.into(), &[]);
    }

    /// A functional of the moment of inertia of a group about the axis through a world point [kg m2].
    pub fn inertia_moment_functional(
        &mut self,
        name: &str,
        over: Over,
        group: &ElementGroup,
        point: Vector3<S>,
        axis: Vector3<S>,
    ) {
        let axis = self.unit(name, axis);
        let p = [point.components(), axis.components()].concat();
        self.add_group_functional(name, "kg m2", over, group, ElementSum::InertiaMoment.into(), &p);
    }

    /// A functional of the failure ratio of Tsai and Wu in layered shells with these plies and their strengths [-].
    pub fn tsai_wu_functional(
        &mut self,
        name: &str,
        over: Over,
        group: &ElementGroup,
        laminate: &Laminate<S>,
        strengths: &[PlyStrength<S>],
    ) {
        let (plies, given) = (laminate.plies.len(), strengths.len());
        if plies != given {
            self.mistakes.push(format!("\"{name}\" has {plies} plies, but strengths of {given}; give those of each ply"));
            return;
        }
        let p = TsaiWu::numbers(laminate, strengths);
        self.add_group_functional(name, "-", over, group, OfShells(TsaiWu { plies }).into(), &p);
    }
}
