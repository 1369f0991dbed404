//! A show as a program: in a window, or into pictures.

use std::process::ExitCode;

use super::{Show, pictures, window};
use crate::error::ExampleError;
use crate::options::ViewOptions;

/// What an example does that is nothing but a show.
#[must_use]
pub fn main(show: Show, options: &ViewOptions) -> ExitCode {
    match run(show, options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Shows it as asked for.
///
/// # Errors
/// There is no display for a window, no driver to draw with, a model cannot be loaded, or a picture cannot be written.
pub fn run(show: Show, options: &ViewOptions) -> Result<(), ExampleError> {
    match &options.screenshots {
        Some(folder) => pictures::write(show, options, folder),
        None => window::run(show, options),
    }
}
