//! All sections of a scene file with their keys.

use super::extended::EXTENDS;
use super::own_parts::{OwnParts, all_forms};
use super::section::{Section, Shape};
use super::state_entries::STATE_FORMS;
use crate::design::repeated;
use crate::elements::entries::{
    AXIS, BETWEEN, Form, Forms, Key, Kind, ORIENTATION, Range, Type, forms, forms_of, joined, may, names_of, need,
};
use crate::elements::flexible::{MATERIAL, MATERIAL_KEYS, SECTION};
use crate::elements::forces::{DAMPERS, LOADS, SPRINGS};
use crate::elements::joints::{DRIVERS, Freedom, JOINTS, ROLLING};
use crate::functionals::load::{JOINT_LOADS, OF_JOINT};
use crate::functionals::quantities::QUANTITIES;
use crate::integrators::NewtonTolerance;
use crate::scenes::Edge;
use Range::{Any, AtLeastZero, Positive, Share};
use Type::{
    Choice, Choices, Count, Counts, Fixed, FixedOrMore, Fixeds, Flag, Item, Items, Lists, Node, NodeSets, Number, Numbers,
    OfMesh, OneOrMore, Over, Pairs, Points, Selections, Series, Stl, Strips, Table, Tables, Text, Texts, Vector, Weights,
};

/// The version of the format that this program reads.
pub(super) const VERSION: usize = 1;

/// How many numbers a design variable may have that has several.
pub(super) const MANY: std::ops::RangeInclusive<usize> = 2..=10_000;

/// Most elements along a line.
const MOST: usize = 10_000;
/// Most steps of a run.
const MOST_STEPS: usize = crate::integrators::MOST_STEPS;

const NAME: Key = need("name", Text, "name, by which others refer to it");

/// Keys at the top of a file.
pub(super) const TOP: Forms = Forms {
    common: &[],
    forms: &[Form {
        name: "",
        doc: "",
        keys: &[
            need("version", Count(VERSION, VERSION), "version of the format: 1"),
            may(EXTENDS, Text, "scene file in the same folder that this one adds to and changes"),
            may("name", Text, "name of the scene; the name of the file"),
            may("summary", Text, "what the scene is, in a line"),
            may("gravity", Vector("m/s2"), "acceleration by weight of all masses, beams, cables and shells; none"),
        ],
    }],
    own: None,
};

/// A table without a choice of forms.
macro_rules! one_form {
    ($($key:expr),* $(,)?) => {
        Forms { common: &[], forms: &[Form { name: "", doc: "", keys: &[$($key),*] }], own: None }
    };
}

const MOTION: Forms = one_form![
    may("point", Vector("m"), "point with the velocity; the origin"),
    may("velocity", Vector("m/s"), "velocity of the point; 0"),
    may("angular_velocity", Vector("rad/s"), "angular velocity in the world; 0"),
];

const AGGREGATE: Forms = one_form![
    need(
        "aggregate",
        Choice(&["smooth_maximum", "upper_maximum", "exponential", "squared_exponential", "power", "squared_power"]),
        "how many values become one near the largest; upper_maximum of n values is above it, by at most ln(n) / sharpness"
    ),
    need("sharpness", Fixed("1/unit", Positive), "rho: the larger, the nearer to the maximum; without unit beside size"),
    may(
        "size",
        Fixed("unit", Positive),
        "size of the quantity by which the sharpness is taken, rho = sharpness / size; not of powers; 1"
    ),
    may("times", Choice(&["start", "end", "run"]), "of which times; run"),
    may("normalized", Flag, "smooth_maximum divided by the measure of points and times; true"),
    may("continuous", Flag, "points count by the area for which they stand; false"),
];

/// Words for what is made over time, in the order of their meaning.
const OVER: Key = need(
    "over",
    Over(&["initial", "terminal", "integral"], &AGGREGATE),
    "value at the start, at the end, integral, or an aggregate",
);

/// What makes springs of a joint.
const SOFT: [Key; 2] = [
    may(
        "stiffness",
        Series("N/m, N m/rad"),
        "of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid",
    ),
    may("damping", Series("N s/m, N m s/rad"), "of a soft joint, of each of its equations; 0"),
];

const LINE: [Key; 8] = [
    need("name", Text, "name; its nodes are NAME.start, NAME.end and NAME[i], counted from 0"),
    need("from", Vector("m"), "where it starts"),
    may("to", Vector("m"), "where it ends; needed but with arc"),
    need("elements", Count(1, MOST), "equal elements"),
    may("start_node", Node, "node that it starts in; its own"),
    may("end_node", Node, "node that it ends in; its own"),
    may("clamped", Choices(&["start", "end"]), "ends that never move; none"),
    may("motion", Table(&MOTION), "rigid motion that it starts with; at rest"),
];

const WALL_OF_ROUND: Key = may("wall", Number("m", Positive), "thickness of the wall of a hollow one; solid");
const LINE_OF_SOLID: [Key; 2] =
    [need("from", Vector("m"), "start of its middle line"), need("to", Vector("m"), "end of its middle line")];
const SOLID: Forms = forms!([
    may("density", Number("kg/m3", Positive), "density; it is drawn only"),
]
"box" "a bar of rectangular section" [
    LINE_OF_SOLID[0],
    LINE_OF_SOLID[1],
    need("second_axis", Vector("-"), "direction that spans the plane of the width with the line"),
    need("width", Number("m", Positive), "along the second axis"),
    need("height", Number("m", Positive), "across it"),
]
"cylinder" "a round bar or tube" [
    LINE_OF_SOLID[0],
    LINE_OF_SOLID[1],
    need("diameter", Number("m", Positive), "outer diameter"),
    WALL_OF_ROUND,
]
"sphere" "a ball" [
    need("centre", Vector("m"), "centre"),
    need("diameter", Number("m", Positive), "outer diameter"),
    WALL_OF_ROUND,
]
"surface" "what a closed surface of triangles holds; without a density it need not be closed" [
    need("file", Stl, "a file in STL, text or binary, beside the scene file"),
    may("scale", Number("m", Positive), "length of a unit of the file; 1"),
    may("position", Vector("m"), "where its origin stands; that of the body"),
    may("orientation", Table(&ORIENTATION), "its axes in the world; those of the body"),
]);

const ARC: Forms = one_form![
    need("centre", Vector("m"), "centre of the circle"),
    need("axis", Vector("-"), "unit vector about which the line turns"),
    need("angle", Number("rad", Any), "angle"),
];

const LINEAR: Forms = one_form![
    need("name", Text, "what it is for"),
    need("coefficients", Weights, "coefficients of design variables, by the names that are listed"),
    may("at_most", Fixed("", Any), "largest value of the sum"),
    may("at_least", Fixed("", Any), "least value of the sum"),
    may("equal", Fixed("", Any), "value of the sum"),
];

const LIMIT: Forms = one_form![
    need("functional", Text, "name of a functional, or of a mode"),
    may("at_most", Fixed("unit", Any), "largest value"),
    may("at_least", Fixed("unit", Any), "least value"),
    may("equal", Fixed("unit", Any), "value"),
    may("scale", Fixed("unit", Positive), "a violation of this size is of the order of 1; the size of the limit"),
];

const PLY: Forms = one_form![
    need("thickness", Number("m", Positive), "thickness"),
    may("angle", Number("rad", Any), "from axis 1 of the shell to the fibres; 0"),
    need("young", Numbers(&[2], "N/m2", Positive), "E_1 along the fibres, E_2 across"),
    need("poisson", Number("-", Any), "nu_12"),
    need("shear", Numbers(&[3], "N/m2", Positive), "G_12, G_13, G_23"),
    need("density", Number("kg/m3", AtLeastZero), "density"),
    may("tension", Numbers(&[2], "N/m2", Positive), "strengths in tension, along and across; for tsai_wu"),
    may("compression", Numbers(&[2], "N/m2", Positive), "strengths in compression, along and across; for tsai_wu"),
    may("shear_strength", Number("N/m2", Positive), "strength in shear; for tsai_wu"),
];

const HELD: Forms = one_form![
    need("place", Counts(2, 0, 2000), "[i, j] of the grid"),
    need("node", Node, "a body, or a node of another shell or of a beam, that stands there"),
];

const NODE_OF_MESH: Forms = one_form![
    need("at", Text, "number of the node, as in \"12\", or a node set of one node"),
    need("node", Node, "a body, or a node of another shell or of a beam, that stands there"),
];

const PART: Forms = one_form![
    need("of", Texts, "groups of faces"),
    may("material", Item(&["material"]), "name of a material; that of the mesh"),
    may("thickness", OfMesh("m", Positive), "thickness; needed but with laminate"),
    may("laminate", Item(&["laminate"]), "name of a laminate"),
    may("direction", Vector("-"), "of laminates: axis 1, projected on the surface; that of the mesh"),
];

const COINCIDENT: Key =
    may("coincident", Flag, "nodes may stand at the same place, or on other faces, and are not joined: a slit; false");

const WALL: Forms = one_form![
    need("between", Counts(2, 0, 1000), "its corners, counted from 0"),
    need("elements", Count(1, 1000), "elements from one to the other"),
];

/// Sections whose entries are nodes or have nodes.
pub(super) const WITH_NODES: &[&str] =
    &["body", "point", "coordinate", "joint_angle", "state", "beam", "cable", "shell", "mesh", "thin_walls", "sphere"];
/// Sections whose entries have elements.
const WITH_ELEMENTS: &[&str] = &["beam", "cable", "shell", "mesh", "thin_walls", "sphere", "group"];
/// Sections whose entries put energy in or take it out.
const WITH_POWER: &[&str] = &joined::<&str, { LOADS.len() + 13 }>(&[
    &["spring", "damper", "element"],
    &names_of::<{ LOADS.len() }, _>(LOADS),
    &["joint", "body", "point"],
    WITH_ELEMENTS,
]);
/// Sections whose entries are joints.
pub(super) const WITH_MULTIPLIERS: &[&str] = &["joint", "driver"];

const BEAM: &[&str] = &["beam"];
const CABLE: &[&str] = &["cable"];
const MEMBERS: &[&str] = &["body", "point", "beam", "cable", "shell", "mesh", "thin_walls", "sphere"];
const SHELLS: &[&str] = &["shell", "mesh", "thin_walls"];
const ELEMENTS: Key = need("elements", Counts(2, 1, 1000), "elements along both directions");
const OF_BEAM: Key = need("beam", Item(BEAM), "name of a beam");
const OF_CABLE: Key = need("cable", Item(CABLE), "name of a cable");
const AT_SHARE: Key = need("share", Fixed("-", Share), "place along its length, from 0 to 1");
const COMPONENT: &str = "axial, shear along axes 2 and 3, torsion, bending about axes 2 and 3";
pub(super) const SECTION_COMPONENTS: &[&str] = &["axial", "shear_2", "shear_3", "torsion", "bending_2", "bending_3"];
const GROUP: Key = need(
    "of",
    Items(WITH_ELEMENTS),
    "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them",
);

const NAMED_NODES: Type = Type::NamedNodes(&POINT_OF_NODE);
const POINT_OF_NODE: Forms = one_form![
    need("on", Node, "node"),
    need("point", Vector("m"), "point of the node, in the world at the start: place, velocity and force are those there"),
];
const NODES: Key = need("nodes", NAMED_NODES, "nodes, or points of them, by the names that the formulas give them");
const DEFINITIONS: Key = may(
    "define",
    Type::Definitions,
    "names for formulas that the other formulas here use, later ones those before them; none",
);
const BREAKPOINTS: Key = may(
    "breakpoints",
    Fixeds(0, "s"),
    "times at which a formula of t jumps or bends: steps end there; needed, if only as [], where one chooses by abs, min, max or if_less; none",
);

/// Joints by formulas.
const OTHER_JOINTS: Forms = forms!([]
"formula" "formulas of the places of its nodes, and of the time, that are zero" [
    NODES,
    DEFINITIONS,
    need("equations", Type::SeriesOfNodes("m, rad"), "what is zero, as in [\"norm(b.position - a.position) - 0.5\"]"),
    BREAKPOINTS,
]
);
const JOINT_FORMS: [Form; JOINTS.len() + 3] =
    joined(&[&forms_of::<{ JOINTS.len() }, _>(JOINTS), OTHER_JOINTS.forms, ROLLING.forms]);

const STATE_KEYS: [Key; 4] = [
    NAME,
    may("nodes", NAMED_NODES, "nodes, or points of them, by the names that the formulas give them; none"),
    DEFINITIONS,
    BREAKPOINTS,
];
/// What is measured by a formula, or of a joint's multipliers.
const MEASURED: Forms = forms!([]
            "formula" "a formula of its nodes and of the time" [
                NODES,
                DEFINITIONS,
                need("value", Type::OfNodes("unit"), "the quantity, as in \"dot(tip.velocity, [0, 0, 1])\""),
                may("unit", Text, "its unit, for tables and charts; -"),
            ]
            "reaction" "weighted sum of a joint's multipliers" [
                OF_JOINT,
                need("weights", Series("-"), "a weight for each of its equations"),
            ]
            "reaction_norm" "length of the forces among a joint's multipliers [N]; of its moments [N m] where it has no force" [OF_JOINT]
);
/// What is measured of elements.
const OF_ELEMENTS: Forms = forms!([]
            "energy" "energy of all elements [J]" []
            "power" "power of loads, dampers, actuators and losses, of all that is in no energy [W]; an integral is a work [J]" [
                may("of", Items(WITH_POWER), "names of loads, springs, dampers, parts of one's own, members or groups; everything"),
            ]
            "mass" "mass of some elements [kg]" [may("of", Items(WITH_ELEMENTS), "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them; everything")]
            "strain_energy" "energy stored in strains [J]" [GROUP]
            "inertia_moment" "moment of inertia about an axis [kg m2]" [
                may("of", Items(WITH_ELEMENTS), "names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them; everything"),
                may("point", Vector("m"), "point of the axis; the origin"),
                AXIS,
            ]
            "von_mises" "von Mises stress by the yield stress [-]: on both surfaces of shells, on the outline of beams of a material and a shape, in the \
                         outer fibres of such cables" [
                GROUP,
                need("yield_stress", Number("N/m2", Positive), "yield stress"),
            ]
            "tsai_wu" "failure ratio of Tsai and Wu in laminates [-]" [
                GROUP,
                need("laminate", Item(&["laminate"]), "name of the laminate, whose plies have strengths"),
            ]
            "section_force" "force or moment in a section of a beam [N, N m]" [
                OF_BEAM, AT_SHARE,
                need("component", Choice(SECTION_COMPONENTS), COMPONENT),
            ]
            "section_forces" "force or moment in all sections of beams [N, N m]" [
                GROUP,
                need("component", Choice(SECTION_COMPONENTS), COMPONENT),
            ]
            "section_strain" "strain or curvature of a section of a beam [-, 1/m]" [
                OF_BEAM, AT_SHARE,
                need("component", Choice(SECTION_COMPONENTS), COMPONENT),
            ]
            "fibre_stress" "axial stress of a fibre of a beam [N/m2]" [
                OF_BEAM, AT_SHARE,
                need("young", Number("N/m2", Positive), "Young's modulus"),
                need("fibre", Numbers(&[2], "m", Any), "place of the fibre along axes 2 and 3"),
            ]
            "cable_strain" "axial strain of a cable [-]" [OF_CABLE, AT_SHARE]
            "cable_curvature" "curvature of a cable [1/m]" [OF_CABLE, AT_SHARE]
            "cable_stress" "axial stress of a fibre of a cable [N/m2]" [
                OF_CABLE, AT_SHARE,
                need("young", Number("N/m2", Positive), "Young's modulus"),
                may("distance", Number("m", Any), "of the fibre from the axis; 0"),
            ]
            "largest_cable_stress" "smooth maximum over time and length of the axial stress of a cable [N/m2]; over is an aggregate \
                                    smooth_maximum of the run" [
                OF_CABLE,
                need("young", Number("N/m2", Positive), "Young's modulus"),
                need("distance", Number("m", AtLeastZero), "of the outer fibres from the axis"),
            ]
);
const FUNCTIONAL_FORMS: [Form; QUANTITIES.len() + 5 + OF_ELEMENTS.forms.len()] =
    joined(&[&forms_of::<{ QUANTITIES.len() }, _>(QUANTITIES), MEASURED.forms, JOINT_LOADS.forms, OF_ELEMENTS.forms]);
const SPRING_FORMS: [Form; SPRINGS.len()] = forms_of(SPRINGS);
const DAMPER_FORMS: [Form; DAMPERS.len()] = forms_of(DAMPERS);
const DRIVER_FORMS: [Form; DRIVERS.len()] = forms_of(DRIVERS);

const LOAD_SECTIONS: [Section; LOADS.len()] = {
    let (mut sections, mut place) = ([FIRST_SECTIONS[0]; LOADS.len()], 0);
    while place < LOADS.len() {
        let form = &LOADS[place].form;
        let forms = Forms { common: &[NAME], forms: std::slice::from_ref(form), own: None };
        sections[place] = Section { name: form.name, shape: Shape::Listed, doc: form.doc, forms };
        place += 1;
    }
    sections
};

/// All sections, in the order of the reference page.
pub(super) const SECTIONS: &[Section] = &joined::<Section, { FIRST_SECTIONS.len() + LOADS.len() + MORE_SECTIONS.len() }>(&[
    FIRST_SECTIONS,
    &LOAD_SECTIONS,
    MORE_SECTIONS,
]);

/// Sections before the loads.
const FIRST_SECTIONS: &[Section] = &[
    Section {
        name: "variable",
        shape: Shape::Named,
        doc: "A design variable. NAME is how formulas call it.",
        forms: one_form![
            need("initial", FixedOrMore("unit"), "value of the initial design; with count one for all, or as many"),
            need("bounds", Fixeds(2, "unit"), "least and largest value"),
            may("unit", Text, "unit, for tables and charts; -"),
            may(
                "count",
                Count(*MANY.start(), *MANY.end()),
                "how many there are: NAME[0], NAME[1] and so on are numbers in formulas, spline(NAME, s) is a value between them, and where a \
                 list of numbers is wanted NAME stands for all; one"
            ),
            may(
                "per_face",
                Text,
                "name of a mesh, or a group of its faces, PLATE.GROUP: the variable is one for each face, NAME[17] that of the face with \
                 the number 17, and in formulas of the thickness NAME is that of the face; one for all"
            ),
            may("per_node", Text, "the same for each node of the faces; one for all"),
            may("name", Text, "how commands and results call it; NAME"),
        ],
    },
    Section { name: "material", shape: Shape::Named, doc: "An isotropic elastic material.", forms: MATERIAL_KEYS },
    Section {
        name: "section",
        shape: Shape::Named,
        doc: "The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place \
              along the length from 0 to 1: `width = \"0.05 - 0.02 * share\"`.",
        forms: SECTION,
    },
    Section {
        name: "laminate",
        shape: Shape::Named,
        doc: "Plies of a shell, from below.",
        forms: one_form![
            need("plies", Tables(&PLY), "plies"),
            may("offset", Number("m", Any), "of the middle of all plies from the nodes, along the normal; 0"),
            may("shear_factor", Fixed("-", Positive), "share of the shear stiffness that acts; 5/6"),
        ],
    },
    Section {
        name: "body",
        shape: Shape::Listed,
        doc: "A rigid body: a frame in space, with or without mass. The body named ground is there already; it never moves.",
        forms: one_form![
            NAME,
            may("position", Vector("m"), "origin of its frame; that of the world"),
            may("orientation", Table(&ORIENTATION), "its axes; those of the world"),
            may("velocity", Vector("m/s"), "velocity of the origin; 0"),
            may("angular_velocity", Vector("rad/s"), "in the world; 0"),
            may("mass", Number("kg", Positive), "mass; none"),
            may("mass_centre", Vector("m"), "in its own axes from its origin; the origin"),
            may(
                "inertia",
                Numbers(&[3, 6], "kg m2", Any),
                "xx, yy, zz, and xy, xz, yz if they are not 0, about the mass centre in its own axes; needed with mass"
            ),
            may("coordinates", Choice(&["euler_parameters", "natural"]), "kind of its coordinates; euler_parameters"),
            may(
                "solids",
                Tables(&SOLID),
                "solids of which it consists, in the world at the start, instead of mass, mass_centre and inertia; none"
            ),
            may("draw", Points, "corners of a line of the picture, in the world at the start; none"),
        ],
    },
    Section {
        name: "point",
        shape: Shape::Listed,
        doc: "A point without rotation.",
        forms: one_form![
            NAME,
            need("position", Vector("m"), "place"),
            may("velocity", Vector("m/s"), "velocity; 0"),
            may("mass", Number("kg", Positive), "mass; none"),
        ],
    },
    Section {
        name: "beam",
        shape: Shape::Listed,
        doc: "A beam, geometrically exact, with shear and torsion, of three-node elements.",
        forms: one_form![
            LINE[0],
            LINE[1],
            LINE[2],
            LINE[3],
            need("section", Item(&["section"]), "name of a section"),
            may(
                "second_axis",
                Vector("-"),
                "direction that spans the plane of axes 1 and 2 with the line; needed but with arc, whose axis is taken"
            ),
            may("arc", Table(&ARC), "part of a circle instead of a straight line"),
            may("twist", Number("rad", Any), "turn of the section from start to end; 0"),
            LINE[4],
            LINE[5],
            LINE[6],
            LINE[7],
        ],
    },
    Section {
        name: "cable",
        shape: Shape::Listed,
        doc: "A cable in absolute nodal coordinates: straight at the start, without torsion.",
        forms: one_form![
            LINE[0],
            LINE[1],
            LINE[2],
            LINE[3],
            need("section", Item(&["section"]), "name of a section that is not of type beam"),
            may("strains", Choice(&["exact", "small"]), "strains of its energy; exact"),
            LINE[4],
            LINE[5],
            LINE[6],
            LINE[7],
        ],
    },
    Section {
        name: "shell",
        shape: Shape::Listed,
        doc: "A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along \
              the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i].",
        forms: forms!([
            NAME,
            ELEMENTS,
            may("material", Item(&["material"]), "name of a material; needed but with laminate"),
            may("thickness", Strips("m", Positive),
                "thickness, or those of strips of equal width across the first direction, or a formula of the share of that direction, from 0 to 1, \
                 which is taken at the middle of each element; needed with material"),
            may("laminate", Item(&["laminate"]), "name of a laminate"),
            may("direction", Vector("-"), "of laminates: axis 1, projected on the surface; needed with laminate"),
            may("damping", Number("s", AtLeastZero), "damping proportional to stiffness; none"),
            may("clamped", Choices(&Edge::NAMES), "edges that never move; none"),
            may("joined", Items(SHELLS), "shells and walls whose nodes it takes over where its edges meet them, to a millionth of its diagonal: with each at least one; none"),
            may("held", Tables(&HELD), "nodes of the grid that are there already; none"),
            may("closed", Flag, "the first direction ends in the nodes where it starts; false"),
            COINCIDENT,
        ]
        "plate" "flat" [
            may("corner", Vector("m"), "a corner; the origin"),
            need("first", Vector("m"), "edge along the first direction"),
            need("second", Vector("m"), "edge along the second direction"),
        ]
        "cylinder" "part of a circular cylinder" [
            need("from", Vector("m"), "where the edge line starts"),
            need("along", Vector("m"), "the edge line, which is the second direction"),
            need("centre", Vector("m"), "a point of the axis"),
            need("axis", Vector("-"), "unit vector of the axis"),
            need("angle", Number("rad", Any), "turn of the edge line about the axis, which is the first direction"),
        ]
        "sphere_patch" "patch of a sphere between longitudes and latitudes about z" [
            need("centre", Vector("m"), "centre"),
            need("radius", Number("m", Positive), "radius"),
            need("longitude", Numbers(&[2], "rad", Any), "from and to, the first direction"),
            need("latitude", Numbers(&[2], "rad", Any), "from and to, the second direction"),
        ]
        "sphere_face" "one of six parts of a sphere" [
            need("centre", Vector("m"), "centre"),
            need("radius", Number("m", Positive), "radius"),
            need("first", Vector("-"), "unit vector along an edge of the face"),
            need("second", Vector("-"), "unit vector along the other, at right angles"),
        ]),
    },
    Section {
        name: "mesh",
        shape: Shape::Listed,
        doc: "A shell on a mesh of quadrilaterals of four, eight and nine nodes and triangles of six. Node NAME[i] is the one with the number i of the \
              file of Gmsh, or the i-th of the points from 0 on; NAME.SET are the nodes of a node set, which a physical curve or point is, or of a group \
              of faces, NAME.SET[i] is one of them, counted from 0; NAME.GROUP are the elements of a group, which a physical surface is.",
        forms: forms!([
            NAME,
            may("material", Item(&["material"]), "name of a material; needed but with laminate or parts"),
            may("thickness", OfMesh("m", Positive),
                "thickness of faces that have no part; may use design variables of faces and nodes; needed with material but with parts"),
            may("laminate", Item(&["laminate"]), "name of a laminate"),
            may("direction", Vector("-"), "of laminates: axis 1, projected on the surface; needed with laminate"),
            may("parts", Tables(&PART), "sections of groups of faces; all faces have one"),
            may("damping", Number("s", AtLeastZero), "damping proportional to stiffness; none"),
            may("clamped", Texts, "node sets, or groups of faces, whose nodes never move; none"),
            may("joined", Items(SHELLS), "shells, meshes and walls whose nodes it takes over where its outer edges meet them, to a millionth of its diagonal: with each at least one; none"),
            may("nodes", Tables(&NODE_OF_MESH), "nodes that are there already; none"),
            may("groups", Selections, "groups of faces by name, beside those of the file: numbers of the faces, or a condition such as \
                 \"norm([x, y, 0]) > 0.5 and z < 1\" that holds at the mean of their corners, in coordinates before scale; none"),
            may("node_sets", Selections, "node sets by name, beside those of the file: numbers of the nodes, or a condition such as \"abs(x) < 1e-6\", in \
                 coordinates before scale; none"),
            may("reverse", Texts, "groups of faces that are turned round, so that their normals point to the other side, with what hangs together with them; none"),
            may("crease", Fixed("rad", Positive), "faces at a larger angle meet in an edge, which keeps its angle; 45 deg"),
            may("scale", Number("-", Positive), "by which the points are multiplied, such as 0.001 for a mesh in millimetres; 1"),
            may("orientation", Table(&ORIENTATION), "turn of the points about the origin, after scale; none"),
            may("position", Vector("m"), "by which the points are moved, after orientation; 0"),
            COINCIDENT,
        ]
        "gmsh" "from a file of Gmsh, version 2 or 4, text or binary; triangles of three nodes are raised to six" [
            need("file", Text, "path of the file, from the folder of this file on"),
        ]
        "faces" "from points and faces here" [
            need("points", Points, "points, counted from 0 on"),
            need("faces", Lists, "points of each face: corners counterclockwise as seen from where the normal points to, then the middles of the edges \
                 from the first corner on, then the middle"),
        ]),
    },
    Section {
        name: "thin_walls",
        shape: Shape::Listed,
        doc: "A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them.",
        forms: forms!([
            NAME,
            may("start", Vector("m"), "where the origin of the profile starts; the origin"),
            need("along", Vector("m"), "its line"),
            need("first_axis", Vector("-"), "axis 1 of the profile, at right angles to the line"),
            may("twist", Number("rad", Any), "turn of the profile about the line from start to end; 0"),
            need("elements", Count(1, MOST), "elements along the line"),
            MATERIAL,
            need("thickness", OneOrMore("m", Positive), "thickness, or that of each wall"),
        ]
        "box_tube" "rectangular tube of four walls: lower, right, upper, left" [
            need("width", Number("m", Positive), "of the middle lines along axis 1"),
            need("height", Number("m", Positive), "of the middle lines along axis 2"),
            need("across", Counts(2, 1, 100), "elements across lower and upper, and right and left walls"),
        ]
        "i_section" "two flanges and a web: both halves of the lower flange, of the upper one, web" [
            need("width", Number("m", Positive), "of the flanges along axis 1"),
            need("height", Number("m", Positive), "of the web along axis 2"),
            need("across", Counts(2, 1, 100), "elements across half a flange, and the web"),
        ]
        "profile" "walls between corners" [
            need("corners", Pairs("m"), "places along axes 1 and 2"),
            need("walls", Tables(&WALL), "walls between corners"),
        ]),
    },
    Section {
        name: "sphere",
        shape: Shape::Listed,
        doc: "A closed sphere of shells, of six faces.",
        forms: one_form![
            NAME,
            may("centre", Vector("m"), "centre; the origin"),
            need("radius", Number("m", Positive), "radius"),
            need("elements", Count(1, 100), "elements along each edge of a face"),
            MATERIAL,
            need("thickness", Number("m", Positive), "thickness"),
        ],
    },
    Section {
        name: "group",
        shape: Shape::Listed,
        doc: "Elements of shells by their places in the grid, for functionals.",
        forms: one_form![
            NAME,
            need("of", Item(&["shell"]), "name of a shell"),
            may("first", Counts(2, 0, 1000), "first and last element along the first direction, from 0; all"),
            may("second", Counts(2, 0, 1000), "first and last element along the second direction, from 0; all"),
        ],
    },
    Section {
        name: "coordinate",
        shape: Shape::Listed,
        doc: "A number that moves, with the meaning that springs and parts of one's own on it give it; one of them must have inertia.",
        forms: one_form![
            NAME,
            may("initial", Number("", Any), "value at the start; 0"),
            may("rate", Number("1/s", Any), "its rate there; 0"),
        ],
    },
    Section {
        name: "joint_angle",
        shape: Shape::Listed,
        doc: "A coordinate that counts the angle of b against a over any number of turns, for gears, springs and functionals; a joint must \
              hold the axis.",
        forms: one_form![NAME, BETWEEN, AXIS],
    },
    Section {
        name: "state",
        shape: Shape::Listed,
        doc: "States z of first order, z' = f(z, nodes, t), as of a controller, an actuator, the slip of a tyre, inflow. Formulas know nodes as those of an \
              [[element]] do; where a state is a node c of others, their formulas know c.NAME of its values and of its outputs.",
        forms: Forms { common: &STATE_KEYS, forms: &STATE_FORMS, own: None },
    },
    Section {
        name: "joint",
        shape: Shape::Listed,
        doc: "What holds nodes together. Geometry is given in the world at the start.",
        forms: Forms { common: &[NAME, SOFT[0], SOFT[1]], forms: &JOINT_FORMS, own: Some(Kind::Joint) },
    },
    Section {
        name: "rigid_interface",
        shape: Shape::Listed,
        doc: "Nodes that a body carries along as they stand, by a rigid link to each.",
        forms: one_form![
            NAME,
            need("body", Node, "the body, or one of the nodes"),
            need("nodes", NodeSets, "nodes, edges of shells, ends of walls, node sets of meshes"),
        ],
    },
    Section {
        name: "hold",
        shape: Shape::Listed,
        doc: "Nodes that are held where they stand while the equilibrium is found at which the motion begins (`start` of `[settings]`), and let go then.",
        forms: one_form![
            need("nodes", NodeSets, "what is held"),
            may("directions", Choices(&Freedom::NAMES), "in which directions of the world; all that it has"),
        ],
    },
    Section {
        name: "spin",
        shape: Shape::Listed,
        doc: "Parts that turn steadily about an axis of the world where the motion begins (`start = \"steady\"` of `[settings]`): it begins at the \
              equilibrium in the frame that turns with them. Weights of what turns count with their part along the axis, the mean over a turn.",
        forms: one_form![
            need("parts", Items(MEMBERS), "bodies, points and members that turn, with all their nodes"),
            may("point", Vector("m"), "a point of the axis; the origin"),
            need("axis", Vector("-"), "its direction"),
            need("rate", Number("rad/s", Any), "of the turn about it"),
        ],
    },
    Section {
        name: "tie",
        shape: Shape::Listed,
        doc: "Edges of shells, or other nodes, that follow the faces of shells on which they lie, where nodes do not meet: edges in the mean along \
              them, so that constant stresses pass exactly; other nodes where they stand.",
        forms: one_form![
            NAME,
            need(
                "nodes",
                NodeSets,
                "what follows: edges of shells, ends of walls, node sets of meshes, nodes; the more finely divided or the shorter \
                 side"
            ),
            need("to", Items(SHELLS), "shells, meshes and walls whose faces they follow"),
            may(
                "within",
                Fixed("m", AtLeastZero),
                "how far from the faces they may lie: they keep that distance; a millionth of the diagonal of \
                all of them"
            ),
        ],
    },
    Section {
        name: "driver",
        shape: Shape::Listed,
        doc: "A prescribed motion.",
        forms: Forms { common: &[NAME], forms: &DRIVER_FORMS, own: None },
    },
    Section {
        name: "spring",
        shape: Shape::Listed,
        doc: "A spring.",
        forms: Forms { common: &[NAME], forms: &SPRING_FORMS, own: Some(Kind::Spring) },
    },
    Section {
        name: "damper",
        shape: Shape::Listed,
        doc: "A damper.",
        forms: Forms { common: &[NAME], forms: &DAMPER_FORMS, own: None },
    },
    Section {
        name: "element",
        shape: Shape::Listed,
        doc: "A part of one's own, by formulas of what its nodes do. Of a node called a in `nodes` these know a.position and a.velocity [m, m/s], \
              of one with axes a.x_axis, a.y_axis, a.z_axis and a.angular_velocity [rad/s], all in the world; of a joint angle a.value and \
              a.rate, of a state a.NAME of its values and outputs; and the time t.",
        forms: one_form![
            NAME,
            NODES,
            DEFINITIONS,
            may("kinetic", Type::OfNodes("J"), "kinetic energy, of places and rates; none"),
            may("potential", Type::OfNodes("J"), "potential energy, of places; none"),
            may(
                "force",
                Type::NamedFormulas("N, N m"),
                "forces on its nodes in the world, of anything; of a joint angle its moment; none"
            ),
            may("moment", Type::NamedFormulas("N m"), "moments on bodies among them in the world, of anything; none"),
            BREAKPOINTS,
        ],
    },
];
/// Sections behind the loads.
const MORE_SECTIONS: &[Section] = &[
    Section {
        name: "drawing",
        shape: Shape::Listed,
        doc: "A line of the picture that moves with a node.",
        forms: one_form![may("on", Node, "node; ground"), need("points", Points, "corners in the world at the start"),],
    },
    Section {
        name: "functional",
        shape: Shape::Listed,
        doc: "A number that a run gives, with its gradient.",
        forms: Forms { common: &[NAME, OVER], forms: &FUNCTIONAL_FORMS, own: Some(Kind::Functional) },
    },
    Section {
        name: "mode",
        shape: Shape::Listed,
        doc: "A number of a mode of small vibrations about the start or the equilibrium, measured by runs, gradients, sweeps and optimizations.",
        forms: one_form![
            need("name", Text, "what results, objective and limits call it"),
            need(
                "number",
                Count(1, 200),
                "which mode, from 1, as costate modes lists them, without rigid motions and those that do not vibrate"
            ),
            may("measure", Choice(&["frequency", "growth"]), "its omega in rad/s, or its growth in 1/s; frequency"),
            may(
                "damped",
                Flag,
                "with dampers, states of first order and what else depends on velocities, as about a steady turn always; false"
            ),
        ],
    },
    Section {
        name: "settings",
        shape: Shape::Once,
        doc: "How a run is made where the command line does not say otherwise.",
        forms: one_form![
            may(
                "end",
                Fixed("s", Positive),
                "duration, or with method static the last load factor; needed but with static, where it is 1"
            ),
            may("steps", Count(1, MOST_STEPS), "steps of equal size; needed without tolerance"),
            may(
                "method",
                Text,
                "integrator: esdirk4, generalized-alpha:0.6, variational, static and others, as for --method; esdirk4"
            ),
            may(
                "tolerance",
                Fixed("-", Positive),
                "steps are chosen by their error: relative and absolute; steps of equal size"
            ),
            may("velocity_tolerance", Fixed("-", Positive), "the same for velocities; tolerance"),
            may("longest_step", Fixed("s", Positive), "longest step that tolerance may choose; any"),
            may(
                "constraint_level",
                Choice(&["position", "velocity", "acceleration"]),
                "time derivative on which constraints are kept; acceleration"
            ),
            may(
                "newton",
                Choice(&[
                    NewtonTolerance::RoundOff.name(),
                    NewtonTolerance::Residual.name(),
                    NewtonTolerance::Scaled.name(),
                ]),
                "when Newton's method stops, as for --newton; round-off"
            ),
            may("solver", Choice(&["automatic", "dense", "multifrontal"]), "solver of the linear systems; automatic"),
            may(
                "start",
                Choice(&["given", "equilibrium", "steady"]),
                "where the motion begins: at the coordinates that the parts give, at the equilibrium near them under the loads of t = 0, or at that in \
                 the frame that turns with what `[[spin]]` names; given"
            ),
            may("divide_steps", Flag, "halve steps that Newton's method cannot make; false"),
            may("drop_redundant", Flag, "leave out redundant constraint equations instead of refusing them; false"),
            may("project_start", Flag, "project an inconsistent start onto the constraints instead of refusing it; false"),
        ],
    },
    Section {
        name: "output",
        shape: Shape::Once,
        doc: "What a run writes where the command line does not say otherwise.",
        forms: one_form![
            may("step", Fixed("s", Positive), "histories at multiples of this time; at the steps"),
            may(
                "histories",
                Texts,
                "what has columns in them, by names: nodes (\"crank\", \"beam[4]\", \"beam.end\", \"plate[2,0]\"), members with all their \
                 nodes, joints, functionals, and \"energy\"; everything"
            ),
            may("vtk", Flag, "meshes for ParaView; false"),
            may("film", Flag, "the motion as a film, film.png; false"),
        ],
    },
    Section {
        name: "optimization",
        shape: Shape::Once,
        doc: "What costate optimize does. The objective is minimize, maximize, or a sum with sense and weights.",
        forms: one_form![
            may("minimize", Text, "name of a functional, or of a mode, that is to become small"),
            may("maximize", Text, "name of one that is to become large"),
            may("sense", Choice(&["minimize", "maximize"]), "of a sum; minimize"),
            may("weights", Weights, "weights of functionals in a sum, by name"),
            may("varying", Texts, "names of the design variables that may change, as they are listed; all"),
            may("scale", Fixed("unit", Positive), "size of the objective that is of the order of 1; its size at the start"),
            may(
                "screening",
                Fixed("-", Positive),
                "limits kept by more than this share need no gradient; every limit has one"
            ),
            may("constraint", Tables(&LIMIT), "limits of functionals and modes"),
            may("linear", Tables(&LINEAR), "limits of sums of design variables"),
        ],
    },
];

/// Keys for which no section is: `define`.
pub(super) const DEFINE: (&str, &str) = (
    "define",
    "Named numbers and vectors: `NAME = 2`, `NAME = \"0.5 * length\"`, `NAME = [0, \"length\", 0]`, in any order. Formulas use them by name. \
     `\"corner{k}\" = { for = { k = [0, 1, 2] }, value = \"platform * out{k}\" }` stands for three.",
);

/// A loop in the entries of lists and of sections with names.
pub(super) const FOR: Key = may(
    "for",
    Text,
    "the entry stands for many: `for = { i = { from = 1, to = 5 } }` makes five of it, `for = { i = [1, 3, 7] }` three, \
     `for = { side = [\"left\", \"right\"] }` two; in its name and all its texts `{i}`, `{i + 1}` and `{side}` are replaced; several names \
     make all pairs; of two numbers that do not follow each other `{ values = [1, 5] }` says that these two are meant",
);

impl OwnParts {
    /// Forms of the sections of joints, drivers, springs, dampers and functionals, with the names of these.
    pub(crate) fn listed(&self) -> Vec<(&'static str, Form)> {
        let sections = ["joint", "driver", "spring", "damper", "functional"];
        let own = SECTIONS.iter().filter(|own| sections.contains(&own.name));
        own.flat_map(|own| all_forms(&own.forms, self).into_iter().map(|form| (own.name, form))).collect()
    }

    /// Two parts of a section have different names.
    ///
    /// # Errors
    /// A name that a part of one's own and another have.
    pub(crate) fn check(&self) -> Result<(), String> {
        for section in SECTIONS {
            let forms = all_forms(&section.forms, self);
            if let Some(name) = repeated(forms.iter().map(|form| form.name)) {
                return Err(format!("two parts of the section [[{}]] are named \"{name}\"", section.name));
            }
        }
        Ok(())
    }
}
