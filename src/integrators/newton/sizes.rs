//! Sizes of unknowns and corrections that no unit changes.

use super::Newton;
use crate::assembly::{Equations, Level, Model, Residual, StageSystem, System, Unknowns, VectorsAvq};
use crate::elements::RunScalar;
use crate::integrators::lists::largest_scaled;
use crate::scalar::larger;

/// Displacement by the model's length that no state could show.
const UNSEEN: f64 = f64::EPSILON * f64::EPSILON;
/// Length that nothing has \[m\]: coordinates below it are what round-off left of zero.
const NO_LENGTH: f64 = 1e-20;
/// Coordinates that are smaller than this share of the lengths among the parameters say nothing about the size of the model.
const NEGLIGIBLE: f64 = 1e-9;

impl<S: RunScalar> Newton<'_, S> {
    /// Sets the scales of coordinates from the largest coordinate of a point in the model: sizes then do not depend on the unit of length.
    pub(in crate::integrators) fn set_coordinate_scales(&mut self, base: &VectorsAvq<S>, p: &[S]) {
        // a body whose frame stays at the origin has its length among the parameters
        let own = *self.parameter_length.get_or_insert_with(|| parameter_length(self.system.model, p));
        let length = turning_length(&self.system, &base.q, own);
        if length != self.turning_length {
            self.turning_length = length;
            self.system.set_turning_scales(length, &mut self.coordinate_scales);
        }
        self.length = self.size(&base.q).max(length);
    }

    /// Largest number of a list of all coordinates, each scaled.
    pub(in crate::integrators) fn size(&self, values: &[S]) -> f64 {
        largest_scaled(values, &self.coordinate_scales, |x, scale| x.value().abs() * scale)
    }

    /// Largest difference of two lists of all coordinates, each scaled.
    pub(in crate::integrators) fn distance(&self, one: &[S], other: &[S]) -> f64 {
        let differences = one.iter().zip(other).map(|(a, b)| (a.value() - b.value()).abs());
        differences.zip(&self.coordinate_scales).fold(0.0, |s: f64, (difference, scale)| s.max(difference * scale))
    }

    /// Largest multiplier, forces and moments alike in the scale of the factored matrix, which no unit changes.
    pub(super) fn multiplier_size(&self, unknowns: &Unknowns<S>) -> f64 {
        let scales = self.factorization.scales();
        self.system.multipliers_with_places(&unknowns.mu).fold(0.0, |largest: f64, (values, places)| {
            largest.max(largest_scaled(values, &scales[places], |x, scale| (x.value() / scale).abs()))
        })
    }

    /// Largest correction of a multiplier in the last solution, in the same scale.
    pub(super) fn multiplier_step(&self) -> f64 {
        let scales = self.factorization.scales();
        self.system.places_of_multipliers().fold(0.0, |largest: f64, places| {
            largest.max(largest_scaled(&self.rhs[places.clone()], &scales[places], |x, scale| (x / scale).abs()))
        })
    }

    /// Largest number of the residual evaluated last, or what is no number.
    pub(super) fn residual_size(&self) -> f64 {
        let Residual { f, g, .. } = &self.residual;
        f.iter().chain(g).fold(0.0, |size: f64, x| larger(size, x.value().abs()))
    }

    /// A correction of the unknowns as a displacement, by the model's length; 0 where coordinates are given.
    pub(super) fn displacement(&self, equations: &Equations, step: f64) -> f64 {
        step * equations.residual.alpha.abs().max(equations.constraint.alpha.abs()) / self.length
    }

    /// Whether a correction is zero in the scales of the model: what comes to rest has no size of its own.
    pub(super) fn is_nothing(&self, equations: &Equations, step: f64) -> bool {
        let moves = equations.residual.alpha != 0.0;
        step <= crate::tolerances::NOTHING || moves && self.displacement(equations, step) <= UNSEEN
    }

    /// Whether corrections of multipliers, in the scale of the matrix, are zero in the scales of the model beside those of coordinates that
    /// are: a force of that size would move none of them as far as any state could show. Reactions of what comes to rest without a load have
    /// no size of their own.
    pub(super) fn is_no_reaction(&mut self, equations: &Equations, reaction_step: f64, step: f64) -> bool {
        if equations.residual.alpha == 0.0 || !self.is_nothing(equations, step) {
            return false;
        }
        // scales of coordinates: an entry of theirs on the diagonal is of order 1, and so is that of a multiplier in their rows
        let Newton { exact, factorization, system, coordinate_scales, .. } = self;
        exact.copy_from_slice(factorization.scales());
        system.places_of_multipliers().for_each(|places| exact[places].fill(0.0));
        let lever = coordinate_scales.iter().fold(1.0, |most: f64, &scale| most.max(scale));
        let largest = exact.iter().fold(0.0, |most: f64, &scale| most.max(scale));
        self.displacement(equations, reaction_step * largest * lever) <= UNSEEN
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

/// By what coordinates that turn are multiplied: the largest coordinate of a point, or the largest of the parameters in metres, if that is not
/// negligible beside it.
fn turning_length<S: RunScalar>(system: &System, q: &[S], of_parameters: f64) -> f64 {
    let largest = system.largest_length(q);
    match of_parameters.max(largest) {
        length if length < NO_LENGTH => 1.0,
        _ if largest > NEGLIGIBLE * of_parameters => largest,
        _ => of_parameters,
    }
}

/// The scales of all coordinates at a place.
pub(crate) fn coordinate_scales(system: &System, q: &[f64], p: &[f64]) -> Vec<f64> {
    let length = turning_length(system, q, parameter_length(system.model, p));
    let mut scales = vec![1.0; system.model.dofs];
    system.set_turning_scales(length, &mut scales);
    scales
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
