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

/// Kinds by their numbers in the file that are read: faces, lines and points that become node sets, and solids that are left out.
///
/// Source: Gmsh reference manual, "MSH file format", list of element types; those of higher order from Gmsh's `GmshDefines.h`.
pub(super) fn kind(number: i32) -> Option<Kind> {
    let of = |dimension, corners, order: i32, nodes: fn(usize) -> usize, name| {
        let order = order as usize;
        Some(Kind { dimension, corners, order, nodes: nodes(order), name })
    };
    let line = |order| of(1, 2, order, |p| p + 1, "lines");
    let triangle = |order| of(2, 3, order, |p| (p + 1) * (p + 2) / 2, "triangles");
    let triangle_of_edges = |order| of(2, 3, order, |p| 3 * p, "triangles");
    let quadrilateral = |order| of(2, 4, order, |p| (p + 1) * (p + 1), "quadrilaterals");
    let quadrilateral_of_edges = |order| of(2, 4, order, |p| 4 * p, "quadrilaterals");
    let tetrahedron = |order| of(3, 4, order, |p| (p + 1) * (p + 2) * (p + 3) / 6, "tetrahedra");
    let hexahedron = |order| of(3, 8, order, |p| (p + 1) * (p + 1) * (p + 1), "hexahedra");
    let prism = |order| of(3, 6, order, |p| (p + 1) * (p + 1) * (p + 2) / 2, "prisms");
    let pyramid = |order| of(3, 5, order, |p| (p + 1) * (p + 2) * (2 * p + 3) / 6, "pyramids");
    match number {
        15 => of(0, 1, 1, |_| 1, "points"),
        1 => line(1),
        8 => line(2),
        26..=28 => line(number - 23),
        62..=66 => line(number - 56),
        2 => triangle(1),
        9 => triangle(2),
        21 => triangle(3),
        23 => triangle(4),
        25 => triangle(5),
        42..=46 => triangle(number - 36),
        20 => triangle_of_edges(3),
        22 => triangle_of_edges(4),
        24 => triangle_of_edges(5),
        52..=56 => triangle_of_edges(number - 46),
        3 => quadrilateral(1),
        10 => quadrilateral(2),
        36..=38 => quadrilateral(number - 33),
        47..=51 => quadrilateral(number - 41),
        16 => quadrilateral_of_edges(2),
        39..=41 => quadrilateral_of_edges(number - 36),
        57..=61 => quadrilateral_of_edges(number - 51),
        4 => tetrahedron(1),
        11 => tetrahedron(2),
        29..=31 => tetrahedron(number - 26),
        71..=75 => tetrahedron(number - 65),
        5 => hexahedron(1),
        12 => hexahedron(2),
        92..=98 => hexahedron(number - 89),
        17 => of(3, 8, 2, |_| 20, "hexahedra"),
        6 => prism(1),
        13 => prism(2),
        90 | 91 => prism(number - 87),
        106..=110 => prism(number - 101),
        18 => of(3, 6, 2, |_| 15, "prisms"),
        7 => pyramid(1),
        14 => pyramid(2),
        118..=124 => pyramid(number - 115),
        19 => of(3, 5, 2, |_| 13, "pyramids"),
        _ => None,
    }
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
