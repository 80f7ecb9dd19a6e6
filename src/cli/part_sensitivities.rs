//! How much a functional changes by relative changes of each part of a mechanism: what its picture is coloured by.

use super::report::Page;
use crate::assembly::Model;
use crate::scenes::Prepared;
use std::ops::Range;

/// What of an element is changed: the first of these that it has among its parameters.
const CHANGED: [&str; 3] = ["thickness", "stiffness", "mass"];

/// The parameters by which parts are changed.
pub struct PartSensitivities {
    /// For each parameter of the model, whether its derivative is needed.
    pub asked: Vec<bool>,
    /// Parameters of each element.
    elements: Vec<Range<usize>>,
}

impl PartSensitivities {
    /// Of a model.
    pub fn of(model: &Model) -> Self {
        let mut asked = vec![false; model.parameters];
        for element in &model.elements {
            let list = element.physics.parameter_list();
            let Some(word) = CHANGED.iter().find(|word| list.iter().any(|own| own.name.contains(*word))) else { continue };
            for (place, own) in element.parameters.clone().zip(&list) {
                asked[place] |= own.name.contains(word);
            }
        }
        PartSensitivities { asked, elements: model.elements.iter().map(|element| element.parameters.clone()).collect() }
    }

    /// Gives a page a colouring for each functional: sum of p df/dp over the chosen parameters p of each element.
    pub fn colour(&self, prepared: &Prepared, by_parameters: &[Vec<f64>], page: &mut Page) {
        let (solids, p) = (prepared.mechanism.solids(), &prepared.mechanism.numbers.p);
        for (functional, row) in prepared.functionals().iter().zip(by_parameters) {
            let of_element = |places: &Range<usize>| {
                let mut own = places.clone().filter(|&place| self.asked[place]).peekable();
                own.peek()?;
                Some(own.map(|place| p[place] * row[place]).sum())
            };
            let values: Vec<f64> = self.elements.iter().map(|places| of_element(places).unwrap_or(f64::NAN)).collect();
            let name = format!("d {} by a relative change of thickness, stiffness or mass", functional.name);
            page.colouring(name, functional.value_unit(), &solids.of_elements(&values));
        }
    }
}
