//! Scripted motion, and a file format for it.
//!
//! - [`dolphins`]: a group of any size swimming closely together, rolling and weaving.
//! - [`pass_through`]: two bodies that pass right through each other.
//! - [`Scene`]: models, and their placements and weights frame by frame, as JSON.
//!
//! The motions are pure functions of frame and index. Nothing is simulated, so you can ask for any frame.

mod body_state;
pub mod dolphins;
mod error;
mod json;
pub mod pass_through;
mod scene;

use glam::{Affine3A, DQuat, DVec3};

pub use body_state::BodyState;
pub use error::SceneError;
pub use scene::{Scene, SceneBody, SceneVersion};

/// A placement of a body that keeps its shape. Rounding to `f32` once, at the end, hides that `sin` and `cos` differ between platforms.
pub fn rigid(rotation: DQuat, translation: DVec3) -> Affine3A {
    Affine3A::from_rotation_translation(rotation.as_quat(), translation.as_vec3())
}
