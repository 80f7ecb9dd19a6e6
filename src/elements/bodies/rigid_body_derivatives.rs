//! Matrix and products of a rigid body, written out because every scene has rigid bodies; the contract tests hold them against those by
//! differentiation.

use super::RigidBody;
use crate::elements::{Anchor, ByPoints, Element, PointWork, State, Wide};
use crate::scalar::{
    Job, Quaternion, SpatialVector, Vector3, g_form, g_rows, rotation_form, rotation_gradient_transposed, rotation_rows,
    tensor_gradient, tensor_times, tensor_times_rows, widest,
};

const DOFS: usize = RigidBody::DOFS;

/// Euler parameters, their rates and second derivatives.
#[inline(always)]
fn turning(s: State<f64>) -> [Quaternion<f64>; 3] {
    [s.q, s.v, s.a].map(|x| Quaternion::from_slice(&x[3..]))
}

#[inline(always)]
fn sum(terms: [(f64, Quaternion<f64>); 3]) -> Quaternion<f64> {
    let mut sum = [0.0; 4];
    for (factor, e) in terms {
        for i in 0..4 {
            sum[i] += factor * e.0[i];
        }
    }
    Quaternion(sum)
}

/// gamma dR/da + beta dR/dv + alpha dR/dq, column after column, to a matrix of zeros.
///
/// With B(e) = d(R c)/de, linear in e, a_c = r'' + B(e) e'' + B(e') e' and
///
/// R_e = B(e)^T m a_c + 4 G(e)^T J G(e) e'' + 8 G(e')^T J G(e) e'.
struct Matrix<'j>(State<'j, f64>, [f64; 3], &'j [f64], &'j mut [Wide]);

impl Job for Matrix<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Matrix(s, [gamma, beta, alpha], p, matrix) = self;
        let (mass, centre, tensor) = (p[0], Vector3::first_three(&p[1..]), &p[4..]);
        let [e, rate, second] = turning(s);
        let force = Anchor::Body.acceleration(s, centre) * mass;
        let by_e = rotation_rows(e, centre);
        let of_acceleration = rotation_rows(sum([(gamma, e), (2.0 * beta, rate), (alpha, second)]), centre);
        let (g, g_rate) = (g_rows(e), g_rows(rate));
        // J G along the two products
        let along = |x: Quaternion<f64>| tensor_times_rows(tensor, &g_rows(x));
        let spin = along(sum([(4.0 * gamma, e), (-4.0 * alpha, second), (0.0, e)]));
        let gyration = along(sum([(8.0 * beta, e), (-8.0 * alpha, rate), (0.0, e)]));
        let momenta =
            tensor_times(tensor, e.g_times(second)) * (4.0 * alpha) + tensor_times(tensor, e.g_times(rate)) * (8.0 * beta);
        let (curvature, skew) = (rotation_form(centre, force), g_form(momenta));
        for i in 0..3 {
            matrix[i].0[i] = gamma * mass;
            for k in 0..4 {
                matrix[i].0[3 + k] = gamma * mass * by_e[i][k];
                matrix[3 + k].0[i] = mass * of_acceleration[i][k];
            }
        }
        for k in 0..4 {
            let column = &mut matrix[3 + k].0;
            for j in 0..4 {
                let mut entry = 2.0 * alpha * curvature[j][k] - skew[j][k];
                for i in 0..3 {
                    entry +=
                        mass * by_e[i][j] * of_acceleration[i][k] + g[i][j] * spin[i][k] + g_rate[i][j] * gyration[i][k];
                }
                column[3 + j] = entry;
            }
        }
    }
}

fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    target.iter_mut().zip(values).for_each(|(target, value)| *target += factor * value);
}

/// Adds the gradient of lambda . R = w . m a_c + 4 delta . J G(e) e'' + 8 epsilon . J G(e) e', with w = lambda_r + B(e) lambda_e,
/// delta = G(e) lambda_e, epsilon = G(e') lambda_e.
fn add_products(s: State<f64>, p: &[f64], lambda: &[f64], gradient: &mut [f64]) {
    let (mass, centre, tensor) = (p[0], Vector3::first_three(&p[1..]), &p[4..]);
    let ([e, rate, second], turn) = (turning(s), Quaternion::from_slice(&lambda[3..]));
    let acceleration = Anchor::Body.acceleration(s, centre);
    let w = Vector3::first_three(lambda) + e.rotate_rate(turn, centre);
    let (delta, epsilon) = (e.g_times(turn), rate.g_times(turn));
    let (swing, omega) = (e.g_times(second), e.g_times(rate));
    let [j_delta, j_epsilon, j_swing, j_omega] = [delta, epsilon, swing, omega].map(|x| tensor_times(tensor, x));

    let (of_a, rest) = gradient.split_at_mut(DOFS);
    let (of_v, rest) = rest.split_at_mut(DOFS);
    let (of_q, of_p) = rest.split_at_mut(DOFS);
    add(of_a, mass, &w.components());
    add(&mut of_a[3..], mass, &rotation_gradient_transposed(e, centre, w));
    add(&mut of_a[3..], 4.0, &e.g_transposed_times(j_delta));
    add(&mut of_v[3..], 2.0 * mass, &rotation_gradient_transposed(rate, centre, w));
    add(&mut of_v[3..], 8.0, &e.g_transposed_times(j_epsilon));
    add(&mut of_v[3..], -8.0, &turn.g_transposed_times(j_omega));
    add(&mut of_q[3..], mass, &rotation_gradient_transposed(second, centre, w));
    add(&mut of_q[3..], mass, &rotation_gradient_transposed(turn, centre, acceleration));
    add(&mut of_q[3..], -4.0, &turn.g_transposed_times(j_swing));
    add(&mut of_q[3..], -4.0, &second.g_transposed_times(j_delta));
    add(&mut of_q[3..], -8.0, &rate.g_transposed_times(j_epsilon));
    if of_p.is_empty() {
        return;
    }
    // the other way round: R(e)^T = R of the opposite rotation
    let back = |x: Quaternion<f64>, y: Quaternion<f64>, f: Vector3<f64>| x.conjugate().rotate_rate(y.conjugate(), f);
    of_p[0] += w.dot(&acceleration);
    add(&mut of_p[1..4], mass, &(back(e, second, w) + back(rate, rate, w) + back(e, turn, acceleration)).components());
    add(&mut of_p[4..], 4.0, &tensor_gradient(delta, swing));
    add(&mut of_p[4..], 8.0, &tensor_gradient(epsilon, omega));
}

impl ByPoints for RigidBody {
    fn matrix<'w>(&self, s: State<f64>, shift: [f64; 3], p: &[f64], _t: f64, work: &'w mut PointWork) -> &'w [Wide] {
        let matrix = work.zeros(DOFS);
        widest(Matrix(s, shift, p, matrix));
        matrix
    }
    fn pull_back(&self, s: State<f64>, p: &[f64], _t: f64, lambdas: &[f64], _work: &mut PointWork, gradients: &mut [f64]) {
        let variables = gradients.len() * DOFS / lambdas.len();
        for (lambda, gradient) in lambdas.chunks_exact(DOFS).zip(gradients.chunks_exact_mut(variables)) {
            add_products(s, p, lambda, gradient);
        }
    }
}
