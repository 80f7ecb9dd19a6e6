use super::{DesignHistory, Ended, Stopping};
use crate::design::DesignVariable;
use crate::functionals::{AggregateKind, Functional};
use crate::history::Keep;
use crate::integrators::{Method, RunError, TimeGrid};
use crate::scenes::{
    AnyScene, FunctionalConstraint, OptimizationProblem, Prepared, Scenario, Sense, Settings, check_modes, fingerprint,
    whole_number,
};

/// Where gradients come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GradientBy {
    /// One adjoint sweep, whatever the number of variables.
    Adjoint,
    /// One more simulation for each variable that varies, at `share` more of its value; not exact.
    Difference {
        /// Relative change of the variable.
        share: f64,
    },
    /// One complex-step simulation for each variable.
    ComplexStep,
}

/// Sees an optimization go on, and may end it.
pub trait Watcher: Sync {
    /// The history has a new point or a new iteration; `false` ends the optimization.
    fn changed(&mut self, _history: &DesignHistory) -> bool {
        true
    }
    /// Asked at every step of every simulation.
    fn wants_to_stop(&self) -> bool {
        false
    }
}

impl Watcher for () {}

/// A scene with its problem, checked, and how it is simulated.
///
/// ```no_run
/// use costate::optimize::{Optimization, Sqp};
/// use costate::scenes::built_in;
/// let optimization = Optimization::of(built_in::named("five-bar")?)?;
/// let optimized = optimization.run(&Sqp, &optimization.initial(), &mut ())?;
/// println!("{:?}", optimized.history.best());
/// # Ok::<(), costate::integrators::RunError>(())
/// ```
pub struct Optimization<'s> {
    /// The scene.
    pub scene: &'s dyn AnyScene,
    /// What is wanted; functionals of scenarios are named as in "stress \[hover\]".
    pub problem: OptimizationProblem,
    /// In which circumstances a design is simulated: its scenarios, or the scene itself.
    pub cases: Vec<Case<'s>>,
    /// How their steps are kept for gradients.
    pub keep: Keep,
    /// Where gradients come from.
    pub gradient: GradientBy,
    /// When to end.
    pub stopping: Stopping,
    pub(super) variables: Vec<DesignVariable>,
    /// Names and units of the functionals that the problem names.
    pub(super) functionals: Vec<(String, String)>,
    /// The case of each of them, and its name there.
    pub(super) places: Vec<(usize, String)>,
    /// Those of them that are aggregates.
    aggregates: Vec<(String, AggregateKind)>,
    /// The steps of each case at the initial design, whose numbers between breakpoints all designs have.
    pub(super) grids: Vec<TimeGrid>,
}

/// One simulation of a design.
pub struct Case<'s> {
    /// Name of the scenario; empty where there is none.
    pub name: String,
    /// What is simulated.
    pub scene: &'s dyn AnyScene,
    /// How it is integrated.
    pub method: Method,
    /// Duration and steps.
    pub settings: Settings,
}

impl<'s> Case<'s> {
    /// A scenario, or a scene by itself without a name, with its own method and settings.
    ///
    /// # Errors
    /// A method that is not listed.
    pub fn of(Scenario { name, scene }: Scenario<'s>) -> Result<Self, RunError> {
        let settings = scene.settings();
        Ok(Case { name, scene, method: Prepared::method_of(&settings)?, settings })
    }

    /// Words about it, with its name where it has one.
    pub fn told(&self, words: String) -> String {
        if self.name.is_empty() { words } else { format!("scenario \"{}\": {words}", self.name) }
    }

    /// What a functional of it is called.
    pub(super) fn full_name(&self, functional: &str) -> String {
        if self.name.is_empty() { functional.into() } else { format!("{functional} [{}]", self.name) }
    }
}

/// Where an optimization ended.
#[derive(Debug)]
pub struct Optimized {
    /// Why it ended, and its counts. The best point of this is in scaled variables; see [`DesignHistory::best`].
    pub ended: Ended,
    /// All designs that were simulated.
    pub history: DesignHistory,
    /// What the last failed design failed with.
    pub failure: Option<RunError>,
}

impl<'s> Optimization<'s> {
    /// A scene's own problem, with its own method and settings.
    ///
    /// # Errors
    /// A scene without a problem, and those of [`Optimization::new`].
    pub fn of(scene: &'s dyn AnyScene) -> Result<Self, RunError> {
        let problem = scene.optimization_problem();
        let problem = problem
            .ok_or_else(|| RunError::Input(format!("the scene \"{}\" states no optimization problem", scene.name())))?;
        let cases = Scenario::all_of(scene).into_iter().map(Case::of).collect::<Result<_, _>>()?;
        Self::new(scene, problem, cases)
    }

    /// Checks a problem against a scene that is simulated in some circumstances. A limit of a functional that names no scenario holds in all that
    /// have it.
    ///
    /// # Errors
    /// A name that the scene has not, or a number that makes no sense.
    pub fn new(scene: &'s dyn AnyScene, problem: OptimizationProblem, cases: Vec<Case<'s>>) -> Result<Self, RunError> {
        let variables = scene.variables();
        let initial: Vec<f64> = variables.iter().map(|variable| variable.initial).collect();
        let (mut all, mut grids) = (Vec::new(), Vec::new());
        for (place, case) in cases.iter().enumerate() {
            if case.scene.variables().iter().map(|own| &own.name).ne(variables.iter().map(|own| &own.name)) {
                let words = case.told("its design variables are not those of the scene, which all share".into());
                return Err(RunError::Input(words));
            }
            let mechanism = case.scene.build_real(&initial).map_err(RunError::Input)?;
            let Settings { end, steps, control, .. } = &case.settings;
            let breakpoints = mechanism.breakpoints(*end).map_err(RunError::Input)?;
            let steps = if control.is_some() { 1 } else { *steps };
            grids.push(TimeGrid::uniform(*end, steps, &breakpoints).map_err(RunError::Input)?);
            let modes = case.scene.modes();
            check_modes(&modes, &mechanism.functionals)?;
            let modes = modes.into_iter().map(|own| (own.unit().to_string(), own.name, None));
            let kind = |own: &Functional| own.over.aggregate().map(|own| own.kind);
            let functionals = mechanism.functionals.iter().map(|own| (own.value_unit(), own.name.clone(), kind(own)));
            all.extend(functionals.chain(modes).map(|(unit, name, aggregate)| {
                let full = case.full_name(&name);
                CaseFunctional { case: place, name, full, unit, aggregate }
            }));
        }
        let problem_of = |message| RunError::Input(format!("optimization of \"{}\": {message}", scene.name()));
        let problem = in_all_scenarios(problem, &all);
        let names: Vec<&str> = all.iter().map(|own| own.full.as_str()).collect();
        problem.check(&variables, &names).map_err(problem_of)?;
        let aggregates = all.iter().filter_map(|own| Some((own.full.clone(), own.aggregate?))).collect();
        let named = |name: &str| {
            problem.objective.iter().any(|(own, _)| own == name)
                || problem.constraints.iter().any(|constraint| constraint.functional == name)
        };
        all.retain(|own| named(&own.full));
        let (functionals, places) = all.into_iter().map(|own| ((own.full, own.unit), (own.case, own.name))).unzip();
        let (keep, gradient, stopping) = (Keep::default(), GradientBy::Adjoint, Stopping::default());
        Ok(Optimization {
            scene,
            problem,
            cases,
            keep,
            gradient,
            stopping,
            variables,
            functionals,
            places,
            aggregates,
            grids,
        })
    }

    /// The design variables.
    pub fn variables(&self) -> &[DesignVariable] {
        &self.variables
    }

    /// Names and units of the functionals that the problem names.
    pub fn functionals(&self) -> &[(String, String)] {
        &self.functionals
    }

    /// The kind of aggregate of a functional, if it is one.
    pub fn aggregate(&self, name: &str) -> Option<AggregateKind> {
        self.aggregates.iter().find(|own| own.0 == name).map(|own| own.1)
    }

    /// The scene's own design.
    pub fn initial(&self) -> Vec<f64> {
        self.variables.iter().map(|variable| variable.initial).collect()
    }

    /// Places of the variables that vary.
    pub fn varying(&self) -> Vec<usize> {
        let varies = |name: &String| self.problem.varying.as_ref().is_none_or(|names| names.contains(name));
        (0..self.variables.len()).filter(|&i| varies(&self.variables[i].name)).collect()
    }

    /// A history without points.
    pub(super) fn history(&self) -> DesignHistory {
        DesignHistory {
            variables: self.variables.iter().map(|own| (own.name.clone(), own.unit.into())).collect(),
            functionals: self.functionals.clone(),
            maximize: self.problem.sense == Sense::Maximize,
            tolerance: self.stopping.violation,
            points: Vec::new(),
        }
    }

    /// What values and gradients of a design follow from: a whole number, not a number where it cannot be built.
    pub(super) fn fingerprint(&self, design: &[f64]) -> f64 {
        let of_case = |(number, case): (usize, &Case)| {
            let is_measured = |name: &str| self.places.iter().any(|place| place.0 == number && place.1 == name);
            fingerprint(case.scene, design, (&case.method, &case.settings), is_measured, true)
        };
        let measures = |case: &(usize, &Case)| self.places.iter().any(|place| place.0 == case.0);
        let all: Vec<f64> = self.cases.iter().enumerate().filter(measures).map(of_case).collect();
        if all.iter().any(|own| own.is_nan()) {
            return f64::NAN;
        }
        whole_number(&(all.iter().map(|own| own.to_bits()).collect::<Vec<u64>>(), format!("{:?}", self.gradient)))
    }

    /// The values of the linear constraints' sums at a design.
    pub fn linear_values(&self, design: &[f64]) -> Vec<f64> {
        let of =
            |name: &String| self.variables.iter().zip(design).find(|(own, _)| own.name == *name).map_or(0.0, |(_, x)| *x);
        let sum = |coefficients: &[(String, f64)]| coefficients.iter().map(|(name, factor)| factor * of(name)).sum();
        self.problem.linear.iter().map(|constraint| sum(&constraint.coefficients)).collect()
    }
}

/// A functional of a case.
struct CaseFunctional {
    case: usize,
    name: String,
    full: String,
    unit: String,
    aggregate: Option<AggregateKind>,
}

/// The problem with a limit for each scenario where one names none, and an objective that only one scenario has by its full name.
fn in_all_scenarios(mut problem: OptimizationProblem, all: &[CaseFunctional]) -> OptimizationProblem {
    let known = |name: &str| all.iter().any(|own| own.full == name);
    let of = |name: &str| -> Vec<String> { all.iter().filter(|own| own.name == name).map(|own| own.full.clone()).collect() };
    problem.constraints = std::mem::take(&mut problem.constraints)
        .into_iter()
        .flat_map(|constraint| match of(&constraint.functional) {
            full if known(&constraint.functional) || full.is_empty() => vec![constraint],
            full => full.into_iter().map(|functional| FunctionalConstraint { functional, ..constraint.clone() }).collect(),
        })
        .collect();
    for (name, _) in problem.objective.iter_mut().filter(|(name, _)| !known(name)) {
        if let [only] = &of(name)[..] {
            *name = only.clone();
        }
    }
    problem
}
