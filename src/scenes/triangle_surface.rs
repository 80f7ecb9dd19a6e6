//! Surfaces of triangles, and what closed ones hold.

use super::solid::Moments;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// A surface of triangles, as of a part from a drawing program.
#[derive(Clone, Debug)]
pub struct TriangleSurface {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    moments: Result<Moments<f64>, String>,
}

impl TriangleSurface {
    /// From its vertices, in any unit of length, and its triangles by the numbers of their vertices, counterclockwise as seen from outside.
    ///
    /// # Errors
    /// A vertex that is not there, or no finite number.
    pub fn new(vertices: Vec<[f64; 3]>, triangles: Vec<[usize; 3]>) -> Result<Self, String> {
        if let Some(number) = triangles.iter().flatten().find(|&&number| number >= vertices.len()) {
            return Err(format!("a triangle has vertex {number}, and there are {}, counted from 0", vertices.len()));
        }
        if vertices.iter().flatten().any(|x| !x.is_finite()) {
            return Err("a vertex is no finite number".into());
        }
        let moments = check_closed(&triangles).and_then(|()| moments(&vertices, &triangles));
        Ok(TriangleSurface { vertices, triangles, moments })
    }

    /// Its vertices.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Its triangles, by numbers of vertices.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    /// What it holds, along its principal axes.
    ///
    /// # Errors
    /// Why it holds nothing: it is not closed, or seen from inside.
    pub(super) fn moments(&self) -> Result<Moments<f64>, &str> {
        self.moments.as_ref().copied().map_err(String::as_str)
    }
}

/// Each edge is one of two triangles, which pass it in opposite directions.
fn check_closed(triangles: &[[usize; 3]]) -> Result<(), String> {
    let mut sides: HashMap<[usize; 2], i64> = HashMap::new();
    for [a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *sides.entry([*from.min(to), *from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    match sides.values().filter(|count| **count != 0).count() {
        0 => Ok(()),
        open => Err(format!(
            "the surface is not closed: {open} of its {} edges are not between two triangles that are seen from the same side",
            sides.len()
        )),
    }
}

/// Sums over the tetrahedra between the triangles and a point in their midst: volume v = a . (b x c) / 6, integral of x dV
/// v (a + b + c) / 4, of x x^T dV v ((a + b + c)(a + b + c)^T + a a^T + b b^T + c c^T) / 20.
fn moments(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Result<Moments<f64>, String> {
    let all: Vec<Vector3<f64>> = vertices.iter().map(|&vertex| vertex.into()).collect();
    let middle = all.iter().sum::<Vector3<f64>>() / all.len().max(1) as f64;
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| all[corner] - middle);
        let (own, sum) = (a.dot(&b.cross(&c)) / 6.0, a + b + c);
        volume += own;
        first += sum * (own / 4.0);
        second += (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose()) * (own / 20.0);
    }
    let extent = all.iter().map(|own| (own - middle).norm()).fold(0.0, f64::max);
    if volume <= crate::tolerances::LONG_SUM * extent.powi(3) {
        let what =
            if volume < 0.0 { "its triangles are seen clockwise from outside: turn them" } else { "it holds nothing" };
        return Err(format!("the volume within the surface is {volume:.3e}: {what}"));
    }
    let centre = first / volume;
    let principal = (second - centre * centre.transpose() * volume).symmetric_eigen();
    let axes = [0, 1, 2].map(|k| principal.eigenvectors.column(k).into_owned());
    Ok(Moments { volume, centre: middle + centre, axes, second: principal.eigenvalues.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_open_or_turned_around_is_told() {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let solid = TriangleSurface::new(vertices.clone(), faces.clone()).unwrap();
        let moments = solid.moments().unwrap();
        assert!((moments.volume - 1.0 / 6.0).abs() < 1e-15);
        assert!(moments.centre.iter().all(|x| (x - 0.25).abs() < 1e-15));
        let told = |vertices: &[[f64; 3]], faces: &[[usize; 3]]| {
            let surface = TriangleSurface::new(vertices.to_vec(), faces.to_vec());
            surface.and_then(|surface| surface.moments().map(drop).map_err(String::from)).unwrap_err()
        };
        assert!(told(&vertices, &faces[1..]).contains("3 of its 6 edges"));
        let turned: Vec<[usize; 3]> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert!(told(&vertices, &turned).contains("clockwise"));
        assert!(told(&vertices, &[[0, 1, 4]]).contains("vertex 4"));
        assert!(told(&[], &[]).contains("holds nothing"));
        assert!(told(&[[f64::NAN; 3]], &[]).contains("finite"));
    }
}
