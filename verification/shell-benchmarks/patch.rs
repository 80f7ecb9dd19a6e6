//! Patches of four distorted elements whose edges are moved as a field of constant strain moves them: inside, the same field must be found.

use costate::elements::flexible::{FaceKind, Material};
use costate::elements::forces::LoadFrame;
use costate::elements::{NodeKind, TimeFunction};
use costate::internals::AppliedTorque;
use costate::prelude::*;
use costate::scenes::{Edge, ShellMesh};

/// A field of constant strain on a flat plate in the plane of x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Field {
    /// Any finite deformation in the plane.
    Membrane,
    /// Two curvatures.
    Bending,
    /// Twisting.
    Twist,
    /// Transverse shear without bending, held by couples or, where strains of faces are tied otherwise, with rotations that are held.
    Shear,
}

/// A unit square.
pub struct Patch {
    pub field: Field,
    pub face: FaceKind,
    pub thickness: f64,
}

/// Slope of the sheared plate by its thickness [1/m]: the couples that hold it then turn a node about its director by less than the slope.
const SLOPE: f64 = 0.1;
const YOUNG: f64 = 1e3;
const POISSON: f64 = 0.3;
/// Corners of the elements.
const CORNERS: [[[f64; 2]; 3]; 3] =
    [[[0.0, 0.0], [0.58, 0.0], [1.0, 0.0]], [[0.0, 0.43], [0.41, 0.57], [1.0, 0.61]], [[0.0, 1.0], [0.38, 1.0], [1.0, 1.0]]];

/// Place of node (i, j): elements have straight edges.
pub fn place(face: FaceKind, i: usize, j: usize) -> [f64; 2] {
    let ends = |k: usize| [k / 2, k.div_ceil(2)];
    if face == FaceKind::Triangle6 && i % 2 == 1 && j % 2 == 1 {
        // in the middle of the edge that divides the quadrilateral
        let [a, b] = [CORNERS[j / 2][i / 2], CORNERS[j / 2 + 1][i / 2 + 1]];
        return [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    }
    let mut sum = [0.0; 2];
    for b in ends(j) {
        for a in ends(i) {
            sum = [sum[0] + 0.25 * CORNERS[b][a][0], sum[1] + 0.25 * CORNERS[b][a][1]];
        }
    }
    sum
}

impl Field {
    /// Size of displacements, small for fields that are linear in them: the membrane feels the square of deflection by thickness.
    pub fn size(self, thickness: f64) -> f64 {
        match self {
            Field::Membrane => 1.0,
            Field::Bending | Field::Twist => 1e-5_f64.min(1e-5 * thickness),
            Field::Shear => SLOPE * thickness,
        }
    }

    /// Position and rotation that the field of some size gives to the point (X, Y).
    pub fn at(self, size: f64, [x, y]: [f64; 2]) -> ([f64; 3], [f64; 4]) {
        let tilted = |w: f64, [w_x, w_y]: [f64; 2]| {
            // d = e_3 - grad w
            let axis = [w_y, -w_x];
            let angle = axis[0].hypot(axis[1]);
            let share = if angle > 0.0 { (0.5 * angle).sin() / angle } else { 0.0 };
            ([x, y, w], [(0.5 * angle).cos(), axis[0] * share, axis[1] * share, 0.0])
        };
        match self {
            Field::Membrane => {
                let f = [[1.05, 0.02], [-0.03, 0.97]];
                // the rotation of the polar decomposition
                let half = 0.5 * f64::atan2(f[1][0] - f[0][1], f[0][0] + f[1][1]);
                let at = [f[0][0] * x + f[0][1] * y, f[1][0] * x + f[1][1] * y, 0.0];
                (at, [half.cos(), 0.0, 0.0, half.sin()])
            }
            Field::Bending => tilted(size * (0.5 * x * x - 0.35 * y * y), [size * x, -0.7 * size * y]),
            Field::Twist => tilted(size * x * y, [size * y, size * x]),
            Field::Shear => ([x, y, size * x], [1.0, 0.0, 0.0, 0.0]),
        }
    }
}

/// N_i and (dN_i/dr, dN_i/ds) of the nine nodes of an element.
fn shape(r: f64, s: f64) -> [(f64, [f64; 2]); 9] {
    let line = |x: f64| [(0.5 * x * (x - 1.0), x - 0.5), (1.0 - x * x, -2.0 * x), (0.5 * x * (x + 1.0), x + 0.5)];
    let (of_r, of_s) = (line(r), line(s));
    std::array::from_fn(|node| {
        let ((f, df), (g, dg)) = (of_r[node % 3], of_s[node / 3]);
        (f * g, [df * g, f * dg])
    })
}

/// Integral of the shape function of node (i, j) over the elements that it belongs to [m2].
fn area_of(i: usize, j: usize) -> f64 {
    let root = 0.6_f64.sqrt();
    let gauss = [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)];
    let mut sum = 0.0;
    for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let Some(own) = (0..9).find(|node| (2 * column + node % 3, 2 * row + node / 3) == (i, j)) else { continue };
        for (r, of_r) in gauss {
            for (s, of_s) in gauss {
                let all = shape(r, s);
                let mut slopes = [[0.0; 2]; 2];
                for (node, (_, derivatives)) in all.iter().enumerate() {
                    let at = place(FaceKind::Quad9, 2 * column + node % 3, 2 * row + node / 3);
                    (0..2).for_each(|k| (0..2).for_each(|l| slopes[k][l] += derivatives[k] * at[l]));
                }
                sum += of_r * of_s * all[own].0 * (slopes[0][0] * slopes[1][1] - slopes[0][1] * slopes[1][0]);
            }
        }
    }
    sum
}

impl Scene for Patch {
    fn name(&self) -> String {
        "patch".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [along, across] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from_f64);
        let mesh = ShellMesh::plate(Vector3::zeros(), [along, across], [2, 2]).with_faces(self.face);
        let mut mesh = mesh.moved(|_, i, j| {
            let [x, y] = place(self.face, i, j);
            Vector3::from_f64([x, y, 0.0])
        });
        for edge in [Edge::FirstStart, Edge::FirstEnd, Edge::SecondStart, Edge::SecondEnd] {
            mesh = mesh.clamped(edge);
        }
        let material = Material { young: S::from(YOUNG), poisson: S::from(POISSON), density: S::zero() };
        let shell = m.shell("shell", mesh, &material, S::from(self.thickness));
        for j in 0..5 {
            for i in 0..5 {
                let node = shell.node(i, j);
                if i % 4 == 0 || j % 4 == 0 {
                    let (x, e) = self.field.at(self.field.size(self.thickness), place(self.face, i, j));
                    let first = m.model.node(node).dofs.start;
                    x.into_iter().chain(e).enumerate().for_each(|(k, own)| m.numbers.q[first + k] = S::from(own));
                } else if self.field == Field::Shear && self.face != FaceKind::Quad9 {
                    // rotations are held, so that the field is in equilibrium without couples
                    let (ground, at) = (m.ground(), m.position(node));
                    m.prismatic(&format!("slide {i}, {j}"), [ground, node], at, Vector3::from_f64([0.0, 0.0, 1.0]));
                } else if self.field == Field::Shear {
                    // the shear force, constant, is held by couples instead of moments that grow
                    let force =
                        5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * self.thickness * self.field.size(self.thickness);
                    let couple = AppliedTorque { on: NodeKind::Body, frame: LoadFrame::World, size: TimeFunction::Constant };
                    let p = [0.0, 1.0, 0.0, force * area_of(i, j)].map(S::from);
                    m.element(&format!("couple {i}, {j}"), &[node], couple, &p);
                }
            }
        }
        Ok(())
    }
}
