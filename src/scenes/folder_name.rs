//! Names of scenes and scenarios, which are those of folders for their results.

/// Most bytes of a name on common file systems.
const MOST_BYTES: usize = 255;
/// Characters that some system takes for a part of a path or refuses.
const OF_PATHS: &str = "/\\:*?\"<>|";
/// Names that belong to devices, with any ending, on Windows.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];
const NUMBERED_DEVICES: [&str; 2] = ["com", "lpt"];
/// What stands beside the folders of scenarios: their comparison.
pub const COMPARISON: [&str; 2] = ["scenarios.json", "scenarios.html"];

/// Checks that each name is one of a folder that lies beside those of the others, wherever results are written.
///
/// # Errors
/// The place of the first name that is none, and why.
pub fn check_folders<'n>(names: impl IntoIterator<Item = &'n str>) -> Result<(), (usize, String)> {
    let mut known: Vec<(&str, String)> = Vec::new();
    for (place, name) in names.into_iter().enumerate() {
        if let Some(why) = refused(name) {
            return Err((place, format!("the name {name:?} is that of a folder for results: {why}")));
        }
        let lower = name.to_lowercase();
        if let Some((other, _)) = known.iter().find(|own| own.1 == lower) {
            let why = match *other == name {
                true => format!("two are named {name:?}, but their results go into folders of their names"),
                false => format!("{other:?} and {name:?} differ in capitals alone, and folders of some systems do not"),
            };
            return Err((place, why));
        }
        known.push((name, lower));
    }
    Ok(())
}

/// The nearest name of a folder to one that people chose for something else.
pub fn folder_name(name: &str) -> String {
    let is_none = |letter: char| letter.is_control() || OF_PATHS.contains(letter);
    let own = name.replace(is_none, "-");
    let own = own.trim_matches(['.', ' ']);
    let end = (0..=own.len().min(MOST_BYTES / 2)).rev().find(|&end| own.is_char_boundary(end)).unwrap_or(0);
    let own = own[..end].trim_end_matches(['.', ' ']);
    if refused(own).is_some() { format!("scene {own}").trim_end().into() } else { own.into() }
}

/// Why a name is no name of a folder.
fn refused(name: &str) -> Option<String> {
    let lower = name.to_lowercase();
    let stem = lower.split('.').next().unwrap_or_default().trim_end();
    let is_numbered = |device: &&str| {
        let number = stem.strip_prefix(*device).unwrap_or_default();
        number.len() == 1 && number.chars().all(|own| own.is_ascii_digit())
    };
    match name {
        _ if name.trim().is_empty() => Some("it is empty".into()),
        _ if name.contains(char::is_control) => Some("it has a control character".into()),
        _ if name.contains(|own| OF_PATHS.contains(own)) => {
            let listed: Vec<String> = OF_PATHS.chars().map(String::from).collect();
            Some(format!("none of {} can be in it", listed.join(" ")))
        }
        _ if name.starts_with('.') || name.ends_with(['.', ' ']) => {
            Some("it cannot begin with a dot, or end with a dot or a blank".into())
        }
        _ if name.len() > MOST_BYTES => Some(format!("it has {} bytes, and at most {MOST_BYTES} are possible", name.len())),
        _ if DEVICES.contains(&stem) || NUMBERED_DEVICES.iter().any(is_numbered) => {
            Some("on some systems it belongs to a device".into())
        }
        _ if COMPARISON.contains(&&*lower) => Some("the comparison of scenarios is written there".into()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_that_of_one_folder_on_every_system_or_refused() {
        let long = "ü".repeat(128);
        for (names, why) in [
            (vec![""], "empty"),
            (vec![" \u{2003}"], "empty"),
            (vec!["hover", "."], "begin with a dot"),
            (vec![".."], "begin with a dot"),
            (vec!["..\\up"], "none of / \\"),
            (vec!["a/b"], "none of / \\"),
            (vec!["C:"], "none of / \\"),
            (vec!["v < 3"], "none of / \\"),
            (vec!["a\nb"], "control character"),
            (vec!["a\u{7f}"], "control character"),
            (vec!["end."], "end with a dot"),
            (vec!["end "], "or a blank"),
            (vec![&long], "256 bytes"),
            (vec!["Con"], "device"),
            (vec!["aux.load"], "device"),
            (vec!["LPT1"], "device"),
            (vec!["Scenarios.HTML"], "comparison"),
            (vec!["a", "b", "a"], "two are named \"a\""),
            (vec!["Über", "über"], "capitals alone"),
        ] {
            let (place, told) = check_folders(names.iter().copied()).expect_err(why);
            assert!(place == names.len() - 1 && told.contains(why), "{names:?}: {told}");
        }
        for name in ["", "../x", "a/b: <c>", "...", "con", "a\u{1}\n", &long.repeat(3)] {
            let own = folder_name(name);
            assert_eq!(check_folders([&*own]), Ok(()), "{name:?}: {own:?}");
        }
        let free =
            ["hover", "30 m s, left", "v1.2", "console", "com", "com10", "über", &long[..254], "a b", "[x]", "'", "&"];
        assert_eq!(check_folders(free), Ok(()));
    }
}
