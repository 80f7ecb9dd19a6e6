//! Meshes of a file: read before the entries that name their nodes and groups.

use super::fields::{Each, Item, NodePlace, Per};
use super::mesh_groups::fixed_point;
use super::mesh_nodes::{names, nodes_of};
use super::raw::{Raw, RawValue};
use super::reader::Reader;
use crate::scenes::{MeshData, read_gmsh, unknown};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

impl Reader {
    pub(super) fn meshes(&mut self) {
        let mut read: HashMap<PathBuf, Arc<MeshData>> = HashMap::new();
        for place in 0..self.declared.len() {
            if self.declared[place].section.name != "mesh" {
                continue;
            }
            let raw = self.raws[place].clone();
            let data = match raw.get("type").and_then(|own| own.text()) {
                Some("gmsh") => self.gmsh_file(&raw, &mut read),
                Some("faces") => Some(Arc::new(given_here(&raw))),
                _ => None,
            };
            let grouped = data.and_then(|data| self.with_groups(&raw, data));
            self.declared[place].mesh = grouped.and_then(|data| self.turned_round(&raw, data));
        }
    }

    /// The mesh of a file of Gmsh; each file is read once.
    fn gmsh_file(&mut self, raw: &Raw, read: &mut HashMap<PathBuf, Arc<MeshData>>) -> Option<Arc<MeshData>> {
        // what is no text is told where values are checked
        let (key, file) = raw.get("file").and_then(|own| Some((own, own.text()?)))?;
        if file.is_empty() {
            return None;
        }
        let path = self.folder.join(file);
        if let Some(data) = read.get(&path) {
            return Some(data.clone());
        }
        match read_gmsh(&path).map(Arc::new) {
            Ok(data) => Some(read.entry(path).or_insert(data).clone()),
            Err(why) => self.refuse(key.at, format!("file, \"{file}\": {why}")),
        }
    }

    /// The mesh with the groups of the key `reverse` turned round, and with what hangs together on their side: faces that are given one by one
    /// must be on one side as they are.
    fn turned_round(&mut self, raw: &Raw, data: Arc<MeshData>) -> Option<Arc<MeshData>> {
        let list = raw.get("reverse").and_then(Raw::list).unwrap_or_default();
        let mut turned: Vec<usize> = Vec::new();
        for own in list {
            let name = own.text()?;
            match data.group(name) {
                Some(faces) => turned.extend(faces),
                None => self.wrong(own.at, format!("reverse: {}", unknown("group of faces", name, &names(&data.groups)))),
            }
        }
        turned.sort_unstable();
        turned.dedup();
        let mut data = (*data).clone();
        data.reverse(turned.iter().copied());
        if !data.file.is_empty() {
            data.orient(turned);
        }
        Some(Arc::new(data))
    }

    /// A mesh and what stands behind its name, in a text such as `plate.rim` or `plate[12]`.
    pub(super) fn of_mesh<'t>(&self, text: &'t str) -> Option<(usize, &'t str)> {
        let ends = text.char_indices().filter(|(_, letter)| matches!(letter, '.' | '[')).map(|(at, _)| at);
        ends.chain([text.len()]).find_map(|at| Some((self.find(text[..at].trim_end(), &["mesh"])?, &text[at..])))
    }

    /// Names of the groups of all meshes as they are written.
    pub(super) fn group_names(&self) -> Vec<String> {
        let meshes = self.declared.iter().filter_map(|own| Some((&own.name, own.mesh.as_ref()?)));
        meshes.flat_map(|(mesh, data)| data.groups.iter().map(move |group| format!("{mesh}.{}", group.0))).collect()
    }

    /// A node or a node set by what stands behind the name of a mesh: `plate[12]`, `plate.rim`, `plate.rim[0]`.
    pub(super) fn mesh_node(&mut self, raw: &Raw, what: &str, sets: bool, (item, rest): (usize, &str)) -> Option<NodePlace> {
        let Item { name, mesh, .. } = &self.declared[item];
        let place = |points: Vec<usize>| NodePlace { item: Some(item), points, ..NodePlace::default() };
        // a mesh that could not be read has been reported
        let Some(data) = mesh else { return Some(place(Vec::new())) };
        let found = nodes_of(data, rest).map_err(|why| format!(": {why}")).and_then(|points| match points.len() {
            0 => Err(" has no nodes".into()),
            count if count > 1 && !sets => Err(format!(
                " has {count} nodes, and one is wanted: \"{name}.SET[0]\" is the first of a set, and a [[rigid_interface]] holds all of them \
                 on a body"
            )),
            _ => Ok(place(points)),
        });
        match found {
            Ok(place) => Some(place),
            Err(why) => self.refuse(raw.at, format!("{what}: \"{}\"{why}", raw.text().unwrap_or_default())),
        }
    }

    /// The faces or points for which a design variable has values.
    pub(super) fn each(&mut self, raw: &Raw) -> Option<Each> {
        let given = [("per_face", Per::Face), ("per_node", Per::Node)].map(|(key, per)| (raw.get(key), key, per));
        let (own, key, per) = match given {
            [(Some(own), ..), (Some(_), ..)] => {
                return self.refuse(own.at, "a design variable has per_face or per_node, not both");
            }
            [(Some(own), key, per), _] | [_, (Some(own), key, per)] => (own, key, per),
            _ => return None,
        };
        // what is no text is told where values are checked
        let text = own.text().filter(|text| !text.is_empty())?;
        let Some((mesh, rest)) = self.of_mesh(text) else {
            let mut known = self.names_of(|own| own.name == "mesh");
            known.extend(self.group_names());
            return self.refuse(own.at, format!("{key}: {}", unknown("mesh", text, &known)));
        };
        let data = self.declared[mesh].mesh.clone()?;
        let faces: Vec<usize> = match rest.strip_prefix('.') {
            Some(group) => match data.group(group) {
                Some(faces) => faces.to_vec(),
                None => {
                    let text = unknown("group of faces", group, &names(&data.groups));
                    return self.refuse(own.at, format!("{key}: {text}"));
                }
            },
            None if rest.is_empty() => (0..data.faces.len()).collect(),
            None => {
                let text = format!("{key} must name a mesh, or a group of its faces; it is \"{text}\"");
                return self.refuse(own.at, text);
            }
        };
        let (places, all): (Vec<usize>, &[usize]) = match per {
            Per::Face => (faces, &data.face_numbers),
            Per::Node => {
                let points = faces.iter().filter_map(|&face| data.faces.get(face)).flatten();
                (points.copied().collect(), &data.point_numbers)
            }
        };
        // faces that a file gives with mistakes in them are told where these are checked
        let mut places: Vec<usize> = places.into_iter().filter(|&place| place < all.len()).collect();
        places.sort_unstable();
        places.dedup();
        let numbers: Vec<usize> = places.iter().map(|&place| all[place]).collect();
        (!numbers.is_empty()).then_some(Each { mesh, per, places, numbers })
    }
}

/// A mesh whose points and faces stand in the file itself, as far as they are right.
fn given_here(raw: &Raw) -> MeshData {
    let list = |key: &str| raw.get(key).and_then(Raw::list).unwrap_or_default();
    let points = list("points");
    let count = points.len();
    let number = |raw: &Raw| match raw.value {
        RawValue::Number { value, whole: true } if (0.0..count.max(1) as f64).contains(&value) => value as usize,
        // refused where values are checked
        _ => 0,
    };
    let face = |face: &Raw| face.list().unwrap_or_default().iter().map(number).collect();
    let faces: Vec<Vec<usize>> = list("faces").iter().map(face).collect();
    MeshData {
        points: points.iter().map(fixed_point).collect(),
        point_numbers: (0..count).collect(),
        face_numbers: (0..faces.len()).collect(),
        faces,
        ..MeshData::default()
    }
}
