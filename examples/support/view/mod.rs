//! Drawn examples: the GPU blends a model, and the overlay shows what the collision code computed.
//!
//! A [`Show`] is a scene and its description. It is put on a [`stage`] (camera, light, panel), and its [`clock`] runs: in a
//! window, off-screen into pictures (`run`), or on a web [`page`].

pub mod clock;
pub mod files;
pub mod models;
#[cfg(not(target_arch = "wasm32"))]
pub mod offscreen;
pub mod overlay;
pub mod page;
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
#[cfg(not(target_arch = "wasm32"))]
mod window;

use bevy::prelude::*;

#[cfg(not(target_arch = "wasm32"))]
pub use run::{main, run};

/// A drawn example.
pub struct Show {
    /// The base name of its pictures.
    pub name: &'static str,
    /// One sentence that describes it.
    pub about: &'static str,
    /// Its own controls, beside those that all shows share: a key or button, and its effect.
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

impl std::fmt::Debug for Show {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Show").field("name", &self.name).finish_non_exhaustive()
    }
}
