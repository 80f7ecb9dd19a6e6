//! What a number changes by with each design variable, printed.

use super::console::{brief, long_number, print, relative_effect};
use crate::io::{Cell, Table};
use costate::scenes::Prepared;

/// Prints the derivatives of what has a name, unit and value, and beside them those of a check by its name, with how far both are apart.
pub fn print_influences(
    (name, unit, value): (&str, &str, f64),
    prepared: &Prepared,
    row: &[f64],
    check: Option<(&str, &[f64], &[f64])>,
) {
    let mut titles = vec!["variable", "value", "unit", "adjoint", "relative"];
    titles.extend(check.iter().flat_map(|own| [own.0, "difference"]));
    let mut table = Table::new(&titles);
    for (i, (variable, &x)) in prepared.variables.iter().zip(&prepared.x).enumerate() {
        let relative = relative_effect(x, row[i], value).map_or("-".into(), Cell::from);
        let mut cells =
            vec![variable.name.as_str().into(), x.into(), variable.unit.into(), long_number(row[i]).into(), relative];
        if let Some((_, others, differences)) = check {
            cells.extend([long_number(others[i]).into(), brief(differences[i]).into()]);
        }
        table.row(cells);
    }
    print(format_args!("gradient of {name} [{unit} / unit of the variable], relative: x / f df/dx\n{table}\n"));
}
