//! Meshes that Gmsh writes: files of version 4.1, as text or binary.

mod input;
mod kinds;

use super::mesh_data::{FilePlace, MeshData, reverse};
use input::{Found, Input, Wrong, shown};
use kinds::{Kind, kind, refused};
use std::collections::HashMap;
use std::path::Path;

/// Largest mesh file in bytes.
const LARGEST: u64 = 2_000_000_000;

/// Reads the surfaces of a file of Gmsh, version 4.1, text or binary, whose numbers and names are kept.
///
/// Quadrilaterals of 4, 8 and 9 nodes and triangles of 6 become faces. Physical surfaces become groups of faces, physical curves and points
/// node sets, those of curves in the order along the curve; one without a name is called as in `"surface 7"`, `"curve 3"` or `"point 1"`.
/// A surface that is in a physical group with a minus sign has its faces turned round, as Gmsh does where it writes version 2. Points that
/// no face names are kept and make no nodes; parameters of nodes on their surfaces (`Mesh.SaveParametric`) are passed over, as are sections
/// that say nothing of the mesh, such as views.
///
/// # Errors
/// A file that cannot be read, is cut off or contradicts itself; other versions; partitioned meshes; elements that no shell is made of. All
/// say where (line of a text, byte of a binary file), what, and what to do.
///
/// Source: Gmsh reference manual, section "MSH file format".
pub fn read_gmsh(path: &Path) -> Result<MeshData, String> {
    let name = path.display().to_string();
    let cannot = |why: String| format!("{name}: cannot be read: {why}");
    let about = std::fs::metadata(path).map_err(|error| cannot(error.to_string()))?;
    if !about.is_file() {
        return Err(cannot("it is no file".into()));
    }
    if about.len() > LARGEST {
        return Err(cannot(format!("it has {} bytes, and a mesh file has at most {LARGEST}", about.len())));
    }
    let bytes = std::fs::read(path).map_err(|error| cannot(error.to_string()))?;
    parse_gmsh(&name, &bytes)
}

/// The same from the bytes of a file; its name is for messages.
///
/// # Errors
/// As [`read_gmsh`].
pub fn parse_gmsh(file: &str, bytes: &[u8]) -> Result<MeshData, String> {
    let mut reader = Reader { input: Input::new(bytes), ..Reader::default() };
    match reader.file() {
        Ok(()) => {}
        Err(Wrong { place: Some(place), what }) => return Err(format!("{file}{place}: {what}")),
        Err(Wrong { place: None, what }) => return Err(format!("{file}: {what}")),
    }
    reader.mesh.file = file.into();
    Ok(reader.mesh)
}

/// Physical groups of an entity; a minus sign turns its elements round.
type Groups = Vec<i32>;

#[derive(Default)]
struct Reader<'b> {
    input: Input<'b>,
    /// By dimension and number.
    names: HashMap<(i32, i32), String>,
    /// By dimension and number, if the file has the section.
    entities: Option<HashMap<(i32, i32), Groups>>,
    places: Option<HashMap<usize, usize>>,
    has_elements: bool,
    mesh: MeshData,
}

impl Default for Input<'_> {
    fn default() -> Self {
        Input::new(&[])
    }
}

/// Points of a physical group, each once in the order in which they come.
#[derive(Default)]
struct NodeSet {
    points: Vec<usize>,
    there: std::collections::HashSet<usize>,
}

impl Reader<'_> {
    fn file(&mut self) -> Found<()> {
        let mut done: Vec<String> = Vec::new();
        while !self.input.is_at_end() {
            let place = self.input.place();
            let header = self.input.next_line();
            let is_name = |own: &&str| {
                (1..=40).contains(&own.len()) && own.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
            };
            let Some(section) = header.strip_prefix('$').filter(is_name).filter(|own| !own.starts_with("End")) else {
                let header = shown(&header);
                let what = match done.is_empty() {
                    true => "this is no mesh of Gmsh, which begins with $MeshFormat".into(),
                    false => format!("a section such as $Nodes is wanted here; there is \"{header}\""),
                };
                return Err(Wrong { place: Some(place), what });
            };
            if !done.iter().any(|own| own == "MeshFormat") && !matches!(section, "MeshFormat" | "Comments") {
                let what = format!("${section} stands before $MeshFormat, which says how the file is written");
                return Err(Wrong { place: Some(place), what });
            }
            if KNOWN.contains(&section) && done.iter().any(|own| own == section) {
                return Err(Wrong { place: Some(place), what: format!("there are two sections ${section}") });
            }
            match section {
                "MeshFormat" => self.format()?,
                "PhysicalNames" => self.physical_names()?,
                "Entities" => self.entities()?,
                "PartitionedEntities" => {
                    let what = "the mesh is partitioned; save it in one piece: UnpartitionMesh, or gmsh without -part";
                    return Err(Wrong { place: Some(place), what: what.into() });
                }
                "Nodes" => self.nodes()?,
                "Elements" => self.elements()?,
                other => self.input.skip(other)?,
            }
            if KNOWN.contains(&section) {
                self.input.end(section)?;
            }
            done.push(section.into());
        }
        if done.is_empty() {
            return Err(Wrong { place: None, what: "the file is empty".into() });
        }
        for (there, section) in [(self.places.is_some(), "Nodes"), (self.has_elements, "Elements")] {
            if !there {
                let what = format!("the section ${section} is missing: the file is cut off, or nothing was meshed");
                return Err(Wrong { place: None, what });
            }
        }
        if self.mesh.faces.is_empty() {
            let what = "the mesh has no faces: mesh surfaces with gmsh -2; where there are physical groups, only what belongs to one is saved, so \
                        that the surfaces need a Physical Surface";
            return Err(Wrong { place: None, what: what.into() });
        }
        Ok(())
    }

    fn format(&mut self) -> Found<()> {
        let place = self.input.place();
        let wrong = |what: String| Err(Wrong { place: Some(place), what });
        let version = self.input.word("the version of the file")?;
        if version.parse::<f64>().ok() != Some(4.1) {
            return wrong(format!(
                "the file has version \"{version}\"; version 4.1 is read: gmsh -format msh41 or Mesh.MshFileVersion = 4.1 writes it"
            ));
        }
        let (kind, size) = (self.input.int("the type of the file")?, self.input.int("the size of its numbers")?);
        if size != 8 {
            return wrong(format!(
                "numbers of the file have {size} bytes; those of 8 bytes are read, as Gmsh writes them today"
            ));
        }
        if !matches!(kind, 0 | 1) {
            return wrong(format!("the type of the file must be 0, a text, or 1, binary; it is {kind}"));
        }
        self.input.line();
        if kind == 1 {
            self.input.binary = true;
            match self.input.int("the number 1")? {
                1 => {}
                one if one.swap_bytes() == 1 => {
                    return wrong(
                        "the file has the bytes of its numbers in the other order; save it as a text: Mesh.Binary = 0"
                            .into(),
                    );
                }
                other => {
                    return wrong(format!(
                        "the binary number behind this line must be 1; it is {other}: the file is damaged"
                    ));
                }
            }
        }
        Ok(())
    }

    /// Names of physical groups, which are a text in binary files, too.
    fn physical_names(&mut self) -> Found<()> {
        let binary = std::mem::take(&mut self.input.binary);
        let count = self.input.size("the number of names")?;
        self.input.check_count(count, "names", [6; 2])?;
        for _ in 0..count {
            let place = Some(self.input.place());
            let key = (self.input.int("the dimension of a group")?, self.input.int("the number of a group")?);
            let line = self.input.line();
            let name = line.strip_prefix('"').and_then(|own| own.strip_suffix('"')).filter(|own| !own.is_empty());
            let Some(name) = name else {
                let what = format!("the name of a physical group stands between quotes; there is {}", shown(&line));
                return Err(Wrong { place, what });
            };
            if self.names.insert(key, name.into()).is_some() {
                let what = format!("the physical group {} of dimension {} has two names", key.1, key.0);
                return Err(Wrong { place, what });
            }
        }
        self.input.binary = binary;
        Ok(())
    }

    fn entities(&mut self) -> Found<()> {
        let mut entities = HashMap::new();
        let mut counts = [0; 4];
        for (count, words) in counts.iter_mut().zip(["points", "curves", "surfaces", "volumes"]) {
            *count = self.input.size(&format!("the number of {words}"))?;
            self.input.check_count(*count, words, [10, 36])?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let number = self.input.int("the number of an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    self.input.double("a coordinate of an entity")?;
                }
                let of_groups = self.input.size("the number of physical groups")?;
                self.input.check_count(of_groups, "physical groups", [2, 4])?;
                let mut groups = Vec::new();
                for _ in 0..of_groups {
                    groups.push(self.input.int("the number of a physical group")?);
                }
                if dimension > 0 {
                    let parts = self.input.size("the number of bounding entities")?;
                    self.input.check_count(parts, "bounding entities", [2, 4])?;
                    for _ in 0..parts {
                        self.input.int("the number of a bounding entity")?;
                    }
                }
                if entities.insert((dimension, number), groups).is_some() {
                    return self.input.wrong(format!("{} {number} is there twice", ENTITIES[dimension as usize]));
                }
            }
        }
        self.entities = Some(entities);
        Ok(())
    }

    fn nodes(&mut self) -> Found<()> {
        let blocks = self.input.size("the number of blocks of nodes")?;
        let count = self.input.size("the number of nodes")?;
        let [least, most] =
            [self.input.size("the least number of a node")?, self.input.size("the largest number of a node")?];
        self.input.check_count(blocks, "blocks of nodes", [8, 20])?;
        self.input.check_count(count, "nodes", [8, 32])?;
        let mut places = HashMap::with_capacity(count);
        for _ in 0..blocks {
            let (dimension, _) = self.entity()?;
            let parametric = self.input.int("whether nodes have parameters")?;
            if !matches!(parametric, 0 | 1) {
                return self.input.wrong(format!("whether nodes have parameters must be 0 or 1; it is {parametric}"));
            }
            let own = self.input.size("the number of nodes of a block")?;
            self.input.check_count(own, "nodes", [8, 32])?;
            for _ in 0..own {
                let place = Some(self.input.place());
                let number = self.input.size("the number of a node")?;
                if number == 0 || !(least..=most).contains(&number) {
                    let what =
                        format!("the number of a node is {number}; the section announces numbers from {least} to {most}");
                    return Err(Wrong { place, what });
                }
                if places.insert(number, self.mesh.point_numbers.len()).is_some() {
                    return Err(Wrong { place, what: format!("node {number} is there twice") });
                }
                self.mesh.point_numbers.push(number);
            }
            for _ in 0..own {
                let mut at = [0.0; 3];
                for own in &mut at {
                    *own = self.input.double("a coordinate of a node")?;
                }
                self.mesh.points.push(at);
                for _ in 0..dimension * parametric {
                    self.input.double("a parameter of a node")?;
                }
            }
        }
        if places.len() != count {
            let own = places.len();
            return self.input.wrong(format!("the section announces {count} nodes, and its blocks have {own}"));
        }
        self.places = Some(places);
        Ok(())
    }

    fn elements(&mut self) -> Found<()> {
        let Some(nodes) = self.places.take() else { return self.input.wrong("$Elements stands before $Nodes") };
        let blocks = self.input.size("the number of blocks of elements")?;
        let count = self.input.size("the number of elements")?;
        let [least, most] =
            [self.input.size("the least number of an element")?, self.input.size("the largest number of an element")?];
        self.input.check_count(blocks, "blocks of elements", [8, 20])?;
        self.input.check_count(count, "elements", [4, 16])?;
        let mut numbers: std::collections::HashSet<usize> = std::collections::HashSet::with_capacity(count);
        let mut groups: HashMap<i32, Vec<usize>> = HashMap::new();
        let mut sets: HashMap<(i32, i32), NodeSet> = HashMap::new();
        for _ in 0..blocks {
            let block = self.input.place();
            let entity = self.entity()?;
            let number = self.input.int("the type of elements")?;
            let own = self.input.size("the number of elements of a block")?;
            let kind = self.kind(number, entity, block)?;
            self.input.check_count(own, "elements", [2 + 2 * kind.nodes, 8 + 8 * kind.nodes])?;
            let physical = self.groups_of(entity, block)?;
            let is_turned = self.is_turned(&physical, entity, block)?;
            for _ in 0..own {
                let place = self.input.place();
                let number = self.input.size("the number of an element")?;
                if !(least..=most).contains(&number) {
                    let what = format!(
                        "the number of an element is {number}; the section announces numbers from {least} to {most}"
                    );
                    return Err(Wrong { place: Some(place), what });
                }
                if !numbers.insert(number) {
                    return Err(Wrong { place: Some(place), what: format!("element {number} is there twice") });
                }
                let mut points = Vec::with_capacity(kind.nodes);
                for _ in 0..kind.nodes {
                    let node = self.input.size("the number of a node of an element")?;
                    let Some(&point) = nodes.get(&node) else {
                        let what = format!("element {number} names node {node}, which $Nodes does not have");
                        return Err(Wrong { place: Some(place), what });
                    };
                    points.push(point);
                }
                if entity.0 == 2 {
                    if is_turned {
                        reverse(&mut points);
                    }
                    for group in &physical {
                        groups.entry(group.abs()).or_default().push(self.mesh.faces.len());
                    }
                    self.mesh.faces.push(points);
                    self.mesh.face_numbers.push(number);
                    self.mesh.face_places.push(place);
                    continue;
                }
                if let &[start, end, middle] = points.as_slice() {
                    points = vec![start, middle, end];
                }
                for group in &physical {
                    let set = sets.entry((entity.0, group.abs())).or_default();
                    let new = points.iter().copied().filter(|&point| set.there.insert(point));
                    set.points.extend(new);
                }
            }
        }
        if numbers.len() != count {
            let own = numbers.len();
            return self.input.wrong(format!("the section announces {count} elements, and its blocks have {own}"));
        }
        self.places = Some(nodes);
        self.has_elements = true;
        self.mesh.groups = self.named(groups.into_iter().map(|(number, faces)| ((2, number), faces)))?;
        self.mesh.node_sets = self.named(sets.into_iter().map(|(key, set)| (key, set.points)))?;
        Ok(())
    }

    /// Dimension and number of an entity.
    fn entity(&mut self) -> Found<(i32, i32)> {
        let dimension = self.input.int("the dimension of an entity")?;
        if !(0..=3).contains(&dimension) {
            return self.input.wrong(format!("the dimension of an entity must be from 0 to 3; it is {dimension}"));
        }
        Ok((dimension, self.input.int("the number of an entity")?))
    }

    /// What an entity is called in messages: by its physical groups, or by its number.
    fn called(&self, entity: (i32, i32)) -> String {
        let (dimension, number) = entity;
        let groups = self.entities.as_ref().and_then(|all| all.get(&entity)).cloned().unwrap_or_default();
        let names: Vec<String> = groups.iter().map(|group| self.name((dimension, group.abs()))).collect();
        let own = format!("{} {number}", ENTITIES[dimension as usize]);
        if names.is_empty() { own } else { format!("{own}, of the physical group \"{}\"", names.join("\", \"")) }
    }

    fn kind(&mut self, number: i32, entity: (i32, i32), block: FilePlace) -> Found<Kind> {
        let wrong = |what: String| Err(Wrong { place: Some(block), what });
        let called = self.called(entity);
        match kind(number) {
            None => {
                let (words, remedy) = refused(number);
                wrong(format!("{called}: no element is made of a {words}; {remedy}"))
            }
            Some(kind) if kind.dimension != entity.0 => wrong(format!("{called}: a {} cannot be a part of it", kind.words)),
            Some(kind) => Ok(kind),
        }
    }

    fn groups_of(&self, entity: (i32, i32), block: FilePlace) -> Found<Groups> {
        let Some(entities) = &self.entities else { return Ok(Vec::new()) };
        match entities.get(&entity) {
            Some(groups) => Ok(groups.clone()),
            None => {
                let what = format!("there is no {} in $Entities", self.called(entity));
                Err(Wrong { place: Some(block), what })
            }
        }
    }

    fn is_turned(&self, groups: &Groups, entity: (i32, i32), block: FilePlace) -> Found<bool> {
        let turned = groups.iter().filter(|group| **group < 0).count();
        if turned > 0 && turned < groups.len() && entity.0 == 2 {
            let called = self.called(entity);
            let what = format!(
                "{called} is in one with a minus sign and in another without, so that its normal has two directions"
            );
            return Err(Wrong { place: Some(block), what });
        }
        Ok(turned > 0)
    }

    fn name(&self, (dimension, number): (i32, i32)) -> String {
        let own = self.names.get(&(dimension, number)).cloned();
        own.unwrap_or_else(|| format!("{} {number}", ENTITIES[dimension as usize]))
    }

    /// Groups in the order of dimension and number, with their names.
    fn named(&self, all: impl Iterator<Item = ((i32, i32), Vec<usize>)>) -> Found<Vec<(String, Vec<usize>)>> {
        let mut all: Vec<((i32, i32), Vec<usize>)> = all.collect();
        all.sort();
        let mut named: Vec<(String, Vec<usize>)> = Vec::new();
        for (key, own) in all {
            let name = self.name(key);
            if named.iter().any(|other| other.0 == name) {
                let kinds = if key.0 == 2 { "surfaces" } else { "curves or points" };
                let what = format!("two physical groups of {kinds} are named \"{name}\"; give them names of their own");
                return Err(Wrong { place: None, what });
            }
            named.push((name, own));
        }
        Ok(named)
    }
}

/// Entities by their dimension.
const ENTITIES: [&str; 4] = ["point", "curve", "surface", "volume"];

/// Sections that are read.
const KNOWN: &[&str] = &["MeshFormat", "PhysicalNames", "Entities", "Nodes", "Elements"];
