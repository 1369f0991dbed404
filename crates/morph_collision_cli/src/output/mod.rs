//! Writes results to stdout without ever panicking: it may be a pipe whose reader has left.
//!
//! Names from files are escaped on the way, so no terminal control characters get through.

pub(crate) mod file;

use std::fmt::Write as _;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use morph_collision_models::text::is_printable;
use serde::Serialize;

use crate::error::CliError;
use crate::messages::left_out::{self, LeftOutOfMesh};
use crate::messages::{printable_lines, progress};

/// The version of all JSON that the program writes. From the first release on, it changes if a key changes its meaning or is removed.
const VERSION: u32 = 1;

/// Whether a file is written to stdout, so that reports have to go to stderr.
static STDOUT_IS_TAKEN: AtomicBool = AtomicBool::new(false);

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

/// A field of a CSV file, in quotes if it needs them.
pub(crate) fn csv_field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
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

#[cfg(test)]
mod tests {
    use super::*;

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
