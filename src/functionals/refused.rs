//! Whether what a functional measures is there in a model.

use super::{Functional, JointLoad, Measured};
use crate::assembly::{Attached, ConstraintId, Model, NodeId};
use crate::elements::ConstraintPhysics;
use std::ops::Range;

/// What is asked for in a model that does not have it.
const STRANGER: &str = "it measures a part of another model; make it anew for this one";

impl Functional {
    /// Why it cannot be read in a model, with its name, if so.
    pub(crate) fn refused(&self, model: &Model) -> Option<String> {
        let aggregate = self.over.aggregate().and_then(|aggregate| aggregate.mistake());
        let why = self.measured.refused(model).or_else(|| Some(format!("it has {}", aggregate?)))?;
        Some(format!("functional \"{}\": {why}", self.name))
    }
}

impl Measured {
    /// Why it cannot be measured in a model, if so: its parts are none of the model's, or have other sizes or laws than it was made for.
    pub fn refused(&self, model: &Model) -> Option<String> {
        match self {
            Measured::Local { nodes, constraints, parameters, quantity } => {
                let Some((dofs, multipliers)) = sizes(model, nodes, constraints) else { return Some(STRANGER.into()) };
                let own = quantity.parameter_list().len() + quantity.sides();
                let wanted = [quantity.dof_count(), quantity.multiplier_count()];
                different("coordinates", dofs, wanted[0])
                    .or_else(|| different("multipliers", multipliers, wanted[1]))
                    .or_else(|| parameters_refused(model, parameters, own))
                    .or_else(|| quantity.refused().map(str::to_string))
            }
            Measured::Group(group) | Measured::Energy(group) => {
                group.parameters_refused(model).or_else(|| group.refused(model))
            }
            Measured::Load { joint, parameters, load } => match model.find_constraint(*joint) {
                None => Some(STRANGER.into()),
                Some(joint) => {
                    parameters_refused(model, parameters, JointLoad::PARAMETERS).or_else(|| load_refused(model, joint, load))
                }
            },
        }
    }
}

/// Coordinates of nodes and multipliers of joints, unless some are of another model.
fn sizes(model: &Model, nodes: &[NodeId], joints: &[ConstraintId]) -> Option<(usize, usize)> {
    let dofs = nodes.iter().map(|&node| Some(model.find_node(node)?.dofs.len())).sum::<Option<usize>>()?;
    let multipliers =
        joints.iter().map(|&joint| Some(model.find_constraint(joint)?.equations.len())).sum::<Option<usize>>()?;
    Some((dofs, multipliers))
}

fn different(what: &str, have: usize, wanted: usize) -> Option<String> {
    (have != wanted).then(|| format!("it reads {wanted} {what}, but its parts in this model have {have}"))
}

fn parameters_refused(model: &Model, places: &Range<usize>, wanted: usize) -> Option<String> {
    let is_there = places.len() == wanted && places.end <= model.parameters;
    let (first, end, all) = (places.start, places.end, model.parameters);
    (!is_there).then(|| {
        format!("its {wanted} parameters cannot be numbers {first}..{end} of a model with {all} parameters; make it anew for this one")
    })
}

fn load_refused(model: &Model, joint: &Attached<ConstraintPhysics>, load: &JointLoad) -> Option<String> {
    let mut first = 0;
    let is_held = joint.nodes.iter().any(|&node| {
        let node = model.node(node);
        let own = first..first + node.dofs.len();
        first = own.end;
        own == load.node && (load.is_power() || node.kind.in_space() == Some(load.on))
    });
    let is_held = is_held || (load.is_power() && load.node == (0..joint.physics.dof_count()));
    let is_own = is_held && load.is_of(&joint.physics);
    (!is_own).then(|| format!("it is the load of another joint than \"{}\"; make one for each joint", joint.name))
}
