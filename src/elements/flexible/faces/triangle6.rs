//! Triangles of six nodes: corners at (r, s) = (0, 0), (1, 0), (0, 1), then the middles of the edges from there on: MITC6.

use super::*;

const NODES: usize = 6;
const GAUSS_POINTS: usize = 6;
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// A triangle of six nodes: corners at (r, s) = (0, 0), (1, 0), (0, 1), then the middles of the edges from each to the next.
///
/// Strains and curvatures along the three edges (E_rr, E_ss, E_qq with q = s - r) are linear in r and s: through two Gauss points of their own
/// edge, and through the mean of two Gauss points of the line half way up to the opposite corner; 2 E_rs = E_rr + E_ss - E_qq. They are those of
/// all displacements of third degree, and their integrals are those of the strains themselves, so that a constant stress does the same
/// work: on warped triangles a point at a height of 1/sqrt 3 above the edge, which keeps the first alone, locks what is thin, and lets pressure
/// widen it. Transverse shear is
///
/// G_r = a_1 + b_1 r + c_1 s + s (d r + e s),   G_s = a_2 + b_2 r + c_2 s - r (d r + e s),
///
/// tied along the edges at two Gauss points of each, and in both components in the middle of the triangle. No edge and no corner is
/// preferred. Six points of quadrature of degree four. Patches of constant strain, curvature, twist and shear are found where edges are
/// straight. With transverse shear that is linear in r and s, tied along the edges alone (MITC6a), thin plates are too soft by a third on
/// coarse meshes.
///
/// Source: Lee & Bathe (2004) for strains along the edges, with the one point above each; Kim & Bathe (2009) for the middle point of transverse
/// shear, which keeps the element stable; the quadrature of Strang & Fix (1973).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Triangle6;

impl Face for Triangle6 {
    const KIND: FaceKind = FaceKind::Triangle6;
    const SHAPE: &'static FaceShape = &SHAPE;
}

static SHAPE: FaceShape = FaceShape {
    name: "triangle of six nodes",
    nodes: NODES,
    places: &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]],
    cyclic: &[0, 1, 2, 3, 4, 5],
    edges: &[&[0, 3, 1], &[1, 4, 2], &[2, 5, 0]],
    corners: 3,
    gauss: &GAUSS,
    gauss_weights: &GAUSS_WEIGHTS,
    at_nodes: &AT_NODES,
    node_weights: &NODE_WEIGHTS,
    spacing: 0.5,
    tying: Tying { points: [6, 6, 2], ties: &TIES, between: Between::ThirdDirection },
    points: &SHELL_POINTS,
    surface_points: &SURFACE_POINTS,
    values: |r, s| SmallVec::from_slice(&numbers(r, s).value),
    pieces: &PIECES,
};

/// Shape functions at (r, s).
const fn numbers(r: f64, s: f64) -> Numbers<NODES> {
    let t = 1.0 - r - s;
    Numbers::new(
        [t * (2.0 * t - 1.0), r * (2.0 * r - 1.0), s * (2.0 * s - 1.0), 4.0 * t * r, 4.0 * r * s, 4.0 * s * t],
        [1.0 - 4.0 * t, 4.0 * r - 1.0, 0.0, 4.0 * (t - r), 4.0 * s, -4.0 * s],
        [1.0 - 4.0 * t, 0.0, 4.0 * s - 1.0, -4.0 * r, 4.0 * r, 4.0 * (t - s)],
    )
}

/// Gauss points of an edge of length 1.
const NEAR: f64 = 0.5 - 0.5 / SQRT_3;
const FAR: f64 = 0.5 + 0.5 / SQRT_3;
/// Gauss points of a line half way up, of length 1/2.
const HALF_NEAR: f64 = 0.5 * NEAR;
const HALF_FAR: f64 = 0.5 * FAR;
const THIRD: f64 = 1.0 / 3.0;

/// Along r, s and q, two on each edge.
static NUMBERS_EDGES: [Numbers<NODES>; 6] =
    [numbers(NEAR, 0.0), numbers(FAR, 0.0), numbers(0.0, NEAR), numbers(0.0, FAR), numbers(FAR, NEAR), numbers(NEAR, FAR)];
/// Half way up from each of them, along it.
static NUMBERS_ABOVE: [Numbers<NODES>; 6] = [
    numbers(HALF_NEAR, 0.5),
    numbers(HALF_FAR, 0.5),
    numbers(0.5, HALF_NEAR),
    numbers(0.5, HALF_FAR),
    numbers(HALF_FAR, HALF_NEAR),
    numbers(HALF_NEAR, HALF_FAR),
];
static NUMBERS_MIDDLE: [Numbers<NODES>; 1] = [numbers(THIRD, THIRD)];
static EDGES: [Weights; 6] = Numbers::at_all(&NUMBERS_EDGES);
static ABOVE: [Weights; 6] = Numbers::at_all(&NUMBERS_ABOVE);
static MIDDLE: [Weights; 1] = Numbers::at_all(&NUMBERS_MIDDLE);

/// Points near the corners and near the middles of the edges: (a, a), (1 - 2 a, a), (a, 1 - 2 a), with their weights, which integrate up to the
/// fourth degree.
const NEAR_CORNERS: f64 = 0.091_576_213_509_770_74;
const NEAR_EDGES: f64 = 0.445_948_490_915_964_9;
const OF_CORNERS: f64 = 0.054_975_871_827_660_94;
const OF_EDGES: f64 = 0.111_690_794_839_005_73;
const PLACES: [[f64; 2]; GAUSS_POINTS] = [
    [NEAR_CORNERS, NEAR_CORNERS],
    [1.0 - 2.0 * NEAR_CORNERS, NEAR_CORNERS],
    [NEAR_CORNERS, 1.0 - 2.0 * NEAR_CORNERS],
    [NEAR_EDGES, 1.0 - 2.0 * NEAR_EDGES],
    [NEAR_EDGES, NEAR_EDGES],
    [1.0 - 2.0 * NEAR_EDGES, NEAR_EDGES],
];
static GAUSS_WEIGHTS: [f64; GAUSS_POINTS] = [OF_CORNERS, OF_CORNERS, OF_CORNERS, OF_EDGES, OF_EDGES, OF_EDGES];
static NUMBERS_GAUSS: [Numbers<NODES>; GAUSS_POINTS] = {
    let mut all = [numbers(0.0, 0.0); GAUSS_POINTS];
    let mut point = 0;
    while point < GAUSS_POINTS {
        all[point] = numbers(PLACES[point][0], PLACES[point][1]);
        point += 1;
    }
    all
};
static NUMBERS_NODES: [Numbers<NODES>; NODES] =
    [numbers(0.0, 0.0), numbers(1.0, 0.0), numbers(0.0, 1.0), numbers(0.5, 0.0), numbers(0.5, 0.5), numbers(0.0, 0.5)];
static GAUSS: [Weights; GAUSS_POINTS] = Numbers::at_all(&NUMBERS_GAUSS);
static AT_NODES: [Weights; NODES] = Numbers::at_all(&NUMBERS_NODES);

/// A quarter of the rule at the corners and three quarters of that at the middles of the edges: all nodes have a share.
static NODE_WEIGHTS: [f64; NODES] = [1.0 / 24.0, 1.0 / 24.0, 1.0 / 24.0, 0.125, 0.125, 0.125];

/// Weights of values at (NEAR, 0), (FAR, 0), (HALF_NEAR, 1/2) and (HALF_FAR, 1/2) in the linear function of the place `along` the edge and
/// `across` it.
const fn linear(along: f64, across: f64) -> [f64; 4] {
    // the middle of the line half way up is at (1/4, 1/2)
    let second = SQRT_3 * (along + 0.5 * across - NEAR);
    [1.0 - second - across, second - across, across, across]
}

/// (G_r, G_s) at (r, s) from G_r at both points of its edge, G_s, G_q, and G_r, G_s in the middle.
const fn transverse(values: [f64; 8], r: f64, s: f64) -> [f64; 2] {
    let [r_near, r_far, s_near, s_far, q_near, q_far, r_middle, s_middle] = values;
    let b_1 = SQRT_3 * (r_far - r_near);
    let a_1 = r_near - b_1 * NEAR;
    let c_2 = SQRT_3 * (s_far - s_near);
    let a_2 = s_near - c_2 * NEAR;
    // G_s - G_r = start + slope s on the edge r = 1 - s
    let slope = SQRT_3 * (q_far - q_near);
    let start = q_near - slope * NEAR;
    // b_2 = start - a_2 + a_1 + b_1 + d, c_1 = c_2 - start - slope + a_2 - a_1 - e; in the middle d - 2 e = 9 left, 2 d - e = 9 right
    let left = r_middle - a_1 - (b_1 + c_2 - start - slope + a_2 - a_1) / 3.0;
    let right = s_middle - a_2 - (c_2 + start - a_2 + a_1 + b_1) / 3.0;
    let (d, e) = (6.0 * right - 3.0 * left, 3.0 * right - 6.0 * left);
    let (b_2, c_1) = (start - a_2 + a_1 + b_1 + d, c_2 - start - slope + a_2 - a_1 - e);
    let rest = d * r + e * s;
    [a_1 + b_1 * r + c_1 * s + s * rest, a_2 + b_2 * r + c_2 * s - r * rest]
}

/// Strains at each tying point on an edge, above an edge, and the place of the first ones above and of transverse shear in the middle.
const ALONG: usize = 3;
const STRETCH: usize = 2;
const FIRST_ABOVE: usize = 6 * ALONG;
const FIRST_MIDDLE: usize = FIRST_ABOVE + 6 * STRETCH;

static TIES: [Ties; GAUSS_POINTS] = {
    let mut all = [NO_TIES; GAUSS_POINTS];
    let mut point = 0;
    while point < GAUSS_POINTS {
        let [r, s] = PLACES[point];
        // along each edge, and across it towards the opposite corner
        let weights = [linear(r, s), linear(s, r), linear(s, 1.0 - r - s)];
        let mut direction = 0;
        while direction < 3 {
            let [near, far, above_near, above_far] = weights[direction];
            let (first, above) = (2 * direction * ALONG, FIRST_ABOVE + 2 * direction * STRETCH);
            all[point].stretch[direction] = [
                Tie { strain: first, weight: near },
                Tie { strain: first + ALONG, weight: far },
                Tie { strain: above, weight: above_near },
                Tie { strain: above + STRETCH, weight: above_far },
            ];
            direction += 1;
        }
        let mut value = 0;
        while value < 8 {
            let mut unit = [0.0; 8];
            unit[value] = 1.0;
            let [of_r, of_s] = transverse(unit, r, s);
            let strain = if value < 6 { ALONG * value + 2 } else { FIRST_MIDDLE + value - 6 };
            all[point].shear[0][value] = Tie { strain, weight: of_r };
            all[point].shear[1][value] = Tie { strain, weight: of_s };
            value += 1;
        }
        point += 1;
    }
    all
};

static ROWS_ALONG: [[Interpolation; 9]; 6] =
    [along_r(&EDGES[0]), along_r(&EDGES[1]), along_s(&EDGES[2]), along_s(&EDGES[3]), along_q(&EDGES[4]), along_q(&EDGES[5])];
static ROWS_STRETCH: [[Interpolation; 6]; 6] = [
    stretch(ABOVE[0].by_r),
    stretch(ABOVE[1].by_r),
    stretch(ABOVE[2].by_s),
    stretch(ABOVE[3].by_s),
    stretch(ABOVE[4].by_q),
    stretch(ABOVE[5].by_q),
];
static ROWS_SHEAR: [[Interpolation; 6]; 2] = [shear(&MIDDLE[0], MIDDLE[0].by_r), shear(&MIDDLE[0], MIDDLE[0].by_s)];
table!(ROWS_GAUSS: inertial at GAUSS, 6 x 6);
table!(ROWS_NODES: turn at AT_NODES, 12 x 6);
table!(ROWS_SURFACE: on_surface at GAUSS, 9 x 6);
points!(SHELL_POINTS: 26 of ROWS_ALONG, ROWS_STRETCH, ROWS_SHEAR, ROWS_GAUSS, ROWS_NODES);
points!(SURFACE_POINTS: 6 of ROWS_SURFACE);

/// Kites at the corners, and what lies between two of them at an edge, up to the middle.
static PIECES: [Piece; GAUSS_POINTS] = {
    let (corners, middle) = ([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [THIRD, THIRD]);
    let mut all = [Piece { corners: [middle; 4], at_edge: [false; 4] }; GAUSS_POINTS];
    let mut corner = 0;
    while corner < 3 {
        let (own, next, last) = (corners[corner], corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
        all[corner].corners = [own, between(own, next, THIRD), middle, between(own, last, THIRD)];
        all[corner].at_edge = [true, false, false, true];
        all[corner + 3].corners =
            [between(own, next, THIRD), between(own, next, 0.5), between(own, next, 2.0 * THIRD), middle];
        all[corner + 3].at_edge = [true, true, false, false];
        corner += 1;
    }
    all
};

const fn between(a: [f64; 2], b: [f64; 2], share: f64) -> [f64; 2] {
    [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transverse_shear_reproduces_its_own_functions() {
        let functions: [fn(f64, f64) -> [f64; 2]; 8] = [
            |_, _| [1.0, 0.0],
            |r, _| [r, 0.0],
            |_, s| [s, 0.0],
            |_, _| [0.0, 1.0],
            |r, _| [0.0, r],
            |_, s| [0.0, s],
            |r, s| [r * s, -r * r],
            |r, s| [s * s, -r * s],
        ];
        for own in functions {
            let at = |r: f64, s: f64| own(r, s);
            let q = |r: f64, s: f64| at(r, s)[1] - at(r, s)[0];
            let values = [
                at(NEAR, 0.0)[0],
                at(FAR, 0.0)[0],
                at(0.0, NEAR)[1],
                at(0.0, FAR)[1],
                q(FAR, NEAR),
                q(NEAR, FAR),
                at(THIRD, THIRD)[0],
                at(THIRD, THIRD)[1],
            ];
            for [r, s] in PLACES {
                let (tied, exact) = (transverse(values, r, s), at(r, s));
                assert!((0..2).all(|k| (tied[k] - exact[k]).abs() < 1e-14), "{tied:?} {exact:?}");
            }
        }
    }

    #[test]
    fn strains_along_an_edge_reproduce_linear_functions_and_the_mean_of_quadratic_ones() {
        // powers of the place along the edge and across it; the mean over the triangle is 2 m! n! / (m + n + 2)!
        for (m, n, mean) in
            [(0, 0, 1.0), (1, 0, THIRD), (0, 1, THIRD), (2, 0, 1.0 / 6.0), (1, 1, 1.0 / 12.0), (0, 2, 1.0 / 6.0)]
        {
            let at = |x: f64, y: f64| x.powi(m) * y.powi(n);
            let values = [at(NEAR, 0.0), at(FAR, 0.0), at(HALF_NEAR, 0.5), at(HALF_FAR, 0.5)];
            let tied = |x: f64, y: f64| linear(x, y).iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
            let integral: f64 = PLACES.iter().zip(GAUSS_WEIGHTS).map(|(&[x, y], weight)| tied(x, y) * weight).sum();
            assert!((2.0 * integral - mean).abs() < 1e-14, "{m} {n}");
            assert!(m + n > 1 || PLACES.iter().all(|&[x, y]| (tied(x, y) - at(x, y)).abs() < 1e-14));
        }
    }

    #[test]
    fn strains_along_an_edge_are_those_of_displacements_of_third_degree() {
        // r (2 r - 1) (r - 1) and r s t are 0 at all nodes, and so are those with another letter
        let slopes: [fn(f64, f64) -> f64; 3] =
            [|r, _| 6.0 * r * r - 6.0 * r + 1.0, |r, s| 6.0 * (1.0 - r - s) * (r + s) - 1.0, |r, s| s * (1.0 - 2.0 * r - s)];
        for at in slopes {
            let values = [at(NEAR, 0.0), at(FAR, 0.0), at(HALF_NEAR, 0.5), at(HALF_FAR, 0.5)];
            for [x, y] in PLACES {
                let tied: f64 = linear(x, y).iter().zip(values).map(|(weight, value)| weight * value).sum();
                assert!(tied.abs() < 1e-14, "{tied}");
            }
        }
    }
}
