use super::extended::EXTENDS;
use super::own_parts::{OwnParts, all_forms};
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
    let mut changes = Map::new();
    for key in TOP.forms[0].keys {
        let into = if key.name == EXTENDS { &mut changes } else { &mut properties };
        into.insert(key.name.into(), of_key(key));
    }
    let repeated = json!({
        "type": "object", "properties": {"for": part("for"), "value": quantity()}, "required": ["for", "value"],
        "additionalProperties": false,
    });
    let defined = any_of(&[quantity(), repeated]);
    properties.insert(DEFINE.0.into(), json!({"type": "object", "description": DEFINE.1, "additionalProperties": defined}));
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
    parts.insert("formula".into(), any_of(&[number(Range::Any), text()]));
    parts.insert("vector".into(), any_of(&[array(formula(Range::Any), 3, 3), text()]));
    let whole = any_of(&[json!({"type": "integer"}), text()]);
    let range = json!({
        "type": "object", "properties": {"from": whole, "to": whole}, "required": ["from", "to"], "additionalProperties": false
    });
    let list = any_of(&[at_least(1, whole), at_least(1, text())]);
    let listed =
        json!({"type": "object", "properties": {"values": list}, "required": ["values"], "additionalProperties": false});
    let values = any_of(&[range, list, listed]);
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
        "oneOf": [
            {"required": ["version", "settings"], "properties": properties, "additionalProperties": false},
            {"required": [EXTENDS], "properties": changes, "additionalProperties": true},
        ],
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
        if forms.have_types() {
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
        _ => any_of(&[number(range), text()]),
    }
}

fn of_key(key: &Key) -> Value {
    let unit = unit(&key.takes);
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    let mut own = of_type(&key.takes);
    own["description"] = format!("{}{unit}", key.doc).into();
    own
}

/// The unit of what a key takes, where it has one.
pub(super) fn unit(takes: &Type) -> &'static str {
    match *takes {
        Type::Number(unit, _) | Type::Fixed(unit, _) | Type::OfMesh(unit, _) | Type::OfNodes(unit) => unit,
        Type::Vector(unit) | Type::Numbers(_, unit, _) | Type::NamedFormulas(unit) => unit,
        Type::List(each, ..) | Type::OneOrMore(each) | Type::Strips(each) => self::unit(each),
        Type::Function(unit, _) | Type::Law(unit, _) | Type::Energy(unit, _) => unit,
        _ => "",
    }
}

fn of_type(takes: &Type) -> Value {
    const LARGEST: usize = usize::MAX >> 11;
    let words = |words: &[&str]| json!({"enum": words});
    let whole = |least: usize, most: usize| json!({"type": "integer", "minimum": least, "maximum": most});
    let count = |least, most| any_of(&[whole(least, most), text()]);
    let named = |own: Value| json!({"type": "object", "additionalProperties": own, "minProperties": 1});
    match *takes {
        Type::Number(_, range) | Type::Fixed(_, range) | Type::OfMesh(_, range) => formula(range),
        Type::OfNodes(_) => formula(Range::Any),
        Type::Vector(_) => part("vector"),
        Type::Numbers(counts, _, range) => {
            let [least, most] = [counts.iter().min(), counts.iter().max()].map(|own| own.copied().unwrap_or(0));
            array(formula(range), least, most)
        }
        // the name of a design variable that has several numbers stands for all of them
        Type::List(Type::Number(_, range), least, _) => any_of(&[text(), at_least(least, formula(*range))]),
        Type::List(each, least, usize::MAX) => at_least(least, of_type(each)),
        Type::List(each, least, most) => array(of_type(each), least, most),
        Type::OneOrMore(each) | Type::Strips(each) => {
            any_of(&[of_type(each), at_least(usize::from(!matches!(each, Type::Choice(_) | Type::Item(_))), of_type(each))])
        }
        Type::Count(least, most) => count(least, most),
        Type::Flag => json!({"type": "boolean"}),
        Type::NamedNodes(forms) => named(any_of(&[text(), inner(forms)])),
        Type::Definitions | Type::NamedFormulas(_) => named(quantity()),
        Type::NamedTables(forms) => named(inner(forms)),
        Type::Weights => named(formula(Range::Any)),
        Type::Text | Type::Stl | Type::OfTime | Type::Node | Type::NodeSet | Type::Item(_) => text(),
        Type::Columns => array(any_of(&[text(), whole(1, LARGEST)]), 2, 2),
        Type::Choice(own) => words(own),
        Type::Lists => at_least(1, at_least(0, whole(0, LARGEST))),
        Type::Selections => {
            let selection = any_of(&[text(), at_least(0, whole(0, LARGEST))]);
            json!({"type": "object", "additionalProperties": selection})
        }
        Type::Table(forms) => inner(forms),
        Type::Function(_, forms) | Type::Law(_, forms) | Type::Energy(_, forms) => {
            any_of(&[number(Range::Any), text(), inner(forms)])
        }
        Type::Over(own, forms) => any_of(&[words(own), inner(forms)]),
    }
}

/// A number or a vector.
fn quantity() -> Value {
    any_of(&[formula(Range::Any), part("vector")])
}

fn text() -> Value {
    json!({"type": "string"})
}

fn any_of(ways: &[Value]) -> Value {
    json!({"anyOf": ways})
}

fn at_least(least: usize, items: Value) -> Value {
    json!({"type": "array", "items": items, "minItems": least})
}

fn array(items: Value, least: usize, most: usize) -> Value {
    json!({"type": "array", "items": items, "minItems": least, "maxItems": most})
}
