//! What numbers change by with each design variable.

use super::console::{brief, relative_effect};
use super::summary::{Summary, by_name};
use crate::io::{Cell, Table, cells};
use costate::scenes::Prepared;
use serde_json::Value;

/// Another gradient beside that by the adjoint: by which way, its rows, and relative differences.
pub type Other<'g> = Option<(&'g str, [&'g [Vec<f64>]; 2])>;

pub fn gradients(prepared: &Prepared, values: &[f64], adjoint: &[Vec<f64>], other: Other) -> Summary {
    let mut summary = Summary::default();
    for (k, functional) in prepared.functionals().iter().enumerate() {
        let other = other.map(|(way, rows)| (way, rows.map(|rows| &rows[k][..])));
        summary.influences((&functional.name, &functional.value_unit(), values[k]), prepared, &adjoint[k], other);
    }
    summary
}

/// x / f df/dx for each variable.
fn relative_effects<'p>(prepared: &'p Prepared, value: f64, row: &'p [f64]) -> impl Iterator<Item = Option<f64>> + 'p {
    prepared.x.iter().zip(row).map(move |(&x, &derivative)| relative_effect(x, derivative, value))
}

/// Adds the derivatives of a value to its object.
pub fn insert_gradient(object: &mut Value, prepared: &Prepared, value: f64, row: &[f64]) {
    object["gradient"] = by_name(&prepared.variables, row.iter().copied());
    object["relative_sensitivity"] = by_name(&prepared.variables, relative_effects(prepared, value, row));
}

impl Summary {
    /// Adds the derivatives of what has a name, unit and value, and beside them those of another way by its name, with how far both are apart.
    pub fn influences(
        &mut self,
        (name, unit, value): (&str, &str, f64),
        prepared: &Prepared,
        row: &[f64],
        other: Option<(&str, [&[f64]; 2])>,
    ) {
        let mut titles = vec!["variable", "value", "unit", "adjoint", "relative"];
        titles.extend(other.iter().flat_map(|own| [own.0, "difference"]));
        let (mut table, mut bars) = (Table::new(&titles), Vec::new());
        let variables = prepared.variables.iter().zip(&prepared.x).zip(relative_effects(prepared, value, row));
        for (i, ((variable, &x), relative)) in variables.enumerate() {
            let shown = relative.map_or("-".into(), Cell::from);
            let mut cells = cells![&variable.name, x, variable.unit, Cell::long(row[i]), shown].to_vec();
            if let Some((_, [others, differences])) = other {
                cells.extend(cells![Cell::long(others[i]), brief(differences[i])]);
            }
            table.row(cells);
            bars.push((variable.name.clone(), relative.unwrap_or(f64::NAN)));
        }
        let heading = format!("Gradient of {name} [{unit} / unit of the variable]");
        self.words(format!("{heading}, relative: x / f df/dx"));
        self.table(heading, table);
        let label = "relative change by a relative change of a variable, x / f df/dx; none of a variable that is 0";
        self.bars(format!("What changes {name}"), label, bars);
    }
}
