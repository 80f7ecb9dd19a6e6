//! What the scenarios of a scene gave, side by side.

use super::console::{print, print_files, print_json};
use super::failure::Failure;
use super::options::SceneOptions;
use super::report::Page;
use super::simulation::Simulation;
use crate::io::{Cell, Chart, Series, Table, write_json};
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
    /// Adds what a scenario gave.
    pub fn add(&mut self, name: &str, prepared: &Prepared, simulation: &Simulation) {
        let place = self.scenarios.len();
        self.scenarios.push(name.into());
        for (functional, &value) in prepared.functionals().iter().zip(&simulation.forward.values) {
            let row = self.rows.iter().position(|row| row.name == functional.name).unwrap_or_else(|| {
                let (name, unit) = (functional.name.clone(), functional.value_unit().to_string());
                self.rows.push(Row { name, unit, values: Vec::new() });
                self.rows.len() - 1
            });
            self.rows[row].values.resize(place, None);
            self.rows[row].values.push(Some(value));
        }
        self.rows.iter_mut().for_each(|row| row.values.resize(place + 1, None));
        for chart in &simulation.measured.charts {
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
    pub fn conclude(&self, scene: &dyn AnyScene, options: &SceneOptions) -> Result<(), Failure> {
        if self.scenarios.len() < 2 {
            return Ok(());
        }
        let names = self.scenarios.iter().map(String::as_str);
        let mut table = Table::new(&["functional"].into_iter().chain(names).chain(["unit"]).collect::<Vec<_>>());
        for Row { name, unit, values } in &self.rows {
            let values = values.iter().map(|value| value.map(Cell::long).into());
            table.row([Cell::from(name)].into_iter().chain(values).chain([unit.into()]));
        }
        print(format_args!("{table}\n"));
        let of_row = |Row { name, unit, values }: &Row| json!({"name": name, "unit": unit, "values": values});
        let rows: Vec<Value> = self.rows.iter().map(of_row).collect();
        let summary = json!({"scene": scene.name(), "scenarios": self.scenarios, "functionals": rows});
        let [file, report] = COMPARISON.map(|name| options.folder(scene).join(name));
        write_json(&file, &summary)?;
        print_files(&[&file]);
        if !options.no_report {
            let mut page = Page::by_command(scene, "comparison of its scenarios");
            page.table("Functionals", &table);
            page.charts("Histories", &self.charts);
            page.write(&report, &[file])?;
            print_files(&[report]);
        }
        print_json(options.json, &summary);
        Ok(())
    }
}
