//! Output: files written whole or not at all, tables, charts, pictures of a motion, progress bars.
//!
//! Everything here takes plain numbers, so any result of the other folders can be written. Every chart goes out twice, as
//! `stem.png` and `stem.svg`; its text is drawn with an embedded font, so that pictures look the same on every machine.

mod axis;
mod chart;
mod file;
mod motion;
mod picture;
mod plot;
mod progress;
mod read;
mod table;

pub use chart::{Chart, Series, Style, write_panels};
pub use file::{IoError, write_file, write_json, write_with};
pub use motion::{Frame, Motion, Polyline, Trail, View};
pub use progress::Progress;
pub use read::read_csv;
pub use table::{Cell, CsvFile, Table, number, write_csv};
