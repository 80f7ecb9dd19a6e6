//! Meshes with triangles of three nodes, raised to second order: shells have triangles of six nodes only.

use crate::scenes::mesh_data::MeshData;
use std::collections::HashMap;

/// Middles of edges by their ends, the smaller first.
struct Middles {
    of_edges: HashMap<[usize; 2], usize>,
}

/// Raises triangles of three points to six, and quadrilaterals of four points beside them, whose edges would not fit, to nine.
///
/// Faces, and lines of node sets, share the middles of their edges, with faces of second order, too. Says what was raised.
pub(super) fn raise<'l>(mesh: &mut MeshData, lines: impl Iterator<Item = &'l mut Vec<usize>>) -> Option<String> {
    let count = |corners: usize| mesh.faces.iter().filter(|face| face.len() == corners).count();
    let [triangles, quadrilaterals] = [3, 4].map(count);
    if triangles == 0 {
        return None;
    }
    let mut middles = Middles::of(mesh);
    for face in &mut mesh.faces {
        let corners = face.len();
        if !matches!(corners, 3 | 4) {
            continue;
        }
        let ends = face.clone();
        face.extend((0..corners).map(|k| middles.between([ends[k], ends[(k + 1) % corners]], &mut mesh.points)));
        if corners == 4 {
            face.push(mesh.points.len());
            mesh.points.push(mean(&ends, &mesh.points));
        }
    }
    for line in lines {
        if let &mut [from, to] = &mut line[..]
            && let Some(&middle) = middles.of_edges.get(&sorted([from, to]))
        {
            line.push(middle);
        }
    }
    let words = match quadrilaterals {
        0 => String::new(),
        count => format!(", and quadrilaterals of 4 nodes beside them to 9 ({count})"),
    };
    Some(format!("triangles of 3 nodes raised to 6 ({triangles}){words}"))
}

impl Middles {
    /// Those that faces of second order have.
    fn of(mesh: &MeshData) -> Self {
        let mut of_edges = HashMap::new();
        for face in &mesh.faces {
            let corners = match face.len() {
                6 => 3,
                8 | 9 => 4,
                _ => continue,
            };
            let edge = |k: usize| (sorted([face[k], face[(k + 1) % corners]]), face[corners + k]);
            of_edges.extend((0..corners).map(edge));
        }
        Middles { of_edges }
    }
    /// The middle of an edge, which may be new.
    fn between(&mut self, ends: [usize; 2], points: &mut Vec<[f64; 3]>) -> usize {
        *self.of_edges.entry(sorted(ends)).or_insert_with(|| {
            points.push(mean(&ends, points));
            points.len() - 1
        })
    }
}

fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

fn mean(own: &[usize], points: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis| own.iter().map(|&point| points[point][axis] / own.len() as f64).sum())
}
