use super::schema::unit;
use super::sections::{DEFINE, FOR, SECTIONS, TOP};
use crate::elements::entries::{Forms, Key, Range, Type};
use std::fmt::Write;

/// The reference page of all sections and keys, in Markdown: what the reader allows, as it is made of the same tables.
pub fn reference() -> String {
    let mut page = String::from("# Sections and keys\n\n## At the top of the file\n\n");
    keys(&mut page, TOP.forms[0].keys);
    let _ = write!(page, "\n## `[{}]`\n\n{}\n", DEFINE.0, DEFINE.1);
    for section in SECTIONS {
        let _ = write!(page, "\n## `{}`\n\n{}\n\n", section.header(), escaped(section.doc));
        forms(&mut page, &section.forms);
    }
    let _ = write!(page, "\n## Tables\n\nValues that are tables have these keys.\n");
    for (name, table) in tables() {
        let _ = write!(page, "\n### {name}\n\n");
        forms(&mut page, table);
    }
    let _ = write!(
        page,
        "\n## Many at once\n\n`{}` in an entry of a list, or of a section with names: {}.\n",
        FOR.name, FOR.doc
    );
    page
}

/// Tables that are values, by the key at which each stands first.
pub(super) fn tables() -> Vec<(String, &'static Forms)> {
    let mut found: Vec<(String, &'static Forms)> = Vec::new();
    for section in SECTIONS {
        for key in all_keys(&section.forms) {
            if let Some(own) = table_of(&key.takes)
                && !found.iter().any(|(_, other)| same(own, other))
            {
                found.push((table_name(key), own));
            }
        }
    }
    found
}

/// Whether a table is one of a list, where one may stand for many.
pub(super) fn is_listed(forms: &'static Forms) -> bool {
    let all = SECTIONS.iter().flat_map(|section| all_keys(&section.forms));
    all.filter_map(|key| if let Type::List(Type::Table(own), ..) = key.takes { Some(*own) } else { None })
        .any(|own| same(own, forms))
}

/// Whether two tables are one.
pub(super) fn same(a: &'static Forms, b: &'static Forms) -> bool {
    let names = |forms: &'static Forms| all_keys(forms).map(|key| key.name).collect::<Vec<_>>();
    names(a) == names(b)
}

fn table_name(key: &Key) -> String {
    match key.takes {
        Type::Function(..) => "a function of time".into(),
        Type::Law(..) | Type::Energy(..) => "a table of s".into(),
        Type::Over(..) => "an aggregate".into(),
        Type::NamedNodes(_) => "a point of a node".into(),
        Type::NamedTables(_) => "a table of an entry".into(),
        _ => key.name.into(),
    }
}

fn table_of(takes: &Type) -> Option<&'static Forms> {
    match takes {
        Type::Table(forms)
        | Type::List(Type::Table(forms), ..)
        | Type::Function(_, forms)
        | Type::Law(_, forms)
        | Type::Energy(_, forms)
        | Type::NamedNodes(forms)
        | Type::NamedTables(forms)
        | Type::Over(_, forms) => Some(*forms),
        _ => None,
    }
}

fn all_keys(forms: &'static Forms) -> impl Iterator<Item = &'static Key> {
    forms.common.iter().chain(forms.forms.iter().flat_map(|form| form.keys))
}

fn forms(page: &mut String, own: &'static Forms) {
    if !own.have_types() {
        return keys(page, &all_keys(own).copied().collect::<Vec<_>>());
    }
    keys(page, own.common);
    for form in own.forms {
        let _ = write!(page, "\n`type = \"{}\"`: {}\n\n", form.name, escaped(form.doc));
        keys(page, form.keys);
    }
}

fn keys(page: &mut String, keys: &[Key]) {
    if keys.is_empty() {
        return;
    }
    page.push_str("| key | value | meaning |\n|---|---|---|\n");
    for key in keys {
        let needed = if key.is_needed { "" } else { ", optional" };
        let _ = writeln!(page, "| `{}` | {}{needed} | {} |", key.name, words(key), escaped(key.doc));
    }
}

fn escaped(text: &str) -> String {
    text.replace('[', "\\[").replace('<', "\\<")
}

/// What each value of a list is, whether so many are right, and what they are called, with how many there are to be.
pub(super) fn many(takes: &Type, count: usize) -> (Type, bool, String) {
    let (each, is_right, how_many) = match *takes {
        Type::Numbers(counts, unit, range) => {
            let words = counts.iter().map(ToString::to_string).collect::<Vec<_>>().join(" or ");
            (Type::Number(unit, range), counts.contains(&count), words + " ")
        }
        Type::List(each, least, most) => {
            let words = match least {
                _ if least == most => format!("{least} "),
                0 | 1 => String::new(),
                _ => format!("{least} or more "),
            };
            (*each, (least..=most).contains(&count), words)
        }
        _ => unreachable!("{takes:?} is no list"),
    };
    let called = match each {
        Type::Number(..) => "numbers or formulas",
        Type::Numbers(..) => "pairs of numbers or formulas",
        Type::Fixed(..) => "numbers",
        Type::Vector(_) => "vectors",
        Type::Count(..) => "whole numbers or formulas of constants",
        Type::OfNodes(_) => "formulas of the nodes",
        Type::Text => "texts",
        Type::Node => "nodes",
        Type::NodeSet => "nodes, edges and ends",
        _ => "tables",
    };
    (each, is_right, how_many + called)
}

/// What a key takes, with unit and range.
fn words(key: &Key) -> String {
    let with = |what: &str, range: Range| {
        let unit = match unit(&key.takes) {
            "" => String::new(),
            unit => format!(" \\[{unit}\\]"),
        };
        let range = if range == Range::Any { String::new() } else { format!(", {}", range.words()) };
        format!("{what}{unit}{range}")
    };
    let one_of = |words: &[&str]| words.iter().map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(" ");
    match key.takes {
        Type::Number(_, range) => with("number or formula", range),
        Type::Fixed(_, range) => with("number", range),
        Type::Vector(_) => with("vector", Range::Any),
        Type::List(Type::Table(_), ..) => format!("list of tables {}", table_name(key)),
        Type::Numbers(..) | Type::List(..) => match many(&key.takes, 0) {
            (Type::Number(_, range), _, words) => with(&words, range),
            (Type::Count(least, most), _, words) => format!("{words}, {least} to {most}"),
            (_, _, words) => with(&words, Range::Any),
        },
        Type::OneOrMore(Type::Number(_, range)) | Type::Strips(Type::Number(_, range)) => {
            with("one or more numbers or formulas", *range)
        }
        Type::OneOrMore(Type::Choice(words)) => format!("some of {}", one_of(words)),
        Type::OneOrMore(Type::Item(sections)) => format!("names of {}", sections.join(", ")),
        Type::OneOrMore(_) | Type::Strips(_) => with("number, or several", Range::Any),
        Type::Count(least, most) if least == most => format!("{least}"),
        Type::Count(least, most) => format!("whole number or formula of constants, {least} to {most}"),
        Type::Flag => "true or false".into(),
        Type::Text => "text".into(),
        Type::Stl => "name of a file".into(),
        Type::Columns => "2 names or numbers of columns".into(),
        Type::Weights => "table of names with numbers".into(),
        Type::Choice(words) => one_of(words),
        Type::Node => "node".into(),
        Type::NodeSet => "node, edge or end".into(),
        Type::Item(sections) => format!("name of a {}", sections.join(", ")),
        Type::OfMesh(_, range) => with("number or formula, of faces and nodes too", range),
        Type::Lists => "lists of whole numbers".into(),
        Type::Selections => "table of names with lists of whole numbers or conditions".into(),
        Type::Table(_) => format!("table {}", table_name(key)),
        Type::Function(..) => with("number, formula or function of time", Range::Any),
        Type::NamedNodes(_) => "table of names with nodes or points of them".into(),
        Type::Definitions => "table of names with formulas of the nodes".into(),
        Type::NamedTables(_) => "tables by their names".into(),
        Type::OfNodes(_) => with("formula of the nodes", Range::Any),
        Type::NamedFormulas(_) => with("table of names with formulas", Range::Any),
        Type::OfTime => "formula of t".into(),
        Type::Law(..) => with("formula of s, v, t or table of s", Range::Any),
        Type::Energy(..) => with("formula or table of s", Range::Any),
        Type::Over(words, _) => format!("{} or an aggregate", one_of(words)),
    }
}
