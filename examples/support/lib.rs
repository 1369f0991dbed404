//! What the examples and the whole-plugin tests share: a Bevy app without a window, models in it, and reports; and, with the
//! feature `render`, what draws them.
// Systems say in their parameters what they ask for.
#![allow(clippy::type_complexity, clippy::too_many_arguments)]

pub mod app;
pub mod character;
pub mod crowd;
pub mod drawn;
pub mod error;
pub mod heaving;
pub mod instances;
pub mod options;
pub mod physics;
pub mod report;
#[cfg(feature = "render")]
pub mod shows;
pub mod tables;
pub mod touching;
#[cfg(feature = "render")]
pub mod view;

/// The README's snippets, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
