//! Tests that every engine passes. The tests of an engine's crate include this folder, and have a module `support` with its app and
//! its components.

mod bullets;
pub(crate) mod common;
mod events;
mod life;
mod mistakes;
pub(crate) mod moving;
mod presence;
pub(crate) mod scene;
pub(crate) mod schedules;
mod sleep;
pub(crate) mod solid;
mod units;
