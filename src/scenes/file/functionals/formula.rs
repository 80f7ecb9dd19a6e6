//! A functional by a formula of nodes.

use super::{Measurand, measurand};
use crate::elements::{Parameter, State};
use crate::functionals::Quantity;
use crate::scenes::file::describing::*;

/// What is measured by a formula, with its unit.
#[derive(Hash)]
struct FormulaQuantity(Formulas, &'static str);

impl Quantity for FormulaQuantity {
    fn dofs(&self) -> usize {
        self.0.dofs()
    }
    fn unit(&self) -> &'static str {
        self.1
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], t: S) -> S {
        self.0.number(0, &self.0.arguments([s.v, s.q], t, p), p)
    }
}

pub(super) const FORMULA: Measurand = measurand(
    "formula",
    "a formula of its nodes and of the time",
    &[
        NODES,
        DEFINITIONS,
        OWN_TABLES,
        need("value", Type::OfNodes("unit"), "the quantity, as in \"dot(tip.velocity, [0, 0, 1])\""),
        may("unit", Type::Text, "its unit, for tables and charts; -"),
    ],
    |e, over, m| {
        let mut reading = Reading::new(e, m)?;
        reading.take_key(e, "value", [true, true])?;
        let Reading { nodes, formulas, p, .. } = reading;
        let unit = kept(e.text("unit").unwrap_or("-"));
        m.functional(e.name(), over, (&nodes, &[]), FormulaQuantity(formulas, unit), &p);
        Ok(())
    },
);
