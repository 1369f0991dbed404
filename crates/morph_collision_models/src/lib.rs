//! Models for `morph_collision`: read and written as glTF, posed by clips, placed in scenes, inspected and generated.
//!
//! The command-line tool `morph-collide` and the examples are built on it. **Its API may change in any release**, including patch releases:
//! name an exact version if you depend on it. To detect collisions, use `morph_collision` or `bevy_morph_collision`.
//!
//! From a file to a tree:
//!
//! 1. [`gltf::read`] opens a file, of any origin, within a limit of [`memory`], and reads its meshes, skins and clips.
//! 2. [`mesh`] holds a mesh with its targets and its skin, joins several, and makes a `morph_collision::MorphModel` of it. [`left_out`] takes
//!    away what is broken.
//! 3. [`clip`] and [`skeleton`] give weights and joint matrices at a time; [`weight_list`] reads weights as a person types them.
//! 4. [`scenes`] places bodies and poses them frame by frame: scripted motion, and the JSON format of scene files.
//! 5. [`inspect`] reports what a file contains and what tree each mesh gets, in the words of [`text`].
//! 6. [`gltf::write`] writes a mesh.
//!
//! [`generated`] has meshes that need no file: dolphins, boxes, random and degenerate meshes, skinned tubes.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! inspect, scenes > left_out > gltf, generated, weight_list > mesh > skeleton > clip, memory, text
//! ```
#![forbid(unsafe_code)]

pub mod clip;
pub mod generated;
pub mod gltf;
pub mod inspect;
pub mod left_out;
pub mod memory;
pub mod mesh;
pub mod scenes;
pub mod skeleton;
pub mod text;
pub mod weight_list;

/// The README's snippet, run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
