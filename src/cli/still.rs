//! Options of what is looked at about an equilibrium: modes, responses.

use super::CommandLine;
use super::failure::Failure;
use super::options::DesignOptions;
use clap::Args;
use costate::integrators::{RunError, STATIC_TABLE};
use costate::scenes::Prepared;

/// A scene, the design, and about which state.
#[derive(Args)]
pub struct StillOptions {
    #[command(flatten)]
    pub of: DesignOptions,
    /// About the equilibrium after the scene's load steps instead of its start; scenes of equilibria do so anyway
    #[arg(long = "static")]
    statics: bool,
}

impl StillOptions {
    /// Prepares the scene, works with it, and says of an error where it belongs.
    pub fn with_scene(
        &self,
        program: &CommandLine,
        work: impl FnOnce(Prepared, &dyn Fn(RunError) -> Failure) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let found = self.of.scene(program)?;
        let scene = self.of.only_scenario(&*found)?;
        let x = self.of.design(scene)?;
        let settings = scene.settings();
        let settings = if self.statics { settings.with_method(STATIC_TABLE) } else { settings };
        let method = Prepared::method_of(&settings)?;
        let named = |error| {
            let failure = Failure::from(error);
            let message = failure.message.replace("by the method \"static\"", "by --static, or correct the start");
            self.of.located(scene, Failure { message, ..failure })
        };
        work(Prepared::with(scene, &x, method, settings).map_err(named)?, &named)
    }
}
