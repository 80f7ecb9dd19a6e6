use super::own_parts::OwnParts;
use super::reader::all_forms;
use super::reference::{is_listed, same, tables};
use super::scenarios::SCENARIO;
use super::section::Shape;
use super::sections::{DEFINE, FOR, SECTIONS, TOP};
use crate::elements::entries::{Forms, Key, Range, Type};
use serde_json::{Map, Value, json};

/// The JSON schema of scene files, from which editors complete and check them, with parts of one's own. It is made of the tables by which
/// files are read.
pub fn schema(parts: &OwnParts) -> Value {
    let mut properties = Map::new();
    for key in TOP.forms[0].keys {
        properties.insert(key.name.into(), of_key(key));
    }
    let quantity = json!({"anyOf": [formula(Range::Any), part("vector")]});
    properties.insert(DEFINE.0.into(), json!({"type": "object", "description": DEFINE.1, "additionalProperties": quantity}));
    for section in SECTIONS {
        let own = table(&section.forms, section.shape != Shape::Once, parts);
        let mut own = match section.shape {
            Shape::Once => own,
            Shape::Named => json!({"type": "object", "additionalProperties": own}),
            Shape::Listed => json!({"type": "array", "items": own}),
        };
        own["description"] = section.doc.into();
        properties.insert(section.name.into(), own);
    }
    let scenario = json!({
        "type": "array",
        "description": "Circumstances in which the scene is run: its keys are what each changes of the file.",
        "items": {"type": "object", "properties": {"name": {"type": "string"}}, "required": ["name"], "additionalProperties": true},
    });
    properties.insert(SCENARIO.into(), scenario);
    let mut parts = Map::new();
    parts.insert("formula".into(), json!({"anyOf": [number(Range::Any), {"type": "string"}]}));
    let component = formula(Range::Any);
    let list = json!({"type": "array", "items": component, "minItems": 3, "maxItems": 3});
    parts.insert("vector".into(), json!({"anyOf": [list, {"type": "string"}]}));
    let words = json!({"type": "array", "items": {"type": "string"}, "minItems": 1});
    let whole = json!({"type": "integer"});
    let range = json!({
        "type": "object", "properties": {"from": whole, "to": whole}, "required": ["from", "to"], "additionalProperties": false
    });
    let list = json!({"anyOf": [{"type": "array", "items": whole, "minItems": 1}, words]});
    let listed =
        json!({"type": "object", "properties": {"values": list}, "required": ["values"], "additionalProperties": false});
    let values = json!({"anyOf": [range, list, listed]});
    let own = json!({"type": "object", "description": FOR.doc, "additionalProperties": values, "minProperties": 1});
    parts.insert("for".into(), own);
    for (name, forms) in tables() {
        parts.insert(name, table(forms, is_listed(forms), &OwnParts::default()));
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "costate scene",
        "description": "A mechanism with its design variables, functionals and settings. Numbers may be formulas in texts.",
        "type": "object",
        "required": ["version", "settings"],
        "additionalProperties": false,
        "properties": properties,
        "$defs": parts,
    })
}

fn part(name: &str) -> Value {
    json!({"$ref": format!("#/$defs/{name}")})
}

/// A table that is a value.
fn inner(forms: &'static Forms) -> Value {
    tables()
        .into_iter()
        .find(|(_, own)| same(own, forms))
        .map_or_else(|| table(forms, false, &OwnParts::default()), |(name, _)| part(&name))
}

/// A table with the keys of its forms; with forms, the one that the key `type` names.
fn table(forms: &Forms, is_repeated: bool, parts: &OwnParts) -> Value {
    let of_form = |name: &str, doc: &str, keys: &[Key]| {
        let (mut properties, mut required) = (Map::new(), Vec::new());
        if !name.is_empty() {
            properties.insert("type".into(), json!({"const": name, "description": doc}));
            required.push("type");
        }
        for key in forms.common.iter().chain(keys) {
            properties.insert(key.name.into(), of_key(key));
            if key.is_needed {
                required.push(key.name);
            }
        }
        if is_repeated {
            properties.insert(FOR.name.into(), part("for"));
        }
        json!({"type": "object", "properties": properties, "required": required, "additionalProperties": false})
    };
    let all: Vec<Value> = all_forms(forms, parts).iter().map(|form| of_form(form.name, form.doc, form.keys)).collect();
    match all.len() {
        1 => all.into_iter().next().unwrap_or_default(),
        _ => json!({"oneOf": all}),
    }
}

fn number(range: Range) -> Value {
    match range {
        Range::Any => json!({"type": "number"}),
        Range::Positive => json!({"type": "number", "exclusiveMinimum": 0}),
        Range::AtLeastZero => json!({"type": "number", "minimum": 0}),
        Range::Share => json!({"type": "number", "minimum": 0, "maximum": 1}),
    }
}

fn formula(range: Range) -> Value {
    match range {
        Range::Any => part("formula"),
        _ => json!({"anyOf": [number(range), {"type": "string"}]}),
    }
}

fn of_key(key: &Key) -> Value {
    let array = |items: Value, least: usize, most: Option<usize>| {
        let mut own = json!({"type": "array", "items": items, "minItems": least});
        if let Some(most) = most {
            own["maxItems"] = most.into();
        }
        own
    };
    let text = || json!({"type": "string"});
    let whole = |least: usize, most: usize| json!({"type": "integer", "minimum": least, "maximum": most});
    let mut unit = "";
    let mut own = match key.takes {
        Type::Number(of, range) | Type::Fixed(of, range) | Type::OfMesh(of, range) => {
            unit = of;
            formula(range)
        }
        Type::Vector(of) => {
            unit = of;
            part("vector")
        }
        Type::Numbers(counts, of, range) => {
            unit = of;
            let [least, most] = [counts.iter().min(), counts.iter().max()].map(|own| own.copied().unwrap_or(0));
            array(formula(range), least, Some(most))
        }
        Type::Fixeds(count, of) => {
            unit = of;
            array(formula(Range::Any), count, (count > 0).then_some(count))
        }
        Type::Series(of) => {
            unit = of;
            json!({"anyOf": [text(), array(formula(Range::Any), 1, None)]})
        }
        Type::FixedOrMore(of) => {
            unit = of;
            json!({"anyOf": [number(Range::Any), {"type": "string"}, array(formula(Range::Any), 1, None)]})
        }
        Type::OneOrMore(of, range) | Type::Strips(of, range) => {
            unit = of;
            json!({"anyOf": [number(range), {"type": "string"}, array(formula(range), 1, None)]})
        }
        Type::Points => {
            unit = "m";
            array(part("vector"), 2, None)
        }
        Type::Pairs(of) => {
            unit = of;
            array(array(formula(Range::Any), 2, Some(2)), 2, None)
        }
        Type::Count(least, most) => json!({"anyOf": [whole(least, most), {"type": "string"}]}),
        Type::Counts(count, least, most) => {
            array(json!({"anyOf": [whole(least, most), {"type": "string"}]}), count, Some(count))
        }
        Type::Flag => json!({"type": "boolean"}),
        Type::SeriesOfNodes(of) => {
            unit = of;
            array(formula(Range::Any), 1, None)
        }
        Type::NamedNodes(forms) => {
            let node = json!({"anyOf": [text(), inner(forms)]});
            json!({"type": "object", "additionalProperties": node, "minProperties": 1})
        }
        Type::Definitions => {
            let own = json!({"anyOf": [formula(Range::Any), part("vector")]});
            json!({"type": "object", "additionalProperties": own, "minProperties": 1})
        }
        Type::OfNodes(of) => {
            unit = of;
            formula(Range::Any)
        }
        Type::NamedFormulas(of) => {
            unit = of;
            let own = json!({"anyOf": [formula(Range::Any), part("vector")]});
            json!({"type": "object", "additionalProperties": own, "minProperties": 1})
        }
        Type::Text | Type::Stl | Type::OfTime | Type::Node | Type::NodeSet | Type::Item(_) => text(),
        Type::Texts => array(text(), 0, None),
        Type::Columns => array(json!({"anyOf": [text(), whole(1, usize::MAX >> 11)]}), 2, Some(2)),
        Type::Weights => json!({"type": "object", "additionalProperties": formula(Range::Any), "minProperties": 1}),
        Type::Choice(words) => json!({"enum": words}),
        Type::Choices(words) => json!({"anyOf": [{"enum": words}, array(json!({"enum": words}), 0, None)]}),
        Type::Nodes(count) => array(text(), count, Some(count)),
        Type::NodeSets => array(text(), 1, None),
        Type::Items(_) => json!({"anyOf": [text(), array(text(), 0, None)]}),
        Type::Lists => array(array(whole(0, usize::MAX >> 11), 0, None), 1, None),
        Type::Selections => {
            let selection = json!({"anyOf": [text(), array(whole(0, usize::MAX >> 11), 0, None)]});
            json!({"type": "object", "additionalProperties": selection})
        }
        Type::Table(forms) => inner(forms),
        Type::Tables(forms) => array(inner(forms), 0, None),
        Type::Function(of, forms) | Type::Law(of, forms) | Type::Energy(of, forms) => {
            unit = of;
            json!({"anyOf": [{"type": "number"}, {"type": "string"}, inner(forms)]})
        }
        Type::Over(words, forms) => json!({"anyOf": [{"enum": words}, inner(forms)]}),
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    own["description"] = format!("{}{unit}", key.doc).into();
    own
}
