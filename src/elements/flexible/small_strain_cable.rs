use super::cable::elastic_parameters;
use super::hermite::{BENDING_AT_TWO, CHORD, NODES};
use crate::elements::{Field, Flexible, Interpolation, NodeKind, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// The cable of [`Cable`](super::Cable) for small strains:
///
/// V = EA l/2 eps^2 + integral of EI/2 kappa^2 dx,   eps = |r_2 - r_1| / l - 1,   kappa = |r_xx|,
///
/// so that the strain is constant in the element and bending has a constant stiffness matrix. Bending is integrated exactly by two Gauss
/// points. An element bent by the angle phi seems shortened by phi^2 / 24: keep elements short.
///
/// * `length`, `axial stiffness`, `bending stiffness`  as there
///
/// Source: Ebrahimi et al., eqs. (31), (33); the transverse matrix of (59) with the factor EI / l^3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SmallStrainCableField;

/// The cable for small strains as an element.
pub type SmallStrainCable = Flexible<SmallStrainCableField>;

/// r_xx from the shares of positions and slopes.
#[inline(always)]
fn second_derivative<S: Scalar>(h: &[S], length: S) -> Vector3<S> {
    let inverse = length.recip();
    (Vector3::first_three(h) * inverse + Vector3::first_three(&h[3..])) * inverse
}

impl Field for SmallStrainCableField {
    const NODES: usize = NODES;
    const NODE: NodeKind = NodeKind::Slope;
    const POINTS: &'static [&'static [Interpolation]] = &[&CHORD, &BENDING_AT_TWO[0], &BENDING_AT_TWO[1]];

    fn parameters(&self) -> Vec<Parameter> {
        elastic_parameters()
    }
    fn parameters_of(&self, _point: usize) -> Range<usize> {
        0..3
    }
    #[inline(always)]
    fn strain_energy<S: Scalar>(&self, point: usize, h: &[S], p: &[S]) -> S {
        if point == 0 {
            return S::zero();
        }
        let curvature = second_derivative(h, p[0]);
        curvature.dot(&curvature) * p[0] * p[2] * 0.25
    }
    fn strain_count(&self, point: usize) -> usize {
        if point == 0 { 1 } else { 0 }
    }
    #[inline(always)]
    fn strains<S: Scalar>(&self, _point: usize, h: &[S], p: &[S], e: &mut [S]) {
        e[0] = Vector3::first_three(h).length() / p[0] - 1.0;
    }
    #[inline(always)]
    fn stored<S: Scalar>(&self, _point: usize, e: &[S], p: &[S]) -> S {
        let Some(strain) = e.first() else { return S::zero() };
        *strain * *strain * p[0] * p[1] * 0.5
    }
}
