//! How much a functional changes by relative changes of each part of a mechanism: what its picture is coloured by.

use super::report::Page;
use costate::scenes::{Prepared, Solids};
use std::ops::Range;

/// The parameters whose derivatives results show, beside those that design variables touch.
pub struct PartSensitivities<'p> {
    /// For each parameter of the model, whether its derivative is needed; empty where none is.
    pub asked: Vec<bool>,
    /// The mechanism that is coloured, if it is.
    coloured: Option<Coloured<'p>>,
}

struct Coloured<'p> {
    solids: Solids<'p>,
    /// Of each element that is shown: its place in the model, and its sizes among the parameters.
    elements: Vec<(usize, Vec<usize>)>,
}

/// Places of the sizes of an element among all parameters: see [`Parameter::is_size`](costate::elements::Parameter::is_size).
fn sizes(prepared: &Prepared, element: usize) -> Vec<usize> {
    let own = &prepared.model().elements[element];
    let list = own.physics.parameter_list();
    own.parameters.clone().zip(list).filter(|(_, parameter)| parameter.is_size).map(|(place, _)| place).collect()
}

impl<'p> PartSensitivities<'p> {
    /// Of a scene: those that a report is coloured by, and those of meshes for ParaView.
    pub fn of(prepared: &'p Prepared, report: bool, meshes: bool) -> Self {
        let coloured = report.then(|| {
            let solids = prepared.mechanism.solids();
            let elements = solids.shown_elements().into_iter().map(|element| (element, sizes(prepared, element)));
            let elements = elements.filter(|(_, sizes)| !sizes.is_empty()).collect();
            Coloured { solids, elements }
        });
        let surfaces = if meshes { prepared.mechanism.surfaces() } else { Vec::new() };
        let thicknesses: Vec<Range<usize>> = surfaces.iter().filter_map(|surface| surface.thicknesses()).collect();
        let of_colours = coloured.iter().flat_map(|own| &own.elements).flat_map(|(_, sizes)| sizes).copied();
        let mut asked = Vec::new();
        for place in of_colours.chain(thicknesses.into_iter().flatten()) {
            asked.resize(prepared.model().parameters, false);
            asked[place] = true;
        }
        PartSensitivities { asked, coloured }
    }

    /// Gives a page a colouring for each functional: sum of p df/dp over the sizes p of each element.
    pub fn colour(&self, prepared: &Prepared, by_parameters: &[Vec<f64>], page: &mut Page) {
        let Some(Coloured { solids, elements }) = &self.coloured else { return };
        let p = &prepared.mechanism.numbers.p;
        for (functional, row) in prepared.functionals().iter().zip(by_parameters) {
            let mut values = vec![f64::NAN; prepared.model().elements.len()];
            for (element, sizes) in elements {
                values[*element] = sizes.iter().map(|&place| p[place] * row[place]).sum();
            }
            let name = format!("d {} by a relative change of thickness, stiffness or mass", functional.name);
            page.colouring(name, functional.value_unit(), &solids.of_elements(&values));
        }
    }
}
