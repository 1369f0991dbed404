//! Text from files, made safe for a terminal and for a log with one line per message.

use std::fmt::{self, Display, Formatter, Write};

/// Shows text with everything escaped that a terminal would interpret rather than print: control characters, escape sequences,
/// line ends, marks that reorder the text around them, and other invisible characters.
///
/// Letters, marks and signs of every script stay as they are, and so do quotes and backslashes.
///
/// ```
/// use morph_collision_models::text::Printable;
///
/// assert_eq!(Printable("caf\u{e9} \"1\"").to_string(), "caf\u{e9} \"1\"");
/// assert_eq!(Printable("\u{1b}[31mred\u{202e}\n").to_string(), r"\u{1b}[31mred\u{202e}\n");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Printable<'a>(pub &'a str);

impl Display for Printable<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for piece in self.0.split_inclusive(['"', '\'', '\\']) {
            let quote = piece
                .char_indices()
                .next_back()
                .filter(|(_, c)| matches!(c, '"' | '\'' | '\\'));
            let text = quote.map_or(piece, |(at, _)| &piece[..at]);
            write!(f, "{}", text.escape_debug())?;
            if let Some((_, quote)) = quote {
                f.write_char(quote)?;
            }
        }
        Ok(())
    }
}

/// Whether [`Printable`] shows a character as it is.
#[must_use]
pub fn is_printable(c: char) -> bool {
    matches!(c, '"' | '\'' | '\\') || {
        // Combining marks are escaped only if no character comes before them.
        let text = ['x', c].iter().collect::<String>();
        text.escape_debug().count() == 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_a_terminal_obeys_gets_through() {
        let bad = "\0\x07\x08\r\n\t\x1b\x7f\u{80}\u{9b}\u{ad}\u{61c}\u{200b}\u{200e}\u{200f}\u{2028}\u{2029}\u{202a}\u{202e}\u{2066}\u{2069}\u{feff}\u{e0041}";
        for c in bad.chars() {
            assert!(!is_printable(c), "{c:?}");
            let shown = Printable(&format!("a{c}b")).to_string();
            assert!(shown.starts_with("a\\") && !shown.contains(c), "{shown:?}");
        }
    }

    #[test]
    fn names_of_every_script_stay_readable() {
        for name in ["Kopf_01", "tête", "te\u{302}te", "頭", "हिन्दी", "C:\\a 'b' \"c\"", ""] {
            assert_eq!(Printable(name).to_string(), name);
            assert!(name.chars().all(is_printable), "{name}");
        }
    }
}
