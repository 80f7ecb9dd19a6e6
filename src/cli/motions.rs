//! Pictures of a mechanism in space: the time lapse of a motion, and modes of vibration.

use super::snapshot::{Snapshot, thinned};
use crate::integrators::Mode;
use crate::io::{ColouredSurface, Facet, Frame, IoError, MotionPicture, Polyline, Role, Trail, View};
use crate::scenes::{Drawn, NodePoint, Prepared};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::Path;

/// Moments of a drawn mode, in half a period.
const MODE_MOMENTS: usize = 9;
/// Displacement of a drawn mode by the extent of the mechanism.
const MODE_SHARE: f64 = 0.15;
/// Most trails of the picture of the motion.
const MOST_TRAILS: usize = 6;
/// Most pictures of a film.
const MOST_SHOTS: usize = 90;
/// How long a film is, unless the motion itself can be watched \[s\].
const FILM: f64 = 4.0;
/// Motions that a film shows as fast as they are \[s\].
const FILM_AS_LONG_AS_THE_MOTION: std::ops::RangeInclusive<f64> = 1.0..=12.0;
/// An extent below this share of the largest is flat.
const FLAT: f64 = 1e-3;

/// When springs, dampers and links are drawn beside bodies.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Links {
    /// In the last pose: those of earlier ones would hide the bodies.
    AtTheEnd,
    Always,
}

/// Distance between the least and the largest of some numbers.
pub fn extent(values: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    most - least
}

/// A mode of vibration through half a period, so large that it is seen; `None` if nothing that is drawn moves in it.
pub fn mode_picture(prepared: &Prepared, q: &[f64], mode: &Mode) -> Option<MotionPicture> {
    let angles = (0..MODE_MOMENTS).map(|k| PI * k as f64 / (MODE_MOMENTS - 1) as f64);
    lapse(prepared, &mode_moments(prepared, q, mode, angles)?, None, Links::AtTheEnd)
}

/// A mode of vibration at some angles of its period, so large that it is seen; `None` if nothing that is drawn moves in it.
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
    let points = |size: f64| -> Option<Vec<[f64; 3]>> {
        let picture = lapse(prepared, &[moved(0.0, size)], None, Links::AtTheEnd)?;
        let lines = picture.frames.into_iter().flat_map(|frame| frame.lines).flat_map(|line| line.points);
        Some(lines.chain(picture.trails.into_iter().flat_map(|trail| trail.points)).chain(picture.anchors).collect())
    };
    // Euler parameters of a large turn lose their length: the size is that of a small one
    let small = 1e-6;
    let (at_rest, displaced) = (points(0.0)?, points(small)?);
    let farthest = at_rest
        .iter()
        .zip(&displaced)
        .fold(0.0, |most: f64, (a, b)| most.max(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()));
    let span = (0..3).fold(0.0, |most: f64, axis| most.max(extent(at_rest.iter().map(|point| point[axis]))));
    let size = MODE_SHARE * span * small / farthest;
    if !(size.is_finite() && size > 0.0) {
        return None;
    }
    Some(angles.map(|angle| moved(angle, size)).collect())
}

/// The time lapse, its last pose with shells as surfaces; `None` if nothing of the scene has a place in space.
pub fn motion(prepared: &Prepared, moments: &[Snapshot]) -> Option<MotionPicture> {
    lapse(prepared, moments, moments.last().and_then(|last| surface(prepared, last)), Links::AtTheEnd)
}

/// Writes the motion as a film; returns false if nothing of the scene has a place in space.
///
/// # Errors
/// A file that cannot be written.
pub fn write_film(prepared: &Prepared, moments: &[Snapshot], path: &Path) -> Result<bool, IoError> {
    let (Some(first), Some(last)) = (moments.first(), moments.last()) else { return Ok(false) };
    let span = last.t - first.t;
    let count = moments.len().min(MOST_SHOTS);
    let wanted = |k: usize| first.t + span * k as f64 / count as f64;
    let mut chosen: Vec<usize> = (0..count).map(|k| moments.partition_point(|own| own.t < wanted(k))).collect();
    chosen.push(moments.len() - 1);
    chosen.dedup();
    let shown: Vec<Snapshot> = chosen.into_iter().map(|place| moments[place].clone()).collect();
    let Some(picture) = lapse(prepared, &shown, None, Links::Always) else { return Ok(false) };
    let shots = shown.iter().enumerate().map(|(place, moment)| (place, surface(prepared, moment)));
    let duration = if FILM_AS_LONG_AS_THE_MOTION.contains(&span) { span } else { FILM };
    picture.write_film(shots.collect(), duration, path)?;
    Ok(true)
}

/// The shells at a moment, coloured by their stress where that is known; `None` where there are none.
fn surface(prepared: &Prepared, moment: &Snapshot) -> Option<ColouredSurface> {
    let (q, p) = (&moment.q, &prepared.mechanism.numbers.p);
    let surfaces = prepared.mechanism.surfaces();
    let facets = surfaces.iter().flat_map(|surface| {
        let pieces = surface.pieces(q);
        let values = surface.stresses(q, p).unwrap_or_else(|| vec![f64::NAN; pieces.len()]);
        pieces.into_iter().zip(values).map(|((corners, outlined), value)| Facet { corners, outlined, value })
    });
    let quantity = "von Mises stress [N/m2]".into();
    (!surfaces.is_empty()).then(|| ColouredSurface { quantity, facets: facets.collect(), range: None })
}

/// Poses at some moments; with a surface for the last one it stands in place of the lines of shells.
fn lapse(
    prepared: &Prepared,
    moments: &[Snapshot],
    surface: Option<ColouredSurface>,
    shown: Links,
) -> Option<MotionPicture> {
    let sketch = prepared.mechanism.sketch();
    if sketch.lines.is_empty() && sketch.followed.is_empty() {
        return None;
    }
    let bodies = sketch.lines.iter().any(|line| line.0 != Drawn::Link);
    // a beam joins nodes
    let is_of_body = |drawn: Drawn, points: &[NodePoint]| {
        matches!(drawn, Drawn::Body | Drawn::Solid) && points.iter().all(|own| own.is_on_node_of(&points[0]))
    };
    let parts = match sketch.lines.iter().any(|(drawn, points)| is_of_body(*drawn, points)) {
        true => prepared.mechanism.solids().part_numbers,
        false => HashMap::new(),
    };
    let role = |(drawn, points): &(Drawn, Vec<NodePoint>)| match drawn {
        Drawn::Link if bodies => Role::Link,
        _ if parts.len() > 1 && is_of_body(*drawn, points) => {
            parts.get(prepared.mechanism.node_of(&points[0])).map_or(Role::Plain, |&number| Role::Body(number))
        }
        _ => Role::Plain,
    };
    let lines: Vec<_> = sketch.lines.iter().map(|line| (line, role(line))).collect();
    let line = |((drawn, points), role): &(&(Drawn, Vec<NodePoint>), Role), moment: &Snapshot| Polyline {
        points: points.iter().map(|point| point.at(&moment.q)).collect(),
        role: *role,
        // where surfaces are drawn in every pose, lines of shells are edges of these
        is_edge: *drawn == Drawn::Solid || (*drawn == Drawn::Shell && shown == Links::Always),
    };
    let frame = |(index, moment): (usize, &Snapshot)| {
        let is_last = index + 1 == moments.len();
        let has_links = !bodies || is_last || shown == Links::Always;
        let links = lines.iter().filter(|((drawn, _), _)| *drawn == Drawn::Link && has_links);
        let covered = is_last && surface.is_some();
        let others = lines.iter().filter(|((drawn, _), _)| match drawn {
            Drawn::Body | Drawn::Solid => true,
            Drawn::Shell => !covered,
            Drawn::Link => false,
        });
        Frame { time: moment.t, lines: links.chain(others).map(|own| line(own, moment)).collect() }
    };
    let trail = |(name, point): &(String, NodePoint)| Trail {
        name: name.clone(),
        points: thinned(moments).map(|(_, moment)| point.at(&moment.q)).collect(),
    };
    let frames: Vec<Frame> = thinned(moments).map(frame).collect();
    let trails: Vec<Trail> = sketch.followed.iter().take(MOST_TRAILS).map(trail).collect();
    let title = prepared.scene.name();
    let anchors = sketch.anchors;
    let mut motion = MotionPicture { title, frames, trails, anchors, surface, view: View::Isometric, only: None };
    motion.view = view(&motion);
    Some(motion)
}

/// Along the direction in which nothing extends, or from a corner.
pub fn view(motion: &MotionPicture) -> View {
    let lines = motion.frames.iter().flat_map(|frame| &frame.lines).flat_map(|line| &line.points);
    let trails = motion.trails.iter().flat_map(|trail| &trail.points);
    let corners = motion.surface.iter().flat_map(|surface| &surface.facets).flat_map(|facet| &facet.corners);
    let points: Vec<&[f64; 3]> = lines.chain(trails).chain(&motion.anchors).chain(corners).collect();
    let extents = [0, 1, 2].map(|index| extent(points.iter().map(|point| point[index])));
    let largest = extents.iter().fold(0.0, |most: f64, &x| most.max(x));
    match extents.map(|extent| extent <= FLAT * largest) {
        // a motion along one line is seen upright
        [true, true, false] => View::Xz,
        [_, _, true] => View::Xy,
        [_, true, _] => View::Xz,
        [true, _, _] => View::Yz,
        _ => View::Isometric,
    }
}
