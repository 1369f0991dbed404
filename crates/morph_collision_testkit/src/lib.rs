//! The library behind the tests, benchmarks, examples and the command-line tool of `morph_collision`.
//!
//! It is published because `morph_collision_cli` depends on it. **Its API may change in any release**, including patch releases: name
//! an exact version if you depend on it. To detect collisions, use `morph_collision` or `bevy_morph_collision` instead.
//!
//! # Models
//!
//! - [`mesh`], [`clip`]: a triangle mesh with morph targets and weight animations, as stored in a file.
//! - [`skin`], [`skeleton`]: the joints that move a mesh, and their clips.
//! - [`joined`], [`together`], [`unweighted`]: several meshes as one, and meshes without the vertices that no joint moves.
//! - [`models`]: generated meshes: a dolphin, the body of the pass-through scene, random, degenerate and rigid meshes.
//! - [`gltf_read`], [`gltf_write`]: read such meshes from glTF 2.0 files and write them.
//! - [`weight_list`], [`nearest`]: weights as a person types them, and suggestions for misspelt names.
//! - [`memory`]: limits the memory that reading a file may take.
//! - [`inspect`]: reports what the meshes of a file contain.
//! - [`scenes`]: scripted motion of the models, and the JSON scene format.
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
//! - [`tightness`]: how much larger the boxes of a posed tree are than the smallest ones.
//!
//! # Output
//!
//! - [`printable`]: makes names from files safe to print.
//! - [`numbers`]: JSON numbers that may not be finite.
//!
//! # Features
//!
//! - `report` (off by default): the module `report`, and the program `report`, which writes the repository's pages of measurements.
#![forbid(unsafe_code)]

pub mod assets;
pub mod bench;
pub mod clip;
pub mod determinism;
pub mod extremes;
pub mod fuzzing;
pub mod gltf_read;
pub mod gltf_write;
pub mod inspect;
pub mod joined;
pub mod left_out;
pub mod memory;
pub mod mesh;
pub mod models;
pub mod moments;
pub mod motion;
pub mod near_degenerate;
pub mod nearest;
pub mod numbers;
pub mod oracle;
pub mod printable;
#[cfg(feature = "report")]
pub mod report;
pub mod rivals;
pub mod scenes;
pub mod search;
pub mod skeleton;
pub mod skin;
pub mod stress;
pub mod tightness;
pub mod together;
pub mod unweighted;
pub mod verify;
pub mod weight_list;

/// The README's snippet, run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
