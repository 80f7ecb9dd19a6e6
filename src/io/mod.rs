//! Output: files written whole or not at all, tables; with the feature `cli` also charts, meshes for ParaView, progress bars; with the feature `arrow` tables as files of Apache Arrow.
//!
//! Everything here takes plain numbers, so any result of the other folders can be written.

#[cfg(feature = "arrow")]
mod arrow;
#[cfg(feature = "cli")]
mod chart;
mod file;
#[cfg(feature = "cli")]
mod progress;
mod read;
mod table;
#[cfg(feature = "cli")]
mod vtu;
#[cfg(feature = "cli")]
mod xml;

#[cfg(feature = "arrow")]
pub use arrow::ArrowFile;
#[cfg(feature = "cli")]
pub use chart::{Bars, Chart, Series, Style, write_bars, write_charts};
pub use file::{IoError, write_file};
#[cfg(feature = "cli")]
pub use progress::Progress;
#[cfg(feature = "cli")]
pub(crate) use read::fields;
pub use read::read_csv;
#[cfg(feature = "cli")]
pub(crate) use table::quoted;
pub use table::{Cell, CsvFile, Table, number, write_csv};
#[cfg(feature = "cli")]
pub(crate) use vtu::base64;
#[cfg(feature = "cli")]
pub use vtu::{Attribute, MeshCell, MeshSeries, UnstructuredMesh};
