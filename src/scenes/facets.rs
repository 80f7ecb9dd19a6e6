//! Surfaces of solids as flat pieces for pictures.

use std::collections::HashMap;
use std::f64::consts::TAU;

/// Sides of what is round.
pub(super) const SIDES: usize = 24;
/// Cosine of the angle between two triangles above which their edge is drawn.
const SHARP: f64 = 0.866;

/// Most lines of a solid in a picture of many moments.
const MOST_LINES: usize = 100;

/// A surface of triangles, counterclockwise as seen from outside, with a vertex for each side of a sharp edge, and the lines that are drawn on it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facets {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
    pub lines: Vec<Vec<usize>>,
}

fn at(origin: [f64; 3], terms: &[(f64, [f64; 3])]) -> [f64; 3] {
    terms.iter().fold(origin, |sum, (weight, own)| [0, 1, 2].map(|k| sum[k] + weight * own[k]))
}

impl Facets {
    fn add(&mut self, points: impl IntoIterator<Item = [f64; 3]>) -> usize {
        let first = self.vertices.len();
        self.vertices.extend(points);
        first
    }

    /// A flat piece of four corners, counterclockwise.
    fn add_quad(&mut self, corners: [[f64; 3]; 4]) -> usize {
        let first = self.add(corners);
        self.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        first
    }

    /// Triangles between two rings of vertices.
    fn add_strip(&mut self, a: usize, b: usize, is_turned: bool) {
        for (k, next) in (0..SIDES).map(|k| (k, (k + 1) % SIDES)) {
            let pieces = [[a + k, a + next, b + next], [a + k, b + next, b + k]];
            self.triangles.extend(pieces.map(|[a, b, c]| if is_turned { [a, c, b] } else { [a, b, c] }));
        }
    }

    /// A bar of rectangular section between two points, with axes along and across.
    pub fn of_box(ends: [[f64; 3]; 2], [_, second, third]: [[f64; 3]; 3], [width, height]: [f64; 2]) -> Self {
        let mut facets = Facets::default();
        let ring = |end: usize| {
            [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
                .map(|[y, z]| at(ends[end], &[(y * width, second), (z * height, third)]))
        };
        let [start, end] = [ring(0), ring(1)];
        for lid in [[start[0], start[3], start[2], start[1]], end] {
            let first = facets.add_quad(lid);
            facets.lines.push(vec![first, first + 1, first + 2, first + 3, first]);
        }
        for k in 0..4 {
            let next = (k + 1) % 4;
            let first = facets.add_quad([start[k], start[next], end[next], end[k]]);
            facets.lines.push(vec![first, first + 3]);
        }
        facets
    }

    /// A round bar between two points, or a tube.
    pub fn of_cylinder(ends: [[f64; 3]; 2], [_, second, third]: [[f64; 3]; 3], radius: f64, inner: Option<f64>) -> Self {
        let mut facets = Facets::default();
        let ring = |end: usize, radius: f64| {
            (0..SIDES).map(move |k| {
                let (sine, cosine) = (TAU * k as f64 / SIDES as f64).sin_cos();
                at(ends[end], &[(radius * cosine, second), (radius * sine, third)])
            })
        };
        let inner = inner.filter(|inner| *inner > 0.0);
        for (radius, inside) in [(Some(radius), false), (inner, true)] {
            let Some(radius) = radius else { continue };
            let [a, b] = [0, 1].map(|end| facets.add(ring(end, radius)));
            facets.add_strip(a, b, inside);
            for first in [a, b] {
                facets.lines.push((first..first + SIDES).chain([first]).collect());
            }
        }
        for end in 0..2 {
            let outer = facets.add(ring(end, radius));
            match inner.map(|inner| facets.add(ring(end, inner))) {
                Some(hole) => facets.add_strip(outer, hole, end == 0),
                None => facets.triangles.extend((1..SIDES - 1).map(|k| match end {
                    0 => [outer, outer + k + 1, outer + k],
                    _ => [outer, outer + k, outer + k + 1],
                })),
            }
        }
        facets
    }

    /// A ball, by circles of latitude.
    pub fn of_sphere(centre: [f64; 3], radius: f64) -> Self {
        let mut facets = Facets::default();
        let rows = SIDES / 2;
        let circle = |row: usize| {
            let (across, up) = (TAU * 0.5 * row as f64 / rows as f64).sin_cos();
            (0..SIDES).map(move |k| {
                let (sine, cosine) = (TAU * k as f64 / SIDES as f64).sin_cos();
                [centre[0] + radius * across * cosine, centre[1] + radius * across * sine, centre[2] - radius * up]
            })
        };
        let south = facets.add([[centre[0], centre[1], centre[2] - radius]]);
        let circles: Vec<usize> = (1..rows).map(|row| facets.add(circle(row))).collect();
        let north = facets.add([[centre[0], centre[1], centre[2] + radius]]);
        for (k, next) in (0..SIDES).map(|k| (k, (k + 1) % SIDES)) {
            facets.triangles.push([south, circles[0] + next, circles[0] + k]);
            let last = circles[circles.len() - 1];
            facets.triangles.push([north, last + k, last + next]);
        }
        circles.windows(2).for_each(|pair| facets.add_strip(pair[0], pair[1], false));
        let equator = circles[circles.len() / 2];
        facets.lines.push((equator..equator + SIDES).chain([equator]).collect());
        facets
    }

    /// Triangles of a surface, with its sharp edges.
    pub fn of_triangles(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Self {
        let mut facets = Facets::default();
        let mut sides: HashMap<[usize; 2], ([f64; 3], [usize; 2])> = HashMap::new();
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| vertices[corner]);
            let first = facets.add([a, b, c]);
            facets.triangles.push([first, first + 1, first + 2]);
            let normal = normal([a, b, c]);
            for k in 0..3 {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                match sides.entry([from.min(to), from.max(to)]) {
                    std::collections::hash_map::Entry::Vacant(free) => {
                        free.insert((normal, [first + k, first + (k + 1) % 3]));
                    }
                    std::collections::hash_map::Entry::Occupied(other) => {
                        let (other, edge) = other.get();
                        let cosine: f64 = (0..3).map(|k| other[k] * normal[k]).sum();
                        if cosine < SHARP {
                            facets.lines.push(edge.to_vec());
                        }
                    }
                }
            }
        }
        facets
    }

    /// Its lines as places: of very many those of the box around all.
    pub fn few_lines(&self) -> Vec<Vec<[f64; 3]>> {
        let places = |line: &Vec<usize>| line.iter().map(|&vertex| self.vertices[vertex]).collect();
        if self.lines.len() <= MOST_LINES {
            return self.lines.iter().map(places).collect();
        }
        let bound =
            |of: fn(f64, f64) -> f64| [0, 1, 2].map(|k| self.vertices.iter().map(|own| own[k]).reduce(of).unwrap_or(0.0));
        let [low, high] = [bound(f64::min), bound(f64::max)];
        let middle = |end: [f64; 3]| [end[0], 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])];
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let around = Facets::of_box([middle(low), middle(high)], axes, [high[1] - low[1], high[2] - low[2]]);
        around.lines.iter().map(|line| line.iter().map(|&vertex| around.vertices[vertex]).collect()).collect()
    }

    /// The same with one vertex for all that stand in one place.
    #[cfg(test)]
    pub fn welded(&self) -> Self {
        let key = |point: &[f64; 3]| point.map(|x| (x * 1e9).round() as i64);
        let mut known: HashMap<[i64; 3], usize> = HashMap::new();
        let mut vertices = Vec::new();
        let mut numbers = Vec::new();
        for point in &self.vertices {
            numbers.push(*known.entry(key(point)).or_insert_with(|| {
                vertices.push(*point);
                vertices.len() - 1
            }));
        }
        let triangles = self.triangles.iter().map(|corners| corners.map(|corner| numbers[corner])).collect();
        Facets { vertices, triangles, lines: Vec::new() }
    }
}

/// The unit normal of a triangle, zero where it has no area.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|own| [0, 1, 2].map(|k| own[k] - a[k]));
    let across = [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
    across.map(|x| if length > 0.0 { x / length } else { 0.0 })
}
