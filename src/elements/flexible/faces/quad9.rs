//! Quadrilaterals of nine nodes at (r, s) in {-1, 0, 1} x {-1, 0, 1}, r first: MITC9.

use super::*;
use crate::elements::flexible::shape::{THREE, THREE_WEIGHTS, slopes, values};

/// Nodes: node 3 b + a + 1 stands at r = a - 1, s = b - 1.
const NODES: usize = 9;
/// Points of three-by-three Gauss quadrature.
const GAUSS_POINTS: usize = 9;

/// A quadrilateral of nine nodes: node 3 b + a + 1 stands at r = a - 1, s = b - 1.
///
/// Strains along r are tied at r = -+1/sqrt(3), s = 0, -+sqrt(3/5), those along s at the places mirrored; the strain between is projected on
/// bilinear functions. Three by three Gauss points.
///
/// Source: Bucalem & Bathe (1993), MITC9.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Quad9;

impl Face for Quad9 {
    const KIND: FaceKind = FaceKind::Quad9;
    const SHAPE: &'static FaceShape = &SHAPE;
}

static SHAPE: FaceShape = FaceShape {
    name: "quadrilateral of nine nodes",
    nodes: NODES,
    places: &[
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [-1.0, 0.0],
        [0.0, 0.0],
        [1.0, 0.0],
        [-1.0, 1.0],
        [0.0, 1.0],
        [1.0, 1.0],
    ],
    cyclic: &[0, 2, 8, 6, 1, 5, 7, 3, 4],
    edges: &[&[0, 1, 2], &[2, 5, 8], &[8, 7, 6], &[6, 3, 0]],
    corners: 4,
    gauss: &GAUSS,
    gauss_weights: &GAUSS_WEIGHTS,
    at_nodes: &AT_NODES,
    node_weights: &LOBATTO_WEIGHTS,
    spacing: 1.0,
    tying: Tying { points: [12, 0, 0], ties: &TIES, between: Between::Projected(&BILINEAR) },
    points: &SHELL_POINTS,
    surface_points: &SURFACE_POINTS,
    values: |r, s| SmallVec::from_slice(&product(values(r), values(s))),
    pieces: &PIECES,
};

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
const fn numbers(r: f64, s: f64) -> Numbers<NODES> {
    Numbers::new(product(values(r), values(s)), product(slopes(r), values(s)), product(values(r), slopes(s)))
}

/// Shape functions at all pairs of some r and s, r first.
const fn grid<const R: usize, const N: usize>(r: [f64; R], s: &[f64]) -> [Numbers<NODES>; N] {
    let mut all = [numbers(0.0, 0.0); N];
    let mut place = 0;
    while place < N {
        all[place] = numbers(r[place % R], s[place / R]);
        place += 1;
    }
    all
}

static NUMBERS_R: [Numbers<NODES>; 6] = grid(TWO, &THREE);
static NUMBERS_S: [Numbers<NODES>; 6] = grid(THREE, &TWO);
static NUMBERS_GAUSS: [Numbers<NODES>; GAUSS_POINTS] = grid(THREE, &THREE);
static NUMBERS_NODES: [Numbers<NODES>; NODES] = grid([-1.0, 0.0, 1.0], &[-1.0, 0.0, 1.0]);

/// At the tying points of strains along r: two along r, three along s.
static TYING_R: [Weights; 6] = Numbers::at_all(&NUMBERS_R);
/// At the tying points of strains along s: three along r, two along s.
static TYING_S: [Weights; 6] = Numbers::at_all(&NUMBERS_S);
static GAUSS: [Weights; GAUSS_POINTS] = Numbers::at_all(&NUMBERS_GAUSS);
static AT_NODES: [Weights; NODES] = Numbers::at_all(&NUMBERS_NODES);

static GAUSS_WEIGHTS: [f64; GAUSS_POINTS] = product(THREE_WEIGHTS, THREE_WEIGHTS);
/// Weights of Lobatto quadrature at three nodes.
const LOBATTO: [f64; 3] = [1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0];
static LOBATTO_WEIGHTS: [f64; NODES] = product(LOBATTO, LOBATTO);

/// Bilinear functions 1, r, s, r s at the Gauss points.
static BILINEAR: [[f64; 4]; GAUSS_POINTS] = {
    let mut all = [[1.0; 4]; GAUSS_POINTS];
    let mut point = 0;
    while point < GAUSS_POINTS {
        let (r, s) = (THREE[point % 3], THREE[point / 3]);
        all[point] = [1.0, r, s, r * s];
        point += 1;
    }
    all
};

/// Strains at each tying point, and the place of the first one along s.
const ALONG: usize = 3;
const FIRST_S: usize = 6;

/// Lines through both tying points along r, and along s, that stand beside the Gauss point.
static TIES: [Ties; GAUSS_POINTS] = {
    let mut all = [NO_TIES; GAUSS_POINTS];
    let mut point = 0;
    while point < GAUSS_POINTS {
        let (i, j) = (point % 3, point / 3);
        let (of_r, of_s) = (line(THREE[i]), line(THREE[j]));
        let mut k = 0;
        while k < 2 {
            let (on_r, on_s) = (ALONG * (k + 2 * j), ALONG * (FIRST_S + i + 3 * k));
            all[point].stretch[0][k] = Tie { strain: on_r, weight: of_r[k] };
            all[point].stretch[1][k] = Tie { strain: on_s, weight: of_s[k] };
            all[point].shear[0][k] = Tie { strain: on_r + 2, weight: of_r[k] };
            all[point].shear[1][k] = Tie { strain: on_s + 2, weight: of_s[k] };
            k += 1;
        }
        point += 1;
    }
    all
};

table!(ROWS_R: along_r at TYING_R, 9 x 6);
table!(ROWS_S: along_s at TYING_S, 9 x 6);
table!(ROWS_GAUSS: place at GAUSS, 18 x 9);
table!(ROWS_NODES: turn at AT_NODES, 12 x 9);
table!(ROWS_SURFACE: on_surface at GAUSS, 9 x 9);
points!(SHELL_POINTS: 30 of ROWS_R, ROWS_S, ROWS_GAUSS, ROWS_NODES);
points!(SURFACE_POINTS: 9 of ROWS_SURFACE);

static PIECES: [Piece; GAUSS_POINTS] = grid_of_pieces([-1.0, 0.5 * THREE[0], 0.5 * THREE[2], 1.0]);
