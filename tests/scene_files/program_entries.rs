//! Entries that a program gives, with its places.

use costate::scenes::file::OwnParts;
use costate::scenes::{FileScene, Prepared};
use serde_json::{Value, json};

fn entries() -> Value {
    json!({
        "": ["swing.toml", "swing.py, line 3", "swing.py, line 4", "swing.py, line 5"],
        "version": 1,
        "gravity": [0, -9.81, 0],
        "define": {"half": {"": 1, "=": "length / 2"}},
        "variable": {"length": {"initial": 1.0, "bounds": [0.1, 10], "unit": "m"}},
        "settings": {"end": 0.3, "steps": 30},
        "point": [{"": 2, "name": "bob \"1\"", "position": ["-2 * half", 0, 0], "mass": 1e-3}],
        "joint": [{"": 3, "name": "rod", "type": "distance", "between": ["ground", "bob \"1\""]}],
        "functional": [{"name": "height", "type": "position", "on": "bob \"1\"", "direction": [0, 1, 0], "over": "terminal"}],
    })
}

fn values(scene: &FileScene) -> Vec<f64> {
    Prepared::new(scene).unwrap().run().unwrap().forward.values
}

#[test]
fn they_make_the_scene_of_the_file_that_is_written_of_them() {
    let own = FileScene::of_entries("swing.toml", &entries(), &OwnParts::default()).unwrap_or_else(|why| panic!("{why}"));
    let text = FileScene::text_of(&entries());
    let written = FileScene::parse("swing.toml", &text).unwrap_or_else(|why| panic!("{why}\n{text}"));
    assert_eq!(values(&own), values(&written));
    assert!(text.contains("\n[[point]]\nname = \"bob \\\"1\\\"\"\n") && text.contains("\n[variable.length]\n"), "{text}");
}

#[test]
fn mistakes_are_told_at_the_places_of_the_program() {
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut entries = entries();
        change(&mut entries);
        FileScene::of_entries("swing.toml", &entries, &OwnParts::default()).map(drop).unwrap_err()
    };
    let told = refused(&|own| own["point"][0]["mass"] = json!("lenght"));
    assert!(told.starts_with("swing.py, line 4: ") && told.contains("did you mean \"length\""), "{told}");
    let told = refused(&|own| own["define"]["half"]["="] = json!([1, 2]));
    assert!(told.starts_with("swing.py, line 3: half of [define]"), "{told}");
    let told = refused(&|own| own["joint"][0]["axis"] = json!([0, 0, 1]));
    assert!(told.starts_with("swing.py, line 5: ") && told.contains("\"axis\""), "{told}");
    let told = refused(&|own| own["settings"]["end"] = json!(-1));
    assert!(told.starts_with("swing.toml: end of [settings]"), "{told}");
}
