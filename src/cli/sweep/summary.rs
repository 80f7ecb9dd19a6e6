//! What is printed at the end of a sweep, and stands in sweep.json.

use super::findings::Findings;
use super::rows::Outcome;
use super::{Sampling, Sweep, pictures};
use crate::console::{count, print, seconds, warn};
use crate::failure::{Failure, INTERRUPTED};
use crate::io::{Cell, Table, cells};
use crate::simulation::names;
use crate::summary::by_name;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Most variables that have a column in the console, and most failed designs that are listed in JSON.
const MOST_COLUMNS: usize = 8;
const MOST_LISTED: usize = 100;

pub struct Summary<'s> {
    sweep: &'s Sweep<'s>,
    /// Designs that were simulated, and those that could not be, by their places.
    done: Vec<(usize, &'s Outcome)>,
    failed: Vec<(usize, &'s Outcome)>,
    /// Rows of an earlier sweep.
    kept: usize,
    seconds: f64,
    findings: Vec<Findings>,
}

impl<'s> Summary<'s> {
    pub fn new(sweep: &'s Sweep<'s>, outcomes: &'s [Option<Outcome>], kept: usize, seconds: f64) -> Self {
        let finished = outcomes.iter().enumerate().filter_map(|(place, outcome)| Some((place, outcome.as_ref()?)));
        let (failed, done): (Vec<_>, Vec<_>) = finished.partition(|(_, outcome)| outcome.failed);
        let variable = |axis: usize| done.iter().map(|&(place, _)| sweep.variation.points[place][axis]).collect();
        let variables: Vec<Vec<f64>> = (0..sweep.variation.axes.len()).map(variable).collect();
        let values = |k: usize| done.iter().map(|&(place, outcome)| (place, outcome.values[k])).collect::<Vec<_>>();
        let findings = (0..sweep.functionals.len()).filter_map(|k| Findings::of(&values(k), &variables)).collect();
        Summary { sweep, done, failed, kept, seconds, findings }
    }

    pub fn draw(&self, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
        if self.findings.is_empty() {
            Ok(Vec::new())
        } else {
            pictures::draw(self.sweep, &self.done, &self.findings, folder)
        }
    }

    /// Prints the extremes of the functionals, their designs, and rank correlations.
    pub fn print(&self) {
        if !self.findings.is_empty() {
            print(format_args!("{}\n", self.extremes()));
            print(format_args!("{}\n", self.designs()));
            print(format_args!("{}\n", self.correlations()));
        }
        let [done, failed] = [&self.done, &self.failed].map(|own| own.len());
        let took = if self.kept == done + failed { String::new() } else { format!(" in {}", seconds(self.seconds)) };
        print(format_args!("{} finished{took}, {failed} failed\n", count(done + failed, "design")));
        let mut told = self.done.iter().filter(|(_, outcome)| !outcome.message.is_empty());
        if let Some((place, Outcome { message, .. })) = told.next() {
            let more = told.count() + 1;
            warn(&format!(
                "{} with a warning in sweep.csv; the first, design {}: {message}",
                count(more, "design"),
                place + 1
            ));
        }
    }

    fn extremes(&self) -> Table {
        let titles = ["functional", "smallest", "design", "largest", "design", "mean", "unit"];
        let keys = ["name", "smallest.value", "smallest.design", "largest.value", "largest.design", "mean", "unit"];
        let mut table = Table::new(&titles).keyed(&keys);
        for ((name, unit), Findings { extremes: [least, most], mean, .. }) in
            self.sweep.functionals.iter().zip(&self.findings)
        {
            table.row(cells![name, least.0, least.1 + 1, most.0, most.1 + 1, *mean, unit]);
        }
        table
    }

    /// The variables of the designs that have an extreme value.
    fn designs(&self) -> Table {
        let axes = 0..self.sweep.variation.axes.len().min(MOST_COLUMNS);
        let labels: Vec<String> = axes.clone().map(|axis| self.sweep.axis_label(axis)).collect();
        let mut table = Table::new(&["design"].into_iter().chain(labels.iter().map(String::as_str)).collect::<Vec<_>>());
        let mut places: Vec<usize> = self.findings.iter().flat_map(|own| own.extremes.map(|extreme| extreme.1)).collect();
        places.sort_unstable();
        places.dedup();
        for place in places {
            let values = axes.clone().map(|axis| Cell::from(self.sweep.variation.points[place][axis]));
            table.row([Cell::from(place + 1)].into_iter().chain(values));
        }
        table
    }

    fn correlations(&self) -> Table {
        let axes = 0..self.sweep.variation.axes.len().min(MOST_COLUMNS);
        let labels: Vec<&str> = axes.clone().map(|axis| self.sweep.axis_name(axis)).collect();
        let mut table = Table::new(&["rank correlation of"].into_iter().chain(labels).collect::<Vec<_>>());
        for ((name, _), own) in self.sweep.functionals.iter().zip(&self.findings) {
            let values = axes.clone().map(|axis| match own.correlations[axis] {
                correlation if correlation.is_finite() => Cell::from(format!("{correlation:>6.3}")),
                _ => "-".into(),
            });
            table.row([Cell::from(name.as_str())].into_iter().chain(values));
        }
        table
    }

    /// The same and more as one object.
    pub fn json(&self, files: &[PathBuf]) -> Value {
        let Summary { sweep, done, failed, kept, seconds, findings } = self;
        let axes = sweep.variation.axes.iter().enumerate().map(|(k, axis)| {
            let (from, to) = axis.range;
            json!({"name": sweep.axis_name(k), "unit": sweep.base.variables[axis.place].unit, "from": from, "to": to, "logarithmic": axis.log})
        });
        let mut functionals = self.extremes().json();
        for (functional, own) in functionals.iter_mut().zip(findings) {
            for (axis, &correlation) in own.correlations.iter().enumerate() {
                functional["rank_correlation"][sweep.axis_name(axis)] = json!(correlation);
            }
        }
        let failure = |(place, outcome): &(usize, &Outcome)| json!({"design": place + 1, "message": outcome.message});
        json!({
            "scene": sweep.name(),
            "method": sweep.method.table.name,
            "designs": sweep.variation.points.len(),
            "sampling": sweep.options.samples.map_or("grid", |_| Sampling::name(sweep.options.sampling)),
            "varied": axes.collect::<Vec<_>>(),
            "design": by_name(&sweep.base.variables, sweep.base.x.iter().copied()),
            "finished": done.len() + failed.len(),
            "taken_over": kept,
            "failed": failed.len(),
            "failures": failed.iter().take(MOST_LISTED).map(failure).collect::<Vec<_>>(),
            "functionals": functionals,
            "threads": sweep.threads,
            "time_s": *seconds,
            "files": names(files),
        })
    }

    pub fn verdict(&self) -> Result<(), Failure> {
        let (all, finished) = (self.sweep.variation.points.len(), self.done.len() + self.failed.len());
        if finished < all {
            let message =
                format!("stopped after {finished} of {all} designs: sweep.csv has their rows, and --resume goes on");
            return Err(Failure { code: INTERRUPTED, message });
        }
        self.failed.first().map_or(Ok(()), |(place, Outcome { message, .. })| {
            let failed = self.failed.len();
            Err(Failure::run(format!("{failed} of {all} designs failed; the first, design {}: {message}", place + 1)))
        })
    }
}
