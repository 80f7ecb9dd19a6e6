//! Meshes with numbers for ParaView: `.vtu` files, binary and compressed, and a `.pvd` file that says at which time each was taken.

use super::xml::xml_text;
use super::{IoError, write_file};
use costate::elements::flexible::faces::FaceKind;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A cell of a mesh, by the numbers of its points.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshCell {
    /// One point.
    Vertex(usize),
    /// Straight lines from point to point.
    PolyLine(Vec<usize>),
    /// A face of a shell, with its points in the order of its kind.
    Face(FaceKind, Vec<usize>),
}

impl MeshCell {
    /// VTK's number of this type.
    fn kind(&self) -> u8 {
        match self {
            MeshCell::Vertex(_) => 1,
            MeshCell::PolyLine(_) => 4,
            MeshCell::Face(FaceKind::Quad4, _) => 9,
            MeshCell::Face(FaceKind::Triangle6, _) => 22,
            MeshCell::Face(FaceKind::Quad9, _) => 28,
        }
    }
    fn points(&self) -> Vec<usize> {
        match self {
            MeshCell::Vertex(point) => vec![*point],
            MeshCell::PolyLine(points) => points.clone(),
            MeshCell::Face(kind, points) => kind.shape().cyclic.iter().map(|&place| points[place]).collect(),
        }
    }
}

/// Numbers with a name, as many components for each point or cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// With the unit.
    pub name: String,
    /// 1 for numbers, 3 for vectors.
    pub components: usize,
    /// Of the first point or cell first; not a number where there is none.
    pub values: Vec<f64>,
}

/// A mesh at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnstructuredMesh {
    /// Points \[m\].
    pub points: Vec<[f64; 3]>,
    /// Cells.
    pub cells: Vec<MeshCell>,
    /// Numbers of points.
    pub point_data: Vec<Attribute>,
    /// Numbers of cells.
    pub cell_data: Vec<Attribute>,
}

/// Bytes of one block before its compression.
const BLOCK: usize = 1 << 20;

/// Bytes as letters, three of them by four: raw bytes make a file that is no XML.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = (0..3).fold(0_u32, |bits, i| bits << 8 | u32::from(three.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// Arrays behind the text of a file, each in compressed blocks.
#[derive(Default)]
struct Appended(String);

impl Appended {
    /// Adds an array and returns its place: number of blocks, bytes of a block and of a last one that is not full, bytes of each block when
    /// compressed, then the blocks.
    fn add(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let place = self.0.len();
        let compressed = bytes
            .chunks(BLOCK)
            .map(|block| {
                let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
                encoder.write_all(block)?;
                encoder.finish()
            })
            .collect::<Result<Vec<_>, _>>()?;
        let sizes = compressed.iter().map(Vec::len);
        let numbers = [compressed.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(sizes);
        self.0 += &base64(&numbers.flat_map(|number| (number as u64).to_le_bytes()).collect::<Vec<u8>>());
        self.0 += &base64(&compressed.concat());
        Ok(place)
    }
}

/// The text of an array.
fn array(name: &str, kind: &str, components: usize, place: usize) -> String {
    let name = xml_text(name);
    format!(
        "        <DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{place}\"/>\n"
    )
}

fn bytes_of(numbers: impl IntoIterator<Item = f64>) -> Vec<u8> {
    numbers.into_iter().flat_map(f64::to_le_bytes).collect()
}

impl UnstructuredMesh {
    /// Writes the mesh as a `.vtu` file.
    ///
    /// # Errors
    /// A file that cannot be written, or an attribute with too few or too many values.
    pub fn write(&self, path: &Path) -> Result<(), IoError> {
        for (attributes, count, of) in
            [(&self.point_data, self.points.len(), "points"), (&self.cell_data, self.cells.len(), "cells")]
        {
            if let Some(wrong) = attributes.iter().find(|own| own.values.len() != own.components * count) {
                let (name, values, components) = (&wrong.name, wrong.values.len(), wrong.components);
                let cause = format!("\"{name}\" has {values} values for {count} {of} with {components} components each");
                return Err(IoError::new(path, cause));
            }
        }
        let contents = self.contents().map_err(|cause| IoError::new(path, cause))?;
        write_file(path, contents.as_bytes())
    }

    fn contents(&self) -> std::io::Result<String> {
        let (mut text, mut appended) = (String::new(), Appended::default());
        text += "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" ";
        text += "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n  <UnstructuredGrid>\n";
        text += &format!("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", self.points.len(), self.cells.len());
        for (section, attributes) in [("PointData", &self.point_data), ("CellData", &self.cell_data)] {
            text += &format!("      <{section}>\n");
            for own in attributes {
                let place = appended.add(&bytes_of(own.values.iter().copied()))?;
                text += &array(&own.name, "Float64", own.components, place);
            }
            text += &format!("      </{section}>\n");
        }
        text += "      <Points>\n";
        text += &array("points", "Float64", 3, appended.add(&bytes_of(self.points.iter().flatten().copied()))?);
        text += "      </Points>\n      <Cells>\n";
        let (mut connectivity, mut offsets, mut kinds, mut count) = (Vec::new(), Vec::new(), Vec::new(), 0_i64);
        for cell in &self.cells {
            let points = cell.points();
            count += points.len() as i64;
            connectivity.extend(points.iter().flat_map(|&point| (point as i64).to_le_bytes()));
            offsets.extend(count.to_le_bytes());
            kinds.push(cell.kind());
        }
        for (name, kind, bytes) in
            [("connectivity", "Int64", connectivity), ("offsets", "Int64", offsets), ("types", "UInt8", kinds)]
        {
            text += &array(name, kind, 1, appended.add(&bytes)?);
        }
        text += "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"base64\">\n   _";
        text += &appended.0;
        text += "\n  </AppendedData>\n</VTKFile>\n";
        Ok(text)
    }
}

/// Meshes over time: `NAME.pvd`, and beside it `NAME-000000.vtu` and so on.
#[derive(Debug)]
pub struct MeshSeries {
    path: PathBuf,
    times: Vec<f64>,
}

impl MeshSeries {
    /// A series whose `.pvd` file stands in a folder under a name.
    pub fn new(folder: &Path, name: &str) -> Self {
        MeshSeries { path: folder.join(format!("{name}.pvd")), times: Vec::new() }
    }

    fn name(&self, number: usize) -> String {
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        format!("{stem}-{number:06}.vtu")
    }

    /// Writes the mesh at the next time \[s\].
    ///
    /// # Errors
    /// See [`UnstructuredMesh::write`].
    pub fn add(&mut self, time: f64, mesh: &UnstructuredMesh) -> Result<(), IoError> {
        mesh.write(&self.path.with_file_name(self.name(self.times.len())))?;
        self.times.push(time);
        Ok(())
    }

    /// Writes the `.pvd` file and returns its path.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(&self) -> Result<&Path, IoError> {
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n");
        for (number, time) in self.times.iter().enumerate() {
            text += &format!("    <DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>\n", self.name(number));
        }
        text += "  </Collection>\n</VTKFile>\n";
        write_file(&self.path, text.as_bytes())?;
        Ok(&self.path)
    }
}
