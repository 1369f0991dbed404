//! Writing to stdout and stderr without ever panicking: either may be a pipe whose reader has left.

use std::fmt::Display;
use std::io::{self, Write};

use serde::Serialize;

use crate::error::CliError;

/// Writes one report to stdout.
pub(crate) fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(CliError::Stdout)
}

/// Writes one JSON object and a line end to stdout.
pub(crate) fn print_json(report: &impl Serialize) -> Result<(), CliError> {
    let mut text = serde_json::to_string_pretty(report).map_err(|error| CliError::Stdout(error.into()))?;
    text.push('\n');
    print(&text)
}

/// Writes a message to stderr under the program's name; if that fails there is nobody left to tell.
pub(crate) fn complain(message: impl Display) {
    let text = message.to_string();
    let _ = writeln!(io::stderr().lock(), "morph-collide: {}", text.trim_end());
}
