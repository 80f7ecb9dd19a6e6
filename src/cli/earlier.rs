//! Tables of designs that an earlier run has left.

use super::console::print;
use super::failure::Failure;
use costate::exchange::is_first;
use std::path::Path;

/// The table of an earlier run of the same command in the same folder keeps its rows, under the first number that is free.
/// Only a file is moved.
pub fn keep_earlier(path: &Path) -> Result<(), Failure> {
    if !is_first() {
        return Ok(());
    }
    let cannot = |cause: std::io::Error| Failure::run(format!("cannot keep the earlier {}: {cause}", path.display()));
    match std::fs::metadata(path) {
        Ok(own) if own.is_file() => {}
        Ok(_) => {
            return Err(Failure::input(format!(
                "{} is no file; the table of this command is written there",
                path.display()
            )));
        }
        Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(cause) => return Err(cannot(cause)),
    }
    let mut kept = (1..).map(|number: u32| path.with_extension(format!("{number}.csv")));
    // what a link leads to may be elsewhere, or nowhere: its name is taken
    let Some(kept) =
        kept.find(|kept| kept.symlink_metadata().is_err_and(|cause| cause.kind() == std::io::ErrorKind::NotFound))
    else {
        return Ok(());
    };
    std::fs::rename(path, &kept).map_err(cannot)?;
    print(format_args!("kept the earlier table as {}", kept.display()));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_earlier_table_is_kept_or_its_error_is_told() {
        let folder = std::env::temp_dir().join(format!("costate-earlier-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let (path, first, second) = (folder.join("designs.csv"), folder.join("designs.1.csv"), folder.join("designs.2.csv"));
        keep_earlier(&path).expect("nothing is there");
        std::fs::write(&path, "points").expect("written");
        // the name of a link that leads nowhere is taken
        #[cfg(unix)]
        std::os::unix::fs::symlink(folder.join("nowhere"), &first).expect("a link");
        #[cfg(not(unix))]
        std::fs::write(&first, "").expect("written");
        keep_earlier(&path).expect("is kept");
        assert!(!path.exists() && first.symlink_metadata().is_ok());
        assert_eq!(std::fs::read_to_string(&second).expect("kept"), "points");
        // what is no file is left where it is
        std::fs::create_dir(&path).expect("a folder");
        let failure = keep_earlier(&path).expect_err("is no file");
        assert!(failure.code == 2 && failure.message.contains("is no file"), "{failure:?}");
        assert!(path.is_dir());
        // and so is what cannot be looked at
        let failure = keep_earlier(&second.join("designs.csv")).expect_err("its folder is a file");
        assert!(failure.code == 1 && failure.message.contains("cannot keep the earlier"), "{failure:?}");
        let _ = std::fs::remove_dir_all(&folder);
    }
}
