//! The functions behind the fuzz targets in `fuzz/`. They are here so that plain tests can replay what fuzzing found.
//!
//! | target | bytes are | must hold |
//! |---|---|---|
//! | [`pairs()`] | two small meshes, tree options, weights and placements | the oracle's pairs; no vertex outside its box |
//! | [`skins()`] | two small meshes moved by joints, tree options, weights and matrices | the oracle's pairs, rays and distances; no vertex outside its box |
//! | [`triangles()`] | two triangles, mostly near-degenerate | the oracle's answer, in any order of corners |
//! | [`layout()`] | a serialised tree | an error, or a tree with correct answers |
//! | [`tree_file()`] | a file of trees | an error, or trees with correct answers |
//! | [`scene()`] | a JSON scene | an error, or a scene that survives writing and reading |
//! | [`gltf()`] | a glTF file | an error, or meshes that can be posed |
//!
//! A function panics if its condition does not hold. Any bytes are a valid case; missing bytes count as zeros.

mod bend;
mod draw;
mod files;
mod graft;
mod layout;
mod one_body;
mod pairs;
mod rig;
mod skins;
mod triangles;

pub use bend::bend;
pub use files::{gltf, scene};
pub use layout::{layout, tree_file};
pub use pairs::pairs;
pub use skins::skins;
pub use triangles::triangles;

/// A target's name and its function.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 7] = [
    ("pairs", pairs),
    ("skins", skins),
    ("triangles", triangles),
    ("layout", layout),
    ("tree_file", tree_file),
    ("scene", scene),
    ("gltf", gltf),
];
