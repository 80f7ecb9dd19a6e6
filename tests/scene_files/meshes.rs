//! Meshes of scene files against shells on grids, and design variables of faces and nodes against one of all.

use super::parsed;
use costate::scenes::{AnyScene, FileScene, Prepared, built_in};

/// A clamped sheet that falls, with what is between the marks.
fn sheet(variable: &str, shell: &str, names: [&str; 3]) -> FileScene {
    let [tip, group, rim] = names;
    let text = format!(
        r#"
version = 1
gravity = [0, 0, -9.81]
settings = {{ end = 0.02, steps = 4 }}

[variable.h]
initial = 0.004
bounds = [0.001, 0.01]
unit = "m"
{variable}

[material.rubber]
young = 2e7
poisson = 0.4
density = 1100

[optimization]
minimize = "mass"
varying = ["h"]

{shell}
material = "rubber"
thickness = "h"

[[body]]
name = "hub"
position = [0.4, 0.1, 0]
mass = 0.2
inertia = [1e-3, 1e-3, 1e-3]

[[rigid_interface]]
name = "hub"
body = "hub"
nodes = ["{rim}"]

[[force]]
name = "push"
on = "{tip}"
direction = [0, 0, 1]
size = 0.3

[[pressure]]
name = "press"
shell = "sheet"
size = 20

[[functional]]
name = "mass"
type = "mass"
of = "sheet"
over = "terminal"

[[functional]]
name = "energy"
type = "strain_energy"
of = "{group}"
over = "integral"

[[functional]]
name = "stress"
type = "von_mises"
of = "sheet"
yield_stress = 1e5
over = {{ aggregate = "smooth_maximum", sharpness = 10 }}

[[functional]]
name = "height"
type = "position"
on = "hub"
direction = [0, 0, 1]
over = "terminal"
"#
    );
    parsed(&text)
}

const GRID: &str = r#"
[[group]]
name = "right"
of = "sheet"
first = [1, 1]

[[shell]]
name = "sheet"
type = "plate"
first = [0.4, 0, 0]
second = [0, 0.2, 0]
elements = [2, 1]
clamped = "first_start"
"#;

/// The same nodes, row by row, of two quadrilaterals of nine; a tenth of a metre in a unit, such as e-1.
fn mesh(unit: &str) -> String {
    let points = (0..3).flat_map(|j| (0..5).map(move |i| format!("[{i}{unit}, {j}{unit}, 0]")));
    let points: Vec<String> = points.collect();
    format!(
        r#"
[[mesh]]
name = "sheet"
type = "faces"
points = [{}]
faces = [[0, 2, 12, 10, 1, 7, 11, 5, 6], [2, 4, 14, 12, 3, 9, 13, 7, 8]]
groups = {{ left = [0], right = [1] }}
node_sets = {{ root = [0, 5, 10], rim = [4, 9, 14], tip = [8] }}
clamped = ["root"]
"#,
        points.join(", ")
    )
}

const OF_GRID: [&str; 3] = ["sheet[3, 1]", "right", "sheet.first_end"];
const OF_MESH: [&str; 3] = ["sheet.tip", "sheet.right", "sheet.rim"];

fn values_and_gradients(scene: &FileScene) -> (Vec<f64>, Vec<Vec<f64>>) {
    let prepared = Prepared::new(scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap();
    let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
    (forward.values, adjoint.rows)
}

fn assert_near(what: &str, own: f64, expected: f64, size: f64) {
    assert!((own - expected).abs() <= 1e-11 * size, "{what}: {own:e} instead of {expected:e}");
}

#[test]
fn a_mesh_is_the_grid_on_the_same_points() {
    let (grid, free) = (sheet("", GRID, OF_GRID), sheet("", &mesh("e-1"), OF_MESH));
    let [own, expected] = [&free, &grid].map(values_and_gradients);
    for k in 0..own.0.len() {
        assert_near("value", own.0[k], expected.0[k], expected.0[k].abs());
        assert_near("derivative", own.1[k][0], expected.1[k][0], expected.1[k][0].abs());
    }
    assert!(own.0.iter().all(|value| *value != 0.0), "{:?}", own.0);
}

#[test]
fn derivatives_by_the_thicknesses_of_faces_and_of_nodes_add_up_to_that_by_one() {
    let text = mesh("e-1");
    let (values, one) = values_and_gradients(&sheet("", &text, OF_MESH));
    for (key, count) in [("per_face = \"sheet\"", 2), ("per_node = \"sheet\"", 15)] {
        let scene = sheet(key, &text, OF_MESH);
        let names: Vec<String> = scene.variables().iter().map(|own| own.name.clone()).collect();
        assert_eq!(names, (0..count).map(|number| format!("h[{number}]")).collect::<Vec<_>>());
        // one name stands for all where variables are chosen
        assert_eq!(scene.optimization_problem().unwrap().varying.unwrap(), names);
        let (own, many) = values_and_gradients(&scene);
        for k in 0..values.len() {
            assert_near(key, own[k], values[k], values[k].abs());
            let size = many[k].iter().fold(0.0, |most: f64, own| most.max(own.abs()));
            assert_near(key, many[k].iter().sum(), one[k][0], size.max(one[k][0].abs()));
        }
    }
    // of a group: the thickness of the other is its own
    let parts = format!("{text}parts = [{{ of = [\"left\"], thickness = 0.004 }}]\n");
    let (own, right) = values_and_gradients(&sheet("per_face = \"sheet.right\"", &parts, OF_MESH));
    let (_, both) = values_and_gradients(&sheet("per_face = \"sheet\"", &text, OF_MESH));
    for k in 0..values.len() {
        assert_near("group", own[k], values[k], values[k].abs());
        assert_near("group", right[k][0], both[k][1], both[k][1].abs());
    }
}

#[test]
fn scale_turn_and_place_of_a_mesh_are_those_of_its_points() {
    let moved = mesh("e2")
        + "scale = 0.001\norientation = { type = \"angle\", axis = [0, 0, 1], angle = 0 }\nposition = [0, 0, 0]\n";
    let [own, expected] = [moved, mesh("e-1")].map(|text| values_and_gradients(&sheet("", &text, OF_MESH)));
    for k in 0..own.0.len() {
        assert_near("value", own.0[k], expected.0[k], expected.0[k].abs());
    }
}

#[test]
fn groups_and_node_sets_by_place_are_those_by_numbers() {
    let text = mesh("e-1");
    let by_place = text
        .replace("left = [0], right = [1]", "left = \"x < 0.2\", right = \"0.2 < x\"")
        .replace("root = [0, 5, 10]", "root = \"x < 1e-9\"")
        .replace("rim = [4, 9, 14]", "rim = \"x > 0.4 - 1e-9\"")
        .replace("tip = [8]", "tip = \"norm([x - 0.3, y - 0.1, z]) < 1e-9 or x > 1 and y > 1\"");
    assert!(!by_place.contains("[4, 9, 14]") && !by_place.contains("[8]"));
    let per_face = "per_face = \"sheet.right\"";
    let parts = "parts = [{ of = [\"left\"], thickness = 0.004 }]\n";
    let [own, expected] = [by_place, text].map(|text| values_and_gradients(&sheet(per_face, &(text + parts), OF_MESH)));
    assert_eq!(own, expected);
}

#[test]
fn faces_whose_nodes_are_all_clamped_change_nothing() {
    let text = mesh("e-1");
    let clamped = text.replace("[\"root\"]", "[\"left\"]");
    let without = text
        .replace("faces = [[0, 2, 12, 10, 1, 7, 11, 5, 6], ", "faces = [")
        .replace("left = [0], right = [1]", "right = [0]")
        .replace("root = [0, 5, 10]", "root = [2, 7, 12]");
    let [own, expected] = [clamped, without].map(|text| values_and_gradients(&sheet("", &text, OF_MESH)));
    // the energy and the height of the tip; masses differ, and the mean over all points of stress
    for k in [1, 3] {
        assert_near("value", own.0[k], expected.0[k], expected.0[k].abs());
        assert_near("derivative", own.1[k][0], expected.1[k][0], expected.1[k][0].abs());
    }
}

#[test]
fn a_condition_wants_points_that_are_numbers() {
    let text = mesh("e-1").replace("root = [0, 5, 10]", "root = \"x < 1e-9\"");
    let formula = text.replace("[0e-1, 0e-1, 0]", "[\"0 * pi\", \"2 - 2\", 0]");
    assert!(formula != text);
    let [own, expected] = [formula, text.clone()].map(|text| values_and_gradients(&sheet("", &text, OF_MESH)));
    assert_eq!(own, expected);
    let moved = text.replace("[0e-1, 0e-1, 0]", "[\"h\", 0, 0]");
    let found = std::panic::catch_unwind(|| sheet("", &moved, OF_MESH)).unwrap_err();
    let why = found.downcast_ref::<String>().unwrap();
    assert!(why.contains("the place of node 0 depends on names"), "{why}");
}

/// An acceleration that is solved anew where the drive stops is the small difference of the forces of stiff shells; so are its derivative
/// parts, whose round-off is no reason to give up.
#[test]
fn a_drive_that_stops_shakes_a_metal_sheet_with_an_exact_gradient() {
    let changes = "settings = { end = 0.05, steps = 6 }
        material.polyamide = { young = 70e9, poisson = 0.33, density = 2700 }
        driver.swing.angle = { type = 'smooth_ramp', to = '10 * deg', duration = 0.025 }";
    let scene = built_in::changed("bracket", changes).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{why}"));
    let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap_or_else(|why| panic!("{why}"));
    let reference = analysis.complex_step(&prepared.x, &forward).unwrap_or_else(|why| panic!("{why}"));
    for (own, other) in adjoint.rows.iter().zip(&reference.rows) {
        let largest = costate::sensitivity::largest_difference(other, own);
        assert!(largest < 1e-10, "{largest:.1e}");
    }
}

/// A plate under a pressure on its right half, with groups turned round.
fn pressed(reverse: &str) -> FileScene {
    super::from_root();
    let text = format!(
        "version = 1\n[settings]\nend = 0.01\nsteps = 4\n[variable]\nh = {{ initial = 0.02, bounds = [0.01, 0.1], unit = \"m\" }}\n\
         [material.steel]\nyoung = 2e11\npoisson = 0.3\ndensity = 7800\n\
         [[mesh]]\nname = \"plate\"\ntype = \"gmsh\"\nfile = \"tests/gmsh/quads4.msh\"\nmaterial = \"steel\"\nthickness = \"h\"\n\
         clamped = [\"left edge\"]\nreverse = [{reverse}]\n[[pressure]]\nname = \"press\"\nshell = \"plate.right half\"\nsize = 1e4\n\
         [[functional]]\nname = \"corner\"\ntype = \"position\"\non = \"plate.corner[0]\"\ndirection = [0, 0, 1]\nover = \"terminal\"\n"
    );
    FileScene::parse("pressed.toml", &text).unwrap()
}

#[test]
fn what_hangs_together_with_a_group_is_turned_round_with_it() {
    let all = ["", "\"left half\", \"right half\"", "\"left half\"", "\"right half\""].map(|reverse| {
        let scene = pressed(reverse);
        let turned = scene.notes().iter().filter(|note| note.contains("turned round")).count();
        (values_and_gradients(&scene).0[0], turned)
    });
    let [(straight, none), (both, still_none), left, right] = all;
    assert!(straight.abs() > 1e-6 && none == 0 && still_none == 0, "{all:?}");
    assert_near("both groups turned round", both, -straight, straight.abs());
    for (own, turned) in [left, right] {
        assert!(own == both && turned == 1, "{all:?}");
    }
}
