//! The laboratory of `morph_collision`: the oracle, the rival methods, the benchmarks and the fuzzing behind its tests and reports.
//!
//! Its models are those of `morph_collision_models`.
//!
//! - [`assets`]: the models and scenes in the repository's `assets/`.
//!
//! # Correctness
//!
//! - [`oracle`]: brute force in exact arithmetic. It uses nothing of `morph_collision`.
//! - [`motion`]: when moving points and triangles, and moving segments, first touch, as exact numbers; random and recorded motions.
//! - [`moments`]: bodies at one moment, ordinary and odd, on which every method has to agree.
//! - [`extremes`]: motions that collapse bodies, blow them up or turn them inside out.
//! - [`verify`]: compares the answers of trees with brute force in random situations, and checks their boxes against vertices.
//! - [`stress`]: the same with generated, difficult meshes, and with bad input.
//! - [`fuzzing`]: the functions that the fuzz targets call.
//! - [`near_degenerate`]: pairs of triangles that rounded arithmetic gets wrong.
//! - [`search`]: hill climbing that looks for the largest rounding error.
//! - [`determinism`]: hashes of answers, which must be the same on every machine.
//!
//! # Speed
//!
//! - [`rivals`]: the other methods that `morph_collision` is compared with, among them Parry's.
//! - [`mod@bench`]: times all methods against each other.
//! - [`machine`]: the processor, and one core of it for a thread.
//! - [`tightness`]: how much larger the boxes of a posed tree are than the smallest ones.
//!
//! # Features
//!
//! - `lab` (on by default): the program `morph-lab`, which has all of this as commands, and writes the repository's pages of measurements.
//! - `report`: the module `report`, which draws their tables and plots.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! bench, determinism, fuzzing, stress > moments, tightness, verify > motion, rivals
//! > assets, extremes, near_degenerate, oracle, report, search > machine
//! ```
#![forbid(unsafe_code)]

pub mod assets;
pub mod bench;
pub mod determinism;
pub mod extremes;
pub mod fuzzing;
pub mod machine;
pub mod moments;
pub mod motion;
pub mod near_degenerate;
pub mod oracle;
#[cfg(feature = "report")]
pub mod report;
pub mod rivals;
pub mod search;
pub mod stress;
pub mod tightness;
pub mod verify;

/// The README's snippet, run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
