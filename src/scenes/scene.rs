use super::builder::MechanismBuilder;
use super::optimization_problem::OptimizationProblem;
use super::{FitProblem, ModeMeasure};
use crate::design::DesignVariable;
use crate::integrators::{ConstraintLevel, ConstraintPolicy, NewtonTolerance, STATIC_TABLE, StepControl};
use crate::linalg::Backend;
use crate::program::Recorded;
use crate::scalar::Scalar;

/// Defaults of a scene's runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Duration \[s\]; in statics the last load factor.
    pub end: f64,
    /// Steps of equal size; without meaning where they are chosen.
    pub steps: usize,
    /// Choose steps by their error.
    pub control: Option<StepControl>,
    /// Halve steps of equal size that Newton's method cannot make.
    pub divide: bool,
    /// End steps where elements pass from one piece of their formulas to another.
    pub locate: bool,
    /// What to do about inconsistent starts and redundant constraints.
    pub policy: ConstraintPolicy,
    /// Name of the scene's own integrator, where it is not the default one: see [`Prepared::method_of`](super::Prepared::method_of).
    pub method: Option<String>,
    /// Time derivative on which constraints are kept.
    pub level: ConstraintLevel,
    /// When Newton's method stops.
    pub newton: NewtonTolerance,
    /// Solver of the linear systems.
    pub solver: Backend,
}

impl Settings {
    /// A duration \[s\] and a number of steps; inconsistent starts and redundant constraints are refused.
    pub fn new(end: f64, steps: usize) -> Self {
        Settings {
            end,
            steps,
            control: None,
            divide: false,
            locate: true,
            policy: ConstraintPolicy::default(),
            method: None,
            level: ConstraintLevel::default(),
            newton: NewtonTolerance::default(),
            solver: Backend::default(),
        }
    }

    /// Equilibria instead of a motion: time is a load factor that goes from 0 to 1 in equal steps.
    pub fn statics(steps: usize) -> Self {
        Settings::new(1.0, steps).with_method(STATIC_TABLE)
    }

    /// An integrator of the scene's own.
    #[must_use]
    pub fn with_method(mut self, name: impl Into<String>) -> Self {
        self.method = Some(name.into());
        self
    }

    /// Leaves the integrator to the caller.
    #[must_use]
    pub fn without_method(mut self) -> Self {
        self.method = None;
        self
    }

    /// Chooses steps by their error instead of equal ones.
    #[must_use]
    pub fn choosing_steps(mut self, control: StepControl) -> Self {
        self.control = Some(control);
        self
    }

    /// Halves steps of equal size that Newton's method cannot make, instead of stopping there: for motions with snaps.
    #[must_use]
    pub fn dividing_steps(mut self) -> Self {
        self.divide = true;
        self
    }

    /// Leaves out redundant constraint equations.
    #[must_use]
    pub fn dropping_redundant(mut self) -> Self {
        self.policy.drop_redundant = true;
        self
    }

    /// Begins the motion at the equilibrium under the loads of its start, near the coordinates that the scene gives: see
    /// [`MechanismBuilder::hold`] for what such an equilibrium leaves free.
    #[must_use]
    pub fn from_equilibrium(mut self) -> Self {
        self.policy.from_equilibrium = true;
        self
    }

    /// Projects the start onto the constraints.
    #[must_use]
    pub fn projecting_start(mut self) -> Self {
        self.policy.project_start = true;
        self
    }
}

/// A mechanism as a function of its design variables, written once for every number type.
///
/// `build` states topology, parameters and initial state; topology must not depend on `x` (it is checked).
pub trait Scene {
    /// Name on the command line.
    fn name(&self) -> String;
    /// One sentence: what it is.
    fn summary(&self) -> String {
        String::new()
    }
    /// Design variables, in the order of `x`.
    fn variables(&self) -> Vec<DesignVariable>;
    /// Duration, steps, and what to do about redundant constraints.
    fn settings(&self) -> Settings;
    /// What is to be optimized, if anything.
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        None
    }
    /// What was measured, to which it is to be fitted, if anything.
    fn fit_problem(&self) -> Option<FitProblem> {
        None
    }
    /// Numbers of modes of small vibrations that are measured beside its functionals.
    fn modes(&self) -> Vec<ModeMeasure> {
        Vec::new()
    }
    /// What its runs write, where the command line does not say otherwise.
    fn output(&self) -> Output {
        Output::default()
    }
    /// The circumstances in which it is run, one by one, instead of by itself; none by default.
    fn scenarios(&self) -> Vec<Scenario<'_>> {
        Vec::new()
    }
    /// Builds the mechanism for the design `x`.
    ///
    /// # Errors
    /// In words, with names and numbers.
    fn build<S: Scalar>(&self, x: &[S], mechanism: &mut MechanismBuilder<S>) -> Result<(), String>;
}

/// One of the circumstances in which a design is to be judged: a flight, a load case, a manoeuvre.
pub struct Scenario<'s> {
    /// Its name among the others.
    pub name: String,
    /// The scene under these circumstances, with the same design variables.
    pub scene: &'s dyn AnyScene,
}

impl<'s> Scenario<'s> {
    /// What of a scene is run: its scenarios, or the scene itself, without a name.
    #[doc(hidden)]
    pub fn all_of(scene: &'s dyn AnyScene) -> Vec<Self> {
        match scene.scenarios() {
            all if all.is_empty() => vec![Scenario { name: String::new(), scene }],
            all => all,
        }
    }
}

/// What a run writes beside its histories at the steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Output {
    /// Histories at multiples of this time instead of at the steps \[s\].
    pub step: Option<f64>,
    /// What has columns: nodes, members with all their nodes, joints, functionals by their names, and `energy`; everything if there are none.
    pub histories: Vec<String>,
    /// Meshes for ParaView.
    pub meshes: bool,
}

/// A scene with its type erased; every [`Scene`] is one, with the same names, and a [`FileScene`](super::FileScene). Where both traits are in scope, take
/// `&dyn AnyScene`.
pub trait AnyScene: Sync {
    /// Name on the command line.
    fn name(&self) -> String;
    /// What it is.
    fn summary(&self) -> String;
    /// Design variables.
    fn variables(&self) -> Vec<DesignVariable>;
    /// Defaults of its runs.
    fn settings(&self) -> Settings;
    /// What is to be optimized.
    fn optimization_problem(&self) -> Option<OptimizationProblem>;
    /// What it is to be fitted to.
    fn fit_problem(&self) -> Option<FitProblem> {
        None
    }
    /// Numbers of modes that are measured.
    fn modes(&self) -> Vec<ModeMeasure>;
    /// What its runs write.
    fn output(&self) -> Output;
    /// What reading it left out or made of its files, in words.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
    /// Where a part of this name is described, as messages say it: file, line and column of a scene from a file.
    fn place_of(&self, _part: &str) -> Option<String> {
        None
    }
    /// The circumstances in which it is run.
    fn scenarios(&self) -> Vec<Scenario<'_>>;
    /// Recorded, with values.
    fn build_recorded(&self, x: &[Recorded]) -> Result<MechanismBuilder<Recorded>, String>;
    /// In real numbers: those that are recorded where none of the variables is, so that what builds a scene is compiled once.
    fn build_real(&self, x: &[f64]) -> Result<MechanismBuilder<f64>, String> {
        let constants: Vec<Recorded> = x.iter().map(|&own| own.into()).collect();
        self.build_recorded(&constants).map(MechanismBuilder::in_real_numbers)
    }
}

/// The finished mechanism of what builds one.
pub(super) fn built(
    build: impl FnOnce(&mut MechanismBuilder<Recorded>) -> Result<(), String>,
) -> Result<MechanismBuilder<Recorded>, String> {
    let mut mechanism = MechanismBuilder::default();
    build(&mut mechanism)?;
    mechanism.finish()
}

macro_rules! same_as_of_scene {
    ($($method:ident -> $type:ty),*) => {$(
        fn $method(&self) -> $type {
            Scene::$method(self)
        }
    )*};
}

impl<T: Scene + Sync> AnyScene for T {
    same_as_of_scene!(
        name -> String, summary -> String, variables -> Vec<DesignVariable>, settings -> Settings,
        optimization_problem -> Option<OptimizationProblem>, fit_problem -> Option<FitProblem>, modes -> Vec<ModeMeasure>, output -> Output,
        scenarios -> Vec<Scenario<'_>>
    );
    fn build_recorded(&self, x: &[Recorded]) -> Result<MechanismBuilder<Recorded>, String> {
        built(|m| self.build(x, m))
    }
}
