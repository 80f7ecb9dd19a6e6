//! Faces near points: where nodes of one mesh lie on the surface of another.

use crate::elements::flexible::faces::{FaceShape, MOST_NODES};
use crate::elements::flexible::shape::weighed;
use crate::scalar::{SpatialVector, Vector3};
use smallvec::SmallVec;
use std::collections::HashMap;

/// Lines that enclose a smaller angle \[rad\], and faces, run along each other: 6 degrees.
pub(super) const ALONG: f64 = 0.1;

/// Cells that one face may be listed in; a larger one is looked at for every point.
const MOST_CELLS: usize = 512;
/// Corrections of a place on a face.
const CORRECTIONS: usize = 30;

pub(super) type Point = Vector3<f64>;

pub(super) fn length(a: Point) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}
/// Cosine of the angle between two directions; not a number for one of length zero.
pub(super) fn cosine(a: Point, b: Point) -> f64 {
    a.dot(&b) / (length(a) * length(b))
}
/// A place for messages.
pub(super) fn shown(point: Point) -> String {
    let [x, y, z] = point.components().map(|own| crate::design::shortest(own + 0.0));
    format!("({x}, {y}, {z}) m")
}

/// A face of a mesh with the places of its nodes.
pub(super) struct PlacedFace {
    pub shape: &'static FaceShape,
    pub nodes: SmallVec<[Point; MOST_NODES]>,
}

/// The face that a point is nearest to, and the place (r, s) on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub face: usize,
    pub at: [f64; 2],
    pub distance: f64,
}

/// Shape functions of a face and their derivatives at (r, s): differences of polynomials of second degree are exact.
pub(super) fn shape_functions(shape: &FaceShape, [r, s]: [f64; 2]) -> [SmallVec<[f64; MOST_NODES]>; 3] {
    let n = |dr: f64, ds: f64| (shape.values)(r + dr, s + ds);
    let half = |after: SmallVec<[f64; MOST_NODES]>, before: SmallVec<[f64; MOST_NODES]>| {
        after.iter().zip(&before).map(|(a, b)| 0.5 * (a - b)).collect()
    };
    [n(0.0, 0.0), half(n(1.0, 0.0), n(-1.0, 0.0)), half(n(0.0, 1.0), n(0.0, -1.0))]
}

impl PlacedFace {
    pub fn is_triangle(&self) -> bool {
        self.shape.corners == 3
    }
    /// The nearest place in the domain of the face.
    pub fn inside(&self, [r, s]: [f64; 2]) -> [f64; 2] {
        if !self.is_triangle() {
            return [r.clamp(-1.0, 1.0), s.clamp(-1.0, 1.0)];
        }
        let beyond = 0.5 * (r + s - 1.0).max(0.0);
        let (r, s) = ((r - beyond).max(0.0), (s - beyond).max(0.0));
        let sum = (r + s).max(1.0);
        [r / sum, s / sum]
    }
    pub fn box_around(&self) -> [Point; 2] {
        let nodes = self.nodes.iter();
        let (least, most) = nodes.fold((self.nodes[0], self.nodes[0]), |(least, most), own| (least.inf(own), most.sup(own)));
        // faces bulge beyond their nodes
        let bulge = 0.1 * length(most - least);
        [least.map(|own| own - bulge), most.map(|own| own + bulge)]
    }
    /// The place nearest to a point and its distance: by Gauss and Newton's method from places all over the face, kept inside.
    fn foot(&self, point: Point) -> ([f64; 2], f64) {
        let starts: &[[f64; 2]] = match self.is_triangle() {
            true => &[[1.0 / 3.0, 1.0 / 3.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            false => &[[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
        };
        let mut nearest = (starts[0], f64::INFINITY);
        for &start in starts {
            let mut at = start;
            for _ in 0..CORRECTIONS {
                let [own, first, second] = shape_functions(self.shape, at).map(|weights| weighed(&self.nodes, &weights));
                let gap = own - point;
                if length(gap) < nearest.1 {
                    nearest = (at, length(gap));
                }
                let tangents = [first, second];
                let [[a, b], [_, d]] = tangents.map(|first| tangents.map(|second| first.dot(&second)));
                let (r, s) = (gap.dot(&tangents[0]), gap.dot(&tangents[1]));
                let determinant = a * d - b * b;
                let next = self.inside([at[0] - (d * r - b * s) / determinant, at[1] - (a * s - b * r) / determinant]);
                if !(next[0].is_finite() && next[1].is_finite()) {
                    break;
                }
                let moved = (next[0] - at[0]).abs() + (next[1] - at[1]).abs();
                at = next;
                if moved < 1e-15 {
                    break;
                }
            }
        }
        nearest
    }
}

/// The faces of some meshes, found by places.
pub(super) struct Surfaces {
    faces: Vec<PlacedFace>,
    /// Least and largest coordinates of each face.
    boxes: Vec<[Point; 2]>,
    /// Faces within reach of each cell of a grid of cubes, apart from those in `large`.
    cells: HashMap<[i64; 3], Vec<usize>>,
    /// Faces that would stand in more than [`MOST_CELLS`] cells.
    large: Vec<usize>,
    /// Width of the cells \[m\].
    cell: f64,
    /// From how far away points find faces \[m\].
    reach: f64,
}

impl Surfaces {
    /// Faces that are found from points up to `reach` \[m\] away.
    pub fn new(faces: Vec<PlacedFace>, reach: f64) -> Self {
        let boxes: Vec<[Point; 2]> = faces.iter().map(PlacedFace::box_around).collect();
        let mean = boxes.iter().map(|[least, most]| length(most - least)).sum::<f64>() / boxes.len().max(1) as f64;
        let cell = mean.max(2.0 * reach).max(f64::MIN_POSITIVE);
        let mut own = Surfaces { faces, boxes, cells: HashMap::new(), large: Vec::new(), cell, reach };
        for face in 0..own.faces.len() {
            let [least, most] = own.boxes[face];
            let (from, to) = (own.cell_of(least.map(|x| x - reach)), own.cell_of(most.map(|x| x + reach)));
            let counts = [0, 1, 2].map(|axis| to[axis].saturating_sub(from[axis]) as usize + 1);
            if counts.iter().fold(1_usize, |all, &own| all.saturating_mul(own)) > MOST_CELLS {
                own.large.push(face);
                continue;
            }
            for i in from[0]..=to[0] {
                for j in from[1]..=to[1] {
                    (from[2]..=to[2]).for_each(|k| own.cells.entry([i, j, k]).or_default().push(face));
                }
            }
        }
        own
    }
    fn cell_of(&self, point: Point) -> [i64; 3] {
        point.map(|x| (x / self.cell).floor() as i64).into()
    }
    /// The nearest foot within reach on faces that are wanted.
    pub fn nearest(&self, point: Point, is_wanted: impl Fn(usize) -> bool) -> Option<Foot> {
        let listed = self.cells.get(&self.cell_of(point)).into_iter().flatten().chain(&self.large);
        let is_near = |face: usize| {
            let [least, most] = self.boxes[face];
            (0..3).all(|axis| (least[axis] - self.reach..=most[axis] + self.reach).contains(&point[axis]))
        };
        let mut found: Option<Foot> = None;
        for &face in listed.filter(|&&face| is_wanted(face) && is_near(face)) {
            let (at, distance) = self.faces[face].foot(point);
            if distance <= self.reach && found.is_none_or(|own| distance < own.distance) {
                found = Some(Foot { face, at, distance });
            }
        }
        found
    }
    /// The nearest of all feet on faces that are wanted, however far away.
    pub fn nearest_of_all(&self, point: Point, is_wanted: impl Fn(usize) -> bool) -> Option<Foot> {
        let foot = |face: usize| {
            let (at, distance) = self.faces[face].foot(point);
            Foot { face, at, distance }
        };
        (0..self.faces.len()).filter(|&face| is_wanted(face)).map(foot).min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
    /// Its faces.
    pub fn faces(&self) -> &[PlacedFace] {
        &self.faces
    }
    /// How far away points find them \[m\].
    pub fn reach(&self) -> f64 {
        self.reach
    }
}

/// Items by their places.
pub(super) struct PlaceIndex<T> {
    /// Items in each cell of a grid of cubes, twice as wide as `near`.
    cells: HashMap<[i64; 3], Vec<(T, Point)>>,
    /// From how far away places find items \[m\].
    near: f64,
}

impl<T: Copy + Ord> PlaceIndex<T> {
    /// Items that are found from places up to `near` \[m\] away.
    pub fn new(near: f64) -> Self {
        PlaceIndex { cells: HashMap::new(), near }
    }
    fn cell(&self, place: Point) -> [i64; 3] {
        place.map(|x| (x / (2.0 * self.near).max(f64::MIN_POSITIVE)).floor() as i64).into()
    }
    pub fn add(&mut self, item: T, place: Point) {
        self.cells.entry(self.cell(place)).or_default().push((item, place));
    }
    /// The nearest item at a place.
    pub fn find(&self, place: Point) -> Option<T> {
        let own = self.cell(place);
        let around = (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]);
        let cells = around.map(|step| [0, 1, 2].map(|axis: usize| own[axis].saturating_add(step[axis])));
        let items = cells.filter_map(|cell| self.cells.get(&cell)).flatten();
        let gaps = items.map(|(item, other)| (*item, length(other - place))).filter(|own| own.1 <= self.near);
        gaps.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))).map(|own| own.0)
    }
}
