/// A kind of elements of Gmsh.
pub(super) struct Kind {
    pub dimension: i32,
    pub nodes: usize,
    pub words: &'static str,
}

/// What makes elements of second order, which there are, of others.
const SECOND_ORDER: &str = "Mesh.ElementOrder = 2 makes quadrilaterals of nine nodes and triangles of six";

/// Kinds by their numbers in the file that are read.
///
/// Source: Gmsh reference manual, "MSH file format", list of element types; those of higher order from Gmsh's `GmshDefines.h`.
pub(super) fn kind(number: i32) -> Option<Kind> {
    let (dimension, nodes, words) = match number {
        15 => (0, 1, "point"),
        1 => (1, 2, "line of 2 nodes"),
        8 => (1, 3, "line of 3 nodes"),
        3 => (2, 4, "quadrilateral of 4 nodes"),
        16 => (2, 8, "quadrilateral of 8 nodes"),
        10 => (2, 9, "quadrilateral of 9 nodes"),
        9 => (2, 6, "triangle of 6 nodes"),
        _ => return None,
    };
    Some(Kind { dimension, nodes, words })
}

/// Kinds that are not read: what they are, and what to do.
pub(super) fn refused(number: i32) -> (String, String) {
    let of_first_order = "Mesh.RecombineAll = 1 makes quadrilaterals, and all of them with Mesh.SubdivisionAlgorithm = 1";
    let surfaces = "only surfaces are read, which become shells: mesh with gmsh -2, and where there are physical groups, save no volumes";
    let (words, remedy) = match number {
        2 => ("triangle of 3 nodes".into(), format!("{of_first_order}; or {SECOND_ORDER}")),
        20..=25 | 42..=46 | 52..=56 => ("triangle of third order or higher".into(), SECOND_ORDER.into()),
        36..=41 | 47..=51 | 57..=61 => ("quadrilateral of third order or higher".into(), SECOND_ORDER.into()),
        26..=28 | 62..=66 => ("line of third order or higher".into(), SECOND_ORDER.into()),
        4..=7 | 11..=14 | 17..=19 | 29..=33 | 71..=125 => ("solid element".into(), surfaces.into()),
        _ => {
            let known = "lines of 2 and 3 nodes, quadrilaterals of 4, 8 and 9 and triangles of 6 are read";
            (format!("element of type {number}"), known.into())
        }
    };
    (words, remedy)
}
