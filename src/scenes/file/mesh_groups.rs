//! Groups of faces and node sets that a scene file adds to a mesh: by numbers, or by a condition on the place.

use super::condition::Condition;
use super::formula::{Formula, Scope};
use super::raw::{KeyValue, Raw, RawValue};
use super::reader::Reader;
use crate::scenes::MeshData;
use std::collections::HashMap;
use std::sync::Arc;

/// Keys for what is selected, and what it consists of.
const SELECTED: [(&str, &str); 2] = [("groups", "face"), ("node_sets", "node")];

/// What can be selected: faces by the middles of their corners, or the nodes of faces.
struct Candidates {
    /// What one is called.
    word: &'static str,
    numbers: Vec<usize>,
    places: Vec<[f64; 3]>,
    /// Which a condition may select.
    used: Vec<bool>,
}

impl Candidates {
    fn of(data: &MeshData, word: &'static str) -> Self {
        let (numbers, places, used) = match word {
            "face" => (
                &data.face_numbers,
                data.faces.iter().map(|face| middle(data, face)).collect(),
                vec![true; data.faces.len()],
            ),
            _ => (&data.point_numbers, data.points.clone(), data.used()),
        };
        Candidates { word, numbers: numbers.clone(), places, used }
    }

    /// Those where a condition holds.
    fn where_holds(&self, condition: &Condition, text: &str) -> Result<Vec<usize>, String> {
        let used = || self.places.iter().enumerate().filter(|(place, _)| self.used[*place]);
        if let Some((place, _)) = used().find(|(_, at)| at.iter().any(|own| !own.is_finite())) {
            let (word, number) = (self.word, self.numbers[place]);
            return Err(format!(
                "\"{text}\": the place of {word} {number} depends on names: conditions select among points of numbers"
            ));
        }
        let selected: Vec<usize> = used().filter(|(_, at)| condition.holds(**at)).map(|(place, _)| place).collect();
        if !selected.is_empty() {
            return Ok(selected);
        }
        let extent = |axis: usize| {
            let all = used().map(|(_, at)| at[axis]);
            let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), own| (a.min(own), b.max(own)));
            format!("{} from {least} to {most}", ["x", "y", "z"][axis])
        };
        let extents = [0, 1, 2].map(extent).join(", ");
        let of = if self.word == "face" { "middles of faces have" } else { "nodes have" };
        Err(format!("\"{text}\" selects no {}: {of} {extents}, before scale, orientation and position", self.word))
    }

    /// Those with some numbers.
    fn numbered(&self, numbers: &[Raw]) -> Result<Vec<usize>, String> {
        let places: HashMap<usize, usize> =
            self.numbers.iter().enumerate().map(|(place, &number)| (number, place)).collect();
        let wholes = numbers.iter().filter_map(|own| match own.value {
            // what is no whole number is told where values are checked
            RawValue::Number { value, whole: true } if value >= 0.0 => Some(value as usize),
            _ => None,
        });
        let place = |number: usize| {
            places.get(&number).copied().ok_or_else(|| {
                let [least, most] = [self.numbers.iter().min(), self.numbers.iter().max()].map(|own| own.unwrap_or(&0));
                let word = self.word;
                format!("names {word} {number}, which is not there; {word}s are numbered from {least} to {most}")
            })
        };
        wholes.map(place).collect()
    }
}

/// Mean of the corners of a face.
fn middle(data: &MeshData, face: &[usize]) -> [f64; 3] {
    let corners = &face[..face.len().min(if matches!(face.len(), 3 | 6) { 3 } else { 4 })];
    let mean =
        |axis: usize| corners.iter().map(|&point| data.points.get(point).map_or(f64::NAN, |own| own[axis])).sum::<f64>();
    [0, 1, 2].map(|axis| mean(axis) / corners.len() as f64)
}

impl Reader {
    /// The mesh with the groups and node sets that its entry adds; `None` if something is wrong with them, which is told.
    pub(super) fn with_groups(&mut self, raw: &Raw, mut data: Arc<MeshData>) -> Option<Arc<MeshData>> {
        let before = self.mistakes.len();
        for (key, word) in SELECTED {
            let Some(entries) = raw.get(key).and_then(Raw::table) else { continue };
            let candidates = Candidates::of(&data, word);
            for entry in entries {
                let Some(places) = self.selected(entry, key, &candidates) else { continue };
                let own = Arc::make_mut(&mut data);
                let named = if key == "groups" { &mut own.groups } else { &mut own.node_sets };
                if named.iter().any(|other| other.0 == entry.key) {
                    let text = format!("{key}: the file of the mesh has \"{}\" already; take another name", entry.key);
                    self.wrong(entry.at, text);
                    continue;
                }
                named.push((entry.key.clone(), places));
            }
        }
        (self.mistakes.len() == before).then_some(data)
    }

    /// Places of what an entry selects; `None` if that is told already, or will be where values are checked.
    fn selected(&mut self, entry: &KeyValue, key: &str, candidates: &Candidates) -> Option<Vec<usize>> {
        let KeyValue { key: name, value, .. } = entry;
        let selected = match &value.value {
            RawValue::List(numbers) => candidates.numbered(numbers),
            RawValue::Text(text, origin) => match origin.formula(text).and_then(Condition::parse) {
                Ok(condition) => candidates.where_holds(&condition, text),
                Err((inside, why)) => {
                    let at = origin.place().map_or(value.at, |at| at + inside);
                    return self.refuse(at, format!("\"{name}\" of {key}, \"{text}\": {why}"));
                }
            },
            _ => return None,
        };
        selected.map_err(|why| self.wrong(value.at, format!("\"{name}\" of {key}: {why}"))).ok()
    }
}

/// A point of numbers or formulas of numbers; not a number where it depends on names.
pub(super) fn fixed_point(raw: &Raw) -> [f64; 3] {
    let fixed = |raw: &Raw| match &raw.value {
        RawValue::Number { value, .. } => vec![*value],
        RawValue::Text(..) => {
            let value = raw.formula().and_then(|own| Formula::parse(own, &Scope::default()).ok()?.constant());
            value.map_or_else(Vec::new, |own| own.components())
        }
        _ => Vec::new(),
    };
    let components: Vec<f64> = raw.one_or_more().iter().flat_map(fixed).collect();
    components.try_into().unwrap_or([f64::NAN; 3])
}
