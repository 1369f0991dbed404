//! Scripted motion, and the file it can be kept in.
//!
//! - [`dolphins`]: a group of any size swimming closely together, rolling and weaving.
//! - [`pass_through`]: two bodies that go right through each other.
//! - [`heads`]: two heads cheek to cheek, and a crowd of them; [`talk`]: what their faces do meanwhile.
//! - [`flip_books`]: two characters of a flip-book that go right through each other.
//! - [`Scene`]: models, and where they are with which weights, frame by frame, as JSON.
//!
//! The motions are pure functions of frame and index: nothing is simulated, so any frame can be asked for by itself.

pub mod dolphins;
mod error;
mod file;
pub mod flip_books;
pub mod heads;
pub mod pass_through;
pub mod talk;

use glam::{Affine3A, DQuat, DVec3};

pub use error::SceneError;
pub use file::{BodyState, Scene, SceneBody};

/// A placement from `f64`: rounding to `f32` once, at the end, hides that `sin` and `cos` differ between platforms.
fn rigid(rotation: DQuat, translation: DVec3) -> Affine3A {
    Affine3A::from_rotation_translation(rotation.as_quat(), translation.as_vec3())
}
