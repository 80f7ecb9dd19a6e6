//! Matrix and products of a cable without damping, written out because they take most of the time of a scene with cables: the contract tests
//! hold them against its differentiated residual.

use super::cable::{AXIAL, BENDING, Cable, LENGTH, Line, MASS, WEIGHTS, derivatives, green_strain, line};
use super::cable_inertia::mass_matrix;
use super::hermite::{COMPONENTS, NODES, THREE_WEIGHTS};
use crate::elements::{ByPoints, Element, PointWork, State, Wide};
use crate::scalar::{Job, Lanes, Vector3, widest};

/// Derivatives of a [`Cable`] without damping.
pub(super) struct CableDerivatives;

const DOFS: usize = NODES * COMPONENTS;

type Block = [[f64; 3]; 3];

/// Adds factor u v^T.
#[inline(always)]
fn add_product(block: &mut Block, factor: f64, u: Vector3<f64>, v: Vector3<f64>) {
    for i in 0..3 {
        for j in 0..3 {
            block[i][j] += factor * u[i] * v[j];
        }
    }
}

/// d2V/d(a, b)2 of the energy at a Gauss point, without its weight: blocks (a, a), (a, b), (b, b), a = r_x, b = r_xx.
///
/// With s = a . a, d = a . b, t = b . b: eps = (s - 1) / 2 and kappa^2 = t / s^2 - d^2 / s^3.
#[inline(always)]
fn second_derivatives(a: Vector3<f64>, b: Vector3<f64>, axial: f64, bending: f64) -> [Block; 3] {
    let (s, d, t) = (a.dot(&a), a.dot(&b), b.dot(&b));
    let inverse = 1.0 / s;
    let cube = inverse * inverse * inverse;
    // of EI/2 kappa^2 towards s, d, t
    let half = 0.5 * bending * cube;
    let (by_s, by_d, by_t) = (half * (3.0 * d * d * inverse - 2.0 * t), -2.0 * half * d, half * s);
    let (by_ss, by_sd) = (half * inverse * (6.0 * t - 12.0 * d * d * inverse), 6.0 * half * d * inverse);
    let (by_st, by_dd) = (-2.0 * half, -2.0 * half);
    let mut blocks = [[[0.0; 3]; 3]; 3];
    for i in 0..3 {
        blocks[0][i][i] = axial * green_strain(a) + 2.0 * by_s;
        blocks[1][i][i] = by_d;
        blocks[2][i][i] = 2.0 * by_t;
    }
    // s goes with 2 a along a, d with b along a and with a along b, t with 2 b along b
    add_product(&mut blocks[0], axial + 4.0 * by_ss, a, a);
    add_product(&mut blocks[0], 2.0 * by_sd, a, b);
    add_product(&mut blocks[0], 2.0 * by_sd, b, a);
    add_product(&mut blocks[0], by_dd, b, b);
    add_product(&mut blocks[1], 2.0 * by_sd, a, a);
    add_product(&mut blocks[1], 4.0 * by_st, a, b);
    add_product(&mut blocks[1], by_dd, b, a);
    add_product(&mut blocks[2], by_dd, a, a);
    blocks
}

/// Places (row, column) of the blocks above and on the diagonal of the matrix of chord and slopes.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// The matrix to be written: in each column one vector for a node, position and slope.
struct Matrix<'j>(&'j [f64], [f64; 3], &'j [f64], &'j mut [Wide]);

impl Job for Matrix<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Matrix(q, [gamma, _, alpha], p, matrix) = self;
        let inverse = 1.0 / p[LENGTH];
        let own: Line<f64> = line(q, inverse);
        // towards chord and slopes
        let mut sums = [[[0.0; 3]; 3]; 6];
        for point in 0..3 {
            let [a, b] = derivatives(&own, point, inverse);
            let weight = alpha * p[LENGTH] * THREE_WEIGHTS[point];
            let [aa, ab, bb] = second_derivatives(a, b, weight * p[AXIAL], weight * p[BENDING]);
            let [of_a, of_b] = [WEIGHTS[point][0], WEIGHTS[point][1].map(|weight| weight * inverse)];
            for (sum, (row, column)) in sums.iter_mut().zip(PAIRS) {
                let factors =
                    [of_a[row] * of_a[column], of_a[row] * of_b[column], of_b[row] * of_a[column], of_b[row] * of_b[column]];
                for i in 0..3 {
                    for j in 0..3 {
                        sum[i][j] +=
                            factors[0] * aa[i][j] + factors[1] * ab[i][j] + factors[2] * ab[j][i] + factors[3] * bb[i][j];
                    }
                }
            }
        }
        // the chord to both nodes: with opposite signs, by the length
        let mut add = |row: usize, column: usize, factor: f64, block: &Block, transposed: bool| {
            for j in 0..3 {
                let target = &mut matrix[(3 * column + j) * NODES + row / 2].0[row % 2 * 3..][..3];
                for i in 0..3 {
                    target[i] += factor * if transposed { block[j][i] } else { block[i][j] };
                }
            }
        };
        const ENDS: [(usize, f64); 2] = [(0, -1.0), (2, 1.0)];
        for (row, sign) in ENDS {
            for (column, other) in ENDS {
                add(row, column, sign * other * inverse * inverse, &sums[0], false);
            }
            for (slope, block) in [(1, &sums[1]), (3, &sums[2])] {
                add(row, slope, sign * inverse, block, false);
                add(slope, row, sign * inverse, block, true);
            }
        }
        add(1, 1, 1.0, &sums[3], false);
        add(1, 3, 1.0, &sums[4], false);
        add(3, 1, 1.0, &sums[4], true);
        add(3, 3, 1.0, &sums[5], false);
        let inertia = mass_matrix(&[p[LENGTH], p[MASS]]);
        for (i, row) in inertia.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                for k in 0..3 {
                    matrix[(3 * j + k) * NODES + i / 2].0[i % 2 * 3 + k] += gamma * entry;
                }
            }
        }
    }
}

/// R with derivatives: along a vector in the first lane, towards each parameter in the others.
struct Along<'j>(&'j [f64], &'j [f64], &'j [f64], &'j [f64], &'j mut [Lanes; DOFS]);

impl Job for Along<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Along(a, q, along, p, r) = self;
        let mut lanes = [[Lanes::default(); DOFS]; 2];
        for i in 0..DOFS {
            lanes[0][i].re = a[i];
            lanes[1][i].re = q[i];
            lanes[1][i].eps[0] = along[i];
        }
        let mut numbers = [Lanes::default(); PARAMETERS];
        for (place, number) in numbers.iter_mut().enumerate() {
            number.re = p[place];
            number.eps[1 + place] = 1.0;
        }
        let state = State { a: &lanes[0], v: &[], q: &lanes[1] };
        Cable { damped: false }.residual(state, &numbers, Lanes::default(), r);
    }
}

/// Length, two stiffnesses, mass, gravity.
const PARAMETERS: usize = 7;

impl ByPoints for CableDerivatives {
    fn matrix<'w>(&self, s: State<f64>, shift: [f64; 3], p: &[f64], _t: f64, work: &'w mut PointWork) -> &'w [Wide] {
        let matrix = work.zeros(DOFS * NODES);
        widest(Matrix(s.q, shift, p, matrix));
        matrix
    }
    /// M and K are symmetric: K lambda is the change of R along lambda, which comes with those by the parameters.
    fn pull_back(&self, s: State<f64>, p: &[f64], _t: f64, lambdas: &[f64], _work: &mut PointWork, gradients: &mut [f64]) {
        let variables = gradients.len() * DOFS / lambdas.len();
        let inertia = mass_matrix(&[p[LENGTH], p[MASS]]);
        for (lambda, gradient) in lambdas.chunks_exact(DOFS).zip(gradients.chunks_exact_mut(variables)) {
            let mut r = [Lanes::default(); DOFS];
            widest(Along(s.a, s.q, lambda, p, &mut r));
            for (i, row) in inertia.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    for k in 0..3 {
                        gradient[3 * i + k] += entry * lambda[3 * j + k];
                    }
                }
            }
            let (_, of_coordinates) = gradient.split_at_mut(2 * DOFS);
            let (of_coordinates, of_parameters) = of_coordinates.split_at_mut(DOFS);
            for ((target, r), lambda) in of_coordinates.iter_mut().zip(&r).zip(lambda) {
                *target += r.eps[0];
                of_parameters.iter_mut().zip(&r.eps[1..]).for_each(|(bar, entry)| *bar += lambda * entry);
            }
        }
    }
}
