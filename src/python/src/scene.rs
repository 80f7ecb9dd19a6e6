//! Scenes: from files, from texts, built in.

use crate::errors::{guarded, run_error, scene_error};
use crate::interrupt::Signals;
use crate::parts::own_parts;
use crate::run::{Run, RunOf};
use costate::history::Keep;
use costate::integrators::Mode;
use costate::optimize::{Fit, Fitted};
use costate::prelude::RunError;
use costate::scenes::{AnyScene, DifferentiatedModes, FileScene, PeriodicModes, Prepared, Settings, built_in};
use costate::sensitivity::Forward;
use pyo3::prelude::*;
use self_cell::self_cell;
use std::sync::Arc;

/// Where a scene comes from.
enum Source {
    File(Box<FileScene>),
    BuiltIn(&'static FileScene),
    /// One of the scenarios of another scene.
    Scenario(Arc<Source>, usize),
}

impl Source {
    fn scene(&self) -> &dyn AnyScene {
        match self {
            Source::File(own) => &**own,
            Source::BuiltIn(own) => *own,
            Source::Scenario(of, place) => of.scene().scenarios().swap_remove(*place).scene,
        }
    }
}

self_cell!(
    /// A scene at a design, ready to run, with what it is made of.
    pub struct PreparedScene {
        owner: Arc<Source>,
        #[covariant]
        dependent: Prepared,
    }
);

/// What a call says of how a scene is run, where the scene does not.
#[derive(Debug, Default, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    end: Option<f64>,
    steps: Option<usize>,
    method: Option<String>,
    keep_steps: bool,
    /// What is called with the time that is reached [s].
    progress: Option<Py<PyAny>>,
}

/// A scene: a mechanism as a function of its design variables.
#[pyclass(frozen, module = "costate._costate")]
pub struct Scene {
    source: Arc<Source>,
}

/// Name, initial value, bounds, unit.
type Variable = (String, f64, (f64, f64), String);

/// Frequency, growth, whirl; then d omega/dx, d growth/dx and how many modes have the value, if they are asked for and there.
type ModeNumbers = (f64, f64, Option<f64>, Option<(Vec<f64>, Vec<f64>, usize)>);

/// See [`Scene::fit`].
type FitNumbers = (Vec<f64>, Vec<Vec<f64>>, Vec<usize>, (f64, usize, bool), Vec<(String, Vec<f64>, Vec<f64>, Vec<f64>)>);

/// Modes of a scene at rest or in a steady turn, or about the motion of a period.
fn modes(
    prepared: &Prepared,
    count: usize,
    (is_damped, is_periodic): (bool, bool),
    gradients: bool,
) -> Result<Vec<ModeNumbers>, RunError> {
    let is_complex = is_damped || prepared.spin_rate().is_some();
    let found = if is_periodic {
        let PeriodicModes { q, modes, .. } = prepared.periodic_modes(count)?;
        DifferentiatedModes { q, modes, gradients: Vec::new(), proved: true }
    } else if gradients {
        prepared.modes_with_gradients(count, is_complex)?
    } else {
        prepared.modes_at_rest(count, is_complex)?
    };
    let mut derivatives = found.gradients.into_iter();
    let one = |mode: &Mode| {
        let gradient = derivatives.next().flatten().map(|own| (own.frequency, own.growth, own.equal));
        (mode.frequency, mode.growth, prepared.whirl(&found.q, mode), gradient)
    };
    Ok(found.modes.iter().map(one).collect())
}

impl Scene {
    fn of(source: Source) -> Self {
        Scene { source: Arc::new(source) }
    }

    /// Ready to run at a design, its own without one.
    fn prepared(&self, x: Option<Vec<f64>>, options: &Options) -> Result<PreparedScene, RunError> {
        PreparedScene::try_new(self.source.clone(), |source| {
            let scene = source.scene();
            let x = x.unwrap_or_else(|| scene.variables().iter().map(|variable| variable.initial).collect());
            let settings = options.apply(scene.settings());
            let mut prepared = Prepared::with(scene, &x, Prepared::method_of(&settings)?, settings)?;
            if !options.keep_steps {
                prepared.keep = Keep::Nothing;
            }
            Ok(prepared)
        })
    }

    /// What is asked of it where it is ready to run, without holding up other threads of Python.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        (x, options): (Option<Vec<f64>>, Options),
        ask: impl FnOnce(&Prepared) -> Result<T, RunError> + Send,
    ) -> PyResult<T> {
        let found = || self.prepared(x, &options).and_then(|prepared| ask(prepared.borrow_dependent()));
        py.detach(|| guarded(|| found().map_err(run_error)))
    }
}

impl Options {
    fn apply(&self, mut settings: Settings) -> Settings {
        settings.end = self.end.unwrap_or(settings.end);
        settings.steps = self.steps.unwrap_or(settings.steps);
        settings.method = self.method.clone().or(settings.method);
        settings
    }
}

fn entries_of(text: &str) -> PyResult<serde_json::Value> {
    serde_json::from_str(text).map_err(|why| scene_error(format!("entries: {why}")))
}

#[pymethods]
impl Scene {
    /// The text of a scene file, with a name for messages; files that it names lie beside a file of this name.
    #[staticmethod]
    fn parse(py: Python<'_>, file: &str, text: &str, parts: Vec<String>) -> PyResult<Self> {
        let parse = || {
            let own = FileScene::parse_with(file, text, &own_parts(&parts)?).map_err(scene_error)?;
            Ok(Scene::of(Source::File(Box::new(own))))
        };
        py.detach(|| guarded(parse))
    }

    /// The entries of a builder, in JSON as [`FileScene::of_entries`] takes them, with a name for messages.
    #[staticmethod]
    fn build(py: Python<'_>, file: &str, entries: &str, parts: Vec<String>) -> PyResult<Self> {
        let build = || {
            let entries = entries_of(entries)?;
            let own = FileScene::of_entries(file, &entries, &own_parts(&parts)?).map_err(scene_error)?;
            Ok(Scene::of(Source::File(Box::new(own))))
        };
        py.detach(|| guarded(build))
    }

    /// The text of a scene file with such entries.
    #[staticmethod]
    fn written(entries: &str) -> PyResult<String> {
        Ok(FileScene::text_of(&entries_of(entries)?))
    }

    /// A scene of the library by its name, if it has one of this name.
    #[staticmethod]
    fn built_in(name: &str) -> PyResult<Option<Self>> {
        if !built_in::names().any(|own| own == name) {
            return Ok(None);
        }
        built_in::named(name).map(|own| Some(Scene::of(Source::BuiltIn(own)))).map_err(scene_error)
    }

    /// Names of the scenes of the library.
    #[staticmethod]
    fn built_in_names() -> Vec<String> {
        built_in::names().map(String::from).collect()
    }

    fn name(&self) -> String {
        self.source.scene().name()
    }

    fn summary(&self) -> String {
        self.source.scene().summary()
    }

    fn variables(&self) -> Vec<Variable> {
        let variables = self.source.scene().variables();
        variables.into_iter().map(|own| (own.name, own.initial, (own.lower, own.upper), own.unit.to_string())).collect()
    }

    /// Duration \[s\] and steps.
    fn settings(&self) -> (f64, usize) {
        let settings = self.source.scene().settings();
        (settings.end, settings.steps)
    }

    /// Names of the functionals with the units of their values.
    fn functionals(&self, py: Python<'_>) -> PyResult<Vec<(String, String)>> {
        self.ask(py, (None, Options::default()), |prepared| {
            Ok(prepared.functionals().iter().map(|own| (own.name.clone(), own.value_unit())).collect())
        })
    }

    /// The circumstances in which it is run, by their names.
    fn scenarios(&self) -> Vec<(String, Scene)> {
        let names = self.source.scene().scenarios().into_iter().map(|own| own.name).enumerate();
        names.map(|(place, name)| (name, Scene::of(Source::Scenario(self.source.clone(), place)))).collect()
    }

    /// Modes about the equilibrium of a design, its own without one.
    fn modes(
        &self,
        py: Python<'_>,
        at: (Option<Vec<f64>>, Options),
        count: usize,
        about: (bool, bool),
        gradients: bool,
    ) -> PyResult<Vec<ModeNumbers>> {
        self.ask(py, at, |prepared| modes(prepared, count, about, gradients))
    }

    /// Complex amplitudes of the functionals where a variable varies harmonically, for each rate.
    fn response(
        &self,
        py: Python<'_>,
        at: (Option<Vec<f64>>, Options),
        by: String,
        rates: Vec<f64>,
    ) -> PyResult<Vec<Vec<[f64; 2]>>> {
        self.ask(py, at, |prepared| prepared.frequency_response(&by, &rates))
    }

    /// Fits it to its measurements from a design: the design, covariance and places of the variables that are estimated, sum, degrees of freedom, whether the
    /// sum is least, and computed values and residuals of each measurement; or what a signal raised.
    fn fit(&self, py: Python<'_>, x: Vec<f64>) -> PyResult<FitNumbers> {
        let fitted = || {
            let fit = Fit::of(self.source.scene()).map_err(run_error)?;
            let mut signals = Signals::new(None);
            let fitted = fit.run(&x, &mut signals);
            signals.caught.map_or(Ok(()), Err)?;
            let Fitted { design, confidence, sum, degrees, is_optimum, curves, .. } = fitted.map_err(run_error)?;
            let estimated = confidence.estimated.iter().map(|&place| fit.varying()[place]).collect();
            let curves = fit.problem.measurements.iter().zip(curves);
            let curves = curves.map(|(own, curve)| (own.name.clone(), own.times.clone(), curve.values, curve.residuals));
            Ok((design, confidence.covariance, estimated, (sum, degrees, is_optimum), curves.collect()))
        };
        py.detach(|| guarded(fitted))
    }

    /// Simulates it at a design, its own without one, and says what ended the run where that was a signal.
    fn run(&self, py: Python<'_>, x: Option<Vec<f64>>, options: Options) -> PyResult<(Run, Option<Py<PyAny>>)> {
        let simulate = || {
            let prepared = Arc::new(self.prepared(x, &options).map_err(run_error)?);
            let mut signals = Signals::new(options.progress);
            let forward = forward(prepared.borrow_dependent(), &mut signals).map_err(run_error)?;
            Ok((Run::of(RunOf::of(prepared, forward), signals.caught.is_some()), signals.caught))
        };
        let (run, caught) = py.detach(|| guarded(simulate))?;
        Ok((run, caught.map(|error| error.into_value(py).into_any())))
    }
}

/// As [`Analysis::forward`](costate::sensitivity::Analysis::forward), with the finished steps of a run that a signal
/// ended.
fn forward(prepared: &Prepared, signals: &mut Signals) -> Result<Forward, RunError> {
    let analysis = prepared.analysis();
    let (forward, stopped) = analysis.observed(&prepared.x, signals)?;
    match stopped {
        // a run that is short of its end has values of a part of it
        _ if signals.caught.is_some() => return Ok(forward),
        Some(error) => return Err(error),
        None => {}
    }
    analysis.check_values(&forward)?;
    Ok(forward)
}
