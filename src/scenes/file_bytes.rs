//! What stands in a file.

use std::borrow::Cow;
use std::path::Path;

/// What stands in a file that is read at a time, or was compiled in.
///
/// # Errors
/// A file that cannot be read, or is larger than `what` it is may be \[bytes\].
pub(super) fn file_bytes(path: &Path, what: &str, largest: u64) -> Result<Cow<'static, [u8]>, String> {
    #[cfg(feature = "files")]
    if let Some(own) = super::built_in::bytes_of(path) {
        return Ok(Cow::Borrowed(own));
    }
    let cannot = |why: String| format!("cannot be read: {why}");
    let about = std::fs::metadata(path).map_err(|error| cannot(error.to_string()))?;
    let size = about.len();
    if !about.is_file() {
        return Err(cannot("it is no file".into()));
    }
    if size > largest {
        return Err(cannot(format!("it has {size} bytes, and {what} has at most {largest}")));
    }
    std::fs::read(path).map(Cow::Owned).map_err(|error| cannot(error.to_string()))
}
