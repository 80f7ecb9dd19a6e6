//! Options of what is looked at about an equilibrium: modes, responses.

use super::CommandLine;
use super::failure::Failure;
use super::options::{changed_design, located, only_scenario};
use clap::Args;
use costate::integrators::{RunError, STATIC_TABLE};
use costate::scenes::{AnyScene, Prepared};
use std::path::PathBuf;

/// A scene, the design, about which state, and where results go.
#[derive(Args)]
pub struct StillOptions {
    /// Name of a scene (see `list`), or path of a scene file (.toml)
    scene: String,
    /// About the equilibrium after the scene's load steps instead of its start; scenes of equilibria do so anyway
    #[arg(long = "static")]
    statics: bool,
    /// Folder for the results [default: out/SCENE]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// One of the scenarios of the scene
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Change a design variable; may be given once for each
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Print one JSON object with all figures on the last line of stdout
    #[arg(long)]
    pub json: bool,
}

impl StillOptions {
    /// Prepares the scene, works with it, and says of an error where it belongs.
    pub fn with_scene(
        &self,
        program: &CommandLine,
        work: impl FnOnce(Prepared, &dyn Fn(RunError) -> Failure) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let found = program.find_scene(&self.scene)?;
        let scene = only_scenario(&*found, self.scenario.as_deref())?;
        let x = changed_design(&scene.variables(), &self.set)?;
        let settings = scene.settings();
        let settings = if self.statics { settings.with_method(STATIC_TABLE) } else { settings };
        let method = Prepared::method_of(&settings)?;
        let named = |error| {
            let failure = Failure::from(error);
            let message = failure.message.replace("by the method \"static\"", "by --static, or correct the start");
            located(scene, &self.scene, Failure { message, ..failure })
        };
        work(Prepared::with(scene, &x, method, settings).map_err(named)?, &named)
    }

    /// The folder for the results.
    pub fn folder(&self, scene: &dyn AnyScene) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(scene.name()))
    }
}
