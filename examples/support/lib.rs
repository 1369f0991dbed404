//! Shared by the examples and the whole-plugin tests: a headless Bevy app, models in it, and reports. The feature `render`
//! adds the code that draws.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! demos > character, dust, heaving, own, slap > report, view > crowd, instances, physics > app, options > costs, drawn, error, outcome, touching
//! ```
// Systems need many parameters.
#![allow(clippy::type_complexity, clippy::too_many_arguments)]

// Examples are also modules of this library, and name it as they do when they are programs.
extern crate self as morph_collision_workspace;

pub mod app;
pub mod character;
pub mod costs;
pub mod crowd;
#[cfg(feature = "render")]
pub mod demos;
pub mod drawn;
pub mod dust;
pub mod error;
pub mod heaving;
pub mod instances;
pub mod options;
pub mod outcome;
#[cfg(feature = "render")]
pub mod own;
pub mod physics;
pub mod report;
pub mod slap;
pub mod touching;
#[cfg(feature = "render")]
pub mod view;

/// The README's snippets, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

/// The pages' programs, compiled where there are materials to draw with.
#[cfg(all(doctest, feature = "render"))]
mod pages {
    #[doc = include_str!("../../docs/first_program.md")]
    struct FirstProgram;

    #[doc = include_str!("../../docs/coming_from_avian.md")]
    struct ComingFromAvian;

    #[doc = include_str!("../../docs/coming_from_rapier.md")]
    struct ComingFromRapier;
}
