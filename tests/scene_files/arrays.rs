//! Design variables of several numbers, splines between them, and lists whose entries stand for many.

use super::{parsed, refused};
use costate::prelude::*;
use costate::scenes::AnyScene;
use costate::scenes::FileScene;

/// A plate whose thickness goes along a spline, one of strips, a mass between values, and a force through all of them.
const TEXT: &str = r#"version = 1
settings = { end = 0.1, steps = 10 }
material.steel = { young = 2e11, poisson = 0.3, density = 1000 }

[variable.wall]
count = 3
name = "thickness"
initial = [0.01, 0.03, 0.02]
bounds = [0.001, 0.1]
unit = "m"

[variable.push]
count = 4
initial = 2
bounds = [0, 10]
unit = "N"

[[shell]]
name = "plate"
type = "plate"
first = [2, 0, 0]
second = [0, 0.5, 0]
elements = [4, 1]
material = "steel"
thickness = "spline(wall, share)"
clamped = ["first_start"]

[[shell]]
name = "strips"
type = "plate"
corner = [0, 0, 1]
first = [2, 0, 0]
second = [0, 0.5, 0]
elements = [3, 1]
material = "steel"
thickness = "wall"
clamped = ["first_start"]

[[point]]
name = "ball {k}"
for = { k = [0, 1, 2] }
position = ["{k}", 0, 2]
mass = "100 * wall[{k}]"

[[force]]
name = "push"
on = "ball 0"
direction = [1, 0, 0]
size = { type = "lines", times = [0, 0.03, 0.06, 0.1], values = "push" }

[[force]]
name = "draw"
on = "ball 1"
direction = [1, 0, 0]
size = { type = "formula", value = "spline(push, 10 * t)" }

[[functional]]
name = "mass of {member}"
for = { member = ["plate", "strips"] }
type = "mass"
of = "{member}"
over = "initial"

[[functional]]
name = "between"
type = "formula"
nodes = { ball = "ball 0" }
value = "spline(wall, 0.25)"
over = "terminal"

[[functional]]
name = "speed of ball {k}"
for = { k = [0, 1] }
type = "velocity"
on = "ball {k}"
direction = [1, 0, 0]
over = "terminal"

[optimization]
minimize = "mass of plate"
varying = ["thickness"]
constraint = [{ for = { member = ["strips", "plate"] }, functional = "mass of {member}", at_least = 10 }]
linear = [
    { for = { k = [0, 1] }, name = "step {k}", coefficients = { "thickness[{k}]" = 1, "thickness[{k + 1}]" = -1 }, at_most = 0.02 },
]
"#;

#[test]
fn several_numbers_are_one_variable_and_a_spline_goes_through_them() {
    let scene = parsed(TEXT);
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let names: Vec<&str> = prepared.variables.iter().map(|own| &*own.name).collect();
    assert_eq!(names, ["thickness[0]", "thickness[1]", "thickness[2]", "push[0]", "push[1]", "push[2]", "push[3]"]);
    assert_eq!(prepared.x, [0.01, 0.03, 0.02, 2.0, 2.0, 2.0, 2.0]);
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap();
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap().rows;
    let reference = analysis.complex_step(&prepared.x, &forward).unwrap().rows;
    for (own, other) in gradient.iter().zip(&reference) {
        assert!(largest_difference(other, own) < 1e-12, "{own:?} {other:?}");
    }
    // the natural spline through (0, a), (1/2, b), (1, c): in its first half (a + b) / 2 - 3 (a - 2 b + c) / 32 in the middle, and
    // a (1 - s) + b s - (a - 2 b + c) (s - s^3) / 4 at a share s of it
    let natural = |[a, b, c]: [f64; 3], share: f64| {
        let (a, c, s) = if share < 0.5 { (a, c, 2.0 * share) } else { (c, a, 2.0 - 2.0 * share) };
        a * (1.0 - s) + b * s - (a - 2.0 * b + c) * (s - s.powi(3)) / 4.0
    };
    let t = [0.01, 0.03, 0.02];
    let of_plate = (0..4).map(|k| natural(t, (f64::from(k) + 0.5) / 4.0)).sum::<f64>() * 1000.0 * 0.25;
    let of_strips = (0.01 + 0.03 + 0.02) * 1000.0 / 3.0;
    let expected = [of_plate, of_strips, natural(t, 0.25), 2.0 * 0.1 / 1.0, 2.0 * 0.1 / 3.0];
    for (own, expected) in forward.values.iter().zip(expected) {
        assert!((own - expected).abs() < 1e-12 * expected, "{own} for {expected}");
    }
    for (k, by_thickness) in gradient[0][..3].iter().enumerate() {
        let unit: [f64; 3] = std::array::from_fn(|i| f64::from(u8::from(i == k)));
        let by_value = (0..4).map(|k| natural(unit, (f64::from(k) + 0.5) / 4.0)).sum::<f64>() * 1000.0 * 0.25;
        assert!((by_thickness - by_value).abs() < 1e-11, "{by_thickness} for {by_value}");
    }
    // lines: each value counts by half the way to its neighbours
    for (k, share) in [0.015, 0.03, 0.035, 0.02].into_iter().enumerate() {
        assert!((gradient[3][3 + k] - share).abs() < 1e-13, "{:?}", gradient[3]);
    }
}

#[test]
fn limits_of_an_optimization_stand_for_many() {
    let scene = parsed(TEXT);
    let problem = scene.optimization_problem().expect("a problem");
    assert_eq!(problem.varying.as_deref(), Some(&["thickness[0]", "thickness[1]", "thickness[2]"].map(String::from)[..]));
    let limited: Vec<&str> = problem.constraints.iter().map(|own| &*own.functional).collect();
    assert_eq!(limited, ["mass of strips", "mass of plate"]);
    let rows: Vec<_> = problem.linear.iter().map(|own| (&*own.name, own.coefficients.len())).collect();
    assert_eq!(rows, [("step 0", 2), ("step 1", 2)]);
    assert_eq!(problem.linear[1].coefficients[1], ("thickness[2]".to_string(), -1.0));
}

#[test]
fn loops_lie_in_loops() {
    let text = TEXT.replace(
        "[[force]]\nname = \"push\"",
        "[[drawing]]\non = \"ball {k}\"\nfor = { k = [0, 1] }\npoints = [[0, 0, \"{k}\"], [1, 0, 2]]\n\n\
         [[mesh]]\nname = \"mesh {k}\"\nfor = { k = [3, 4] }\ntype = \"faces\"\npoints = [[0, 0, \"{k}\"], [1, 0, \"{k}\"], [1, 1, \"{k}\"], [0, 1, \"{k}\"]]\n\
         faces = [[0, 1, 2, 3]]\ngroups = { all = [0] }\nmaterial = \"steel\"\n\
         parts = [{ for = { name = [\"all\"] }, of = [\"{name}\"], thickness = \"0.001 * {k} * wall[0]\" }]\n\n[[force]]\nname = \"push\"",
    );
    let scene = parsed(&text);
    assert!(Prepared::new(&scene).is_ok());
    let same = text.replace("for = { name = [\"all\"] }, of = [\"{name}\"]", "for = { k = [5] }, of = [\"all\"]");
    let told = FileScene::parse("arrays.toml", &same).unwrap_err();
    assert!(told.contains("k is a name of the loop around this one"), "{told}");
}

#[test]
fn what_is_wrong_with_several_numbers_is_told() {
    for (from, to, part) in [
        ("count = 4", "count = 0", "count of [variable.push]"),
        ("count = 3", "count = 1", "count of [variable.wall]"),
        ("count = 4", "count = 1000000000000", "count of [variable.push]"),
        ("initial = 2", "initial = [1, 2]", "\"push\" has 4 values, and these are 2"),
        ("initial = [0.01, 0.03, 0.02]", "initial = [0.01, 0.3, 0.02]", "initial of \"thickness\" is 0.3"),
        ("\"100 * wall[{k}]\"", "\"100 * wall[{k + 1}]\"", "there is no wall[3]: the last one is wall[2]"),
        ("\"100 * wall[{k}]\"", "\"100 * wall\"", "\"wall\" has 3 values, wall[0] to wall[2]"),
        ("\"spline(wall, 0.25)\"", "\"spline(s, 0.25)\"", "spline wants the name of a design variable with count"),
        ("\"spline(wall, 0.25)\"", "\"spline(wall, [1, 2, 3])\"", "the place of spline is a number"),
        ("\"spline(wall, 0.25)\"", "\"spline(wall, share)\"", "\"share\" is the place along a beam"),
        (
            "thickness = \"spline(wall, share)\"",
            "thickness = [\"wall[0]\", \"share\"]",
            "share is the place along all strips",
        ),
        ("values = \"push\"", "values = \"wall\"", "there are 4 times, but 3 values"),
        ("[variable.push]\n", "[variable.push]\nper_face = \"plate\"\n", "mesh"),
        ("[[point]]", "[define]\nwall = 3\n\n[[point]]", "the name \"wall\" is taken by a design variable"),
    ] {
        assert!(TEXT.contains(from), "{from}");
        let told = refused(&TEXT.replace(from, to));
        assert!(told.contains(part), "{to}: {told}");
    }
}

/// Points whose places and masses are definitions by a loop, which know each other and other definitions.
const DEFINED: &str = r#"version = 1
settings = { end = 1, steps = 2 }

[variable]
a = { initial = 0.5, bounds = [0, 1], unit = "m" }

[define]
size = 3
"mass{k}" = { for = { k = { from = 1, to = "size" } }, value = "{k} * norm(place{k})" }
"place{k}" = { for = { k = { from = 1, to = "size" } }, value = ["{k} * a", 0, 0] }

[[point]]
name = "p{k}"
for = { k = { from = 1, to = "size" } }
position = "place{k}"
mass = "mass{k}"

[[functional]]
name = "mass"
type = "mass"
over = "initial"
"#;

#[test]
fn definitions_are_repeated_by_loops() {
    let scene = FileScene::parse("defined.toml", DEFINED).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap();
    // 1 a + 2 (2 a) + 3 (3 a)
    assert!((forward.values[0] - 7.0).abs() < 1e-14, "{:?}", forward.values);
    let rows = analysis.adjoint(&prepared.x, &forward).unwrap().rows;
    assert!((rows[0][0] - 14.0).abs() < 1e-13, "{rows:?}");
    for (what, by, why) in [
        ("size = 3\n", "size = 3\nmass2 = 1\n", "the name \"mass2\" is taken by another definition"),
        ("value = \"{k} * norm", "val = \"{k} * norm", "or { for = .., value = .. }"),
        ("to = \"size\" } }, value = \"{k} * norm", "to = 0 } }, value = \"{k} * norm", "goes from 1 to 0"),
        ("\"{k} * norm(place{k})\"", "\"{k} * norm(place{j})\"", "{j}"),
        ("\"{k} * norm(place{k})\"", "\"{k} * norm(place{k + 3})\"", "place4"),
        ("\"mass{k}\" =", "\"mass{k}\" = 2\n\"other{k}\" =", "\"mass{k}\""),
    ] {
        assert!(DEFINED.contains(what), "{what}");
        let told = refused(&DEFINED.replacen(what, by, 1));
        assert!(told.contains(why), "{what} by {by}: {told}");
    }
}

/// Places of points along x, of a formula with braces in a loop.
fn places(formula: &str, values: &str) -> Result<Vec<f64>, String> {
    let text = format!(
        "version = 1\nvariable.l = {{ initial = 0.5, bounds = [0, 1] }}\nvariable.k_2 = {{ initial = 3, bounds = [0, 9] }}\n\
         settings = {{ end = 1, steps = 1 }}\n[[point]]\nname = \"p{{i}}\"\nfor = {{ i = {values} }}\nposition = [\"{formula}\", 0, 0]\nmass = 1\n"
    );
    let scene = FileScene::parse("braces.toml", &text)?;
    let mechanism = scene.build_real(&[0.5, 3.0])?;
    Ok(mechanism.numbers.q.chunks(3).map(|place| place[0]).collect())
}

#[test]
fn what_stands_in_braces_is_a_value_in_formulas() {
    let numbers = "[-1, 2]";
    for (formula, values, expected) in [
        ("{i}", numbers, [-1.0, 2.0]),
        ("{i}^2", numbers, [1.0, 4.0]),
        ("2 - {i}^2", numbers, [1.0, -2.0]),
        ("-{i}^2", numbers, [-1.0, -4.0]),
        ("2^{i}", numbers, [0.5, 4.0]),
        ("l-{i}", numbers, [1.5, -1.5]),
        ("1 / {i} / {2 * i}", numbers, [0.5, 0.125]),
        ("3 * ({i} - {i + 1}) * {i}", numbers, [3.0, -6.0]),
        ("[l, {i}, 0].y", numbers, [-1.0, 2.0]),
        ("max({i}, l)", numbers, [0.5, 2.0]),
        ("2 * {i}", "[\"1 + l\", \"-l\"]", [3.0, -1.0]),
        ("{i}^2", "[\"1 + l\", \"-l\"]", [2.25, 0.25]),
        ("{i}", "[\"1 + l\", \"-l\"]", [1.5, -0.5]),
        ("{i}(l^2)", "[\"sqrt\", \"log\"]", [0.5, 0.25_f64.ln()]),
        ("2 * {i}", "[\"l\", \"k_2\"]", [1.0, 6.0]),
        ("k_{i} * k{j}", "[2], j = [\"_2\"]", [9.0, f64::NAN]),
    ] {
        let found = places(formula, values).unwrap_or_else(|why| panic!("{formula}: {why}"));
        let expected = expected.iter().filter(|own| own.is_finite());
        assert!(found.iter().eq(expected.clone()), "{formula} with {values}: {found:?} for {expected:?}");
    }
    for formula in ["2{i}", "{i}2", "1e{i}", "0.{i}", "{i}.5", "{i}{i}", "{i}e3"] {
        let why = places(formula, "[3, 4]").expect_err(formula);
        assert!(why.contains("{i} is 3 here and touches what stands beside it"), "{formula}: {why}");
    }
    for formula in ["k_{i - 3}", "l{i - 3}", "{i - 3}(l)"] {
        let why = places(formula, "[2]").expect_err(formula);
        assert!(why.contains("{i - 3} is -1 here"), "{formula}: {why}");
    }
}
