//! What the sections of a file say, until all of them are known and a mesh is made of it.

use super::input::{Result, Wrong};
use super::kinds::Kind;
use super::second_order::Middles;
use crate::scenes::mesh_data::{FilePlace, MeshData, reverse};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Entities by their dimension.
pub(super) const ENTITIES: [&str; 4] = ["point", "curve", "surface", "volume"];

/// An element as a file gives it: its nodes by their numbers.
pub(super) struct Element {
    pub kind: Kind,
    pub number: usize,
    pub place: FilePlace,
    pub nodes: Vec<usize>,
}

#[derive(Default)]
pub(super) struct Collected {
    /// Names of physical groups by dimension and number; those of version 2.0 have no dimension.
    pub names: HashMap<(Option<i32>, u32), String>,
    /// Places of the points by the numbers of their nodes.
    points: HashMap<usize, usize>,
    face_numbers: HashSet<usize>,
    /// Faces of physical surfaces, by the number of these.
    groups: BTreeMap<u32, BTreeSet<usize>>,
    /// Points of the elements of physical curves and points, by dimension and number of these.
    sets: BTreeMap<(i32, u32), Vec<Vec<usize>>>,
    /// Elements that nothing is made of.
    left_out: BTreeMap<Kind, usize>,
    /// Elements of third order and higher.
    lowered_kinds: BTreeMap<Kind, usize>,
    middles: Middles,
    mesh: MeshData,
}

impl Collected {
    pub fn add_node(&mut self, number: usize, place: FilePlace) -> Result<()> {
        if self.points.insert(number, self.mesh.point_numbers.len()).is_some() {
            return Err(Wrong { place: Some(place), what: format!("node {number} is there twice") });
        }
        self.mesh.point_numbers.push(number);
        Ok(())
    }
    /// Coordinates of the first node that has none yet.
    pub fn add_point(&mut self, at: [f64; 3]) {
        self.mesh.points.push(at);
    }

    /// Adds an element, which belongs to physical groups and may be turned round; returns its face.
    pub fn add_element(&mut self, element: Element, groups: &[i32], is_turned: bool) -> Result<Option<usize>> {
        let dimension = element.kind.dimension;
        if dimension == 3 || (dimension < 2 && groups.is_empty()) {
            *self.left_out.entry(element.kind).or_default() += 1;
            return Ok(None);
        }
        let mut points = self.points_of(&element)?;
        if element.kind.order > 2 {
            *self.lowered_kinds.entry(element.kind).or_default() += 1;
            points = self.middles.lower(element.kind, &points, &mut self.mesh.points);
        }
        if dimension < 2 {
            for group in groups {
                self.sets.entry((dimension, group.unsigned_abs())).or_default().push(points.clone());
            }
            return Ok(None);
        }
        if is_turned {
            reverse(&mut points);
        }
        let Element { number, place, .. } = element;
        if !self.face_numbers.insert(number) {
            return Err(Wrong { place: Some(place), what: format!("element {number} is there twice") });
        }
        let face = self.mesh.faces.len();
        self.mesh.faces.push(points);
        self.mesh.face_numbers.push(number);
        self.mesh.face_places.push(place);
        groups.iter().for_each(|group| _ = self.add_to_group(face, *group));
        Ok(Some(face))
    }
    /// Puts a face into a physical group, and says whether it is new there.
    pub fn add_to_group(&mut self, face: usize, group: i32) -> bool {
        self.groups.entry(group.unsigned_abs()).or_default().insert(face)
    }

    fn points_of(&self, element: &Element) -> Result<Vec<usize>> {
        let point = |node: &usize| {
            self.points.get(node).copied().ok_or_else(|| Wrong {
                place: Some(element.place),
                what: format!("element {} names node {node}, which $Nodes does not have", element.number),
            })
        };
        element.nodes.iter().map(point).collect()
    }

    /// Name of a physical group.
    pub fn name(&self, (dimension, number): (i32, u32)) -> String {
        let own = [Some(dimension), None].into_iter().find_map(|dimension| self.names.get(&(dimension, number)));
        own.cloned().unwrap_or_else(|| format!("{} {number}", ENTITIES[dimension as usize]))
    }

    /// The mesh, with notes of what became of the file.
    pub fn finish(mut self) -> Result<MeshData> {
        let of_file = |what: String| Wrong { place: None, what };
        let counts = self.left_out.iter().map(|(kind, count)| format!("{} ({count})", kind.words()));
        let left_out = counts.collect::<Vec<_>>().join(", ");
        if self.mesh.faces.is_empty() {
            return Err(of_file(without_faces(&left_out)));
        }
        let mut notes = Vec::new();
        if !left_out.is_empty() {
            let why = "shells are made of surfaces, node sets of physical curves and points";
            notes.push(format!("left out: {left_out}; {why}"));
        }
        notes.extend(self.make_second_order().map_err(of_file)?);
        let unused = self.mesh.used().iter().filter(|used| !**used).count();
        if unused > 0 {
            notes.push(format!("nodes that belong to no face: {unused} of {}", self.mesh.points.len()));
        }
        let groups = std::mem::take(&mut self.groups);
        self.mesh.groups =
            self.named(groups.into_iter().map(|(number, faces)| ((2, number), faces.into_iter().collect())))?;
        let sets = std::mem::take(&mut self.sets);
        self.mesh.node_sets = self.named(sets.into_iter().map(|(key, elements)| (key, in_order(elements))))?;
        self.mesh.notes = notes;
        Ok(self.mesh)
    }

    /// Makes all faces what shells have, and numbers the points that are new. Says what was changed.
    fn make_second_order(&mut self) -> Result<Option<String>, String> {
        let lowered =
            self.lowered_kinds.iter().map(|(kind, count)| format!("{} lowered to second order ({count})", kind.words()));
        let mut changes: Vec<String> = lowered.collect();
        let middles = std::mem::take(&mut self.middles);
        changes.extend(middles.raise(&mut self.mesh, self.sets.values_mut().flatten()));
        if changes.is_empty() {
            return Ok(None);
        }
        let numbers = &mut self.mesh.point_numbers;
        let added = self.mesh.points.len() - numbers.len();
        let largest = numbers.iter().max().copied().unwrap_or(0);
        let none_left = || format!("the number of node {largest} leaves none for nodes in the middles of edges");
        let last = largest.checked_add(added.max(1)).ok_or_else(none_left)?;
        numbers.extend(largest + 1..=largest + added);
        let new = if added == 0 {
            String::new()
        } else {
            format!(": nodes {} to {last} are the middles of edges and faces", largest + 1)
        };
        Ok(Some(format!("{}{new}", changes.join(", "))))
    }

    /// Groups with their names, which must differ.
    fn named(&self, all: impl Iterator<Item = ((i32, u32), Vec<usize>)>) -> Result<Vec<(String, Vec<usize>)>> {
        let mut named: Vec<(String, Vec<usize>)> = Vec::new();
        let mut taken = HashSet::new();
        for (key, own) in all {
            let name = self.name(key);
            if !taken.insert(name.clone()) {
                let kinds = if key.0 == 2 { "surfaces" } else { "curves or points" };
                let what = format!("two physical groups of {kinds} are named \"{name}\"; give them names of their own");
                return Err(Wrong { place: None, what });
            }
            named.push((name, own));
        }
        Ok(named)
    }
}

/// Points of lines and points, each once in the order along the lines.
fn in_order(elements: Vec<Vec<usize>>) -> Vec<usize> {
    let mut there = HashSet::new();
    let along = elements.into_iter().flat_map(|element| match element[..] {
        [start, end, middle] => vec![start, middle, end],
        _ => element,
    });
    along.filter(|&point| there.insert(point)).collect()
}

fn without_faces(left_out: &str) -> String {
    let saved = "where there are physical groups, only what belongs to one is saved";
    let surfaces = format!("{saved}, so that surfaces need a Physical Surface, or gmsh -save_all");
    match left_out {
        "" => format!("the mesh has no faces: mesh surfaces with gmsh -2; {surfaces}"),
        _ => {
            let wanted = "shells are made of surfaces, such as those that bound solids";
            format!("the mesh has no faces, but {left_out}: {wanted}; {surfaces}")
        }
    }
}
