//! Faces of shells: shape functions, places where strains are tied, quadrature, and numbers of nodes in meshes. A new one is a file here and a
//! line in [`FaceKind`].

mod quad4;
mod quad9;
mod triangle6;

pub use quad4::Quad4;
pub use quad9::Quad9;
pub use triangle6::Triangle6;

use super::shape::TWO;
use crate::elements::Interpolation;
use crate::elements::field::rows;
use smallvec::SmallVec;
use std::hash::Hash;

/// Numbers that are interpolated of each node: position x, director d, and two more axes.
pub const NUMBERS: usize = 12;
/// Most nodes of a face.
pub const MOST_NODES: usize = 9;
/// Parameters of a node: position and director.
pub const NODE_PARAMETERS: usize = 6;

/// Shape functions N_i(r, s) of the nodes of a face at one point.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// N_i.
    pub value: &'static [f64],
    /// dN_i/dr.
    pub by_r: &'static [f64],
    /// dN_i/ds.
    pub by_s: &'static [f64],
    /// dN_i/ds - dN_i/dr: along the edge of a triangle between its ends on both axes.
    pub by_q: &'static [f64],
}

/// The numbers behind [`Weights`].
#[derive(Clone, Copy)]
struct Numbers<const N: usize> {
    value: [f64; N],
    by_r: [f64; N],
    by_s: [f64; N],
    by_q: [f64; N],
}

impl<const N: usize> Numbers<N> {
    const fn new(value: [f64; N], by_r: [f64; N], by_s: [f64; N]) -> Self {
        let mut by_q = [0.0; N];
        let mut node = 0;
        while node < N {
            by_q[node] = by_s[node] - by_r[node];
            node += 1;
        }
        Numbers { value, by_r, by_s, by_q }
    }
    const fn at_all<const M: usize>(all: &'static [Self; M]) -> [Weights; M] {
        let first = &all[0];
        let mut own = [Weights { value: &first.value, by_r: &first.by_r, by_s: &first.by_s, by_q: &first.by_q }; M];
        let mut point = 0;
        while point < M {
            let at = &all[point];
            own[point] = Weights { value: &at.value, by_r: &at.by_r, by_s: &at.by_s, by_q: &at.by_q };
            point += 1;
        }
        own
    }
}

/// What a shell computes at one of its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShellPlace {
    /// Strain, curvature and transverse shear along one direction.
    Along,
    /// Strain and curvature along one direction.
    Stretch,
    /// Transverse shear along one direction.
    Shear,
    /// Inertia at a Gauss point and, if it is asked for there, the strain and curvature between r and s.
    Gauss(usize),
    /// Turning of a node about its director.
    Node(usize),
}

/// A strain at a tying point with its weight at a Gauss point.
#[derive(Clone, Copy, Debug)]
pub struct Tie {
    /// Place of a strain or of a transverse shear; a curvature stands behind its strain.
    pub strain: usize,
    /// Weight; 0 for none.
    pub weight: f64,
}

/// What ties the strains at a Gauss point.
#[derive(Clone, Copy, Debug)]
pub struct Ties {
    /// E_rr, E_ss and, in triangles, E_qq along the third edge.
    pub stretch: [[Tie; 4]; 3],
    /// G_r and G_s.
    pub shear: [[Tie; 8]; 2],
}

const NO_TIE: Tie = Tie { strain: 0, weight: 0.0 };
const NO_TIES: Ties = Ties { stretch: [[NO_TIE; 4]; 3], shear: [[NO_TIE; 8]; 2] };

/// How the strain between r and s follows.
#[derive(Clone, Copy, Debug)]
pub enum Between {
    /// From its values at the Gauss points, by the nearest combination of four functions, which have these values there.
    Projected(&'static [[f64; 4]]),
    /// As it is at the Gauss points.
    Own,
    /// From strains along three directions: 2 E_rs = E_rr + E_ss - E_qq.
    ThirdDirection,
}

/// How strains are tied.
#[derive(Clone, Copy, Debug)]
pub struct Tying {
    /// Numbers of points at which strains are taken: [`ShellPlace::Along`], [`ShellPlace::Stretch`], [`ShellPlace::Shear`], in this order.
    pub points: [usize; 3],
    /// At each Gauss point.
    pub ties: &'static [Ties],
    /// The strain between r and s.
    pub between: Between,
}

/// The part of a face around a Gauss point, for pictures.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// (r, s) of its corners.
    pub corners: [[f64; 2]; 4],
    /// Whether it ends at the edge of the face from each corner to the next.
    pub at_edge: [bool; 4],
}

/// Everything that distinguishes one kind of face from another.
#[derive(Debug)]
pub struct FaceShape {
    /// In words.
    pub name: &'static str,
    /// Number of nodes.
    pub nodes: usize,
    /// (r, s) of the nodes.
    pub places: &'static [[f64; 2]],
    /// Places of the nodes in the order of meshes: corners counterclockwise, then middles of the edges from there, then the middle.
    pub cyclic: &'static [usize],
    /// Nodes along each edge, counterclockwise.
    pub edges: &'static [&'static [usize]],
    /// Number of corners: the first nodes in the order of meshes.
    pub corners: usize,
    /// At the Gauss points.
    pub gauss: &'static [Weights],
    /// Their weights.
    pub gauss_weights: &'static [f64],
    /// At the nodes.
    pub at_nodes: &'static [Weights],
    /// Weights of a quadrature at the nodes, all positive.
    pub node_weights: &'static [f64],
    /// Distance of neighbouring nodes in r and in s.
    pub spacing: f64,
    /// How strains are tied.
    pub tying: Tying,
    /// What is interpolated at the points of a shell: those of [`Tying::points`], Gauss points, nodes.
    pub points: &'static [&'static [Interpolation]],
    /// What loads interpolate at each Gauss point: (x, dx/dr, dx/ds).
    pub surface_points: &'static [&'static [Interpolation]],
    /// N_i(r, s).
    pub values: fn(f64, f64) -> SmallVec<[f64; MOST_NODES]>,
    /// Parts around the Gauss points.
    pub pieces: &'static [Piece],
}

/// A kind of face as a type.
pub trait Face: Hash + Clone + Copy + Send + Sync + 'static {
    /// Its kind.
    const KIND: FaceKind;
    /// What it is.
    const SHAPE: &'static FaceShape;
}

/// A kind of face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaceKind {
    /// Four-node quadrilateral, MITC4.
    Quad4,
    /// Nine-node quadrilateral, MITC9.
    Quad9,
    /// Six-node triangle, MITC6.
    Triangle6,
}

impl FaceKind {
    /// All of them.
    pub const ALL: [FaceKind; 3] = [FaceKind::Quad4, FaceKind::Quad9, FaceKind::Triangle6];

    /// What it is.
    pub fn shape(self) -> &'static FaceShape {
        match self {
            FaceKind::Quad4 => Quad4::SHAPE,
            FaceKind::Quad9 => Quad9::SHAPE,
            FaceKind::Triangle6 => Triangle6::SHAPE,
        }
    }
}

impl FaceShape {
    /// Place of the first parameter of the section, behind those of the nodes.
    pub const fn section(&self) -> usize {
        self.nodes * NODE_PARAMETERS
    }
    /// Place of Young's modulus of a shell of one material, behind the thicknesses of the nodes.
    pub const fn young(&self) -> usize {
        self.section() + self.nodes
    }
    /// Place of Poisson's ratio.
    pub const fn poisson(&self) -> usize {
        self.young() + 1
    }
    /// What is computed at a point.
    pub fn place(&self, point: usize) -> ShellPlace {
        let [along, stretch, shear] = self.tying.points;
        let (first_gauss, gauss) = (along + stretch + shear, self.gauss.len());
        match point {
            _ if point < along => ShellPlace::Along,
            _ if point < along + stretch => ShellPlace::Stretch,
            _ if point < first_gauss => ShellPlace::Shear,
            _ if point < first_gauss + gauss => ShellPlace::Gauss(point - first_gauss),
            _ => ShellPlace::Node(point - first_gauss - gauss),
        }
    }
    /// Values at the nodes of the linear function of r and s nearest to some values at the Gauss points, in the mean by their weights.
    pub fn at_nodes_from_gauss(&self, values: &[f64]) -> Vec<f64> {
        let place = |weights: &Weights| {
            let own = weights.value.iter().zip(self.places);
            own.fold([0.0; 2], |[r, s], (weight, place)| [r + weight * place[0], s + weight * place[1]])
        };
        let points: Vec<[f64; 2]> = self.gauss.iter().map(place).collect();
        let product = |f: &dyn Fn(usize) -> f64| self.gauss_weights.iter().enumerate().map(|(g, w)| w * f(g)).sum::<f64>();
        // 1, r and s, each made orthogonal to those before it
        let area = product(&|_| 1.0);
        let [mean_r, mean_s] = [0, 1].map(|k| product(&|g| points[g][k]) / area);
        let along = |[r, _]: [f64; 2]| r - mean_r;
        let both = product(&|g| along(points[g]) * points[g][1]) / product(&|g| along(points[g]).powi(2));
        let across = |[r, s]: [f64; 2]| s - mean_s - both * along([r, s]);
        let part = |f: &dyn Fn([f64; 2]) -> f64| product(&|g| f(points[g]) * values[g]) / product(&|g| f(points[g]).powi(2));
        let (mean, by_r, by_s) = (part(&|_| 1.0), part(&along), part(&across));
        self.places.iter().map(|&own| mean + by_r * along(own) + by_s * across(own)).collect()
    }
    /// Number of strains at a place.
    pub fn strain_count(&self, place: ShellPlace) -> usize {
        match (place, self.tying.between) {
            (ShellPlace::Along, _) => 3,
            (ShellPlace::Stretch, _) => 2,
            (ShellPlace::Shear | ShellPlace::Node(_), _) => 1,
            (ShellPlace::Gauss(_), Between::ThirdDirection) => 0,
            (ShellPlace::Gauss(_), _) => 2,
        }
    }
    /// Place of the first strain of Gauss points, and of the first turning of nodes.
    pub fn first_strains(&self) -> [usize; 2] {
        let [along, stretch, shear] = self.tying.points;
        let first = 3 * along + 2 * stretch + shear;
        [first, first + self.gauss.len() * self.strain_count(ShellPlace::Gauss(0))]
    }
}

/// Places of x, d and the two more axes in a node's numbers.
const X: usize = 0;
const D: usize = 3;
const FIRST: usize = 6;
const SECOND: usize = 9;

/// (dx/dt, d, dd/dt) at a point, with derivatives along the direction t that have these weights.
const fn along(w: &Weights, by_t: &'static [f64]) -> [Interpolation; 9] {
    rows(&[(X, 3, by_t), (D, 3, w.value), (D, 3, by_t)])
}
/// (dx/dr, d, dd/dr) at a point.
const fn along_r(w: &Weights) -> [Interpolation; 9] {
    along(w, w.by_r)
}
/// (dx/ds, d, dd/ds).
const fn along_s(w: &Weights) -> [Interpolation; 9] {
    along(w, w.by_s)
}
/// (dx/dq, d, dd/dq).
const fn along_q(w: &Weights) -> [Interpolation; 9] {
    along(w, w.by_q)
}
/// (dx/dt, dd/dt).
const fn stretch(by_t: &'static [f64]) -> [Interpolation; 6] {
    rows(&[(X, 3, by_t), (D, 3, by_t)])
}
/// (dx/dt, d).
const fn shear(w: &Weights, by_t: &'static [f64]) -> [Interpolation; 6] {
    rows(&[(X, 3, by_t), (D, 3, w.value)])
}
/// (x, d).
const fn inertial(w: &Weights) -> [Interpolation; 6] {
    rows(&[(X, 3, w.value), (D, 3, w.value)])
}
/// (x, d, dx/dr, dx/ds, dd/dr, dd/ds).
const fn place(w: &Weights) -> [Interpolation; 18] {
    rows(&[(X, 3, w.value), (D, 3, w.value), (X, 3, w.by_r), (X, 3, w.by_s), (D, 3, w.by_r), (D, 3, w.by_s)])
}
/// (x, dx/dr, dx/ds).
const fn on_surface(w: &Weights) -> [Interpolation; 9] {
    rows(&[(X, 3, w.value), (X, 3, w.by_r), (X, 3, w.by_s)])
}
/// (dx/dr, dx/ds, first axis, second axis).
const fn turn(w: &Weights) -> [Interpolation; 12] {
    rows(&[(X, 3, w.by_r), (X, 3, w.by_s), (FIRST, 3, w.value), (SECOND, 3, w.value)])
}

/// A table of rows at all points of a list.
macro_rules! table {
    ($name:ident: $rows:ident at $list:ident, $width:literal x $count:literal) => {
        static $name: [[Interpolation; $width]; $count] = {
            let mut all = [$rows(&$list[0]); $count];
            let mut point = 0;
            while point < $count {
                all[point] = $rows(&$list[point]);
                point += 1;
            }
            all
        };
    };
}
use table;

/// Lists of rows, one after the other.
macro_rules! points {
    ($name:ident: $count:literal of $($table:ident),+) => {
        static $name: [&[Interpolation]; $count] = {
            let mut all: [&[Interpolation]; $count] = [&[]; $count];
            let mut point = 0;
            $({
                let mut own = 0;
                while own < $table.len() {
                    all[point] = &$table[own];
                    (own, point) = (own + 1, point + 1);
                }
            })+
            // none is missing
            assert!(point == $count);
            all
        };
    };
}
use points;

/// Weights of two values at -+1/sqrt(3) in the line through them.
const fn line(x: f64) -> [f64; 2] {
    [0.5 * (1.0 + x / TWO[0]), 0.5 * (1.0 + x / TWO[1])]
}

/// A grid of pieces that end at some places along r and s.
const fn grid_of_pieces<const E: usize, const N: usize>(ends: [f64; E]) -> [Piece; N] {
    let count = E - 1;
    let mut all = [Piece { corners: [[0.0; 2]; 4], at_edge: [false; 4] }; N];
    let mut piece = 0;
    while piece < N {
        let (i, j) = (piece % count, piece / count);
        let [[left, right], [low, high]] = [[ends[i], ends[i + 1]], [ends[j], ends[j + 1]]];
        all[piece] = Piece {
            corners: [[left, low], [right, low], [right, high], [left, high]],
            at_edge: [j == 0, i + 1 == count, j + 1 == count, i == 0],
        };
        piece += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Powers (m, n) of r^m s^n that the face interpolates.
    fn powers(kind: FaceKind) -> Vec<(i32, i32)> {
        let all = (0..3).flat_map(|m| (0..3).map(move |n| (m, n)));
        all.filter(|&(m, n)| match kind {
            FaceKind::Quad4 => m < 2 && n < 2,
            FaceKind::Quad9 => true,
            FaceKind::Triangle6 => m + n < 3,
        })
        .collect()
    }

    fn monomial((m, n): (i32, i32), [r, s]: [f64; 2]) -> f64 {
        r.powi(m) * s.powi(n)
    }

    /// Its derivatives towards r and s.
    fn slopes((m, n): (i32, i32), [r, s]: [f64; 2]) -> [f64; 2] {
        let slope = |x: f64, m: i32| f64::from(m) * x.powi((m - 1).max(0));
        [slope(r, m) * s.powi(n), r.powi(m) * slope(s, n)]
    }

    fn sum(weights: &[f64], values: &[f64]) -> f64 {
        weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
    }

    /// Where a point lies, by its shape functions and the places of the nodes.
    fn place(point: &Weights, nodes: &[[f64; 2]]) -> [f64; 2] {
        [0, 1].map(|axis| sum(point.value, &nodes.iter().map(|node| node[axis]).collect::<Vec<_>>()))
    }

    #[test]
    fn linear_functions_are_recovered_at_the_nodes_and_others_in_the_mean() {
        for kind in FaceKind::ALL {
            let shape = kind.shape();
            let at_gauss = |f: &dyn Fn([f64; 2]) -> f64| -> Vec<f64> {
                let nodal: Vec<f64> = shape.places.iter().map(|&own| f(own)).collect();
                shape.gauss.iter().map(|point| sum(point.value, &nodal)).collect()
            };
            let linear = |[r, s]: [f64; 2]| 0.7 - 2.0 * r + 0.3 * s;
            let own = shape.at_nodes_from_gauss(&at_gauss(&linear));
            assert!(own.iter().zip(shape.places).all(|(own, &at)| (own - linear(at)).abs() < 1e-14), "{kind:?}: {own:?}");
            // what is left over is orthogonal to 1, r and s
            let bent = at_gauss(&|[r, s]| r * s + 0.2 * r);
            let near = shape.at_nodes_from_gauss(&bent);
            for other in [|_: [f64; 2]| 1.0, |[r, _]: [f64; 2]| r, |[_, s]: [f64; 2]| s] {
                let rest = shape.gauss.iter().zip(&bent).zip(at_gauss(&other)).zip(shape.gauss_weights);
                let left = |(((point, bent), other), weight): (((&Weights, &f64), f64), &f64)| {
                    weight * (bent - sum(point.value, &near)) * other
                };
                let sum: f64 = rest.map(left).sum();
                assert!(sum.abs() < 1e-14, "{kind:?}: {sum:e}");
            }
        }
    }

    #[test]
    fn shape_functions_reproduce_their_polynomials_and_slopes() {
        for kind in FaceKind::ALL {
            let (shape, nodes) = (kind.shape(), kind.shape().places);
            for w in shape.gauss.iter().chain(shape.at_nodes) {
                let at = place(w, nodes);
                assert!((shape.values)(at[0], at[1]).iter().zip(w.value).all(|(a, b)| (a - b).abs() < 2e-15));
                for power in powers(kind) {
                    let values: Vec<f64> = nodes.iter().map(|&node| monomial(power, node)).collect();
                    let [by_r, by_s] = slopes(power, at);
                    let errors = [
                        sum(w.value, &values) - monomial(power, at),
                        sum(w.by_r, &values) - by_r,
                        sum(w.by_s, &values) - by_s,
                        sum(w.by_q, &values) - (by_s - by_r),
                    ];
                    assert!(errors.iter().all(|error| error.abs() < 5e-15), "{kind:?} {power:?} {errors:?}");
                }
            }
            for (node, w) in shape.at_nodes.iter().enumerate() {
                assert!((w.value[node] - 1.0).abs() < 1e-15, "{kind:?} {node}");
            }
        }
    }

    #[test]
    fn quadratures_find_the_integrals_of_polynomials() {
        // of r^m s^n over the square from -1 to 1, or over the triangle: m! n! / (m + n + 2)!
        let factorial = |m: i32| (1..=m).map(f64::from).product::<f64>();
        let of_line = |m: i32| if m % 2 == 0 { 2.0 / f64::from(m + 1) } else { 0.0 };
        for (kind, degree, at_nodes) in [(FaceKind::Quad4, 3, 1), (FaceKind::Quad9, 5, 3), (FaceKind::Triangle6, 4, 1)] {
            let (shape, nodes) = (kind.shape(), kind.shape().places);
            let exact = |m: i32, n: i32| match kind {
                FaceKind::Triangle6 => factorial(m) * factorial(n) / factorial(m + n + 2),
                _ => of_line(m) * of_line(n),
            };
            let points: Vec<[f64; 2]> = shape.gauss.iter().map(|point| place(point, nodes)).collect();
            for (m, n) in (0..=degree).flat_map(|m| (0..=degree - m).map(move |n| (m, n))) {
                let values: Vec<f64> = points.iter().map(|&at| monomial((m, n), at)).collect();
                assert!((sum(shape.gauss_weights, &values) - exact(m, n)).abs() < 2e-15, "{kind:?} {m} {n}");
                if m + n <= at_nodes {
                    let values: Vec<f64> = nodes.iter().map(|&at| monomial((m, n), at)).collect();
                    assert!((sum(shape.node_weights, &values) - exact(m, n)).abs() < 2e-15, "{kind:?} {m} {n}");
                }
            }
            assert!(shape.node_weights.iter().all(|&weight| weight > 0.0));
        }
    }

    #[test]
    fn edges_run_around_the_face_and_pieces_cover_it() {
        for kind in FaceKind::ALL {
            let (shape, nodes) = (kind.shape(), kind.shape().places);
            assert_eq!(shape.edges.len(), shape.corners);
            for (edge, next) in shape.edges.iter().zip(shape.edges.iter().cycle().skip(1)) {
                assert_eq!(edge.last(), next.first());
            }
            let area = |corners: &[[f64; 2]]| -> f64 {
                let twice = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - a[1] * b[0]);
                0.5 * twice.sum::<f64>()
            };
            let corners: Vec<[f64; 2]> = shape.edges.iter().map(|edge| nodes[edge[0]]).collect();
            let pieces: f64 = shape.pieces.iter().map(|piece| area(&piece.corners)).sum();
            assert!((pieces - area(&corners)).abs() < 1e-15 && shape.pieces.len() == shape.gauss.len());
            assert!((shape.gauss_weights.iter().sum::<f64>() - pieces).abs() < 2e-15);
        }
    }
}
