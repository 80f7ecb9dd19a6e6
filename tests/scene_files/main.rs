//! Scenes from files: those of `examples/scenes` against their twins in Rust, wrong files, and files changed at random.

mod arrays;
mod complex_modes;
mod coverage;
mod equilibrium_start;
mod extended;
mod formula_parts;
mod laws;
mod mechanisms;
mod meshes;
mod mode_gradients;
mod mode_limits;
mod mutations;
mod own_parts;
mod periodic_modes;
mod power;
mod program_entries;
mod response;
mod runge_kutta;
mod scenarios;
mod signals;
mod solids;
mod states;
mod steady_start;
mod tables;
mod twins;
mod wrong_files;
mod wrong_meshes;

use costate::scenes::file::OwnParts;
use costate::scenes::{AnyScene, DesignVariable, FileScene, Prepared, built_in, file};
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// The example files, by name.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

fn read(path: &Path) -> FileScene {
    FileScene::read(path).unwrap_or_else(|why| panic!("{why}"))
}

/// Most steps of a run here: what a file and its twin have in common shows in the first ones.
const STEPS: usize = 40;

/// A scene at its initial design with the steps of its own settings, but not more than some.
fn prepared(scene: &dyn AnyScene) -> Prepared<'_> {
    let mut settings = scene.settings();
    let method = Prepared::method_of(&settings).unwrap();
    if settings.steps > STEPS && !method.table.is_static() {
        settings.end *= STEPS as f64 / settings.steps as f64;
        settings.steps = STEPS;
    }
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    Prepared::with(scene, &x, method, settings).unwrap_or_else(|why| panic!("{}: {why}", scene.name()))
}

/// Largest difference of two lists of numbers as a share of the largest number of `of`.
fn difference(a: &[f64], b: &[f64], of: f64) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most, (a, b)| if a == b { most } else { f64::max(most, (a - b).abs() / of) })
}

fn size(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |most: f64, own| most.max(own.abs()))
}

/// Design variables with the letters that a number of the file and a constant of the program may differ by in their last digit left out.
fn same_variables(a: &[DesignVariable], b: &[DesignVariable]) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-15 * a.abs().max(b.abs());
    a.len() == b.len()
        && a.iter().all(|a| {
            let Some(b) = b.iter().find(|b| b.name == a.name) else { return false };
            let bounds = near(a.lower, b.lower) && near(a.upper, b.upper);
            a.name == b.name && a.unit == b.unit && near(a.initial, b.initial) && bounds
        })
}

/// Holds a file against its twin: parts and numbers, functionals and gradients.
fn compare(path: &Path) {
    let scene = read(path);
    let name = scene.name();
    assert_eq!(path.file_stem().unwrap().to_str().unwrap(), name, "the name of the file and of the scene");
    let twin = built_in::all().into_iter().find(|twin| twin.name() == name);
    let Some(twin) = twin else {
        // a file without a twin: its gradient is checked by complex step
        let prepared = prepared(&scene);
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap();
        let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
        let reference = analysis.complex_step(&prepared.x, &forward).unwrap();
        for (own, other) in adjoint.rows.iter().zip(&reference.rows) {
            let largest = costate::sensitivity::largest_difference(other, own);
            assert!(largest < 1e-9, "{name}: {largest:.1e}");
        }
        return;
    };
    assert_eq!(scene.summary(), twin.summary(), "{name}");
    let (variables, others) = (scene.variables(), twin.variables());
    assert!(same_variables(&variables, &others), "{name}: {variables:?}\n{others:?}");
    assert_eq!(scene.settings(), twin.settings(), "{name}");
    assert_eq!(scene.optimization_problem(), twin.optimization_problem(), "{name}");
    let (own, other) = (prepared(&scene), prepared(&*twin));

    // the same parts, with the same numbers but for roundings of other orders of the same operations
    let parts = |prepared: &Prepared| {
        let model = prepared.model();
        let mut parts: Vec<String> = model.nodes.iter().map(|node| format!("node {} {:?}", node.name, node.kind)).collect();
        parts.extend(model.constraints.iter().map(|joint| format!("joint {}", joint.name)));
        parts.push(format!("{} elements", model.elements.len()));
        parts.extend(prepared.functionals().iter().map(|own| format!("functional {} [{}]", own.name, own.value_unit())));
        parts.sort();
        parts
    };
    assert_eq!(parts(&own), parts(&other), "{name}");

    let runs = [&own, &other].map(|prepared| {
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{name}: {why}"));
        let gradient = analysis.adjoint(&prepared.x, &forward).unwrap_or_else(|why| panic!("{name}: {why}"));
        (forward.values, gradient.rows)
    });
    let [(values, rows), (twin_values, twin_rows)] = &runs;
    let place = |prepared: &Prepared, functional: &str| {
        prepared.functionals().iter().position(|own| own.name == functional).unwrap()
    };
    let of_variable = |name: &str| variables.iter().position(|own| own.name == name).unwrap();
    let (mut same, mut worst) = (true, 0.0_f64);
    for functional in own.functionals() {
        let (here, there) = (place(&own, &functional.name), place(&other, &functional.name));
        // loops in a file put its variables in another order
        let in_order: Vec<f64> = others.iter().map(|own| rows[here][of_variable(&own.name)]).collect();
        let row = difference(&in_order, &twin_rows[there], size(&twin_rows[there]));
        // a value may pass through zero: what its variables can change it by is its size then
        let reach: f64 = twin_rows[there].iter().zip(&other.x).map(|(row, x)| (row * x).abs()).sum();
        let value = difference(&values[here..=here], &twin_values[there..=there], twin_values[there].abs().max(reach));
        same &= values[here] == twin_values[there] && in_order == twin_rows[there];
        worst = worst.max(row).max(value);
    }
    println!("{name}: {}", if same { "the same to the last bit".into() } else { format!("{worst:.1e}") });
    if worst > SAME {
        // nodes in another order are eliminated in another order, and stiff members make much of a rounding: as much as one of the design
        // variables may make
        let limit = other.gradient_limits(SAME).unwrap().into_iter().fold(0.0, f64::max);
        assert!(
            worst <= limit,
            "{name}: functionals or gradients differ by {worst:.1e}, roundings of the variables by {limit:.1e}"
        );
    }
}

/// By how much a file may differ from its twin, in shares of the largest derivative of each functional.
const SAME: f64 = 1e-12;

#[test]
fn files_give_the_functionals_and_gradients_of_their_twins() {
    let files = files();
    assert!(files.len() >= 2, "{files:?}");
    // one after the other, as each runs on all processors; a name on the command line asks for one
    let wanted = std::env::var("SCENE_FILE").ok();
    let chosen = files.iter().filter(|path| wanted.as_ref().is_none_or(|own| path.to_string_lossy().contains(&**own)));
    chosen.for_each(|path| compare(path));
}

/// What parts of files on the pages leave out.
const REST: &str = r#"version = 1
gravity = [0, -9.81, 0]
settings = { end = 1e-3, steps = 2 }
material.aluminium = { young = 70e9, poisson = 0.33, density = 2700 }
functional = [{ name = "mass", type = "mass", of = "bracket", over = "initial" }]

"#;

#[test]
fn the_examples_of_the_pages_are_files_that_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = std::fs::read_dir(root.join("src/guide")).unwrap().map(|entry| entry.unwrap().path());
    let pages = guide.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    let mut count = 0;
    for path in pages.chain([root.join("README.md"), root.join("src/scenes/file/format.md")]) {
        let text = std::fs::read_to_string(&path).unwrap();
        let page = &path.display().to_string();
        for block in text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()) {
            count += 1;
            // parts of a file, of which the rest is always the same
            let whole = match block.contains("version = 1") {
                true => block.to_string(),
                false => format!("{REST}{block}"),
            };
            // beside the files that it names
            let place = root.join("examples/scenes").join(path.with_extension("toml").file_name().unwrap());
            let scene = FileScene::parse(&place.display().to_string(), &whole).unwrap_or_else(|why| panic!("{why}"));
            let prepared = prepared(&scene);
            let analysis = prepared.analysis();
            let forward = analysis.forward(&prepared.x).unwrap();
            let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
            let reference = analysis.complex_step(&prepared.x, &forward).unwrap();
            let largest = costate::sensitivity::largest_difference(&reference.rows[0], &adjoint.rows[0]);
            assert!(largest < 1e-12 && size(&adjoint.rows[0]) > 0.0, "{page}: {largest:.1e}");
        }
    }
    assert!(count >= 6, "only {count} files");
}

/// Holds a file against the text that belongs into it.
fn kept(path: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("COSTATE_WRITE_PAGES").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let how = "COSTATE_WRITE_PAGES=1 cargo test --release --test scene_files the_ writes it";
    assert!(std::fs::read_to_string(&path).unwrap() == text, "{} is old: {how}", path.display());
}

#[test]
fn the_reference_page_is_what_the_reader_knows() {
    kept("src/scenes/file/reference.md", &file::reference());
}

#[test]
fn the_published_schema_is_the_one_of_the_reader() {
    let schema = serde_json::to_string_pretty(&file::schema(&OwnParts::default())).unwrap();
    kept("examples/scenes/schema.json", &format!("{schema}\n"));
    let printed = std::process::Command::new(env!("CARGO_BIN_EXE_costate")).arg("schema").output().unwrap();
    assert_eq!(String::from_utf8(printed.stdout).unwrap(), format!("{schema}\n"));
}

/// Whether a value agrees with a schema, as far as those of this crate go.
fn agrees(whole: &serde_json::Value, schema: &serde_json::Value, value: &serde_json::Value) -> bool {
    use serde_json::Value;
    let agrees = |schema: &Value, value: &Value| agrees(whole, schema, value);
    let Some(rules) = schema.as_object() else { return schema.as_bool().unwrap_or(true) };
    rules.iter().all(|(rule, of)| match rule.as_str() {
        "$ref" => agrees(whole.pointer(of.as_str().unwrap().trim_start_matches('#')).unwrap(), value),
        "anyOf" => of.as_array().unwrap().iter().any(|own| agrees(own, value)),
        "oneOf" => of.as_array().unwrap().iter().filter(|own| agrees(own, value)).count() == 1,
        "const" => of == value,
        "enum" => of.as_array().unwrap().contains(value),
        "type" => match of.as_str().unwrap() {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "number" => value.is_number(),
            "integer" => value.is_i64() || value.is_u64(),
            "boolean" => value.is_boolean(),
            other => panic!("type {other}"),
        },
        "required" => value
            .as_object()
            .is_none_or(|own| of.as_array().unwrap().iter().all(|key| own.contains_key(key.as_str().unwrap()))),
        "properties" => value
            .as_object()
            .is_none_or(|own| own.iter().all(|(key, value)| of.get(key).is_none_or(|schema| agrees(schema, value)))),
        "additionalProperties" => value.as_object().is_none_or(|own| {
            let known = |key: &String| rules.get("properties").is_some_and(|known| known.get(key).is_some());
            own.iter().filter(|(key, _)| !known(key)).all(|(_, value)| *of != Value::Bool(false) && agrees(of, value))
        }),
        "items" => match value.as_array() {
            Some(list) if !rules.contains_key("prefixItems") => list.iter().all(|own| agrees(of, own)),
            _ => true,
        },
        "prefixItems" => value.as_array().is_none_or(|list| {
            let all = of.as_array().unwrap();
            list.len() <= all.len() && list.iter().zip(all).all(|(own, schema)| agrees(schema, own))
        }),
        "minItems" => value.as_array().is_none_or(|list| list.len() as u64 >= of.as_u64().unwrap()),
        "maxItems" => value.as_array().is_none_or(|list| list.len() as u64 <= of.as_u64().unwrap()),
        "minProperties" => value.as_object().is_none_or(|own| own.len() as u64 >= of.as_u64().unwrap()),
        "minimum" => value.as_f64().is_none_or(|own| own >= of.as_f64().unwrap()),
        "maximum" => value.as_f64().is_none_or(|own| own <= of.as_f64().unwrap()),
        "exclusiveMinimum" => value.as_f64().is_none_or(|own| own > of.as_f64().unwrap()),
        "pattern" => value.as_str().is_none_or(|own| own.contains('{')),
        "description" | "title" | "$schema" | "$defs" => true,
        other => panic!("rule {other}"),
    })
}

fn as_json(value: &DeValue) -> serde_json::Value {
    match value {
        DeValue::String(own) => own.to_string().into(),
        DeValue::Integer(own) => own.as_str().replace('_', "").parse::<i64>().unwrap().into(),
        DeValue::Float(own) => own.as_str().replace('_', "").parse::<f64>().unwrap().into(),
        DeValue::Boolean(own) => (*own).into(),
        DeValue::Datetime(own) => own.to_string().into(),
        DeValue::Array(list) => list.iter().map(|own| as_json(own.get_ref())).collect(),
        DeValue::Table(table) => {
            table.iter().map(|(key, own)| (key.get_ref().to_string(), as_json(own.get_ref()))).collect()
        }
    }
}

#[test]
fn the_schema_accepts_the_example_files_and_refuses_wrong_keys() {
    let schema = file::schema(&OwnParts::default());
    for path in files() {
        let text = std::fs::read_to_string(&path).unwrap();
        let value = as_json(&DeValue::Table(DeTable::parse(&text).unwrap().into_inner()));
        assert!(agrees(&schema, &schema, &value), "{}", path.display());
        // what changes another file may be any part of it
        if value.get("extends").is_some() {
            continue;
        }
        for (key, own) in value.as_object().unwrap() {
            let rule = &schema["oneOf"][0]["properties"][key];
            let entries = own.as_array().filter(|_| rule["type"] == "array");
            match entries {
                Some(list) => list
                    .iter()
                    .for_each(|own| assert!(agrees(&schema, &rule["items"], own), "{}: {key}: {own}", path.display())),
                None => assert!(agrees(&schema, rule, own), "{}: {key}: {own}", path.display()),
            }
        }
        let mut wrong = value.clone();
        wrong["settings"]["stpes"] = 3.into();
        assert!(!agrees(&schema, &schema, &wrong), "{}", path.display());
    }
}
