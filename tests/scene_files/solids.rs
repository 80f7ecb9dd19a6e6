//! Bodies of solids: the same motion as with mass and inertia by hand, gradients by every size, and what is wrong with them.

use costate::scenes::{FileScene, Prepared};

const BAR: &str = r#"
version = 1
gravity = [0, 0, -9.81]
[settings]
end = 0.4
steps = 40
[variable]
length = { initial = 0.8, bounds = [0.1, 2.0], unit = "m" }
width = { initial = 0.05, bounds = [0.01, 0.2], unit = "m" }
[[body]]
name = "bar"
position = ["0.5 * length", 0, 0]
BODY
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "bar"]
point = [0, 0, 0]
axis = [0, 1, 0]
[[functional]]
name = "height"
type = "position"
on = "bar"
direction = [0, 0, 1]
over = "terminal"
[[functional]]
name = "load"
type = "joint_load"
joint = "hinge"
on = "bar"
load = "force"
direction = [0, 0, 1]
over = "integral"
"#;

const SOLIDS: &str = r#"solids = [{ type = "box", from = [0, 0, 0], to = ["length", 0, 0], second_axis = [0, 1, 0], width = "width", height = 0.02, density = 2700 }]"#;
const BY_HAND: &str = r#"mass = "2700 * length * width * 0.02"
inertia = ["54 * length * width * (width^2 + 0.02^2) / 12", "54 * length * width * (length^2 + 0.02^2) / 12", "54 * length * width * (length^2 + width^2) / 12"]"#;

fn scene(body: &str) -> Result<FileScene, String> {
    FileScene::parse("solids.toml", &BAR.replace("BODY", body))
}

#[test]
fn a_bar_of_its_sizes_moves_as_one_of_its_mass() {
    let results = [SOLIDS, BY_HAND].map(|body| {
        let scene = scene(body).unwrap();
        let prepared = Prepared::new(&scene).unwrap();
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap();
        let gradient = analysis.adjoint(&prepared.x, &forward).unwrap();
        let check = analysis.complex_step(&prepared.x, &forward).unwrap();
        for (own, other) in gradient.rows.iter().flatten().zip(check.rows.iter().flatten()) {
            assert!((own - other).abs() < 1e-12 * (1.0 + other.abs()), "{own} {other}");
        }
        [forward.values, gradient.rows.concat()].concat()
    });
    for (own, other) in results[0].iter().zip(&results[1]) {
        assert!((own - other).abs() < 1e-12 * (1.0 + other.abs()), "{own} {other}");
    }
    // a heavier bar falls as fast and pulls harder
    assert!(results[0][3].abs() < 1e-3 * results[0][2].abs() && results[0][5].abs() > 1.0, "{results:?}");
}

#[test]
fn what_cannot_be_a_solid_is_told() {
    super::from_root();
    let cylinder = r#"solids = [{ type = "cylinder", from = [0, 0, 0], to = ["length", 0, 0], diameter = 0.02, "#;
    for (body, words) in [
        (format!("{SOLIDS}\nmass = 2"), "has its mass of its solids"),
        (format!("{SOLIDS}\ninertia = [1, 1, 1]"), "has its mass of its solids"),
        (SOLIDS.replace("to = [\"length\", 0, 0]", "to = [0, 0, 0]"), "has both of its ends in one place"),
        (SOLIDS.replace("second_axis = [0, 1, 0]", "second_axis = [1, 0, 0]"), "second axis along its line"),
        (format!("{cylinder} wall = 0.02, density = 1 }}]"), "a wall is at most as thick as that"),
        (SOLIDS.replace("width = \"width\"", "width = 0"), "greater than 0"),
        ("solids = [{ type = \"surface\", file = \"none.stl\" }]".into(), "\"none.stl\": cannot be read"),
        ("solids = [{ type = \"surface\", file = \"Cargo.toml\" }]".into(), "\"Cargo.toml\": "),
        (
            "solids = [{ type = \"surface\", file = \"tests/scene_files/coverage/open.stl\", density = 1 }]".into(),
            "the surface is not closed: 3 of its 6 edges",
        ),
        ("solids = [{ type = \"surface\", file = 3 }]".into(), "must be the name of a file in STL"),
    ] {
        let why = scene(&body).and_then(|scene| Prepared::new(&scene).map(drop).map_err(|why| why.to_string())).unwrap_err();
        assert!(why.contains(words), "{body}\n{why}");
    }
}
