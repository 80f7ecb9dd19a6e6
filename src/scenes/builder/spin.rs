//! What turns steadily where a motion begins.

use super::MechanismBuilder;
use crate::assembly::{NodeId, Spin};
use crate::elements::SPIN_PARAMETERS;
use crate::scalar::{Scalar, SpatialVector, Vector3};

impl<S: Scalar> MechanismBuilder<S> {
    /// Lets nodes turn steadily about an `axis` (a unit vector) through `point` \[m\], at a rate [rad/s], where the motion begins: it begins at the
    /// equilibrium in the frame that turns with them, under centrifugal forces and the loads of its start, with the velocities of that turn. Weights of
    /// what turns count with their part along the axis, the mean over a turn. It has an effect only in runs [from
    /// equilibrium](crate::scenes::Settings::from_equilibrium); what does not turn is at rest there.
    ///
    /// ```
    /// use costate::prelude::*;
    ///
    /// // a mass that a spring holds on a slide of a hub: k (r - r0) = m omega^2 r
    /// struct Whirled;
    /// impl Scene for Whirled {
    ///     fn name(&self) -> String {
    ///         "whirled".into()
    ///     }
    ///     fn variables(&self) -> Vec<DesignVariable> {
    ///         vec![DesignVariable::new("omega", 20.0, (0.0, 30.0), "rad/s")]
    ///     }
    ///     fn settings(&self) -> Settings {
    ///         Settings::new(0.1, 20).from_equilibrium()
    ///     }
    ///     fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
    ///         let (zero, [along_x, _, along_z]) = (Vector3::zeros(), Quaternion::<S>::identity().columns());
    ///         let (ground, at) = (m.ground(), along_x * S::from(0.5));
    ///         let [hub, mass] = [("hub", zero), ("mass", at)].map(|(name, place)| m.body(name, place, Quaternion::identity()));
    ///         let inertia = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0].map(S::from);
    ///         m.rigid_body("hub", hub, S::one(), zero, inertia);
    ///         m.rigid_body("mass", mass, S::from(2.0), zero, inertia);
    ///         m.revolute("shaft", [ground, hub], zero, along_z);
    ///         m.prismatic("slide", [hub, mass], at, along_x);
    ///         m.line_spring("spring", [hub, mass], [zero, at], S::from(2000.0), S::from(0.5));
    ///         m.hold(hub, &[Freedom::RotationZ]);
    ///         m.spin(&[hub, mass], zero, along_z, x[0]);
    ///         m.position_functional("x at the start", Over::Initial, mass, zero, along_x);
    ///         Ok(())
    ///     }
    /// }
    /// ```
    pub fn spin(&mut self, nodes: &[NodeId], point: Vector3<S>, axis: Vector3<S>, rate: S) {
        let mut turning = Vec::new();
        for &node in nodes {
            let Some(kind) = self.kind_of("spin", node) else { return };
            let own = &self.model.nodes[node.0];
            if own.fixed || kind.in_space().is_none() {
                let why = if own.fixed { "it never moves".into() } else { format!("it is {}", kind.words()) };
                self.mistakes.push(format!("\"{}\" cannot turn steadily: {why}", own.name));
                return;
            }
            if !turning.contains(&node) {
                turning.push(node);
            }
        }
        if self.model.spin.is_some() {
            return self.mistakes.push("nodes turn steadily already: there is one steady turn in a model".into());
        }
        let axis = self.unit("spin", axis);
        let parameters = self.model.add_parameters(SPIN_PARAMETERS);
        self.numbers.p.extend(point.components().into_iter().chain(axis.components()).chain([rate]));
        self.model.spin = Some(Spin { nodes: turning, parameters });
    }
}
