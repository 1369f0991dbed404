//! What the program says on stderr beside its results: errors, warnings, and progress. It never panics: stderr may be a pipe whose reader
//! has left.
//!
//! Names from files are escaped on the way, so no terminal control characters get through.

pub(crate) mod left_out;
pub(crate) mod progress;

use std::fmt::{Display, Write as _};
use std::io::{self, Write};
use std::path::Path;
use std::sync::OnceLock;

use morph_collision_models::left_out::LeftOut;
use morph_collision_models::text::{Grouped, Printable};

use left_out::LeftOutOfMesh;

/// The name of the program, for messages.
static PROGRAM: OnceLock<String> = OnceLock::new();

/// Names the program before the first message.
pub(crate) fn set_program(name: &str) {
    PROGRAM.get_or_init(|| name.to_owned());
}

fn program() -> &'static str {
    PROGRAM.get().map_or("morph-collide", String::as_str)
}

/// Writes a one-line message to stderr after the program's name, or passes it to the listener. Failures are ignored because there is nobody
/// left to tell.
pub fn complain(message: impl Display) {
    progress::clear();
    let text = message.to_string();
    let text = Printable(text.trim_end()).to_string();
    if !progress::warn_listener(&text) {
        let _ = writeln!(io::stderr().lock(), "{}: {text}", program());
    }
}

/// Like [`complain`], for a message of several lines.
pub(crate) fn complain_at_length(message: impl Display) {
    let text = message.to_string();
    let _ = write!(
        io::stderr().lock(),
        "{}: {}",
        program(),
        printable_lines(text.trim_end())
    );
}

/// A number with its noun: `1 body`, `1,234 bodies`.
#[must_use]
pub fn counted(number: usize, one: &str, many: &str) -> String {
    format!("{} {}", Grouped(number as u64), if number == 1 { one } else { many })
}

/// At most this many names are listed in a message.
const MOST_NAMES: usize = 12;

/// Names in quotes: the first ones, and how many there are.
pub(crate) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let quoted = |name: &S| format!("\"{}\"", Printable(name.as_ref()));
    let shown: Vec<String> = names.iter().take(MOST_NAMES).map(quoted).collect();
    match names.len() {
        count if count > MOST_NAMES => format!("{}, ... ({count} in all)", shown.join(", ")),
        _ => shown.join(", "),
    }
}

/// Escapes every line and ends it with a line break.
pub(crate) fn printable_lines(text: &str) -> String {
    let mut lines = String::with_capacity(text.len());
    for line in text.lines() {
        // Writing to a string cannot fail.
        let _ = writeln!(lines, "{}", Printable(line));
    }
    lines
}

/// Says what was left out of a mesh, once.
pub(crate) fn warn_left_out(file: &Path, mesh: usize, name: &str, left_out: LeftOut) {
    let found = LeftOutOfMesh {
        file: file.display().to_string(),
        mesh,
        name: name.to_owned(),
        left_out,
    };
    if left_out::add(&found) {
        complain(format_args!(
            "warning: {}: mesh {mesh} \"{}\": {}",
            found.file,
            Printable(&found.name),
            found.left_out
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = (0..14).map(|index| index.to_string()).collect();
        assert_eq!(listed(&names[..2]), "\"0\", \"1\"");
        assert!(listed(&names).ends_with("\"11\", ... (14 in all)"));
    }
}
