//! What functionals measure, and what they make of it.

use super::{Functional, Measured};
use crate::assembly::{ConstraintId, Model, NodeId};
use crate::program::Digest;

impl Functional {
    /// What it does in a model, whatever it is called; `None` if what it measures is none of the model's.
    pub(crate) fn law(&self, model: &Model) -> Option<Digest> {
        let measured = match &self.measured {
            Measured::Local { nodes, constraints, parameters, quantity } => {
                let (nodes, constraints) = (places(model, nodes)?, joints(model, constraints)?);
                let formula = quantity.refused().map_or_else(|| quantity.formula().digest(), Digest::of);
                Digest::of(&(nodes, constraints, parameters, formula))
            }
            Measured::Group(group) | Measured::Energy(group) => group.law(model)?,
            Measured::Load { joint, parameters, load } => {
                let physics = &model.find_constraint(*joint)?.physics;
                let formula = load.refused(physics).is_none().then(|| load.formula(physics).digest())?;
                Digest::of(&(joint.0, parameters, formula))
            }
        };
        // the shortest digits of a number read back as that number
        Some(Digest::of(&(measured, format!("{:?}", self.over))))
    }
}

fn places(model: &Model, nodes: &[NodeId]) -> Option<Vec<usize>> {
    nodes.iter().map(|&node| model.find_node(node).map(|_| node.0)).collect()
}

fn joints(model: &Model, constraints: &[ConstraintId]) -> Option<Vec<usize>> {
    constraints.iter().map(|&joint| model.find_constraint(joint).map(|_| joint.0)).collect()
}
