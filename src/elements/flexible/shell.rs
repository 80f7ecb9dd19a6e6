// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::biquadratic::{
    AT_NODES, FIRST_GAUSS, FIRST_NODE, FIRST_S, GAUSS, GAUSS_POINTS, LOBATTO, NODES, NUMBERS, POINTS, SHELL_POINTS, Weights,
    gauss_weight,
};
use super::shape::{THREE, TWO};
use crate::elements::{Element, Field, Flexible, Interpolation, NodeKind, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// Reissner-Mindlin shell of nine nodes with position x and Euler parameters e, for large displacements and rotations (MITC9).
///
/// The shell is x(r, s, z) = x(r, s) + z d(r, s) with the directors d = R(e) D of the nodes, both interpolated biquadratically. With
/// z = 0 on the reference surface, and a comma for derivatives towards r and s, its strains of Green and Lagrange are, linear in z,
///
/// E_ab = (x,a . x,b - X,a . X,b) / 2,   K_ab = (x,a . d,b + x,b . d,a - X,a . D,b - X,b . D,a) / 2,   G_a = x,a . d - X,a . D.
///
/// Strains along r (E_rr, K_rr, G_r) are taken at r = -+1/sqrt(3), s = 0, -+sqrt(3/5), those along s at the places mirrored, and interpolated to
/// three by three Gauss points (MITC). There E_rs and K_rs are replaced by the bilinear functions of r and s that are nearest to them in the
/// sum of squares weighted by 1/j, with dA = j dr ds. Where j is constant, these are the values at r, s = -+1/sqrt(3) that MITC9 takes, to
/// the last digit; elsewhere they keep the work of every constant stress, so that patches of distorted elements with straight edges
/// find constant strains. With these strains
///
/// V = integral of (E . A E + 2 E . B K + K . D K + G . S G) / 2 dA
///
/// in orthonormal axes: no locking in shear or along the surface, no mode without energy beside rigid motions. All nodes start with the
/// same e. A rotation about the director is held by the penalty k A_33 w^2 / 2 dA with the turning w = (x,1 . t_2 - x,2 . t_1) / 2 of the
/// surface against the axes t_a = R(e) T_a of the node, at the nodes (Lobatto); w is zero for every rigid motion and every stretch that the
/// axes follow. Its inertia is [`DRILLING_INERTIA`] of the rotary one.
///
/// Kinetic energy: integral of (m |dx/dt|^2 + 2 m_1 dx/dt . dd/dt + m_2 |dd/dt|^2) / 2 dA. Weight: V = -g . integral of m x + m_1 d dA.
///
/// Damping proportional to stiffness adds Rayleigh's function eta V of the strain rates in place of the strains: it takes 2 eta V of them
/// from the power, nothing in rigid motions.
///
/// Parameters, of each node
/// * `position x, y, z`  X \[m\]
/// * `director x, y, z`  D, normal to the surface, of length 1, both in a frame that all nodes share at the start
///
/// of an [isotropic](ShellSection::Isotropic) section: `thickness` h at each node \[m\], `young` E [N/m2], `poisson` nu, `density` rho [kg/m3];
/// A = h C, B = 0, D = h^3/12 C with C of plane stress, S = 5/6 G h, m = rho h, m_1 = 0, m_2 = rho h^3/12;
///
/// of a [laminate](ShellSection::Laminate): A [N/m], B \[N\], D [N m] by the rows of their upper triangles for (11, 22, 12), S [N/m] for
/// (1, 2), m [kg/m2], m_1 [kg/m], m_2 \[kg\], and a direction along axis 1, projected on the surface;
///
/// and `drilling` k, `gravity x, y, z` g [m/s2], and with [`damped`](ShellField::damped) `damping` eta \[s\].
///
/// Source: Bucalem & Bathe (1993), MITC9; Boopathy & Kennedy, section 3, for directors from rotations in multibody systems; Hughes &
/// Brezzi (1989) for the penalty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShellField {
    /// What its section is made of.
    pub section: ShellSection,
    /// With damping proportional to stiffness.
    pub damped: bool,
}

/// What the section of a shell is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShellSection {
    /// One material, the same in all directions.
    Isotropic,
    /// Stiffnesses and inertia for each area.
    Laminate,
}

/// The shell as an element.
pub type Shell = Flexible<ShellField>;

/// Inertia of a rotation about the director, as a share of the rotary inertia of the section: it belongs to no motion of the material.
pub const DRILLING_INERTIA: f64 = 1e-3;

/// Share of the shear stiffness G h that acts: that of a parabola of stresses.
const SHEAR_FACTOR: f64 = 5.0 / 6.0;

/// Parameters of a node: position and director.
pub const NODE_PARAMETERS: usize = 6;
/// Place of the first parameter of the section.
pub const SECTION: usize = NODES * NODE_PARAMETERS;
/// Place of Young's modulus of a shell of one material, behind the thicknesses of the nodes.
pub const YOUNG: usize = SECTION + NODES;
/// Place of Poisson's ratio.
pub const POISSON: usize = YOUNG + 1;

/// Strains at each tying point along r or s, and between.
const ALONG: usize = 3;
const BETWEEN: usize = 2;
/// Place of the first strain along s, of the first between, and of the first of turning.
const STRAINS_S: usize = 6 * ALONG;
const STRAINS_RS: usize = 2 * STRAINS_S;
const TURNING: usize = STRAINS_RS + GAUSS_POINTS * BETWEEN;

/// Bilinear functions 1, r, s, r s at the Gauss points.
const BILINEAR: [[f64; 4]; GAUSS_POINTS] = {
    let mut all = [[1.0; 4]; GAUSS_POINTS];
    let mut point = 0;
    while point < GAUSS_POINTS {
        let (r, s) = (THREE[point % 3], THREE[point / 3]);
        all[point] = [1.0, r, s, r * s];
        point += 1;
    }
    all
};

/// Upper triangle of a symmetric matrix of three rows, by rows.
type Symmetric<S> = [S; 6];

/// A Gauss point of a deformed shell.
#[derive(Clone, Copy, Debug)]
pub struct ShellPoint<S> {
    /// E_11, E_22, 2 E_12 of the reference surface, in orthonormal axes: axis 1 along the direction of a laminate, otherwise along X,r.
    pub strain: [S; 3],
    /// K_11, K_22, 2 K_12 \[1/m\]: strains at the place z are E + z K.
    pub curvature: [S; 3],
    /// Thickness \[m\]; 0 for a laminate, whose plies say it.
    pub thickness: S,
    /// The area of the reference surface for which it stands \[m2\].
    pub area: S,
}

impl<S: Scalar> ShellPoint<S> {
    /// Strains at the place `z` along the normal.
    pub fn strain_at(&self, z: S) -> [S; 3] {
        std::array::from_fn(|i| self.strain[i] + self.curvature[i] * z)
    }
    /// Von Mises stresses [N/m2] on the lower and upper surface of a shell of one material, of plane stress at small strains:
    ///
    /// s^2 = s_11^2 - s_11 s_22 + s_22^2 + 3 s_12^2,   (s_11, s_22, s_12) = C (E -+ h/2 K).
    pub fn von_mises(&self, young: S, poisson: S) -> [S; 2] {
        let [plane, shear] = plane_stress(young, poisson);
        let half = self.thickness * 0.5;
        [-half, half].map(|z| {
            let [along, across, between] = self.strain_at(z);
            let (first, second) = (plane * (along + poisson * across), plane * (across + poisson * along));
            let mixed = shear * between;
            (first * first - first * second + second * second + mixed * mixed * 3.0).sqrt()
        })
    }
}

/// E / (1 - nu^2) and the shear modulus.
fn plane_stress<S: Scalar>(young: S, poisson: S) -> [S; 2] {
    [young / (-(poisson * poisson) + 1.0), young / ((poisson + 1.0) * 2.0)]
}

/// Stiffness and inertia of a section for each area.
struct Section<S> {
    /// A, B, D.
    stiffness: [Symmetric<S>; 3],
    /// S_11, S_12, S_22.
    shear: [S; 3],
    /// m, m_1, m_2.
    inertia: [S; 3],
}

/// A point of the reference: an area for each dr ds, and the components of strains in orthonormal axes.
struct Reference<S> {
    area: S,
    /// A^a . e_i, row by row: e_i are the axes, A^a the vectors dual to X,r and X,s.
    components: [[S; 2]; 2],
}

/// A vector of the nodes' parameters with some weights: position at place 0, director at 3.
fn combine<S: Scalar>(p: &[S], weights: &[f64; NODES], place: usize) -> Vector3<S> {
    let own = |i: usize| {
        let mut sum = S::zero();
        for (node, &weight) in weights.iter().enumerate() {
            sum += p[NODE_PARAMETERS * node + place + i] * weight;
        }
        sum
    };
    Vector3::new(own(0), own(1), own(2))
}

/// Interpolated numbers of a point in the reference.
fn in_reference<S: Scalar>(point: usize, p: &[S]) -> [S; 18] {
    let rows = SHELL_POINTS[point];
    std::array::from_fn(|i| {
        let Some(Interpolation { component, weights }) = rows.get(i) else { return S::zero() };
        weights
            .iter()
            .enumerate()
            .fold(S::zero(), |sum, (node, &weight)| sum + p[NODE_PARAMETERS * node + component] * weight)
    })
}

/// (x,a . x,a / 2, x,a . d,a, x,a . d) from (x,a, d, d,a).
fn along<S: Scalar>(h: &[S]) -> [S; ALONG] {
    let (slope, director, turn) = (Vector3::first_three(h), Vector3::first_three(&h[3..]), Vector3::first_three(&h[6..]));
    [slope.dot(&slope) * 0.5, slope.dot(&turn), slope.dot(&director)]
}

/// (x,r . x,s, x,r . d,s + x,s . d,r) from (x, d, x,r, x,s, d,r, d,s).
fn between<S: Scalar>(h: &[S]) -> [S; BETWEEN] {
    let vector = |place: usize| Vector3::first_three(&h[3 * place..]);
    [vector(2).dot(&vector(3)), vector(2).dot(&vector(5)) + vector(3).dot(&vector(4))]
}

/// L D L^T of a symmetric matrix of four rows: L below the diagonal, 1/D on it.
fn factors<S: Scalar>(matrix: [[S; 4]; 4]) -> [[S; 4]; 4] {
    let mut own = matrix;
    for k in 0..4 {
        own[k][k] = own[k][k].recip();
        for i in k + 1..4 {
            let share = own[i][k] * own[k][k];
            for j in k + 1..=i {
                let other = own[j][k];
                own[i][j] -= share * other;
            }
        }
        for i in k + 1..4 {
            let inverse = own[k][k];
            own[i][k] *= inverse;
        }
    }
    own
}

/// Solution for these factors.
fn solve<S: Scalar>(factors: &[[S; 4]; 4], mut x: [S; 4]) -> [S; 4] {
    for i in 0..4 {
        for k in 0..i {
            let known = x[k];
            x[i] -= factors[i][k] * known;
        }
    }
    for i in (0..4).rev() {
        x[i] *= factors[i][i];
        for k in i + 1..4 {
            let known = x[k];
            x[i] -= factors[k][i] * known;
        }
    }
    x
}

/// What takes values at the Gauss points to the nearest bilinear function: the weight of each point, and the factors of the products of the
/// bilinear functions with each other.
struct Projection<S> {
    weights: [S; GAUSS_POINTS],
    factors: [[S; 4]; 4],
}

impl<S: Scalar> Projection<S> {
    fn new(p: &[S]) -> Self {
        let weights: [S; GAUSS_POINTS] = std::array::from_fn(|point| {
            let (_, area) = surface(p, &GAUSS[point]);
            area.recip() * gauss_weight(point)
        });
        let product = |i: usize, j: usize| {
            let own = BILINEAR.iter().zip(&weights);
            own.fold(S::zero(), |sum, (bilinear, &weight)| sum + weight * (bilinear[i] * bilinear[j]))
        };
        let matrix = std::array::from_fn(|i| std::array::from_fn(|j| product(i, j)));
        Projection { weights, factors: factors(matrix) }
    }
    /// Coefficients of 1, r, s, r s.
    fn of(&self, values: impl Fn(usize) -> S) -> [S; 4] {
        let weighted: [S; GAUSS_POINTS] = std::array::from_fn(|point| values(point) * self.weights[point]);
        let products = std::array::from_fn(|i| {
            BILINEAR.iter().zip(&weighted).fold(S::zero(), |sum, (bilinear, &own)| sum + own * bilinear[i])
        });
        solve(&self.factors, products)
    }
}

/// Thickness of an isotropic section where shape functions have some values.
fn thickness<S: Scalar>(p: &[S], weights: &[f64; NODES]) -> S {
    weights.iter().zip(&p[SECTION..]).fold(S::zero(), |sum, (&weight, &own)| sum + own * weight)
}

/// Tangents of the reference and its unit normal, with the area that they span.
fn surface<S: Scalar>(p: &[S], weights: &Weights) -> ([Vector3<S>; 3], S) {
    let (first, second) = (combine(p, &weights.by_r, 0), combine(p, &weights.by_s, 0));
    let normal = first.cross(&second);
    let area = normal.length();
    ([first, second, normal * area.recip()], area)
}

/// Axes of a node along its surface, and the tangents in them: X,r = l T_1, X,s = m T_1 + n T_2.
fn node_axes<S: Scalar>(p: &[S], node: usize) -> ([Vector3<S>; 2], [S; 3]) {
    let ([first, second, normal], _) = surface(p, &AT_NODES[node]);
    let length = first.length();
    let along = first * length.recip();
    let across = normal.cross(&along);
    ([along, across], [length, second.dot(&along), second.dot(&across)])
}

/// Weights of two values at -+1/sqrt(3) in the line through them.
fn line(x: f64) -> [f64; 2] {
    [0.5 * (1.0 + x / TWO[0]), 0.5 * (1.0 + x / TWO[1])]
}

/// M x for an upper triangle.
fn times<S: Scalar>(m: &Symmetric<S>, x: [S; 3]) -> [S; 3] {
    let [a, b, c, d, e, f] = *m;
    [a * x[0] + b * x[1] + c * x[2], b * x[0] + d * x[1] + e * x[2], c * x[0] + e * x[1] + f * x[2]]
}

fn dot<S: Scalar, const N: usize>(x: [S; N], y: [S; N]) -> S {
    x.into_iter().zip(y).fold(S::zero(), |sum, (x, y)| sum + x * y)
}

impl<S: Scalar> Reference<S> {
    /// At a Gauss point, with axis 1 along a direction or else along X,r.
    fn at(p: &[S], point: usize, direction: Option<Vector3<S>>) -> Self {
        let ([first, second, normal], area) = surface(p, &GAUSS[point]);
        let first_axis = match direction {
            Some(direction) => (direction - normal * normal.dot(&direction)).unit(),
            None => first.unit(),
        };
        let second_axis = normal.cross(&first_axis);
        let duals = [second.cross(&normal) * area.recip(), normal.cross(&first) * area.recip()];
        let components = [first_axis, second_axis].map(|axis| duals.map(|dual| dual.dot(&axis)));
        Reference { area, components }
    }
    /// Rows that take (E_rr, E_ss, 2 E_rs) to (E_11, E_22, 2 E_12).
    fn in_axes(&self) -> [[S; 3]; 3] {
        let [[a, b], [c, d]] = self.components;
        [[a * a, b * b, a * b], [c * c, d * d, c * d], [(a + a) * c, (b + b) * d, a * d + b * c]]
    }
    /// T^T M T of a stiffness in the axes, times a factor.
    fn covariant(&self, m: &Symmetric<S>, factor: S) -> Symmetric<S> {
        let rows = self.in_axes();
        let column = |j: usize| [rows[0][j], rows[1][j], rows[2][j]];
        let product = [0, 1, 2].map(|j| times(m, column(j)));
        [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| dot(column(i), product[j]) * factor)
    }
    /// The same of a stiffness against transverse shear.
    fn covariant_shear(&self, m: &[S; 3], factor: S) -> [S; 3] {
        let [[a, b], [c, d]] = self.components;
        let entry = |[x, y]: [S; 2], [z, w]: [S; 2]| (x * (m[0] * z + m[1] * w) + y * (m[1] * z + m[2] * w)) * factor;
        [entry([a, c], [a, c]), entry([a, c], [b, d]), entry([b, d], [b, d])]
    }
}

impl ShellField {
    /// Place of the drilling factor, before gravity.
    pub const fn drilling(&self) -> usize {
        SECTION
            + match self.section {
                ShellSection::Isotropic => NODES + 3,
                ShellSection::Laminate => 27,
            }
    }
    /// Direction of axis 1.
    fn direction<S: Scalar>(&self, p: &[S]) -> Option<Vector3<S>> {
        (self.section == ShellSection::Laminate).then(|| Vector3::first_three(&p[SECTION + 24..]))
    }
    /// The section where shape functions have some values.
    fn section_at<S: Scalar>(&self, p: &[S], weights: &[f64; NODES]) -> Section<S> {
        let own = &p[SECTION..];
        let zero = S::zero();
        if self.section == ShellSection::Laminate {
            let triangle = |first: usize| std::array::from_fn(|i| own[first + i]);
            return Section {
                stiffness: [triangle(0), triangle(6), triangle(12)],
                shear: [own[18], own[19], own[20]],
                inertia: [own[21], own[22], own[23]],
            };
        }
        let thickness = thickness(p, weights);
        let (young, poisson, density) = (p[YOUNG], p[POISSON], p[POISSON + 1]);
        let second = thickness * thickness * thickness / 12.0;
        let [plane, shear] = plane_stress(young, poisson);
        let of_plane_stress =
            |factor: S| [plane * factor, plane * poisson * factor, zero, plane * factor, zero, shear * factor];
        let transverse = shear * thickness * SHEAR_FACTOR;
        Section {
            stiffness: [of_plane_stress(thickness), [zero; 6], of_plane_stress(second)],
            shear: [transverse, zero, transverse],
            inertia: [density * thickness, zero, density * second],
        }
    }
    /// m, m_1 and m_2 of a Gauss point's share of the area.
    fn inertia_at<S: Scalar>(&self, p: &[S], point: usize) -> [S; 3] {
        let (_, area) = surface(p, &GAUSS[point]);
        let share = area * gauss_weight(point);
        self.section_at(p, &GAUSS[point].value).inertia.map(|inertia| inertia * share)
    }
    /// A_33 and m_2 of a node's share of the area.
    fn of_node<S: Scalar>(&self, p: &[S], node: usize) -> [S; 2] {
        let (_, area) = surface(p, &AT_NODES[node]);
        let share = area * (LOBATTO[node % 3] * LOBATTO[node / 3]);
        let section = self.section_at(p, &AT_NODES[node].value);
        [section.stiffness[0][5] * share, section.inertia[2] * share]
    }
    /// Strains, curvatures and shear at a Gauss point towards (r, s), from those at the tying points and the coefficients of those between.
    fn tied<S: Scalar>(point: usize, e: &[S], between: &[[S; 4]; BETWEEN]) -> ([S; 3], [S; 3], [S; 2]) {
        let (i, j) = (point % 3, point / 3);
        let (of_r, of_s) = (line(THREE[i]), line(THREE[j]));
        let tied_r = |which: usize| {
            let own = |a: usize| e[ALONG * (a + 2 * j) + which];
            own(0) * of_r[0] + own(1) * of_r[1]
        };
        let tied_s = |which: usize| {
            let own = |b: usize| e[STRAINS_S + ALONG * (i + 3 * b) + which];
            own(0) * of_s[0] + own(1) * of_s[1]
        };
        let [strain_rs, curvature_rs] = between.map(|own| dot(own, BILINEAR[point].map(S::from)));
        let strain = [tied_r(0), tied_s(0), strain_rs];
        let curvature = [tied_r(1), tied_s(1), curvature_rs];
        (strain, curvature, [tied_r(2), tied_s(2)])
    }
    /// Coefficients of the strains and curvatures between r and s.
    fn between<S: Scalar>(e: &[S], p: &[S]) -> [[S; 4]; BETWEEN] {
        let projection = Projection::new(p);
        [0, 1].map(|which| projection.of(|point| e[STRAINS_RS + BETWEEN * point + which]))
    }
    /// Energy of the strains at a Gauss point.
    fn energy_at<S: Scalar>(&self, point: usize, e: &[S], between: &[[S; 4]; BETWEEN], p: &[S]) -> S {
        let (strain, curvature, shear) = Self::tied(point, e, between);
        let section = self.section_at(p, &GAUSS[point].value);
        let reference = Reference::at(p, point, self.direction(p));
        let share = reference.area * (0.5 * gauss_weight(point));
        let [a, b, d] = section.stiffness.map(|stiffness| reference.covariant(&stiffness, share));
        let s = reference.covariant_shear(&section.shear, share);
        let mut energy = dot(strain, times(&a, strain)) + dot(curvature, times(&d, curvature));
        if self.section == ShellSection::Laminate {
            energy += dot(strain, times(&b, curvature)) * 2.0;
        }
        energy + shear[0] * (s[0] * shear[0] + s[1] * shear[1]) + shear[1] * (s[1] * shear[0] + s[2] * shear[1])
    }
}

impl Shell {
    /// The Gauss points for coordinates and parameters of the element.
    pub fn points<S: Scalar>(&self, q: &[S], p: &[S]) -> [ShellPoint<S>; GAUSS_POINTS] {
        let mut e = vec![S::zero(); Element::strain_count(self)];
        // strains of a shell do not depend on time
        Element::strains(self, q, p, S::zero(), &mut e);
        let (field, between) = (&self.0, ShellField::between(&e, p));
        std::array::from_fn(|point| {
            let (strain, curvature, _) = ShellField::tied(point, &e, &between);
            let reference = Reference::at(p, point, field.direction(p));
            let rows = reference.in_axes();
            let thickness = match field.section {
                ShellSection::Isotropic => thickness(p, &GAUSS[point].value),
                ShellSection::Laminate => S::zero(),
            };
            ShellPoint {
                strain: rows.map(|row| dot(row, strain)),
                curvature: rows.map(|row| dot(row, curvature)),
                thickness,
                area: reference.area * gauss_weight(point),
            }
        })
    }
}

impl Field for ShellField {
    const NODES: usize = NODES;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] = &SHELL_POINTS;
    const MAPPED: Option<usize> = Some(NUMBERS);

    fn parameters(&self) -> Vec<Parameter> {
        let mut list = Vec::new();
        for node in 1..=NODES {
            for (name, unit) in [("position", "m"), ("director", "-")] {
                list.extend(["x", "y", "z"].map(|axis| Parameter::named(format!("node {node}: {name} {axis}"), unit)));
            }
        }
        match self.section {
            ShellSection::Isotropic => {
                list.extend((1..=NODES).map(|node| {
                    let own = Parameter::named(format!("thickness {node}"), "m");
                    Parameter { admissible: crate::elements::Admissible::Positive, ..own }
                }));
                list.push(Parameter::positive("young", "N/m2"));
                list.push(Parameter::new("poisson", "-"));
                list.push(Parameter::non_negative("density", "kg/m3"));
            }
            ShellSection::Laminate => {
                for (matrix, unit) in [("A", "N/m"), ("B", "N"), ("D", "N m")] {
                    let entries = ["11", "12", "13", "22", "23", "33"];
                    list.extend(entries.map(|entry| Parameter::named(format!("{matrix} {entry}"), unit)));
                }
                list.extend(["11", "12", "22"].map(|entry| Parameter::named(format!("S {entry}"), "N/m")));
                list.push(Parameter::non_negative("mass", "kg/m2"));
                list.push(Parameter::new("first moment of mass", "kg/m"));
                list.push(Parameter::non_negative("second moment of mass", "kg"));
                list.extend(["direction x", "direction y", "direction z"].map(|name| Parameter::new(name, "-")));
            }
        }
        list.push(Parameter::positive("drilling", "-"));
        list.extend(["gravity x", "gravity y", "gravity z"].map(|name| Parameter::new(name, "m/s2")));
        list.extend(self.damped.then(|| Parameter::non_negative("damping", "s")));
        list
    }

    fn parameters_of(&self, _point: usize) -> Range<usize> {
        0..self.drilling() + 4 + usize::from(self.damped)
    }

    fn node_map<S: Scalar>(&self, node: usize, q: &[S], p: &[S], y: &mut [S]) {
        let e = Quaternion::from_slice(&q[3..]);
        let inverse = e.norm_squared().recip();
        let columns = e.columns().map(|column| column * inverse);
        let turned = |axis: Vector3<S>| crate::scalar::combine_columns(&columns, axis);
        let ([first, second], _) = node_axes(p, node);
        let director = Vector3::first_three(&p[NODE_PARAMETERS * node + 3..]);
        let vectors = [Vector3::first_three(q), turned(director), turned(first), turned(second)];
        for (y, vector) in y.chunks_exact_mut(3).zip(vectors) {
            y.copy_from_slice(&vector.components());
        }
    }

    fn kinetic<S: Scalar>(&self, point: usize, v: &[S], _h: &[S], p: &[S]) -> S {
        if point < FIRST_GAUSS {
            return S::zero();
        }
        let vector = |place: usize| Vector3::first_three(&v[3 * place..]);
        if point >= FIRST_NODE {
            let [_, inertia] = self.of_node(p, point - FIRST_NODE);
            let (first, second) = (vector(2), vector(3));
            return (first.dot(&first) + second.dot(&second)) * inertia * (0.25 * DRILLING_INERTIA);
        }
        let [mass, moment, inertia] = self.inertia_at(p, point - FIRST_GAUSS);
        let (velocity, turn) = (vector(0), vector(1));
        let mut twice = velocity.dot(&velocity) * mass + turn.dot(&turn) * inertia;
        if self.section == ShellSection::Laminate {
            twice += velocity.dot(&turn) * (moment + moment);
        }
        twice * 0.5
    }

    fn potential<S: Scalar>(&self, point: usize, h: &[S], p: &[S]) -> S {
        if !(FIRST_GAUSS..FIRST_NODE).contains(&point) {
            return S::zero();
        }
        let [mass, moment, _] = self.inertia_at(p, point - FIRST_GAUSS);
        let mut weighed = Vector3::first_three(h) * mass;
        if self.section == ShellSection::Laminate {
            weighed += Vector3::first_three(&h[3..]) * moment;
        }
        -weighed.dot(&Vector3::first_three(&p[self.drilling() + 1..]))
    }

    fn strain_count(&self, point: usize) -> usize {
        match point {
            0..FIRST_GAUSS => ALONG,
            FIRST_GAUSS..FIRST_NODE => BETWEEN,
            _ => 1,
        }
    }

    fn strains<S: Scalar>(&self, point: usize, h: &[S], p: &[S], e: &mut [S]) {
        if point >= FIRST_NODE {
            let (_, [length, along, across]) = node_axes(p, point - FIRST_NODE);
            let vector = |place: usize| Vector3::first_three(&h[3 * place..]);
            let first = vector(0) * length.recip();
            let second = (vector(1) - first * along) * across.recip();
            e[0] = (first.dot(&vector(3)) - second.dot(&vector(2))) * 0.5;
            return;
        }
        let start = in_reference(point, p);
        if point < FIRST_GAUSS {
            let (now, before) = (along(h), along(&start));
            (0..ALONG).for_each(|i| e[i] = now[i] - before[i]);
        } else {
            let (now, before) = (between(h), between(&start));
            (0..BETWEEN).for_each(|i| e[i] = now[i] - before[i]);
        }
    }

    fn stored_together<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let between = Self::between(e, p);
        let mut energy = S::zero();
        for point in 0..GAUSS_POINTS {
            energy += self.energy_at(point, e, &between, p);
        }
        for node in 0..NODES {
            let [stiffness, _] = self.of_node(p, node);
            let turning = e[TURNING + node];
            energy += stiffness * p[self.drilling()] * turning * turning * 0.5;
        }
        energy
    }

    fn dissipation_together<S: Scalar>(&self, _e: &[S], rate: &[S], p: &[S]) -> S {
        if self.damped { self.stored_together(rate, p) * p[self.drilling() + 4] } else { S::zero() }
    }

    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        (0..GAUSS_POINTS).map(|point| self.inertia_at(p, point)[0]).sum()
    }
}

// the places of strains follow from the points
const _: () = assert!(FIRST_S * ALONG == STRAINS_S && FIRST_GAUSS * ALONG == STRAINS_RS && POINTS == FIRST_NODE + NODES);
