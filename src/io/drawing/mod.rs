//! Charts and pictures of a motion.
//!
//! Every chart goes out twice, as `stem.png` and `stem.svg`; its text is drawn with an embedded font, so that pictures look the same on
//! every machine.

mod axis;
mod bars;
mod chart;
mod motion;
mod picture;
mod plot;

pub use bars::{Bars, write_bars};
pub use chart::{Chart, Series, Style, write_panels};
pub use motion::{ColouredSurface, Facet, Frame, MotionPicture, Polyline, Role, Trail, View};
