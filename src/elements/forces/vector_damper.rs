use super::line_damper::{DAMPER_EXAMPLE, DAMPER_KEYS, damper_parameters, held};
use crate::elements::entries::{Entry, Example, Given, Key};
use crate::elements::joints::gap;
use crate::elements::{Element, NodeKind, NodePair, Output, Parameter};
use crate::scalar::{Scalar, SpatialVector};

/// A damper on the whole relative velocity of two points: force c (dx_b/dt - dx_a/dt) \[N\].
///
/// * `damping`  c [N s/m], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies \[m\]
///
/// Source: Ebrahimi et al., eq. (65). [`LineDamper`](super::LineDamper) acts along the line only.
#[derive(Hash)]
pub struct VectorDamper(pub NodePair);

impl Element for VectorDamper {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        damper_parameters()
    }
    fn strain_count(&self) -> usize {
        3
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e.copy_from_slice(&gap(self.0, q, &p[1..]).components());
    }
    fn outputs(&self) -> Vec<Output> {
        let along = |axis| {
            [("distance", "m"), ("rate", "m/s"), ("force", "N")]
                .map(|(name, unit)| Output::new(format!("{name}_{axis}"), unit))
        };
        ["x", "y", "z"].into_iter().flat_map(along).collect()
    }
    fn damping<S: Scalar>(&self, _e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        for (s, &rate) in s.iter_mut().zip(rate) {
            *s = p[0] * rate;
        }
    }
}

impl Entry for VectorDamper {
    type Law = Self;
    const NAME: &'static str = "vector";
    const DOC: &'static str = "on the whole relative velocity of two points";
    const KEYS: &'static [Key] = DAMPER_KEYS;
    const EXAMPLE: Example = DAMPER_EXAMPLE;

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (nodes, p) = held(given);
        (VectorDamper(nodes), p)
    }
}
