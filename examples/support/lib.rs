//! What the examples and the whole-plugin tests share: a Bevy app without a window, models in it, and reports.

pub mod app;
mod displacements;
pub mod error;
pub mod instances;
pub mod physics;
pub mod report;
pub mod touching;

/// The README's snippets, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
