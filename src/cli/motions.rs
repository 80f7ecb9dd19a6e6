//! A mechanism in space as pages show it: from where it is seen first, and how modes of vibration swing.

use super::snapshot::{Snapshot, thinned};
use costate::integrators::Mode;
use costate::scenes::{Prepared, Sketch};

/// Displacement of a shown mode by the extent of the mechanism.
const MODE_SHARE: f64 = 0.15;
/// An extent below this share of the largest is flat.
const FLAT: f64 = 1e-3;

/// From where a mechanism is seen: in a plane with one axis to the right and the other one upwards, or from the direction (1, 1, 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    Xy,
    Xz,
    Yz,
    Isometric,
}

/// Distance between the least and the largest of some numbers.
pub fn extent(values: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    most - least
}

/// Extents along the axes of some points \[m\].
fn extents(points: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis| extent(points.iter().map(|point| point[axis])))
}

/// All points of a sketch at some coordinates \[m\].
fn points(sketch: &Sketch, q: &[f64]) -> Vec<[f64; 3]> {
    let moved = sketch.lines.iter().flat_map(|line| &line.1).chain(sketch.followed.iter().map(|own| &own.1));
    moved.map(|point| point.at(q)).chain(sketch.anchors.iter().copied()).collect()
}

/// The lines of a mechanism; `None` if nothing of it has a place in space.
fn sketch(prepared: &Prepared) -> Option<Sketch> {
    Some(prepared.mechanism.sketch()).filter(|sketch| !(sketch.lines.is_empty() && sketch.followed.is_empty()))
}

/// A mode of vibration at some angles of its period, so large that it is seen; `None` if nothing that is shown moves in it.
pub fn mode_moments(
    prepared: &Prepared,
    q: &[f64],
    mode: &Mode,
    angles: impl Iterator<Item = f64>,
) -> Option<Vec<Snapshot>> {
    // rigid motions have no period
    let rate = if mode.frequency > 0.0 { mode.frequency } else { 1.0 };
    let moved = |angle: f64, size: f64| Snapshot {
        t: angle / rate,
        q: q.iter()
            .zip(&mode.shape)
            .zip(&mode.ahead)
            .map(|((q, shape), ahead)| q + size * (shape * angle.cos() - ahead * angle.sin()))
            .collect(),
        ..Snapshot::default()
    };
    let sketch = sketch(prepared)?;
    // Euler parameters of a large turn lose their length: the size is that of a small one
    let small = 1e-6;
    let [at_rest, displaced] = [0.0, small].map(|size| points(&sketch, &moved(0.0, size).q));
    let farthest = at_rest
        .iter()
        .zip(&displaced)
        .fold(0.0, |most: f64, (a, b)| most.max(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()));
    let size = MODE_SHARE * extents(&at_rest).into_iter().fold(0.0, f64::max) * small / farthest;
    if !(size.is_finite() && size > 0.0) {
        return None;
    }
    Some(angles.map(|angle| moved(angle, size)).collect())
}

/// From where a motion is seen first: along the direction in which nothing extends, or from a corner; `None` if nothing of the scene has a
/// place in space.
pub fn view(prepared: &Prepared, moments: &[Snapshot]) -> Option<View> {
    let sketch = sketch(prepared)?;
    let all: Vec<[f64; 3]> = thinned(moments).flat_map(|(_, moment)| points(&sketch, &moment.q)).collect();
    let extents = extents(&all);
    let largest = extents.into_iter().fold(0.0, f64::max);
    Some(match extents.map(|extent| extent <= FLAT * largest) {
        // a motion along one line is seen upright
        [true, true, false] => View::Xz,
        [_, _, true] => View::Xy,
        [_, true, _] => View::Xz,
        [true, _, _] => View::Yz,
        _ => View::Isometric,
    })
}
