//! Surfaces from files in STL, text or binary.

use super::raw::Raw;
use super::reader::Reader;
use crate::scenes::{TriangleSurface, file_bytes};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// Largest file in bytes.
const LARGEST: u64 = 100_000_000;
/// Bytes of a binary file before its triangles, and of each triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

impl Reader {
    /// The surface of a file beside the scene file.
    pub(super) fn surface(&mut self, raw: &Raw, what: &str) -> Option<Arc<TriangleSurface>> {
        let file = raw.text().filter(|file| !file.is_empty());
        let file = file.or_else(|| self.not(raw, what, "the name of a file in STL"))?;
        match read(&self.folder.join(file)) {
            Ok(surface) => Some(Arc::new(surface)),
            Err(why) => self.refuse(raw.at, format!("{what}, \"{file}\": {why}")),
        }
    }
}

fn read(path: &Path) -> Result<TriangleSurface, String> {
    parse(file_bytes(path, "a surface", LARGEST)?.into_owned())
}

fn parse(mut bytes: Vec<u8>) -> Result<TriangleSurface, String> {
    let count = bytes.get(HEAD - 4..HEAD).and_then(|own| own.try_into().ok()).map(u32::from_le_bytes);
    if count.is_some_and(|count| bytes.len() == HEAD + TRIANGLE * count as usize) {
        // binary, even where its free text begins like that of the other kind
        bytes[0] = 0;
    }
    let mut cursor = Cursor::new(bytes);
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(|why| format!("it is no STL: {why}"))?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let mut known: HashMap<[u32; 3], usize> = HashMap::new();
    for triangle in triangles {
        let triangle = triangle.map_err(|why| format!("it is no STL: {why}"))?;
        let corners = triangle.vertices.map(|vertex| {
            // -0 is 0
            let place = <[f32; 3]>::from(vertex).map(|x| x + 0.0);
            *known.entry(place.map(f32::to_bits)).or_insert_with(|| {
                vertices.push(place.map(f64::from));
                vertices.len() - 1
            })
        });
        // some programs write triangles without area
        let [a, b, c] = corners;
        faces.extend((a != b && b != c && c != a).then_some(corners));
    }
    TriangleSurface::new(vertices, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, -0.0], [0.0, 0.0, 1.0]];
    const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    fn text() -> String {
        let vertex = |&corner: &usize| CORNERS[corner].map(|x| x.to_string()).join(" ");
        let face = |face: &[usize; 3]| {
            let corners: Vec<String> = face.iter().map(|corner| format!("vertex {}\n", vertex(corner))).collect();
            format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.concat())
        };
        format!("solid corner\n{}endsolid corner\n", FACES.iter().map(face).collect::<String>())
    }

    fn binary(head: &[u8]) -> Vec<u8> {
        let mut bytes = head.to_vec();
        bytes.resize(HEAD - 4, b' ');
        bytes.extend(4_u32.to_le_bytes());
        for face in FACES {
            let normal = [0.0_f32; 3];
            let all = normal.into_iter().chain(face.into_iter().flat_map(|corner| CORNERS[corner]));
            all.for_each(|x| bytes.extend(x.to_le_bytes()));
            bytes.extend([0, 0]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_give_one_surface() {
        for bytes in [text().into_bytes(), binary(b"made by hand"), binary(b"solid made by a program that ")] {
            let surface = parse(bytes).unwrap();
            assert_eq!((surface.vertices().len(), surface.triangles().len()), (4, 4));
        }
    }

    #[test]
    fn what_is_no_surface_is_told() {
        let mut cut = binary(b"cut");
        cut.truncate(200);
        for bytes in [Vec::new(), b"solid".to_vec(), b"[settings]\nend = 1.0\n".to_vec(), cut, vec![255; 4000]] {
            assert!(parse(bytes).is_err());
        }
    }

    #[test]
    fn no_bytes_end_in_a_panic() {
        let mut lot = 1_u64;
        for (number, start) in [text().into_bytes(), binary(b"x")].into_iter().cycle().take(4000).enumerate() {
            let mut bytes = start;
            for _ in 0..=number % 4 {
                lot = lot.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let place = (lot >> 33) as usize % bytes.len();
                bytes[place] = (lot >> 20) as u8;
            }
            let _ = parse(bytes);
        }
    }
}
