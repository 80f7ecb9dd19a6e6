//! The pictures of a sweep: scatter-1.svg and so on, functionals over one variable each, and sensitivity.svg.

use super::Sweep;
use super::findings::Findings;
use super::rows::Outcome;
use crate::failure::Failure;
use crate::io::{Bars, Chart, Series, Style, write_bars, write_charts};
use std::path::{Path, PathBuf};

/// Most functionals in one picture, and most pictures and bars of variables: those that matter most.
const MOST_PANELS: usize = 12;
const MOST_VARIABLES: usize = 12;

/// Draws what is finished; returns the files.
pub fn draw(
    sweep: &Sweep,
    done: &[(usize, &Outcome)],
    findings: &[Findings],
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for axis in most_telling(sweep, findings.iter()) {
        files.push(folder.join(format!("scatter-{}.svg", axis + 1)));
        write_charts(&scatter(sweep, done, axis), &files[files.len() - 1])?;
    }
    // one value of each variable shows no sensitivity
    if findings.iter().any(|own| own.correlations.iter().any(|correlation| correlation.is_finite())) {
        files.push(folder.join("sensitivity.svg"));
        let label = format!("Spearman's rank correlation over {} designs", done.len());
        write_bars(&bars(sweep, findings), &label, &files[files.len() - 1])?;
    }
    Ok(files)
}

/// Axes with the largest rank correlation with one of some functionals, in their order.
fn most_telling<'f>(sweep: &Sweep, findings: impl Iterator<Item = &'f Findings> + Clone) -> Vec<usize> {
    let mut axes: Vec<usize> = (0..sweep.variation.axes.len()).collect();
    let weight = |axis: usize| findings.clone().map(|own| own.correlations[axis].abs()).fold(0.0, f64::max);
    axes.sort_by(|&a, &b| weight(b).total_cmp(&weight(a)));
    axes.truncate(MOST_VARIABLES);
    axes.sort_unstable();
    axes
}

/// Each functional over one variable; a curve where nothing else varies.
fn scatter(sweep: &Sweep, done: &[(usize, &Outcome)], axis: usize) -> Vec<Chart> {
    let style = if sweep.variation.axes.len() == 1 { Style::Both } else { Style::Markers };
    let chart = |(place, (name, unit)): (usize, &(String, String))| {
        let point = |&(number, outcome): &(usize, &Outcome)| (sweep.variation.points[number][axis], outcome.values[place]);
        let mut points: Vec<(f64, f64)> = done.iter().map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Chart {
            title: if place == 0 { format!("{}: {name}", sweep.name()) } else { name.clone() },
            x_label: sweep.axis_label(axis),
            y_label: format!("[{unit}]"),
            series: vec![Series { name: String::new(), points, style }],
            log_x: sweep.variation.axes[axis].log,
            ..Chart::default()
        }
    };
    sweep.functionals.iter().enumerate().take(MOST_PANELS).map(chart).collect()
}

/// Rank correlations of each functional, the largest above.
fn bars(sweep: &Sweep, findings: &[Findings]) -> Vec<Bars> {
    let panel = |(place, own): (usize, &Findings)| {
        let mut axes = most_telling(sweep, std::iter::once(own));
        axes.sort_by(|&a, &b| own.correlations[b].abs().total_cmp(&own.correlations[a].abs()));
        let name = &sweep.functionals[place].0;
        let title = if place == 0 { format!("{}: {name}", sweep.name()) } else { name.clone() };
        Bars { title, bars: axes.into_iter().map(|axis| (sweep.axis_name(axis).into(), own.correlations[axis])).collect() }
    };
    findings.iter().enumerate().take(MOST_PANELS).map(panel).collect()
}
