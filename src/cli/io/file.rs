//! Files appear under their name only when they are complete.

use costate::exchange::is_first;
use costate::history::check_place;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::{fmt, fs};

/// A file that could not be written: which one, and why.
#[derive(Debug)]
pub struct IoError {
    /// The file or folder as the caller named it.
    pub path: PathBuf,
    /// What went wrong, and with which values.
    pub cause: String,
}

impl IoError {
    pub(crate) fn new(path: &Path, cause: impl fmt::Display) -> Self {
        Self { path: path.to_path_buf(), cause: cause.to_string() }
    }
}

impl fmt::Display for IoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot write {}: {}", self.path.display(), self.cause)
    }
}

impl std::error::Error for IoError {}

/// Writes `contents` to `path`, creating missing folders; the file appears whole or not at all.
///
/// # Errors
/// A folder that cannot be created, or a file that cannot be written or renamed.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), IoError> {
    let aside = Aside::beside(path)?;
    fs::write(&aside.part, contents).map_err(|cause| IoError::new(path, cause))?;
    aside.publish()
}

/// The same of a JSON object, in lines that people can read.
///
/// # Errors
/// As [`write_file`].
pub fn write_json(path: &Path, object: &Value) -> Result<(), IoError> {
    write_file(path, format!("{object:#}\n").as_bytes())
}

/// Takes what is written, and keeps nothing.
const NOWHERE: &str = if cfg!(windows) { "NUL" } else { "/dev/null" };

/// A temporary file in the folder of its target; removed unless it is published.
pub(crate) struct Aside {
    target: PathBuf,
    /// Where to write; keeps the extension of the target.
    pub(crate) part: PathBuf,
}

impl Aside {
    pub(crate) fn beside(target: &Path) -> Result<Self, IoError> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let Some(name) = target.file_name() else {
            return Err(IoError::new(target, "the path does not end in a file name"));
        };
        if !is_first() {
            // another rank has the same numbers, and writes the file
            return Ok(Self { target: target.to_path_buf(), part: NOWHERE.into() });
        }
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let part = format!(".part-{}-{count}-{}", std::process::id(), name.to_string_lossy());
        if target.is_dir() {
            return Err(IoError::new(target, "a folder of this name exists"));
        }
        check_place(target).map_err(|cause| IoError::new(target, cause))?;
        let folder = target.parent().unwrap_or(Path::new(""));
        fs::create_dir_all(folder)
            .map_err(|cause| IoError::new(target, format!("cannot create the folder {}: {cause}", folder.display())))?;
        Ok(Self { target: target.to_path_buf(), part: folder.join(part) })
    }

    /// The same under the name `NAME.unfinished.EXTENSION`, which stays if the program is killed.
    pub(crate) fn unfinished(target: &Path) -> Result<Self, IoError> {
        let aside = Self::beside(target)?;
        if !is_first() {
            return Ok(aside);
        }
        let ending = target.extension().map_or("unfinished".into(), |old| format!("unfinished.{}", old.to_string_lossy()));
        Ok(Self { part: target.with_extension(ending), target: aside.target.clone() })
    }

    pub(crate) fn publish(self) -> Result<(), IoError> {
        if !is_first() {
            return Ok(());
        }
        fs::rename(&self.part, &self.target).map_err(|cause| IoError::new(&self.target, cause))
    }
}

impl Drop for Aside {
    fn drop(&mut self) {
        // after a rename there is nothing left under this name
        if is_first() {
            let _ = fs::remove_file(&self.part);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An empty folder of its own for one test, removed when dropped.
    pub(crate) struct Folder(pub(crate) PathBuf);

    impl Folder {
        pub(crate) fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("costate-io-{}-{name}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            fs::create_dir_all(&path).unwrap();
            Self(path)
        }

        pub(crate) fn names(&self) -> Vec<String> {
            let mut names: Vec<_> =
                fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn an_error_names_the_path_and_the_cause() {
        let folder = Folder::new("blocked");
        write_file(&folder.0.join("block"), b"a file where a folder is needed").unwrap();
        let error = write_file(&folder.0.join("block/x.txt"), b"").unwrap_err().to_string();
        assert!(error.contains("block/x.txt") && error.contains("cannot create the folder"), "{error}");
        let error = write_file(&folder.0, b"").unwrap_err().to_string();
        assert!(error.contains("blocked") && error.contains("a folder of this name exists"), "{error}");
        assert!(write_file(Path::new("/"), b"").unwrap_err().to_string().contains("file name"));
        assert_eq!(folder.names(), ["block"]);
    }
}
