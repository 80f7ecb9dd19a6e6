use super::keys::{Forms, Key, Range, Shape, Type};
use super::reference::is_listed;
use super::sections::{DEFINE, FOR, SECTIONS, TOP};
use serde_json::{Map, Value, json};

/// The JSON schema of scene files, from which editors complete and check them. It is made of the tables by which files are read.
pub fn schema() -> Value {
    let mut properties = Map::new();
    for key in TOP.forms[0].keys {
        properties.insert(key.name.into(), of_key(key));
    }
    let quantity = json!({"anyOf": [formula("", Range::Any), vector()]});
    properties.insert(DEFINE.0.into(), json!({"type": "object", "description": DEFINE.1, "additionalProperties": quantity}));
    for section in SECTIONS {
        let own = table(&section.forms, is_listed(section.shape));
        let mut own = match section.shape {
            Shape::Once => own,
            Shape::Named => json!({"type": "object", "additionalProperties": own}),
            Shape::Listed => json!({"type": "array", "items": own}),
        };
        own["description"] = section.doc.into();
        properties.insert(section.name.into(), own);
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "costate scene",
        "description": "A mechanism with its design variables, functionals and settings. Numbers may be formulas in texts.",
        "type": "object",
        "required": ["version", "settings"],
        "additionalProperties": false,
        "properties": properties,
    })
}

/// A table with the keys of its forms; with forms, the one that the key `type` names.
fn table(forms: &Forms, is_listed: bool) -> Value {
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
        if is_listed {
            let range = json!({"type": "array", "prefixItems": [{"type": "integer"}, {"type": "integer"}], "items": false, "minItems": 2});
            let words = json!({"type": "array", "items": {"type": "string"}, "minItems": 1});
            let values = json!({"anyOf": [range, words]});
            let own = json!({"type": "object", "description": FOR.doc, "additionalProperties": values, "minProperties": 1});
            properties.insert(FOR.name.into(), own);
        }
        json!({"type": "object", "properties": properties, "required": required, "additionalProperties": false})
    };
    let all: Vec<Value> = forms.forms.iter().map(|form| of_form(form.name, form.doc, form.keys)).collect();
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

fn formula(_unit: &str, range: Range) -> Value {
    json!({"anyOf": [number(range), {"type": "string"}]})
}

fn vector() -> Value {
    let component = formula("", Range::Any);
    json!({"anyOf": [{"type": "array", "items": component, "minItems": 3, "maxItems": 3}, {"type": "string"}]})
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
        Type::Number(of, range) | Type::Fixed(of, range) => {
            unit = of;
            formula(of, range)
        }
        Type::Vector(of) => {
            unit = of;
            vector()
        }
        Type::Numbers(counts, of, range) => {
            unit = of;
            let [least, most] = [counts.iter().min(), counts.iter().max()].map(|own| own.copied().unwrap_or(0));
            array(formula(of, range), least, Some(most))
        }
        Type::Fixeds(count, of) => {
            unit = of;
            array(formula(of, Range::Any), if count == 0 { 2 } else { count }, (count > 0).then_some(count))
        }
        Type::Series(of) => {
            unit = of;
            array(formula(of, Range::Any), 1, None)
        }
        Type::OneOrMore(of, range) => {
            unit = of;
            json!({"anyOf": [number(range), {"type": "string"}, array(formula(of, range), 1, None)]})
        }
        Type::Points => {
            unit = "m";
            array(vector(), 2, None)
        }
        Type::Count(least, most) => json!({"anyOf": [whole(least, most), {"type": "string", "pattern": "[{]"}]}),
        Type::Counts(count, least, most) => array(whole(least, most), count, Some(count)),
        Type::Flag => json!({"type": "boolean"}),
        Type::Text | Type::Node | Type::Item(_) => text(),
        Type::Texts => array(text(), 0, None),
        Type::Weights => json!({"type": "object", "additionalProperties": formula("", Range::Any), "minProperties": 1}),
        Type::Choice(words) => json!({"enum": words}),
        Type::Choices(words) => json!({"anyOf": [{"enum": words}, array(json!({"enum": words}), 0, None)]}),
        Type::Nodes(count) => array(text(), count, Some(count)),
        Type::NodeSets => array(text(), 1, None),
        Type::Items(_) => json!({"anyOf": [text(), array(text(), 0, None)]}),
        Type::Table(forms) => table(forms, false),
        Type::Tables(forms) => array(table(forms, false), 0, None),
        Type::Function(of, forms) => {
            unit = of;
            json!({"anyOf": [{"type": "number"}, {"type": "string"}, table(forms, false)]})
        }
        Type::Over(words, forms) => json!({"anyOf": [{"enum": words}, table(forms, false)]}),
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    own["description"] = format!("{}{unit}", key.doc).into();
    own
}
