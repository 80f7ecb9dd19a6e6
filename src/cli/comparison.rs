//! What the scenarios of a scene gave, side by side.

use super::console::{json_number, long_number, print, print_files, print_json};
use super::failure::Failure;
use super::options::SceneOptions;
use super::report::Page;
use super::simulation::Simulation;
use crate::io::{Cell, Chart, Series, Table, write_file};
use costate::scenes::{AnyScene, COMPARISON, Prepared};
use serde_json::{Value, json};

/// A functional in all scenarios; in some it may be missing.
struct Row {
    name: String,
    unit: String,
    values: Vec<Option<f64>>,
}

/// Values of functionals and histories by scenario.
#[derive(Default)]
pub struct Comparison {
    scenarios: Vec<String>,
    rows: Vec<Row>,
    /// Charts with one series for each scenario, where their times agree.
    charts: Vec<Chart>,
}

impl Comparison {
    /// Adds what a scenario gave; of one that stopped early nothing can be compared.
    pub fn add(&mut self, name: &str, prepared: &Prepared, simulation: &Simulation) {
        if simulation.stopped.is_some() {
            return;
        }
        let place = self.scenarios.len();
        self.scenarios.push(name.into());
        for (functional, &value) in prepared.functionals().iter().zip(&simulation.forward.values) {
            let row = match self.rows.iter().position(|row| row.name == functional.name) {
                Some(row) => &mut self.rows[row],
                None => {
                    let (name, unit) = (functional.name.clone(), functional.value_unit().to_string());
                    self.rows.push(Row { name, unit, values: Vec::new() });
                    self.rows.last_mut().expect("just added")
                }
            };
            row.values.resize(place, None);
            row.values.push(Some(value));
        }
        self.rows.iter_mut().for_each(|row| row.values.resize(place + 1, None));
        for chart in &simulation.charts {
            for series in &chart.series {
                self.add_history(name, chart, series);
            }
        }
    }

    /// Adds a history to the chart of what it shows.
    fn add_history(&mut self, scenario: &str, chart: &Chart, series: &Series) {
        let title = if chart.title.is_empty() { series.name.clone() } else { format!("{}: {}", chart.title, series.name) };
        let own = Series { name: scenario.into(), ..series.clone() };
        let times = |series: &Series| series.points.iter().map(|point| point.0.to_bits()).collect::<Vec<_>>();
        let same = |other: &&mut Chart| {
            other.title == title
                && other.y_label == chart.y_label
                && other.series.first().is_some_and(|other| times(other) == times(&own))
        };
        match self.charts.iter_mut().find(same) {
            Some(other) => other.series.push(own),
            None => self.charts.push(Chart { title, series: vec![own], ..chart.clone() }),
        }
    }

    /// Prints and writes the comparison of more than one scenario: `scenarios.html` and `scenarios.json`.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn conclude(&self, scene: &dyn AnyScene, options: &SceneOptions) -> Result<(), Failure> {
        if self.scenarios.len() < 2 {
            return Ok(());
        }
        let names = || self.scenarios.iter().map(String::as_str);
        let columns: Vec<&str> = std::iter::once("functional").chain(names()).chain(["unit"]).collect();
        let mut table = Table::new(&columns);
        for Row { name, unit, values } in &self.rows {
            let cell = |value: &Option<f64>| value.map_or(Cell::Empty, |value| long_number(value).into());
            let cells = std::iter::once(name.as_str().into()).chain(values.iter().map(cell)).chain([unit.as_str().into()]);
            table.row(cells.collect::<Vec<Cell>>());
        }
        print(format_args!("{table}\n"));
        let folder = options.folder(scene);
        let values =
            |row: &Row| -> Vec<Value> { row.values.iter().map(|own| own.map_or(Value::Null, json_number)).collect() };
        let of_row = |row: &Row| json!({"name": row.name, "unit": row.unit, "values": values(row)});
        let summary = json!({"scene": scene.name(), "scenarios": self.scenarios, "functionals": self.rows.iter().map(of_row).collect::<Vec<_>>()});
        let [file, report] = COMPARISON.map(|name| folder.join(name));
        write_file(&file, format!("{summary:#}\n").as_bytes())?;
        print_files(&[&file]);
        if options.reports() {
            let mut page = Page::by_command(scene, "comparison of its scenarios");
            let cells = |row: &Row| [&[json!(row.name)][..], &values(row), &[json!(row.unit)]].concat();
            page.table("Functionals", &columns, self.rows.iter().map(cells).collect());
            page.charts("Histories", &self.charts);
            page.write(&report, &[file])?;
            print_files(&[report]);
        }
        print_json(options.json, &summary);
        Ok(())
    }
}
