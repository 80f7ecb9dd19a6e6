/// A kind of elements of Gmsh.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    pub dimension: i32,
    pub nodes: usize,
    pub words: &'static str,
}

/// What makes elements of second order.
const SECOND_ORDER: &str = "Mesh.ElementOrder = 2 makes quadrilaterals of nine nodes and triangles of six";

/// Kinds by their numbers in the file that are read: faces, lines and points that become node sets, and solids that are left out.
///
/// Source: Gmsh reference manual, "MSH file format", list of element types; those of higher order from Gmsh's `GmshDefines.h`.
pub(super) fn kind(number: i32) -> Option<Kind> {
    let (dimension, nodes, words) = match number {
        15 => (0, 1, "points"),
        1 => (1, 2, "lines of 2 nodes"),
        8 => (1, 3, "lines of 3 nodes"),
        2 => (2, 3, "triangles of 3 nodes"),
        9 => (2, 6, "triangles of 6 nodes"),
        3 => (2, 4, "quadrilaterals of 4 nodes"),
        16 => (2, 8, "quadrilaterals of 8 nodes"),
        10 => (2, 9, "quadrilaterals of 9 nodes"),
        4 => (3, 4, "tetrahedra of 4 nodes"),
        11 => (3, 10, "tetrahedra of 10 nodes"),
        5 => (3, 8, "hexahedra of 8 nodes"),
        17 => (3, 20, "hexahedra of 20 nodes"),
        12 => (3, 27, "hexahedra of 27 nodes"),
        6 => (3, 6, "prisms of 6 nodes"),
        18 => (3, 15, "prisms of 15 nodes"),
        13 => (3, 18, "prisms of 18 nodes"),
        7 => (3, 5, "pyramids of 5 nodes"),
        19 => (3, 13, "pyramids of 13 nodes"),
        14 => (3, 14, "pyramids of 14 nodes"),
        _ => return None,
    };
    Some(Kind { dimension, nodes, words })
}

/// Why kinds of another number are not read, and what to do.
pub(super) fn refused(number: i32) -> String {
    let words = match number {
        20..=25 | 42..=46 | 52..=56 => "triangles of third order or higher",
        36..=41 | 47..=51 | 57..=61 => "quadrilaterals of third order or higher",
        26..=28 | 62..=66 => "lines of third order or higher",
        29..=33 | 71..=83 | 90..=140 => "solids of third order or higher",
        _ => {
            return format!(
                "elements of type {number} are not known: lines, triangles and quadrilaterals of first and second order are read"
            );
        }
    };
    format!("no element is made of {words}; {SECOND_ORDER}")
}
