//! The charts of an optimization.

use crate::io::{Chart, Series, Style};
use costate::design::DesignVariable;
use costate::optimize::{DesignHistory, DesignPoint, Optimization};

/// Most curves of variables in one chart: those that move most.
const MOST_CURVES: usize = 10;
/// Ratio of the largest to the least objective from which the axis is logarithmic.
const DECADES: f64 = 1e3;

/// Whether positive numbers are so far apart that a linear axis shows nothing of the small ones.
fn spans_decades(values: impl Iterator<Item = f64>) -> bool {
    let (least, most) = values.fold((f64::INFINITY, 0.0), |(least, most), value| (value.min(least), value.max(most)));
    least > 0.0 && most > DECADES * least
}

/// Objective and violation over iterations, and design variables.
pub fn charts(optimization: &Optimization, history: &DesignHistory) -> Vec<Chart> {
    let mut reached: Vec<(f64, &DesignPoint)> =
        history.points.iter().filter_map(|point| Some((point.iteration? as f64, point))).collect();
    reached.sort_by(|a, b| a.0.total_cmp(&b.0));
    let curve = |name: &str, value: &dyn Fn(&DesignPoint) -> f64| Series {
        name: name.into(),
        points: reached.iter().map(|(iteration, point)| (*iteration, value(point))).collect(),
        style: Style::Both,
    };
    let problem = &optimization.problem;
    let units: Vec<&str> = history.functionals.iter().map(|functional| functional.1.as_str()).collect();
    let label = problem.objective_name();
    let objective = Chart {
        title: format!("{}: {} {label}", optimization.scene.name(), problem.sense.name()),
        x_label: "iteration".into(),
        y_label: if problem.objective.len() == 1 && units.len() == 1 {
            format!("objective [{}]", units[0])
        } else {
            "objective".into()
        },
        series: vec![curve("", &|point| point.objective)],
        log_y: spans_decades(reached.iter().map(|(_, point)| point.objective)),
        ..Chart::default()
    };
    let mut panels = vec![objective];
    let tolerance = history.tolerance;
    if reached.iter().any(|(_, point)| point.violation > tolerance) {
        panels.push(Chart {
            x_label: "iteration".into(),
            y_label: format!("violation ({tolerance:e}: none)"),
            series: vec![curve("", &|point| point.violation.max(tolerance))],
            log_y: true,
            ..Chart::default()
        });
    }

    let relative = |i: usize, point: &DesignPoint| {
        let DesignVariable { lower, upper, .. } = &optimization.variables()[i];
        let range = upper - lower;
        if range.is_finite() { (point.design[i] - lower) / range } else { point.design[i] / history.points[0].design[i] }
    };
    let moved = |i: usize| {
        let values = reached.iter().map(|(_, point)| relative(i, point));
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let mut places = optimization.varying();
    if places.len() > MOST_CURVES {
        places.sort_by(|&a, &b| moved(b).total_cmp(&moved(a)));
        places.truncate(MOST_CURVES);
        places.sort_unstable();
    }
    let series = places.iter().map(|&i| curve(&optimization.variables()[i].name, &|point| relative(i, point)));
    let design = Chart {
        title: format!("{}: design variables between their bounds", optimization.scene.name()),
        x_label: "iteration".into(),
        y_label: "0: lower bound, 1: upper bound".into(),
        series: series.collect(),
        ..Chart::default()
    };
    panels.push(design);
    panels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_logarithmic_where_a_linear_one_hides_the_small_numbers() {
        for (values, spans) in [
            (&[58.0, 1e-5, 1e-6][..], true),
            (&[58.0, 5.0], false),
            (&[58.0, 0.0], false),
            (&[58.0, -1e-6], false),
            (&[f64::NAN], false),
            (&[], false),
        ] {
            assert_eq!(spans_decades(values.iter().copied()), spans, "{values:?}");
        }
    }
}
