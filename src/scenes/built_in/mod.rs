//! The scenes of the command line. A new one is a file here and a line in [`all`].

mod five_bar;
mod pendulum;

pub use five_bar::FiveBar;
pub use pendulum::Pendulum;

use super::AnyScene;

/// All built-in scenes.
pub fn all() -> Vec<Box<dyn AnyScene>> {
    vec![Box::new(Pendulum), Box::new(FiveBar)]
}
