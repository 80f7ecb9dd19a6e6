//! A mesh of faces as a file gives it: numbers, and what the file calls things.

use crate::elements::flexible::faces::FaceKind;
use std::collections::HashMap;
use std::fmt;

/// Points nearer than this share of the diagonal of the mesh stand at the same place.
const SAME_PLACE: f64 = 1e-9;

/// Where something stands in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePlace {
    /// Line of a text, from 1 on.
    Line(usize),
    /// Byte of a binary file, from 0 on.
    Byte(usize),
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            FilePlace::Line(line) => write!(f, ":{line}"),
            FilePlace::Byte(byte) => write!(f, ", byte {byte}"),
        }
    }
}

/// Points \[m, or the unit of the file\] and faces of a file, which has numbers and names of its own for them.
///
/// A [`FreeMesh`](super::FreeMesh) is [made](super::FreeMesh::of_data) of it for every scalar. Faces list the places of their points in
/// `points`, in the order in which a [`FreeMesh`](super::FreeMesh) wants them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// The file, for messages.
    pub file: String,
    /// Coordinates of the points, used or not.
    pub points: Vec<[f64; 3]>,
    /// Numbers of the points in the file.
    pub point_numbers: Vec<usize>,
    /// Places of the points of each face.
    pub faces: Vec<Vec<usize>>,
    /// Numbers of the faces in the file.
    pub face_numbers: Vec<usize>,
    /// Where the faces stand in the file; empty if that is not known.
    pub face_places: Vec<FilePlace>,
    /// Named groups of faces, by their places in `faces`.
    pub groups: Vec<(String, Vec<usize>)>,
    /// Named sets of points, by their places in `points`, those of curves in the order along the curve.
    pub node_sets: Vec<(String, Vec<usize>)>,
}

impl MeshData {
    /// Place of the point with a number of the file.
    pub fn point(&self, number: usize) -> Option<usize> {
        self.point_numbers.iter().position(|&own| own == number)
    }
    /// Faces of a group.
    pub fn group(&self, name: &str) -> Option<&[usize]> {
        self.groups.iter().find(|own| own.0 == name).map(|own| own.1.as_slice())
    }
    /// Points of a node set; of a group of faces if no set has the name, in the order of the points.
    pub fn node_set(&self, name: &str) -> Option<Vec<usize>> {
        if let Some(own) = self.node_sets.iter().find(|own| own.0 == name) {
            return Some(own.1.clone());
        }
        let mut points: Vec<usize> = self.group(name)?.iter().flat_map(|&face| self.faces[face].iter().copied()).collect();
        points.sort_unstable();
        points.dedup();
        Some(points)
    }
    /// Which points belong to a face.
    pub fn used(&self) -> Vec<bool> {
        let mut used = vec![false; self.points.len()];
        for &point in self.faces.iter().flatten() {
            used.get_mut(point).into_iter().for_each(|used| *used = true);
        }
        used
    }
    /// Numbers of two points of faces that stand at the same place: faces on both sides are not joined there.
    pub fn coincident(&self) -> Option<[usize; 2]> {
        let used = self.used();
        let own: Vec<usize> = (0..self.points.len()).filter(|&point| used[point]).collect();
        let extent = |axis: usize| {
            let all = own.iter().map(|&point| self.points[point][axis]);
            let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            most - least
        };
        let near = SAME_PLACE * extent(0).hypot(extent(1)).hypot(extent(2)).max(f64::MIN_POSITIVE);
        // points of one place lie in one of neighbouring cells; cells of far places may be one, too
        let cell = |point: usize| self.points[point].map(|own| (own / near).floor() as i64);
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::with_capacity(own.len());
        for point in own {
            let [i, j, k] = cell(point);
            for neighbour in 0..27 {
                let key = [
                    i.saturating_add(neighbour % 3 - 1),
                    j.saturating_add(neighbour / 3 % 3 - 1),
                    k.saturating_add(neighbour / 9 - 1),
                ];
                let other = cells.get(&key).into_iter().flatten().find(|&&other| {
                    let [a, b] = [point, other].map(|point| self.points[point]);
                    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2]) <= near
                });
                if let Some(&other) = other {
                    return Some([other, point].map(|point| self.point_numbers[point]));
                }
            }
            cells.entry([i, j, k]).or_default().push(point);
        }
        None
    }
    /// Turns faces round, so that their normals point to the other side; each keeps its first point.
    pub fn reverse(&mut self, faces: impl IntoIterator<Item = usize>) {
        for face in faces {
            reverse(&mut self.faces[face]);
        }
    }
}

/// Turns a face round: its corners, and the middles of its edges.
pub(super) fn reverse(face: &mut [usize]) {
    let corners = if face.len() == FaceKind::Triangle6.shape().nodes { 3 } else { 4 };
    // what has another number of points is refused where it is to become a face
    if let Some(own) = face.get_mut(1..corners) {
        own.reverse();
    }
    if let Some(middles) = face.get_mut(corners..2 * corners) {
        middles.reverse();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_turned_round_has_its_middles_between_their_corners() {
        let mut quad: Vec<usize> = (0..9).collect();
        reverse(&mut quad);
        assert_eq!(quad, [0, 3, 2, 1, 7, 6, 5, 4, 8]);
        let mut triangle: Vec<usize> = (0..6).collect();
        reverse(&mut triangle);
        assert_eq!(triangle, [0, 2, 1, 5, 4, 3]);
        let mut four: Vec<usize> = (0..4).collect();
        reverse(&mut four);
        assert_eq!(four, [0, 3, 2, 1]);
    }

    #[test]
    fn points_at_one_place_are_found_across_cells() {
        let faces = vec![vec![0, 1, 2, 3], vec![4, 5, 6, 7]];
        let points = |gap: f64| {
            let square = |x: f64| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 1.0, 1.0, 0.0], [x, 1.0, 0.0]];
            [square(0.0), square(1.0 + gap)].concat()
        };
        let mesh = |gap| MeshData {
            points: points(gap),
            point_numbers: (11..19).collect(),
            faces: faces.clone(),
            ..MeshData::default()
        };
        assert_eq!(mesh(0.0).coincident(), Some([12, 15]));
        assert_eq!(mesh(-1e-10).coincident(), Some([12, 15]));
        assert_eq!(mesh(1e-10).coincident(), Some([12, 15]));
        assert_eq!(mesh(1e-6).coincident(), None);
    }
}
