//! What a mechanism is made of as meshes for ParaView: shells as surfaces with their stress, beams and bodies as lines, the rest as points.

use crate::io::{Attribute, IoError, MeshCell, MeshSeries, UnstructuredMesh};
use crate::scenes::{Drawn, NodePoint, Prepared, Surface};
use std::collections::HashMap;
use std::path::Path;

/// Name of the file of the series.
pub const SERIES: &str = "fields.pvd";

/// The meshes of a run.
pub struct Meshes<'p> {
    prepared: &'p Prepared<'p>,
    series: MeshSeries,
    points: Vec<NodePoint>,
    cells: Vec<MeshCell>,
    /// The first cells are theirs.
    surfaces: Vec<Surface>,
}

/// Where points with an identity stand.
type Known = HashMap<(usize, [u64; 3]), usize>;

/// Where a point stands among others, which it joins if it is new.
fn place(points: &mut Vec<NodePoint>, known: &mut Known, point: &NodePoint) -> usize {
    *known.entry(point.identity()).or_insert_with(|| {
        points.push(point.clone());
        points.len() - 1
    })
}

impl<'p> Meshes<'p> {
    /// Meshes that will stand in a folder.
    pub fn new(prepared: &'p Prepared<'p>, folder: &Path) -> Self {
        let mechanism = &prepared.mechanism;
        let (surfaces, sketch) = (mechanism.surfaces(), mechanism.sketch());
        let (mut points, mut known, mut cells) = (Vec::new(), Known::new(), Vec::new());
        for surface in &surfaces {
            let nodes = surface.nodes.iter().map(|node| place(&mut points, &mut known, node)).collect();
            cells.push(MeshCell::Face(surface.kind.face, nodes));
        }
        // edges of shells are seen on their surfaces
        for (_, line) in sketch.lines.iter().filter(|(drawn, _)| *drawn != Drawn::Shell) {
            cells.push(MeshCell::PolyLine(line.iter().map(|point| place(&mut points, &mut known, point)).collect()));
        }
        for (_, followed) in &sketch.followed {
            let before = points.len();
            let point = place(&mut points, &mut known, followed);
            if point == before {
                cells.push(MeshCell::Vertex(point));
            }
        }
        let name = SERIES.trim_end_matches(".pvd");
        Meshes { prepared, series: MeshSeries::new(folder, name), points, cells, surfaces }
    }

    /// Writes the mesh at a time \[s\].
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn add(&mut self, t: f64, q: &[f64]) -> Result<(), IoError> {
        let mesh = self.mesh(q);
        self.series.add(t, &mesh)
    }

    /// Writes the file that names all others.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(&self) -> Result<(), IoError> {
        self.series.finish().map(drop)
    }

    fn mesh(&self, q: &[f64]) -> UnstructuredMesh {
        let numbers = &self.prepared.mechanism.numbers;
        let points: Vec<[f64; 3]> = self.points.iter().map(|point| point.at(q)).collect();
        let moved = self.points.iter().zip(&points).flat_map(|(point, now)| {
            let start = point.at(&numbers.q);
            [0, 1, 2].map(|k| now[k] - start[k])
        });
        let turned = self.points.iter().flat_map(|point| point.rotation(&numbers.q, q));
        let point_data = vec![
            Attribute { name: "displacement [m]".into(), components: 3, values: moved.collect() },
            Attribute { name: "rotation [rad]".into(), components: 3, values: turned.collect() },
        ];
        let of_cells = |name: &str, value: &dyn Fn(&Surface) -> Option<f64>| {
            let mut values: Vec<f64> = self.surfaces.iter().map(|surface| value(surface).unwrap_or(f64::NAN)).collect();
            values.resize(self.cells.len(), f64::NAN);
            Attribute { name: name.into(), components: 1, values }
        };
        let cell_data = if self.surfaces.is_empty() {
            Vec::new()
        } else {
            vec![
                of_cells("von Mises stress [N/m2]", &|surface| surface.stress(q, &numbers.p)),
                of_cells("thickness [m]", &|surface| surface.thickness(&numbers.p)),
            ]
        };
        UnstructuredMesh { points, cells: self.cells.clone(), point_data, cell_data }
    }
}
