//! Drawn examples: a model is blended by the GPU, and what the collision code believes is drawn on top.
//!
//! A [`Show`] is a scene and what to say about it. [`run`] puts it on a [`stage`] (camera, light, panel) and lets its [`clock`] run: in a
//! window, or [off-screen](offscreen) into pictures.

pub mod clock;
pub mod models;
pub mod offscreen;
pub mod overlay;
mod panel;
mod pictures;
pub mod pointer;
pub mod sliders;
pub mod stage;
mod window;

use std::process::ExitCode;

use bevy::prelude::*;

use crate::error::ExampleError;
use crate::options::ViewOptions;

/// A drawn example.
pub struct Show {
    /// What its pictures are called.
    pub name: &'static str,
    /// One sentence about what is to be seen.
    pub about: &'static str,
    /// What it listens to beside what all do: a key or button, and what that does.
    pub keys: &'static [(&'static str, &'static str)],
    /// Where the camera stands.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// The frames of which there are pictures.
    pub pictures: &'static [u32],
    /// Adds the scene. What takes time to load is marked [`clock::Pending`].
    pub scene: Box<dyn FnOnce(&mut App) + Send>,
}

impl std::fmt::Debug for Show {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Show").field("name", &self.name).finish_non_exhaustive()
    }
}

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
