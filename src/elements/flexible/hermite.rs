//! Cubic Hermite functions of two nodes with position and slope, on xi = x / l from 0 to 1, and where they are used.

use crate::elements::field::rows;
use crate::elements::{Interpolation, NodeKind};

/// Nodes of a cubic line.
pub const NODES: usize = 2;
/// Coordinates of a node.
pub const COMPONENTS: usize = NodeKind::Slope.dofs();

/// Values of the functions of (r_1, r_1x, r_2, r_2x); those of the slopes times l.
pub const fn values(xi: f64) -> [f64; 4] {
    let (square, cube) = (xi * xi, xi * xi * xi);
    [1.0 - 3.0 * square + 2.0 * cube, xi - 2.0 * square + cube, 3.0 * square - 2.0 * cube, cube - square]
}

/// First derivatives with respect to xi.
pub const fn slopes(xi: f64) -> [f64; 4] {
    let square = xi * xi;
    [6.0 * square - 6.0 * xi, 1.0 - 4.0 * xi + 3.0 * square, 6.0 * xi - 6.0 * square, 3.0 * square - 2.0 * xi]
}

/// Second derivatives.
pub const fn curvatures(xi: f64) -> [f64; 4] {
    [12.0 * xi - 6.0, 6.0 * xi - 4.0, 6.0 - 12.0 * xi, 6.0 * xi - 2.0]
}

/// Gauss quadrature on (0, 1) with three points: sqrt(3/5) on both sides of the middle.
pub const THREE: [f64; 3] = [0.112_701_665_379_258_3, 0.5, 0.887_298_334_620_741_7];
/// Its weights.
pub const THREE_WEIGHTS: [f64; 3] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
/// Gauss quadrature on (0, 1) with two points; both weights are 1/2.
pub const TWO: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Weights of positions and of slopes in a number at a point.
pub(super) type Weights = [[f64; NODES]; 2];

const fn split([of_first, of_first_slope, of_second, of_second_slope]: [f64; 4]) -> Weights {
    [[of_first, of_second], [of_first_slope, of_second_slope]]
}

pub(super) const SLOPES_AT_THREE: [Weights; 3] = [split(slopes(THREE[0])), split(slopes(THREE[1])), split(slopes(THREE[2]))];
pub(super) const CURVATURES_AT_THREE: [Weights; 3] =
    [split(curvatures(THREE[0])), split(curvatures(THREE[1])), split(curvatures(THREE[2]))];
const CURVATURES_AT_TWO: [Weights; 2] = [split(curvatures(TWO[0])), split(curvatures(TWO[1]))];

/// The six numbers whose combination is a derivative of r: the share of positions, then that of slopes.
const fn derivative_rows(weights: &'static Weights) -> [Interpolation; 6] {
    rows(&[(0, 3, &weights[0]), (3, 3, &weights[1])])
}

/// Second derivatives at two points.
pub const BENDING_AT_TWO: [[Interpolation; 6]; 2] =
    [derivative_rows(&CURVATURES_AT_TWO[0]), derivative_rows(&CURVATURES_AT_TWO[1])];
/// r_2 - r_1.
pub const CHORD: [Interpolation; 3] = rows(&[(0, 3, &[-1.0, 1.0])]);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_reproduced_with_their_derivatives_and_gauss_points_integrate() {
        for xi in THREE.into_iter().chain(TWO).chain([0.0, 1.0]) {
            for power in 0..4 {
                // x^n has these values and slopes at both ends
                let ends = [if power == 0 { 1.0 } else { 0.0 }, if power == 1 { 1.0 } else { 0.0 }, 1.0, f64::from(power)];
                let sum = |functions: [f64; 4]| functions.iter().zip(ends).map(|(f, end)| f * end).sum::<f64>();
                let derivative = |times: i32| {
                    let factor: f64 = (0..times).map(|k| f64::from(power - k)).product();
                    if power < times { 0.0 } else { factor * xi.powi(power - times) }
                };
                for (functions, times) in [(values(xi), 0), (slopes(xi), 1), (curvatures(xi), 2)] {
                    assert!((sum(functions) - derivative(times)).abs() < 1e-14);
                }
            }
        }
        for power in 0..6 {
            let exact = 1.0 / f64::from(power + 1);
            let three: f64 = THREE.iter().zip(THREE_WEIGHTS).map(|(x, w)| w * x.powi(power)).sum();
            assert!((three - exact).abs() < 1e-15);
            if power < 4 {
                assert!((TWO.iter().map(|x| 0.5 * x.powi(power)).sum::<f64>() - exact).abs() < 1e-15);
            }
        }
    }
}
