//! What holds parts while the equilibrium is found at which a motion begins.

use super::MechanismBuilder;
use crate::assembly::NodeId;
use crate::elements::joints::{Freedom, HeldNode};
use crate::scalar::Scalar;

impl<S: Scalar> MechanismBuilder<S> {
    /// Holds a node where it stands while the equilibrium is found at which the motion begins, and lets it go then: in the given directions of the
    /// world, in all that it has if none is given. For what that equilibrium leaves free, and for what is released at the start. It has an effect
    /// only in runs [from equilibrium](crate::scenes::Settings::from_equilibrium).
    ///
    /// ```
    /// use costate::prelude::*;
    ///
    /// // a mass that hangs from a spring, and may slide to the side
    /// let mut m = MechanismBuilder::<f64>::default();
    /// let (ground, mass) = (m.ground(), m.point("mass", Vector3::new(0.0, 0.0, -1.0)));
    /// m.point_mass("mass", mass, 2.0);
    /// m.hold(mass, &[Freedom::X, Freedom::Y]);
    /// # let _ = ground;
    /// assert!(m.finish().is_ok());
    /// ```
    pub fn hold(&mut self, node: NodeId, directions: &[Freedom]) {
        let Some(kind) = self.kind_of("hold", node) else { return };
        let name = self.model.nodes[node.0].name.clone();
        let has = Freedom::of(kind);
        if let Some(&other) = directions.iter().find(|freedom| !has.contains(freedom)) {
            let direction = Freedom::NAMES[other as usize];
            self.mistakes.push(format!("\"{name}\" cannot be held in the direction {direction}: it is {}", kind.words()));
            return;
        }
        if self.model.nodes[node.0].fixed {
            self.mistakes.push(format!("\"{name}\" cannot be held: it never moves"));
            return;
        }
        let held = if directions.is_empty() { has } else { directions }.to_vec();
        let given = if kind.is_of_states() { &self.numbers.v } else { &self.numbers.q };
        let start = given[self.model.nodes[node.0].dofs.clone()].to_vec();
        self.numbers.p.extend_from_slice(&start);
        self.model.add_hold(&format!("hold of {name}"), &[node], HeldNode { kind, held }.into());
    }
}
