use super::entry_context::{Builder, Built, EntryContext, kept};
use super::extended::{text_of, whole_tree};
use super::fields::{Each, Fields, Item, Value};
use super::mistake::{Mistake, Source};
use super::own_parts::OwnParts;
use super::raw::Raw;
use super::reader::{Contents, Variable, read};
use super::scenarios::{take_scenarios, without_problem};
use crate::design::DesignVariable;
use crate::integrators::{
    ConstraintLevel, MOST_STEPS, NewtonTolerance, STATIC_TABLE, StepControl, table_named, table_names,
};
use crate::linalg::Backend;
use crate::program::Recorded;
use crate::scalar::Scalar;
use crate::scenes::{
    AnyScene, FitProblem, FunctionalConstraint, Limit, LinearConstraint, MechanismBuilder, ModeMeasure, OptimizationProblem,
    Output, Scenario, Sense, Settings, built, check_folders, unknown,
};
use std::cell::Cell;
use std::collections::HashSet;
use std::path::Path;

/// A scene that a file describes: see [the format](super).
///
/// ```
/// use costate::scenes::{FileScene, Prepared};
/// let text = r#"
///     version = 1
///     gravity = [0, -9.81, 0]
///     settings = { end = 0.592, steps = 100 }
///     variable.length = { initial = 1.0, bounds = [0.1, 10], unit = "m" }
///
///     [[point]]
///     name = "bob"
///     position = ["-length", 0, 0]
///     mass = 1.0
///
///     [[joint]]
///     name = "rod"
///     type = "distance"
///     between = ["ground", "bob"]
///
///     [[functional]]
///     name = "height at the end"
///     type = "position"
///     on = "bob"
///     direction = [0, 1, 0]
///     over = "terminal"
/// "#;
/// let scene = FileScene::parse("pendulum.toml", text)?;
/// let prepared = Prepared::new(&scene).map_err(|error| error.to_string())?;
/// let analysis = prepared.analysis();
/// let forward = analysis.forward(&prepared.x).map_err(|error| error.to_string())?;
/// // a quarter of a period, 1.85407 sqrt(l / g), takes it to its lowest place
/// assert!((forward.values[0] + 1.0).abs() < 1e-6);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug)]
pub struct FileScene {
    source: Source,
    contents: Contents,
    name: String,
    variables: Vec<DesignVariable>,
    settings: Settings,
    problem: Option<OptimizationProblem>,
    fit: Option<FitProblem>,
    output: Output,
    scenarios: Vec<(String, FileScene)>,
}

/// Name spaces of what messages name, the likeliest first; others are what parts are made of.
const PARTS: [&str; 5] = ["measurement", "member", "joint", "force", "functional"];

impl FileScene {
    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, or what is wrong in it: see [`FileScene::parse`].
    pub fn read(path: &Path) -> Result<Self, String> {
        Self::read_with(path, &OwnParts::default())
    }

    /// Reads a file in which parts of one's own have forms, too.
    ///
    /// # Errors
    /// As [`FileScene::read`].
    pub fn read_with(path: &Path, parts: &OwnParts) -> Result<Self, String> {
        Self::parse_with(&path.display().to_string(), &text_of(path)?, parts)
    }

    /// Reads the text of a file; its name is for messages, and for the scene unless the file gives one.
    ///
    /// # Errors
    /// All mistakes that were found, a line each: file, line, column, key, value, what is allowed.
    pub fn parse(file: &str, text: &str) -> Result<Self, String> {
        Self::parse_with(file, text, &OwnParts::default())
    }

    /// Reads a text in which parts of one's own have forms, too.
    ///
    /// # Errors
    /// As [`FileScene::parse`].
    pub fn parse_with(file: &str, text: &str, parts: &OwnParts) -> Result<Self, String> {
        parts.check()?;
        let mut source = Source::new(file.into(), text.into());
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        if let Some(kind) = other_format(text) {
            return Err(format!("{file}: this is {kind}"));
        }
        let root = whole_tree(&mut source)?;
        Self::of_tree(source, root, folder, parts)
    }

    /// Takes entries that a program gives: sections as in a file, whose tables say by the key "" where they come from, a number of the list of
    /// places that the key "" of the whole has; `{"": 3, "=": value}` is a value with its place.
    ///
    /// # Errors
    /// As [`FileScene::parse`].
    pub fn of_entries(file: &str, entries: &serde_json::Value, parts: &OwnParts) -> Result<Self, String> {
        parts.check()?;
        let places = entries[""].as_array().into_iter().flatten().filter_map(|own| own.as_str().map(String::from));
        let source = Source::of_program(file.into(), places.collect());
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        Self::of_tree(source, Raw::of_entries(entries, 0), folder, parts)
    }

    /// The text of a scene file with these entries.
    pub fn text_of(entries: &serde_json::Value) -> String {
        Raw::of_entries(entries, 0).written()
    }

    fn of_tree(source: Source, mut root: Raw, folder: &Path, parts: &OwnParts) -> Result<Self, String> {
        let file = source.name().to_string();
        let told = |mistakes| source.all_told(mistakes);
        let scenarios = take_scenarios(&mut root).map_err(told)?;
        let mut made = Vec::new();
        for (name, scenario) in scenarios {
            let own = Self::of_root(source.clone(), &scenario, (folder, parts), &[]).map_err(|why| {
                // what is wrong without it is not the scenario's
                let without = Self::of_root(source.clone(), &without_problem(&root), (folder, parts), &[]);
                without.err().unwrap_or_else(|| format!("scenario \"{name}\": {why}"))
            })?;
            made.push((own, name));
        }
        let functionals = |(own, name): &(FileScene, String)| {
            own.contents.functionals().flat_map(|own| [format!("{own} [{name}]"), own.into()]).collect::<Vec<_>>()
        };
        let functionals: Vec<String> = made.iter().flat_map(functionals).collect();
        let mut scene = Self::of_root(source, &root, (folder, parts), &functionals)?;
        for (mut own, name) in made {
            own.name = format!("{}, {name}", scene.name);
            check_folders([&*own.name]).map_err(|(_, why)| format!("{file}: scenario \"{name}\": {why}"))?;
            if !own.variables.iter().map(|own| &own.name).eq(scene.variables.iter().map(|own| &own.name)) {
                return Err(format!(
                    "{file}: scenario \"{name}\" has other design variables than the file: they are shared"
                ));
            }
            scene.scenarios.push((name, own));
        }
        Ok(scene)
    }

    /// What the tree of a text says, whose problem may name other functionals, too.
    fn of_root(
        source: Source,
        root: &Raw,
        (folder, parts): (&Path, &OwnParts),
        functionals: &[String],
    ) -> Result<Self, String> {
        let contents = read(root, folder, parts).map_err(|mistakes| source.all_told(mistakes))?;
        let file = source.name();
        let stem = Path::new(file).file_stem().map_or_else(|| file.into(), |stem| stem.to_string_lossy().into_owned());
        let mut run = RunEntries { contents: &contents, mistakes: Vec::new() };
        let name = contents.top.text("name").map_or(stem, String::from);
        if let Err((_, why)) = check_folders([&*name]) {
            let mend = if contents.top.has("name") { "" } else { "; give the file a key name" };
            run.wrong(contents.top.place("name"), why + mend);
        }
        let (variables, settings) = (run.variables(), run.settings());
        let functionals = run.functionals(functionals);
        let problem = run.problem(&variables, functionals.clone());
        let fit = run.fit(&variables, &functionals);
        let output = run.output(settings.end);
        run.check_spans(settings.end);
        let mut mistakes = run.mistakes;
        if mistakes.is_empty() {
            for (section, fields) in &contents.single {
                mistakes.extend(fields.unread().into_iter().map(|(key, at)| {
                    Mistake::new(at, format!("{key} of [{section}] has no effect beside its other keys: leave it out"))
                }));
            }
        }
        if !mistakes.is_empty() {
            return Err(source.all_told(mistakes));
        }
        Ok(FileScene { source, contents, name, variables, settings, problem, fit, output, scenarios: Vec::new() })
    }
}

/// What a text is that is no scene file, and what to do with it.
fn other_format(text: &str) -> Option<&'static str> {
    let text = text.trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n']);
    if text.starts_with("$MeshFormat") {
        return Some("a mesh of Gmsh, and no scene: name it in a scene file by the key file of a [[mesh]] of type \"gmsh\"");
    }
    if text.starts_with("<?xml") || text.starts_with("<robot") || text.starts_with("<mujoco") || text.starts_with("<sdf") {
        return Some(
            "a file in XML, as URDF and MJCF are, which are not read: write its bodies and joints as entries of a scene file in TOML",
        );
    }
    text.starts_with('{').then_some("JSON, and no scene: scene files are TOML")
}

impl Variable {
    /// How many numbers of the design it has.
    fn count(&self) -> usize {
        self.numbers.len().max(1)
    }
    fn names(&self) -> Vec<String> {
        match &self.numbers[..] {
            [] => vec![self.name.clone()],
            numbers => numbers.iter().map(|number| format!("{}[{number}]", self.name)).collect(),
        }
    }
}

/// What a file says of the run, and what is wrong with it.
pub(super) struct RunEntries<'c> {
    pub contents: &'c Contents,
    pub mistakes: Vec<Mistake>,
}

impl<'c> RunEntries<'c> {
    pub(super) fn wrong(&mut self, at: usize, what: impl Into<String>) {
        self.mistakes.push(Mistake::new(at, what));
    }

    pub(super) fn single(&self, name: &str) -> Option<&'c Fields> {
        self.contents.single.iter().find(|own| own.0 == name).map(|own| &own.1)
    }

    /// A name must be known.
    pub(super) fn check(&mut self, kind: &str, at: usize, name: &str, known: &[String]) {
        if !known.iter().any(|own| own == name) {
            self.wrong(at, unknown(kind, name, known));
        }
    }

    /// Formulas of time hold at all times; when they were splines, these went on with constant slope before their start and after their end.
    fn check_spans(&mut self, end: f64) {
        let functions = self.contents.items.iter().flat_map(|item| &item.fields.values).filter_map(|own| match &own.2 {
            Value::Fields(fields) if fields.form == "formula" => Some(fields),
            _ => None,
        });
        for function in functions {
            let is_outside = |key| function.fixed(key).is_some_and(|own| if key == "start" { own > 0.0 } else { own < end });
            for key in ["start", "end"].into_iter().filter(|key| is_outside(key)) {
                let text = format!(
                    "{key} lies within the run, but a formula of time holds at all times; leave {key} out, or let if_less choose between what \
                     holds before it and after it"
                );
                self.wrong(function.place(key), text);
            }
        }
    }

    /// What a run writes. What histories are to have is the energy, or a part that has nodes, multipliers, forces or a value, or one of its
    /// nodes.
    fn output(&mut self, end: f64) -> Output {
        let Some(fields) = self.single("output") else { return Output::default() };
        let step = fields.fixed("step");
        if let Some(step) = step.filter(|step| end / step > MOST_STEPS as f64) {
            let text = format!("step of [output] is {step} s, and at most {MOST_STEPS} of them fit into {end} s");
            self.wrong(fields.place("step"), text);
        }
        let told = self.contents.items.iter().filter(|item| item.section.has_columns);
        let mut known: Vec<String> = told.map(|item| item.name.clone()).collect();
        known.push("energy".into());
        for (at, value) in fields.list("histories") {
            let Value::Text(text) = value else { continue };
            let is_of = |name: &String| {
                text.strip_prefix(name.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with(['[', '.', ',']))
            };
            if !known.iter().any(is_of) {
                self.wrong(at, format!("histories of [output]: {}", unknown("part", text, &known)));
            }
        }
        Output { step, histories: fields.texts("histories").map(String::from).collect(), meshes: fields.flag("vtk") }
    }

    fn variables(&mut self) -> Vec<DesignVariable> {
        let mut variables = Vec::new();
        for own in &self.contents.variables {
            let (fields, name, count) = (&self.contents.items[own.item].fields, &own.name, own.count());
            let mut initial = fields.fixed_list("initial");
            let bounds = fields.fixed_list("bounds");
            let &[lower, upper] = bounds.as_slice() else { continue };
            if lower > upper {
                let text = format!("the bounds of \"{name}\" are {lower} and {upper}; give the smaller one first");
                self.wrong(fields.place("bounds"), text);
            } else if let Some(initial) = initial.iter().find(|own| !(lower..=upper).contains(*own)) {
                let text = format!("initial of \"{name}\" is {initial}; it must lie between its bounds {lower} and {upper}");
                self.wrong(fields.place("initial"), text);
            }
            if let &[one] = &initial[..] {
                initial.resize(count, one);
            }
            if initial.len() != count {
                let text = format!("\"{name}\" has {count} values, and these are {}", initial.len());
                self.wrong(fields.place("initial"), text);
            }
            let unit = kept(fields.text("unit").unwrap_or("-"));
            let numbered = own.names().into_iter().zip(initial);
            variables.extend(numbered.map(|(name, initial)| DesignVariable::new(name, initial, (lower, upper), unit)));
        }
        variables
    }

    fn settings(&mut self) -> Settings {
        let Some(fields) = self.single("settings") else {
            self.wrong(self.contents.top.at, "the section [settings] is missing: give it the keys end [s] and steps");
            return Settings::new(1.0, 1);
        };
        let method = fields.text("method");
        match method.map(table_named) {
            None | Some(Ok(Some(_))) => {}
            Some(Ok(None)) => {
                let text = unknown("method of [settings]:", method.unwrap_or_default(), &table_names());
                self.wrong(fields.place("method"), text);
            }
            Some(Err(why)) => self.wrong(fields.place("method"), format!("method of [settings]: {why}")),
        }
        let is_static = method == Some(STATIC_TABLE);
        let tolerance = fields.fixed("tolerance");
        let end = fields.fixed("end").or(is_static.then_some(1.0));
        if end.is_none() {
            self.wrong(fields.at, "[settings] needs the key end: the duration in s");
        }
        match (fields.has("steps"), tolerance) {
            (false, None) => self.wrong(
                fields.at,
                "[settings] needs the key steps, or tolerance where steps are to be chosen by their error",
            ),
            (true, Some(_)) => self
                .wrong(fields.place("tolerance"), "[settings] has steps and tolerance: one of them says how long steps are"),
            _ => {}
        }
        for key in
            ["velocity_tolerance", "locate", "project_start", "start"].into_iter().filter(|key| is_static && fields.has(key))
        {
            self.wrong(fields.place(key), format!("{key} of [settings] means nothing with the method static"));
        }
        for key in ["velocity_tolerance", "longest_step"].into_iter().filter(|key| tolerance.is_none() && fields.has(key)) {
            self.wrong(fields.place(key), format!("{key} of [settings] means nothing without the key tolerance"));
        }
        self.check_start(fields);
        let mut settings = Settings::new(end.unwrap_or(1.0), fields.count("steps").max(1));
        settings.method = method.map(str::to_string);
        let level = fields.text("constraint_level").and_then(ConstraintLevel::by_name);
        settings.level = level.unwrap_or(settings.level);
        let newton = NewtonTolerance::ALL.into_iter().find(|own| fields.text("newton") == Some(own.name()));
        settings.newton = newton.unwrap_or(settings.newton);
        let solver = Backend::ALL.into_iter().find(|own| fields.text("solver") == Some(own.name()));
        settings.solver = solver.unwrap_or(settings.solver);
        settings.divide = fields.flag("divide_steps");
        settings.locate = !matches!(fields.get("locate"), Some((_, Value::Flag(false))));
        settings.policy.drop_redundant = fields.flag("drop_redundant");
        settings.policy.project_start = fields.flag("project_start");
        settings.policy.from_equilibrium = matches!(fields.text("start"), Some("equilibrium" | "steady"));
        settings.control = tolerance.map(|tolerance| {
            let mut control = StepControl::new(tolerance);
            control.velocities = StepControl::new(fields.fixed("velocity_tolerance").unwrap_or(tolerance)).velocities;
            control.longest = fields.fixed("longest_step").unwrap_or(f64::INFINITY);
            control
        });
        settings
    }

    /// Whether what is held and what turns fits to how the motion begins.
    fn check_start(&mut self, fields: &Fields) {
        let (start, contents) = (fields.text("start"), self.contents);
        let first = |section: &str| contents.items.iter().find(|item| item.section.name == section);
        if let Some(hold) = first("hold").filter(|_| !matches!(start, Some("equilibrium" | "steady"))) {
            let text = "[[hold]] holds nodes in the equilibrium at which a motion begins: give [settings] the key start = \"equilibrium\" or \"steady\"";
            self.wrong(hold.fields.at, text);
        }
        match (first("spin"), start == Some("steady")) {
            (Some(spin), false) => {
                let text =
                    "[[spin]] is for a motion that begins with a steady turn: give [settings] the key start = \"steady\"";
                self.wrong(spin.fields.at, text);
            }
            (None, true) => {
                let text = "start = \"steady\" needs a [[spin]]: which parts turn, about which axis, at which rate";
                self.wrong(fields.place("start"), text);
            }
            _ => {}
        }
    }

    fn limit(&mut self, fields: &Fields) -> Limit {
        let given = [
            fields.fixed("at_most").map(Limit::AtMost),
            fields.fixed("at_least").map(Limit::AtLeast),
            fields.fixed("equal").map(Limit::Equal),
        ];
        let given: Vec<Limit> = given.into_iter().flatten().collect();
        if let [one] = given[..] {
            return one;
        }
        let text = format!("a limit needs one of the keys at_most, at_least and equal; {} are given", given.len());
        self.wrong(fields.at, text);
        Limit::Equal(0.0)
    }

    /// The objective, with the key that says it.
    fn objective(&mut self, fields: &Fields) -> Option<(Sense, &'static str, Weights)> {
        let one = |key: &str| vec![(fields.text(key).unwrap_or_default().to_string(), 1.0)];
        match ["minimize", "maximize", "weights"].map(|key| fields.has(key)) {
            [true, false, false] => Some((Sense::Minimize, "minimize", one("minimize"))),
            [false, true, false] => Some((Sense::Maximize, "maximize", one("maximize"))),
            [false, false, true] => {
                let sense = if fields.text("sense") == Some("maximize") { Sense::Maximize } else { Sense::Minimize };
                Some((sense, "weights", weights(fields, "weights")))
            }
            _ => {
                let text = "[optimization] needs one of the keys minimize, maximize and weights, which says the objective";
                self.wrong(fields.at, text);
                None
            }
        }
    }

    /// Names of functionals, and of others of scenarios.
    fn functionals(&self, others: &[String]) -> Vec<String> {
        let mut functionals: Vec<String> = self.contents.functionals().map(String::from).collect();
        for other in others {
            if !functionals.contains(other) {
                functionals.push(other.clone());
            }
        }
        functionals
    }

    /// Names of design variables that may change; one name stands for all of a variable of faces or nodes.
    pub(super) fn varying(&mut self, fields: &Fields, names: &[String]) -> Option<Vec<String>> {
        let all = |name: &str| match self.contents.variables.iter().find(|own| own.name == name) {
            Some(own) => own.names(),
            None => vec![name.into()],
        };
        let varying = fields.has("varying").then(|| fields.texts("varying").flat_map(all).collect::<Vec<String>>());
        let at = fields.place("varying");
        varying.iter().flatten().for_each(|name| self.check("design variable", at, name, names));
        varying
    }

    /// The problem, of functionals of scenarios, too.
    fn problem(&mut self, variables: &[DesignVariable], mut functionals: Vec<String>) -> Option<OptimizationProblem> {
        let (contents, fields) = (self.contents, self.single("optimization")?);
        functionals.extend(modes(contents).map(|mode| mode.name));
        let names: Vec<String> = variables.iter().map(|variable| variable.name.clone()).collect();
        let (sense, key, objective) = self.objective(fields)?;
        objective.iter().for_each(|(name, _)| self.check("functional", fields.place(key), name, &functionals));
        let varying = self.varying(fields, &names);
        let constraints = fields.tables("constraint").map(|own| {
            let functional = own.text("functional").unwrap_or_default().to_string();
            self.check("functional", own.place("functional"), &functional, &functionals);
            FunctionalConstraint { functional, limit: self.limit(own), scale: own.fixed("scale") }
        });
        let constraints = constraints.collect();
        let linear = fields.tables("linear").map(|own| {
            let (name, at) = (own.text("name").unwrap_or_default().to_string(), own.place("coefficients"));
            let coefficients = weights(own, "coefficients");
            coefficients.iter().for_each(|(name, _)| self.check("design variable", at, name, &names));
            LinearConstraint { name, coefficients, limit: self.limit(own) }
        });
        let linear = linear.collect();
        let (scale, screening) = (fields.fixed("scale"), fields.fixed("screening"));
        let problem = OptimizationProblem { sense, objective, scale, constraints, linear, varying, screening };
        // the rest, such as an objective of weights that are zero
        if self.mistakes.is_empty()
            && let Err(why) = problem.check(variables, &functionals.iter().map(String::as_str).collect::<Vec<_>>())
        {
            self.wrong(fields.at, why);
        }
        Some(problem)
    }
}

/// Numbers by the names of functionals or design variables.
type Weights = Vec<(String, f64)>;

fn weights(fields: &Fields, key: &str) -> Weights {
    match fields.get(key) {
        Some((_, Value::Weights(weights))) => weights.clone(),
        _ => Vec::new(),
    }
}

fn modes(contents: &Contents) -> impl Iterator<Item = ModeMeasure> {
    contents.items.iter().filter(|item| item.section.name == "mode").map(|Item { name, fields, .. }| ModeMeasure {
        name: name.clone(),
        number: fields.count("number"),
        growth: fields.text("measure") == Some("growth"),
        damped: fields.flag("damped"),
    })
}

// not as a `Scene`, which would be compiled anew in each program that has files
impl AnyScene for FileScene {
    fn name(&self) -> String {
        self.name.clone()
    }
    fn summary(&self) -> String {
        self.contents.top.text("summary").unwrap_or("a scene from a file").into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        self.variables.clone()
    }
    fn settings(&self) -> Settings {
        self.settings.clone()
    }
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        self.problem.clone()
    }
    fn fit_problem(&self) -> Option<FitProblem> {
        self.fit.clone()
    }
    fn modes(&self) -> Vec<ModeMeasure> {
        modes(&self.contents).collect()
    }
    fn output(&self) -> Output {
        self.output.clone()
    }
    fn scenarios(&self) -> Vec<Scenario<'_>> {
        self.scenarios.iter().map(|(name, scene)| Scenario { name: name.clone(), scene }).collect()
    }
    fn notes(&self) -> Vec<String> {
        let meshes = self.contents.items.iter().filter_map(|item| item.mesh.as_ref());
        let mut notes: Vec<String> =
            meshes.flat_map(|data| data.notes.iter().map(|note| format!("{}: {note}", data.file))).collect();
        let mut told = HashSet::new();
        notes.retain(|note| told.insert(note.clone()));
        notes
    }
    fn place_of(&self, part: &str) -> Option<String> {
        let items = || self.contents.items.iter().filter(|item| !part.is_empty() && item.name == part);
        let item = PARTS.into_iter().find_map(|space| items().find(|item| item.section.space == space))?;
        Some(self.source.place(item.fields.at))
    }
    fn build_recorded(&self, x: &[Recorded]) -> Result<MechanismBuilder<Recorded>, String> {
        built(|m| self.build(x, m))
    }
}

/// The numbers that formulas take, and those of the variables of each face or node of a mesh with their places among them.
type Numbers<'c> = (Vec<Recorded>, Vec<(usize, &'c Each, Vec<Recorded>)>);

impl FileScene {
    /// The numbers that formulas take at a design: the place along a section, the design variables, the definitions.
    fn numbers(&self, x: &[Recorded]) -> Result<Numbers<'_>, String> {
        let (mut numbers, mut each, mut rest) = (vec![Recorded::default()], Vec::new(), x);
        for own in &self.contents.variables {
            let (values, others) = rest.split_at(own.count());
            rest = others;
            if let Some(of) = &own.each {
                each.push((numbers.len(), of, values.to_vec()));
            }
            numbers.extend_from_slice(if own.each.is_none() { values } else { &values[..1] });
        }
        for (at, name, formula) in &self.contents.definitions {
            let value = formula.value(|place| numbers[place]).components();
            if let Some(own) = value.iter().map(|own| own.value()).find(|own| !own.is_finite()) {
                let text = format!("{name} of [define] is {own} at this design; it must be finite");
                return Err(self.source.told(&Mistake::new(*at, text)));
            }
            if formula.constant().is_none() {
                numbers.extend(value);
            }
        }
        Ok((numbers, each))
    }

    fn build(&self, x: &[Recorded], m: &mut Builder) -> Result<(), String> {
        let Contents { top, items, order, own, .. } = &self.contents;
        if x.len() != self.variables.len() {
            return Err(format!("{} variables expected, {} given", self.variables.len(), x.len()));
        }
        let (numbers, each) = self.numbers(x)?;
        let built = items.iter().map(|_| Built::Nothing).collect();
        let (share, elements) = (Cell::new(Recorded::default()), vec![Vec::new(); items.len()]);
        let mut context = EntryContext { own, items, numbers, share, each, built, elements };
        // the ground comes first, as nothing can be joined to it otherwise
        if order.iter().any(|&place| items[place].fields.values.iter().any(|(_, _, value)| names_ground(value))) {
            m.ground();
        }
        let mut mistakes = Vec::new();
        let last = order.iter().rposition(|&place| items[place].section.has_mass());
        for (rank, &place) in order.iter().enumerate() {
            let first = m.model.elements.len();
            let built = (items[place].section.build)(context.entry(place), m);
            context.elements[place] = m.model.element_ids().skip(first).collect();
            let of_builder = m.take_mistakes().into_iter().map(|what| Mistake::new(items[place].fields.at, what));
            let before = mistakes.len();
            mistakes.extend(of_builder);
            match built {
                // a member with mistakes lacks nodes or elements: what needs them would only repeat it
                Ok(
                    Built::Mesh(_) | Built::Shell(_) | Built::Walls(_) | Built::Sphere(_) | Built::Beam(_) | Built::Cable(_),
                ) if mistakes.len() > before => {
                    break;
                }
                Ok(built) => context.built[place] = built,
                Err(mistake) => {
                    mistakes.push(mistake);
                    // what needs this entry would only repeat it
                    break;
                }
            }
            if Some(rank) == last
                && let Some((at, Value::Formula(formula, _))) = top.get("gravity")
            {
                let gravity = formula.value(|place| context.numbers[place]).vector();
                if !gravity.iter().all(|own| own.value().is_finite()) {
                    return Err(self.source.told(&Mistake::new(at, "gravity is not finite at this design")));
                }
                m.gravity(gravity);
            }
        }
        if mistakes.is_empty() {
            mistakes = without_effect(items);
        }
        if mistakes.is_empty() { Ok(()) } else { Err(self.source.all_told(mistakes)) }
    }
}

/// Keys that no part has asked for when all were made.
fn without_effect(items: &[Item]) -> Vec<Mistake> {
    let named: HashSet<usize> = items.iter().flat_map(|item| item.fields.items()).collect();
    let checked = items.iter().filter(|item| match item.section.name {
        "variable" | "mode" | "measurement" => false,
        // what others are made of may stand in a file that does not use it
        "section" | "laminate" => named.contains(&item.place),
        _ => true,
    });
    let told = |item: &Item, (key, at): (&str, usize)| {
        let (section, name) = (item.section.name, &item.name);
        Mistake::new(at, format!("{key} of the {section} \"{name}\" has no effect beside its other keys: leave it out"))
    };
    checked.flat_map(|item| item.fields.unread().into_iter().map(|key| told(item, key))).collect()
}

fn names_ground(value: &Value) -> bool {
    match value {
        Value::Node(place) => place.item.is_none(),
        Value::List(list) => list.iter().any(|(_, own)| names_ground(own)),
        _ => false,
    }
}
