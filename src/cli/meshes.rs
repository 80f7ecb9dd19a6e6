//! What a mechanism is made of as meshes for ParaView: shells as surfaces with their stress, beams and cables as lines
//! with their section forces and stress, bodies as lines, the rest as points.

use crate::io::{Attribute, IoError, MeshCell, MeshSeries, UnstructuredMesh};
use costate::assembly::ElementId;
use costate::functionals::{Functional, Measured, Sample};
use costate::scalar::larger;
use costate::scenes::{Drawn, LineElement, NodePoint, Prepared, Surface};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

pub const SERIES: &str = "fields.pvd";
const GRADIENTS: &str = "gradients.vtu";

pub struct Meshes<'p> {
    prepared: &'p Prepared<'p>,
    series: MeshSeries,
    points: Vec<NodePoint>,
    cells: Vec<MeshCell>,
    /// The first cells are theirs.
    surfaces: Vec<Surface>,
    /// The next ones are elements of beams and cables.
    lines: Vec<LineElement>,
}

/// Von Mises stresses of a shell of one material at its Gauss points, in each of [`LAYERS`].
type Layers = Option<Vec<[f64; 3]>>;

/// Along the director, from below.
const LAYERS: [&str; 3] = ["bottom", "middle", "top"];

/// Where points with an identity stand.
type PointPlaces = HashMap<(usize, [u64; 3]), usize>;

/// Where a point stands among others, which it joins if it is new.
fn place(points: &mut Vec<NodePoint>, known: &mut PointPlaces, point: &NodePoint) -> usize {
    *known.entry(point.identity()).or_insert_with(|| {
        points.push(point.clone());
        points.len() - 1
    })
}

impl<'p> Meshes<'p> {
    pub fn new(prepared: &'p Prepared<'p>, folder: &Path) -> Self {
        let mechanism = &prepared.mechanism;
        let (surfaces, sketch) = (mechanism.surfaces(), mechanism.sketch());
        let (mut points, mut known, mut cells) = (Vec::new(), PointPlaces::new(), Vec::new());
        for surface in &surfaces {
            let nodes = surface.nodes.iter().map(|node| place(&mut points, &mut known, node)).collect();
            cells.push(MeshCell::Face(surface.kind.face, nodes));
        }
        let lines = mechanism.line_elements();
        let mut of_lines = HashSet::new();
        for line in &lines {
            let nodes: Vec<NodePoint> = line.nodes.iter().filter_map(|&node| mechanism.node_point(node, [0.0; 3])).collect();
            of_lines.extend(nodes.windows(2).map(|pair| [pair[0].identity(), pair[1].identity()]));
            cells.push(MeshCell::PolyLine(nodes.iter().map(|node| place(&mut points, &mut known, node)).collect()));
        }
        // edges of shells are seen on their surfaces, beams and cables by their elements
        let is_seen =
            |line: &[NodePoint]| line.windows(2).all(|pair| of_lines.contains(&[pair[0].identity(), pair[1].identity()]));
        for (_, line) in sketch.lines.iter().filter(|(drawn, line)| *drawn != Drawn::Shell && !is_seen(line)) {
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
        Meshes { prepared, series: MeshSeries::new(folder, name), points, cells, surfaces, lines }
    }

    pub fn add(&mut self, sample: &Sample<f64>) -> Result<(), IoError> {
        let mesh = self.mesh(sample);
        self.series.add(sample.t, &mesh)
    }

    /// Writes the file that names all others.
    pub fn finish(&self) -> Result<(), IoError> {
        self.series.finish().map(drop)
    }

    fn mesh(&self, sample: &Sample<f64>) -> UnstructuredMesh {
        let (numbers, q) = (&self.prepared.mechanism.numbers, &sample.at.q[..]);
        // where they start: "Warp By Vector" shows them displaced, larger than they are if wanted
        let points: Vec<[f64; 3]> = self.points.iter().map(|point| point.at(&numbers.q)).collect();
        let moved = self.points.iter().zip(&points).flat_map(|(point, start)| {
            let now = point.at(q);
            [0, 1, 2].map(|k| now[k] - start[k])
        });
        let turned = self.points.iter().flat_map(|point| point.rotation(&numbers.q, q));
        let mut point_data = vec![
            Attribute { name: "displacement [m]".into(), components: 3, values: moved.collect() },
            Attribute { name: "rotation [rad]".into(), components: 3, values: turned.collect() },
        ];
        let layers: Vec<Layers> = self.surfaces.iter().map(|surface| surface.layer_stresses(q, &numbers.p)).collect();
        let mut cell_data = self.cell_data(sample, &layers);
        if layers.iter().any(Option::is_some) {
            for (layer, name) in LAYERS.into_iter().enumerate() {
                let of = |own: &Layers| Some(own.as_ref()?.iter().map(|point| point[layer]).collect::<Vec<f64>>());
                let largest = layers.iter().map(|own| of(own)?.into_iter().reduce(larger));
                cell_data.push(self.of_first_cells(format!("von Mises stress, {name} [N/m2]"), largest));
                let mut nodal = self.at_nodes(format!("von Mises stress, {name}, nodal mean [N/m2]"), layers.iter().map(of));
                // a line through values that fall to zero passes below it
                nodal.values.iter_mut().for_each(|own| *own = larger(0.0, *own));
                point_data.push(nodal);
            }
        }
        point_data.extend(self.prepared.functionals().iter().filter_map(|own| self.measured_at_nodes(own, sample)));
        UnstructuredMesh { points, cells: self.cells.clone(), point_data, cell_data }
    }

    fn cell_data(&self, sample: &Sample<f64>, layers: &[Layers]) -> Vec<Attribute> {
        let (mechanism, q) = (&self.prepared.mechanism, &sample.at.q[..]);
        let p = &mechanism.numbers.p;
        let states: Vec<_> = self.lines.iter().map(|line| mechanism.line_state(line, q)).collect();
        let mut all = Vec::new();
        if !self.surfaces.is_empty() || !self.lines.is_empty() {
            let outside =
                |own: &Layers| Some(own.as_ref()?.iter().flat_map(|[lower, _, upper]| [*lower, *upper]).fold(0.0, larger));
            let stresses = layers.iter().map(outside).chain(states.iter().map(|(_, stress)| *stress));
            all.push(self.of_first_cells("von Mises stress [N/m2]".into(), stresses));
        }
        if !self.surfaces.is_empty() {
            all.push(self.of_surfaces("thickness [m]".into(), |surface| surface.thickness(p)));
        }
        if !self.lines.is_empty() {
            for (name, first) in [("section force [N]", 0), ("section moment [N m]", 3)] {
                let mut values = vec![f64::NAN; 3 * self.surfaces.len()];
                states.iter().for_each(|(forces, _)| values.extend_from_slice(&forces[first..first + 3]));
                values.resize(3 * self.cells.len(), f64::NAN);
                all.push(Attribute { name: name.into(), components: 3, values });
            }
        }
        all.extend(self.prepared.functionals().iter().filter_map(|functional| self.measured(functional, sample)));
        all
    }

    /// A number of each surface; of other cells and surfaces without it none.
    fn of_surfaces(&self, name: String, value: impl Fn(&Surface) -> Option<f64>) -> Attribute {
        self.of_first_cells(name, self.surfaces.iter().map(value))
    }

    /// Numbers of the first cells; the others have none.
    fn of_first_cells(&self, name: String, values: impl Iterator<Item = Option<f64>>) -> Attribute {
        let mut values: Vec<f64> = values.map(|value| value.unwrap_or(f64::NAN)).collect();
        values.resize(self.cells.len(), f64::NAN);
        Attribute { name, components: 1, values }
    }

    /// Numbers at the nodes of surfaces from those at their Gauss points: of each surface the nearest linear function, of all surfaces at a node
    /// the mean. Other points, and surfaces without numbers, have none.
    fn at_nodes(&self, name: String, at_gauss: impl Iterator<Item = Option<Vec<f64>>>) -> Attribute {
        let mut sums = vec![[0.0; 2]; self.points.len()];
        for (cell, own) in self.cells.iter().zip(at_gauss) {
            let (MeshCell::Face(kind, nodes), Some(own)) = (cell, own) else { continue };
            for (&node, value) in nodes.iter().zip(kind.shape().at_nodes_from_gauss(&own)) {
                sums[node] = [sums[node][0] + value, sums[node][1] + 1.0];
            }
        }
        Attribute { name, components: 1, values: sums.into_iter().map(|[sum, count]| sum / count).collect() }
    }

    /// What a functional of a group measures at the nodes of its surfaces: at each of their Gauss points the largest value of all places along
    /// the normal.
    fn measured_at_nodes(&self, functional: &Functional, sample: &Sample<f64>) -> Option<Attribute> {
        let Measured::Group(group) = &functional.measured else { return None };
        let values: HashMap<ElementId, Vec<f64>> =
            group.point_values(self.prepared.model(), sample, &self.prepared.mechanism.numbers.p).into_iter().collect();
        let of = |surface: &Surface| {
            let (own, points) = (values.get(&surface.element)?, surface.kind.face.shape().gauss.len());
            let places = own.len() / points;
            (places * points == own.len() && places > 0)
                .then(|| own.chunks(places).map(|point| point.iter().copied().fold(f64::NEG_INFINITY, larger)).collect())
        };
        let own: Vec<Option<Vec<f64>>> = self.surfaces.iter().map(of).collect();
        let name = format!("measured for {}, nodal mean [{}]", functional.name, functional.unit);
        own.iter().any(Option::is_some).then(|| self.at_nodes(name, own.into_iter()))
    }

    /// What a functional of a group measures in each of its surfaces, beams and cables, at the point where it is largest.
    fn measured(&self, functional: &Functional, sample: &Sample<f64>) -> Option<Attribute> {
        let Measured::Group(group) = &functional.measured else { return None };
        let (model, p) = (self.prepared.model(), &self.prepared.mechanism.numbers.p);
        let values: HashMap<ElementId, f64> = group.element_values(model, sample, p).into_iter().collect();
        let surfaces = self.surfaces.iter().map(|surface| surface.element);
        let cells: Vec<_> = surfaces.chain(self.lines.iter().map(|line| line.element)).collect();
        let own = cells.iter().map(|element| values.get(element).copied());
        let name = format!("measured for {} [{}]", functional.name, functional.unit);
        own.clone().any(|value| value.is_some()).then(|| self.of_first_cells(name, own))
    }
}

/// Writes the derivatives of all functionals by the thickness of each shell element, given those by parameters, on the mesh of the start;
/// nothing without shells.
pub fn write_gradients(prepared: &Prepared, by_parameters: &[Vec<f64>], folder: &Path) -> Result<Option<PathBuf>, IoError> {
    let meshes = Meshes::new(prepared, folder);
    if meshes.surfaces.iter().all(|surface| surface.thicknesses().is_none()) {
        return Ok(None);
    }
    let points = meshes.points.iter().map(|point| point.at(&prepared.mechanism.numbers.q)).collect();
    let gradients = prepared.functionals().iter().zip(by_parameters).map(|(functional, row)| {
        let name = format!("gradient of {} by thickness [{}/m]", functional.name, functional.value_unit());
        meshes.of_surfaces(name, |surface| Some(row[surface.thicknesses()?].iter().sum()))
    });
    let path = folder.join(GRADIENTS);
    let (cells, cell_data) = (meshes.cells.clone(), gradients.collect());
    UnstructuredMesh { points, cells, point_data: Vec::new(), cell_data }.write(&path)?;
    Ok(Some(path))
}
