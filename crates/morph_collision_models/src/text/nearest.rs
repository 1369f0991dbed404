//! Names that a misspelt one may stand for.

use super::printable::Printable;

/// Longer names are not compared.
const LONGEST: usize = 100;
/// Further names are not compared.
const MOST: usize = 10_000;
/// The number of names that are suggested.
const SHOWN: usize = 3;

/// The end of a message about an unknown name: the known names that are most like it; empty if none is.
///
/// Names are alike if few letters differ, whatever their case, or if one contains the other.
///
/// ```
/// use morph_collision_models::text::suggestion;
///
/// let known = ["jawOpen", "jawLeft", "mouthSmile_L"];
/// assert_eq!(suggestion("jawOpn", known), "; did you mean \"jawOpen\"?");
/// assert_eq!(suggestion("smile", known), "; did you mean \"mouthSmile_L\"?");
/// assert_eq!(suggestion("tail", known), "");
/// ```
#[must_use]
pub fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    if name.is_empty() || name.len() > LONGEST {
        return String::new();
    }
    let wanted = name.to_lowercase();
    let distance = |known: &str| {
        let lower = known.to_lowercase();
        let most = (wanted.chars().count().max(lower.chars().count()) / 3).max(1);
        let edits = strsim::damerau_levenshtein(&wanted, &lower);
        match edits <= most {
            true => Some(edits),
            // Behind all names that are alike letter by letter.
            false if wanted.len() > 2 && (lower.contains(&wanted) || wanted.contains(&lower)) && lower.len() > 2 => {
                Some(LONGEST + edits)
            }
            false => None,
        }
    };
    let short = known
        .into_iter()
        .take(MOST)
        .filter(|known| (1..=LONGEST).contains(&known.len()));
    let mut alike: Vec<(usize, &str)> = short.filter_map(|known| Some((distance(known)?, known))).collect();
    // Names at the same distance stay in order.
    alike.sort_by_key(|&(distance, _)| distance);
    alike.dedup_by_key(|&mut (_, name)| name);
    let shown: Vec<String> = alike
        .iter()
        .take(SHOWN)
        .map(|(_, known)| format!("\"{}\"", Printable(known)))
        .collect();
    match shown.as_slice() {
        [] => String::new(),
        [only] => format!("; did you mean {only}?"),
        [first @ .., last] => format!("; did you mean {} or {last}?", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_come_first_and_are_safe_to_print() {
        let known = ["browDownLeft", "browDownRight", "browInnerUp", "jawOpen"];
        assert_eq!(
            suggestion("browDownLefft", known),
            "; did you mean \"browDownLeft\" or \"browDownRight\"?"
        );
        assert_eq!(suggestion("JAWOPEN", known), "; did you mean \"jawOpen\"?");
        assert_eq!(suggestion("a\u{1b}c", ["a\u{1b}b"]), "; did you mean \"a\\u{1b}b\"?");
        assert_eq!(suggestion("", known), "");
        assert_eq!(suggestion(&"x".repeat(101), [&*"x".repeat(100)]), "");
    }
}
