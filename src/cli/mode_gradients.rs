//! `costate modes --gradients`: derivatives of frequencies and growth by the design variables.

use super::console::relative_effect;
use super::failure::Failure;
use super::summary::{Summary, by_name};
use crate::io::{Cell, Table, cells, write_csv};
use costate::design::DesignVariable;
use costate::program::tolerances::ROUND_OFF;
use costate::scenes::{DifferentiatedModes, ModeGradient, Prepared};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

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

    /// A variable, and what each of the first modes makes of it.
    fn table(&self) -> Table {
        let shown: Vec<(usize, &ModeGradient)> = self.moving().take(SHOWN).collect();
        let mut columns = vec!["variable".to_string(), "unit".into()];
        for (mode, _) in &shown {
            columns.extend([format!("omega {}", mode + 1), "relative".into()]);
            columns.extend(self.are_complex.then(|| format!("growth {}", mode + 1)));
        }
        let mut table = Table::new(&columns);
        for (variable, (named, x)) in self.prepared.variables.iter().zip(&self.prepared.x).enumerate() {
            let mut row = cells![&named.name, named.unit].to_vec();
            for (mode, own) in &shown {
                let value = &self.own.modes[*mode];
                let size = value.frequency.hypot(value.growth) / x.abs();
                let shown = |derivative: f64| if derivative.abs() < ROUND_OFF * size { 0.0 } else { derivative };
                let derivative = shown(own.frequency[variable]);
                let relative = relative_effect(*x, derivative, value.frequency).map_or("-".into(), Cell::from);
                row.extend(cells![derivative, relative]);
                row.extend(self.are_complex.then(|| shown(own.growth[variable]).into()));
            }
            table.row(row);
        }
        table
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

    /// Derivatives of modes that are no rigid motions.
    pub fn summary(&self) -> Summary {
        let (mut summary, table) = (Summary::default(), self.table());
        if self.moving().next().is_some() {
            summary.words(
                "derivatives [rad/s, 1/s / unit of the variable], relative: x / omega d omega/dx; through the equilibrium\n",
            );
            summary.table("Derivatives by the design", table);
            summary.warnings(self.equal());
        }
        summary
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
        let named = |values: &[f64]| by_name(&self.prepared.variables, values.iter().copied());
        json!({"omega_rad_s": named(&own.frequency), "growth_1_s": named(&own.growth), "equal": own.equal})
    }
}
