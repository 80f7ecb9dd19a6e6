//! Shape functions of three nodes at xi = -1, 0, 1, and where they are used.

use crate::elements::Interpolation;
use crate::elements::field::rows;
use crate::scalar::{Scalar, Vector3};

/// Nodes of a quadratic line.
pub const NODES: usize = 3;

/// Values N_i(xi).
pub const fn values(xi: f64) -> [f64; NODES] {
    [0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)]
}

/// Derivatives dN_i/dxi.
pub const fn slopes(xi: f64) -> [f64; NODES] {
    [xi - 0.5, -2.0 * xi, xi + 0.5]
}

/// Places of two-point Gauss quadrature, 1 / sqrt 3; both weights are 1.
pub const TWO: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];
/// Places of three-point Gauss quadrature, sqrt(3/5).
pub const THREE: [f64; 3] = [-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4];
/// Its weights.
pub const THREE_WEIGHTS: [f64; 3] = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];

const SLOPES_AT_TWO: [[f64; NODES]; 2] = [slopes(TWO[0]), slopes(TWO[1])];
const VALUES_AT_TWO: [[f64; NODES]; 2] = [values(TWO[0]), values(TWO[1])];
const VALUES_AT_THREE: [[f64; NODES]; 3] = [values(THREE[0]), values(THREE[1]), values(THREE[2])];

/// (dr/dxi, e, de/dxi) of nodes with position r and Euler parameters e.
const fn strain_rows(n: &'static [f64], slopes: &'static [f64]) -> [Interpolation; 11] {
    rows(&[(0, 3, slopes), (3, 4, n), (3, 4, slopes)])
}

/// (r, e).
const fn place_rows(n: &'static [f64]) -> [Interpolation; 7] {
    rows(&[(0, 7, n)])
}

/// (dr/dxi, e, de/dxi) at the tying points.
pub const AT_TYING_POINTS: [[Interpolation; 11]; 2] =
    [strain_rows(&VALUES_AT_TWO[0], &SLOPES_AT_TWO[0]), strain_rows(&VALUES_AT_TWO[1], &SLOPES_AT_TWO[1])];

/// (r, e) at three Gauss points.
pub const AT_GAUSS_POINTS: [[Interpolation; 7]; 3] =
    [place_rows(&VALUES_AT_THREE[0]), place_rows(&VALUES_AT_THREE[1]), place_rows(&VALUES_AT_THREE[2])];

/// Sum of points with weights.
pub fn weighed<S: Scalar>(points: &[Vector3<S>], weights: &[f64]) -> Vector3<S> {
    points.iter().zip(weights).fold(Vector3::zeros(), |sum, (&point, &weight)| sum + point * S::from(weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_reproduce_quadratics_and_gauss_points_integrate_them() {
        let nodes = [-1.0, 0.0, 1.0];
        for xi in TWO.into_iter().chain(THREE) {
            for power in 0..3 {
                let value: f64 = values(xi).iter().zip(nodes).map(|(n, x): (&f64, f64)| n * x.powi(power)).sum();
                let slope: f64 = slopes(xi).iter().zip(nodes).map(|(n, x): (&f64, f64)| n * x.powi(power)).sum();
                assert!((value - xi.powi(power)).abs() < 1e-15);
                assert!((slope - f64::from(power) * xi.powi((power - 1).max(0))).abs() < 1e-15);
            }
        }
        for power in 0..6 {
            let exact = if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 };
            let three: f64 = THREE.iter().zip(THREE_WEIGHTS).map(|(x, w)| w * x.powi(power)).sum();
            assert!((three - exact).abs() < 1e-15);
            if power < 4 {
                assert!((TWO.iter().map(|x| x.powi(power)).sum::<f64>() - exact).abs() < 1e-15);
            }
        }
    }
}
