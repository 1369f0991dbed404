//! Tests that every engine passes. The tests of an engine's crate include this folder, and have a module `support` with its app.

mod bullets;
mod mistakes;
pub(crate) mod scene;
pub(crate) mod schedules;
mod units;
