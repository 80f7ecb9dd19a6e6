//! Results of a run as numpy arrays.

use crate::doubts::doubts;
use crate::errors::{guarded, run_error};
use crate::scene::PreparedScene;
use costate::functionals::Sample;
use costate::prelude::RunError;
use costate::scenes;
use costate::sensitivity::{Forward, SwitchError};
use costate_cli::RunReport;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use self_cell::self_cell;
use std::sync::Arc;

type Simulated<'p> = scenes::Run<'p>;

type Array<'py> = Bound<'py, PyArray1<f64>>;

self_cell!(
    /// A run with the scene that was run.
    pub struct RunOf {
        owner: Arc<PreparedScene>,
        #[covariant]
        dependent: Simulated,
    }
);

impl RunOf {
    /// The run of a scene.
    pub fn of(prepared: Arc<PreparedScene>, forward: Forward) -> Self {
        RunOf::new(prepared, |prepared| Simulated { prepared: prepared.borrow_dependent(), forward })
    }
}

/// A simulated scene.
#[pyclass(frozen, module = "costate._costate")]
pub struct Run {
    own: RunOf,
    /// Whether a signal ended it.
    is_stopped: bool,
}

impl Run {
    /// Of a run with its scene, and whether a signal ended it.
    pub fn of(own: RunOf, is_stopped: bool) -> Self {
        Run { own, is_stopped }
    }

    /// Why it has no end.
    fn stopped(&self) -> Option<String> {
        let steps = self.run().forward.history.steps();
        self.is_stopped.then(|| format!("the run was stopped after step {steps}, before its end"))
    }

    fn run(&self) -> &Simulated<'_> {
        self.own.borrow_dependent()
    }

    /// Reads something of the steps without holding up other threads of Python.
    fn read<T: Send>(&self, py: Python<'_>, read: impl FnOnce(&Simulated) -> Result<T, RunError> + Send) -> PyResult<T> {
        py.detach(|| guarded(|| read(self.run()).map_err(run_error)))
    }

    /// Rows of derivatives of a run that has its end.
    fn derivatives<'py>(
        &self,
        py: Python<'py>,
        rows: impl FnOnce(&Simulated) -> Result<Vec<Vec<f64>>, RunError> + Send,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.read(py, |run| match self.stopped() {
            Some(why) => Err(RunError::Input(format!("{why}: it has no derivatives"))),
            None => rows(run),
        })?;
        matrix(py, &rows, self.run().prepared.x.len())
    }
}

/// Rows of numbers as an array, with so many columns where there are no rows.
fn matrix<'py>(py: Python<'py>, rows: &[impl AsRef<[f64]>], columns: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let columns = rows.first().map_or(columns, |row| row.as_ref().len());
    let numbers: Vec<f64> = rows.iter().flat_map(|row| row.as_ref().iter().copied()).collect();
    PyArray1::from_vec(py, numbers).reshape([rows.len(), columns])
}

#[pymethods]
impl Run {
    /// The design.
    fn design<'py>(&self, py: Python<'py>) -> Array<'py> {
        PyArray1::from_slice(py, &self.run().forward.x)
    }

    /// Values of the functionals.
    fn values<'py>(&self, py: Python<'py>) -> Array<'py> {
        PyArray1::from_slice(py, &self.run().forward.values)
    }

    /// Names of the functionals with the units of their values.
    fn functionals(&self) -> Vec<(String, String)> {
        self.run().prepared.functionals().iter().map(|own| (own.name.clone(), own.value_unit())).collect()
    }

    /// Names of the nodes.
    fn nodes(&self) -> Vec<String> {
        let nodes = self.run().prepared.model().nodes.iter();
        nodes.filter(|node| !node.fixed).map(|node| node.name.clone()).collect()
    }

    /// Names of joints and drivers.
    fn joints(&self) -> Vec<String> {
        self.run().prepared.model().constraints.iter().map(|own| own.name.clone()).collect()
    }

    /// A sentence for each reason to doubt the run or its gradients.
    fn doubts(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let stopped = self.stopped().map(|why| format!("{why}: values and histories are those of the finished steps"));
        self.read(py, |run| Ok(stopped.into_iter().chain(doubts(run.prepared, &run.forward)).collect()))
    }

    /// Names of events, stops and latches with the times \[s\] at which they happened.
    fn events(&self) -> Vec<(String, f64)> {
        let run = self.run();
        run.prepared.analysis().events(&run.forward).into_iter().map(|own| (own.name, own.t)).collect()
    }

    /// Steps taken, steps given up, systems solved, Newton iterations, factorizations.
    fn work<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let forward = &self.run().forward;
        let work = PyDict::new(py);
        work.set_item("steps", forward.history.steps())?;
        work.set_item("rejected", forward.rejected)?;
        work.set_item("systems", forward.counters.systems)?;
        work.set_item("newton_iterations", forward.counters.iterations)?;
        work.set_item("factorizations", forward.counters.factorizations)?;
        Ok(work)
    }

    /// The start and the ends of the steps \[s\].
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let times = self.read(py, |run| {
            let mut times = Vec::new();
            run.prepared.analysis().for_each_sample(&run.forward, |sample: &Sample<f64>| times.push(sample.t))?;
            Ok(times)
        })?;
        Ok(PyArray1::from_vec(py, times))
    }

    /// The interactive page of `costate run`, or of `costate gradient`, as HTML.
    fn report(&self, py: Python<'_>, with_gradient: bool) -> PyResult<String> {
        self.read(py, |run| {
            let warnings = doubts(run.prepared, &run.forward);
            RunReport { run, with_gradient, warnings, stopped: self.stopped() }.html()
        })
    }

    /// The motion of a node.
    fn node<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyDict>> {
        let own = self.read(py, |run| run.node(name))?;
        let history = PyDict::new(py);
        history.set_item("times", PyArray1::from_vec(py, own.times))?;
        history.set_item("coordinates", matrix(py, &own.coordinates, 0)?)?;
        history.set_item("rates", matrix(py, &own.rates, 0)?)?;
        for (key, rows) in [
            ("positions", &own.positions),
            ("velocities", &own.velocities),
            ("accelerations", &own.accelerations),
            ("angular_velocities", &own.angular_velocities),
        ] {
            history.set_item(key, matrix(py, rows, 3)?)?;
        }
        let count = own.axes.len();
        let axes: Vec<[f64; 3]> = own.axes.into_iter().flatten().collect();
        history.set_item("axes", matrix(py, &axes, 3)?.reshape([count, 3, 3])?)?;
        Ok(history)
    }

    /// What a joint or driver does to the last of its nodes that moves.
    fn joint<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyDict>> {
        let own = self.read(py, |run| run.joint(name))?;
        let history = PyDict::new(py);
        history.set_item("times", PyArray1::from_vec(py, own.times))?;
        history.set_item("forces", matrix(py, &own.forces, 3)?)?;
        history.set_item("moments", matrix(py, &own.moments, 3)?)?;
        history.set_item("multipliers", matrix(py, &own.multipliers, 0)?)?;
        Ok(history)
    }

    /// What a functional measures over time: times, values, unit.
    fn history<'py>(&self, py: Python<'py>, functional: &str) -> PyResult<(Array<'py>, Array<'py>, String)> {
        let own = self.read(py, |run| run.history(functional))?;
        Ok((PyArray1::from_vec(py, own.times), PyArray1::from_vec(py, own.values), own.unit.to_string()))
    }

    /// Derivatives of some functionals by all design variables, by the discrete adjoint, a row for each that is wanted.
    fn gradient<'py>(&self, py: Python<'py>, wanted: Vec<usize>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.derivatives(py, |Simulated { prepared, forward }| {
            let asked: Vec<bool> = (0..forward.values.len()).map(|k| wanted.contains(&k)).collect();
            let gradient = prepared.analysis().adjoint_of(&prepared.x, forward, &asked)?;
            let wrong = prepared.analysis().switch_errors(forward, &gradient)?;
            let is_wanted = |own: &&SwitchError| wanted.iter().any(|&k| prepared.functionals()[k].name == own.functional);
            if let Some(why) = wrong.iter().filter(is_wanted).find_map(SwitchError::refused) {
                return Err(RunError::Input(why));
            }
            Ok(wanted.iter().map(|&k| gradient.rows[k].clone()).collect())
        })
    }

    /// The same by complex-step runs of the whole simulation, for checks.
    fn complex_step<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.derivatives(py, |Simulated { prepared, forward }| {
            Ok(prepared.analysis().complex_step(&prepared.x, forward)?.rows)
        })
    }

    /// The same by tangent runs, eight variables at a time.
    fn tangent<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.derivatives(py, |Simulated { prepared, forward }| Ok(prepared.analysis().tangent(&prepared.x, forward)?.rows))
    }
}
