use super::Analysis;
use crate::assembly::StructuralSignature;
use crate::integrators::Method;
use crate::linalg::Backend;
use crate::program::Digest;

/// What a run follows from beside its numbers: the structure of the model, the method, decisions about the start, and the functionals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Signature {
    pub structure: StructuralSignature,
    method: String,
    functionals: Vec<Option<Digest>>,
}

impl Signature {
    pub fn of(analysis: &Analysis) -> Self {
        let Analysis { model, method, plan, functionals, .. } = analysis;
        // the same run follows from whatever solves its systems, measured or not
        let method = Method { backend: Backend::default(), measures_phases: false, ..(*method).clone() };
        Signature {
            structure: model.structural_signature(),
            method: format!("{method:?}{plan:?}"),
            functionals: functionals.iter().map(|own| own.law(model)).collect(),
        }
    }

    /// Why a run of another signature is none of this analysis, if so.
    pub fn difference(&self, of_run: &Signature, analysis: &Analysis) -> Option<String> {
        let name = |place: usize| analysis.functionals.get(place).map_or("", |own| own.name.as_str());
        if let Some(foreign) = self.functionals.iter().position(Option::is_none) {
            return Some(format!("functional \"{}\" measures parts of another model", name(foreign)));
        }
        if let Some(what) = self.structure.difference(&of_run.structure, analysis.model) {
            return Some(format!("its model has another structure: {what} differs"));
        }
        if self.method != of_run.method {
            return Some(format!(
                "it was made by another method, level or plan of the start than \"{}\" with those of the analysis",
                analysis.method.table.name
            ));
        }
        let (own, others) = (self.functionals.len(), of_run.functionals.len());
        if own != others {
            return Some(format!("it has {others} functionals, and the analysis {own}"));
        }
        let differing = self.functionals.iter().zip(&of_run.functionals).position(|(own, of_run)| own != of_run);
        differing.map(|place| format!("functional \"{}\" is another one there", name(place)))
    }
}
