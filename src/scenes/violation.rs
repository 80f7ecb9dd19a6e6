use super::Prepared;
use crate::elements::bodies::OrthonormalAxes;
use crate::elements::{Constraint, NodeKind, State};
use crate::scalar::{Quaternion, larger};

/// How far a state is from the constraints, at the worst of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Violation {
    /// Largest |g| of the joints, dropped equations included [m or rad].
    pub position: f64,
    /// Largest |dg/dt| of the joints [m/s or rad/s].
    pub velocity: f64,
    /// Largest | |e| - 1 | of the bodies' Euler parameters [-].
    pub norm: f64,
}

impl Violation {
    /// The worse of two states, entry by entry; a number that is not finite stays visible.
    #[must_use]
    pub fn worse(self, other: Violation) -> Violation {
        Violation {
            position: larger(self.position, other.position),
            velocity: larger(self.velocity, other.velocity),
            norm: larger(self.norm, other.norm),
        }
    }
}

impl Prepared<'_> {
    /// How far the state (q, v) at time `t` \[s\] is from the constraints, evaluated afresh from g.
    pub fn violation(&self, t: f64, q: &[f64], v: &[f64]) -> Violation {
        let model = self.model();
        let mut worst = Violation::default();
        for joint in &model.constraints {
            let gather = |x: &[f64]| -> Vec<f64> {
                joint.nodes.iter().flat_map(|node| &x[model.nodes[node.0].dofs.clone()]).copied().collect()
            };
            let (q, v) = (gather(q), gather(v));
            let zeros = vec![0.0; q.len()];
            let state = State { a: &zeros, v: &v, q: &q };
            let p = &self.mechanism.numbers.p[joint.parameters.clone()];
            for [value, rate, _] in joint.physics.motion(state, p, t) {
                worst.position = larger(worst.position, value.abs());
                worst.velocity = larger(worst.velocity, rate.abs());
            }
        }
        for node in model.nodes.iter().filter(|node| node.kind == NodeKind::Body) {
            let length = Quaternion::from_slice(&q[node.dofs.start + 3..]).norm_squared().sqrt();
            worst.norm = larger(worst.norm, (length - 1.0).abs());
        }
        for node in model.nodes.iter().filter(|node| node.kind == NodeKind::Natural) {
            let mut g = [0.0; OrthonormalAxes::EQUATIONS];
            OrthonormalAxes.g(&q[node.dofs.clone()], &[], t, &mut g);
            worst.norm = g.iter().fold(worst.norm, |largest, g| larger(largest, g.abs()));
        }
        worst
    }
}
