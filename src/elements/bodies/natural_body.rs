use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A rigid body in natural coordinates: position r of its frame and its axes u, v, w, whose mass matrix is constant.
///
/// With the velocity of a body point dr/dt + E' s, E = [u v w],
///
/// T = m/2 |dr/dt|^2 + m dr/dt . E' c + 1/2 sum over i, j of P_ij e_i' . e_j',   P = J_E + m c c^T,   J_E = tr(J)/2 1 - J,
///
/// where P is the second moment of mass about the origin of the frame, m c the first, and e_1..e_3 are the axes; R = M a. For c = 0 and
/// principal axes M is diagonal with m and (J2 + J3 - J1)/2, (J1 + J3 - J2)/2, (J1 + J2 - J3)/2.
///
/// * `mass`  m \[kg\], 0 or greater
/// * `centre x, y, z`  c, mass centre in the body frame \[m\]
/// * `inertia xx, yy, zz, xy, xz, yz`  J, about the mass centre, body axes [kg m2]; products with the sign of the tensor entry
///
/// Source: Ebrahimi et al., eqs. (39), (60), (61).
#[derive(Hash)]
pub struct NaturalBody;

impl NaturalBody {
    /// Moments of mass of orders 0, 1 and 2 about the origin: m, m c and P with index 0 for the origin, 1 to 3 for the axes.
    #[inline(always)]
    fn moments<S: Scalar>(p: &[S]) -> [[S; 4]; 4] {
        let (mass, centre, half) = (p[0], &p[1..4], S::from(0.5));
        let (xx, yy, zz) = (p[4], p[5], p[6]);
        let euler = [
            [(yy + zz - xx) * half, -p[7], -p[8]],
            [-p[7], (xx + zz - yy) * half, -p[9]],
            [-p[8], -p[9], (xx + yy - zz) * half],
        ];
        let mut moments = [[mass; 4]; 4];
        for i in 0..3 {
            moments[0][i + 1] = mass * centre[i];
            moments[i + 1][0] = mass * centre[i];
            for j in 0..3 {
                moments[i + 1][j + 1] = euler[i][j] + mass * centre[i] * centre[j];
            }
        }
        moments
    }
}

/// 1/2 sum over i, j of M_ij v_i . v_j for the rates of four vectors.
#[inline(always)]
pub(in crate::elements) fn kinetic_of_vectors<S: Scalar>(matrix: &[[S; 4]; 4], v: &[S]) -> S {
    let mut twice = S::zero();
    for i in 0..4 {
        for j in 0..4 {
            let product = v[3 * i] * v[3 * j] + v[3 * i + 1] * v[3 * j + 1] + v[3 * i + 2] * v[3 * j + 2];
            twice += matrix[i][j] * product;
        }
    }
    twice * 0.5
}

impl Element for NaturalBody {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Natural]
    }
    fn parameters(&self) -> Vec<Parameter> {
        super::rigid_body::inertia_parameters()
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S]) -> S {
        kinetic_of_vectors(&Self::moments(p), v)
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0]
    }
}
