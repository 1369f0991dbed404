//! Drawn examples: the GPU blends a model, and the overlay shows what the collision code computed.
//!
//! A [`Demo`] is a scene and its description. It is put on a [`stage`] (camera, light, panel), and its [`clock`] runs: in a
//! window, off-screen into pictures (`run`), or on a web [`page`]. The scene adds the plugins of this project that it needs.

pub mod arms;
pub mod clock;
mod counts;
#[cfg(feature = "render_ui")]
mod diagnostic_panel;
pub mod files;
pub mod group;
pub mod halves;
pub mod marks;
pub mod models;
#[cfg(not(target_arch = "wasm32"))]
pub mod offscreen;
pub mod overlay;
pub mod page;
#[cfg(not(target_arch = "wasm32"))]
mod panel;
#[cfg(not(target_arch = "wasm32"))]
mod pictures;
#[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "on a page there is a hand"))]
pub mod pointer;
#[cfg(not(target_arch = "wasm32"))]
mod run;
pub mod sliders;
pub mod smooth;
pub mod stage;
pub mod types;
pub mod volumes;
#[cfg(not(target_arch = "wasm32"))]
mod window;

use std::process::ExitCode;

use bevy::prelude::*;
use clap::{Args, Command, FromArgMatches};

use crate::options::ViewOptions;
use crate::outcome::exit_code;

#[cfg(not(target_arch = "wasm32"))]
pub use run::run;

/// The main function of an example that has no options of its own.
#[must_use]
pub fn main(demo: Demo) -> ExitCode {
    let command = ViewOptions::augment_args(Command::new(demo.name).about(demo.about));
    match ViewOptions::from_arg_matches(&command.get_matches()) {
        Ok(options) => exit_code(run(demo, &options)),
        Err(error) => error.exit(),
    }
}

/// A web page has no command line; it calls [`page::run`].
#[cfg(target_arch = "wasm32")]
#[allow(clippy::missing_errors_doc)]
pub fn run(_: Demo, _: &ViewOptions) -> Result<(), crate::error::ExampleError> {
    Err(crate::error::ExampleError::NoDisplay)
}

/// A drawn example.
pub struct Demo {
    /// The base name of its pictures.
    pub name: &'static str,
    /// One sentence that describes it.
    pub about: &'static str,
    /// Its own controls, beside those that all demos share: a key or button, and its effect.
    pub keys: &'static [(&'static str, &'static str)],
    /// The camera's position.
    pub eye: Vec3,
    /// The point that the camera looks at.
    pub target: Vec3,
    /// The frames to take pictures of.
    pub pictures: &'static [u32],
    /// Adds the scene. Entities that take time to load are marked [`clock::Pending`].
    pub scene: Box<dyn FnOnce(&mut App) + Send>,
}

impl std::fmt::Debug for Demo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Demo").field("name", &self.name).finish_non_exhaustive()
    }
}
