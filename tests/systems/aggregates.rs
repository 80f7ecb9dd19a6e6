//! Largest values: bounds from above, and sharpness by a size.

use costate::integrators::tables;
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};

/// A pendulum on a spring, with functionals of this text.
fn pendulum(functionals: &str) -> Result<FileScene, String> {
    let text = r#"
version = 1
name = "pendulum"
gravity = [0, 0, -9.81]
settings = { end = 0.8, steps = 40 }
variable.mass = { initial = 2, bounds = [0.1, 10], unit = "kg" }
point = [{ name = "bob", position = [1, 0, -0.3], mass = "mass" }, { name = "other", position = [-0.5, 0, 0.4], mass = 1 }]
joint = [
    { name = "rod", type = "distance", between = ["ground", "bob"] },
    { name = "second", type = "distance", between = ["bob", "other"] },
]
"#;
    FileScene::parse("pendulum.toml", &format!("{text}{functionals}"))
}

fn functional(name: &str, over: &str) -> String {
    format!("[[functional]]\nname = \"{name}\"\ntype = \"reaction\"\njoint = \"rod\"\nweights = [1]\nover = {over}\n")
}

/// Values of functionals, largest values, and whether adjoint and complex step agree.
fn run(scene: &FileScene, method: Method) -> (Vec<f64>, Vec<f64>, usize) {
    let x: Vec<f64> = AnyScene::variables(scene).iter().map(|variable| variable.initial).collect();
    let prepared = Prepared::with(scene, &x, method.clone(), AnyScene::settings(scene).without_method()).expect("sound");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).expect("runs");
    let (adjoint, complex) =
        (analysis.adjoint(&x, &forward).expect("a gradient"), analysis.complex_step(&x, &forward).expect("one"));
    for (own, other) in adjoint.rows.iter().flatten().zip(complex.rows.iter().flatten()) {
        assert!((own - other).abs() <= 1e-11 * other.abs().max(1.0), "{}: {own} {other}", method.table.name);
    }
    let largest = forward.extremes.iter().map(|own| own.as_ref().expect("an aggregate").largest.value).collect();
    let stages = method.table.stages.len().max(method.table.quadrature.stages.len());
    (forward.values, largest, stages * forward.grid.steps())
}

#[test]
fn an_upper_maximum_is_above_the_largest_value_by_at_most_its_bound() {
    let over = |more: &str| format!("{{ aggregate = \"upper_maximum\", {more} }}");
    let text = [over("sharpness = 0.5"), over("sharpness = 20"), over("sharpness = 200, size = 10")];
    let text: String = text.iter().enumerate().map(|(k, over)| functional(&format!("f{k}"), over)).collect();
    let scene = pendulum(&text).expect("sound");
    for table in tables().into_iter().filter(|table| !table.is_static()) {
        let name = table.name.clone();
        let (values, largest, samples) = run(&scene, Method::new(table, ConstraintLevel::Acceleration));
        for ((value, largest), sharpness) in values.iter().zip(&largest).zip([0.5, 20.0, 20.0]) {
            let above = value - largest;
            let bound = (samples as f64).ln() / sharpness;
            assert!((0.0..=bound).contains(&above), "{name}, {sharpness}: {value} for {largest}, {bound} allowed");
        }
        // a sharpness by a size is the same number
        assert_eq!(values[1], values[2], "{name}");
    }
}

#[test]
fn what_bounds_nothing_and_what_has_no_effect_is_refused() {
    for (over, says) in [
        ("{ aggregate = \"upper_maximum\", sharpness = 1, continuous = true }", "bounds nothing"),
        ("{ aggregate = \"upper_maximum\", sharpness = 1, normalized = true }", "normalized"),
        ("{ aggregate = \"power\", sharpness = 4, size = 3 }", "size"),
        ("{ aggregate = \"upper_maximum\", sharpness = 1, size = 0 }", "size"),
    ] {
        let scene = pendulum(&functional("f", over));
        let error = match &scene {
            Ok(scene) => AnyScene::build_real(scene, &[2.0]).err().expect(over),
            Err(error) => error.clone(),
        };
        assert!(error.contains(says), "{over}: {error}");
    }
    let power = Aggregate::new(AggregateKind::Power, 4.0).relative_to(3.0);
    assert!(power.sharpness.is_nan() && Aggregate::upper_maximum(4.0).relative_to(8.0).sharpness == 0.5);
}
