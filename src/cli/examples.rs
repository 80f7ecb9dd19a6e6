//! Examples below the help of each command, with the names of the program and of its scenes.

use super::CommandLine;
use costate::design::DesignVariable;
use costate::scenes::AnyScene;

/// Lines of a command: what stands behind the name of the program, and what it does.
type Examples = Vec<(String, &'static str)>;

/// Sweeps of a scene over one of its variables, and over all.
fn sweeps(scene: &str, variable: Option<&DesignVariable>) -> Examples {
    let range = variable.map_or_else(|| "length=1:2".into(), |own| format!("{}={}:{}", own.name, own.lower, own.upper));
    vec![
        (format!("sweep {scene} --vary \"{range}:5\""), "five values of one variable"),
        (format!("sweep {scene} --samples 64 --sampling sobol"), "64 designs within the bounds of all variables"),
    ]
}

impl CommandLine<'_> {
    /// A scene with some property, else the first one, else one that is built in, else a file.
    fn example_scene(&self, has: impl Fn(&dyn AnyScene) -> bool, built_in: &'static str) -> String {
        let found = self.scenes.iter().find(|scene| has(**scene)).or(self.scenes.first());
        let other = if self.built_in.is_empty() { "arm.toml" } else { built_in };
        found.map_or_else(|| other.into(), |scene| scene.name())
    }

    /// What stands below the help of a command.
    pub(super) fn examples(&self, command: &str) -> String {
        let first = self.example_scene(|_| true, "pendulum");
        let better = self.example_scene(|scene| scene.optimization_problem().is_some(), "five-bar");
        let variable = self.own_scene(&first).ok().flatten().and_then(|scene| scene.variables().into_iter().next());
        let set = variable.as_ref().map_or_else(String::new, |own| format!(" --set \"{}={}\"", own.name, own.initial));
        let examples: Examples = match command {
            "run" => vec![
                (format!("run {first}"), "the motion, with a report and other results in out/"),
                (format!("run {first} --steps 2000{set} --out results"), "finer, another design, another folder"),
                (
                    "run arm.toml --tolerance 1e-6 --vtk".into(),
                    "a scene file, steps chosen by their error, meshes for ParaView",
                ),
            ],
            "gradient" => vec![
                (format!("gradient {first} --check"), "derivatives by the adjoint, compared with complex step"),
                (format!("gradient {first} --history checkpoints:100"), "in 100 MB of memory, however many steps"),
            ],
            "optimize" => vec![
                (format!("optimize {better}"), "the problem that the scene states"),
                (format!("optimize {better} --iterations 20 --json"), "with one JSON object behind the tables"),
            ],
            "fit" => {
                let measured = self.example_scene(|scene| scene.fit_problem().is_some(), "damped-oscillator");
                vec![
                    (format!("fit {measured}"), "the variables that fit its measurements, and how exactly"),
                    (format!("fit {measured} --starts 8"), "from eight designs within the bounds"),
                ]
            }
            "response" => vec![(
                "response beam.toml --by force --rates 1:1000:200:log".into(),
                "amplitude and phase of the functionals of a scene file over the rate of a force",
            )],
            "import" => vec![("import robot.urdf".into(), "writes robot.toml, held on the ground at its root link")],
            "sweep" => sweeps(&first, variable.as_ref()),
            "modes" => {
                let is_still = |scene: &dyn AnyScene| scene.settings().method.as_deref() == Some("static");
                let still = self.example_scene(is_still, "von-mises-truss");
                vec![
                    (format!("modes {still} --count 4"), "the four slowest"),
                    ("modes arm.toml --static".into(), "about the equilibrium under the scene's loads"),
                ]
            }
            "verify" => self.studies.first().map_or_else(Vec::new, |study| {
                vec![("verify".into(), "the studies"), (format!("verify {}", study.name()), "one of them")]
            }),
            "check" => vec![("check arm.toml".into(), "what is wrong with the file, with line and column")],
            "new" => vec![("new arm.toml".into(), "a flexible arm to change into something of your own")],
            "schema" => vec![("schema > costate.json".into(), "for `#:schema costate.json` in the first line of a file")],
            "list" => {
                vec![("list".into(), "all scenes"), (format!("list {first}"), "design variables and functionals of one")]
            }
            "completions" => vec![(
                format!("completions bash > ~/.local/share/bash-completion/completions/{}", self.name),
                "for new shells",
            )],
            "man" => vec![("man ~/.local/share/man/man1".into(), "a page of the manual for each command")],
            _ => Vec::new(),
        };
        let width = examples.iter().map(|(line, _)| line.chars().count()).max().unwrap_or_default();
        let lines = examples.iter().map(|(line, what)| format!("  {} {line:<width$}  {what}", self.name));
        format!("Examples:\n{}", lines.collect::<Vec<_>>().join("\n"))
    }
}
