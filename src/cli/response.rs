//! `costate response`: amplitude and phase of what functionals measure, over the rate of a harmonic change.

use super::CommandLine;
use super::console::{print, print_files, print_json};
use super::failure::Failure;
use super::rates::Rates;
use super::simulation::names;
use super::still::StillOptions;
use crate::io::{Chart, Series, Style, Table, cells, write_charts, write_csv, write_json};
use clap::Args;
use costate::functionals::Functional;
use costate::integrators::RunError;
use costate::scenes::Prepared;
use serde_json::json;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Options of `costate response`.
#[derive(Args)]
pub struct ResponseOptions {
    #[command(flatten)]
    still: StillOptions,
    /// Design variable that varies harmonically by a little: the size of a force, the displacement of a driver
    #[arg(long, value_name = "VARIABLE")]
    by: String,
    /// Rates [rad/s]: first, last, how many; with :log in equal steps of the logarithm
    #[arg(long, value_name = "FIRST:LAST:NUMBER[:log]")]
    rates: Rates,
}

/// What one functional answers.
struct Answer {
    name: String,
    /// Of its amplitude, by the variable.
    unit: String,
    /// Complex amplitude at each rate.
    parts: Vec<[f64; 2]>,
}

impl Answer {
    fn amplitude(&self, place: usize) -> f64 {
        let [re, im] = self.parts[place];
        re.hypot(im)
    }
    /// By how much it runs ahead, in (-pi, pi] \[rad\].
    fn phase(&self, place: usize) -> f64 {
        let [re, im] = self.parts[place];
        im.atan2(re)
    }
    fn peak(&self) -> usize {
        (0..self.parts.len()).max_by(|&a, &b| self.amplitude(a).total_cmp(&self.amplitude(b))).unwrap_or(0)
    }
}

pub fn run(options: &ResponseOptions, program: &CommandLine) -> Result<(), Failure> {
    options.still.with_scene(program, |prepared, named| respond(options, &prepared, named))
}

fn respond(options: &ResponseOptions, prepared: &Prepared, named: &dyn Fn(RunError) -> Failure) -> Result<(), Failure> {
    let scene = prepared.scene;
    let variable = prepared.variable(&options.by)?;
    let unit = &prepared.variables[variable].unit;
    let rates = &options.rates.list;
    let amplitudes = prepared.frequency_response(&options.by, rates).map_err(named)?;
    let answer = |(place, functional): (usize, &Functional)| Answer {
        name: functional.name.clone(),
        unit: format!("{} by {}", functional.unit, if unit.is_empty() { "-" } else { unit }),
        parts: amplitudes.iter().map(|row| row[place]).collect(),
    };
    let answers: Vec<Answer> = prepared.functionals().iter().enumerate().map(answer).collect();
    print(format_args!("{}: {}", scene.name(), scene.summary()));
    let about = match prepared.spin_rate() {
        Some(_) => ", about the steady turn at which the motion begins, in the frame that turns",
        None => "",
    };
    print(format_args!("small steady vibrations where \"{}\" varies harmonically{about}\n", options.by));
    let mut table =
        Table::new(&["functional", "unit", "at the first rate", "largest amplitude", "at [rad/s]", "[Hz]", "phase [deg]"]);
    for own in &answers {
        let peak = own.peak();
        let (rate, phase) = (rates[peak], own.phase(peak).to_degrees());
        table.row(cells![&own.name, &own.unit, own.amplitude(0), own.amplitude(peak), rate, rate / TAU, phase]);
    }
    print(format_args!("{table}\n"));
    let folder = options.still.of.folder(scene);
    let mut files =
        write(&answers, (rates, options.rates.are_logarithmic), &format!("{}: by {}", scene.name(), options.by), &folder)?;
    let summary = folder.join("response.json");
    files.push(summary.clone());
    print_files(&files);
    let functionals = answers.iter().map(|own| {
        let [re, im] = [0, 1].map(|part| own.parts.iter().map(|own| own[part]).collect::<Vec<_>>());
        json!({"name": own.name, "unit": own.unit, "re": re, "im": im})
    });
    let object = json!({
        "scene": scene.name(),
        "by": options.by,
        "rates_rad_s": rates,
        "functionals": functionals.collect::<Vec<_>>(),
        "files": names(&files),
    });
    write_json(&summary, &object)?;
    print_json(options.still.of.json, &object);
    Ok(())
}

/// Writes response.csv, and amplitudes and phases as response.svg.
fn write(answers: &[Answer], (rates, log_x): (&[f64], bool), title: &str, folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let files = ["response.csv", "response.svg"].map(|name| folder.join(name));
    let columns = |own: &Answer| [format!("{}, amplitude [{}]", own.name, own.unit), format!("{}, phase [rad]", own.name)];
    let header: Vec<String> = ["rate [rad/s]".to_string()].into_iter().chain(answers.iter().flat_map(columns)).collect();
    let row = |place: usize| -> Vec<f64> {
        let numbers = answers.iter().flat_map(|own| [own.amplitude(place), own.phase(place)]);
        [rates[place]].into_iter().chain(numbers).collect()
    };
    write_csv(&files[0], &header, (0..rates.len()).map(row))?;
    let curve = |own: &Answer, name: String, value: &dyn Fn(usize) -> f64| Series {
        name,
        points: rates.iter().enumerate().map(|(place, &rate)| (rate, value(place))).collect(),
        style: if own.parts.len() < 60 { Style::Both } else { Style::Line },
    };
    let chart = |y_label: String, series: Vec<Series>, log_y: bool| Chart {
        title: String::new(),
        x_label: "rate [rad/s]".into(),
        y_label,
        series,
        log_x,
        log_y,
    };
    let mut charts = Vec::new();
    let mut units: Vec<&str> = answers.iter().map(|own| own.unit.as_str()).collect();
    units.sort_unstable();
    units.dedup();
    for unit in units {
        let own = || answers.iter().filter(|own| own.unit == unit && own.amplitude(own.peak()) > 0.0);
        let series: Vec<Series> = own().map(|own| curve(own, own.name.clone(), &|place| own.amplitude(place))).collect();
        let phases: Vec<Series> =
            own().map(|own| curve(own, String::new(), &|place| own.phase(place).to_degrees())).collect();
        if !series.is_empty() {
            charts.extend([chart(format!("amplitude [{unit}]"), series, true), chart("phase [deg]".into(), phases, false)]);
        }
    }
    let Some(first) = charts.first_mut() else { return Ok(vec![files[0].clone()]) };
    first.title = title.into();
    write_charts(&charts, &files[1])?;
    Ok(files.to_vec())
}
