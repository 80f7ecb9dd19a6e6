//! A mesh of faces as a file gives it: numbers, and what the file calls things.

use std::collections::HashMap;
use std::fmt;

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
    /// What reading the file left out or made of it, in words.
    pub notes: Vec<String>,
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
    /// Turns faces round, so that their normals point to the other side; each keeps its first point.
    pub fn reverse(&mut self, faces: impl IntoIterator<Item = usize>) {
        for face in faces {
            reverse(&mut self.faces[face]);
        }
    }

    /// Turns faces round so that all that hang together have their normals on one side: that of most of those among them that lead, or of most
    /// of all where none of them leads; [`notes`](MeshData::notes) say how many. Faces hang together by edges that have no third face; those
    /// of a band that is twisted in itself, which has one side only, stay as they are.
    pub fn orient(&mut self, leading: impl IntoIterator<Item = usize>) {
        let mut leads = vec![false; self.faces.len()];
        leading.into_iter().for_each(|face| leads[face] = true);
        let beside = self.beside();
        let mut sides: Vec<Option<bool>> = vec![None; self.faces.len()];
        let mut turned = Vec::new();
        for first in 0..self.faces.len() {
            if sides[first].is_some() {
                continue;
            }
            sides[first] = Some(true);
            let mut all = vec![(first, true)];
            let mut has_sides = true;
            let mut next = 0;
            while let Some(&(face, side)) = all.get(next) {
                next += 1;
                for &(other, agrees) in &beside[face] {
                    let own = side == agrees;
                    match sides[other] {
                        None => {
                            sides[other] = Some(own);
                            all.push((other, own));
                        }
                        Some(known) => has_sides &= known == own,
                    }
                }
            }
            let any_leads = all.iter().any(|(face, _)| leads[*face]);
            let votes =
                |wanted: bool| all.iter().filter(|(face, side)| *side == wanted && (leads[*face] || !any_leads)).count();
            let side = votes(true) >= votes(false);
            turned.extend(all.into_iter().filter(|own| has_sides && own.1 != side).map(|own| own.0));
        }
        if !turned.is_empty() {
            let (count, of) = (turned.len(), self.faces.len());
            self.notes.push(format!(
                "turned round, so that normals point to one side where faces are joined: {count} of {of} faces"
            ));
        }
        self.reverse(turned);
    }
    /// The faces that hang together with each, and whether their normals are on its side.
    fn beside(&self) -> Vec<Vec<(usize, bool)>> {
        let mut edges: HashMap<[usize; 2], Vec<(usize, bool)>> = HashMap::new();
        for (number, face) in self.faces.iter().enumerate() {
            let corners = corners(face);
            for k in 0..corners {
                let (from, to) = (face[k], face[(k + 1) % corners]);
                edges.entry([from.min(to), from.max(to)]).or_default().push((number, from < to));
            }
        }
        let mut beside = vec![Vec::new(); self.faces.len()];
        for own in edges.into_values() {
            if let [(first, forward), (second, other)] = own[..] {
                beside[first].push((second, forward != other));
                beside[second].push((first, forward != other));
            }
        }
        beside
    }
}

/// How many corners a face has, at most as many as points.
fn corners(face: &[usize]) -> usize {
    face.len().min(if matches!(face.len(), 3 | 6) { 3 } else { 4 })
}

/// Turns a face round: its corners, and the middles of its edges.
pub(super) fn reverse(face: &mut [usize]) {
    // what has another number of points is refused where it is to become a face
    let corners = corners(face);
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
        let mut three: Vec<usize> = (0..3).collect();
        reverse(&mut three);
        assert_eq!(three, [0, 2, 1]);
        let mut four: Vec<usize> = (0..4).collect();
        reverse(&mut four);
        assert_eq!(four, [0, 3, 2, 1]);
    }
}
