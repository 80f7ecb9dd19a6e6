//! States of first order.

use crate::elements::{Element, NodeKind, Output, Parameter, State};
use crate::scenes::file::describing::*;
use crate::scenes::file::state_entries::{MADE, STATE_FORMS};

const STATE_KEYS: [Key; 5] = [
    NAME,
    may("nodes", NAMED_NODES, "nodes, or points of them, by the names that the formulas give them; none"),
    DEFINITIONS,
    OWN_TABLES,
    BREAKPOINTS,
];

pub(super) const SECTION: Section = Section {
    forms: Forms { common: &STATE_KEYS, forms: &STATE_FORMS, own: None },
    build,
    ..Section::with_nodes(
        "state",
        "States z of first order, z' = f(z, nodes, t), as of a controller, an actuator, the slip of a tyre, inflow. Formulas know nodes as those of an \
          [[element]] do; where a state is a node c of others, their formulas know c.NAME of its values and of its outputs.",
        Nodes::one(&[]),
    )
};

/// States of first order by formulas of their rates: R = dz/dt - f(z, nodes, t) on the last node, whose rates they are.
#[derive(Hash)]
struct FormulaState {
    formulas: Formulas,
    /// What histories tell: the values, their rates, the outputs, which are the formulas behind the rates.
    outputs: Vec<Output>,
}

impl Element for FormulaState {
    fn nodes(&self) -> Vec<NodeKind> {
        self.formulas.kinds()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.formulas.parameters()
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        let Formulas { nodes, .. } = &self.formulas;
        let known = self.formulas.arguments([s.v, s.q], t, p);
        for (which, place) in self.formulas.place(nodes.len() - 1).enumerate() {
            r[place] += s.a[place] - self.formulas.number(which, &known, p);
        }
    }
    fn outputs(&self) -> Vec<Output> {
        self.outputs.clone()
    }
    fn write_outputs<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, outputs: &mut [S]) {
        let known = self.formulas.arguments([v, q], t, p);
        let values = &v[self.formulas.place(self.formulas.nodes.len() - 1)];
        outputs
            .iter_mut()
            .zip(values.iter().copied().chain(self.formulas.numbers(&known, p)))
            .for_each(|(output, own)| *output = own);
    }
}

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let named = |key: &str| match e.get(key) {
        Some((_, Value::Formulas(given))) => given.as_slice(),
        _ => &[],
    };
    let [initial, rates, outputs] = if e.form == "formula" { ["initial", "rate", "output"] } else { MADE }.map(named);
    for key in SECTION.forms.keys(e.form) {
        if let (Type::Number(..), Some((at, Value::Formula(formula, _)))) = (key.takes, e.get(key.name)) {
            if formula.uses_from(e.context.numbers.len()) {
                return Err(Mistake::new(at, format!("{} must be a number of the design alone", key.name)));
            }
            e.number(key.name)?;
        }
    }
    let mut start = Vec::new();
    for (value, at, formula) in initial {
        if formula.is_vector() || formula.uses_from(e.context.numbers.len()) {
            return Err(Mistake::new(*at, format!("the start of {value} must be a number of the design alone")));
        }
        start.extend(formula.value(|place| e.context.numbers[place]).components());
    }
    let mut reading = Reading::new(e, m)?;
    let node = m.states(e.name(), &start);
    reading.add("", node, NodeKind::States(start.len()));
    for (value, at, _) in initial {
        let Some((_, at, formula)) = rates.iter().find(|own| own.0 == *value) else {
            return Err(Mistake::new(*at, format!("{value} has a start, but no rate")));
        };
        if formula.is_vector() {
            return Err(Mistake::new(*at, format!("the rate of {value} must be a number")));
        }
        reading.take(*at, formula, [true, true])?;
    }
    if let Some((other, at, _)) = rates.iter().find(|own| initial.iter().all(|value| value.0 != own.0)) {
        return Err(Mistake::new(*at, format!("{other} has a rate, but no start: give it one in initial")));
    }
    let values = || initial.iter().map(|own| own.0.as_str());
    let mut told: Vec<Output> = values().map(|value| Output::new(value.to_string(), "")).collect();
    told.extend(values().map(|value| Output::new(format!("d{value}/dt"), "")));
    for (output, _, formula) in outputs {
        reading.add_formula(formula);
        told.extend(outputs_of(output, "", formula.is_vector()));
    }
    let Reading { nodes, formulas, p, .. } = reading;
    m.element(e.name(), &nodes, FormulaState { formulas, outputs: told }, &p);
    Ok(Built::Node(node))
}
