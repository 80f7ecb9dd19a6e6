//! The public interface is as small as a reader can take in, and is changed on purpose: `public_interface.txt` lists it.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Items beyond which nobody reads the list.
const MOST: usize = 400;

/// The library as rustdoc writes it in JSON.
struct Library(Value);

impl Library {
    fn read() -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("doc").join("costate.json");
        let how = "RUSTC_BOOTSTRAP=1 cargo rustdoc --lib -- -Z unstable-options --output-format json";
        let text = std::fs::read_to_string(&path).unwrap_or_else(|_| panic!("no {}: {how}", path.display()));
        Library(serde_json::from_str(&text).unwrap())
    }

    /// Kind and content of an item, unless it is hidden or of another crate.
    fn item(&self, id: &Value) -> Option<(&str, &Value)> {
        let item = self.0["index"].get(id.to_string())?;
        item["inner"].as_object().unwrap().iter().next().map(|(kind, inner)| (kind.as_str(), inner))
    }

    /// Adds what a path leads to, by the paths that programs write.
    fn add<'l>(&'l self, id: &'l Value, path: &str, items: &mut BTreeMap<String, &'l Value>) {
        match self.item(id) {
            Some(("module", module)) => {
                for child in module["items"].as_array().unwrap() {
                    let (target, name) = match self.item(child) {
                        Some(("use", used)) => (&used["id"], &used["name"]),
                        _ => (child, &self.0["index"][child.to_string()]["name"]),
                    };
                    self.add(target, &format!("{path}::{}", name.as_str().unwrap()), items);
                }
            }
            _ => _ = items.insert(path.to_string(), id),
        }
    }

    /// Items by their paths.
    fn items(&self) -> BTreeMap<String, &Value> {
        let mut items = BTreeMap::new();
        self.add(&self.0["root"], "costate", &mut items);
        items
    }

    /// Inherent methods and constants, and items of traits, of some items.
    fn members(&self, ids: impl Iterator<Item = Value>) -> [usize; 2] {
        let length = |list: &Value| list.as_array().map_or(0, Vec::len);
        let [mut inherent, mut of_traits] = [0, 0];
        for (kind, inner) in ids.filter_map(|id| self.item(&id)) {
            of_traits += if kind == "trait" { length(&inner["items"]) } else { 0 };
            let impls = inner["impls"].as_array().into_iter().flatten().filter_map(|id| self.item(id));
            inherent += impls.filter(|(_, own)| own["trait"].is_null()).map(|(_, own)| length(&own["items"])).sum::<usize>();
        }
        [inherent, of_traits]
    }
}

#[test]
#[ignore = "reads what rustdoc writes: .ci/run"]
fn the_public_interface_is_the_one_listed() {
    let library = Library::read();
    let items = library.items();
    let kind = |id| library.item(id).map_or("use", |(kind, _)| kind);
    let text: String = items.iter().map(|(path, id)| format!("{path} {}\n", kind(id))).collect();
    let distinct: BTreeSet<String> = items.values().map(|id| id.to_string()).collect();
    let [inherent, of_traits] = library.members(distinct.iter().map(|id| serde_json::from_str(id).unwrap()));
    println!(
        "{} items, {} without those named twice, {inherent} inherent, {of_traits} of traits",
        items.len(),
        distinct.len()
    );
    assert!(items.len() <= MOST, "{} public items, at most {MOST}", items.len());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/public_interface.txt");
    if std::env::var_os("COSTATE_WRITE_PAGES").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let listed = std::fs::read_to_string(&path).unwrap_or_default();
    let [listed, found] = [&listed, &text].map(|text| text.lines().collect::<BTreeSet<_>>());
    let [added, gone] = [found.difference(&listed), listed.difference(&found)].map(Vec::from_iter);
    let how = "COSTATE_WRITE_PAGES=1 cargo test --test public_interface -- --ignored writes the list";
    assert!(added.is_empty() && gone.is_empty(), "new: {added:?}, gone: {gone:?}; if that is meant, {how}");
}
