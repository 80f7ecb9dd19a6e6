//! Meshes that Gmsh writes: files of versions 2 and 4, as text or binary.

mod collected;
mod input;
mod kinds;
mod second_order;
mod version2;
mod version4;

use super::file_bytes;
use super::mesh_data::{FilePlace, MeshData};
use collected::Collected;
use input::{Input, Result, Wrong, shown};
use std::path::Path;
use version4::Entities;

/// Largest mesh file in bytes.
const LARGEST: u64 = 2_000_000_000;

/// Versions that are read.
const VERSIONS: [f64; 5] = [2.0, 2.1, 2.2, 4.0, 4.1];

/// What writes a file anew that is of another version.
const ANEW: &str = "versions 2.0 to 2.2, 4.0 and 4.1 are read: gmsh OLD.msh -save -format msh41 -o NEW.msh writes it anew";

/// Reads the surfaces of a file of Gmsh, versions 2 and 4, text or binary, whose numbers and names are kept.
///
/// Quadrilaterals of 4, 8 and 9 nodes and triangles of 6 become faces. Triangles of 3 are raised to 6 by nodes in the middles of their edges,
/// and quadrilaterals of 4 in the same file to 9; faces of third order and higher are lowered to second, through the middles of their edges
/// (and of quadrilaterals), where there may be no node of the file. New nodes have the numbers that follow the largest of the file. Physical surfaces become
/// groups of faces, physical curves and points node sets, those of curves in the order along the curve; one without a name is called as in
/// `"surface 7"`, `"curve 3"` or `"point 1"`. In files of version 4 a surface that is in a physical group with a minus sign has its faces
/// turned round, as Gmsh does where it writes version 2. Solids, and lines and points without a physical group, are left out, which
/// [`notes`](MeshData::notes) say. Points that no face names are kept and make no nodes; parameters of nodes on their surfaces
/// (`Mesh.SaveParametric`) are passed over, as are sections that say nothing of the mesh, such as views.
///
/// # Errors
/// A file that cannot be read, is cut off or contradicts itself; other versions; partitioned meshes; elements of unknown kinds; a mesh without
/// faces. All say where (line of a text, byte of a binary file), what, and what to do.
///
/// Source: Gmsh reference manual, section "MSH file format".
pub fn read_gmsh(path: &Path) -> Result<MeshData, String> {
    let name = path.display().to_string();
    let bytes = file_bytes(path, "a mesh file", LARGEST).map_err(|why| format!("{name}: {why}"))?;
    parse_gmsh(&name, &bytes)
}

/// The same from the bytes of a file; its name is for messages.
///
/// # Errors
/// As [`read_gmsh`].
pub fn parse_gmsh(file: &str, bytes: &[u8]) -> Result<MeshData, String> {
    let mut reader = Reader { input: Input::new(bytes), ..Reader::default() };
    match reader.file().and_then(|()| reader.mesh.finish()) {
        Ok(mesh) => Ok(MeshData { file: file.into(), ..mesh }),
        Err(Wrong { place: Some(place), what }) => Err(format!("{file}{place}: {what}")),
        Err(Wrong { place: None, what }) => Err(format!("{file}: {what}")),
    }
}

#[derive(Default)]
struct Reader<'b> {
    input: Input<'b>,
    version: f64,
    /// Of version 4, if the file has the section.
    entities: Option<Entities>,
    mesh: Collected,
}

impl Default for Input<'_> {
    fn default() -> Self {
        Input::new(&[])
    }
}

/// The name of a section, from the line that begins it.
fn section_name(header: &str) -> Option<&str> {
    let is_name = |own: &&str| {
        (1..=40).contains(&own.len()) && own.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
    };
    header.strip_prefix('$').filter(is_name).filter(|own| !own.starts_with("End"))
}

impl Reader<'_> {
    fn file(&mut self) -> Result<()> {
        let mut done: Vec<&str> = Vec::new();
        let mut is_empty = true;
        while !self.input.is_at_end() {
            let place = Some(self.input.place());
            let wrong = |what: String| Err(Wrong { place, what });
            let header = self.input.next_line();
            let Some(section) = section_name(&header) else {
                return wrong(match is_empty {
                    true => "this is no mesh of Gmsh, which begins with $MeshFormat".into(),
                    false => format!("a section such as $Nodes is wanted here; there is \"{}\"", shown(&header)),
                });
            };
            is_empty = false;
            if !done.contains(&"MeshFormat") && !matches!(section, "MeshFormat" | "Comments") {
                return wrong(match section {
                    "NOD" | "NOE" => format!("the file has version 1; {ANEW}"),
                    _ => format!("${section} stands before $MeshFormat, which says how the file is written"),
                });
            }
            let Some(known) = KNOWN.into_iter().find(|own| *own == section) else {
                self.input.skip(section)?;
                continue;
            };
            // the same nodes by another name
            let own = if known == "ParametricNodes" { "Nodes" } else { known };
            if done.contains(&own) {
                return wrong(format!("there are two sections ${own}"));
            }
            done.push(own);
            self.section(known, place)?;
            self.input.end(known)?;
        }
        if is_empty {
            return Err(Wrong { place: None, what: "the file is empty".into() });
        }
        let missing = ["Nodes", "Elements"].into_iter().find(|own| !done.contains(own));
        missing.map_or(Ok(()), |section| {
            let what = format!("the section ${section} is missing: the file is cut off, or nothing was meshed");
            Err(Wrong { place: None, what })
        })
    }

    /// Reads a section, whose header stands at a place.
    fn section(&mut self, name: &str, place: Option<FilePlace>) -> Result<()> {
        let is_of_version_4 = self.version >= 4.0;
        let what = match name {
            "MeshFormat" => return self.format(),
            "PhysicalNames" => return self.physical_names(),
            "Entities" if is_of_version_4 => return self.entities(),
            "Nodes" if is_of_version_4 => return self.nodes_in_blocks(),
            "Elements" if is_of_version_4 => return self.elements_in_blocks(),
            "Nodes" => return self.nodes(false),
            "ParametricNodes" => return self.nodes(true),
            "Elements" => return self.elements(),
            "PartitionedEntities" => {
                "the mesh is partitioned; save it in one piece: UnpartitionMesh, or gmsh without -part".into()
            }
            other => format!("${other} does not belong to version {}", self.version),
        };
        Err(Wrong { place, what })
    }

    fn format(&mut self) -> Result<()> {
        let place = self.input.place();
        let wrong = |what: String| Err(Wrong { place: Some(place), what });
        let version = self.input.word("the version of the file")?;
        let Some(known) = version.parse().ok().filter(|own| VERSIONS.contains(own)) else {
            return wrong(format!("the file has version \"{}\"; {ANEW}", shown(version)));
        };
        self.version = known;
        self.input.long_numbers = known == 4.1;
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
                one if one.swap_bytes() == 1 => self.input.big_endian = true,
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
    fn physical_names(&mut self) -> Result<()> {
        let binary = std::mem::take(&mut self.input.binary);
        let count = self.input.size("the number of names")?;
        self.input.check_count(count, "names", [6; 2])?;
        for _ in 0..count {
            let place = Some(self.input.place());
            let dimension = if self.version > 2.0 { Some(self.input.int("the dimension of a group")?) } else { None };
            let number = self.input.int("the number of a group")?;
            let line = self.input.line();
            let name = line.strip_prefix('"').and_then(|own| own.strip_suffix('"')).filter(|own| !own.is_empty());
            let Some(name) = name else {
                let what = format!("the name of a physical group stands between quotes; there is {}", shown(&line));
                return Err(Wrong { place, what });
            };
            if self.mesh.names.insert((dimension, number.unsigned_abs()), name.into()).is_some() {
                let of = dimension.map_or(String::new(), |own| format!(" of dimension {own}"));
                let what = format!("the physical group {number}{of} has two names");
                return Err(Wrong { place, what });
            }
        }
        self.input.binary = binary;
        Ok(())
    }
}

/// Sections that are read.
const KNOWN: [&str; 7] =
    ["MeshFormat", "PhysicalNames", "Entities", "PartitionedEntities", "Nodes", "ParametricNodes", "Elements"];
