//! Scripted motion, and a file format for it.
//!
//! - [`dolphins`]: a group of any size swimming closely together, rolling and weaving.
//! - [`pass_through`]: two bodies that pass right through each other.
//! - [`heads`]: two heads cheek to cheek, and a crowd of heads.
//! - [`talk`]: the motion of their faces.
//! - [`flip_books`]: two characters of a flip-book that pass right through each other.
//! - [`Scene`]: models, and their placements and weights frame by frame, as JSON.
//!
//! The motions are pure functions of frame and index. Nothing is simulated, so you can ask for any frame.

pub mod dolphins;
mod error;
mod file;
pub mod flip_books;
pub mod heads;
pub mod pass_through;
pub mod talk;

use glam::{Affine3A, DQuat, DVec3};

pub use error::SceneError;
pub use file::{BodyState, Scene, SceneBody, SceneVersion};

/// A placement from `f64`. Rounding to `f32` once, at the end, hides that `sin` and `cos` differ between platforms.
fn rigid(rotation: DQuat, translation: DVec3) -> Affine3A {
    Affine3A::from_rotation_translation(rotation.as_quat(), translation.as_vec3())
}
