//! Scenes fitted to measurements: estimates, covariances and derivatives against closed forms, complex steps and difference quotients.

mod cases;

use crate::{Form, Noise, Report, Study};
use cases::{ARM, CHAIN, Made, OSCILLATOR, QUARTER_CAR, drawn, exact, fit_to, read};
use costate::optimize::{Combined, Fit, Fitted};
use costate::scalar::{COMPLEX_STEP, Complex64, Scalar};
use costate::scenes::{AnyScene, FitProblem, Loss, Measurement, Prepared, Prior, built_in};

/// Derivatives against complex steps, and against difference quotients of whole runs, by the largest derivative by the same variable.
const DERIVATIVES: f64 = 1e-11;
const OF_QUOTIENTS: f64 = 1e-6;
/// Estimates from exact data, by their values.
const EXACT: f64 = 1e-7;
/// A covariance against that of the closed form.
const COVARIANCE: f64 = 0.02;
/// Standard deviations within which estimates are, of 95 % of all data sets.
const DEVIATIONS: f64 = 3.0;
const SHARE: f64 = 0.95;

/// The study.
pub struct FitToMeasurements;

impl Study for FitToMeasurements {
    fn name(&self) -> &'static str {
        "fit"
    }
    fn summary(&self) -> &'static str {
        "scenes fitted to measurements: estimates and covariances against closed forms, derivatives, outliers, what cannot be told apart"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        derivatives(report)?;
        closed_form(report)?;
        data_sets(report)?;
        undetermined(report)?;
        outliers(report)?;
        priors_and_delays(report)?;
        for case in [CHAIN, QUARTER_CAR, ARM] {
            recovered(report, &case)?;
        }
        Ok(())
    }
}

fn words(why: impl ToString) -> String {
    why.to_string()
}

/// Measurements of all functionals of a scene at times that do not end steps, but of times of events, which are no numbers before these.
fn of_all(scene: &dyn AnyScene) -> Result<Vec<Measurement>, String> {
    let (prepared, end) = (Prepared::new(scene).map_err(words)?, scene.settings().end);
    let times: Vec<f64> = (0..23).map(|k| end * (0.01 + f64::from(k)) / 22.02).collect();
    let of = |functional: &costate::functionals::Functional| Measurement {
        name: functional.name.clone(),
        functional: functional.name.clone(),
        unit: None,
        times: times.clone(),
        values: vec![0.0; times.len()],
        deviations: None,
        delay: None,
    };
    Ok(prepared.functionals().iter().filter(|own| !own.name.starts_with("time ")).map(of).collect())
}

/// The Jacobian by tangents against that by complex steps and by difference quotients of whole runs.
fn check_jacobian(report: &mut Report, name: &str, fit: &Fit, x: &[f64]) -> Result<(), String> {
    let [tangent, complex] = [false, true].map(|by_complex_step| fit.jacobian(x, by_complex_step).map_err(words));
    let (tangent, complex) = (tangent?, complex?);
    let (mut apart, mut of_quotients) = (0.0_f64, 0.0_f64);
    for (place, &variable) in fit.varying().iter().enumerate() {
        let size = complex.iter().fold(f64::MIN_POSITIVE, |most: f64, row| most.max(row[place].abs()));
        let between = |own: &Vec<f64>, other: f64| (own[place] - other).abs() / size;
        apart = tangent.iter().zip(&complex).fold(apart, |most, (own, other)| most.max(between(own, other[place])));
        // a step is too long or too short: the better one counts
        let mut least = f64::INFINITY;
        for share in [1e-4, 1e-5] {
            let step = share * fit.variables()[variable].size(x[variable]);
            let beside = |steps: f64| {
                let mut moved = x.to_vec();
                moved[variable] += steps * step;
                fit.residuals(&moved).map_err(words)
            };
            // of fourth order
            let [a, b, c, d] = [beside(-2.0)?, beside(-1.0)?, beside(1.0)?, beside(2.0)?];
            let quotient = |row: usize| (a[row] - d[row] + 8.0 * (c[row] - b[row])) / (12.0 * step);
            let most = (0..a.len()).fold(0.0, |most: f64, row| most.max(between(&tangent[row], quotient(row))));
            least = least.min(most);
        }
        of_quotients = of_quotients.max(least);
    }
    report.at_most(format!("{name}/derivatives against complex step"), apart, DERIVATIVES);
    report.at_most(format!("{name}/derivatives against quotients of runs"), of_quotients, OF_QUOTIENTS);
    Ok(())
}

/// Derivatives of all functionals of some scenes, with breakpoints and events among them, and of a delay.
fn derivatives(report: &mut Report) -> Result<(), String> {
    eprintln!("[1/7] derivatives");
    for name in ["pendulum", "five-bar", "quarter-car", "bouncing-ball", "knee-stop", "escapement"] {
        let scene = built_in::named(name)?;
        let problem = FitProblem { measurements: of_all(scene)?, ..FitProblem::default() };
        let fit = fit_to(scene, problem).map_err(words)?;
        check_jacobian(report, name, &fit, &fit.initial())?;
    }
    let scene = read(&OSCILLATOR)?;
    let mut measurements = exact(&scene, &OSCILLATOR, OSCILLATOR.truth).map_err(words)?;
    measurements[0].delay = Some("delay".into());
    let fit = fit_to(&scene, FitProblem { measurements, ..FitProblem::default() }).map_err(words)?;
    let x = [&OSCILLATOR.truth[..4], &[0.013]].concat();
    check_jacobian(report, "oscillator with a delay", &fit, &x)
}

/// Place of the oscillator of 2 kg at a time, for stiffness, damping and where it is let go.
fn place<S: Scalar>([k, c, a]: [S; 3], t: f64) -> S {
    let decay = c * 0.25;
    let omega = (k * 0.5 - decay * decay).sqrt();
    a * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin())
}

/// The first three variables of the oscillator, which are fitted.
const VARYING: [&str; 3] = ["stiffness", "damping", "release"];

fn problem(measurements: Vec<Measurement>, varying: &[&str]) -> FitProblem {
    let varying = Some(varying.iter().map(ToString::to_string).collect());
    FitProblem { measurements, varying, ..FitProblem::default() }
}

fn fitted(scene: &dyn AnyScene, problem: FitProblem) -> Result<Fitted, String> {
    let fit = fit_to(scene, problem).map_err(words)?;
    let fitted = fit.run(&fit.initial(), &mut ()).map_err(words)?;
    if fitted.is_optimum { Ok(fitted) } else { Err(format!("a fit did not end at a least sum: {fitted:?}")) }
}

/// Estimates and covariance from the closed form of the oscillation.
fn closed_form(report: &mut Report) -> Result<(), String> {
    eprintln!("[2/7] closed form");
    let scene = read(&OSCILLATOR)?;
    let mut measurements = exact(&scene, &OSCILLATOR, OSCILLATOR.truth).map_err(words)?;
    let [k, c, a] = [0, 1, 2].map(|own| OSCILLATOR.truth[own]);
    let times = measurements[0].times.clone();
    let exact: Vec<f64> = times.iter().map(|&t| place([k, c, a], t)).collect();
    let apart = measurements[0].values.iter().zip(&exact).fold(0.0, |most: f64, (own, exact)| most.max((own - exact).abs()));
    report.at_most("oscillator/values against the closed form, by the first place", apart / a, 1e-6);
    measurements[0].values = exact;
    let own = fitted(&scene, problem(measurements, &VARYING))?;
    for (variable, name) in VARYING.iter().enumerate() {
        let truth = OSCILLATOR.truth[variable];
        report.compare(
            format!("oscillator/{name} from the closed form, by its value"),
            own.design[variable] / truth,
            1.0,
            1e-5,
        );
    }
    report.inform("oscillator/iterations", own.iterations as f64);
    // (J^T J)^-1 of the closed form, differentiated by a complex step
    let column = |variable: usize| {
        let mut x = [k, c, a].map(Complex64::from);
        x[variable].im = COMPLEX_STEP;
        times.iter().map(|&t| place(x, t).im / COMPLEX_STEP / OSCILLATOR.measured[0].1).collect::<Vec<_>>()
    };
    let columns = [0, 1, 2].map(column);
    let product = |i: usize, j: usize| columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum::<f64>();
    let covariance = nalgebra::DMatrix::from_fn(3, 3, product).try_inverse().ok_or("the closed form tells nothing")?;
    for i in 0..3 {
        for j in 0..=i {
            let name = format!("oscillator/covariance of {} and {} by that of the closed form", VARYING[i], VARYING[j]);
            report.compare(name, own.confidence.covariance[i][j] / covariance[(i, j)], 1.0, COVARIANCE);
        }
    }
    Ok(())
}

/// Data sets with errors that are drawn: how many estimates lie within their deviations.
fn data_sets(report: &mut Report) -> Result<(), String> {
    eprintln!("[3/7] drawn data sets");
    let sets = if report.is_short() { 20 } else { 200 };
    let scene = read(&OSCILLATOR)?;
    let exact = exact(&scene, &OSCILLATOR, OSCILLATOR.truth).map_err(words)?;
    let mut noise = Noise::new(report.seed() + 1);
    let (mut all_within, mut within_one, mut squares, mut sums) = (0, 0, 0.0, 0.0);
    for _ in 0..sets {
        let own = fitted(&scene, problem(drawn(&exact, &mut noise), &VARYING))?;
        let off = |variable: usize| (own.design[variable] - OSCILLATOR.truth[variable]) / own.confidence.deviation(variable);
        let off = [0, 1, 2].map(off);
        all_within += usize::from(off.iter().all(|off| off.abs() <= DEVIATIONS));
        within_one += off.iter().filter(|off| off.abs() <= 1.0).count();
        squares += off.iter().map(|off| off * off).sum::<f64>();
        sums += own.sum / own.degrees as f64;
    }
    let count = sets as f64;
    let share = all_within as f64 / count;
    report.compare(format!("{sets} data sets/share with all estimates within 3 deviations"), share, 1.0, 1.0 - SHARE);
    report.inform(
        format!("{sets} data sets/share of estimates within 1 deviation (0.683)"),
        within_one as f64 / (3.0 * count),
    );
    // the mean of the squares of 3 n normal numbers, and of sums of squares, within four deviations of theirs
    let spread = 4.0 * (2.0 / (3.0 * count)).sqrt();
    report.compare(format!("{sets} data sets/mean square of estimates by deviations"), squares / (3.0 * count), 1.0, spread);
    let spread = 4.0 * (2.0 / (57.0 * count)).sqrt();
    report.compare(format!("{sets} data sets/sum by degrees of freedom"), sums / count, 1.0, spread);
    Ok(())
}

/// A free oscillation tells stiffness, damping and mass by their ratios alone.
fn undetermined(report: &mut Report) -> Result<(), String> {
    eprintln!("[4/7] what cannot be told apart");
    let scene = read(&OSCILLATOR)?;
    let measurements = exact(&scene, &OSCILLATOR, OSCILLATOR.truth).map_err(words)?;
    let own = fitted(&scene, problem(measurements, &["stiffness", "damping", "release", "mass"]))?;
    let unknown: Vec<&Combined> = own.confidence.combinations.iter().filter(|own| own.deviation.is_infinite()).collect();
    report.compare("free oscillation/combinations that are not determined", unknown.len() as f64, 1.0, 0.0);
    let expected = [1.0, 1.0, 0.0, 1.0].map(|own: f64| own / 3.0_f64.sqrt());
    let apart = unknown.first().map_or(f64::NAN, |own| {
        own.coefficients.iter().zip(expected).fold(0.0, |most: f64, (own, expected)| most.max((own - expected).abs()))
    });
    report.at_most("free oscillation/that of stiffness, damping and mass, by its size", apart, 1e-6);
    let x = &own.design;
    report.compare("free oscillation/stiffness by mass", x[0] / x[3], 40.0, 40.0 * EXACT);
    Ok(())
}

/// One value that is wrong by 60 deviations.
fn outliers(report: &mut Report) -> Result<(), String> {
    eprintln!("[5/7] outliers");
    let scene = read(&OSCILLATOR)?;
    let exact = exact(&scene, &OSCILLATOR, OSCILLATOR.truth).map_err(words)?;
    let mut measurements = drawn(&exact, &mut Noise::new(report.seed() + 5));
    measurements[0].values[7] += 60.0 * OSCILLATOR.measured[0].1;
    for loss in [Loss::Linear, Loss::Huber, Loss::SoftL1, Loss::Cauchy] {
        let own = fitted(&scene, FitProblem { loss, ..problem(measurements.clone(), &VARYING) })?;
        let off = |variable: usize| {
            let off = (own.design[variable] - OSCILLATOR.truth[variable]) / own.confidence.deviation(variable);
            off.abs()
        };
        let most = [0, 1, 2].map(off).into_iter().fold(0.0, f64::max);
        let name = format!("outlier of 60 deviations/{}/largest error of an estimate by its deviation", loss.name());
        match loss {
            Loss::Linear => report.inform(name, most),
            _ => report.at_most(name, most, DEVIATIONS),
        }
    }
    Ok(())
}

/// A prior is one more measurement; a delay is found with the rest.
fn priors_and_delays(report: &mut Report) -> Result<(), String> {
    eprintln!("[6/7] priors and delays");
    let scene = read(&OSCILLATOR)?;
    let mut measurements = exact(&scene, &OSCILLATOR, OSCILLATOR.truth).map_err(words)?;
    // what nothing tells has the deviation of its prior
    let mut with_prior = problem(measurements.clone(), &["stiffness", "damping", "release", "mass"]);
    with_prior.priors = vec![Prior { variable: "mass".into(), mean: 2.0, deviation: 0.1 }];
    let own = fitted(&scene, with_prior)?;
    report.compare("prior/mass by its prior", own.design[3] / 2.0, 1.0, EXACT);
    report.compare("prior/deviation of the mass", own.confidence.deviation(3), 0.1, 1e-7);
    // the same motion, looked at 17 ms later
    let [k, c, a] = [0, 1, 2].map(|own| OSCILLATOR.truth[own]);
    let truth = 0.017;
    measurements[0].times.iter_mut().for_each(|t| *t += 0.04 * (3.0 - *t) / 3.0);
    measurements[0].values = measurements[0].times.iter().map(|t| place([k, c, a], t - truth)).collect();
    measurements[0].delay = Some("delay".into());
    let own = fitted(&scene, problem(measurements, &["stiffness", "damping", "release", "delay"]))?;
    report.compare("delay/of 17 ms [s]", own.design[4], truth, 1e-6);
    report.compare("delay/stiffness beside it, by its value", own.design[0] / k, 1.0, 1e-5);
    Ok(())
}

/// Numbers of a mechanism from what sensors tell: exactly from exact values, and within their deviations from those with errors.
fn recovered(report: &mut Report, case: &Made) -> Result<(), String> {
    eprintln!("[7/7] {}", case.name);
    let scene = read(case)?;
    let exact = exact(&scene, case, case.truth).map_err(words)?;
    let all: Vec<String> = scene.variables().into_iter().map(|own| own.name).collect();
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    let own = fitted(&scene, problem(exact.clone(), &all))?;
    let apart = own.design.iter().zip(case.truth).fold(0.0, |most: f64, (own, truth)| most.max((own / truth - 1.0).abs()));
    report.at_most(format!("{}/estimates from exact values, by their own", case.name), apart, EXACT);
    report.inform(format!("{}/iterations", case.name), own.iterations as f64);
    let own = fitted(&scene, problem(drawn(&exact, &mut Noise::new(report.seed() + 9)), &all))?;
    for (variable, name) in all.iter().enumerate() {
        let deviation = own.confidence.deviation(variable);
        let off = (own.design[variable] - case.truth[variable]) / deviation;
        report.at_most(format!("{}/{name}/error by its deviation", case.name), off.abs(), DEVIATIONS);
        report.inform(format!("{}/{name}/deviation by its value", case.name), deviation / own.design[variable]);
    }
    Ok(())
}
