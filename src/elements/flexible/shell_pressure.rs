use super::biquadratic::{GAUSS_POINTS, NODES, SURFACE_POINTS, gauss_weight};
use crate::elements::forces::LoadFrame;
use crate::elements::{Field, Flexible, Interpolation, NodeKind, Parameter, TimeFunction};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// A pressure f(t) [N/m2] on a shell, along its normal, at three by three Gauss points.
///
/// Dead: the force f N dA on each area of the reference. Follower: f n da = f x,r cross x,s dr ds on the deformed surface. It pushes to
/// where the normal points. Around a closed volume V the follower does the work f dV, and its forces have no resultant.
///
/// Parameters:
/// * of a dead load, at each Gauss point: `area x, y, z`  N dA, in the world \[m2\]
/// * parameters of f(t) [N/m2]
pub struct ShellPressureField {
    /// Dead in the world, or follower with the body.
    pub frame: LoadFrame,
    /// Size over time.
    pub size: TimeFunction,
}

/// The pressure as an element.
pub type ShellPressure = Flexible<ShellPressureField>;

impl ShellPressureField {
    /// Number of parameters before those of f(t).
    fn areas(&self) -> usize {
        if self.frame == LoadFrame::World { 3 * GAUSS_POINTS } else { 0 }
    }
}

impl Field for ShellPressureField {
    const NODES: usize = NODES;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] = &SURFACE_POINTS;

    fn parameters(&self) -> Vec<Parameter> {
        let named = |point: usize, axis: &str| Parameter::named(format!("Gauss point {point}: area {axis}"), "m2");
        let areas = (1..=GAUSS_POINTS).flat_map(|point| ["x", "y", "z"].map(|axis| named(point, axis)));
        areas.take(self.areas()).chain(self.size.parameters("N/m2")).collect()
    }
    fn parameters_of(&self, _point: usize) -> Range<usize> {
        0..self.areas() + self.size.parameters("N/m2").len()
    }
    fn add_force<S: Scalar>(&self, point: usize, _v: &[S], h: &[S], p: &[S], t: S, force: &mut [S]) {
        let area = match self.frame {
            LoadFrame::World => Vector3::first_three(&p[3 * point..]),
            LoadFrame::Body => {
                Vector3::first_three(&h[3..]).cross(&Vector3::first_three(&h[6..])) * S::from(gauss_weight(point))
            }
        };
        let load = area * self.size.value(t, &p[self.areas()..]);
        for (force, load) in force.iter_mut().zip(load.components()) {
            *force += load;
        }
    }
    fn breakpoints(&self, p: &[f64]) -> Vec<f64> {
        self.size.breakpoints(&p[self.areas()..])
    }
}
