use super::faces::{Face, FaceKind, Quad4, Quad9, Triangle6, Weights};
use super::shape::weighed;
use crate::elements::entries::{Entry, Example, Given, Key, Type, may, need};
use crate::elements::forces::load_frame::{FRAMES, LoadFrame, SIZE, size};
use crate::elements::{AnyElement, Field, Flexible, Interpolation, NodeKind, Parameter, TimeFunction};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// A pressure f(t) [N/m2] on a shell, along its normal, at the Gauss points of its [face](Face).
///
/// Dead: the force f N dA on each area of the reference. Follower: f n da = f x,r cross x,s dr ds on the deformed surface. It pushes to
/// where the normal points. Around a closed volume V the follower does the work f dV, and its forces have no resultant.
///
/// Parameters:
/// * of a dead load, at each Gauss point: `area x, y, z`  N dA, in the world \[m2\]
/// * parameters of f(t) [N/m2]
#[derive(Hash)]
pub struct ShellPressureField<F = Quad9> {
    /// Its face.
    pub face: F,
    /// Dead in the world, or follower with the body.
    pub frame: LoadFrame,
    /// Size over time.
    pub size: TimeFunction,
}

/// The pressure as an element.
pub type ShellPressure<F = Quad9> = Flexible<ShellPressureField<F>>;

impl<F: Face> ShellPressureField<F> {
    /// Number of parameters before those of f(t).
    fn areas(&self) -> usize {
        if self.frame == LoadFrame::World { 3 * F::SHAPE.gauss.len() } else { 0 }
    }
}

impl<F: Face> Field for ShellPressureField<F> {
    const NODES: usize = F::SHAPE.nodes;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] = F::SHAPE.surface_points;

    fn parameters(&self) -> Vec<Parameter> {
        let named = |point: usize, axis: &str| Parameter::named(format!("Gauss point {point}: area {axis}"), "m2");
        let areas = (1..=F::SHAPE.gauss.len()).flat_map(|point| ["x", "y", "z"].map(|axis| named(point, axis)));
        areas.take(self.areas()).chain(self.size.parameters("N/m2")).collect()
    }
    fn parameters_of(&self, _point: usize) -> Range<usize> {
        0..self.areas() + self.size.parameters("N/m2").len()
    }
    fn add_force<S: Scalar>(&self, point: usize, _v: &[S], h: &[S], p: &[S], t: S, force: &mut [S]) {
        let area = match self.frame {
            LoadFrame::World => Vector3::first_three(&p[3 * point..]),
            LoadFrame::Body => {
                Vector3::first_three(&h[3..]).cross(&Vector3::first_three(&h[6..])) * S::from(F::SHAPE.gauss_weights[point])
            }
        };
        let load = area * self.size.value(t, &p[self.areas()..]);
        for (force, load) in force.iter_mut().zip(load.components()) {
            *force += load;
        }
    }
}

/// The pressure on a face of any kind, which its number of nodes tells.
pub struct PressureOnFace;

impl Entry for PressureOnFace {
    type Law = Box<dyn AnyElement>;
    const NAME: &'static str = "pressure";
    const DOC: &'static str = "A pressure on a shell; it pushes to where the normal points.";
    const KEYS: &'static [Key] = &[
        need(
            "shell",
            Type::Item(&["shell", "mesh"]),
            "name of a shell or a mesh, or a group of the faces of one: PLATE.GROUP",
        ),
        may("frame", FRAMES, "dead load, or normal to the deformed surface; body"),
        size("N/m2"),
    ];
    const EXAMPLE: Example = (&[NodeKind::Body; Quad9::SHAPE.nodes], &[SIZE]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self::Law, Vec<S>) {
        given.all_are(NodeKind::Body, "a face of a shell");
        let (frame, (size, values)) = (LoadFrame::given(given, LoadFrame::Body), given.function("size"));
        let points = given.positions();
        let kind = FaceKind::ALL.into_iter().find(|kind| kind.shape().nodes == points.len()).unwrap_or(FaceKind::Quad9);
        let shape = kind.shape();
        let area = |(weights, &own): (&Weights, &f64)| {
            (weighed(&points, weights.by_r).cross(&weighed(&points, weights.by_s)) * S::from(own)).components()
        };
        let areas = shape.gauss.iter().zip(shape.gauss_weights).filter(|_| frame == LoadFrame::World).flat_map(area);
        let p = areas.chain(values).collect();
        let law = match kind {
            FaceKind::Quad4 => Flexible(ShellPressureField { face: Quad4, frame, size }).into(),
            FaceKind::Quad9 => Flexible(ShellPressureField { face: Quad9, frame, size }).into(),
            FaceKind::Triangle6 => Flexible(ShellPressureField { face: Triangle6, frame, size }).into(),
        };
        (law, p)
    }
}
