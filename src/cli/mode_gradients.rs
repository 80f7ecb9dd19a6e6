//! `costate modes --gradients`: derivatives of frequencies and growth by the design variables.

use super::console::{json_number, print, relative_effect};
use super::failure::Failure;
use super::report::Page;
use crate::io::{Cell, Table, number, write_csv};
use costate::design::DesignVariable;
use costate::scenes::{DifferentiatedModes, ModeGradient, Prepared};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// What is shown as zero, relative.
const ROUND_OFF: f64 = 1e-14;
/// Modes of the printed table.
const SHOWN: usize = 6;

/// What is said of the derivatives of a scene's modes.
pub struct Gradients<'g> {
    pub prepared: &'g Prepared<'g>,
    pub own: &'g DifferentiatedModes,
    /// Whether modes grow or fade, or could.
    pub are_complex: bool,
}

impl Gradients<'_> {
    fn moving(&self) -> impl Iterator<Item = (usize, &ModeGradient)> {
        self.own.gradients.iter().enumerate().filter_map(|(mode, own)| Some((mode, own.as_ref()?)))
    }

    /// Columns and rows: a variable, and what each of the first modes makes of it.
    fn rows(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let shown: Vec<(usize, &ModeGradient)> = self.moving().take(SHOWN).collect();
        let mut columns = vec!["variable".to_string(), "unit".into()];
        for (mode, _) in &shown {
            columns.extend([format!("omega {}", mode + 1), "relative".into()]);
            columns.extend(self.are_complex.then(|| format!("growth {}", mode + 1)));
        }
        let row = |variable: usize| {
            let named = &self.prepared.variables[variable];
            let mut row = vec![named.name.clone(), named.unit.to_string()];
            for (mode, own) in &shown {
                let (x, value) = (self.prepared.x[variable], &self.own.modes[*mode]);
                let size = value.frequency.hypot(value.growth) / x.abs();
                let shown = |derivative: f64| if derivative.abs() < ROUND_OFF * size { 0.0 } else { derivative };
                let derivative = shown(own.frequency[variable]);
                let relative = relative_effect(x, derivative, value.frequency).map_or("-".into(), number);
                row.extend([number(derivative), relative]);
                row.extend(self.are_complex.then(|| number(shown(own.growth[variable]))));
            }
            row
        };
        (columns, (0..self.prepared.x.len()).map(row).collect())
    }

    /// What equal values mean for their derivatives.
    fn equal(&self) -> Option<String> {
        let equal: Vec<String> =
            self.moving().filter(|(_, own)| own.equal > 1).map(|(mode, _)| (mode + 1).to_string()).collect();
        (!equal.is_empty()).then(|| {
            format!(
                "modes {} have the value of another one: each variable alone parts them as these derivatives say, the lowest omega first; they do not \
                 add up where variables change together",
                equal.join(", ")
            )
        })
    }

    /// Prints the derivatives.
    pub fn print(&self) {
        if self.moving().next().is_none() {
            return;
        }
        let (columns, rows) = self.rows();
        let mut table = Table::new(&columns.iter().map(String::as_str).collect::<Vec<_>>());
        for row in rows {
            table.row(row.into_iter().map(Cell::from));
        }
        print(format_args!(
            "derivatives [rad/s, 1/s / unit of the variable], relative: x / omega d omega/dx; through the equilibrium\n\n{table}\n"
        ));
        self.equal().into_iter().for_each(|text| print(format_args!("{text}\n")));
    }

    /// Adds them to the page.
    pub fn add_to(&self, page: &mut Page) {
        if self.moving().next().is_none() {
            return;
        }
        let (columns, rows) = self.rows();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let rows = rows.into_iter().map(|row| row.into_iter().map(Value::from).collect()).collect();
        page.table("Derivatives by the design", &columns, rows);
        self.equal().into_iter().for_each(|text| page.warning(text));
    }

    /// Writes mode-gradients.csv: a row for each mode that is no rigid motion.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, Failure> {
        let file = folder.join("mode-gradients.csv");
        let by = |variable: &DesignVariable| {
            let unit = if variable.unit.is_empty() { "-" } else { variable.unit };
            ["d omega [rad/s", "d growth [1/s"].map(|what| format!("{what} / {unit}] by {}", variable.name))
        };
        let header = ["mode".to_string()].into_iter().chain(self.prepared.variables.iter().flat_map(by)).collect::<Vec<_>>();
        let row = |(mode, own): (usize, &ModeGradient)| {
            let each = own.frequency.iter().zip(&own.growth).flat_map(|(&omega, &growth)| [omega, growth]);
            [(mode + 1) as f64].into_iter().chain(each).collect::<Vec<f64>>()
        };
        write_csv(&file, &header, self.moving().map(row))?;
        Ok(file)
    }

    /// Those of one mode as JSON; null of a rigid motion.
    pub fn json(&self, mode: usize) -> Value {
        let Some(own) = &self.own.gradients[mode] else { return Value::Null };
        let named = |values: &[f64]| {
            let each = self.prepared.variables.iter().zip(values);
            Value::from(each.map(|(variable, &own)| (variable.name.clone(), json_number(own))).collect::<Map<_, _>>())
        };
        json!({"omega_rad_s": named(&own.frequency), "growth_1_s": named(&own.growth), "equal": own.equal})
    }
}
