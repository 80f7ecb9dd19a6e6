//! Numbers of modes that a scene measures beside its functionals, as commands print and show them.

use super::influences::insert_gradient;
use super::summary::Summary;
use crate::io::{Cell, Table, cells};
use costate::integrators::RunError;
use costate::scenes::{ModeMeasure, Prepared, check_modes};
use serde_json::Value;

/// They are of the start or the equilibrium, and known before a run.
pub struct MeasuredModes {
    pub measures: Vec<ModeMeasure>,
    pub values: Vec<f64>,
    /// Derivatives by all design variables, if these are asked for.
    pub rows: Option<Vec<Vec<f64>>>,
}

impl MeasuredModes {
    pub fn of(prepared: &Prepared) -> Result<Self, RunError> {
        let measures = prepared.scene.modes();
        check_modes(&measures, prepared.functionals())?;
        let values = prepared.measured_modes(&measures)?;
        Ok(MeasuredModes { measures, values, rows: None })
    }

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

    /// Values, and derivatives where they are there; nothing where nothing is measured.
    pub fn summary(&self, prepared: &Prepared) -> Summary {
        let mut summary = Summary::default();
        summary.table("Modes", self.table());
        summary.warnings(self.toppling());
        for (own, value, row) in self.all() {
            if let Some(row) = row {
                summary.influences((&own.name, own.unit(), value), prepared, row, None);
            }
        }
        summary
    }

    fn table(&self) -> Table {
        let mut table = Table::new(&["mode", "value", "unit"]).keyed(&["name", "value", "unit"]);
        for (own, value, _) in self.all() {
            table.row(cells![&own.name, Cell::long(value), own.unit()]);
        }
        table
    }

    /// The same as JSON; nothing where nothing is measured.
    pub fn json(&self, prepared: &Prepared) -> Option<Vec<Value>> {
        let mut objects = self.table().json();
        for (place, (_, value, row)) in self.all().enumerate() {
            row.into_iter().for_each(|row| insert_gradient(&mut objects[place], prepared, value, row));
        }
        (!self.measures.is_empty()).then_some(objects)
    }
}
