//! Which designs a sweep runs: a grid of values of some variables, or points drawn in their ranges.

use super::SweepOptions;
use crate::failure::Failure;
use crate::options::variable_named;
use clap::ValueEnum;
use costate::design::{DesignVariable, check_design, latin_hypercube, shortest, sobol};

pub const MOST_DESIGNS: usize = 1_000_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Sampling {
    // each of N equal strata of a range has one design
    LatinHypercube,
    // of low discrepancy, evenest where N is a power of two
    Sobol,
}

impl Sampling {
    pub fn name(self) -> &'static str {
        match self {
            Sampling::LatinHypercube => "latin-hypercube",
            Sampling::Sobol => "sobol",
        }
    }
}

pub struct Axis {
    /// Its place among the variables of the scene.
    pub place: usize,
    pub range: (f64, f64),
    /// Equal steps are those of the logarithm.
    pub log: bool,
    values: Option<Vec<f64>>,
}

impl Axis {
    /// The value at a share of the way from one end of the range to the other.
    fn at(&self, share: f64) -> f64 {
        let (from, to) = self.range;
        let between = |from: f64, to: f64| from + share * (to - from);
        let value = if self.log { 10f64.powf(between(from.log10(), to.log10())) } else { between(from, to) };
        match share {
            0.0 => from,
            1.0 => to,
            // rounding leaves no range
            _ => value.clamp(from, to),
        }
    }
}

pub struct Variation {
    pub axes: Vec<Axis>,
    pub points: Vec<Vec<f64>>,
    /// How they were chosen, in words.
    pub words: String,
}

impl Variation {
    /// What `--vary`, `--samples`, `--sampling` and `--seed` say together.
    pub fn of(options: &SweepOptions, variables: &[DesignVariable], set: &[usize]) -> Result<Self, Failure> {
        let Some(samples) = options.samples else { return Self::grid(options, variables, set) };
        let mut axes = axes(&options.vary, variables, set)?;
        if let Some((_, given)) = axes.iter().zip(&options.vary).find(|(axis, _)| axis.values.is_some()) {
            return Err(refused(
                given,
                "with --samples it must be a range without a count: NAME=FROM:TO or NAME=FROM:TO:log",
            ));
        }
        if axes.is_empty() {
            axes = axes_of_bounds(variables, set)?;
        }
        let (sampling, dimensions) = (options.sampling, axes.len());
        let shares = match sampling {
            Sampling::LatinHypercube => latin_hypercube(samples, dimensions, options.seed.unwrap_or_default()),
            Sampling::Sobol => sobol(samples, dimensions, options.seed).map_err(|message| {
                Failure::input(format!(
                    "--sampling sobol: {message}; take latin-hypercube, or name fewer variables by --vary"
                ))
            })?,
        };
        let points = shares.iter().map(|shares| axes.iter().zip(shares).map(|(axis, &share)| axis.at(share)).collect());
        Ok(Variation { points: points.collect(), axes, words: format!("drawn by {}", sampling.name()) })
    }

    fn grid(options: &SweepOptions, variables: &[DesignVariable], set: &[usize]) -> Result<Self, Failure> {
        let axes = axes(&options.vary, variables, set)?;
        if axes.is_empty() {
            let variable = variables.first().map_or("NAME", |variable| &variable.name);
            return Err(Failure::input(format!(
                "nothing varies: name variables by --vary, as in --vary {variable}=FROM:TO:COUNT, or draw designs within the \
                 bounds of all by --samples N"
            )));
        }
        let mut points = vec![Vec::new()];
        for (axis, given) in axes.iter().zip(&options.vary) {
            let values = axis.values.as_ref().ok_or_else(|| {
                refused(given, "a grid needs a count, as in NAME=FROM:TO:COUNT; or draw designs in ranges by --samples N")
            })?;
            if points.len() * values.len() > MOST_DESIGNS {
                return Err(refused(
                    given,
                    &format!("the grid has more than {MOST_DESIGNS} designs: take fewer values, or --samples N"),
                ));
            }
            // the last variable varies fastest
            points =
                points.iter().flat_map(|point| values.iter().map(move |&value| [&point[..], &[value]].concat())).collect();
        }
        Ok(Variation { axes, points, words: "of a grid".into() })
    }

    /// The values of the axes put into a design.
    pub fn design(&self, base: &[f64], number: usize) -> Vec<f64> {
        let mut x = base.to_vec();
        self.axes.iter().zip(&self.points[number]).for_each(|(axis, &value)| x[axis.place] = value);
        x
    }
}

fn refused(given: &str, message: &str) -> Failure {
    Failure::input(format!("--vary {given}: {message}"))
}

/// Every variable that has a range, within its bounds.
fn axes_of_bounds(variables: &[DesignVariable], set: &[usize]) -> Result<Vec<Axis>, Failure> {
    let mut axes = Vec::new();
    for (place, DesignVariable { name, lower, upper, .. }) in variables.iter().enumerate() {
        if set.contains(&place) || lower == upper {
            continue;
        }
        if !(lower.is_finite() && upper.is_finite()) {
            return Err(Failure::input(format!(
                "--samples: \"{name}\" has no bound on a side; name ranges by --vary, as in --vary {name}=FROM:TO"
            )));
        }
        axes.push(Axis { place, range: (*lower, *upper), log: false, values: None });
    }
    if axes.is_empty() { Err(Failure::input("--samples: no variable of the scene is left to vary")) } else { Ok(axes) }
}

fn axes(given: &[String], variables: &[DesignVariable], set: &[usize]) -> Result<Vec<Axis>, Failure> {
    let mut axes: Vec<Axis> = Vec::new();
    for given in given {
        let (name, values) = given.split_once('=').ok_or_else(|| {
            refused(
                given,
                "it must read NAME=FROM:TO:COUNT, NAME=FROM:TO:COUNT:log or NAME=VALUE,VALUE; with --samples NAME=FROM:TO",
            )
        })?;
        let place = variable_named(variables, name.trim()).map_err(|message| refused(given, &message))?;
        if set.contains(&place) {
            return Err(refused(given, "--set gives it one value; leave one of the two out"));
        }
        if axes.iter().any(|own| own.place == place) {
            return Err(refused(given, "it varies already; give all its values at once"));
        }
        let axis = axis(place, values.trim()).map_err(|message| refused(given, &message))?;
        for end in [axis.range.0, axis.range.1] {
            check_design(&variables[place..=place], &[end]).map_err(|message| refused(given, &message))?;
        }
        axes.push(axis);
    }
    Ok(axes)
}

fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("\"{text}\" is not a number")),
    }
}

/// A range, with or without the count of its values, or a list of values.
fn axis(place: usize, text: &str) -> Result<Axis, String> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let (range, log) = match parts.split_last() {
        Some((&"log", range)) => (range, true),
        _ => (&parts[..], false),
    };
    let (from, to, count) = match *range {
        [list] if !log => {
            let values = list.split(',').map(number).collect::<Result<Vec<f64>, String>>()?;
            let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
            return Ok(Axis { place, range: ends, log, values: Some(values) });
        }
        [from, to] => (number(from)?, number(to)?, None),
        [from, to, count] => (number(from)?, number(to)?, Some(count)),
        _ => {
            return Err(
                "it must read FROM:TO:COUNT, FROM:TO:COUNT:log or VALUE,VALUE; with --samples FROM:TO or FROM:TO:log".into(),
            );
        }
    };
    if from >= to {
        let [from, to] = [from, to].map(shortest);
        return Err(format!("a range goes from a number to a larger one, not from {from} to {to}"));
    }
    if log && from <= 0.0 {
        return Err(format!("a logarithmic range lies above 0, but this one begins at {}", shortest(from)));
    }
    let mut axis = Axis { place, range: (from, to), log, values: None };
    axis.values = count
        .map(|count| match count.parse::<usize>() {
            Ok(count) if (2..=MOST_DESIGNS).contains(&count) => {
                Ok((0..count).map(|k| axis.at(k as f64 / (count - 1) as f64)).collect())
            }
            _ => Err(format!(
                "the count \"{count}\" must be a whole number from 2 to {MOST_DESIGNS}; one value is NAME=VALUE"
            )),
        })
        .transpose()?;
    Ok(axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<f64> {
        axis(0, text).expect("values").values.expect("a list")
    }

    #[test]
    fn ranges_end_at_their_ends_and_are_even_in_numbers_or_in_logarithms() {
        assert_eq!(values("1:2:5"), [1.0, 1.25, 1.5, 1.75, 2.0]);
        assert_eq!(values("1e3:1e6:4:log"), [1e3, 1e4, 1e5, 1e6]);
        assert_eq!(values(" 3, 1,2 "), [3.0, 1.0, 2.0]);
        assert_eq!(values("-7"), [-7.0]);
        for text in ["0.1:0.7:12", "0.3:7.7:100:log", "1e-300:1e300:7:log"] {
            let (values, own) = (values(text), axis(0, text).expect("a range"));
            assert_eq!((values[0], values[values.len() - 1]), own.range, "{text}");
            assert!(values.windows(2).all(|pair| pair[0] < pair[1]), "{text}");
        }
        assert!(axis(0, "1:2").is_ok_and(|own| own.values.is_none() && own.at(0.25) == 1.25));
    }
}
