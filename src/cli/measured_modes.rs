//! Numbers of modes that a scene measures beside its functionals, as commands print and show them.

use super::console::{json_number, long_number, print, relative_effect, warn};
use super::influences::print_influences;
use super::report::Page;
use crate::io::Table;
use costate::integrators::RunError;
use costate::scenes::{ModeMeasure, Prepared, check_modes};
use serde_json::{Map, Value, json};

/// They are of the start or the equilibrium, and known before a run.
pub struct MeasuredModes {
    pub measures: Vec<ModeMeasure>,
    pub values: Vec<f64>,
    /// Derivatives by all design variables, if these are asked for.
    pub rows: Option<Vec<Vec<f64>>>,
}

impl MeasuredModes {
    /// Those of a prepared scene.
    ///
    /// # Errors
    /// Wrong names or numbers, and what keeps modes from being found.
    pub fn of(prepared: &Prepared) -> Result<Self, RunError> {
        let measures = prepared.scene.modes();
        check_modes(&measures, prepared.functionals())?;
        let values = prepared.measured_modes(&measures)?;
        Ok(MeasuredModes { measures, values, rows: None })
    }

    /// Adds derivatives.
    ///
    /// # Errors
    /// What keeps them from being found.
    pub fn differentiate(&mut self, prepared: &Prepared) -> Result<(), RunError> {
        self.rows = Some(prepared.measured_modes_by_design(&self.measures)?);
        Ok(())
    }

    fn all(&self) -> impl Iterator<Item = (&ModeMeasure, f64, Option<&[f64]>)> {
        let row = |place: usize| self.rows.as_ref().map(|rows| &rows[place][..]);
        self.measures.iter().zip(&self.values).enumerate().map(move |(place, (own, &value))| (own, value, row(place)))
    }

    /// What is given for the frequency of modes that have none.
    fn toppling(&self) -> Vec<String> {
        let topples = |(own, value, _): &(&ModeMeasure, f64, _)| !own.growth && *value < 0.0;
        let words = |(own, ..): (&ModeMeasure, f64, _)| {
            format!("\"{}\": mode {} topples, and minus its growth stands for its frequency", own.name, own.number)
        };
        self.all().filter(topples).map(words).collect()
    }

    /// Prints values, and derivatives where they are there.
    pub fn print(&self, prepared: &Prepared) {
        if self.measures.is_empty() {
            return;
        }
        let mut table = Table::new(&["mode", "value", "unit"]);
        for (own, value, _) in self.all() {
            table.row([own.name.as_str().into(), long_number(value).into(), own.unit().into()]);
        }
        print(format_args!("{table}\n"));
        self.toppling().iter().for_each(|words| warn(words));
        for (own, value, row) in self.all() {
            if let Some(row) = row {
                print_influences((&own.name, own.unit(), value), prepared, row, None);
            }
        }
    }

    /// The same for a page.
    pub fn show(&self, prepared: &Prepared, page: &mut Page) {
        if self.measures.is_empty() {
            return;
        }
        let row = |(own, value, _): (&ModeMeasure, f64, _)| {
            vec![json!(own.name), json!(long_number(value).trim()), json!(own.unit())]
        };
        page.table("Modes", &["mode", "value", "unit"], self.all().map(row).collect());
        self.toppling().into_iter().for_each(|words| page.warning(words));
        for (own, value, row) in self.all() {
            if let Some(row) = row {
                page.influences((&own.name, own.unit(), value), prepared, row, None);
            }
        }
    }

    /// The same as JSON; nothing where nothing is measured.
    pub fn json(&self, prepared: &Prepared) -> Option<Value> {
        let named = |row: Vec<f64>| -> Value {
            let pairs = prepared.variables.iter().zip(row);
            pairs.map(|(variable, value)| (variable.name.clone(), json_number(value))).collect::<Map<_, _>>().into()
        };
        let object = |(own, value, row): (&ModeMeasure, f64, Option<&[f64]>)| {
            let mut object = json!({"name": own.name, "value": json_number(value), "unit": own.unit()});
            if let Some(row) = row {
                let relative = |(&x, &derivative)| relative_effect(x, derivative, value).unwrap_or(f64::NAN);
                object["relative_sensitivity"] = named(prepared.x.iter().zip(row).map(relative).collect());
                object["gradient"] = named(row.to_vec());
            }
            object
        };
        (!self.measures.is_empty()).then(|| self.all().map(object).collect())
    }
}
