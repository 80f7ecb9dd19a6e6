//! Tables: values at times and at points of s, from lists and from files.

use super::{parsed, refused};
use costate::elements::{Table, TimeFunction};
use costate::internals::{ArgumentKind, Formula, ProgramWork, Recorded};
use costate::prelude::*;
use costate::scalar::Curve;
use costate::sensitivity::largest_difference;
use num_dual::Dual2_64;
use std::path::PathBuf;
use std::sync::{Arc, Weak};
use std::time::Instant;

const WAYS: [(&str, Interpolant); 4] = [
    ("monotone", Interpolant::Monotone),
    ("smooth", Interpolant::Smooth),
    ("lines", Interpolant::Lines),
    ("steps", Interpolant::Steps),
];

/// f, f' and f'' of a table whose values stay, and of one whose values are parameters.
fn both(knots: &[f64], values: &[f64], way: Interpolant, t: f64) -> [[f64; 3]; 2] {
    let curve = TimeFunction::curve(knots, values, way).expect("sound");
    let table = Table::new(knots, way).expect("sound");
    let numbers: Vec<Dual2_64> = table.numbers(values).into_iter().map(Dual2_64::from).collect();
    let at = Dual2_64::new(t, 1.0, 0.0);
    [curve.value(at, &[]), table.value(at, &numbers)].map(|own| [own.re, own.v1, own.v2])
}

#[track_caller]
fn assert_both(knots: &[f64], values: &[f64], way: Interpolant, t: f64, expected: [f64; 3]) {
    for found in both(knots, values, way, t) {
        let near = |(found, expected): (f64, f64)| (found - expected).abs() < 1e-12 * (1.0 + expected.abs());
        assert!(found.into_iter().zip(expected).all(near), "{way:?} at {t}: {found:?}, not {expected:?}");
    }
}

#[test]
fn tables_and_their_derivatives_are_those_of_their_formulas() {
    // slopes of a parabola away from its vertex are not cut
    let knots = [1.0, 2.0, 2.5, 4.0, 4.5];
    let squares = knots.map(|x: f64| x * x);
    for t in [1.0, 1.3, 2.0, 2.5, 3.9, 4.4999] {
        assert_both(&knots, &squares, Interpolant::Monotone, t, [t * t, 2.0 * t, 2.0]);
    }
    assert_both(&knots, &squares, Interpolant::Monotone, 6.0, [20.25 + 9.0 * 1.5, 9.0, 0.0]);
    // between zeros: slopes are zero at the top and at the feet of a bump
    let (knots, bump) = ([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 0.0, 0.06, 0.0, 0.0]);
    let foot = |s: f64| [0.06 * s * s * (3.0 - 2.0 * s), 0.36 * s * (1.0 - s), 0.36 * (1.0 - 2.0 * s)];
    for (t, expected) in [(-3.0, [0.0; 3]), (0.5, [0.0; 3]), (1.25, foot(0.25)), (1.0, foot(0.0)), (9.0, [0.0; 3])] {
        assert_both(&knots, &bump, Interpolant::Monotone, t, expected);
    }
    // natural spline through 0, 1, 0: 3/2 t - t^3/2 up to the middle
    let spline = |t: f64| [1.5 * t - 0.5 * t.powi(3), 1.5 - 1.5 * t * t, -3.0 * t];
    for (t, expected) in [(0.0, spline(0.0)), (0.3, spline(0.3)), (1.0, [1.0, 0.0, -3.0]), (-2.0, [-3.0, 1.5, 0.0])] {
        assert_both(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0], Interpolant::Smooth, t, expected);
    }
    for (t, line, step) in [(-1.0, [2.0, 0.0], 2.0), (0.0, [2.0, 1.5], 2.0), (1.0, [3.5, 1.5], 2.0), (2.0, [5.0, -4.0], 5.0)]
    {
        assert_both(&[0.0, 2.0, 2.5], &[2.0, 5.0, 3.0], Interpolant::Lines, t, [line[0], line[1], 0.0]);
        assert_both(&[0.0, 2.0, 2.5], &[2.0, 5.0, 3.0], Interpolant::Steps, t, [step, 0.0, 0.0]);
    }
    assert_both(&[0.0, 2.0, 2.5], &[2.0, 5.0, 3.0], Interpolant::Steps, 7.0, [3.0, 0.0, 0.0]);
    assert_both(&[0.0, 2.0, 2.5], &[2.0, 5.0, 3.0], Interpolant::Lines, 7.0, [3.0, 0.0, 0.0]);
    for (t, line) in [(-2.0, [-1.0, 1.5]), (1.0, [3.5, 1.5]), (7.0, [-15.0, -4.0])] {
        assert_both(&[0.0, 2.0, 2.5], &[2.0, 5.0, 3.0], Interpolant::LinesOn, t, [line[0], line[1], 0.0]);
    }
}

/// Numbers between 0 and 1 (Marsaglia's xorshift generator).
fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / 2.0_f64.powi(53)
}

#[test]
fn monotone_tables_stay_between_neighbouring_values() {
    let mut state = 7;
    for case in 0..300 {
        let count = 2 + case % 9;
        let mut at = 0.0;
        let knots: Vec<f64> = (0..count)
            .map(|_| {
                at += 10.0_f64.powf(4.0 * random(&mut state) - 2.0);
                at
            })
            .collect();
        // rounded, so that some neighbours are equal
        let values: Vec<f64> =
            (0..count).map(|_| (5.0 * random(&mut state)).round() * 1e3_f64.powf(random(&mut state))).collect();
        for (pair, ends) in knots.windows(2).zip(values.windows(2)) {
            let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            for share in 0..=20 {
                let t = pair[0] + (pair[1] - pair[0]) * f64::from(share) / 20.0;
                for [found, ..] in both(&knots, &values, Interpolant::Monotone, t) {
                    let round_off = 1e-12 * high.abs().max(low.abs());
                    assert!(found >= low - round_off && found <= high + round_off, "{found} at {t}: {knots:?} {values:?}");
                }
            }
        }
    }
    let spline =
        |k: u8| both(&[0.0, 1.0, 2.0, 3.0, 4.0], &[0.0, 0.0, 1.0, 0.0, 0.0], Interpolant::Smooth, 0.01 * f64::from(k))[0][0];
    assert!((0..100).map(spline).any(|own| own < -0.05), "a natural spline leaves its data");
}

/// A mass on a spring, both driven by tables whose values are design variables.
fn of_design(way: &str) -> String {
    let names = ["a", "b", "c", "d", "e"];
    let variables: String = (0..)
        .zip(names)
        .map(|(k, name)| format!("{name} = {{ initial = {}, bounds = [-50, 50] }}\n", [1.5, -4.0, 7.0, 7.5, 2.0][k]))
        .collect();
    format!(
        "version = 1\n[variable]\n{variables}\
         [[point]]\nname = \"mass\"\nposition = [0.5, 0, 0]\nvelocity = [0.4, 0, 0]\nmass = 2\n\
         [[joint]]\nname = \"rail\"\ntype = \"point_on_line\"\nbetween = [\"ground\", \"mass\"]\naxis = [1, 0, 0]\n\
         [[force]]\nname = \"push\"\non = \"mass\"\ndirection = [1, 0, 0]\n\
         size = {{ type = \"table\", times = [0.013, 0.11, 0.23, 0.37, 0.48], values = [\"a\", \"b\", \"c\", \"d\", \"e\"], \
         interpolation = \"{way}\" }}\n\
         [[spring]]\nname = \"spring\"\ntype = \"line_law\"\nbetween = [\"ground\", \"mass\"]\nrest_length = 0.5\n\
         force = {{ type = \"table\", points = [-0.3, -0.1, 0.05, 0.2, 0.4], values = [\"-9 * e\", \"a\", \"c\", 30, \"8 * d\"], \
         interpolation = \"{way}\" }}\n\
         [[functional]]\nname = \"x\"\ntype = \"position\"\non = \"mass\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n\
         [settings]\nend = 0.5\nsteps = 100\n"
    )
}

#[test]
fn gradients_by_the_values_of_tables_are_exact() {
    for (way, _) in WAYS {
        let scene = parsed(&of_design(way));
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap();
        let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
        let reference = analysis.complex_step(&prepared.x, &forward).unwrap();
        let largest = largest_difference(&reference.rows[0], &adjoint.rows[0]);
        println!("{way}: {largest:.1e} {:?}", adjoint.rows[0]);
        assert!(largest < 1e-12, "{way}: {largest:.1e}");
        assert!(adjoint.rows[0].iter().all(|own| *own != 0.0), "{way}: {:?}", adjoint.rows);
    }
}

/// A file with two columns, in a folder of this process.
fn file(name: &str, text: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("costate_tables_{}_{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("road.csv");
    std::fs::write(&path, text).unwrap();
    path
}

/// A mass on a spring that a table pushes.
fn pushed(size: &str) -> String {
    let of_design = of_design("monotone");
    let (before, rest) = of_design.split_once("size = ").unwrap();
    format!("{before}size = {size}\n{}", rest.split_once('\n').unwrap().1)
}

fn of_file(path: &std::path::Path, more: &str) -> String {
    pushed(&format!("{{ type = \"table\", file = {:?}{more} }}", path.to_str().unwrap()))
}

fn wave(count: usize) -> (Vec<f64>, Vec<f64>) {
    let times = (0..count).map(|k| 0.5 * k as f64 / (count - 1) as f64);
    times.map(|t| (t, 3.0 * (9.0 * t).sin())).unzip()
}

#[test]
fn a_table_is_one_look_up_however_long_it_is() {
    let instructions = |count: usize, way: Interpolant| {
        let (times, values) = wave(count);
        let table = Table::new(&times, way).expect("sound");
        let parameters = table.numbers(&values).len();
        let arguments = [(ArgumentKind::Time, 1), (ArgumentKind::Parameter, parameters)];
        let of_design = Formula::record(arguments, |x: &[Recorded]| vec![table.value(x[0], &x[1..])]).unwrap();
        let curve = TimeFunction::curve(&times, &values, way).expect("sound");
        let fixed = Formula::record(arguments, |x: &[Recorded]| vec![curve.value(x[0], &[])]).unwrap();
        [of_design, fixed].map(|formula| formula.values().instructions())
    };
    for (name, way) in WAYS {
        let [few, many] = [10, 5000].map(|count| instructions(count, way));
        println!("{name}: {few:?} instructions");
        assert_eq!(few, many, "{name}");
        assert!(few[0] < 40 && few[1] == 1, "{name}: {few:?}");
    }
}

#[test]
fn a_run_takes_as_long_with_many_points_as_with_few() {
    for count in [10, 1000, 5000] {
        let (times, values) = wave(count);
        let rows: String = times.iter().zip(&values).map(|(t, y)| format!("{t},{y}\n")).collect();
        let text = of_file(&file(&format!("long{count}"), &rows), "").replace("steps = 100", "steps = 20000");
        let start = Instant::now();
        let scene = parsed(&text);
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
        let (read, start) = (start.elapsed(), Instant::now());
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap();
        let ran = start.elapsed();
        println!("{count} points: set-up {read:.1?}, run {ran:.1?}, x = {}", forward.values[0]);
        // a fixed table has no parameters
        assert!(prepared.model().elements.iter().all(|own| own.name != "push" || own.parameters.len() < 10));
    }
}

#[test]
fn a_table_goes_with_what_used_it() {
    let (times, values) = wave(50);
    let curve = Curve::new(&times, &values, Interpolant::Monotone).expect("sound");
    let watched: Weak<Curve> = Arc::downgrade(&curve);
    // formulas without tables are kept for models to come
    let formula = Formula::record([(ArgumentKind::Time, 1)], |x: &[Recorded]| vec![x[0].on_curve(&curve, 0)]).unwrap();
    formula.values().run(&[0.1], &mut [0.0], &mut ProgramWork::default());
    drop(formula);
    assert_eq!(watched.strong_count(), 1, "a table outlives its formula");
    let mut m = MechanismBuilder::<f64>::default();
    let mass = m.point("mass", Vector3::x());
    m.point_mass("mass", mass, 1.0);
    let size = Signal::of(TimeFunction::Curve(curve, Interpolant::Monotone), &[]);
    m.force("push", Force { on: mass, point: Vector3::x(), direction: Vector3::x(), frame: LoadFrame::World, size });
    let model = m.finish().expect("sound");
    assert!(watched.strong_count() > 0);
    drop(model);
    assert_eq!(watched.strong_count(), 0, "a table outlives its model");
}

#[test]
fn a_run_is_none_of_a_scene_whose_table_has_changed() {
    let rows = |last: f64| format!("0,1\n0.2,3\n0.5,{last}\n");
    let path = file("changed", &rows(2.0));
    let scenes = [2.0, 2.0, 2.5].map(|last| {
        std::fs::write(&path, rows(last)).unwrap();
        parsed(&of_file(&path, ""))
    });
    let [first, same, other] = scenes.each_ref().map(|scene| Prepared::new(scene).unwrap_or_else(|why| panic!("{why}")));
    let run = first.analysis().forward(&first.x).unwrap();
    same.analysis().adjoint(&same.x, &run).unwrap();
    let told = other.analysis().adjoint(&other.x, &run).unwrap_err().to_string();
    assert!(told.contains("push"), "{told}");
}

#[test]
fn files_give_what_their_numbers_say_in_a_list() {
    let value = |text: &str| {
        let scene = parsed(text);
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
        prepared.analysis().forward(&prepared.x).unwrap().values[0]
    };
    let listed = value(&pushed("{ type = \"table\", times = [0, 0.2, 0.5], values = [1, \"2 + 1\", 2] }"));
    for (name, text, more) in [
        ("plain", "0,1\n0.2,3\n0.5,2\n", ""),
        ("named", "\u{feff}# a road\nh; \"t\" ; x\n1; 0; 9\n\n3;0.2;9\n2;0.5;9\n", ", columns = [\"t\", \"h\"]"),
        ("numbered", "t\tx\th\n0\t9\t1\n0.2\t9\t3\n0.5\t9\t2\n", ", columns = [1, 3]"),
        ("blanks", "0 1\n 0.2   3\n0.5 2\n", ", interpolation = \"monotone\""),
    ] {
        assert_eq!(value(&of_file(&file(name, text), more)), listed, "{name}");
    }
}

#[test]
fn what_is_wrong_with_a_file_of_a_table_is_told() {
    for (name, text, more, part) in [
        ("word", "t,h\n0,1\n0.2,two\n", "", "line 3, column \"h\": \"two\" is no finite number"),
        ("comma", "0;1\n0,2;3\n", "", "line 2, column 1: \"0,2\" is no finite number"),
        ("infinite", "0,1\n1,inf\n", "", "line 2, column 2: \"inf\" is no finite number"),
        ("back", "t,h\n0,1\n0.2,3\n0.2,4\n", "", "line 4, column \"t\": 0.2 does not increase after 0.2"),
        ("short", "0,1\n0.2\n", "", "line 2 ends before column 2"),
        ("header", "0,1\n0.2,3\n", ", columns = [\"t\", \"h\"]", "does not name columns, so that none is \"t\""),
        ("name", "t,h\n0,1\n1,2\n", ", columns = [\"t\", \"z\"]", "names no column \"z\"; there are t, h"),
        ("number", "0,1\n0.2,3\n", ", columns = [1, 3]", "there is no column 3: its first line has 2"),
        ("one", "t,h\n0,1\n", "", "it has 1 lines of numbers, and a table needs 2 or more"),
        ("empty", "\n", "", "it has no lines with numbers"),
        ("both", "0,1\n1,2\n", ", times = [0, 1]", "leave either these or the file out"),
        ("columns", "0,1\n1,2\n", ", columns = [1]", "two names or numbers of columns"),
        ("way", "0,1\n1,2\n", ", interpolation = \"linear\"", "lines"),
    ] {
        let told = refused(&of_file(&file(name, text), more));
        assert!(told.contains(part), "{name}: {told}");
    }
    for (size, part) in [
        ("{ type = \"table\", file = \"no_such.csv\" }", "file, \"no_such.csv\": cannot be read"),
        ("{ type = \"table\", times = [0, 1] }", "the key values is needed here"),
        ("{ type = \"table\", values = [0, 1] }", "the key times is needed here"),
        ("{ type = \"table\", times = [0, 1], values = [0, 1], columns = [1, 2] }", "give the key file, too"),
        ("{ type = \"table\", times = [0, 1], values = [0] }", "there are 2 times, but 1 values"),
        ("{ type = \"table\", times = [1, 0], values = [0, 1] }", "must increase"),
    ] {
        let told = refused(&pushed(size));
        assert!(told.contains(part), "{size}: {told}");
    }
}

/// A point at x with a functional of the table f there, whose keys are given; w is a design variable.
fn named(table: &str, x: f64, value: &str) -> String {
    format!(
        "version = 1\nsettings = {{ end = 0.1, steps = 2 }}\n\
         [variable]\nw = {{ initial = 2, bounds = [0, 9] }}\nx = {{ initial = {x}, bounds = [-99, 99] }}\n\
         [define]\ndouble = \"2 * w\"\n\
         [table.f]\n{table}\n\
         [[point]]\nname = \"p\"\nposition = [\"x\", 0, 0]\nmass = 1\n\
         [[functional]]\nname = \"f\"\ntype = \"formula\"\nnodes = {{ p = \"p\" }}\nvalue = \"{value}\"\nover = \"terminal\"\n"
    )
}

/// Value and derivatives by w and x.
fn of_named(text: &str) -> [f64; 3] {
    let scene = parsed(text);
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap();
    let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
    [forward.values[0], adjoint.rows[0][0], adjoint.rows[0][1]]
}

#[test]
fn formulas_call_tables_by_their_names() {
    // through (0, 0), (1, w), (3, 1) with w = 2: lines of slopes 2 and -1/2
    for (keys, at, expected) in [
        ("", 0.5, [1.0, 0.5, 2.0]),
        ("", 2.0, [1.5, 0.5, -0.5]),
        ("", -1.0, [0.0, 0.0, 0.0]),
        ("", 9.0, [1.0, 0.0, 0.0]),
        ("extrapolation = \"constant\"", 9.0, [1.0, 0.0, 0.0]),
        ("extrapolation = \"linear\"", -1.0, [-2.0, -1.0, 2.0]),
        ("extrapolation = \"linear\"", 9.0, [-2.0, -3.0, -0.5]),
    ] {
        // values of the design, and the same ones fixed
        for (values, by_design) in [("[0, \"double / 2\", 1]", 1.0), ("[0, 2, 1]", 0.0)] {
            let table = format!("points = [0, 1, 3]\nvalues = {values}\ninterpolation = \"lines\"\n{keys}");
            let found = of_named(&named(&table, at, "f(p.position.x) + 0 * w"));
            let expected = [expected[0], by_design * expected[1], expected[2]];
            assert!(
                found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-13),
                "{keys} at {at}: {found:?} {expected:?}"
            );
        }
    }
    for (keys, beyond) in [("", [4.0, 0.0, 2.0]), ("extrapolation = \"constant\"", [2.0, 0.0, 0.0])] {
        let table = format!("points = [0, 1]\nvalues = [0, 2]\n{keys}");
        let found = of_named(&named(&table, 2.0, "f(p.position.x) + 0 * w"));
        assert!(found.iter().zip(beyond).all(|(a, b)| (a - b).abs() < 1e-13), "{keys}: {found:?}");
    }
    // of anything, and within definitions
    let table = "points = [0, 1, 3]\nvalues = [0, 2, 1]\ninterpolation = \"lines\"";
    let text = named(table, 0.5, "2 * f(f(w / 4) + 0.5 * one) + 0 * p.position.x");
    let text = text.replace("double =", "one = \"f(0.5)\"\ndouble =");
    assert!((of_named(&text)[0] - 3.5).abs() < 1e-13, "{:?}", of_named(&text));
}

#[test]
fn what_is_wrong_with_a_named_table_is_told() {
    let sound = "points = [0, 1]\nvalues = [0, 2]";
    for (table, value, part) in [
        ("points = [0, 1]\nvalues = [0]", "f(w)", "there are 2 points, but 1 values"),
        ("points = [1, 0]\nvalues = [0, 1]", "f(w)", "must increase"),
        ("values = [1, 2]", "f(w)", "there are 0 points, but 2 values"),
        ("points = [0, 1]\nvalues = [0, \"f(1)\"]", "w", "leads back to itself"),
        ("points = [0, 1]\nvalues = [0, 1]\ninterpolation = \"steps\"\nextrapolation = \"linear\"", "f(w)", "stay constant"),
        ("points = [0, 1]\nvalues = [0, 1]\nextrapolation = \"none\"", "f(w)", "constant"),
        (sound, "f", "is a table: f(x) is its value at x"),
        (sound, "f(p.position)", "is a number, and this is a vector"),
        (sound, "g(w)", "\"g\""),
    ] {
        let told = refused(&named(table, 1.0, value));
        assert!(told.contains(part), "{table}, {value}: {told}");
        assert_eq!(told.lines().count(), 1, "{told}");
    }
    let told = refused(&named(sound, 1.0, "f(w)").replace("double", "f"));
    assert!(told.contains("is taken by"), "{told}");
}
