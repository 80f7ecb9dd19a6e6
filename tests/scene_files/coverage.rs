//! Everything that a file can say is said somewhere, builds, and has gradients that a complex step confirms.

use costate::scenes::file::OwnParts;
use costate::scenes::{AnyScene, FileScene, Prepared, file};
use costate::sensitivity::largest_difference;
use serde_json::Value;
use std::collections::BTreeSet;
use toml::de::{DeTable, DeValue};

/// Files that say what the examples do not.
const FILES: &[(&str, &str)] = &[
    ("bodies and joints", include_str!("coverage/joints.toml")),
    ("loads and springs", include_str!("coverage/loads.toml")),
    ("laws of springs", include_str!("coverage/laws.toml")),
    ("contacts that give way", include_str!("coverage/contacts.toml")),
    ("coordinates", include_str!("coverage/coordinates.toml")),
    ("beams and cables", include_str!("coverage/members.toml")),
    ("shells", include_str!("coverage/shells.toml")),
    ("meshes", include_str!("coverage/meshes.toml")),
    ("a start from equilibrium", include_str!("coverage/equilibrium.toml")),
    ("a start from a steady turn", include_str!("coverage/steady.toml")),
    ("bodies of solids", include_str!("coverage/solids.toml")),
    ("events and stops", include_str!("coverage/events.toml")),
    ("friction and contacts", include_str!("coverage/friction.toml")),
    ("rolling", include_str!("coverage/rolling.toml")),
    ("measurements", include_str!("coverage/fit.toml")),
    ("soft joints, tapered beams, profiles", include_str!("coverage/soft.toml")),
];

/// What tables at these keys are called among the definitions of the schema: they are the same wherever they stand.
const TABLES: [(&str, &str); 19] = [
    ("arc", "arc"),
    ("constraint", "constraint"),
    ("linear", "linear"),
    ("prior", "prior"),
    ("plies", "plies"),
    ("held", "held"),
    ("solids", "solids"),
    ("parts", "parts"),
    ("walls", "walls"),
    ("nodes", "nodes"),
    ("force", "a table of s"),
    ("moment", "a table of s"),
    ("energy", "a table of s"),
    ("size", "a function of time"),
    ("angle", "a function of time"),
    ("displacement", "a function of time"),
    ("over", "an aggregate"),
    ("motion", "motion"),
    ("orientation", "orientation"),
];

/// Paths of all keys that a schema allows: `joint.revolute.axis`, `driver.translation.displacement.sine.phase`.
fn allowed(whole: &Value, schema: &Value, path: &str, found: &mut BTreeSet<String>) {
    if let Some(place) = schema["$ref"].as_str() {
        let name = place.rsplit('/').next().unwrap();
        return allowed(whole, whole.pointer(place.trim_start_matches('#')).unwrap(), name, found);
    }
    if let Some(list) = schema["oneOf"].as_array().or(schema["anyOf"].as_array()) {
        list.iter().for_each(|own| allowed(whole, own, path, found));
    }
    if schema["items"].is_object() {
        allowed(whole, &schema["items"], path, found);
    }
    let Some(properties) = schema["properties"].as_object() else { return };
    let form = properties.get("type").and_then(|own| own["const"].as_str()).map_or(String::new(), |own| format!(".{own}"));
    for (key, own) in properties {
        let path = format!("{path}{form}.{key}");
        found.insert(path.clone());
        allowed(whole, own, &path, found);
    }
}

/// Paths of all keys that a file gives.
fn given(value: &DeValue, path: &str, found: &mut BTreeSet<String>) {
    match value {
        DeValue::Array(list) => list.iter().for_each(|own| given(own.get_ref(), path, found)),
        DeValue::Table(table) => {
            let form = table.iter().find(|own| own.0.get_ref() == "type").and_then(|own| own.1.get_ref().as_str());
            let form = form.map_or(String::new(), |own| format!(".{own}"));
            for (key, own) in table.iter() {
                let path = format!("{path}{form}.{}", key.get_ref());
                let table = TABLES
                    .iter()
                    .find(|own| own.0 == key.get_ref())
                    .filter(|_| own.get_ref().is_table() || own.get_ref().is_array());
                given(own.get_ref(), table.map_or(path.as_str(), |own| own.1), found);
                found.insert(path);
            }
        }
        _ => {}
    }
}

#[test]
fn every_key_of_the_format_is_used_in_a_file_that_is_tested() {
    let schema = file::schema(&OwnParts::default());
    let (mut wanted, mut used) = (BTreeSet::new(), BTreeSet::new());
    let named = ["variable", "table", "material", "section", "laminate"];
    for (section, own) in schema["oneOf"][0]["properties"].as_object().unwrap() {
        let own = if named.contains(&section.as_str()) { &own["additionalProperties"] } else { own };
        allowed(&schema, own, section, &mut wanted);
    }
    let mut texts: Vec<String> = super::files().iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    texts.extend(FILES.iter().map(|own| own.1.to_string()));
    for text in &texts {
        let table = DeTable::parse(text).unwrap().into_inner();
        for (section, own) in table.iter() {
            let section = section.get_ref().to_string();
            match own.get_ref() {
                DeValue::Table(entries) if named.contains(&section.as_str()) => {
                    entries.iter().for_each(|(_, own)| given(own.get_ref(), &section, &mut used));
                }
                own => given(own, &section, &mut used),
            }
        }
    }
    // what all types of a section have needs no file for each of them; a loop stands in any entry
    let parts = |path: &str| path.split('.').map(String::from).collect::<Vec<_>>();
    let everywhere = |path: &str| {
        let own = parts(path);
        let alike = |other: &&String| {
            let other = parts(other);
            own.len() == 3 && other.len() == 3 && own[0] == other[0] && own[2] == other[2]
        };
        let types: BTreeSet<String> = wanted
            .iter()
            .map(|own| parts(own))
            .filter(|of| of.len() == 3 && of[0] == own[0])
            .map(|of| of[1].clone())
            .collect();
        let is_common = wanted.iter().filter(alike).count() == types.len();
        path.ends_with(".for") || is_common && used.iter().any(|own| alike(&own))
    };
    let missing: Vec<&String> = wanted.difference(&used).filter(|path| !everywhere(path)).collect();
    assert!(
        wanted.len() > 400 && missing.is_empty(),
        "{} of {} keys are used nowhere: {missing:#?}",
        missing.len(),
        wanted.len()
    );
}

#[test]
fn gradients_of_everything_that_a_file_can_say_are_those_of_a_complex_step() {
    super::from_root();
    for (name, text) in FILES {
        let scene = FileScene::parse(&format!("{name}.toml"), text).unwrap_or_else(|why| panic!("{why}"));
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
        assert!(!scene.variables().is_empty() && !prepared.functionals().is_empty(), "{name}");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{name}: {why}"));
        let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
        let reference = analysis.complex_step(&prepared.x, &forward).unwrap();
        let mut moved = vec![false; prepared.x.len()];
        for (k, functional) in prepared.functionals().iter().enumerate() {
            let difference = largest_difference(&reference.rows[k], &adjoint.rows[k]);
            // what no change of a variable by its size changes is round-off
            let pairs = reference.rows[k].iter().zip(&adjoint.rows[k]).zip(&prepared.x);
            let apart = pairs.fold(0.0, |most: f64, ((a, b), x)| most.max(((a - b) * x).abs()));
            let is_round_off = apart <= 1e-12 * forward.values[k].abs();
            assert!(difference <= 1e-10 || is_round_off, "{name}, {}: {difference:.1e}", functional.name);
            moved.iter_mut().zip(&adjoint.rows[k]).for_each(|(moved, own)| *moved |= *own != 0.0);
        }
        // no variable is lost on the way
        let lost: Vec<&str> =
            prepared.variables.iter().zip(moved).filter(|own| !own.1).map(|own| own.0.name.as_str()).collect();
        assert!(lost.is_empty(), "{name}: nothing depends on {lost:?}");
    }
}
