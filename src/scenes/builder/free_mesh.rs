//! Meshes of shells as users bring them: points, and faces of any kinds between them.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::SurfaceMesh;
use super::shells::MeshedShell;
use crate::assembly::NodeId;
use crate::elements::flexible::faces::{FaceKind, Weights};
use crate::elements::flexible::shape::weighed;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::MeshData;
use std::collections::HashMap;
use std::sync::Arc;

/// Cosine of the angle between faces from which on they meet in an edge instead of going on smoothly: 45 degrees.
const CREASE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Most edges between faces of different sides that are told.
const MOST_TOLD: usize = 3;

/// A face: its kind, and its points in the order of the element.
#[derive(Clone, Debug)]
pub(super) struct MeshFace {
    pub kind: FaceKind,
    pub points: Vec<usize>,
}

/// An edge of a mesh: its points from the end of the smaller number on, and each face there with whether it runs that way.
pub(super) struct MeshEdge {
    pub points: Vec<usize>,
    pub faces: Vec<(usize, bool)>,
}

/// A mesh of quadrilaterals of four and nine nodes and triangles of six, mixed as they come, at t = 0 in the world \[m\].
///
/// Points and faces are numbered from 0 on, in the order in which they are given; points that no face names make no nodes. A face lists its
/// corners counterclockwise as seen from where its normal points to, then the middles of its edges from the first corner on, then its middle:
/// the order of Gmsh and of VTK. Its kind follows from the number of its points; one of eight points is completed by its middle point, as are
/// its normals.
///
/// Directors are the normals that are given for each point, or else the mean of the normals of the faces that meet there, weighed by their
/// areas: of those that go on smoothly, within 45 degrees or [`creased`](FreeMesh::creased). Faces at a larger angle keep directors of their
/// own in the frame of the common node, so that the angle stays.
#[derive(Clone, Debug)]
pub struct FreeMesh<S> {
    pub(super) points: Vec<Vector3<S>>,
    pub(super) faces: Vec<MeshFace>,
    pub(super) normals: Option<Vec<Vector3<S>>>,
    /// Named groups of faces, and named sets of points.
    pub(super) groups: Vec<(String, Vec<usize>)>,
    pub(super) node_sets: Vec<(String, Vec<usize>)>,
    /// Points that never move.
    pub(super) clamped: Vec<usize>,
    /// Nodes that are there already.
    pub(super) given: Vec<(usize, NodeId)>,
    /// Damping proportional to stiffness \[s\].
    pub(super) damping: Option<S>,
    /// Points may stand at the same place and are not joined.
    pub(super) may_coincide: bool,
    /// Why it is no mesh that can be made or joined, in words that follow its name.
    pub(super) unjoined: Option<String>,
    /// Cosine of the largest angle between faces that go on smoothly.
    crease: f64,
    /// Points of faces of eight, whose middles are the last points.
    completed: Vec<Vec<usize>>,
    /// Numbers of points of faces that are no faces.
    odd: Vec<(usize, usize)>,
    /// The file that it is from, which has numbers of its own.
    data: Option<Arc<MeshData>>,
    /// The grid that it is.
    pub(super) grid: Option<Grid>,
}

/// A grid of points, whose points and faces are called by their places in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Cells of three points along the first direction.
    pub columns: usize,
    /// Faces in place of each cell.
    pub parts: usize,
}

impl<S: Scalar> FreeMesh<S> {
    /// A mesh of points \[m\] and faces, which list the numbers of their points.
    pub fn new<L: AsRef<[usize]>>(points: Vec<Vector3<S>>, faces: impl IntoIterator<Item = L>) -> Self {
        let mut mesh = FreeMesh::of_points(points);
        for (number, face) in faces.into_iter().enumerate() {
            let own = face.as_ref();
            let kind = match own.len() {
                4 => FaceKind::Quad4,
                6 => FaceKind::Triangle6,
                8 | 9 => FaceKind::Quad9,
                count => {
                    mesh.odd.push((number, count));
                    continue;
                }
            };
            let mut cyclic = own.to_vec();
            if own.len() == 8 {
                cyclic.push(mesh.points.len());
                mesh.points.push(middle(&mesh.points, own));
                mesh.completed.push(own.to_vec());
            }
            let mut points = vec![0; cyclic.len()];
            kind.shape().cyclic.iter().zip(cyclic).for_each(|(&place, point)| points[place] = point);
            mesh.faces.push(MeshFace { kind, points });
        }
        mesh
    }

    /// The mesh of a file. Nodes and elements are called by their numbers there.
    pub fn of_data(data: &Arc<MeshData>) -> Self {
        Self::of_data_at(data, data.points.iter().map(|&point| Vector3::from_f64(point)).collect())
    }
    /// The same with its points elsewhere \[m\].
    pub(crate) fn of_data_at(data: &Arc<MeshData>, points: Vec<Vector3<S>>) -> Self {
        let mut mesh = Self::new(points, &data.faces);
        (mesh.groups, mesh.node_sets) = (data.groups.clone(), data.node_sets.clone());
        mesh.data = Some(data.clone());
        mesh
    }

    /// Points without faces.
    pub(super) fn of_points(points: Vec<Vector3<S>>) -> Self {
        FreeMesh {
            points,
            faces: Vec::new(),
            normals: None,
            groups: Vec::new(),
            node_sets: Vec::new(),
            clamped: Vec::new(),
            given: Vec::new(),
            damping: None,
            may_coincide: false,
            unjoined: None,
            crease: CREASE,
            completed: Vec::new(),
            odd: Vec::new(),
            data: None,
            grid: None,
        }
    }

    /// Normals at the points, of any length but zero.
    #[must_use]
    pub fn with_normals(mut self, normals: Vec<Vector3<S>>) -> Self {
        let middles: Vec<Vector3<S>> = self.completed.iter().map(|own| middle(&normals, own)).collect();
        self.normals = Some(normals.into_iter().chain(middles).map(|normal| normal.unit()).collect());
        self
    }
    /// Faces whose normals enclose more than this angle \[rad\] keep directors of their own where they meet.
    #[must_use]
    pub fn creased(mut self, angle: f64) -> Self {
        self.crease = angle.cos();
        self
    }
    /// Some faces have a name.
    #[must_use]
    pub fn group(mut self, name: &str, faces: impl IntoIterator<Item = usize>) -> Self {
        self.groups.push((name.into(), faces.into_iter().collect()));
        self
    }
    /// Some points have a name.
    #[must_use]
    pub fn node_set(mut self, name: &str, points: impl IntoIterator<Item = usize>) -> Self {
        self.node_sets.push((name.into(), points.into_iter().collect()));
        self
    }
    /// The nodes at some points never move.
    #[must_use]
    pub fn clamped(mut self, points: impl IntoIterator<Item = usize>) -> Self {
        self.clamped.extend(points);
        self
    }
    /// The node at a point is one that is there: of another shell, a beam or a rigid body, with its frame at this place.
    #[must_use]
    pub fn with_node(mut self, point: usize, node: NodeId) -> Self {
        self.given.push((point, node));
        self
    }
    /// Damping proportional to stiffness: strain rates times eta \[s\] add to the strains in all stresses.
    #[must_use]
    pub fn damped(mut self, damping: S) -> Self {
        self.damping = Some(damping);
        self
    }
    /// Points may stand at the same place, or on other faces, where faces are not to be joined: a slit.
    #[must_use]
    pub fn with_coincident_points(mut self) -> Self {
        self.may_coincide = true;
        self
    }
    /// Moves the points, from position and number to another position \[m\]; normals that were given stay.
    #[must_use]
    pub fn moved(mut self, to: impl Fn(Vector3<S>, usize) -> Vector3<S>) -> Self {
        let first = self.points.len() - self.completed.len();
        self.points[..first].iter_mut().enumerate().for_each(|(number, point)| *point = to(*point, number));
        self.complete();
        self
    }
    /// Places of the middles of faces of eight points.
    fn complete(&mut self) {
        let first = self.points.len() - self.completed.len();
        for (place, own) in self.completed.iter().enumerate() {
            self.points[first + place] = middle(&self.points, own);
        }
    }

    /// Lets a point be a node that is there, at its place, unless it is one already.
    pub(super) fn take_over(&mut self, point: usize, node: NodeId, place: Vector3<S>) {
        if self.given.iter().all(|(given, _)| *given != point) {
            self.given.push((point, node));
            self.points[point] = place;
            self.complete();
        }
    }
    /// Keeps why it is no mesh that can be joined, in words that follow its name.
    pub(super) fn refuse(&mut self, why: String) {
        self.unjoined.get_or_insert(why);
    }

    /// Number of a point where users see it: that of the file; the middles of quadrilaterals of eight have none there.
    pub(super) fn point_number(&self, point: usize) -> String {
        let Some(data) = &self.data else { return point.to_string() };
        let first = data.points.len();
        match data.point_numbers.get(point) {
            Some(number) => number.to_string(),
            None => {
                let mut of_eight = data.faces.iter().zip(&data.face_numbers).filter(|(face, _)| face.len() == 8);
                let face = of_eight.nth(point - first).map_or(0, |(_, number)| *number);
                format!("in the middle of element {face}")
            }
        }
    }
    /// What the node at a point is called behind the name of the mesh.
    pub(super) fn node_name(&self, point: usize) -> String {
        let width = self.grid.map(|grid| 2 * grid.columns + 1);
        let own = width.map(|width| format!("[{},{}]", point % width, point / width));
        own.unwrap_or_else(|| format!("[{}]", self.point_number(point)))
    }
    /// What the element on a face is called.
    pub(super) fn element_name(&self, face: usize) -> String {
        let Some(Grid { columns, parts }) = self.grid else {
            let own = self.data.as_ref().and_then(|data| data.face_numbers.get(face));
            return format!("element {}", own.copied().unwrap_or(face));
        };
        let (cell, part) = (face / parts, face % parts + 1);
        let (column, row) = (cell % columns + 1, cell / columns + 1);
        if parts == 1 { format!("element {column}, {row}") } else { format!("element {column}, {row}, part {part}") }
    }
    /// The same for messages, with its place in a file if it is from one.
    pub(super) fn element_place(&self, face: usize) -> String {
        let name = self.element_name(face);
        let place = self.data.as_ref().and_then(|data| Some((&data.file, data.face_places.get(face)?)));
        place.map_or_else(|| name.clone(), |(file, place)| format!("{name} ({file}{place})"))
    }
    /// Diagonal of the box around its points \[m\].
    pub(super) fn size(&self) -> f64 {
        let extent = |axis: usize| {
            let all = self.points.iter().map(|point| point[axis].value());
            let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            most - least
        };
        extent(0).hypot(extent(1)).hypot(extent(2))
    }
    /// Places of a face's nodes.
    pub(super) fn places(&self, face: &MeshFace) -> Vec<Vector3<S>> {
        face.points.iter().map(|&point| self.points[point]).collect()
    }
    /// All its edges.
    pub(super) fn edges(&self) -> Vec<MeshEdge> {
        let mut known: HashMap<[usize; 2], usize> = HashMap::new();
        let mut edges: Vec<MeshEdge> = Vec::new();
        for (number, face) in self.faces.iter().enumerate() {
            for edge in face.kind.shape().edges {
                let mut points: Vec<usize> = edge.iter().map(|&place| face.points[place]).collect();
                let forward = points[0] < points[points.len() - 1];
                if !forward {
                    points.reverse();
                }
                let ends = [points[0], points[points.len() - 1]];
                let place = *known.entry(ends).or_insert(edges.len());
                if place == edges.len() {
                    edges.push(MeshEdge { points, faces: Vec::new() });
                }
                edges[place].faces.push((number, forward));
            }
        }
        edges
    }
    /// X,r cross X,s at the nodes of each face.
    fn own_normals(&self) -> Vec<Vec<Vector3<S>>> {
        let of_face = |face: &MeshFace| {
            let places = self.places(face);
            let tangent = |weights: &[f64]| weighed(&places, weights);
            let normal = |weights: &Weights| tangent(weights.by_r).cross(&tangent(weights.by_s));
            face.kind.shape().at_nodes.iter().map(normal).collect()
        };
        self.faces.iter().map(of_face).collect()
    }
    /// Directors at the nodes of each face.
    pub(super) fn directors(&self) -> Vec<Vec<Vector3<S>>> {
        if let Some(normals) = &self.normals {
            let of_face = |face: &MeshFace| face.points.iter().map(|&point| normals[point]).collect();
            return self.faces.iter().map(of_face).collect();
        }
        let own = self.own_normals();
        let mut meeting: Vec<Vec<(usize, usize)>> = vec![Vec::new(); self.points.len()];
        for (number, face) in self.faces.iter().enumerate() {
            face.points.iter().enumerate().for_each(|(place, &point)| meeting[point].push((number, place)));
        }
        let mean = |face: usize, place: usize| {
            let normal = own[face][place];
            let all = meeting[self.faces[face].points[place]].iter().map(|&(face, place)| own[face][place]);
            let smooth = all.filter(|other| other.unit().dot(&normal.unit()).value() >= self.crease);
            smooth.fold(Vector3::zeros(), |sum, other| sum + other).unit()
        };
        let of_face = |face: usize| (0..self.faces[face].points.len()).map(|place| mean(face, place)).collect();
        (0..self.faces.len()).map(of_face).collect()
    }

    /// Faces of other kinds whose edges do not fit, in words: a middle of an edge is neither a corner nor left out by what lies beside.
    fn hanging(&self) -> Option<String> {
        let mut middles: HashMap<usize, (usize, [usize; 2])> = HashMap::new();
        let mut of_ends: HashMap<[usize; 2], (usize, Option<usize>)> = HashMap::new();
        for (number, face) in self.faces.iter().enumerate() {
            for edge in face.kind.shape().edges {
                let [mut from, mut to] = [edge[0], edge[edge.len() - 1]].map(|place| face.points[place]);
                if from > to {
                    (from, to) = (to, from);
                }
                let middle = (edge.len() == 3).then(|| face.points[edge[1]]);
                let &mut (other, beside) = of_ends.entry([from, to]).or_insert((number, middle));
                if beside != middle {
                    let [first, second] = [other, number].map(|face| self.element_place(face));
                    let [from, to] = [from, to].map(|point| self.point_number(point));
                    return Some(format!(
                        "{first} and {second} do not have the same points along their edge from point {from} to point {to}: faces of four \
                         points do not fit to those of six, eight or nine"
                    ));
                }
                middles.extend(middle.map(|middle| (middle, (number, [from, to]))));
            }
        }
        let corners = self
            .faces
            .iter()
            .enumerate()
            .flat_map(|(number, face)| face.kind.shape().edges.iter().map(move |edge| (number, face.points[edge[0]])));
        corners.into_iter().find_map(|(number, point)| {
            let &(other, [from, to]) = middles.get(&point)?;
            let [first, second] = [other, number].map(|face| self.element_place(face));
            let [point, from, to] = [point, from, to].map(|point| self.point_number(point));
            Some(format!(
                "point {point} is a corner of {second} and the middle of the edge of {first} from point {from} to point {to}: corners meet \
                 corners"
            ))
        })
    }

    /// What cannot be a shell, in words.
    pub(super) fn mistakes(&self) -> Vec<String> {
        let mut all = self.mistakes_of_numbers();
        // what follows looks at points and faces that are there
        if !all.is_empty() {
            return all;
        }
        let own_normals = self.own_normals();
        all.extend(self.folded(&own_normals));
        all.extend(self.hanging());
        if all.is_empty() {
            all.extend(self.gaps(&own_normals));
        }
        if all.is_empty() { self.turned() } else { all }
    }

    /// Numbers of points and faces where there are none, and faces that are none.
    fn mistakes_of_numbers(&self) -> Vec<String> {
        let mut all = Vec::new();
        for &(number, count) in &self.odd {
            all.push(format!(
                "face {number} has {count} points; a quadrilateral has 4, 8 or 9, a triangle 6: linear triangles are made quadratic by \
                 points in the middles of their edges"
            ));
        }
        if self.faces.is_empty() {
            all.push("it has no faces".into());
        }
        let count = self.points.len();
        if let Some(normals) = self.normals.as_ref().filter(|normals| normals.len() < count) {
            all.push(format!("it has {count} points, but {} normals", normals.len()));
        }
        let lists = self.groups.iter().map(|own| ("group", own, self.faces.len(), "faces"));
        let lists = lists.chain(self.node_sets.iter().map(|own| ("node set", own, count, "points")));
        for (what, (name, numbers), there, of) in lists {
            if let Some(number) = numbers.iter().find(|&&number| number >= there) {
                all.push(format!(
                    "its {what} \"{name}\" names number {number} of {there} {of}, which are counted from 0 on"
                ));
            }
        }
        let held = self.clamped.iter().chain(self.given.iter().map(|(point, _)| point));
        if let Some(point) = held.copied().find(|&point| point >= count) {
            all.push(format!("its point {point} is held, but there are {count} points, counted from 0 on"));
        }
        for (number, face) in self.faces.iter().enumerate() {
            let name = self.element_place(number);
            if let Some(point) = face.points.iter().find(|&&point| point >= count) {
                all.push(format!("{name}: there is no point {point} among {count}, counted from 0 on"));
            } else if let Some(point) = repeated(&face.points) {
                let point = self.point_number(point);
                all.push(format!(
                    "{name} names point {point} twice: a face that is narrowed to a triangle is one of six points"
                ));
            }
        }
        all
    }

    /// The first face that is folded or has no area.
    fn folded(&self, own_normals: &[Vec<Vector3<S>>]) -> Option<String> {
        let folded: Vec<(usize, usize, f64)> = own_normals.iter().enumerate().filter_map(fold_of).collect();
        let &(number, node, cosine) = folded.first()?;
        let (name, point) = (self.element_place(number), self.point_number(self.faces[number].points[node]));
        let more = match folded.len() - 1 {
            0 => String::new(),
            more => format!("; the same holds for {more} more"),
        };
        Some(format!(
            "{name} is folded or has no area at point {point}: its normal there and that of the whole face enclose an angle whose \
             cosine is {cosine:.3}; points must lie apart, corners be convex, and points on edges lie near their middles{more}"
        ))
    }

    /// Edges at which the normals of the faces point to different sides.
    fn turned(&self) -> Vec<String> {
        let mut all = Vec::new();
        let mut turned = 0;
        for MeshEdge { points, faces } in self.edges() {
            if let [(first, forward), (second, other)] = faces[..]
                && forward == other
            {
                turned += 1;
                if turned > MOST_TOLD {
                    continue;
                }
                let [from, to] = [points[0], points[points.len() - 1]].map(|point| self.point_number(point));
                let [first, second] = [first, second].map(|face| self.element_place(face));
                all.push(format!(
                    "{first} and {second} run along their edge from point {from} to point {to} in the same direction, so that their normals point \
                     to different sides: reverse one of them, or the group that it belongs to; a band that is twisted in itself has one side only, and \
                     must be cut"
                ));
            }
        }
        if turned > MOST_TOLD {
            all.push(format!("the same holds for {} more edges", turned - MOST_TOLD));
        }
        all
    }
}

/// The middle of a quadrilateral of eight points: with their shape functions -1/4 of each corner and 1/2 of each middle of an edge.
fn middle<S: Scalar>(points: &[Vector3<S>], own: &[usize]) -> Vector3<S> {
    let point = |point: usize| points.get(point).copied().unwrap_or_else(|| Vector3::from_f64([f64::NAN; 3]));
    let weighed = own.iter().enumerate().map(|(place, &own)| point(own) * S::from(if place < 4 { -0.25 } else { 0.5 }));
    weighed.fold(Vector3::zeros(), |sum, own| sum + own)
}

/// A face that is folded: its number, and the first node at which it is, with the cosine of the angle between the normals there and of all.
fn fold_of<S: Scalar>((number, normals): (usize, &Vec<Vector3<S>>)) -> Option<(usize, usize, f64)> {
    let mean = normals.iter().fold(Vector3::zeros(), |sum, &normal| sum + normal).unit();
    let cosines = normals.iter().map(|normal| normal.unit().dot(&mean).value());
    cosines.enumerate().find(|(_, cosine)| !(*cosine > 0.0)).map(|(node, cosine)| (number, node, cosine))
}

/// The first number that is there twice.
fn repeated(numbers: &[usize]) -> Option<usize> {
    numbers.iter().enumerate().find(|(place, number)| numbers[..*place].contains(number)).map(|(_, &number)| number)
}

impl<S: Scalar> SurfaceMesh<S> for FreeMesh<S> {
    type Member = MeshedShell;
    type Place = usize;

    fn free(&self) -> FreeMesh<S> {
        self.clone()
    }
    fn free_mut(&mut self) -> &mut FreeMesh<S> {
        self
    }
    fn place(&self, face: usize, node: usize) -> usize {
        self.faces[face].points[node]
    }
    fn member(self, shell: MeshedShell) -> MeshedShell {
        shell
    }
}
