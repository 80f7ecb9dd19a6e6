//! What a run of a drawn scene says, and whether it is right: the program runs as a user runs it, and is held against references that share
//! neither method, steps nor derivatives with it.

// functionals are told by their numbers
#![allow(clippy::needless_range_loop)]
// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::drawing::{DRAWN, Design, Drawn, Jumps, Kind, VARIABLES, draw};
use crate::Lots;
use crate::program::{Ended, Place, words};
use costate::functionals::Sample;
use costate::integrators::StepError;
use costate::internals::{Measured, VectorsAvq};
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};
use costate::sensitivity::Forward;
use serde_json::Value;
use std::fs;
use std::time::Duration;

/// What became of a scene, with the kind or the reason.
pub enum Outcome {
    /// Values and gradient agree with the references.
    Right,
    /// They do not, and a warning says so.
    Told(String),
    /// No values or no gradient, with an error.
    Refused(String),
    /// The references are too far apart to tell.
    Unchecked(String),
    /// At a limit between two motions: other steps make other events, or quotients scatter.
    Sensitive(String),
    /// They do not agree, and nothing says so.
    Wrong(String),
    /// All agree, and the energy balance is said to be off.
    EnergyAlarm(String),
    /// All agree, and `--check` fails.
    CheckFails(String),
    /// A panic, a signal, silence, a hang.
    Broken(String),
}

/// Steps of a run have estimated errors; of what these may sum up to, on the way to the end, a result may be off by so many times as much.
const SAFETY: f64 = 10.0;
/// Shares of a functional's size by which values, and derivatives, may be off in any case: what nobody notices.
const SLIGHT: [f64; 2] = [1e-6, 1e-4];
/// By how much more than a step's share of the run values, and derivatives, are off that are right to first order of the step.
const FIRST_ORDER: [f64; 2] = [1.0, 2.0];
/// Share of a functional's size by which a derivative may differ from quotients of runs of the same steps, beside their noise.
const OF_QUOTIENTS: f64 = 1e-6;
/// Share of a size at which references that differ more tell nothing.
const ROUGH: f64 = 1e-2;
/// Share of the usual size of a quantity that counts as its size where it is smaller: a functional may be zero.
const USUAL: f64 = 0.1;
/// By how much more steps the references have.
const FINER: [usize; 2] = [8, 12];
/// The same of a motion with events at most, whose last step may be as short.
const MOST_FINER: f64 = 20.0;
/// Steps of their difference quotients, as relative changes of the variables: halved each time, for two extrapolations. What vibrates a hundred
/// times changes its phase by a tenth of a radian.
const QUOTIENTS: [f64; 3] = [2e-3, 1e-3, 5e-4];
/// Steps of quotients of runs with the same events: changes that are as slight as roundings let them be.
const WITH_EVENTS: [f64; 3] = [1e-4, 1e-5, 1e-6];
/// Time after which a run is told to stop, and gave no result; one that does not stop then hangs.
const LONGEST: Duration = Duration::from_secs(180);

/// What the program prints: values and derivatives along a direction.
struct Results {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// What is right.
struct Reference {
    right: Results,
    /// By how much it is uncertain itself: values, slopes.
    apart: [Vec<f64>; 2],
    /// Sizes of the functionals: what relative changes of all variables change counts as much as the value.
    sizes: Vec<f64>,
    /// Largest kinetic energy and how much the potential one changes \[J\].
    moved: f64,
}

/// How a motion with an estimate of its steps' errors ended: for the limit beyond which they are called coarse.
#[derive(Clone)]
pub struct Deviation {
    /// Largest estimated error of a step, as a share.
    pub estimate: f64,
    /// Largest share of its size by which a value is off that no warning names.
    pub off: f64,
    /// Of which functional that is, and its value and the right one.
    pub of: String,
}

/// What became of a scene.
pub struct Judged {
    pub outcome: Outcome,
    /// By how much it is off.
    pub deviation: Option<Deviation>,
    /// At how many instants something happened in it, of a run that got to its end.
    pub happened: Option<usize>,
}

impl From<Outcome> for Judged {
    fn from(outcome: Outcome) -> Self {
        Judged { outcome, deviation: None, happened: None }
    }
}

/// A drawn scene of a seed.
pub struct Case {
    pub seed: u64,
    pub kind: Kind,
}

impl Case {
    pub fn drawn(&self) -> Drawn {
        draw(self.seed, self.kind, &DRAWN, Jumps::Found)
    }

    /// The direction along which derivatives are compared.
    fn direction(&self) -> Design {
        let mut lots = Lots::new(self.seed, 8);
        std::array::from_fn(|_| lots.number(0.3, 1.0) * lots.pick(&[-1.0, 1.0]))
    }

    /// Runs the program on the scene, and tells what became of it.
    ///
    /// # Errors
    /// What keeps the program from being run at all.
    pub fn outcome(&self, place: &Place) -> Result<Judged, String> {
        place.clear()?;
        let drawn = self.drawn();
        fs::write(place.path("scene.toml"), &drawn.text).map_err(|error| error.to_string())?;
        let line = "gradient scene.toml --check --json --no-report --out out";
        let ended = place.run(&words(line), None, LONGEST)?;
        if ended.is_wrong() {
            return Ok(Outcome::Broken(ended.err).into());
        }
        if ended.told {
            return Ok(Outcome::Refused(format!("no result within {} s", LONGEST.as_secs())).into());
        }
        let said = ended.out.lines().last().and_then(|line| serde_json::from_str::<Value>(line).ok());
        let error = ended.err.lines().rfind(|line| line.starts_with("error: ")).unwrap_or_default().to_string();
        let Some((said, results)) = said.and_then(|said| Some((results(&said, self)?, said))).map(|(r, s)| (s, r)) else {
            return Ok(Outcome::Refused(error).into());
        };
        Ok(match self.kind {
            Kind::Vibration => self.judge_modes(place, &results)?.into(),
            _ => self.judge(&drawn, &said, &results, &ended, &error),
        })
    }

    /// A prepared scene with another method and other steps.
    fn finer<T>(
        &self,
        (x, jumps): (&Design, Jumps),
        (method, level): (&str, ConstraintLevel),
        steps: usize,
        take: impl Fn(&Prepared) -> Result<T, RunError>,
    ) -> Result<T, String> {
        let scene = FileScene::parse("reference", &draw(self.seed, self.kind, x, jumps).text)?;
        let is_static = self.kind == Kind::Equilibrium;
        let table = table_by_name(if is_static { "static" } else { method }).ok_or("a method that is listed")?;
        let settings = Settings { steps, control: None, ..AnyScene::settings(&scene).without_method() };
        let prepared = Prepared::with(&scene, x, Method::new(table, level), settings).map_err(|error| error.to_string())?;
        take(&prepared).map_err(|error| error.to_string())
    }

    /// Values of runs whose jumps are given.
    fn values(&self, x: &Design, method: &str, steps: usize) -> Result<Vec<f64>, String> {
        let method = (method, ConstraintLevel::Acceleration);
        self.finer((x, Jumps::Given), method, steps, |prepared| prepared.analysis().values(&prepared.x))
    }

    fn reference(&self, drawn: &Drawn, units: &[String]) -> Result<Reference, String> {
        let [fine, other] = FINER.map(|finer| finer * drawn.steps);
        let (values, others) = (self.values(&DRAWN, "esdirk5", fine)?, self.values(&DRAWN, "sdirk4", other)?);
        // a time that is given at its place does not move with the design
        let found = (&DRAWN, Jumps::Found);
        let (rows, moved) = self.finer(found, ("esdirk5", ConstraintLevel::Acceleration), fine, |prepared| {
            let (analysis, x) = (prepared.analysis(), &prepared.x);
            let forward = analysis.forward(x)?;
            let rows = analysis.adjoint(x, &forward).map_or_else(|_| vec![vec![]; forward.values.len()], |own| own.rows);
            Ok((rows, energy_moved(prepared, &forward)?))
        })?;
        let direction = self.direction();
        let at = |step: f64| -> Design { std::array::from_fn(|i| DRAWN[i] + step * direction[i]) };
        let mut quotients = Vec::new();
        for step in QUOTIENTS {
            let (above, below) = (self.values(&at(step), "esdirk5", fine)?, self.values(&at(-step), "esdirk5", fine)?);
            quotients
                .push(above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * step)).collect::<Vec<_>>());
        }
        let extrapolated = |k: usize, i: usize| (4.0 * quotients[i + 1][k] - quotients[i][k]) / 3.0;
        let all = 0..values.len();
        let slopes = all.clone().map(|k| extrapolated(k, 1)).collect();
        let apart = [
            values.iter().zip(&others).map(|(own, other)| (own - other).abs()).collect(),
            all.clone().map(|k| (extrapolated(k, 1) - extrapolated(k, 0)).abs()).collect(),
        ];
        let sizes = all.map(|k| size_of(values[k], &rows[k], drawn.units.size(&units[k]))).collect();
        Ok(Reference { right: Results { values, slopes }, apart, sizes, moved })
    }

    /// Where things happen: values of a run by another method with other steps, and how far one of the same method with finer ones is away;
    /// derivatives by quotients of runs with the same events. And at how many instants something happened.
    fn reference_with_events(&self, drawn: &Drawn, units: &[String]) -> Result<(Result<Reference, Outcome>, usize), String> {
        let scene = FileScene::parse("scene", &drawn.text)?;
        let own = Prepared::new(&scene).map_err(|error| error.to_string())?;
        let (analysis, x) = (own.analysis(), &own.x);
        let forward = analysis.forward(x).map_err(|error| error.to_string())?;
        let happened = |prepared: &Prepared, forward: &Forward| {
            let names = prepared.analysis().events(forward).into_iter().map(|event| event.name);
            (names.collect::<Vec<_>>(), forward.grid.events.len())
        };
        let (names, instants) = happened(&own, &forward);
        let finer = |method: &str, finer: usize| -> Result<_, RunError> {
            let mut settings = AnyScene::settings(&scene);
            if method != own.method.table.name {
                settings.level = ConstraintLevel::Acceleration;
            }
            settings.method = Some(method.into());
            settings.steps *= finer;
            let tolerance = drawn.tolerance.map(|own| own / (finer as f64).powi(drawn.order as i32 + 1));
            settings.control = tolerance.map(StepControl::new);
            let prepared = Prepared::with(&scene, x, Prepared::method_of(&settings)?, settings)?;
            let forward = prepared.analysis().forward(x)?;
            let happened = happened(&prepared, &forward);
            Ok((forward.values, happened))
        };
        let judge = || -> Result<_, Outcome> {
            let unchecked = |error: RunError| Outcome::Unchecked(format!("no reference: {error}"));
            let method = &own.method.table.name;
            // an event may end the run just behind where steps begin anew: its last step has to be divided, too
            let sizes = || forward.grid.times.windows(2).map(|ends| ends[1] - ends[0]);
            let longest = sizes().fold(0.0, f64::max) / sizes().next_back().unwrap_or(1.0);
            let by = (2.0 * longest).ceil().min(MOST_FINER) as usize;
            let [course, other] = [(&**method, by), ("esdirk5", 3)].map(|(method, by)| finer(method, by));
            let (course, other) = (course.map_err(unchecked)?, other.map_err(unchecked)?);
            for (of, (_, (of_names, of_instants))) in [("finer", &course), ("other", &other)] {
                if (of_names, of_instants) != (&names, &instants) {
                    return Err(Outcome::Sensitive(format!(
                        "with {of} steps {of_instants} instants at which something happens, not {instants}"
                    )));
                }
            }
            let beside = |error: RunError| Outcome::Sensitive(format!("beside the design: {error}"));
            let (on_steps, direction) = (analysis.on_steps_of(&forward), self.direction());
            let noise = on_steps.noise(x, &direction).map_err(beside)?;
            let quotients = WITH_EVENTS.map(|step| on_steps.central_difference(x, &direction, step));
            let quotients = quotients.into_iter().collect::<Result<Vec<_>, _>>().map_err(beside)?;
            let rows = analysis.adjoint(x, &forward).map_err(unchecked)?.rows;
            let moved = energy_moved(&own, &forward).map_err(unchecked)?;
            let all = 0..forward.values.len();
            // of two neighbours that are least apart the shorter one, if the shortest does not say otherwise: what vibrates fast makes long ones agree
            let best = all.clone().map(|k| {
                let noise = |i: usize| noise[k] / WITH_EVENTS[i];
                let away = |i: usize, j: usize| (quotients[i][k] - quotients[j][k]).abs();
                let apart = |i: usize| away(i, i + 1) + noise(i + 1);
                let is_chance = away(1, 2) > SAFETY * (apart(0) + noise(2));
                let i = if apart(0) < apart(1) && !is_chance { 0 } else { 1 };
                (quotients[i + 1][k], apart(i))
            });
            let (slopes, scatter) = best.unzip();
            let away = all.clone().map(|k| (forward.values[k] - course.0[k]).abs()).collect();
            let sizes = all.map(|k| size_of(forward.values[k], &rows[k], drawn.units.size(&units[k]))).collect();
            Ok(Reference { right: Results { values: other.0, slopes }, apart: [away, scatter], sizes, moved })
        };
        Ok((judge(), instants))
    }

    fn judge(&self, drawn: &Drawn, said: &Value, own: &Results, ended: &Ended, error: &str) -> Judged {
        let has_events = self.kind.has_events();
        let warnings: Vec<&str> = ended.err.lines().filter_map(|line| line.strip_prefix("warning: ")).collect();
        let texts = |key: &str| -> Vec<String> {
            let all = said["functionals"].as_array().into_iter().flatten();
            all.map(|own| own[key].as_str().unwrap_or_default().to_string()).collect()
        };
        let (names, units) = (texts("name"), texts("unit"));
        let reference = match has_events {
            true => self.reference_with_events(drawn, &units).map(|(own, count)| (own, Some(count))),
            false => self.reference(drawn, &units).map(|own| (Ok(own), None)),
        };
        let (reference, happened) = match reference {
            Ok((Ok(own), happened)) => (own, happened),
            Ok((Err(outcome), happened)) => return Judged { happened, ..outcome.into() },
            Err(why) => return Outcome::Unchecked(format!("no reference: {why}")).into(),
        };
        let Reference { right, apart, sizes, moved } = reference;
        // what the run says of itself
        let steps = said["steps"].as_f64().unwrap_or(1.0);
        let own_estimate = drawn.tolerance.or(said["largest_step_error"]["share"].as_f64()).unwrap_or(0.0);
        // where things happen finer steps tell how far off it is
        let estimate = if has_events { 0.0 } else { own_estimate };
        let (slight, rough_share) =
            if has_events { ([SLIGHT[0], OF_QUOTIENTS], [ROUGH, SLIGHT[1]]) } else { (SLIGHT, [ROUGH; 2]) };
        // an error of C h^p changes by p of it where a variable stretches the time that each step takes, and C by as much as the value
        let by_design = [1.0, 1.0 + drawn.order as f64];
        let (mut wrong, mut rough) = (Vec::new(), Vec::new());
        for (k, name) in names.iter().enumerate() {
            let off = [(own.values[k] - right.values[k]).abs(), (own.slopes[k] - right.slopes[k]).abs()];
            for (what, i) in [("value", 0), ("derivative", 1)] {
                let allowed = slight[i].max(SAFETY * steps * estimate * by_design[i]) * sizes[k] + SAFETY * apart[i][k];
                if !(off[i] <= allowed) {
                    let (own, right) = [(own.values[k], right.values[k]), (own.slopes[k], right.slopes[k])][i];
                    let (off, allowed) = (off[i] / sizes[k], allowed / sizes[k]);
                    wrong.push((
                        format!("{what} of \"{name}\" {own:e} for {right:e}: {off:.1e} of its size off, {allowed:.1e} said"),
                        off / FIRST_ORDER[i],
                    ));
                } else if apart[i][k] > rough_share[i] * sizes[k] {
                    rough.push(format!(
                        "{what} of \"{name}\": references are {:.1e} of its size apart",
                        apart[i][k] / sizes[k]
                    ));
                }
            }
        }
        if wrong.is_empty()
            && !has_events
            && let Err(why) = self.same_steps(own, &sizes)
        {
            wrong.push((why, f64::INFINITY));
        }
        // right to first order of the step
        let is_rough = |warning: &&str| warning.contains("has a kink") || warning.contains("take a method whose");
        let others = warnings.iter().filter(|warning| !is_rough(warning)).count();
        let covered = match (others, warnings.len()) {
            (1.., _) => f64::INFINITY,
            (0, 1..) => SAFETY / steps,
            _ => 0.0,
        };
        let off = |k: usize| (own.values[k] - right.values[k]).abs() / sizes[k];
        // what a warning names is told, whatever the steps are
        let is_named = |k: &usize| warnings.iter().any(|warning| warning.contains(&format!("\"{}\"", names[*k])));
        let worst = (0..sizes.len()).filter(|k| !is_named(k)).max_by(|&i, &j| off(i).total_cmp(&off(j)));
        let deviation = said["largest_step_error"]["share"].as_f64().zip(worst).map(|(estimate, k)| {
            let of = format!(
                "\"{}\" {:e} for {:e}, references {:.1e} of its size apart",
                names[k],
                own.values[k],
                right.values[k],
                apart[0][k] / sizes[k]
            );
            Deviation { estimate, off: off(k), of }
        });
        let worst = wrong.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let alarm =
            warnings.iter().find(|warning| warning.contains("J apart") || warning.contains("the energy of this scene"));
        let left = said["energy_balance_J"]["left"].as_f64().unwrap_or(f64::INFINITY);
        let outcome = match (worst, alarm) {
            (Some((why, off)), _) if *off > covered => Outcome::Wrong(why.clone()),
            (Some(_), _) => Outcome::Told(warnings.join(" | ")),
            (None, Some(alarm)) if left.abs() <= StepError::COARSE * moved => Outcome::EnergyAlarm(alarm.to_string()),
            _ if error.contains("differs from") => Outcome::CheckFails(error.into()),
            _ if !rough.is_empty() && has_events => Outcome::Sensitive(rough.swap_remove(0)),
            _ if !rough.is_empty() => Outcome::Unchecked(rough.swap_remove(0)),
            _ => Outcome::Right,
        };
        Judged { outcome, deviation, happened }
    }

    /// The gradient against quotients of runs of the same steps, each built and solved by itself.
    fn same_steps(&self, own: &Results, sizes: &[f64]) -> Result<(), String> {
        let scene = FileScene::parse("scene", &self.drawn().text)?;
        let quotients = || -> Result<_, RunError> {
            let prepared = Prepared::new(&scene)?;
            let forward = prepared.analysis().forward(&prepared.x)?;
            prepared.analysis().on_steps_of(&forward).quotients(&prepared.x, &self.direction())
        };
        // designs beside may not be simulated
        let Ok(quotients) = quotients() else { return Ok(()) };
        for (k, (quotient, size)) in quotients.iter().zip(sizes).enumerate().filter(|(_, (own, _))| own.is_smooth) {
            let off = (own.slopes[k] - quotient.value).abs();
            if !(off <= SAFETY * quotient.floor + OF_QUOTIENTS * size) {
                return Err(format!(
                    "derivative {} of functional {k}, by runs of the same steps {}",
                    own.slopes[k], quotient.value
                ));
            }
        }
        Ok(())
    }

    /// Derivatives of modes against quotients of their values, each found by a run of the program.
    fn judge_modes(&self, place: &Place, own: &Results) -> Result<Outcome, String> {
        let direction = self.direction();
        let mut quotients: Vec<Vec<f64>> = Vec::new();
        for step in QUOTIENTS {
            let mut ends = Vec::new();
            for sign in [1.0, -1.0] {
                let set =
                    VARIABLES.iter().zip(direction).map(|(name, d)| format!("--set {name}={:?}", 1.0 + sign * step * d));
                let line = format!("run scene.toml --json --no-report --out out {}", set.collect::<Vec<_>>().join(" "));
                let ended = place.run(&words(&line), None, LONGEST)?;
                let said = ended.out.lines().last().and_then(|line| serde_json::from_str::<Value>(line).ok());
                let Some(said) = said.filter(|_| ended.code == Some(0)) else { return Ok(Outcome::Unchecked(ended.err)) };
                ends.push(list_of(&said["modes"], |own| own["value"].as_f64()).unwrap_or_default());
            }
            quotients.push(ends[0].iter().zip(&ends[1]).map(|(above, below)| (above - below) / (2.0 * step)).collect());
        }
        for k in 0..own.values.len() {
            let extrapolated = [0, 1].map(|i| (4.0 * quotients[i + 1][k] - quotients[i][k]) / 3.0);
            let (off, apart) = ((own.slopes[k] - extrapolated[1]).abs(), (extrapolated[1] - extrapolated[0]).abs());
            // frequencies of one scene are of one size
            let size = own.values.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
            if !(off <= SLIGHT[1] * size + SAFETY * apart) {
                return Ok(Outcome::Wrong(format!(
                    "derivative of mode value {k}: {} for {}",
                    own.slopes[k], extrapolated[1]
                )));
            }
            if apart > ROUGH * size {
                return Ok(Outcome::Unchecked(format!("quotients of mode value {k} are {:.1e} apart", apart / size)));
            }
        }
        Ok(Outcome::Right)
    }
}

/// The size of a functional, by its derivatives and what is usual in its unit.
fn size_of(value: f64, row: &[f64], usual: f64) -> f64 {
    value.abs() + row.iter().map(|own| own.abs()).sum::<f64>() + USUAL * usual
}

/// Largest kinetic energy of a run, and how much the potential one changes \[J\].
fn energy_moved(prepared: &Prepared, forward: &Forward) -> Result<f64, RunError> {
    let (energy, mut kinetic, mut least, mut most) = (Measured::energy(), 0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
    prepared.analysis().for_each_sample(forward, |sample| {
        let of = |v: Vec<f64>| {
            let at = VectorsAvq { a: Vec::new(), v, q: sample.at.q.clone() };
            energy.value(prepared.model(), &Sample { t: sample.t, at, ..Sample::empty() }, &forward.numbers.p)
        };
        let potential = of(vec![0.0; sample.at.v.len()]);
        (least, most) = (least.min(potential), most.max(potential));
        kinetic = kinetic.max(of(sample.at.v.clone()) - potential);
    })?;
    Ok(kinetic + most - least)
}

fn list_of<T>(list: &Value, take: impl Fn(&Value) -> Option<T>) -> Option<Vec<T>> {
    list.as_array()?.iter().map(take).collect()
}

/// Values and derivatives along the direction that a run prints: of functionals, or of modes.
fn results(said: &Value, case: &Case) -> Option<Results> {
    let list = &said[if case.kind == Kind::Vibration { "modes" } else { "functionals" }];
    let direction = case.direction();
    let slope = |own: &Value| -> Option<f64> {
        let terms = VARIABLES.iter().zip(direction).map(|(name, d)| Some(own["gradient"][name].as_f64()? * d));
        terms.sum()
    };
    Some(Results { values: list_of(list, |own| own["value"].as_f64())?, slopes: list_of(list, slope)? })
}
