//! What functionals measure, and what they make of it.

use super::{Functional, Measured};
use crate::assembly::Model;
use crate::program::Digest;

impl Functional {
    /// What it does in a model, whatever it is called; `None` if what it measures is none of the model's.
    pub(crate) fn law(&self, model: &Model) -> Option<Digest> {
        if self.measured.refused(model).is_some() {
            return None;
        }
        let measured = match &self.measured {
            Measured::Local { nodes, constraints, parameters, quantity } => {
                let nodes: Vec<usize> = nodes.iter().map(|node| node.0).collect();
                let constraints: Vec<usize> = constraints.iter().map(|joint| joint.0).collect();
                Digest::of(&(nodes, constraints, parameters, quantity.formula().digest()))
            }
            Measured::Group(group) | Measured::Energy(group) => group.law(model),
            Measured::Load { joint, parameters, load } => {
                let formula = load.formula(&model.constraints[joint.0].physics);
                Digest::of(&(joint.0, parameters, formula.digest()))
            }
        };
        // the shortest digits of a number read back as that number
        Some(Digest::of(&(measured, format!("{:?}", self.over))))
    }
}
