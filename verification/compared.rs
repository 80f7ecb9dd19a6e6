//! Scenes of files whose functionals are compared with values and derivatives from elsewhere.

use crate::{Report, largest};
use costate::integrators::StepControl;
use costate::scenes::{AnyScene, FileScene, Prepared, Settings};
use costate::sensitivity::largest_difference;

/// How many times as few steps the comparison with complex step has.
const FEWER: usize = 10;

/// A scene of a file, whose functionals have the names of the references.
pub struct Case {
    pub name: &'static str,
    /// Its name among the references.
    pub reference: &'static str,
    pub text: &'static str,
    /// Limits of the relative errors of values and derivatives with the steps that the file gives.
    pub given: [f64; 2],
    /// Tolerance of chosen steps.
    pub tolerance: f64,
    /// Limits with chosen steps.
    pub chosen: [f64; 2],
    /// Limit of the adjoint against complex step, by the largest derivative of a row.
    pub exact: f64,
}

/// Values and derivatives to compare with.
pub struct References(Vec<([&'static str; 3], f64)>);

impl References {
    /// Reads a table: case, functional, variable or "value", number.
    pub fn read(table: &'static str) -> Result<Self, String> {
        let row = |line: &'static str| {
            let fields: Vec<&str> = line.split(',').collect();
            let [case, functional, variable, number] = fields[..] else {
                return Err(format!("\"{line}\" has no four fields"));
            };
            let number = number.parse::<f64>().map_err(|why| format!("\"{line}\": {why}"))?;
            Ok(([case, functional, variable], number))
        };
        let rows = table.lines().skip(1).map(row);
        Ok(References(rows.collect::<Result<_, String>>()?))
    }

    /// The value of a functional of a case.
    pub fn value(&self, case: &str, functional: &str) -> Result<f64, String> {
        let found = self.derivative(case, functional, "value");
        found.ok_or_else(|| format!("there is no value of \"{functional}\" of {case}"))
    }

    /// Its derivative by a variable, if there is one.
    pub fn derivative(&self, case: &str, functional: &str, variable: &str) -> Option<f64> {
        self.0.iter().find(|own| own.0 == [case, functional, variable]).map(|own| own.1)
    }
}

/// Measures a part of the study; where it fails, that is a failed figure with its reason, and the others go on.
pub fn told(report: &mut Report, name: &str, measure: impl FnOnce(&mut Report) -> Result<(), String>) {
    if let Err(why) = measure(report) {
        report.note(format!("{name}: {why}"));
        report.at_most(format!("{name}/runs to its end"), f64::NAN, 0.0);
    }
}

/// Values and gradients of a run, by names.
pub struct Measured {
    pub functionals: Vec<String>,
    pub variables: Vec<String>,
    pub x: Vec<f64>,
    pub values: Vec<f64>,
    pub rows: Vec<Vec<f64>>,
    /// Largest difference of a row to the complex step; zero where none is asked for.
    pub apart: f64,
}

/// What is measured of a run.
#[derive(Clone, Copy, PartialEq)]
pub enum Check {
    Gradient,
    ComplexStep,
}

pub fn measure(text: &str, settings: impl FnOnce(Settings) -> Settings, check: Check) -> Result<Measured, String> {
    let scene = FileScene::parse("case.toml", text)?;
    let x: Vec<f64> = AnyScene::variables(&scene).iter().map(|variable| variable.initial).collect();
    let settings = settings(AnyScene::settings(&scene));
    let method = Prepared::method_of(&settings).map_err(|why| why.to_string())?;
    let prepared = Prepared::with(&scene, &x, method, settings).map_err(|why| why.to_string())?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).map_err(|why| why.to_string())?;
    let rows = analysis.adjoint(&x, &forward).map_err(|why| why.to_string())?.rows;
    let mut apart = 0.0;
    if check == Check::ComplexStep {
        let complex = analysis.complex_step(&x, &forward).map_err(|why| why.to_string())?.rows;
        apart = largest(complex.iter().zip(&rows).map(|(complex, own)| largest_difference(complex, own)));
    }
    Ok(Measured {
        functionals: prepared.functionals().iter().map(|own| own.name.to_string()).collect(),
        variables: prepared.variables.iter().map(|own| own.name.to_string()).collect(),
        x,
        values: forward.values.clone(),
        rows,
        apart,
    })
}

impl Measured {
    /// Errors of the functional k: of its value, by that, and the largest of its derivatives, each by itself; of one that is zero x df/dx by the
    /// largest of the others.
    pub fn errors(&self, k: usize, case: &str, references: &References) -> Result<[f64; 2], String> {
        let name = &self.functionals[k];
        let value = references.value(case, name)?;
        let exact = self.variables.iter().map(|variable| references.derivative(case, name, variable));
        // a case may have derivatives by some variables only
        let exact: Vec<Option<f64>> = exact.collect();
        let size = |x: f64| if x == 0.0 { 1.0 } else { x.abs() };
        let effects = exact.iter().zip(&self.x).filter_map(|(exact, x)| exact.map(|exact| (exact * size(*x)).abs()));
        let most = effects.fold(0.0, f64::max);
        let of_derivative = |(i, exact): (usize, &Option<f64>)| {
            let exact = (*exact)?;
            let error = (self.rows[k][i] - exact).abs();
            Some(if exact == 0.0 { error * size(self.x[i]) / most } else { error / exact.abs() })
        };
        let of_row = largest(exact.iter().enumerate().filter_map(of_derivative));
        Ok([(self.values[k] - value).abs() / value.abs(), of_row])
    }

    fn largest_errors(&self, case: &str, references: &References) -> Result<[f64; 2], String> {
        let all = (0..self.functionals.len()).map(|k| self.errors(k, case, references));
        let all: Vec<[f64; 2]> = all.collect::<Result<_, _>>()?;
        Ok([0, 1].map(|which| largest(all.iter().map(|errors| errors[which]))))
    }
}

/// A case with the steps that its file gives, with chosen ones, and its adjoint against complex step.
pub fn compare(report: &mut Report, case: &Case, references: &References) -> Result<(), String> {
    let Case { name, reference, text, given, tolerance, chosen, exact } = case;
    let tell = |report: &mut Report, steps: &str, measured: &Measured, limits: [f64; 2]| -> Result<(), String> {
        let [value, derivative] = measured.largest_errors(reference, references)?;
        report.at_most(format!("{name}/{steps}/largest relative error of a value"), value, limits[0]);
        report.at_most(format!("{name}/{steps}/largest relative error of a derivative"), derivative, limits[1]);
        Ok(())
    };
    tell(report, "given steps", &measure(text, |settings| settings, Check::Gradient)?, *given)?;
    let fewer = |settings: Settings| Settings { steps: settings.steps / FEWER, ..settings };
    let apart = measure(text, fewer, Check::ComplexStep)?.apart;
    report.at_most(format!("{name}/adjoint against complex step"), apart, *exact);
    if report.is_short() {
        return Ok(());
    }
    let by_error = |settings: Settings| settings.choosing_steps(StepControl::new(*tolerance));
    tell(report, "chosen steps", &measure(text, by_error, Check::Gradient)?, *chosen)
}
