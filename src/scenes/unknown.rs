//! Unknown names: what was meant, and what there is.

/// Most names that are listed: design variables of faces are thousands.
const MOST_SHOWN: usize = 100;

/// Says that `given` is no known `kind`, with the nearest name and the list of all.
pub fn unknown(kind: &str, given: &str, known: &[String]) -> String {
    let nearest = nearest(given, known).map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"));
    let shown = known.iter().take(MOST_SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    let list = match known.len().checked_sub(MOST_SHOWN) {
        _ if known.is_empty() => "there is none".into(),
        Some(more) if more > 0 => format!("known: {shown} and {more} more"),
        _ => format!("known: {shown}"),
    };
    if let Some(instead) = instead(given, known) {
        return format!("{kind} \"{given}\" is not known any more: {instead}; {list}");
    }
    let separator = if nearest.is_empty() { ";" } else { "" };
    format!("{kind} \"{given}\" is not known{nearest}{separator} {list}")
}

/// What serves instead of a word of earlier states of the program, given those known in its place.
fn instead(given: &str, known: &[String]) -> Option<&'static str> {
    let is_among = |word: &str| known.iter().any(|own| own == word);
    match given {
        "velocity" if is_among("position") && is_among("acceleration") => {
            Some("\"acceleration\" has the full order of every method, for less work")
        }
        _ => None,
    }
}

/// The known name with the fewest changed letters, if they are few.
fn nearest<'n>(given: &str, known: &'n [String]) -> Option<&'n str> {
    let limit = given.chars().count().max(3) / 3 + 1;
    let measured = known.iter().map(|name| (changes(&given.to_lowercase(), &name.to_lowercase()), name));
    measured.min_by_key(|(changes, _)| *changes).filter(|(changes, _)| *changes <= limit).map(|(_, name)| name.as_str())
}

/// Letters to insert, remove, replace or swap with their neighbour to turn one word into the other.
fn changes(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let above = &rows[i - 1];
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_suggested_only_if_it_is_near() {
        let known: Vec<String> = ["pendulum", "five-bar"].map(String::from).to_vec();
        assert!(unknown("scene", "five-bra", &known).contains("did you mean \"five-bar\"? known: pendulum, five-bar"));
        assert!(unknown("scene", "fivebar", &known).contains("\"five-bar\"?"));
        let far = unknown("scene", "crane", &known);
        assert_eq!(far, "scene \"crane\" is not known; known: pendulum, five-bar");
        assert_eq!(unknown("study", "x", &[]), "study \"x\" is not known; there is none");
        let many: Vec<String> = (0..103).map(|number| format!("face[{number}]")).collect();
        assert!(unknown("variable", "thickness", &many).ends_with(", face[98], face[99] and 3 more"));
    }
}
