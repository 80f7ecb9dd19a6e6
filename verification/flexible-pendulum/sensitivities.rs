//! Sensitivities of the deflection of the tip to height, density and Young's modulus over time.

use super::path::{MOMENTS, pendulum, prepare};
use super::{END, line};
use crate::Report;
use costate::integrators::{DEFAULT_TABLE, RunError};
use costate::sensitivity::GradientCourse;
use costate_cli::Chart;

/// Largest difference of exact derivatives, by the largest one so far.
const EXACT: f64 = 1e-12;
/// Moments at which the adjoint of a run that ends there is compared.
const ENDS: [usize; 8] = [50, 100, 150, 200, 250, 300, 350, 400];
/// The design variables, and the units of the sensitivities to them.
const VARIABLES: [(&str, &str); 3] = [("h", "m/m"), ("rho", "m4/kg"), ("E", "m3/N")];
const RHO: usize = 1;
const YOUNG: usize = 2;

/// Largest of the differences, each by the largest of the sizes up to it.
fn by_largest_so_far(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for (difference, size) in pairs {
        largest = largest.max(size.abs());
        let own = if difference == 0.0 { 0.0 } else { difference.abs() / largest };
        // a maximum that keeps NaN
        worst = if own <= worst { worst } else { own };
    }
    worst
}

/// Deflection with its derivatives at every step; with a report, these are compared with complex step and adjoint.
fn course(elements: usize, method: &str, steps: usize, report: Option<&mut Report>) -> Result<GradientCourse, RunError> {
    let scene = pendulum(elements)?;
    let prepared = prepare(&scene, method, END, steps)?;
    let mut analysis = prepared.analysis();
    analysis.functionals = &prepared.functionals()[..1];
    let x = &prepared.x;
    let forward = analysis.forward(x)?;
    let tangent = analysis.tangent_over_time(x, &forward)?;
    let Some(report) = report else { return Ok(tangent) };
    let complex = analysis.complex_step_over_time(x, &forward)?;
    let figure = |what: &str| format!("sensitivities/{method}/{elements} elements, {} ms/{what}", 1e3 * END / steps as f64);
    for (variable, (name, _)) in VARIABLES.into_iter().enumerate() {
        let (own, exact) = (&tangent.derivatives[0][variable], &complex.derivatives[0][variable]);
        let worst = by_largest_so_far(own.iter().zip(exact).map(|(own, exact)| (own - exact, *exact)));
        report.at_most(figure(&format!("direct differentiation - complex step at every step, {name}")), worst, EXACT);
    }
    let mut worst = [0.0_f64; 3];
    for end in ENDS {
        let last = end * steps / MOMENTS;
        let part = prepare(&scene, method, END * end as f64 / MOMENTS as f64, last)?;
        let mut analysis = part.analysis();
        analysis.functionals = &part.functionals()[..1];
        let adjoint = analysis.adjoint(x, &analysis.forward(x)?)?;
        for (variable, worst) in worst.iter_mut().enumerate() {
            let exact = &complex.derivatives[0][variable];
            let largest = exact[..=last].iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            *worst = worst.max((adjoint.rows[0][variable] - exact[last]).abs() / largest);
        }
    }
    for ((name, _), worst) in VARIABLES.into_iter().zip(worst) {
        // the runs that end earlier have steps that differ in their last digits
        report.at_most(figure(&format!("adjoint - complex step at eight ends, {name}")), worst, 10.0 * EXACT);
    }
    // lengths and gravity leave one speed, sqrt(E / rho): rho df/drho + E df/dE = 0
    let of = |variable: usize| tangent.derivatives[0][variable].iter().map(move |derivative| x[variable] * derivative);
    let sums = of(RHO).zip(of(YOUNG)).map(|(rho, young)| (rho + young, young));
    report.at_most(figure("rho d/drho + E d/dE"), by_largest_so_far(sums), 1e-9);
    Ok(tangent)
}

/// Largest difference of two courses at the moments, by the largest of the second.
fn difference(own: &GradientCourse, other: &GradientCourse, variable: usize) -> f64 {
    let at_moments = |course: &GradientCourse| -> Vec<f64> {
        let stride = (course.times.len() - 1) / MOMENTS;
        course.derivatives[0][variable].iter().step_by(stride).copied().collect()
    };
    let (own, other) = (at_moments(own), at_moments(other));
    let largest = other.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    own.iter().zip(&other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / largest
}

pub fn over_time(report: &mut Report) -> Result<(), RunError> {
    let variational = course(5, "variational", 4000, Some(report))?;
    let default = course(5, DEFAULT_TABLE, 1600, Some(report))?;
    let [coarse, fine, finest] = [10, 20, 40].map(|elements| course(elements, DEFAULT_TABLE, 3200, None));
    let (coarse, fine, finest) = (coarse?, fine?, finest?);
    let mut charts = Vec::new();
    for (variable, (name, unit)) in VARIABLES.into_iter().enumerate() {
        let figure = |what: &str| format!("sensitivities/to {name}/{what}, largest difference by the largest");
        let apart = |own: &GradientCourse, other: &GradientCourse| difference(own, other, variable);
        report.inform(figure("variational, 1 ms, against esdirk4, 2.5 ms, 5 elements"), apart(&variational, &default));
        report.inform(figure("5 elements against 40"), apart(&default, &finest));
        report.inform(figure("10 elements against 40"), apart(&coarse, &finest));
        report.at_most(figure("20 elements against 40"), apart(&fine, &finest), 0.05);
        let points = |course: &GradientCourse| -> Vec<(f64, f64)> {
            course.times.iter().copied().zip(course.derivatives[0][variable].iter().copied()).collect()
        };
        let series = [("5 elements, variational, 1 ms", &variational), ("40 elements, esdirk4, 1.25 ms", &finest)];
        charts.push(Chart {
            x_label: "time [s]".into(),
            y_label: format!("d deflection / d {name} [{unit}]"),
            series: series.into_iter().map(|(name, course)| line(name, points(course).into_iter())).collect(),
            ..Chart::default()
        });
    }
    report.picture("sensitivities", charts);
    Ok(())
}
