//! What a command found, as one value, which one writer each turns into words on the terminal, JSON and parts of a page.

use super::console::{print, warn};
use super::report::Page;
use crate::io::Table;
use costate::design::DesignVariable;
use serde_json::{Map, Value};

/// Words, tables and warnings in the order in which they are told.
#[derive(Default)]
pub struct Summary(Vec<Part>);

enum Part {
    /// For the terminal alone.
    Words(String),
    /// With its heading on a page, which has none where that is empty.
    Table(String, Table),
    Warning(String),
    /// A name and what is said of it: a line on the terminal, and below the title of a page.
    Fact(&'static str, String),
    /// For a page alone: heading, label, names and numbers.
    Bars(String, &'static str, Vec<(String, f64)>),
}

impl Summary {
    /// Adds words that only the terminal shows.
    pub fn words(&mut self, words: impl Into<String>) {
        self.0.push(Part::Words(words.into()));
    }

    /// Adds a table that has rows.
    pub fn table(&mut self, heading: impl Into<String>, table: Table) {
        if !table.is_empty() {
            self.0.push(Part::Table(heading.into(), table));
        }
    }

    /// Adds what must not be missed.
    pub fn warnings(&mut self, all: impl IntoIterator<Item = String>) {
        self.0.extend(all.into_iter().map(Part::Warning));
    }

    /// Adds a name and what is said of it.
    pub fn fact(&mut self, name: &'static str, words: impl Into<String>) {
        self.0.push(Part::Fact(name, words.into()));
    }

    /// Adds bars to both sides of zero, which only a page shows.
    pub fn bars(&mut self, heading: String, label: &'static str, bars: Vec<(String, f64)>) {
        self.0.push(Part::Bars(heading, label, bars));
    }

    pub fn print(&self) {
        for part in &self.0 {
            match part {
                Part::Words(words) => print(words),
                Part::Table(_, table) => print(format_args!("{table}\n")),
                Part::Warning(words) => warn(words),
                Part::Fact(name, words) => print(format_args!("{name}: {words}\n")),
                Part::Bars(..) => {}
            }
        }
    }

    pub fn show(&self, page: &mut Page) {
        for part in &self.0 {
            match part {
                Part::Table(heading, table) if !heading.is_empty() => page.table(heading, table),
                Part::Warning(words) => page.warning(words),
                Part::Fact(name, words) => page.fact(name, words),
                Part::Bars(heading, label, bars) => page.bars(heading, label, bars),
                _ => {}
            }
        }
    }
}

/// Numbers of design variables by their names.
pub fn by_name<N: Into<Value>>(variables: &[DesignVariable], values: impl IntoIterator<Item = N>) -> Value {
    let named = variables.iter().zip(values).map(|(variable, value)| (variable.name.clone(), value.into()));
    named.collect::<Map<_, _>>().into()
}
