//! Which formula gives what is no number.

use crate::assembly::{Model, NodeId, VectorsAvq};
use crate::elements::{FormulaWork, Parameter, RunScalar};
use crate::program::Formula;
use crate::scalar::{Scalar, Tangents};

const MOST_SHOWN: usize = 12;

/// The first element or constraint whose formula is not finite at a state, or, where these are asked for, one of its derivatives by the state; with
/// its arguments, in words.
pub(super) fn not_finite(model: &Model, p: &[f64], at: &VectorsAvq<f64>, t: f64, derivatives: bool) -> Option<String> {
    let mut work = FormulaWork::default();
    let elements = model.elements.iter().find_map(|element| {
        let states = [("a", &at.a), ("v", &at.v), ("q", &at.q)];
        let numbers = &p[element.parameters.clone()];
        let inputs = Inputs { model, nodes: &element.nodes, states: &states, p: numbers, t, derivatives };
        inputs.complaint(&element.name, element.physics.residual(), &element.physics.parameter_list(), &mut work)
    });
    elements.or_else(|| {
        model.constraints.iter().find_map(|joint| {
            let states = [("v", &at.v), ("q", &at.q)];
            let numbers = &p[joint.parameters.clone()];
            let inputs = Inputs { model, nodes: &joint.nodes, states: &states, p: numbers, t, derivatives };
            inputs.complaint(&joint.name, joint.physics.formula(), &joint.physics.parameter_list(), &mut work)
        })
    })
}

struct Inputs<'i> {
    model: &'i Model,
    nodes: &'i [NodeId],
    states: &'i [(&'static str, &'i Vec<f64>)],
    p: &'i [f64],
    t: f64,
    derivatives: bool,
}

impl Inputs<'_> {
    fn own(&self, values: &[f64]) -> Vec<f64> {
        self.nodes.iter().flat_map(|node| values[self.model.nodes[node.0].dofs.clone()].iter().copied()).collect()
    }

    fn complaint(
        &self,
        name: &str,
        formula: &Formula,
        parameters: &[Parameter],
        work: &mut FormulaWork<Tangents>,
    ) -> Option<String> {
        let moving: Vec<f64> = self.states.iter().flat_map(|(_, values)| self.own(values)).collect();
        let count = moving.len();
        let all: Vec<f64> = moving.into_iter().chain(self.p.iter().copied()).chain([self.t]).collect();
        let arguments = |moved: Option<usize>| {
            let mut arguments: Vec<Tangents> = all.iter().map(|&value| value.into()).collect();
            if let Some(place) = moved {
                arguments[place].add_to_part(0, 1.0);
            }
            arguments
        };
        let directions = if self.derivatives { 0..count } else { 0..0 };
        let found = std::iter::once(None).chain(directions.map(Some)).find_map(|moved| {
            let results = work.run(formula.values(), arguments(moved).into_iter());
            let row = results.iter().position(|result| !(result.value().is_finite() && result.part(0).is_finite()))?;
            let value = if results[row].value().is_finite() { results[row].part(0) } else { results[row].value() };
            Some((moved, row, value))
        });
        let (moved, row, value) = found?;
        let what = match moved {
            None => format!("row {row} of its formula is {value}"),
            Some(_) => format!("a derivative of row {row} of its formula is {value}"),
        };
        let lists = self.states.iter().map(|(name, values)| format!("{name} = {}", list(&self.own(values))));
        let numbers = parameters
            .iter()
            .zip(self.p)
            .map(|(parameter, value)| format!("{} = {value} {}", parameter.name, parameter.unit));
        let shown: Vec<String> = lists.chain(numbers.take(MOST_SHOWN)).collect();
        Some(format!("\"{name}\": {what} at {}", shown.join(", ")))
    }
}

fn list(values: &[f64]) -> String {
    let shown: Vec<String> = values.iter().take(MOST_SHOWN).map(|value| format!("{value:.4e}")).collect();
    let more = if values.len() > MOST_SHOWN { ", ..." } else { "" };
    format!("({}{more})", shown.join(", "))
}
