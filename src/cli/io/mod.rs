//! Output: files written whole or not at all, tables, charts, meshes for ParaView, progress bars; with the feature `arrow` tables as files of Apache Arrow.
//!
//! Everything here takes plain numbers, so any result of the other folders can be written.

#[cfg(feature = "arrow")]
mod arrow;
mod chart;
mod file;
mod progress;
mod read;
mod table;
mod vtu;
mod xml;

#[cfg(feature = "arrow")]
pub use arrow::ArrowFile;
pub use chart::{Bars, Chart, Series, Style, write_bars, write_charts};
#[cfg(test)]
pub(crate) use file::tests::Folder;
pub use file::{IoError, write_file, write_json};
pub use progress::Progress;
pub(crate) use read::fields;
pub use read::read_csv;
pub use table::{Cell, CsvFile, Table, long_number, number, write_csv};
pub(crate) use table::{cells, quoted};
pub(crate) use vtu::base64;
pub use vtu::{Attribute, MeshCell, MeshSeries, UnstructuredMesh};
