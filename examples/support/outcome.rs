//! What an example prints: its progress, and a report or an error at the end.

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

/// The exit code of a run: 2 after an error, which is written to standard error.
#[must_use]
pub fn exit_code(outcome: Result<(), impl Display>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Prints the result of a run as text, or as one JSON object.
pub fn print_report(report: &(impl Serialize + Display), as_json: bool) {
    // Numbers and plain names can always be written as JSON.
    let text = match as_json {
        true => serde_json::to_string(report).unwrap_or_default(),
        false => report.to_string(),
    };
    print(&format!("{text}\n"));
}

/// Prints text. Ends the program if nobody reads it, as `head` does after a few lines.
pub fn print(text: &str) {
    if io::stdout().lock().write_all(text.as_bytes()).is_err() {
        std::process::exit(0);
    }
}

/// A progress bar for a number of frames, if standard error is a terminal.
#[must_use]
pub fn progress_bar(frames: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("frame {pos}/{len} {wide_bar} {per_sec} {msg}");
    ProgressBar::new(frames).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
