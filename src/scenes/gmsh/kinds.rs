/// A kind of elements of Gmsh.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kind {
    pub dimension: i32,
    /// Ends of a line.
    pub corners: usize,
    /// Parts into which nodes divide an edge.
    pub order: usize,
    pub nodes: usize,
    name: &'static str,
}

impl Kind {
    /// Its name in messages.
    pub fn words(self) -> String {
        if self.dimension == 0 { self.name.into() } else { format!("{} of {} nodes", self.name, self.nodes) }
    }
    /// It has nodes inside, not on its edges alone.
    pub fn is_complete(self) -> bool {
        self.nodes > self.corners * self.order
    }
}

/// Kinds that differ in their order: name, dimension, corners, nodes by the order, the least order, and the numbers of this and the following
/// ones in the file.
type Family = (&'static str, i32, usize, fn(usize) -> usize, usize, &'static [i32]);

/// What is read: faces, lines and points that become node sets, and solids that are left out.
///
/// Source: Gmsh reference manual, "MSH file format", list of element types; those of higher order from Gmsh's `GmshDefines.h`.
const FAMILIES: [Family; 13] = [
    ("points", 0, 1, |_| 1, 1, &[15]),
    ("lines", 1, 2, |p| p + 1, 1, &[1, 8, 26, 27, 28, 62, 63, 64, 65, 66]),
    ("triangles", 2, 3, |p| (p + 1) * (p + 2) / 2, 1, &[2, 9, 21, 23, 25, 42, 43, 44, 45, 46]),
    // with nodes on their edges alone
    ("triangles", 2, 3, |p| 3 * p, 3, &[20, 22, 24, 52, 53, 54, 55, 56]),
    ("quadrilaterals", 2, 4, |p| (p + 1) * (p + 1), 1, &[3, 10, 36, 37, 38, 47, 48, 49, 50, 51]),
    ("quadrilaterals", 2, 4, |p| 4 * p, 2, &[16, 39, 40, 41, 57, 58, 59, 60, 61]),
    ("tetrahedra", 3, 4, |p| (p + 1) * (p + 2) * (p + 3) / 6, 1, &[4, 11, 29, 30, 31, 71, 72, 73, 74, 75]),
    ("hexahedra", 3, 8, |p| (p + 1) * (p + 1) * (p + 1), 1, &[5, 12, 92, 93, 94, 95, 96, 97, 98]),
    ("hexahedra", 3, 8, |_| 20, 2, &[17]),
    ("prisms", 3, 6, |p| (p + 1) * (p + 1) * (p + 2) / 2, 1, &[6, 13, 90, 91, 106, 107, 108, 109, 110]),
    ("prisms", 3, 6, |_| 15, 2, &[18]),
    ("pyramids", 3, 5, |p| (p + 1) * (p + 2) * (2 * p + 3) / 6, 1, &[7, 14, 118, 119, 120, 121, 122, 123, 124]),
    ("pyramids", 3, 5, |_| 13, 2, &[19]),
];

/// The kind of a number in the file, if it is read.
pub(super) fn kind(number: i32) -> Option<Kind> {
    FAMILIES.iter().find_map(|&(name, dimension, corners, nodes, first, numbers)| {
        let order = first + numbers.iter().position(|own| *own == number)?;
        Some(Kind { dimension, corners, order, nodes: nodes(order), name })
    })
}

/// Why kinds of another number are not read, and what to do.
pub(super) fn refused(number: i32) -> String {
    match number {
        32 | 33 | 79..=83 | 99..=105 | 111..=117 | 125..=131 => {
            "solids of third order or higher without nodes inside are not known: Mesh.ElementOrder = 2, or \
             Mesh.SecondOrderIncomplete = 0"
                .into()
        }
        _ => {
            format!("elements of type {number} are not known: points, lines, triangles, quadrilaterals and solids are read")
        }
    }
}
