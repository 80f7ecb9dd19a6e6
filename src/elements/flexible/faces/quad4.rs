//! Quadrilaterals of four nodes at (r, s) in {-1, 1} x {-1, 1}, r first: MITC4.

use super::*;

const NODES: usize = 4;
const GAUSS_POINTS: usize = 4;

/// A quadrilateral of four nodes: node 2 b + a + 1 stands at r = 2 a - 1, s = 2 b - 1.
///
/// Transverse shear along r is tied in the middles of the edges s = -+1 and interpolated linearly between, that along s the same way. Strains
/// of the surface and curvatures are those of bilinear interpolation: along r they do not depend on r, so that s = -+1/sqrt(3) gives those of
/// all four Gauss points. Patches of constant strain, curvature and twist are found on any mesh; thin plates do not lock in shear. In its
/// plane the element is as stiff against bending as any of four nodes and full quadrature, and warped elements are stiffened by their
/// membrane.
///
/// Source: Dvorkin & Bathe (1984), MITC4.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Quad4;

impl Face for Quad4 {
    const KIND: FaceKind = FaceKind::Quad4;
    const SHAPE: &'static FaceShape = &SHAPE;
}

static SHAPE: FaceShape = FaceShape {
    name: "quadrilateral of four nodes",
    nodes: NODES,
    places: &[[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]],
    cyclic: &[0, 1, 3, 2],
    edges: &[&[0, 1], &[1, 3], &[3, 2], &[2, 0]],
    corners: 4,
    gauss: &GAUSS,
    gauss_weights: &[1.0; GAUSS_POINTS],
    at_nodes: &AT_NODES,
    node_weights: &[1.0; NODES],
    spacing: 2.0,
    tying: Tying { points: [0, 4, 4], ties: &TIES, between: Between::Own },
    points: &SHELL_POINTS,
    surface_points: &SURFACE_POINTS,
    values: |r, s| SmallVec::from_slice(&numbers(r, s).value),
    pieces: &PIECES,
};

/// Shape functions at (r, s).
const fn numbers(r: f64, s: f64) -> Numbers<NODES> {
    let ([of_r, of_s], slope) = ([[0.5 * (1.0 - r), 0.5 * (1.0 + r)], [0.5 * (1.0 - s), 0.5 * (1.0 + s)]], [-0.5, 0.5]);
    let mut all = Numbers::new([0.0; NODES], [0.0; NODES], [0.0; NODES]);
    let mut node = 0;
    while node < NODES {
        let (a, b) = (node % 2, node / 2);
        all.value[node] = of_r[a] * of_s[b];
        all.by_r[node] = slope[a] * of_s[b];
        all.by_s[node] = of_r[a] * slope[b];
        node += 1;
    }
    Numbers::new(all.value, all.by_r, all.by_s)
}

const fn grid(ends: [f64; 2]) -> [Numbers<NODES>; 4] {
    let [a, b] = ends;
    [numbers(a, a), numbers(b, a), numbers(a, b), numbers(b, b)]
}

static NUMBERS_STRETCH: [Numbers<NODES>; 4] =
    [numbers(0.0, TWO[0]), numbers(0.0, TWO[1]), numbers(TWO[0], 0.0), numbers(TWO[1], 0.0)];
static NUMBERS_SHEAR: [Numbers<NODES>; 4] = [numbers(0.0, -1.0), numbers(0.0, 1.0), numbers(-1.0, 0.0), numbers(1.0, 0.0)];
static NUMBERS_GAUSS: [Numbers<NODES>; GAUSS_POINTS] = grid(TWO);
static NUMBERS_NODES: [Numbers<NODES>; NODES] = grid([-1.0, 1.0]);

/// At the places of strains and curvatures: two along r, two along s.
static STRETCH: [Weights; 4] = Numbers::at_all(&NUMBERS_STRETCH);
/// At the tying points of transverse shear: two along r, two along s.
static SHEAR: [Weights; 4] = Numbers::at_all(&NUMBERS_SHEAR);
static GAUSS: [Weights; GAUSS_POINTS] = Numbers::at_all(&NUMBERS_GAUSS);
static AT_NODES: [Weights; NODES] = Numbers::at_all(&NUMBERS_NODES);

/// Strains and curvatures beside the Gauss point, lines of transverse shear.
static TIES: [Ties; GAUSS_POINTS] = {
    let first_shear = 2 * STRETCH.len();
    let mut all = [NO_TIES; GAUSS_POINTS];
    let mut point = 0;
    while point < GAUSS_POINTS {
        let (i, j) = (point % 2, point / 2);
        all[point].stretch[0][0] = Tie { strain: 2 * j, weight: 1.0 };
        all[point].stretch[1][0] = Tie { strain: 2 * (2 + i), weight: 1.0 };
        let (of_s, of_r) = ([0.5 * (1.0 - TWO[j]), 0.5 * (1.0 + TWO[j])], [0.5 * (1.0 - TWO[i]), 0.5 * (1.0 + TWO[i])]);
        let mut k = 0;
        while k < 2 {
            all[point].shear[0][k] = Tie { strain: first_shear + k, weight: of_s[k] };
            all[point].shear[1][k] = Tie { strain: first_shear + 2 + k, weight: of_r[k] };
            k += 1;
        }
        point += 1;
    }
    all
};

static ROWS_STRETCH: [[Interpolation; 6]; 4] =
    [stretch(STRETCH[0].by_r), stretch(STRETCH[1].by_r), stretch(STRETCH[2].by_s), stretch(STRETCH[3].by_s)];
static ROWS_SHEAR: [[Interpolation; 6]; 4] = [
    shear(&SHEAR[0], SHEAR[0].by_r),
    shear(&SHEAR[1], SHEAR[1].by_r),
    shear(&SHEAR[2], SHEAR[2].by_s),
    shear(&SHEAR[3], SHEAR[3].by_s),
];
table!(ROWS_GAUSS: place at GAUSS, 18 x 4);
table!(ROWS_NODES: turn at AT_NODES, 12 x 4);
table!(ROWS_SURFACE: on_surface at GAUSS, 9 x 4);
points!(SHELL_POINTS: 16 of ROWS_STRETCH, ROWS_SHEAR, ROWS_GAUSS, ROWS_NODES);
points!(SURFACE_POINTS: 4 of ROWS_SURFACE);

static PIECES: [Piece; GAUSS_POINTS] = grid_of_pieces([-1.0, 0.0, 1.0]);
