//! Writes to stdout and stderr without ever panicking: either may be a pipe whose reader has left.
//!
//! Names from files are escaped on the way, so no terminal control characters get through.

use std::fmt::{Display, Write as _};
use std::io::{self, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use morph_collision_models::left_out::LeftOut;
use morph_collision_models::text::Grouped;
use morph_collision_models::text::{Printable, is_printable};
use serde::Serialize;

use crate::error::CliError;
use crate::left_out::{self, LeftOutOfMesh};
use crate::progress;

/// The version of all JSON that the program writes. From the first release on, it changes if a key changes its meaning or is removed.
const VERSION: u32 = 1;

/// Whether a file is written to stdout, so that reports have to go to stderr.
static STDOUT_IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// The name of the program, for messages.
static PROGRAM: OnceLock<String> = OnceLock::new();

/// Names the program before the first message.
pub(crate) fn set_program(name: &str) {
    PROGRAM.get_or_init(|| name.to_owned());
}

fn program() -> &'static str {
    PROGRAM.get().map_or("morph-collide", String::as_str)
}

/// A report with the version of its format.
#[derive(Serialize)]
struct Versioned<'a, T> {
    version: u32,
    #[serde(flatten)]
    report: &'a T,
    /// What `--skip-bad` left out of meshes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<LeftOutOfMesh>,
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

/// Leaves stdout to an output file. Reports go to stderr from now on.
pub(crate) fn leave_stdout_to_a_file() {
    STDOUT_IS_TAKEN.store(true, Ordering::Relaxed);
}

/// Writes one report to stdout. Line breaks are kept; all other unprintable characters are escaped.
///
/// # Errors
/// [`CliError::Stdout`].
pub fn print(text: &str) -> Result<(), CliError> {
    write(&printable_lines(text))
}

/// Writes one JSON object and a line end to stdout.
///
/// # Errors
/// [`CliError::Stdout`].
pub fn print_json(report: &impl Serialize) -> Result<(), CliError> {
    let report = Versioned {
        version: VERSION,
        report,
        left_out: left_out::all(),
    };
    let text = serde_json::to_string_pretty(&report).map_err(|error| CliError::Stdout(error.into()))?;
    write(&printable_json(&text))
}

/// Writes text that is safe to print, such as a script or a page.
pub(crate) fn write(text: &str) -> Result<(), CliError> {
    progress::end();
    if STDOUT_IS_TAKEN.load(Ordering::Relaxed) {
        let _ = io::stderr().lock().write_all(text.as_bytes());
        return Ok(());
    }
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(CliError::Stdout)
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

/// A field of a CSV file, in quotes if it needs them.
pub(crate) fn csv_field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Escapes every line and ends it with a line break.
fn printable_lines(text: &str) -> String {
    let mut lines = String::with_capacity(text.len());
    for line in text.lines() {
        // Writing to a string cannot fail.
        let _ = writeln!(lines, "{}", Printable(line));
    }
    lines
}

/// JSON with unprintable characters as `\u` escapes (they only occur in strings), and a line end.
pub(crate) fn printable_json(json: &str) -> String {
    let mut text = String::with_capacity(json.len() + 1);
    for c in json.chars() {
        if c == '\n' || is_printable(c) {
            text.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                let _ = write!(text, "\\u{unit:04x}");
            }
        }
    }
    text.push('\n');
    text
}

/// Says what was left out of a mesh, once.
pub(crate) fn tell_left_out(file: &Path, mesh: usize, name: &str, left_out: LeftOut) {
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

    #[test]
    fn fields_are_quoted_if_they_have_to_be() {
        assert_eq!(csv_field("jawOpen"), "jawOpen");
        assert_eq!(csv_field("a, \"b\""), "\"a, \"\"b\"\"\"");
    }

    #[test]
    fn json_stays_the_same_and_shows_no_invisible_characters() -> Result<(), serde_json::Error> {
        let names = ["tête", "a\u{9b}31m", "b\u{202e}c", "\u{e0041}", "\x7f\x1b\n\"\\"];
        let json = printable_json(&serde_json::to_string_pretty(&names)?);
        assert!(json.chars().all(|c| c == '\n' || is_printable(c)), "{json:?}");
        let back: Vec<String> = serde_json::from_str(&json)?;
        assert_eq!(back, names);
        Ok(())
    }
}
