//! Wrong files of many kinds: each is refused with code 2 and a message that says where, what is there, and what is allowed.

use super::{parsed, refused};
use costate::scenes::{AnyScene, FileScene, Prepared};
use std::process::Command;

/// A sound file, in which each case changes something.
const SOUND: &str = r#"version = 1
gravity = [0, -9.81, 0]

[variable.length]
initial = 1.0
bounds = [0.1, 10]
unit = "m"

[define]
half = "0.5 * length"
pin = [0, 0, 0]

[material.steel]
young = 2e11
poisson = 0.3
density = 7800

[section.round]
type = "circle"
material = "steel"
diameter = 0.05

[settings]
end = 1.0
steps = 10

[optimization]
minimize = "height"

[[body]]
name = "crank"
position = ["half", 0, 0]
mass = 1.0
inertia = [0.01, 0.1, 0.1]

[[beam]]
name = "rod"
from = ["length", 0, 0]
to = ["2 * length", 0, 0]
elements = 1
section = "round"
second_axis = [0, 1, 0]

[[joint]]
name = "bearing"
type = "revolute"
between = ["ground", "crank"]
point = "pin"
axis = [0, 0, 1]

[[joint]]
name = "weld"
type = "fixed"
between = ["crank", "rod.start"]

[[functional]]
name = "height"
type = "position"
on = "rod.end"
direction = [0, 1, 0]
over = "terminal"
"#;

/// What is replaced by what, the line and column that the message names, and what it says.
const CASES: &[(&str, &str, &str, &[&str])] = &[
    // the text itself
    ("version = 1", "version = = 1", "1:11", &["no TOML"]),
    ("\"crank\"\nposition", "\"crank\nposition", "31:", &["no TOML"]),
    ("unit = \"m\"", "unit = \"m\"\nunit = \"mm\"", "8:", &["no TOML", "duplicate key"]),
    // nodes
    (
        "between = [\"crank\", \"rod.start\"]",
        "between = [\"crank\", \"crank\"]",
        "54:11",
        &["two of between are the same node"],
    ),
    // versions
    ("version = 1\n", "", "1:1", &["needs the key version", "1"]),
    ("version = 1", "version = 2", "1:11", &["version of the file must be 1", "the number 2"]),
    // keys
    ("mass = 1.0", "mas = 1.0", "33:1", &["[[body]] \"crank\"", "key \"mas\"", "did you mean \"mass\"?", "inertia"]),
    ("[settings]", "[setings]", "23:2", &["key \"setings\"", "did you mean \"settings\"?"]),
    ("gravity = [", "gravty = [", "2:1", &["key \"gravty\"", "did you mean \"gravity\"?"]),
    (
        "type = \"circle\"\n",
        "type = \"circle\"\nwidth = 0.1\n",
        "20:1",
        &["[section.round] of type circle", "key \"width\"", "diameter"],
    ),
    ("inertia = [0.01, 0.1, 0.1]", "", "30:1", &["mass needs the key inertia", "kg m2"]),
    ("from = [\"length\", 0, 0]\n", "", "36:1", &["[[beam]] \"rod\" needs the key from", "where it starts"]),
    ("type = \"revolute\"\n", "", "44:1", &["[[joint]] \"bearing\" needs the key type", "spherical, revolute"]),
    // types of values
    ("elements = 1", "elements = 1.5", "40:12", &["elements of [[beam]] \"rod\"", "whole number from 1 to", "1.5"]),
    ("elements = 1", "elements = 0", "40:12", &["whole number from 1 to", "the number 0"]),
    ("mass = 1.0", "mass = true", "33:8", &["mass of [[body]] \"crank\"", "number or a formula", "true"]),
    ("position = [\"half\", 0, 0]", "position = [\"half\", 0]", "32:12", &["vector [x, y, z]", "a list of 2"]),
    ("position = [\"half\", 0, 0]", "position = \"half\"", "32:12", &["must be a vector", "\"half\" gives a number"]),
    ("mass = 1.0", "mass = \"pin\"", "33:8", &["must be a number", "\"pin\" is a vector"]),
    ("inertia = [0.01, 0.1, 0.1]", "inertia = [0.01, 0.1]", "34:11", &["3 or 6 numbers", "a list of 2"]),
    ("name = \"crank\"", "name = 7", "31:8", &["name of [[body]]", "a text", "the number 7"]),
    ("[settings]\n", "[[settings]]\n", "23:1", &["[settings] must be a table", "a list of 1"]),
    ("[[beam]]", "[beam]", "36:2", &["beam must be written as [[beam]]"]),
    ("[material.steel]", "[[material]]", "13:3", &["material must be written as [material.NAME]"]),
    ("over = \"terminal\"", "over = 3", "61:8", &["over of [[functional]] \"height\"", "initial, terminal, integral"]),
    ("over = \"terminal\"", "over = \"terminus\"", "61:8", &["initial, terminal, integral"]),
    (
        "over = \"terminal\"",
        "over = \"maximum\"",
        "61:8",
        &["aggregate = \"upper_maximum\"", "smooth_maximum, upper_maximum, exp"],
    ),
    // words of other programs
    ("[[body]]", "[[collision]]\n[[body]]", "30:3", &["key \"collision\"", "[[shape]]", "[[contact]]"]),
    ("[[body]]", "[[trigger]]\n[[body]]", "30:3", &["is [[event]]"]),
    ("mass = 1.0", "mass = 1.0\nsliding_friction = 0.3", "34:1", &["dry friction is [[friction]]", "[[clutch]]"]),
    ("type = \"revolute\"", "type = \"hinge_stops\"", "46:8", &["type \"hinge_stops\"", "a rigid stop is [[stop]]"]),
    // names that no table can show
    ("name = \"crank\"", "name = \"crank\\n\"", "31:8", &["control character"]),
    ("type = \"circle\"", "type = \"cicle\"", "19:8", &["[section.round]", "type \"cicle\"", "did you mean \"circle\"?"]),
    ("name = \"rod\"", "name = \"rod\"\nclamped = \"strat\"", "38:11", &["did you mean \"start\"?"]),
    // ranges
    ("mass = 1.0", "mass = -1.0", "33:8", &["mass of [[body]] \"crank\" is -1", "at least 0"]),
    ("mass = 1.0", "mass = nan", "33:8", &["mass of [[body]] \"crank\" is NaN", "finite"]),
    ("end = 1.0", "end = inf", "24:7", &["end of [settings] is inf", "finite"]),
    ("mass = 1.0", "mass = \"1 / 0\"", "33:8", &["is inf", "at least 0"]),
    ("mass = 1.0", "mass = \"half - length\"", "33:8", &["at this design the value is -0.5", "at least 0"]),
    ("half = \"0.5 * length\"", "half = \"log(-length)\"", "10:8", &["half of [define] is NaN", "finite"]),
    ("bounds = [0.1, 10]", "bounds = [10, 0.1]", "6:10", &["10 and 0.1", "smaller one first"]),
    ("initial = 1.0", "initial = 20", "5:11", &["initial of \"length\" is 20", "between its bounds 0.1 and 10"]),
    ("end = 1.0", "end = \"length\"", "24:7", &["depends on a design variable", "stays"]),
    ("inertia = [0.01, 0.1, 0.1]", "inertia = [0.01, 0.1, 1.0]", "30:", &["inertia of \"crank\"", "exceeds the sum"]),
    ("axis = [0, 0, 1]", "axis = [0, 0, 0]", "44:", &["\"bearing\"", "any length but zero"]),
    // names
    (
        "\"ground\", \"crank\"",
        "\"ground\", \"crnak\"",
        "47:22",
        &["node \"crnak\"", "did you mean \"crank\"?", "rod", "ground"],
    ),
    ("\"rod.start\"", "\"rod\"", "54:21", &["no node of the beam \"rod\"", "rod[i], rod.start, rod.end"]),
    ("\"rod.start\"", "\"rod.middle\"", "54:21", &["no node of the beam \"rod\"", "rod.start"]),
    ("\"rod.start\"", "\"rod[7]\"", "54:21", &["no node 7", "there are 3"]),
    ("\"rod.start\"", "\"bearing\"", "54:21", &["\"bearing\" is a joint", "no node"]),
    ("material = \"steel\"", "material = \"steal\"", "20:12", &["material \"steal\"", "did you mean \"steel\"?"]),
    ("section = \"round\"", "section = \"steel\"", "41:11", &["\"steel\" is a material", "section is wanted", "round"]),
    ("name = \"weld\"", "name = \"bearing\"", "52:8", &["name \"bearing\" is taken", "joint"]),
    ("name = \"crank\"", "name = \"ground\"", "31:8", &["\"ground\" belongs to the body that never moves"]),
    ("minimize = \"height\"", "minimize = \"hight\"", "28:12", &["functional \"hight\"", "did you mean \"height\"?"]),
    (
        "minimize = \"height\"",
        "minimize = \"height\"\nvarying = [\"lenght\"]",
        "29:11",
        &["design variable \"lenght\"", "did you mean \"length\"?"],
    ),
    ("minimize = \"height\"\n", "", "27:", &["one of the keys minimize, maximize and weights"]),
    (
        "minimize = \"height\"",
        "minimize = \"height\"\nconstraint = [{ functional = \"height\" }]",
        "29:",
        &["at_most, at_least and equal"],
    ),
    ("[variable.length]", "[variable.\"the length\"]", "4:11", &["\"the length\" cannot be used in formulas"]),
    ("[variable.length]", "[variable.sin]", "4:11", &["\"sin\" means a function"]),
    ("half = \"0.5", "length = \"0.5", "10:1", &["name \"length\" is taken by a design variable"]),
    // formulas
    ("\"0.5 * length\"", "\"0.5 * lenght\"", "10:15", &["half of [define]", "name \"lenght\"", "did you mean \"length\"?"]),
    ("\"0.5 * length\"", "\"0.5 * (length\"", "10:22", &["')' is missing"]),
    ("\"0.5 * length\"", "\"0.5 length\"", "10:13", &["'l' does not continue the formula"]),
    ("\"0.5 * length\"", "\"sinus(length)\"", "10:9", &["function \"sinus\""]),
    ("\"0.5 * length\"", "\"half * length\"", "10:8", &["definition of \"half\" leads back to itself", "half -> half"]),
    ("half = \"0.5 * length\"", "half = \"other\"\nother = \"2 * half\"", "10:8", &["half -> other -> half"]),
    ("\"2 * length\"", "\"length + pin\"", "39:15", &["cannot join a number and a vector"]),
    // settings
    ("steps = 10\n", "", "23:1", &["needs the key steps", "tolerance"]),
    ("end = 1.0\n", "", "23:1", &["needs the key end"]),
    ("steps = 10", "steps = 10\nmethod = \"esdirk6\"", "26:10", &["method", "\"esdirk6\"", "did you mean \"esdirk"]),
    ("steps = 10", "steps = 10\nmethod = \"variational:2\"", "26:10", &["variational:2", "from 0 to 1"]),
    ("steps = 10", "steps = 10\ntolerance = 1e-6", "26:13", &["steps and tolerance"]),
    ("steps = 10", "steps = 10\nlongest_step = 0.1", "26:16", &["means nothing without the key tolerance"]),
    ("steps = 10\n", "steps = 10\n[output]\nfilm = true\n", "27:1", &["film", "report.html, plays"]),
    ("steps = 10\n", "steps = 10\n[output]\nstep = 1e-300\n", "27:8", &["step of [output] is", "fit into 1 s"]),
    ("steps = 10", "steps = 10\nconstraint_level = \"positon\"", "26:20", &["did you mean \"position\"?"]),
    ("steps = 10", "steps = 10\nconstraint_level = \"velocity\"", "26:20", &["not known any more", "\"acceleration\" has"]),
    ("steps = 10", "steps = 10\nsolver = \"sparse\"", "26:10", &["automatic, dense, multifrontal"]),
    ("steps = 10", "steps = 10\nnewton = 3", "26:10", &["newton of [settings]", "round-off, residual"]),
    // soft joints and sections that change
    ("axis = [0, 0, 1]", "axis = [0, 0, 1]\nstiffness = [1, 2]", "44:1", &["5 equations", "2 stiffnesses and 2 dampings"]),
    ("axis = [0, 0, 1]", "axis = [0, 0, 1]\ndamping = [1]", "50:11", &["only a soft joint has damping"]),
    ("mass = 1.0", "mass = \"share\"", "33:9", &["share", "only numbers of a [section]"]),
    (
        "diameter = 0.05",
        "diameter = \"0.05 - 0.1 * share\"",
        "21:12",
        &["diameter: at this design the value is -0.0", "greater than 0"],
    ),
    // loops
    ("bounds = [0.1, 10]\n", "bounds = [0.1, 10]\nfor = { i = [1, 2] }\n", "4:11", &["name \"length\" is taken"]),
    ("name = \"weld\"", "name = \"weld\"\nfor = { i = 3 }", "53:13", &["for: i is the number 3"]),
    ("name = \"weld\"", "name = \"weld {j}\"\nfor = { i = [1, 2] }", "52:8", &["\"weld {j}\"", "name \"j\"", "known: i"]),
    ("name = \"weld\"", "name = \"weld\"\nfor = { i = [1, 2] }", "52:8", &["name \"weld\" is taken"]),
    (
        "[[functional]]",
        "[[point]]\nname = \"p {i}\"\nfor = { i = [1, 2] }\nposition = [\"i\", 0, 0]\nmass = 1.0\n\n[[functional]]",
        "59:14",
        &["name \"i\" is not known", "by i is written {i}"],
    ),
    (
        "name = \"weld\"",
        "name = \"weld {i}\"\nfor = { i = { from = 3, to = 1 } }",
        "53:13",
        &["from 3 to 1", "makes nothing"],
    ),
    ("name = \"weld\"", "name = \"weld {i}\"\nfor = { i = [] }", "53:13", &["i is a list of 0"]),
    ("name = \"weld\"", "name = \"weld {i}\"\nfor = { i = [1, \"a\"] }", "53:13", &["i is a list of 2"]),
    (
        "name = \"weld\"",
        "name = \"weld {i}\"\nfor = { i = { from = 1 } }",
        "53:13",
        &["i is a table", "{ from = 1, to = 5 }"],
    ),
    ("name = \"weld\"", "name = \"weld {i}\"\nfor = { i = { from = 1, to = 2, by = 1 } }", "53:13", &["i is a table"]),
    ("name = \"weld\"", "name = \"weld {pi}\"\nfor = { pi = [1, 2] }", "53:9", &["\"pi\" means a constant"]),
    // names that mean something in formulas
    ("[variable.length]", "[variable.t]", "4:11", &["\"t\" means the time"]),
    ("[variable.length]", "[variable.share]", "4:11", &["\"share\" means the place along a beam"]),
    ("half = \"0.5", "t = 1\nhalf = \"0.5", "10:1", &["\"t\" means the time"]),
    ("half = \"0.5", "share = 1\nhalf = \"0.5", "10:1", &["\"share\" means the place"]),
    ("half = \"0.5", "norm = 1\nhalf = \"0.5", "10:1", &["\"norm\" means a function"]),
    ("half = \"0.5", "deg = 1\nhalf = \"0.5", "10:1", &["\"deg\" means a constant"]),
    // keys without effect
    (
        "elements = 1",
        "elements = 1\nclamped = \"start\"\nstart_node = \"crank\"",
        "41:11",
        &["clamped = \"start\" has no effect beside start_node"],
    ),
    (
        "elements = 1",
        "elements = 1\narc = { centre = [\"length\", 1, 0], axis = [0, 0, 1], angle = 0.5 }",
        "39:6",
        &["to of the beam \"rod\" has no effect"],
    ),
    (
        "to = [\"2 * length\", 0, 0]\nelements = 1",
        "elements = 1\narc = { centre = [\"length\", 1, 0], axis = [0, 0, 1], angle = 0.5 }",
        "42:15",
        &["second_axis of the beam \"rod\" has no effect"],
    ),
    ("second_axis = [0, 1, 0]\n", "", "36:1", &["the key second_axis is needed"]),
    (
        "inertia = [0.01, 0.1, 0.1]\n",
        "inertia = [0.01, 0.1, 0.1]\nvelocity = [1, 0, 0]\n\n[[beam]]\nname = \"other\"\nfrom = [\"half\", 0, 0]\nto = [\"half\", 1, 0]\n\
         elements = 1\nsection = \"round\"\nsecond_axis = [1, 0, 0]\nstart_node = \"crank\"\nmotion = { velocity = [2, 0, 0] }\n",
        "45:10",
        &["another velocity than it has of its own", "crank"],
    ),
    (
        "minimize = \"height\"",
        "minimize = \"height\"\nsense = \"maximize\"",
        "29:9",
        &["sense of [optimization] has no effect"],
    ),
    (
        "over = \"terminal\"",
        "over = { aggregate = \"power\", sharpness = 4, normalized = true }",
        "61:59",
        &["normalized of the functional \"height\" has no effect"],
    ),
    (
        "type = \"position\"\non = \"rod.end\"\ndirection = [0, 1, 0]",
        "type = \"joint_load\"\njoint = \"weld\"\non = \"crank\"\nload = \"force_norm\"\ndirection = [0, 1, 0]",
        "62:13",
        &["direction of the functional \"height\" has no effect"],
    ),
    (
        "type = \"position\"\non = \"rod.end\"\ndirection = [0, 1, 0]",
        "type = \"joint_load\"\njoint = \"weld\"\non = \"crank\"\nload = \"moment_norm\"\nframe = \"body\"",
        "62:9",
        &["frame has no effect on the size of a load"],
    ),
    (
        "type = \"circle\"\nmaterial = \"steel\"\ndiameter = 0.05",
        "type = \"beam\"\naxial = 1\nmass = 1\nstiffness = [1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1]",
        "20:9",
        &["axial has no effect beside stiffness"],
    ),
    (
        "[[joint]]\nname = \"weld\"",
        "[[point]]\nname = \"bob\"\nposition = [0, 1, 0]\nmass = 1\n\n[[force]]\nname = \"push\"\non = \"bob\"\npoint = [0, 2, 0]\n\
         direction = [1, 0, 0]\nsize = 1\n\n[[joint]]\nname = \"weld\"",
        "59:9",
        &["this point lies 1 m from \"bob\"", "leave it out"],
    ),
    // other formats
    ("version = 1\n", "$MeshFormat\n4.1 0 8\n", "", &["a mesh of Gmsh", "[[mesh]]"]),
    ("version = 1\n", "<?xml version=\"1.0\"?>\n<robot name=\"arm\"/>\n", "", &["XML", "URDF"]),
    // what has nothing to build
    ("[[body]]", "[[drawing]]", "", &["key \"name\""]),
];

#[test]
fn the_sound_file_is_sound() {
    let scene = parsed(SOUND);
    Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
}

#[test]
fn each_wrong_file_is_told_with_place_value_and_remedy() {
    assert!(CASES.len() >= 25);
    let mut failed = Vec::new();
    for (what, by, place, parts) in CASES {
        assert!(SOUND.contains(what), "{what} is not in the file");
        let message = refused(&SOUND.replacen(what, by, 1));
        let placed = message.lines().any(|line| line.starts_with(&format!("scene.toml:{place}")));
        if !placed || !parts.iter().all(|part| message.contains(part)) {
            failed.push(format!("{what:?} -> {by:?}\n  wanted {place} {parts:?}\n  {message}"));
        }
    }
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), CASES.len(), failed.join("\n"));
}

#[test]
fn all_mistakes_of_a_file_are_told_at_once_in_their_order() {
    let text =
        SOUND.replace("mass = 1.0", "mass = -1").replace("steps = 10", "stpes = 10").replace("unit = \"m\"", "unit = 3");
    let message = refused(&text);
    let lines: Vec<&str> = message.lines().map(|line| line.split(": ").next().unwrap()).collect();
    assert_eq!(lines, ["scene.toml:7:8", "scene.toml:25:1", "scene.toml:33:8"], "{message}");
}

#[test]
fn one_mistake_makes_no_others() {
    let shell = "[[shell]]\nname = \"plate\"\ntype = \"plate\"\nfirst = [1, 0, 0]\nsecond = [0, 1, 0]\nelements = [2, 2]\nmaterial = \"steel\"\n\
                 thickness = 0.01\n\n[[shell]]\nname = \"other {i}\"\ntype = \"plate\"\ncorner = [\"2 * {i}\", 0, 0]\nfirst = [1, 0, 0]\nsecond = [0, 1, 0]\n\
                 elements = [2, 2]\nmaterial = \"steel\"\nthickness = 0.01\nfor = { i = { from = 1, to = 2 } }\n\n";
    let users: String = (0..9)
        .map(|k| {
            format!(
                "[[functional]]\nname = \"energy {k}\"\ntype = \"strain_energy\"\nof = [\"plate\", \"other 1\"]\nover = \"terminal\"\n\n[[force]]\n\
                 name = \"push {k}\"\non = \"plate[0, {k}]\"\ndirection = [0, 0, 1]\nsize = 1\n\n"
            )
        })
        .collect();
    let whole = format!(
        "{SOUND}\n{shell}{}",
        users
            .replace("[0, 5]", "[0, 0]")
            .replace("[0, 6]", "[0, 1]")
            .replace("[0, 7]", "[0, 2]")
            .replace("[0, 8]", "[0, 3]")
    );
    assert_eq!(refused(&whole), "nothing was found");
    for (what, by) in [
        ("for = { i = { from = 1, to = 2 } }", "for = { i = 3 }"),
        ("second = [0, 1, 0]\nelements", "second = [1, 0, 0]\nelements"),
        ("thickness = 0.01\n\n", "thickness = -0.01\n\n"),
        ("thickness = 0.01\n\n", "thickness = 0.01\nclosd = true\n\n"),
        ("type = \"plate\"\nfirst", "type = \"plte\"\nfirst"),
    ] {
        assert!(whole.contains(what), "{what}");
        let message = refused(&whole.replacen(what, by, 1));
        assert_eq!(message.lines().count(), 1, "{by}: {message}");
    }
}

#[test]
fn loops_take_ranges_and_lists() {
    let with = |values: &str| {
        let text = format!(
            "name = \"crank\"\n[[point]]\nname = \"bob {{i}}\"\nposition = [\"{{i}}\", 0, 0]\nmass = 1\nfor = {{ i = {values} }}\n[[body]]\nname = \"crank\""
        );
        let scene = FileScene::parse(
            "scene.toml",
            &SOUND.replacen("name = \"crank\"", &text.replacen("name = \"crank\"", "name = \"first\"", 1), 1),
        );
        let scene = scene.unwrap_or_else(|why| panic!("{why}"));
        let mechanism = scene.build_real(&[1.0]).unwrap_or_else(|why| panic!("{why}"));
        let own = mechanism.model.nodes.iter().filter_map(|node| node.name.strip_prefix("bob ").map(String::from));
        own.collect::<Vec<_>>().join(" ")
    };
    for (values, made) in [
        ("{ from = 1, to = 5 }", "1 2 3 4 5"),
        ("{ from = -1, to = 1 }", "-1 0 1"),
        ("{ from = 2, to = 2 }", "2"),
        ("{ values = [-1, 1] }", "-1 1"),
        ("{ values = [\"1\", \"7\"] }", "1 7"),
        ("[1, 2]", "1 2"),
        ("[5, 1]", "5 1"),
        ("[3]", "3"),
        ("[1, 3, 7]", "1 3 7"),
        ("[-1, 1]", "-1 1"),
        ("[1, 5]", "1 5"),
    ] {
        assert_eq!(with(values), made, "{values}");
    }
}

#[test]
fn the_command_line_ends_with_code_2_and_the_place() {
    let folder = std::env::temp_dir().join(format!("costate-wrong-file-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let run = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_costate")).args(arguments).current_dir(&folder).output().unwrap()
    };
    std::fs::write(folder.join("sound.toml"), SOUND).unwrap();
    std::fs::write(folder.join("wrong.toml"), SOUND.replace("mass = 1.0", "mass = -1.0")).unwrap();
    std::fs::write(folder.join("binary.toml"), [b'a', 0xff, 0xfe]).unwrap();
    std::fs::write(folder.join("design.toml"), SOUND.replace("mass = 1.0", "mass = \"1 - half\"")).unwrap();
    let cases: [(&[&str], &[&str]); 7] = [
        (&["check", "wrong.toml"], &["wrong.toml:33:8: mass of [[body]] \"crank\" is -1"]),
        (&["run", "wrong.toml"], &["wrong.toml:33:8"]),
        (&["gradient", "wrong.toml", "--check"], &["wrong.toml:33:8"]),
        (&["modes", "missing.toml"], &["missing.toml: cannot be read"]),
        (&["check", "binary.toml"], &["binary.toml:1:2: this is no text in UTF-8"]),
        (&["optimize", "design.toml", "--set", "length=5"], &["design.toml:33:8: mass: at this design the value is -1.5"]),
        (&["check", "."], &["\".\""]),
    ];
    for (arguments, parts) in cases {
        let output = run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{arguments:?}: {message}");
        assert!(message.starts_with("error: "), "{arguments:?}: {message}");
    }
    // what only the start of the scene shows is told where the part is described, not the variable of its name
    let weld = "[[joint]]\nname = \"weld\"";
    assert!(SOUND.contains(weld));
    let second = "[[joint]]\nname = \"length\"\ntype = \"revolute\"\nbetween = [\"ground\", \"crank\"]\npoint = \"pin\"\naxis = [0, 0, 1]\n\n";
    std::fs::write(folder.join("twice.toml"), SOUND.replace(weld, &format!("{second}{weld}"))).unwrap();
    let loose = "[[body]]\nname = \"loose\"\nmass = 1\ninertia = [0, 0, 0]\n\n";
    std::fs::write(folder.join("loose.toml"), SOUND.replace(weld, &format!("{loose}{weld}"))).unwrap();
    let place = SOUND.lines().position(|line| line == "name = \"weld\"").unwrap();
    for (file, parts) in [("twice.toml", ["joint \"length\"", "drop_redundant = true"]), ("loose.toml", ["\"loose\"", ""])] {
        let output = run(&["check", file]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{file}: {message}");
        assert!(message.starts_with(&format!("error: {file}:{place}:")), "{file}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{file}: {message}");
    }
    for (what, by, place, _) in CASES {
        std::fs::write(folder.join("case.toml"), SOUND.replacen(what, by, 1)).unwrap();
        let output = run(&["check", "case.toml"]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{what:?} -> {by:?}: {message}");
        assert!(message.contains(&format!("case.toml:{place}")), "{what:?} -> {by:?}: {message}");
    }
    let _ = std::fs::remove_dir_all(folder.join("out"));
    let output = run(&["check", "sound.toml"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && said.contains("sound.toml: in order; 1 design variable"), "{said}");
    assert!(!folder.join("out").exists(), "check writes nothing");
    std::fs::remove_dir_all(&folder).unwrap();
}
