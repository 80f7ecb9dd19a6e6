//! Shape functions of nine nodes at (r, s) in {-1, 0, 1} x {-1, 0, 1}, r first, and where shells use them.

use super::shape::{THREE, THREE_WEIGHTS, TWO, slopes, values};
use crate::elements::Interpolation;

/// Nodes: node 3 b + a + 1 stands at r = a - 1, s = b - 1.
pub const NODES: usize = 9;

/// Numbers that are interpolated of each node: position x, director d, and two more axes.
pub const NUMBERS: usize = 12;

/// Points of three-by-three Gauss quadrature.
pub const GAUSS_POINTS: usize = 9;

/// N_i and its derivatives at one point.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// N_i.
    pub value: [f64; NODES],
    /// dN_i/dr.
    pub by_r: [f64; NODES],
    /// dN_i/ds.
    pub by_s: [f64; NODES],
}

const fn product(of_r: [f64; 3], of_s: [f64; 3]) -> [f64; NODES] {
    let mut weights = [0.0; NODES];
    let mut node = 0;
    while node < NODES {
        weights[node] = of_r[node % 3] * of_s[node / 3];
        node += 1;
    }
    weights
}

/// Shape functions at (r, s).
pub const fn weights(r: f64, s: f64) -> Weights {
    Weights {
        value: product(values(r), values(s)),
        by_r: product(slopes(r), values(s)),
        by_s: product(values(r), slopes(s)),
    }
}

/// Shape functions at all pairs of some r and s, r first.
const fn grid<const R: usize, const N: usize>(r: [f64; R], s: &[f64]) -> [Weights; N] {
    let mut all = [weights(0.0, 0.0); N];
    let mut place = 0;
    while place < N {
        all[place] = weights(r[place % R], s[place / R]);
        place += 1;
    }
    all
}

/// At the tying points of strains along r: two along r, three along s.
pub static TYING_R: [Weights; 6] = grid(TWO, &THREE);
/// At the tying points of strains along s: three along r, two along s.
pub static TYING_S: [Weights; 6] = grid(THREE, &TWO);
/// At the Gauss points, three by three.
pub static GAUSS: [Weights; GAUSS_POINTS] = grid(THREE, &THREE);
/// At the nodes.
pub static AT_NODES: [Weights; NODES] = grid([-1.0, 0.0, 1.0], &[-1.0, 0.0, 1.0]);

/// Weight of a Gauss point.
pub fn gauss_weight(point: usize) -> f64 {
    THREE_WEIGHTS[point % 3] * THREE_WEIGHTS[point / 3]
}

/// Weights of Lobatto quadrature at the nodes.
pub const LOBATTO: [f64; 3] = [1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0];

/// The three components of a vector that starts at `component`.
const fn vector(component: usize, weights: &'static [f64; NODES]) -> [Interpolation; 3] {
    [
        Interpolation { component, weights },
        Interpolation { component: component + 1, weights },
        Interpolation { component: component + 2, weights },
    ]
}

const fn rows<const N: usize, const V: usize>(vectors: [[Interpolation; 3]; V]) -> [Interpolation; N] {
    let mut rows = [vectors[0][0]; N];
    let mut place = 0;
    while place < N {
        rows[place] = vectors[place / 3][place % 3];
        place += 1;
    }
    rows
}

/// Places of x, d and the two more axes in a node's numbers.
const X: usize = 0;
const D: usize = 3;
const FIRST: usize = 6;
const SECOND: usize = 9;

/// (dx/dr, d, dd/dr) at a point.
const fn along_r(w: &'static Weights) -> [Interpolation; 9] {
    rows([vector(X, &w.by_r), vector(D, &w.value), vector(D, &w.by_r)])
}
/// (dx/ds, d, dd/ds).
const fn along_s(w: &'static Weights) -> [Interpolation; 9] {
    rows([vector(X, &w.by_s), vector(D, &w.value), vector(D, &w.by_s)])
}
/// (x, d, dx/dr, dx/ds, dd/dr, dd/ds).
const fn place(w: &'static Weights) -> [Interpolation; 18] {
    rows([
        vector(X, &w.value),
        vector(D, &w.value),
        vector(X, &w.by_r),
        vector(X, &w.by_s),
        vector(D, &w.by_r),
        vector(D, &w.by_s),
    ])
}
/// (x, dx/dr, dx/ds).
const fn on_surface(w: &'static Weights) -> [Interpolation; 9] {
    rows([vector(X, &w.value), vector(X, &w.by_r), vector(X, &w.by_s)])
}
/// (dx/dr, dx/ds, first axis, second axis).
const fn turn(w: &'static Weights) -> [Interpolation; 12] {
    rows([vector(X, &w.by_r), vector(X, &w.by_s), vector(FIRST, &w.value), vector(SECOND, &w.value)])
}

/// A table of rows at all points of a grid.
macro_rules! table {
    ($name:ident: $rows:ident at $grid:ident, $width:literal x $count:literal) => {
        static $name: [[Interpolation; $width]; $count] = {
            let mut all = [$rows(&$grid[0]); $count];
            let mut point = 0;
            while point < $count {
                all[point] = $rows(&$grid[point]);
                point += 1;
            }
            all
        };
    };
}
table!(ROWS_R: along_r at TYING_R, 9 x 6);
table!(ROWS_S: along_s at TYING_S, 9 x 6);
table!(ROWS_GAUSS: place at GAUSS, 18 x 9);
table!(ROWS_NODES: turn at AT_NODES, 12 x 9);
table!(ROWS_SURFACE: on_surface at GAUSS, 9 x 9);

/// What loads on a surface interpolate at each Gauss point: (x, dx/dr, dx/ds).
pub static SURFACE_POINTS: [&[Interpolation]; GAUSS_POINTS] = {
    let mut all: [&[Interpolation]; GAUSS_POINTS] = [&[]; GAUSS_POINTS];
    let mut point = 0;
    while point < GAUSS_POINTS {
        all[point] = &ROWS_SURFACE[point];
        point += 1;
    }
    all
};

/// Number of points: tying points along r and along s, Gauss points, and nodes.
pub const POINTS: usize = 30;
/// First tying point along s.
pub const FIRST_S: usize = 6;
/// First Gauss point.
pub const FIRST_GAUSS: usize = 12;
/// First node.
pub const FIRST_NODE: usize = 21;

/// What is interpolated at each point of a shell.
pub static SHELL_POINTS: [&[Interpolation]; POINTS] = {
    let mut all: [&[Interpolation]; POINTS] = [&[]; POINTS];
    let mut point = 0;
    while point < POINTS {
        all[point] = if point < FIRST_S {
            &ROWS_R[point]
        } else if point < FIRST_GAUSS {
            &ROWS_S[point - FIRST_S]
        } else if point < FIRST_NODE {
            &ROWS_GAUSS[point - FIRST_GAUSS]
        } else {
            &ROWS_NODES[point - FIRST_NODE]
        };
        point += 1;
    }
    all
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_reproduce_biquadratics_and_their_slopes() {
        let all = TYING_R.iter().chain(&TYING_S).chain(&GAUSS).chain(&AT_NODES);
        let places =
            |r: &[f64], s: &[f64]| -> Vec<(f64, f64)> { s.iter().flat_map(|&s| r.iter().map(move |&r| (r, s))).collect() };
        let ends = [-1.0, 0.0, 1.0];
        let at = [places(&TWO, &THREE), places(&THREE, &TWO), places(&THREE, &THREE), places(&ends, &ends)];
        let mut checked = 0;
        for (w, (r, s)) in all.zip(at.concat()) {
            let sum = |weights: &[f64; NODES], f: &dyn Fn(f64, f64) -> f64| -> f64 {
                (0..NODES).map(|i| weights[i] * f((i % 3) as f64 - 1.0, (i / 3) as f64 - 1.0)).sum()
            };
            for (m, n) in [(0, 0), (1, 0), (0, 1), (1, 2), (2, 1), (2, 2)] {
                let f = |r: f64, s: f64| r.powi(m) * s.powi(n);
                let slope = |x: f64, m: i32| f64::from(m) * x.powi((m - 1).max(0));
                assert!((sum(&w.value, &f) - f(r, s)).abs() < 1e-15);
                assert!((sum(&w.by_r, &f) - slope(r, m) * s.powi(n)).abs() < 2e-15);
                assert!((sum(&w.by_s, &f) - r.powi(m) * slope(s, n)).abs() < 2e-15);
            }
            checked += 1;
        }
        assert_eq!(checked, POINTS);
    }
}
