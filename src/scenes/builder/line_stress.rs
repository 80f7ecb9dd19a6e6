//! Von Mises stresses and section forces of beams and cables in groups.

use super::{LineField, MechanismBuilder};
use crate::assembly::{ElementId, NodeId};
use crate::elements::ElementPhysics;
use crate::elements::flexible::{Beam, Cable, OutlineStress, STRAINS, Section, SmallStrainCable};
use crate::functionals::quantities::{BeamSectionForce, BeamVonMises, CableVonMises, VonMises};
use crate::functionals::{AnyPointQuantity, ElementGroup, GroupPart, OfBeams, OfShells, Over, PointWeights};
use crate::program::Recorded;
use crate::scalar::Scalar;

/// What gives stresses of an element of a beam or cable.
#[derive(Clone, Debug)]
pub(super) enum LineStress<S> {
    /// Outlines at both ends.
    Beam([OutlineStress<S>; 2]),
    /// Young's modulus [N/m2] and distance of the outer fibres from the axis \[m\].
    Cable([S; 2]),
    /// None, for this reason.
    Unknown(String),
}

impl<S: Scalar> LineStress<S> {
    /// Of an element of a beam with these sections at its ends.
    pub(super) fn of_beam(ends: [&Section<S>; 2]) -> Self {
        if let Some(size) = ends.iter().find_map(|end| end.impossible) {
            return LineStress::Unknown(format!("at an end of it {size}"));
        }
        match ends.map(|end| end.stress) {
            [Some(start), Some(end)] => LineStress::Beam([start, end]),
            _ => LineStress::by_stiffness(),
        }
    }

    /// Of an element with a section of which nothing is known but its stiffness.
    pub(super) fn by_stiffness() -> Self {
        let missing = "its section is given by stiffness alone, without the points of its outline and their moduli";
        LineStress::Unknown(format!("{missing}; give a material and a shape"))
    }

    /// What is measured in it, and the numbers that it takes.
    fn quantity(&self) -> (Box<dyn AnyPointQuantity>, Vec<S>) {
        match self {
            LineStress::Beam(ends) => {
                let quantity = BeamVonMises { round: ends.map(|end| end.round) };
                (OfBeams(quantity).into(), ends.iter().flat_map(OutlineStress::numbers).collect())
            }
            LineStress::Cable(numbers) => (CableVonMises.into(), numbers.to_vec()),
            LineStress::Unknown(_) => unreachable!("an element without stresses was refused"),
        }
    }

    /// Largest von Mises stress [N/m2] at both ends of an element with these section forces; of a cable EA and EI tell
    /// its strains.
    fn largest(&self, forces: [[S; STRAINS]; 2], p: &[S]) -> Option<S> {
        let stresses: Vec<S> = match self {
            LineStress::Beam(ends) => {
                ends.iter().zip(forces).flat_map(|(end, own)| end.von_mises(own).into_iter()).collect()
            }
            &LineStress::Cable([young, distance]) => {
                forces.iter().map(|own| young * (own[0].abs() / p[1] + distance * own[4] / p[2])).collect()
            }
            LineStress::Unknown(_) => return None,
        };
        stresses.into_iter().reduce(|largest, own| largest.max(own))
    }

    /// Whether both are measured by one formula.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (LineStress::Beam(own), LineStress::Beam(other)) => own.map(|end| end.round) == other.map(|end| end.round),
            (own, other) => matches!((own, other), (LineStress::Cable(_), LineStress::Cable(_))),
        }
    }
}

impl LineStress<Recorded> {
    /// With values in place of what is recorded.
    pub(super) fn in_real_numbers(self) -> LineStress<f64> {
        let of_outline =
            |own: OutlineStress<Recorded>| OutlineStress::from_numbers(own.round, &own.numbers().map(Recorded::number));
        match self {
            LineStress::Beam(ends) => LineStress::Beam(ends.map(of_outline)),
            LineStress::Cable(numbers) => LineStress::Cable(numbers.map(Recorded::number)),
            LineStress::Unknown(why) => LineStress::Unknown(why),
        }
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A functional of the von Mises stress by the yield stress [-] of shells of one material, on both surfaces (see
    /// `VonMises`), of beams, at points on the outlines of their sections ([`OutlineStress`]), and of cables, in
    /// their outer fibres (`CableVonMises`).
    pub fn von_mises_functional(&mut self, name: &str, over: Over, group: &ElementGroup, yield_stress: S) {
        let is_line = |&element: &ElementId| self.is_line(element);
        let (lines, others): (Vec<ElementId>, Vec<ElementId>) = group.elements.iter().copied().partition(is_line);
        if lines.is_empty() {
            self.add_group_functional(name, "-", over, group, OfShells(VonMises).into(), &[yield_stress]);
            return;
        }
        let has_shells = others.iter().any(|&element| {
            self.model.find_element(element).is_some_and(|element| OfShells(VonMises).record(&element.physics).is_some())
        });
        if has_shells && over.points() == PointWeights::Own {
            self.mistakes.push(format!(
                "\"{name}\" measures shells and beams of the group \"{}\" together, which stand for areas and for lengths: take an \
                 aggregate in which all points count the same, or a functional for each",
                group.name
            ));
            return;
        }
        let Some(parts) = self.line_parts(name, &lines) else { return };
        if !self.check_over(name, over) || !self.check_elements(name, &others) {
            return;
        }
        let parameters = self.add_numbers(&[yield_stress]);
        let mut all = Vec::new();
        for (elements, quantity, numbers) in parts {
            let of_elements = self.add_numbers(&numbers);
            all.push(GroupPart { elements: Some(elements), quantity, of_elements });
        }
        if has_shells {
            let elements = Some(others.into_iter().filter(|&own| self.model.find_element(own).is_some()).collect());
            all.push(GroupPart { elements, quantity: OfShells(VonMises).into(), of_elements: 0..0 });
        }
        self.measure_parts(name, "-", over, all, parameters);
    }

    /// A functional of a section force N1, N2, N3 \[N\] or moment M1, M2, M3 [N m], by its number from 0 to 5, over the
    /// beams of a group: at both ends of each element.
    pub fn section_forces_functional(&mut self, name: &str, over: Over, group: &ElementGroup, component: usize) {
        if component >= STRAINS {
            self.mistakes
                .push(format!("\"{name}\" asks for component {component} of section forces; components are 0 to 5"));
            return;
        }
        let unit = if component < 3 { "N" } else { "N m" };
        self.add_group_functional(name, unit, over, group, OfBeams(BeamSectionForce { component }).into(), &[]);
    }

    /// Whether an element is one of a beam or cable.
    fn is_line(&self, element: ElementId) -> bool {
        let is_cable =
            |own: &ElementPhysics| own.downcast::<Cable>().is_some() || own.downcast::<SmallStrainCable>().is_some();
        let is_line = |own: &ElementPhysics| is_cable(own) || own.downcast::<Beam>().is_some();
        self.model.find_element(element).is_some_and(|element| is_line(&element.physics))
    }

    /// Elements that are measured by one formula, with it and their numbers; `None` if one of them has no stresses.
    #[allow(clippy::type_complexity)]
    fn line_parts(
        &mut self,
        name: &str,
        lines: &[ElementId],
    ) -> Option<Vec<(Vec<ElementId>, Box<dyn AnyPointQuantity>, Vec<S>)>> {
        let unknown = LineStress::by_stiffness();
        let mut parts: Vec<(&LineStress<S>, Vec<ElementId>, Vec<S>)> = Vec::new();
        for &element in lines {
            let own = self.line_stresses.get(&element).unwrap_or(&unknown);
            if let LineStress::Unknown(why) = own {
                let of = &self.model.find_element(element)?.name;
                self.mistakes.push(format!("\"{name}\" asks for the von Mises stress of \"{of}\": {why}"));
                return None;
            }
            let place = parts.iter().position(|(other, ..)| own.is_like(other)).unwrap_or(parts.len());
            if place == parts.len() {
                parts.push((own, Vec::new(), Vec::new()));
            }
            parts[place].1.push(element);
            parts[place].2.extend(own.quantity().1);
        }
        Some(parts.into_iter().map(|(own, elements, numbers)| (elements, own.quantity().0, numbers)).collect())
    }
}

/// An element of a beam or cable as it is shown.
pub struct LineElement {
    /// The element.
    pub element: ElementId,
    /// Its nodes, from end to end.
    pub nodes: Vec<NodeId>,
    field: LineField,
}

impl MechanismBuilder<f64> {
    /// The elements of all beams and cables.
    #[doc(hidden)]
    pub fn line_elements(&self) -> Vec<LineElement> {
        let of_line = |line: &super::OutlinedLine| {
            let field = line.field;
            let nodes = |id| self.model.find_element(id).map(|element| element.nodes.to_vec());
            let one = move |&element: &ElementId| Some(LineElement { element, nodes: nodes(element)?, field });
            line.elements.iter().filter_map(one).collect::<Vec<_>>()
        };
        self.outlined.iter().flat_map(of_line).collect()
    }

    /// N1, N2, N3 \[N\], M1, M2, M3 [N m] in the middle of an element, and the largest von Mises stress [N/m2] at its
    /// ends if its section tells it, both without damping, at the coordinates of the whole mechanism.
    #[doc(hidden)]
    pub fn line_state(&self, line: &LineElement, q: &[f64]) -> ([f64; STRAINS], Option<f64>) {
        let dofs = line.nodes.iter().flat_map(|&node| self.model.node(node).dofs.clone());
        let q: Vec<f64> = dofs.map(|dof| q[dof]).collect();
        let parameters = self.model.find_element(line.element).map_or(0..0, |element| element.parameters.clone());
        let p = &self.numbers.p[parameters];
        let places = line.field.places();
        let (first, last) = (places[0], places[places.len() - 1]);
        let at = |place: f64| line.field.section_forces(place, &q, p);
        let stress = self.line_stresses.get(&line.element).and_then(|own| own.largest([at(first), at(last)], p));
        (at(0.5 * (first + last)), stress)
    }
}
