//! Sizes of unknowns and corrections that no unit changes.

use super::Newton;
use crate::assembly::{Equations, Level, Model, Node, StageSystem, VectorsAvq};
use crate::elements::{NodeKind, RunScalar};

/// Correction beyond which nothing is round-off, as a displacement by the model's length.
pub(super) const NEAR: f64 = 1e-6;
/// Coordinates that are smaller than this share of the lengths among the parameters say nothing about the size of the model.
const NEGLIGIBLE: f64 = 1e-9;

impl<S: RunScalar> Newton<'_, S> {
    /// Sets the scales of coordinates from the largest coordinate of a point in the model: sizes then do not depend on the unit of length.
    pub(in crate::integrators) fn set_coordinate_scales(&mut self, base: &VectorsAvq<S>, p: &[S]) {
        let nodes = &self.system.model.nodes;
        let lengths = nodes.iter().filter(|node| node.kind != NodeKind::Coordinates(node.dofs.len()));
        let largest = lengths
            .flat_map(|node| &base.q[node.dofs.start..node.dofs.start + 3])
            .fold(0.0, |largest: f64, q| largest.max(q.value().abs()));
        // a body whose frame stays at the origin has its length among the parameters
        let own = *self.parameter_length.get_or_insert_with(|| parameter_length(self.system.model, p));
        let length = match own.max(largest) {
            0.0 => 1.0,
            _ if largest > NEGLIGIBLE * own => largest,
            _ => own,
        };
        let turning = |node: &&Node| matches!(node.kind, NodeKind::Body | NodeKind::Natural | NodeKind::Slope);
        for node in nodes.iter().filter(turning) {
            self.coordinate_scales[node.dofs.start + 3..node.dofs.end].fill(length);
        }
        self.length = self.size(&base.q).max(length);
    }

    /// Largest number of a list of all coordinates, each scaled.
    pub(in crate::integrators) fn size(&self, values: &[S]) -> f64 {
        values.iter().zip(&self.coordinate_scales).fold(0.0, |s: f64, (x, scale)| s.max(x.value().abs() * scale))
    }

    /// Largest difference of two lists of all coordinates, each scaled.
    pub(in crate::integrators) fn distance(&self, one: &[S], other: &[S]) -> f64 {
        let differences = one.iter().zip(other).map(|(a, b)| (a.value() - b.value()).abs());
        differences.zip(&self.coordinate_scales).fold(0.0, |s: f64, (difference, scale)| s.max(difference * scale))
    }

    /// A correction of the unknowns as a displacement, by the model's length; 0 where coordinates are given.
    pub(super) fn displacement(&self, equations: &Equations, step: f64) -> f64 {
        step * equations.residual.alpha.abs().max(equations.constraint.alpha.abs()) / self.length
    }

    /// For a projection: the factor from its unknowns to the projected state, and the size of that state.
    pub(super) fn projected_size(&self, StageSystem { equations, base, .. }: StageSystem<S>) -> Option<(f64, f64)> {
        let largest = |values: &[S]| self.size(values).max(f64::MIN_POSITIVE);
        match equations.level {
            Level::Position if equations.metric => Some((equations.constraint.alpha, largest(&base.q))),
            Level::Velocity if equations.metric => Some((equations.constraint.beta, largest(&base.v))),
            _ => None,
        }
    }
}

/// The largest of the parameters in metres: places of joints and masses, lengths.
fn parameter_length<S: RunScalar>(model: &Model, p: &[S]) -> f64 {
    let elements = model.elements.iter().map(|element| (element.physics.parameter_list(), &element.parameters));
    let joints = model.constraints.iter().map(|joint| (joint.physics.parameter_list(), &joint.parameters));
    let lengths = elements.chain(joints).flat_map(|(list, places)| {
        let places = places.clone().zip(list);
        places.filter(|(_, parameter)| parameter.unit == "m").map(|(place, _)| p[place].value().abs())
    });
    lengths.fold(0.0, f64::max)
}
