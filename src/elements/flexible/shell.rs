// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::faces::{
    Between, Face, FaceKind, FaceShape, NODE_PARAMETERS, NUMBERS, Quad4, Quad9, ShellPlace, Tie, Triangle6, Weights,
};
use crate::elements::{AnyElement, Element, Field, Flexible, Interpolation, NodeKind, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use smallvec::SmallVec;
use std::ops::Range;

/// Reissner-Mindlin shell of nodes with position x and Euler parameters e, for large displacements and rotations: quadrilaterals of
/// [nine](Quad9) and [four](Quad4) nodes, triangles of [six](Triangle6).
///
/// The shell is x(r, s, z) = x(r, s) + z d(r, s) with the directors d = R(e) D of the nodes, both interpolated by the shape functions of the
/// [face](Face). With z = 0 on the reference surface, and a comma for derivatives towards r and s, its strains of Green and Lagrange are,
/// linear in z,
///
/// E_ab = (x,a . x,b - X,a . X,b) / 2,   K_ab = (x,a . d,b + x,b . d,a - X,a . D,b - X,b . D,a) / 2,   G_a = x,a . d - X,a . D.
///
/// Strains along some directions (E_tt, K_tt, G_t) are taken at tying points and interpolated to the Gauss points (MITC): which, and between
/// which places, says the face. With nine nodes E_rs and K_rs are replaced by the bilinear functions of r and s that are nearest to them in
/// the sum of squares weighted by 1/j, with dA = j dr ds. Where j is constant, these are the values at r, s = -+1/sqrt(3) that MITC9 takes, to
/// the last digit; elsewhere they keep the work of every constant stress, so that patches of distorted elements with straight edges
/// find constant strains. With these strains
///
/// V = integral of (E . A E + 2 E . B K + K . D K + G . S G) / 2 dA
///
/// in orthonormal axes: no locking in shear or along the surface, no mode without energy beside rigid motions. All nodes start with the
/// same e. A rotation about the director is held by the penalty k D w^2 / (2 l^2) dA with the turning w = (x,1 . t_2 - x,2 . t_1) / 2 of the
/// surface against the axes t_a = R(e) T_a of the node, by a quadrature at the nodes; w is zero for every rigid motion and every stretch that the
/// axes follow. D = D_33 - B_33^2 / A_33 is the stiffness against twist, and l^2 the sum of squares of the distances of neighbouring nodes in r
/// and s: the surface turns at the nodes as exactly as slopes of its shape functions do, and a penalty that is no stiffer than bending does not
/// lock what bends, however thin it is. Its inertia is `DRILLING_INERTIA` of the rotary one.
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
/// Source: that of the face; Boopathy & Kennedy, section 3, for directors from rotations in multibody systems; Hughes & Brezzi (1989) for
/// the penalty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShellField<F = Quad9> {
    /// Its face.
    pub face: F,
    /// What its section is made of.
    pub section: ShellSection,
    /// With damping proportional to stiffness.
    pub damped: bool,
}

/// What the section of a shell is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShellSection {
    /// One material, the same in all directions.
    Isotropic,
    /// Stiffnesses and inertia for each area.
    Laminate,
}

/// The shell as an element.
pub type Shell<F = Quad9> = Flexible<ShellField<F>>;

/// A shell whose face is told by its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShellKind {
    /// Kind of its face.
    pub face: FaceKind,
    /// What its section is made of.
    pub section: ShellSection,
    /// With damping proportional to stiffness.
    pub damped: bool,
}

/// What is made of a shell by its kind, for the type of its face.
macro_rules! by_face {
    ($kind:expr, $field:ident => $made:expr) => {{
        let ShellKind { face, section, damped } = $kind;
        match face {
            FaceKind::Quad4 => {
                let $field = ShellField { face: Quad4, section, damped };
                $made
            }
            FaceKind::Quad9 => {
                let $field = ShellField { face: Quad9, section, damped };
                $made
            }
            FaceKind::Triangle6 => {
                let $field = ShellField { face: Triangle6, section, damped };
                $made
            }
        }
    }};
}

impl ShellKind {
    /// The element.
    pub fn element(self) -> Box<dyn AnyElement> {
        by_face!(self, field => Flexible(field).into())
    }
    /// The Gauss points for coordinates and parameters of the element.
    pub fn points<S: Scalar>(self, q: &[S], p: &[S]) -> Vec<ShellPoint<S>> {
        by_face!(self, field => Flexible(field).points(q, p))
    }
    /// Place of the drilling factor among its parameters, before gravity.
    pub fn drilling(self) -> usize {
        by_face!(self, field => field.drilling())
    }
}

/// Inertia of a rotation about the director, as a share of the rotary inertia of the section: it belongs to no motion of the material.
pub const DRILLING_INERTIA: f64 = 1e-3;

/// Share of the shear stiffness G h that acts: that of a parabola of stresses.
const SHEAR_FACTOR: f64 = 5.0 / 6.0;

/// Strains at a tying point, with their places: along a direction, its curvature, and transverse shear.
const ALONG: usize = 3;
/// Strains at a Gauss point: between the directions, and its curvature.
const BETWEEN: usize = 2;

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
        let half = self.thickness * 0.5;
        [-half, half].map(|z| self.von_mises_at(z, young, poisson))
    }
    /// The same at the place `z` along the normal.
    pub fn von_mises_at(&self, z: S, young: S, poisson: S) -> S {
        let [plane, shear] = plane_stress(young, poisson);
        let [along, across, between] = self.strain_at(z);
        let (first, second) = (plane * (along + poisson * across), plane * (across + poisson * along));
        let mixed = shear * between;
        (first * first - first * second + second * second + mixed * mixed * 3.0).sqrt()
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
fn combine<S: Scalar>(p: &[S], weights: &[f64], place: usize) -> Vector3<S> {
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
fn in_reference<S: Scalar>(rows: &[Interpolation], p: &[S]) -> SmallVec<[S; 18]> {
    let number = |Interpolation { component, weights }: &Interpolation| {
        let own = weights.iter().enumerate();
        own.fold(S::zero(), |sum, (node, &weight)| sum + p[NODE_PARAMETERS * node + component] * weight)
    };
    rows.iter().map(number).collect()
}

/// (x,a . x,a / 2, x,a . d,a, x,a . d) from (x,a, d, d,a).
fn along<S: Scalar>(h: &[S]) -> [S; ALONG] {
    let (slope, director, turn) = (Vector3::first_three(h), Vector3::first_three(&h[3..]), Vector3::first_three(&h[6..]));
    [slope.dot(&slope) * 0.5, slope.dot(&turn), slope.dot(&director)]
}

/// (x,a . x,a / 2, x,a . d,a) from (x,a, d,a).
fn stretch<S: Scalar>(h: &[S]) -> [S; 2] {
    let (slope, turn) = (Vector3::first_three(h), Vector3::first_three(&h[3..]));
    [slope.dot(&slope) * 0.5, slope.dot(&turn)]
}

/// x,a . d from (x,a, d).
fn shear<S: Scalar>(h: &[S]) -> [S; 1] {
    [Vector3::first_three(h).dot(&Vector3::first_three(&h[3..]))]
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

/// What takes values at the Gauss points to the nearest combination of four functions: the weight of each point, and the factors of the products
/// of the functions with each other.
struct Projection<'f, S> {
    functions: &'f [[f64; 4]],
    weights: SmallVec<[S; 9]>,
    factors: [[S; 4]; 4],
}

impl<'f, S: Scalar> Projection<'f, S> {
    fn new(shape: &FaceShape, functions: &'f [[f64; 4]], p: &[S]) -> Self {
        let weight = |(weights, &own): (&Weights, &f64)| surface(p, weights).1.recip() * own;
        let weights: SmallVec<[S; 9]> = shape.gauss.iter().zip(shape.gauss_weights).map(weight).collect();
        let product = |i: usize, j: usize| {
            let own = functions.iter().zip(&weights);
            own.fold(S::zero(), |sum, (own, &weight)| sum + weight * (own[i] * own[j]))
        };
        let matrix = std::array::from_fn(|i| std::array::from_fn(|j| product(i, j)));
        Projection { functions, weights, factors: factors(matrix) }
    }
    /// Coefficients of the functions.
    fn of(&self, values: impl Fn(usize) -> S) -> [S; 4] {
        let weighted: SmallVec<[S; 9]> =
            self.weights.iter().enumerate().map(|(point, &weight)| values(point) * weight).collect();
        let products = std::array::from_fn(|i| {
            self.functions.iter().zip(&weighted).fold(S::zero(), |sum, (functions, &own)| sum + own * functions[i])
        });
        solve(&self.factors, products)
    }
}

/// Thickness of an isotropic section where shape functions have some values.
fn thickness<S: Scalar>(p: &[S], weights: &[f64]) -> S {
    weights.iter().zip(&p[NODE_PARAMETERS * weights.len()..]).fold(S::zero(), |sum, (&weight, &own)| sum + own * weight)
}

/// Tangents of the reference and its unit normal, with the area that they span.
fn surface<S: Scalar>(p: &[S], weights: &Weights) -> ([Vector3<S>; 3], S) {
    let (first, second) = (combine(p, weights.by_r, 0), combine(p, weights.by_s, 0));
    let normal = first.cross(&second);
    let area = normal.length();
    ([first, second, normal * area.recip()], area)
}

/// Axes of a node along its surface, and the tangents in them: X,r = l T_1, X,s = m T_1 + n T_2.
fn node_axes<S: Scalar>(p: &[S], at_node: &Weights) -> ([Vector3<S>; 2], [S; 3]) {
    let ([first, second, normal], _) = surface(p, at_node);
    let length = first.length();
    let along = first * length.recip();
    let across = normal.cross(&along);
    ([along, across], [length, second.dot(&along), second.dot(&across)])
}

/// Sum of strains `which` places behind those of the ties.
fn tied_sum<S: Scalar>(ties: &[Tie], e: &[S], which: usize) -> S {
    let mut terms = ties.iter().filter(|tie| tie.weight != 0.0).map(|tie| e[tie.strain + which] * tie.weight);
    let first = terms.next().unwrap_or_else(S::zero);
    terms.fold(first, |sum, term| sum + term)
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
    fn at(p: &[S], weights: &Weights, direction: Option<Vector3<S>>) -> Self {
        let ([first, second, normal], area) = surface(p, weights);
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

impl<F: Face> ShellField<F> {
    /// Place of the drilling factor, before gravity.
    pub const fn drilling(&self) -> usize {
        F::SHAPE.section()
            + match self.section {
                ShellSection::Isotropic => F::SHAPE.nodes + 3,
                ShellSection::Laminate => 27,
            }
    }
    /// What tells it from other shells.
    pub fn kind(&self) -> ShellKind {
        ShellKind { face: F::KIND, section: self.section, damped: self.damped }
    }
    /// Direction of axis 1.
    fn direction<S: Scalar>(&self, p: &[S]) -> Option<Vector3<S>> {
        (self.section == ShellSection::Laminate).then(|| Vector3::first_three(&p[F::SHAPE.section() + 24..]))
    }
    /// The section where shape functions have some values.
    fn section_at<S: Scalar>(&self, p: &[S], weights: &[f64]) -> Section<S> {
        let zero = S::zero();
        if self.section == ShellSection::Laminate {
            let own = &p[F::SHAPE.section()..];
            let triangle = |first: usize| std::array::from_fn(|i| own[first + i]);
            return Section {
                stiffness: [triangle(0), triangle(6), triangle(12)],
                shear: [own[18], own[19], own[20]],
                inertia: [own[21], own[22], own[23]],
            };
        }
        let thickness = thickness(p, weights);
        let [young, poisson, density] = [0, 1, 2].map(|place| p[F::SHAPE.young() + place]);
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
        let weights = &F::SHAPE.gauss[point];
        let (_, area) = surface(p, weights);
        let share = area * F::SHAPE.gauss_weights[point];
        self.section_at(p, weights.value).inertia.map(|inertia| inertia * share)
    }
    /// (D_33 - B_33^2 / A_33) / l^2 and m_2 of a node's share of the area.
    fn of_node<S: Scalar>(&self, p: &[S], node: usize) -> [S; 2] {
        let weights = &F::SHAPE.at_nodes[node];
        let ([first, second, _], area) = surface(p, weights);
        let share = area * F::SHAPE.node_weights[node];
        let section = self.section_at(p, weights.value);
        let [membrane, coupling, bending] = section.stiffness.map(|stiffness| stiffness[5]);
        let own = bending - coupling * coupling / membrane;
        let length_squared = (first.dot(&first) + second.dot(&second)) * F::SHAPE.spacing.powi(2);
        [own * share / length_squared, section.inertia[2] * share]
    }
    /// Strains, curvatures and shear at a Gauss point towards (r, s), from those at the tying points and the coefficients of those between.
    fn tied<S: Scalar>(point: usize, e: &[S], between: &[[S; 4]; BETWEEN]) -> ([S; 3], [S; 3], [S; 2]) {
        let tying = &F::SHAPE.tying;
        let ties = &tying.ties[point];
        let [strain, curvature] = [0, 1].map(|which| {
            let [along_r, along_s] = [0, 1].map(|direction| tied_sum(&ties.stretch[direction], e, which));
            let between = match tying.between {
                Between::Projected(functions) => dot(between[which], functions[point].map(S::from)),
                Between::Own => e[F::SHAPE.first_strains()[0] + BETWEEN * point + which],
                Between::ThirdDirection => along_r + along_s - tied_sum(&ties.stretch[2], e, which),
            };
            [along_r, along_s, between]
        });
        (strain, curvature, [0, 1].map(|direction| tied_sum(&ties.shear[direction], e, 0)))
    }
    /// Coefficients of the projected strains and curvatures between r and s.
    fn between<S: Scalar>(e: &[S], p: &[S]) -> [[S; 4]; BETWEEN] {
        let Between::Projected(functions) = F::SHAPE.tying.between else { return [[S::zero(); 4]; BETWEEN] };
        let (projection, [first, _]) = (Projection::new(F::SHAPE, functions, p), F::SHAPE.first_strains());
        [0, 1].map(|which| projection.of(|point| e[first + BETWEEN * point + which]))
    }
    /// Energy of the strains at a Gauss point.
    fn energy_at<S: Scalar>(&self, point: usize, e: &[S], between: &[[S; 4]; BETWEEN], p: &[S]) -> S {
        let (strain, curvature, shear) = Self::tied(point, e, between);
        let weights = &F::SHAPE.gauss[point];
        let section = self.section_at(p, weights.value);
        let reference = Reference::at(p, weights, self.direction(p));
        let share = reference.area * (0.5 * F::SHAPE.gauss_weights[point]);
        let [a, b, d] = section.stiffness.map(|stiffness| reference.covariant(&stiffness, share));
        let s = reference.covariant_shear(&section.shear, share);
        let mut energy = dot(strain, times(&a, strain)) + dot(curvature, times(&d, curvature));
        if self.section == ShellSection::Laminate {
            energy += dot(strain, times(&b, curvature)) * 2.0;
        }
        energy + shear[0] * (s[0] * shear[0] + s[1] * shear[1]) + shear[1] * (s[1] * shear[0] + s[2] * shear[1])
    }
}

impl<F: Face> Shell<F> {
    /// The Gauss points for coordinates and parameters of the element.
    pub fn points<S: Scalar>(&self, q: &[S], p: &[S]) -> Vec<ShellPoint<S>> {
        let mut e = vec![S::zero(); Element::strain_count(self)];
        // strains of a shell do not depend on time
        Element::strains(self, q, p, S::zero(), &mut e);
        let (field, between) = (&self.0, ShellField::<F>::between(&e, p));
        let at = |(point, weights): (usize, &Weights)| {
            let (strain, curvature, _) = ShellField::<F>::tied(point, &e, &between);
            let reference = Reference::at(p, weights, field.direction(p));
            let rows = reference.in_axes();
            let thickness = match field.section {
                ShellSection::Isotropic => thickness(p, weights.value),
                ShellSection::Laminate => S::zero(),
            };
            ShellPoint {
                strain: rows.map(|row| dot(row, strain)),
                curvature: rows.map(|row| dot(row, curvature)),
                thickness,
                area: reference.area * F::SHAPE.gauss_weights[point],
            }
        };
        F::SHAPE.gauss.iter().enumerate().map(at).collect()
    }
}

impl<F: Face> Field for ShellField<F> {
    const NODES: usize = F::SHAPE.nodes;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] = F::SHAPE.points;
    const MAPPED: Option<usize> = Some(NUMBERS);

    fn parameters(&self) -> Vec<Parameter> {
        let mut list = Vec::new();
        for node in 1..=Self::NODES {
            for (name, unit) in [("position", "m"), ("director", "-")] {
                list.extend(["x", "y", "z"].map(|axis| Parameter::named(format!("node {node}: {name} {axis}"), unit)));
            }
        }
        match self.section {
            ShellSection::Isotropic => {
                list.extend((1..=Self::NODES).map(|node| {
                    let own = Parameter::named(format!("thickness {node}"), "m").as_size();
                    Parameter { admissible: crate::elements::Admissible::Positive, ..own }
                }));
                list.push(Parameter::positive("young", "N/m2"));
                list.push(Parameter::new("poisson", "-"));
                list.push(Parameter::non_negative("density", "kg/m3"));
            }
            ShellSection::Laminate => {
                for (matrix, unit) in [("A", "N/m"), ("B", "N"), ("D", "N m")] {
                    let entries = ["11", "12", "13", "22", "23", "33"];
                    list.extend(entries.map(|entry| Parameter::named(format!("{matrix} {entry}"), unit).as_size()));
                }
                list.extend(["11", "12", "22"].map(|entry| Parameter::named(format!("S {entry}"), "N/m").as_size()));
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
        let ([first, second], _) = node_axes(p, &F::SHAPE.at_nodes[node]);
        let director = Vector3::first_three(&p[NODE_PARAMETERS * node + 3..]);
        let vectors = [Vector3::first_three(q), turned(director), turned(first), turned(second)];
        for (y, vector) in y.chunks_exact_mut(3).zip(vectors) {
            y.copy_from_slice(&vector.components());
        }
    }

    fn kinetic<S: Scalar>(&self, point: usize, v: &[S], _h: &[S], p: &[S]) -> S {
        let vector = |place: usize| Vector3::first_three(&v[3 * place..]);
        match F::SHAPE.place(point) {
            ShellPlace::Gauss(point) => {
                let [mass, moment, inertia] = self.inertia_at(p, point);
                let (velocity, turn) = (vector(0), vector(1));
                let mut twice = velocity.dot(&velocity) * mass + turn.dot(&turn) * inertia;
                if self.section == ShellSection::Laminate {
                    twice += velocity.dot(&turn) * (moment + moment);
                }
                twice * 0.5
            }
            ShellPlace::Node(node) => {
                let [_, inertia] = self.of_node(p, node);
                let (first, second) = (vector(2), vector(3));
                (first.dot(&first) + second.dot(&second)) * inertia * (0.25 * DRILLING_INERTIA)
            }
            ShellPlace::Along | ShellPlace::Stretch | ShellPlace::Shear => S::zero(),
        }
    }

    fn potential<S: Scalar>(&self, point: usize, h: &[S], p: &[S]) -> S {
        let ShellPlace::Gauss(point) = F::SHAPE.place(point) else { return S::zero() };
        let [mass, moment, _] = self.inertia_at(p, point);
        let mut weighed = Vector3::first_three(h) * mass;
        if self.section == ShellSection::Laminate {
            weighed += Vector3::first_three(&h[3..]) * moment;
        }
        -weighed.dot(&Vector3::first_three(&p[self.drilling() + 1..]))
    }

    fn strain_count(&self, point: usize) -> usize {
        F::SHAPE.strain_count(F::SHAPE.place(point))
    }

    fn strains<S: Scalar>(&self, point: usize, h: &[S], p: &[S], e: &mut [S]) {
        let place = F::SHAPE.place(point);
        if let ShellPlace::Node(node) = place {
            let (_, [length, along, across]) = node_axes(p, &F::SHAPE.at_nodes[node]);
            let vector = |place: usize| Vector3::first_three(&h[3 * place..]);
            let first = vector(0) * length.recip();
            let second = (vector(1) - first * along) * across.recip();
            e[0] = (first.dot(&vector(3)) - second.dot(&vector(2))) * 0.5;
            return;
        }
        let start = in_reference(F::SHAPE.points[point], p);
        let differ = |e: &mut [S], now: &[S], before: &[S]| {
            e.iter_mut().zip(now).zip(before).for_each(|((e, &now), &before)| *e = now - before);
        };
        match place {
            ShellPlace::Along => differ(e, &along(h), &along(&start)),
            ShellPlace::Stretch => differ(e, &stretch(h), &stretch(&start)),
            ShellPlace::Shear => differ(e, &shear(h), &shear(&start)),
            ShellPlace::Gauss(_) => differ(e, &between(h), &between(&start)),
            ShellPlace::Node(_) => {}
        }
    }

    fn stored_together<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let between = Self::between(e, p);
        let mut energy = S::zero();
        for point in 0..F::SHAPE.gauss.len() {
            energy += self.energy_at(point, e, &between, p);
        }
        let [_, first_turning] = F::SHAPE.first_strains();
        for node in 0..Self::NODES {
            let [stiffness, _] = self.of_node(p, node);
            let turning = e[first_turning + node];
            energy += stiffness * p[self.drilling()] * turning * turning * 0.5;
        }
        energy
    }

    fn dissipation_together<S: Scalar>(&self, _e: &[S], rate: &[S], p: &[S]) -> S {
        if self.damped { self.stored_together(rate, p) * p[self.drilling() + 4] } else { S::zero() }
    }

    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        (0..F::SHAPE.gauss.len()).map(|point| self.inertia_at(p, point)[0]).sum()
    }
}
