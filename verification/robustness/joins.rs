//! Shells joined to each other, drawn by lot: what becomes of each, against one shell.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::{Noise, Report};
use costate::elements::flexible::{FaceKind, Material};
use costate::prelude::*;
use costate::scenes::{Edge, FreeMesh, ShellMember};

/// Cases.
const DRAWN: usize = 60;
/// Length of an element, and width of the strip [m].
const LENGTH: f64 = 0.1;
const WIDTH: f64 = 0.2;
/// Gap, as a share of the diagonal of a panel, up to which nodes are one: what the builder promises.
const SAME_PLACE: f64 = 1e-6;
/// Deflection that joined panels may be off that of one shell, as a share of it: what a gap of a millionth of a panel leaves.
const OFF: f64 = 1e-4;

/// A strip of panels along x, clamped at its start and loaded at its end.
#[derive(Clone, Debug)]
struct Strip {
    /// Elements of each panel along and across.
    panels: Vec<[usize; 2]>,
    /// Before each panel but the first [m].
    gaps: Vec<f64>,
    face: FaceKind,
}

impl Scene for Strip {
    fn name(&self) -> String {
        "strip".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("thickness", 0.01, (0.001, 0.1), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let material = Material { young: S::from(7e10), poisson: S::from(0.3), density: S::from(2700.0) };
        let vector = |components| Vector3::<S>::from_f64(components);
        let mut panels: Vec<ShellMember> = Vec::new();
        let mut start = 0.0;
        for (number, &[along, across]) in self.panels.iter().enumerate() {
            let corner = vector([start + if number > 0 { self.gaps[number - 1] } else { 0.0 }, 0.0, 0.0]);
            let length = LENGTH * along as f64;
            let mesh = ShellMesh::plate(corner, [vector([length, 0.0, 0.0]), vector([0.0, WIDTH, 0.0])], [along, across]);
            let mesh = mesh.with_faces(self.face);
            let mesh = match panels.last() {
                Some(before) => m.joined(mesh, &[before]),
                None => mesh.clamped(Edge::FirstStart),
            };
            panels.push(m.shell(&format!("panel {}", number + 1), mesh, &material, x[0]));
            start += length;
        }
        if let Some(last) = panels.last() {
            let node = last.node(2 * last.counts[0], 0);
            let (point, direction) = (m.position(node), vector([0.0, 0.0, 1.0]));
            let size = Signal::of(TimeFunction::ConstantRate, &[S::zero(), S::from(10.0)]);
            m.force("pull", Force { on: node, point, direction, frame: LoadFrame::World, size });
            m.position_functional("tip", Over::Terminal, node, point, direction);
        }
        Ok(())
    }
}

impl Strip {
    fn draw(noise: &mut Noise) -> Self {
        let mut below = |count: usize| (0.5 * (noise.next() + 1.0) * count as f64) as usize % count;
        let (count, across) = (2 + below(3), 1 + below(3));
        let mut panels: Vec<[usize; 2]> = (0..count).map(|_| [1 + below(2), across]).collect();
        if below(3) == 0 {
            let other = below(count);
            panels[other][1] = 1 + (across + below(2)) % 3;
        }
        let mut gap = || {
            let size = 10f64.powf(-12.0 + 10.0 * (below(1000) as f64 / 1000.0));
            if below(2) == 0 { 0.0 } else { size * if below(2) == 0 { 1.0 } else { -1.0 } }
        };
        let gaps = (1..count).map(|_| gap()).collect();
        let face = FaceKind::ALL[below(3)];
        Strip { panels, gaps, face }
    }
    /// Whether all panels fit, do not fit, or stand just as far from each other as may be.
    fn fits(&self) -> Option<bool> {
        if self.panels.iter().any(|panel| panel[1] != self.panels[0][1]) {
            return Some(false);
        }
        let shares = self
            .gaps
            .iter()
            .zip(&self.panels[1..])
            .map(|(gap, panel)| gap.abs() / (SAME_PLACE * (LENGTH * panel[0] as f64).hypot(WIDTH)));
        let largest = shares.fold(0.0, f64::max);
        if (0.9..1.1).contains(&largest) { None } else { Some(largest < 1.0) }
    }
    fn as_one(&self) -> Self {
        let along = self.panels.iter().map(|panel| panel[0]).sum();
        Strip { panels: vec![[along, self.panels[0][1]]], gaps: Vec::new(), face: self.face }
    }
    fn tip(&self) -> Result<f64, String> {
        let prepared = Prepared::new(self).map_err(|error| error.to_string())?;
        let forward = prepared.analysis().forward(&prepared.x).map_err(|error| error.to_string())?;
        Ok(forward.values[0])
    }
}

/// What is wrong, points, and faces of a mesh.
type Sheet = (&'static str, Vec<[f64; 2]>, Vec<Vec<usize>>);

/// Meshes that must be refused: each a square and what stands wrong beside it.
fn refused() -> Vec<Sheet> {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let with = |points: &[[f64; 2]]| [&square[..], points].concat();
    let (own, beside) = (vec![0, 1, 2, 3], [[2.0, 0.0], [2.0, 1.0]]);
    let halves = [[1.0, 0.5], [2.0, 0.0], [2.0, 0.5], [2.0, 1.0]];
    let near = [[1.0 + 1e-9, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0 + 1e-9, 1.0]];
    vec![
        ("twice", square.to_vec(), vec![own.clone(), own.clone()]),
        ("twice, reversed", square.to_vec(), vec![own.clone(), vec![3, 2, 1, 0]]),
        ("one upon two", with(&beside), vec![own.clone(), vec![1, 4, 5, 2], vec![0, 4, 5, 3]]),
        ("two beside one", with(&halves), vec![own.clone(), vec![1, 5, 6, 4], vec![4, 6, 7, 2]]),
        ("points at one place", with(&near), vec![own, vec![4, 5, 6, 7]]),
    ]
}

/// Draws strips and counts what becomes of them.
pub fn count(report: &mut Report) {
    let mut noise = Noise::new(12);
    let [mut right, mut errors, mut wrong, mut falsely] = [0.0; 4];
    for _ in 0..DRAWN {
        let strip = Strip::draw(&mut noise);
        let Some(fits) = strip.fits() else { continue };
        match (strip.tip(), fits) {
            (Ok(tip), true) => match strip.as_one().tip() {
                Ok(one) if (tip / one - 1.0).abs() <= OFF => right += 1.0,
                other => {
                    report.note(format!("{strip:?} is wrong: {tip:e} m, and as one shell {other:?}"));
                    wrong += 1.0;
                }
            },
            (Ok(tip), false) => {
                report.note(format!("{strip:?} does not fit, and gives {tip:e} m"));
                wrong += 1.0;
            }
            (Err(why), true) => {
                report.note(format!("{strip:?} fits: {why}"));
                falsely += 1.0;
            }
            (Err(why), false) => {
                if why.contains("joined to") {
                    errors += 1.0;
                } else {
                    report.note(format!("{strip:?}, refused for another reason: {why}"));
                    wrong += 1.0;
                }
            }
        }
    }
    for (name, points, faces) in refused() {
        let mut m = MechanismBuilder::<f64>::default();
        let material = Material { young: 7e10, poisson: 0.3, density: 2700.0 };
        let points = points.into_iter().map(|[x, y]| Vector3::new(x, y, 0.0)).collect();
        m.shell("sheet", FreeMesh::new(points, faces), &material, 0.01);
        if m.finish().is_ok() {
            report.note(format!("a mesh with faces {name} is taken"));
            wrong += 1.0;
        } else {
            errors += 1.0;
        }
    }
    report.inform("joins/right", right);
    report.inform("joins/refused, with the place", errors);
    report.at_most("joins/refused though they fit", falsely, 0.0);
    report.at_most("joins/wrong", wrong, 0.0);
}
