//! Drawn examples: a model is blended by the GPU, and what the collision code believes is drawn on top.
//!
//! A [`Show`] is a scene and what to say about it. It is put on a [`stage`] (camera, light, panel) and its [`clock`] runs: in a window or
//! off-screen into pictures (`run`), or on a web [`page`].

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
