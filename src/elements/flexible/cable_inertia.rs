use super::hermite::NODES;
use crate::elements::bodies::kinetic_of_vectors;
use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::Scalar;

/// Inertia of a cable element: R = M a with the constant matrix M = m l times the integral of S^T S, which is exact.
///
/// * `length`  l \[m\], greater than 0
/// * `mass`  m, for each length [kg/m], greater than 0
///
/// Source: Ebrahimi et al., eqs. (30), (58).
#[derive(Hash)]
pub struct CableInertia;

/// 420 times the integrals of products of the Hermite functions; each slope brings a factor l.
const PRODUCTS: [[f64; 4]; 4] =
    [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0], [54.0, 13.0, 156.0, -22.0], [-13.0, -3.0, -22.0, 4.0]];

/// Entries of M between (r_1, r_1x, r_2, r_2x), from length and mass.
#[inline(always)]
fn mass_matrix<S: Scalar>(p: &[S]) -> [[S; 4]; 4] {
    let (length, share) = (p[0], p[0] * p[1] / 420.0);
    let factors = [S::one(), length, S::one(), length];
    let mut matrix = [[share; 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            matrix[i][j] = share * factors[i] * factors[j] * PRODUCTS[i][j];
        }
    }
    matrix
}

impl Element for CableInertia {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("length", "m"), Parameter::positive("mass", "kg/m")];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Slope; NODES]
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S]) -> S {
        kinetic_of_vectors(&mass_matrix(p), v)
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0] * p[1]
    }
}
