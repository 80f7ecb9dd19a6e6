//! Scenes from files: those of `examples/scenes`, wrong files, and files changed at random.

mod arrays;
mod complex_modes;
mod coverage;
mod equilibrium_start;
mod extended;
mod fit;
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
mod wrong_files;
mod wrong_meshes;

use costate::scenes::file::OwnParts;
use costate::scenes::{AnyScene, FileScene, Prepared, built_in, file};
use costate::sensitivity::largest_difference;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// The example files, by name.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("examples/scenes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

/// A text as a scene.
fn parsed(text: &str) -> FileScene {
    from_root();
    FileScene::parse("scene.toml", text).unwrap_or_else(|why| panic!("{why}"))
}

/// Scenes of these tests name their files from the root of the repository.
fn from_root() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).unwrap());
}

/// What is said of a scene that cannot be run.
fn refused(text: &str) -> String {
    from_root();
    let scene = match FileScene::parse("scene.toml", text) {
        Ok(scene) => scene,
        Err(why) => return why,
    };
    let run = Prepared::new(&scene).and_then(|prepared| prepared.analysis().forward(&prepared.x).map(drop));
    run.err().map_or_else(|| "nothing was found".into(), |why| why.to_string())
}

/// A scene at its initial design with few steps of its own settings, the fewer the more design variables it has.
fn prepared(scene: &dyn AnyScene) -> Prepared<'_> {
    let mut settings = scene.settings();
    let method = Prepared::method_of(&settings).unwrap();
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let steps = (400 / x.len()).clamp(2, 40);
    if settings.steps > steps && !method.table.is_static() {
        settings.end *= steps as f64 / settings.steps as f64;
        settings.steps = steps;
    }
    Prepared::with(scene, &x, method, settings).unwrap_or_else(|why| panic!("{}: {why}", scene.name()))
}

fn size(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |most: f64, own| most.max(own.abs()))
}

#[test]
fn gradients_of_the_example_scenes_are_those_of_complex_steps() {
    let mut untold = Vec::new();
    for name in built_in::names() {
        let prepared = prepared(built_in::named(name).unwrap());
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{name}: {why}"));
        let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap_or_else(|why| panic!("{name}: {why}"));
        let reference = analysis.complex_step(&prepared.x, &forward).unwrap();
        let apart: Vec<f64> = adjoint.rows.iter().zip(&reference.rows).map(|(a, b)| largest_difference(b, a)).collect();
        println!("{name}: {:.1e}", size(&apart));
        if size(&apart) > EXACT {
            // stiff members make much of a rounding: as much as one of the design variables may make
            match prepared.gradient_limits(EXACT) {
                Ok(limits) => {
                    let is_within = |(apart, limit): (&f64, &f64)| apart <= limit;
                    assert!(apart.iter().zip(&limits).all(is_within), "{name}: {apart:?}, limits {limits:?}");
                }
                Err(why) => {
                    assert!(why.to_string().contains("agreement shows nothing"), "{name}: {why}");
                    untold.push(name);
                }
            }
        }
    }
    // the axial force of a beam that is stiff along its line
    assert!(untold.len() <= 4, "{untold:?}");
}

/// By how much gradients may differ from complex steps, in shares of the largest derivative of each functional.
const EXACT: f64 = 1e-10;

/// What parts of files on the pages leave out.
const REST: &str = r#"version = 1
gravity = [0, -9.81, 0]
settings = { end = 1e-3, steps = 2 }
material.aluminium = { young = 70e9, poisson = 0.33, density = 2700 }
functional = [{ name = "mass", type = "mass", of = "bracket", over = "initial" }]

"#;

#[test]
fn the_examples_of_the_pages_are_files_that_run() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
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
            let largest = largest_difference(&reference.rows[0], &adjoint.rows[0]);
            assert!(largest < 1e-12 && size(&adjoint.rows[0]) > 0.0, "{page}: {largest:.1e}");
        }
    }
    assert!(count >= 6, "only {count} files");
}

/// Holds a file against the text that belongs into it.
fn kept(path: &str, text: &str) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(path);
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
fn the_printed_schema_is_the_one_of_the_reader() {
    let schema = serde_json::to_string_pretty(&file::schema(&OwnParts::default())).unwrap();
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
