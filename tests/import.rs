//! Robots from URDF: the same motion as by hand, and what is left out is said.

use costate::scenes::{FileScene, Prepared, Settings};
use std::path::PathBuf;
use std::process::{Command, Output};

/// An empty folder of its own for one test, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("costate-import-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }
    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_costate")).args(arguments).current_dir(&self.0).output().unwrap()
    }
    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn said(output: &Output) -> String {
    [&output.stdout[..], &output.stderr[..]].map(|bytes| String::from_utf8_lossy(bytes).into_owned()).concat()
}

/// An arm on a hinge about y, inclined by 0.5 rad, whose frame of inertia is turned by a quarter about y; a hand on a slide, a finger whose
/// hinge follows that of the arm.
const ROBOT: &str = r#"<?xml version="1.0"?>
<robot name="arm of two">
  <link name="base"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  <link name="arm">
    <inertial><origin xyz="0 0 -0.5" rpy="0 1.5707963267948966 0"/><mass value="2"/>
      <inertia ixx="0.02" iyy="0.18" izz="0.17" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 -0.5"/><geometry><cylinder radius="0.03" length="1"/></geometry></visual>
    <visual><geometry><mesh filename="package://parts/meshes/arm.dae"/></geometry></visual>
  </link>
  <link name="hand"><inertial><mass value="0.4"/><inertia ixx="0.001" iyy="0.001" izz="0.001"/></inertial>
    <visual><geometry><sphere radius="0.05"/></geometry></visual></link>
  <link name="finger"><inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4"/></inertial>
    <visual><geometry><mesh filename="package://parts/wedge.stl" scale="0.01 0.01 0.01"/></geometry></visual></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 0.5 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="3" velocity="2"/><dynamics damping="0.3"/></joint>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="hand"/><origin xyz="0 0 -1"/><axis xyz="0 0 1"/>
    <dynamics damping="5" friction="0.1"/></joint>
  <joint name="knuckle" type="continuous"><parent link="hand"/><child link="finger"/><axis xyz="0 1 0"/>
    <mimic joint="shoulder" multiplier="-2"/></joint>
</robot>
"#;

#[test]
fn a_robot_swings_as_its_links_say() {
    let folder = Folder::new("swing");
    folder.write("arm.urdf", ROBOT);
    std::fs::copy(
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/scene_files/coverage/wedge.stl"),
        folder.0.join("wedge.stl"),
    )
    .unwrap();
    let output = folder.run(&["import", "arm.urdf"]);
    let told = said(&output);
    assert!(output.status.success(), "{told}");
    for words in [
        "4 links, 3 joints",
        "arm.dae\" is no STL",
        "limits are left out, nothing stops the joints: \"shoulder\"",
        "dry friction is left out of joints: \"slide\"",
        "arm.toml: in order",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    assert!(!told.contains("wedge.stl"), "{told}");
    let again = folder.run(&["import", "arm.urdf"]);
    assert!(again.status.code() == Some(2) && said(&again).contains("exists already"), "{}", said(&again));
    let scene = FileScene::read(&folder.0.join("arm.toml")).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap();
    let run = prepared.run().unwrap();
    // the finger turns twice as far to the other side, all the time, and the hand slides down against 5 N s/m
    let [angle, finger] = ["shoulder angle", "knuckle angle"].map(|name| run.node(name).unwrap());
    for (own, other) in angle.coordinates.iter().zip(&finger.coordinates) {
        assert!((other[0] + 2.0 * own[0]).abs() < 1e-12, "{} {}", own[0], other[0]);
    }
    assert!(angle.coordinates.last().unwrap()[0].abs() > 0.1);
}

/// I alpha = m g d sin(0.5): about the hinge I = 0.18 + 2 x 0.5^2 kg m2, since the axis of the hinge is one of the frame of inertia.
#[test]
fn a_link_alone_begins_to_fall_by_its_moment_of_inertia() {
    let folder = Folder::new("fall");
    let body = ROBOT.split("<link name=\"hand\">").next().unwrap();
    let shoulder = ROBOT.split("<joint name=\"slide\"").next().unwrap().split("</link>").last().unwrap();
    folder.write("arm.urdf", &format!("{body}{shoulder}</robot>").replace("damping=\"0.3\"", "damping=\"0\""));
    let output = folder.run(&["import", "arm.urdf", "--out", "one.toml"]);
    assert!(output.status.success(), "{}", said(&output));
    let mut text = std::fs::read_to_string(folder.0.join("one.toml")).unwrap();
    // nothing reads the angle
    assert!(!text.contains("joint_angle"), "{text}");
    // the frame of inertia turned into that of the link: x and z change places
    let inertia = text.lines().find(|line| line.starts_with("inertia")).unwrap();
    assert!(inertia.starts_with("inertia = [0.17") && inertia.contains("0.18") && inertia.contains("0.02"), "{inertia}");
    text += "[[functional]]\nname = \"rate\"\ntype = \"joint_rate\"\nbetween = [\"base\", \"arm\"]\naxis = [0, 1, 0]\nover = \"terminal\"\n";
    let scene = FileScene::parse("one.toml", &text).unwrap();
    let h = 1e-4;
    let prepared = Prepared::with(&scene, &[], Prepared::default_method(), Settings::new(h, 1)).unwrap();
    let alpha = prepared.analysis().forward(&[]).unwrap().values[0] / h;
    // it hangs towards -x where y is its axis: gravity turns it back
    let expected = 2.0 * 9.81 * 0.5 * 0.5_f64.sin() / (0.18 + 0.5);
    assert!((alpha.abs() - expected).abs() < 1e-7 * expected, "{alpha} {expected}");
    assert!(alpha < 0.0, "it falls back to hanging, {alpha}");
}

#[test]
fn a_free_robot_falls_and_what_is_no_robot_is_told() {
    let folder = Folder::new("free");
    folder.write("ball.urdf", "<robot name=\"ball\"><link name=\"ball\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link></robot>");
    assert!(folder.run(&["import", "ball.urdf", "--free"]).status.success());
    let scene = FileScene::read(&folder.0.join("ball.toml")).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let ball = prepared.run().unwrap().node("ball").unwrap();
    assert!((ball.coordinates.last().unwrap()[2] + 0.5 * 9.81).abs() < 1e-9);
    folder.write("scene.toml.urdf", "version = 1\n");
    folder.write("model.urdf", "<sdf version=\"1.6\"/>");
    for (file, words) in [("none.urdf", "cannot be read"), ("scene.toml.urdf", "no XML"), ("model.urdf", "<sdf>")] {
        let output = folder.run(&["import", file]);
        assert!(output.status.code() == Some(2) && said(&output).contains(words), "{file}: {}", said(&output));
    }
    // nothing half-written
    assert_eq!(std::fs::read_dir(&folder.0).unwrap().count(), 4);
}

/// A link of the tests below.
fn link(name: &str, inertial: &str) -> String {
    format!("<link name=\"{name}\">{inertial}</link>\n")
}

/// Its mass centre on the axis x, its mass and the diagonal of its tensor.
fn inertial(x: f64, mass: f64, [xx, yy, zz]: [f64; 3]) -> String {
    format!(
        "<inertial><origin xyz=\"{x} 0 0\"/><mass value=\"{mass}\"/><inertia ixx=\"{xx}\" iyy=\"{yy}\" izz=\"{zz}\"/></inertial>"
    )
}

/// A joint about or along y with its parent, at a place on the axis x.
fn joint(kind: &str, [parent, child]: [&str; 2], x: f64, more: &str) -> String {
    format!(
        "<joint name=\"to {child}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin xyz=\"{x} 0 0\"/>\
         <axis xyz=\"0 2 0\"/>{more}</joint>\n"
    )
}

/// What import says of a robot, and the scene that it writes.
fn imported(folder: &Folder, parts: &[String], options: &[&str]) -> (String, String) {
    folder.write("r.urdf", &format!("<robot name=\"r\">{}</robot>", parts.concat()));
    let _ = std::fs::remove_file(folder.0.join("r.toml"));
    let output = folder.run(&[&["import", "r.urdf"], options].concat());
    assert!(output.status.success(), "{}", said(&output));
    (said(&output), std::fs::read_to_string(folder.0.join("r.toml")).unwrap())
}

/// The angular acceleration about y from rest of the child of a hinge about y.
fn acceleration(text: &str, [parent, child]: [&str; 2]) -> f64 {
    let rate = format!(
        "{text}[[functional]]\nname = \"rate\"\ntype = \"joint_rate\"\nbetween = [\"{parent}\", \"{child}\"]\naxis = [0, 1, 0]\nover = \"terminal\"\n"
    );
    let scene = FileScene::parse("text", &rate).unwrap_or_else(|why| panic!("{why}"));
    let h = 1e-4;
    let prepared = Prepared::with(&scene, &[], Prepared::default_method(), Settings::new(h, 1)).unwrap();
    prepared.analysis().forward(&[]).unwrap().values[0] / h
}

/// Three links in a row, welded, swing about the hinge of the first as one body: I alpha = g sum of m x, I = sum of J + m x^2.
#[test]
fn links_welded_together_are_one_body_and_their_frames_are_places() {
    let folder = Folder::new("welded");
    let tensor = [0.01, 0.02, 0.02];
    let parts = [
        link("base", ""),
        link("ground", &inertial(0.1, 1.0, tensor)),
        link("link.2", &inertial(0.2, 2.0, tensor)),
        link("3", &inertial(0.0, 3.0, tensor)),
        joint("revolute", ["base", "ground"], 0.0, ""),
        joint("fixed", ["ground", "link.2"], 0.5, ""),
        joint("fixed", ["link.2", "3"], 0.25, ""),
    ];
    let (told, text) = imported(&folder, &parts, &[]);
    assert!(told.contains("its body is: \"ground_link\"") && told.contains("3 nodes"), "{told}");
    for line in ["link_2 = [0.5, 0, 0] # \"link.2\", on \"ground_link\"", "_3 = [0.75, 0, 0] # \"3\", on \"ground_link\""] {
        assert!(text.contains(line), "{text}");
    }
    let (masses, places) = ([1.0, 2.0, 3.0], [0.1, 0.7, 0.75]);
    let sum = |power: i32| masses.iter().zip(places).map(|(mass, x)| mass * f64::powi(x, power)).sum::<f64>();
    let expected = 9.81 * sum(1) / (sum(2) + 3.0 * 0.02);
    let alpha = acceleration(&text, ["base", "ground_link"]);
    assert!((alpha - expected).abs() < 1e-7 * expected, "{alpha} for {expected}");
    // the place of a frame is one that functionals take
    let place = "[[functional]]\nname = \"x\"\ntype = \"position\"\non = \"ground_link\"\npoint = \"_3\"\ndirection = [1, 0, 0]\nover = \"initial\"\n";
    let scene = FileScene::parse("text", &(text + place)).unwrap();
    let values = Prepared::new(&scene).unwrap().analysis().forward(&[]).unwrap().values;
    assert!((values[0] - 0.75).abs() < 1e-15, "{values:?}");
}

/// What no body has becomes the nearest that one has, and is said; round-off beside m c^2 and tensors without mass stay.
#[test]
fn placeholders_become_admissible_and_inertia_without_mass_stays() {
    let folder = Folder::new("placeholders");
    for (mass, x, tensor, moment, words) in [
        (2.0, 0.3, [1e-3, 1e-2, 1e-3], 1e-2 - 8e-3 / 3.0, "[0.001, 0.01, 0.001, 0, 0, 0], of the body: \"arm\""),
        (2.0, 0.3, [0.5, -0.1, 0.2], -0.1 + 0.4 / 3.0, "no body can have the inertia of \"arm\""),
        (2.0, 0.3, [1e-20, -1e-20, 0.0], 0.0, ""),
        (0.0, 0.0, [0.01, 0.01, 0.01], 0.01, ""),
    ] {
        let arm = link("arm", &inertial(x, mass, tensor));
        let (told, text) = imported(&folder, &[link("base", ""), arm, joint("continuous", ["base", "arm"], 0.0, "")], &[]);
        assert_eq!(told.contains("no body can have"), !words.is_empty(), "{told}");
        assert!(told.contains(words), "{told}");
        let torque = text + "[[torque]]\nname = \"motor\"\non = \"arm\"\naxis = [0, 1, 0]\nsize = 0.7\n";
        let (alpha, expected) = (acceleration(&torque, ["base", "arm"]), (0.7 + 9.81 * mass * x) / (mass * x * x + moment));
        assert!((alpha - expected).abs() < 1e-6 * expected, "{tensor:?}: {alpha} for {expected}");
    }
    let negative = [link("base", ""), link("arm", &inertial(0.3, -1.0, [1.0; 3])), joint("fixed", ["base", "arm"], 0.0, "")];
    let (told, text) = imported(&folder, &negative, &[]);
    assert!(
        told.contains("a negative mass is left out, with its inertia, of links: \"arm\"") && !text.contains("mass ="),
        "{told}"
    );
}

/// A slide that follows a hinge and one that follows the slide, with offsets: they start where the others take them, and follow.
#[test]
fn joints_that_slide_follow_and_start_at_their_offset() {
    let folder = Folder::new("follow");
    let body = |name: &str| link(name, &inertial(0.2, 1.0, [0.1; 3]));
    let follow = |joint: &str, multiplier: f64, offset: f64| {
        format!("<mimic joint=\"to {joint}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/><dynamics damping=\"0.2\"/>")
    };
    let parts = [
        ["base", "arm", "slide", "other", "free", "ring"].map(body).concat(),
        joint("revolute", ["base", "arm"], 0.0, "<dynamics damping=\"0.4\" friction=\"1\"/>"),
        joint("prismatic", ["arm", "slide"], 0.1, &follow("arm", 0.5, 0.03)),
        joint("prismatic", ["base", "other"], 0.2, &follow("slide", -2.0, 0.01)),
        joint("revolute", ["base", "free"], 0.3, &follow("none", 1.0, 0.0)),
        joint("revolute", ["base", "ring"], 0.4, &follow("ring", 1.0, 0.0)),
    ];
    let (told, text) = imported(&folder, &parts, &[]);
    for words in ["should follow \"to none\", which is not there: \"to free\"", "which follows it in turn: \"to ring\""] {
        assert!(told.contains(words), "{told}");
    }
    // of the joints that turn one is followed
    assert_eq!(text.matches("[[joint_angle]]").count(), 1, "{text}");
    let scene = FileScene::parse("text", &text).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let run = prepared.run().unwrap();
    let [angle, arm, slide, other] = ["to arm angle", "arm", "slide", "other"].map(|name| run.node(name).unwrap());
    assert!(angle.coordinates.last().unwrap()[0].abs() > 0.5);
    for (k, own) in angle.coordinates.iter().enumerate() {
        let along = slide.coordinates[k][1] - arm.coordinates[k][1];
        assert!((along - 0.5 * own[0] - 0.03).abs() < 1e-11, "{along} at {own:?}");
        assert!((other.coordinates[k][1] + 2.0 * along - 0.01).abs() < 1e-11, "{} at {along}", other.coordinates[k][1]);
    }
}

/// A finger without inertia and one that follows it stay where they are; what no joint holds is written, and refused by name.
#[test]
fn joints_that_move_nothing_are_held_and_what_cannot_start_is_refused() {
    let folder = Folder::new("nothing");
    let parts = [
        link("base", ""),
        link("arm", &inertial(0.2, 1.0, [0.1; 3])),
        ["finger", "other"].map(|name| link(name, "")).concat(),
        joint("revolute", ["base", "arm"], 0.0, ""),
        joint("revolute", ["arm", "finger"], 0.3, ""),
        joint("prismatic", ["arm", "other"], 0.3, "<mimic joint=\"to finger\" multiplier=\"0.1\"/>"),
    ];
    let (told, text) = imported(&folder, &parts, &[]);
    assert!(told.contains("so that no equation says how they move: \"to finger\"\n"), "{told}");
    let alpha = acceleration(&text, ["arm", "finger"]);
    assert!(alpha.abs() < 1e-9 && acceleration(&text, ["base", "arm"]) > 1.0, "{alpha}");
    let loose = joint("floating", ["base", "arm"], 0.0, "");
    folder.write("loose.urdf", &format!("<robot name=\"r\">{}{}{loose}</robot>", link("base", ""), link("arm", "")));
    let output = folder.run(&["import", "loose.urdf"]);
    assert_eq!(output.status.code(), Some(2));
    let words = ["was written, but it cannot start as it is", "\"arm\""];
    assert!(words.iter().all(|words| said(&output).contains(words)), "{}", said(&output));
    assert!(folder.0.join("loose.toml").exists());
}

#[test]
fn histories_of_chosen_parts_are_columns_of_all() {
    let folder = Folder::new("chosen");
    let text = include_str!("scene_files/coverage/solids.toml").replace("tests/scene_files/coverage/", "");
    folder.write("solids.toml", &text);
    folder.write("all.toml", &text.replace("histories = [\"hammer\", \"hinge\", \"reach\", \"energy\"]", ""));
    std::fs::copy(
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/scene_files/coverage/wedge.stl"),
        folder.0.join("wedge.stl"),
    )
    .unwrap();
    for scene in ["solids", "all"] {
        let output = folder.run(&["run", &format!("{scene}.toml"), "--out", scene, "--no-report"]);
        assert!(output.status.success(), "{}", said(&output));
    }
    let read = |scene: &str| costate_cli::io::read_csv(&folder.0.join(scene).join("histories.csv")).unwrap();
    let ((names, rows), (all_names, all_rows)) = (read("solids"), read("all"));
    assert!(names.len() < all_names.len() && names.iter().all(|name| !name.starts_with("flywheel")), "{names:?}");
    for wanted in [
        "t [s]",
        "hammer.x [m]",
        "hammer.omega_y [rad/s]",
        "energy [J]",
        "hinge.mu1",
        "hinge.force_z [N]",
        "measured for reach [m]",
    ] {
        assert!(names.iter().any(|name| name == wanted), "{wanted}: {names:?}");
    }
    for (place, name) in names.iter().enumerate() {
        let other = all_names.iter().position(|own| own == name).unwrap();
        assert!(rows.iter().zip(&all_rows).all(|(own, all)| own[place] == all[other]), "{name}");
    }
    folder.write("wrong.toml", &text.replace("\"hinge\", \"reach\"", "\"hing\""));
    let output = folder.run(&["check", "wrong.toml"]);
    assert!(
        output.status.code() == Some(2) && said(&output).contains("part \"hing\" is not known; did you mean \"hinge\""),
        "{}",
        said(&output)
    );
}
