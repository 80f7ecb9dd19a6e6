//! What the parts of a model do, whatever they are called and whatever their numbers are.

use super::{Attached, Event, Model};
use crate::elements::{ConstraintPhysics, ElementPhysics};
use crate::program::Digest;

/// The structure of a model: kinds of nodes, and of each element and constraint its nodes, the places of its parameters and its recorded formula.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct StructuralSignature {
    nodes: Vec<Digest>,
    spin: Option<Vec<usize>>,
    elements: Vec<Digest>,
    constraints: Vec<Digest>,
    events: Vec<Digest>,
    presence: Vec<(usize, bool)>,
    parameters: usize,
}

fn law<P>(part: &Attached<P>, own: Digest) -> Digest {
    let nodes: Vec<usize> = part.nodes.iter().map(|node| node.0).collect();
    Digest::of(&(nodes, &part.parameters, own))
}

fn law_of_event(own: &Event) -> Digest {
    let Event { condition, multipliers, directions, once, ends_run, while_joint, resets, opens, closes } = own;
    let resets: Vec<_> = resets.iter().map(|own| (law(&own.values, own.values.physics.digest()), &own.targets)).collect();
    Digest::of(&(
        law(condition, condition.physics.digest()),
        (multipliers, directions),
        (once, ends_run, while_joint),
        resets,
        opens,
        closes,
    ))
}

impl Model {
    /// All of it, formulas included.
    pub(crate) fn structural_signature(&self) -> StructuralSignature {
        self.structural_signature_of(ElementPhysics::law, ConstraintPhysics::law)
    }

    /// The same without formulas: how its parts hang together.
    pub(crate) fn topology(&self) -> StructuralSignature {
        self.structural_signature_of(|_| Digest::default(), |own| Digest::of(&own.equation_count()))
    }

    fn structural_signature_of(
        &self,
        of_element: impl Fn(&ElementPhysics) -> Digest,
        of_constraint: impl Fn(&ConstraintPhysics) -> Digest,
    ) -> StructuralSignature {
        StructuralSignature {
            nodes: self.nodes.iter().map(|node| Digest::of(&(node.kind, node.fixed))).collect(),
            spin: self.spin.as_ref().map(|spin| spin.nodes.iter().map(|node| node.0).collect()),
            elements: self.elements.iter().map(|own| law(own, of_element(&own.physics))).collect(),
            constraints: self
                .constraints
                .iter()
                .chain(&self.holds)
                .map(|own| law(own, of_constraint(&own.physics)))
                .collect(),
            events: self.events.iter().map(law_of_event).collect(),
            presence: self.presence.clone(),
            parameters: self.parameters,
        }
    }
}

impl StructuralSignature {
    /// What differs from another one, in words, with the names of the model whose signature this is.
    pub fn difference(&self, other: &StructuralSignature, model: &Model) -> Option<String> {
        let first = |own: &[Digest], other: &[Digest]| own.iter().zip(other).position(|(own, other)| own != other);
        let counts = [&self.nodes, &self.elements, &self.constraints, &self.events].map(Vec::len);
        let others = [&other.nodes, &other.elements, &other.constraints, &other.events].map(Vec::len);
        if let Some(node) = first(&self.nodes, &other.nodes) {
            return Some(format!("the kind of node \"{}\"", model.nodes[node].name));
        }
        let parts = model
            .elements
            .iter()
            .map(|own| &own.name)
            .chain(model.constraints.iter().chain(&model.holds).map(|own| &own.name))
            .chain(model.events.iter().map(|own| &own.condition.name));
        let [own, others_laws] = [self, other].map(|laws| [&laws.elements[..], &laws.constraints, &laws.events].concat());
        match (first(&own, &others_laws), counts == others && self.parameters == other.parameters) {
            (Some(place), true) => {
                let name = parts.into_iter().nth(place).map_or("", String::as_str);
                Some(format!("the law of \"{name}\": its formula, its options, times of its jumps, or its nodes"))
            }
            (_, false) => Some("the number of nodes, elements, joints, events or parameters".into()),
            (None, true) if self.presence != other.presence => Some("which joints are there at the start".into()),
            (None, true) if self.spin != other.spin => Some("what turns steadily at the start".into()),
            (None, true) => None,
        }
    }
}
