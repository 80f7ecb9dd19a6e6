use super::builder::MechanismBuilder;
use super::scene::{AnyScene, Settings};
use super::unknown;
use crate::assembly::{Attached, Model, VectorsAvq};
use crate::design::{Beside, DesignMap, DesignVariable, ModelNumbers, NumberList, check_design, repeated, shortest};
use crate::elements::ConstraintPhysics;
use crate::functionals::{Functional, Sample, multipliers_without_forces};
use crate::history::Keep;
use crate::integrators::{
    ConstraintLevel, DEFAULT_TABLE, InitialState, Method, Problem, RunError, StartPlan, StepControl, TimeGrid,
    table_by_name, table_named, table_names,
};
use crate::linalg::{Factorization, SolverPlan};
use crate::program::Recorded;
use crate::scalar::Scalar;
use crate::sensitivity::{Analysis, Breakpoints, largest_difference};
use std::ops::Range;

/// A scene at one design, ready to run: built, checked, with its steps laid out.
pub struct Prepared<'s> {
    /// The scene.
    pub scene: &'s dyn AnyScene,
    /// Design variables.
    pub variables: Vec<DesignVariable>,
    /// The design.
    pub x: Vec<f64>,
    /// The mechanism in real numbers.
    pub mechanism: MechanismBuilder<f64>,
    /// How it is integrated.
    pub method: Method,
    /// Its steps; with a control the stretches between breakpoints.
    pub grid: TimeGrid,
    /// How steps are chosen.
    pub control: Option<StepControl>,
    /// Halve steps that Newton's method cannot make.
    pub divide: bool,
    /// Decisions about the start.
    pub plan: StartPlan,
    /// How runs keep their steps for gradients: in memory unless it is changed.
    pub keep: Keep,
}

/// How many times the effect of a rounding of the variables two derivatives may be apart.
pub const SCATTER: f64 = 4.0;
/// Largest relative difference between gradients and difference quotients of runs that passes. Where roundings change complex steps by more, these
/// show nothing that quotients do not.
pub const OF_QUOTIENTS: f64 = 1e-6;

/// A run beside a design.
#[doc(hidden)]
pub struct Nearby {
    /// Values of the functionals.
    pub values: Vec<f64>,
    /// Their complex-step gradients.
    pub rows: Vec<Vec<f64>>,
}

impl<'s> Prepared<'s> {
    /// The default method: ESDIRK of order 4 at acceleration level.
    ///
    /// # Panics
    /// Not: the default table is on the list.
    pub fn default_method() -> Method {
        let table = table_by_name(DEFAULT_TABLE).expect("the default table is listed");
        Method::new(table, ConstraintLevel::default())
    }

    /// The method that settings ask for: their own table, or the default one, with their level, rule and solver.
    ///
    /// # Errors
    /// [`RunError::Input`] for a name that is not listed.
    pub fn method_of(settings: &Settings) -> Result<Method, RunError> {
        let name = settings.method.as_deref().unwrap_or(DEFAULT_TABLE);
        let table = table_named(name).map_err(RunError::Input)?;
        let table = table.ok_or_else(|| RunError::Input(unknown("method", name, &table_names())))?;
        let mut method = Method::new(table, settings.level);
        (method.tolerance, method.backend, method.locates) = (settings.newton, settings.solver, settings.locate);
        Ok(method)
    }

    /// Builds a scene at its initial design, with its own settings and their method.
    ///
    /// # Errors
    /// See [`Prepared::with`].
    pub fn new(scene: &'s dyn AnyScene) -> Result<Self, RunError> {
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let settings = scene.settings();
        Self::with(scene, &x, Self::method_of(&settings)?, settings)
    }

    /// Builds a scene at a design. The method is the given one: settings that name another are refused, see
    /// [`Settings::without_method`].
    ///
    /// # Errors
    /// A design out of bounds, a mistake of the scene, or a start that cannot be simulated, with names and numbers.
    pub fn with(scene: &'s dyn AnyScene, x: &[f64], method: Method, settings: Settings) -> Result<Self, RunError> {
        let variables = scene.variables();
        if let Some(name) = repeated(variables.iter().map(|variable| &*variable.name)) {
            return Err(RunError::Input(format!("two design variables are named \"{name}\"")));
        }
        check_design(&variables, x).map_err(RunError::Input)?;
        if let Some(own) = settings.method.as_deref().filter(|own| *own != method.table.name) {
            return Err(RunError::Input(format!(
                "the settings name the method \"{own}\", but \"{}\" is given: take Prepared::method_of(&settings), or settings \
                 without_method()",
                method.table.name
            )));
        }
        let mechanism = scene.build_real(x).map_err(RunError::Input)?.for_table(&method.table);
        let Settings { end, steps, control, divide, mut policy, .. } = settings;
        // load steps lead to equilibria themselves
        policy.from_equilibrium &= !method.table.is_static();
        if let Some(control) = &control {
            control.check(&method.table)?;
        }
        let steps = if control.is_some() { 1 } else { steps };
        let breakpoints = mechanism.all_breakpoints(end).map_err(RunError::Input)?;
        if let Some(own) = breakpoints.all().iter().find(|own| own.is_constraint && own.kind.is_some() && own.at.t > 0.0) {
            let (name, t) = (&own.part, shortest(own.at.t));
            return Err(RunError::Input(format!(
                "the motion that \"{name}\" prescribes or its rate would jump at t = {t} s; give it a smooth ramp or a table"
            )));
        }
        let grid = TimeGrid::uniform(end, steps, &breakpoints.times()).map_err(RunError::Input)?;
        let (x, plan, keep) = (x.to_vec(), StartPlan::default(), Keep::default());
        let mut prepared = Prepared { scene, variables, x, mechanism, method, grid, control, divide, plan, keep };
        prepared.plan = StartPlan::prepare(&prepared.problem(), &prepared.method.table, policy)?;
        match prepared.functionals().iter().find_map(|functional| functional.refused(prepared.model())) {
            Some(why) => Err(RunError::Input(why)),
            None => Ok(prepared),
        }
    }

    /// Takes the steps that were laid for another design of the scene, so that the number of those between two breakpoints does not change from
    /// design to design, and values with it.
    #[doc(hidden)]
    pub fn keep_steps_of(&mut self, other: &TimeGrid) {
        if self.grid.is_of_same_run(other) {
            self.grid = other.clone();
        }
    }

    /// The topology.
    pub fn model(&self) -> &Model {
        &self.mechanism.model
    }

    /// The functionals.
    pub fn functionals(&self) -> &[Functional] {
        &self.mechanism.functionals
    }

    /// The problem in real numbers.
    pub fn problem(&self) -> Problem<'_, f64> {
        let ModelNumbers { p, q, v } = self.mechanism.numbers.clone();
        Problem { model: &self.mechanism.model, p, start: InitialState { q, v } }
    }

    /// Constraint equations that are left out as redundant at the start.
    #[doc(hidden)]
    pub fn redundant(&self) -> Vec<usize> {
        self.plan.dropped.iter().copied().filter(|row| !self.model().comes_and_goes(*row)).collect()
    }

    /// Names of the joints, and of the functionals, whose reactions the model does not determine at its start: where redundant equations are
    /// left out, many reactions have the same forces, and those of least norm are given.
    pub fn undetermined(&self) -> [Vec<&str>; 2] {
        let (model, Problem { p, start, .. }) = (self.model(), self.problem());
        let dropped = self.redundant();
        if dropped.is_empty() {
            return [Vec::new(), Vec::new()];
        }
        let added = multipliers_without_forces(model, &dropped, &p, &start.q, 0.0);
        let of_joint =
            |joint: &&Attached<ConstraintPhysics>| added[joint.equations.clone()].iter().any(|&added| added != 0.0);
        let at = VectorsAvq { a: vec![0.0; model.dofs], v: start.v, q: start.q };
        let sample = Sample { at, mu: vec![0.0; model.equations], ..Sample::empty() };
        let of_functional = |own: &&Functional| own.changes_with(model, &sample, &p, &added);
        let joints = model.constraints.iter().filter(of_joint).map(|joint| &*joint.name).collect();
        [joints, self.functionals().iter().filter(of_functional).map(|own| &*own.name).collect()]
    }

    /// The solver of the linear systems of stages, and what it takes.
    ///
    /// # Errors
    /// [`RunError::Stopped`] if no numbers could make the equations regular.
    pub fn linear_solver(&self) -> Result<SolverPlan, RunError> {
        let system = self.method.system(self.model(), &self.plan.dropped);
        let factorization = Factorization::new(&system.pattern, self.method.backend);
        factorization.map(|factorization| factorization.plan()).map_err(|singular| RunError::of_pattern("start", singular))
    }

    /// Values and complex-step gradients at designs next to this one, variables a rounding of their size up or down in four patterns: how far
    /// these are apart is what no check of a derivative can see. Stiff members make it large, as a rounding of their length is a force.
    ///
    /// # Errors
    /// Those of the runs.
    #[doc(hidden)]
    pub fn complex_steps_nearby(&self) -> Result<[Nearby; 4], RunError> {
        let at = |is_up: fn(usize) -> bool| -> Result<Nearby, RunError> {
            let next = |i: usize, x: f64, size: f64| match x {
                0.0 if is_up(i) => f64::EPSILON * size,
                0.0 => -f64::EPSILON * size,
                _ if is_up(i) => x.next_up(),
                _ => x.next_down(),
            };
            let moved = |(i, (variable, &x)): (usize, (&DesignVariable, &f64))| {
                let next = next(i, x, variable.size(x));
                if next >= variable.lower && next <= variable.upper { next } else { x }
            };
            let x: Vec<f64> = self.variables.iter().zip(&self.x).enumerate().map(moved).collect();
            let analysis = self.analysis();
            let forward = analysis.forward(&x)?;
            let rows = analysis.complex_step(&x, &forward)?.rows;
            Ok(Nearby { values: forward.values, rows })
        };
        Ok([at(|_| true)?, at(|_| false)?, at(|i| i % 2 == 0)?, at(|i| i % 2 == 1)?])
    }

    /// By how much the gradients of the functionals may differ from complex steps: by `least`, or by four times what a rounding of the
    /// variables does to these ([`largest_difference`] of designs next to this one).
    ///
    /// # Errors
    /// Those of the runs; a rounding that does so much that agreement would show nothing.
    pub fn gradient_limits(&self, least: f64) -> Result<Vec<f64>, RunError> {
        let nearby = self.complex_steps_nearby()?;
        let limit = |k: usize| {
            let rows = nearby.each_ref().map(|run| &run.rows[k]);
            let pairs = rows.iter().flat_map(|one| rows.iter().map(move |other| (one, other)));
            let apart = SCATTER * pairs.fold(0.0, |most: f64, (one, other)| most.max(largest_difference(one, other)));
            if apart > OF_QUOTIENTS {
                let name = &self.functionals()[k].name;
                return Err(RunError::Input(format!(
                    "a rounding of the variables changes the complex-step derivatives of \"{name}\" by {:.1e} of them: agreement shows nothing",
                    apart / SCATTER
                )));
            }
            Ok(least.max(apart))
        };
        (0..self.functionals().len()).map(limit).collect()
    }

    /// The scene's dependence on its design.
    pub fn analysis(&self) -> Analysis<'_> {
        Analysis {
            model: &self.mechanism.model,
            map: self,
            functionals: &self.mechanism.functionals,
            method: &self.method,
            grid: &self.grid,
            control: self.control,
            divide: self.divide,
            plan: &self.plan,
            keep: &self.keep,
        }
    }

    /// The numbers of a mechanism that was built for a design `x`, if it is this one with other numbers.
    fn same_laws<S: Scalar>(
        &self,
        x: &[f64],
        built: Result<MechanismBuilder<S>, String>,
    ) -> Result<ModelNumbers<S>, String> {
        let built = built?.for_table(&self.method.table);
        // at its own design a scene has the options that it has
        let is_own = x.iter().map(|x| x.to_bits()).eq(self.x.iter().map(|x| x.to_bits()));
        let (ours, theirs) = (self.model(), &built.model);
        let difference = match is_own {
            true => ours.topology().difference(&theirs.topology(), ours),
            false => self.changed_law(&built),
        };
        difference.map_or(Ok(built.numbers), |what| Err(self.depends_on_design(&what)))
    }

    fn depends_on_design(&self, what: &str) -> String {
        format!(
            "scene \"{}\": its topology changes with the design, or its options do: {what}; only numbers may depend on design \
             variables",
            self.scene.name()
        )
    }

    /// What this mechanism and another one do not have in common, beside numbers.
    fn changed_law<S: Scalar>(&self, other: &MechanismBuilder<S>) -> Option<String> {
        let (ours, theirs) = (self.model(), &other.model);
        let of_functionals = || {
            let laws = |functionals: &[Functional], model: &Model| -> Vec<_> {
                functionals.iter().map(|own| (own.name.clone(), own.law(model))).collect()
            };
            // a caller may have chosen some of the functionals
            let others = laws(&other.functionals, theirs);
            let changed = laws(self.functionals(), ours).into_iter().find(|own| !others.contains(own));
            changed.map(|(name, _)| format!("functional \"{name}\""))
        };
        ours.structural_signature().difference(&theirs.structural_signature(), ours).or_else(of_functionals)
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// Times of a run from 0 to `end` at which formulas jump or bend whatever the motion is, such as those of loads, drivers and states:
    /// steps end there.
    ///
    /// # Errors
    /// A part with more than a million of them.
    pub fn breakpoints(&self, end: f64) -> Result<Vec<f64>, String> {
        Ok(self.all_breakpoints(end)?.times())
    }

    fn all_breakpoints(&self, end: f64) -> Result<Breakpoints, String> {
        let values = |numbers: &[S]| numbers.iter().map(|number| number.value()).collect();
        let ModelNumbers { p, q, v } = &self.numbers;
        let numbers = ModelNumbers { p: values(p), q: values(q), v: values(v) };
        Breakpoints::of(&self.model, &self.functionals, &numbers, end)
    }
}

impl DesignMap for Prepared<'_> {
    fn real(&self, x: &[f64]) -> Result<ModelNumbers<f64>, String> {
        check_design(&self.variables, x)?;
        self.same_laws(x, self.scene.build_real(x))
    }
    fn beside(&self, x: &[f64], share: f64) -> Result<Option<Beside>, String> {
        let moved = |(variable, &x): (&DesignVariable, &f64)| {
            let step = share * if x == 0.0 { 1.0 } else { x.abs() };
            if x + step <= variable.upper { x + step } else { (x - step).max(variable.lower) }
        };
        let moved: Vec<f64> = self.variables.iter().zip(x).map(moved).collect();
        let Ok(built) = self.scene.build_real(&moved) else { return Ok(None) };
        // options that follow the variables would be missing in derivatives
        let numbers = self.same_laws(&moved, Ok(built))?;
        Ok(Some((moved, numbers)))
    }
    fn variable_name(&self, place: usize) -> String {
        self.variables.get(place).map_or_else(|| format!("{}", place + 1), |own| format!("\"{}\"", own.name))
    }
    fn number_name(&self, list: NumberList, place: usize) -> String {
        let model = self.model();
        let parts = model.elements.iter().map(|own| (&own.name, &own.parameters));
        let parts = parts.chain(model.constraints.iter().map(|own| (&own.name, &own.parameters)));
        let nodes = model.nodes.iter().map(|node| (&node.name, &node.dofs));
        let find = |mut owners: Box<dyn Iterator<Item = (&String, &Range<usize>)> + '_>| {
            owners.find(|(_, numbers)| numbers.contains(&place)).map(|(name, numbers)| (name.clone(), place - numbers.start))
        };
        let owner = find(if list == NumberList::Parameters { Box::new(parts) } else { Box::new(nodes) });
        let (name, place) = owner.unwrap_or_else(|| ("the model".into(), place));
        format!("{} {} of \"{name}\"", list.word(), place + 1)
    }
    fn nearby(&self, x: &[f64]) -> Result<ModelNumbers<f64>, String> {
        self.same_laws(x, self.scene.build_real(x))
    }
    fn recorded(&self, x: &[Recorded]) -> Result<ModelNumbers<Recorded>, String> {
        let own: Vec<f64> = x.iter().map(|x| x.value()).collect();
        check_design(&self.variables, &own)?;
        self.same_laws(&own, self.scene.build_recorded(x))
    }
}
