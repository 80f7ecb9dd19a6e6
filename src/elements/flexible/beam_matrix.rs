//! Matrices of a beam's points, written out because they take most of the time of a scene with beams: a tenth of that of their
//! differentiation, which the contract tests hold against them.

use super::beam::{Reference, STRAINS};
use crate::scalar::{Quaternion, Vec3, tensor_times};

type Vector = Vec3<f64>;
/// Three rows towards four Euler parameters.
type Rows = [[f64; 4]; 3];

/// G(e), rows: G(e) d for a rate d.
#[inline(always)]
fn g_rows(e: Quaternion<f64>) -> Rows {
    let [a, x, y, z] = e.0;
    [[-x, a, z, -y], [-y, -z, a, x], [-z, y, -x, a]]
}

/// d(R(e) s)/de: rows of 2 (s (a de0 - u . du) + u (s . du) + du (u . s) + (de0 u + a du) x s).
#[inline(always)]
fn rotation_rows(e: Quaternion<f64>, s: Vector) -> Rows {
    let ([a, x, y, z], [p, q, r]) = (e.0, s.0);
    let along = x * p + y * q + z * r;
    [
        [2.0 * (a * p + y * r - z * q), 2.0 * along, 2.0 * (x * q - y * p + a * r), 2.0 * (x * r - z * p - a * q)],
        [2.0 * (a * q + z * p - x * r), 2.0 * (y * p - x * q - a * r), 2.0 * along, 2.0 * (y * r - z * q + a * p)],
        [2.0 * (a * r + x * q - y * p), 2.0 * (z * p - x * r + a * q), 2.0 * (z * q - y * r - a * p), 2.0 * along],
    ]
}

/// d(R(e)^T s)/de: the same for the opposite rotation.
#[inline(always)]
fn rotation_back_rows(e: Quaternion<f64>, s: Vector) -> Rows {
    let mut rows = rotation_rows(e.conjugate(), s);
    for row in &mut rows {
        for entry in &mut row[1..] {
            *entry = -*entry;
        }
    }
    rows
}

/// What a tying point's matrix depends on.
pub(super) struct Strained<'p> {
    /// (dr/dxi, e, de/dxi).
    pub h: &'p [f64],
    pub reference: Reference<f64>,
    /// EA, GA2, GA3, GJ, EI2, EI3, then, if there are more, the entries above the diagonal by rows.
    pub stiffness: &'p [f64],
    /// Section forces.
    pub stress: [f64; STRAINS],
}

/// Numbers of a tying point.
const N: usize = 11;

/// Adds `factor` d2V/dh2 of V = J/2 strain . C strain, row-major.
///
/// With strain = Lambda^T (R^T x, 2 G(e) d) / (J |e|^2) - (1, 0, ..), x = dr/dxi, d = de/dxi: J B^T C B, and the curvature of
/// w / |e|^2, w = x . R(e) nu + 2 mu . G(e) d for fixed (nu, mu) = Lambda stress.
#[inline(always)]
pub(super) fn add_strain_matrix(at: &Strained, factor: f64, matrix: &mut [f64]) {
    let (x, e, d) = (Vec3::from_slice(at.h), Quaternion::from_slice(&at.h[3..]), Quaternion::from_slice(&at.h[7..]));
    let inverse = 1.0 / e.norm_squared();
    let scale = inverse / at.reference.metric;
    let (back, turned) = (e.rotate_back(x), e.g_times(d));
    let (by_e, g_e, g_d) = (rotation_back_rows(e, x), g_rows(e), g_rows(d));
    let columns = e.columns();

    // B: strains towards (x, e, d)
    let mut b = [[0.0; N]; STRAINS];
    for (i, axis) in at.reference.axes.iter().enumerate() {
        let axis = axis.0;
        for k in 0..3 {
            // R^T dx: its rows are the columns of R
            b[i][k] = scale * (axis[0] * columns[0].0[k] + axis[1] * columns[1].0[k] + axis[2] * columns[2].0[k]);
        }
        let (mut of_back, mut of_turned) = (0.0, 0.0);
        for l in 0..3 {
            of_back += axis[l] * back.0[l];
            of_turned += axis[l] * turned.0[l];
        }
        for k in 0..4 {
            let (mut gamma, mut kappa, mut along) = (0.0, 0.0, 0.0);
            for l in 0..3 {
                gamma += axis[l] * by_e[l][k];
                kappa += axis[l] * g_d[l][k];
                along += axis[l] * g_e[l][k];
            }
            let shrink = 2.0 * inverse * e.0[k];
            b[i][3 + k] = scale * (gamma - shrink * of_back);
            b[3 + i][3 + k] = -2.0 * scale * (kappa + shrink * of_turned);
            b[3 + i][7 + k] = 2.0 * scale * along;
        }
    }
    // factor J C B
    let weight = factor * at.reference.metric;
    let mut cb = b;
    for i in 0..STRAINS {
        for k in 0..N {
            cb[i][k] *= weight * at.stiffness[i];
        }
    }
    if at.stiffness.len() > STRAINS {
        let mut entry = STRAINS;
        for i in 0..STRAINS {
            for j in i + 1..STRAINS {
                let c = weight * at.stiffness[entry];
                entry += 1;
                for k in 0..N {
                    cb[i][k] += c * b[j][k];
                    cb[j][k] += c * b[i][k];
                }
            }
        }
    }
    for i in 0..STRAINS {
        // gamma does not read d, kappa not x
        let (first, last) = if i < 3 { (0, 7) } else { (3, N) };
        for row in first..last {
            let left = b[i][row];
            for column in 0..N {
                matrix[row * N + column] += left * cb[i][column];
            }
        }
    }

    // curvature of w / |e|^2
    let [n1, n2, n3, m1, m2, m3] = at.stress;
    let (nu, mu) = (at.reference.combine([n1, n2, n3]), at.reference.combine([m1, m2, m3]));
    let pulled = e.rotate(nu);
    let by_nu = rotation_rows(e, nu);
    let (of_e, of_d) = (d.g_transposed_times(mu), e.g_transposed_times(mu));
    let w = pulled.dot(x) + 2.0 * turned.dot(mu);
    let mut gradient = [0.0; N];
    gradient[..3].copy_from_slice(&pulled.0);
    for k in 0..4 {
        gradient[3 + k] = x.0[0] * by_nu[0][k] + x.0[1] * by_nu[1][k] + x.0[2] * by_nu[2][k] - 2.0 * of_e[k];
        gradient[7 + k] = 2.0 * of_d[k];
    }
    let own = factor * inverse;
    // 2 S with x . R(e) nu = e . S e
    let (dot, cross) = (x.dot(nu), nu.cross(x));
    let mut second = [[0.0; 4]; 4];
    second[0][0] = dot;
    for i in 0..3 {
        second[0][1 + i] = cross.0[i];
        second[1 + i][0] = cross.0[i];
        for j in 0..3 {
            second[1 + i][1 + j] = x.0[i] * nu.0[j] + nu.0[i] * x.0[j] - if i == j { dot } else { 0.0 };
        }
    }
    // T with mu . G(e) d = e . T d
    let [a, b, c] = mu.0;
    let mixed = [[0.0, a, b, c], [-a, 0.0, -c, b], [-b, c, 0.0, -a], [-c, -b, a, 0.0]];
    for i in 0..4 {
        for k in 0..3 {
            let entry = own * by_nu[k][i];
            matrix[k * N + 3 + i] += entry;
            matrix[(3 + i) * N + k] += entry;
        }
        for j in 0..4 {
            matrix[(3 + i) * N + 3 + j] += 2.0 * own * second[i][j];
            let entry = 2.0 * own * mixed[i][j];
            matrix[(3 + i) * N + 7 + j] += entry;
            matrix[(7 + j) * N + 3 + i] += entry;
        }
    }
    let shrink = 2.0 * own * inverse;
    for i in 0..4 {
        let own = shrink * e.0[i];
        for k in 0..N {
            matrix[(3 + i) * N + k] -= own * gradient[k];
            matrix[k * N + 3 + i] -= own * gradient[k];
        }
        for j in 0..4 {
            matrix[(3 + i) * N + 3 + j] += 4.0 * inverse * own * w * e.0[j];
        }
        matrix[(3 + i) * N + 3 + i] -= shrink * w;
    }
}

/// Adds gamma dr/da + beta dr/dv + alpha dr/dq of a Gauss point (seven numbers r, e) whose mass centre lies on the line, row-major.
///
/// With omega = 2 G(e) e' / |e|^2, its rate, and M = J domega/dt + omega x J omega: (m a, 2 G(e)^T M / |e|^2).
#[inline(always)]
pub(super) fn add_inertia_matrix([a, v, h]: [&[f64]; 3], [gamma, beta, alpha]: [f64; 3], p: &[f64], matrix: &mut [f64]) {
    const N: usize = 7;
    let (e, rate) = (Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&v[3..]));
    let second = Quaternion::from_slice(&a[3..]);
    let inverse = 1.0 / e.norm_squared();
    let (g, g_rate, g_second) = (g_rows(e), g_rows(rate), g_rows(second));
    let omega = e.g_times(rate) * (2.0 * inverse);
    let swing = e.g_times(second) * (2.0 * inverse);
    let along = 2.0 * e.dot(rate) * inverse;
    let tensor = &p[4..];
    let momentum = tensor_times(tensor, omega);
    let moment = tensor_times(tensor, swing - omega * along) + omega.cross(momentum);
    let force = e.g_transposed_times(moment * (2.0 * inverse));
    for i in 0..3 {
        matrix[i * N + i] += gamma * p[0];
    }
    for k in 0..4 {
        let column = |rows: &Rows| Vec3([rows[0][k], rows[1][k], rows[2][k]]);
        let shrink = 2.0 * alpha * inverse * e.0[k];
        let d_omega = (column(&g) * beta - column(&g_rate) * alpha) * (2.0 * inverse) - omega * shrink;
        let d_swing = (column(&g) * gamma - column(&g_second) * alpha) * (2.0 * inverse) - swing * shrink;
        let d_along = 2.0 * (alpha * rate.0[k] + beta * e.0[k]) * inverse - along * shrink;
        let d_spin = d_swing - d_omega * along - omega * d_along;
        let d_moment = tensor_times(tensor, d_spin) + d_omega.cross(momentum) + omega.cross(tensor_times(tensor, d_omega));
        let turned = e.g_transposed_times(d_moment * (2.0 * inverse));
        // G(unit k)^T M
        let mut unit = Quaternion([0.0; 4]);
        unit.0[k] = alpha;
        let of_unit = unit.g_transposed_times(moment * (2.0 * inverse));
        for i in 0..4 {
            matrix[(3 + i) * N + 3 + k] += turned[i] + of_unit[i] - shrink * force[i];
        }
    }
}
