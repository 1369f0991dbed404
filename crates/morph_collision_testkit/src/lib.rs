//! What the tests, tools and examples of `morph_collision` share, and what nobody else needs.
//!
//! - [`mesh`], [`clip`]: a triangle mesh with morph targets and weight animations, as a file holds it.
//! - [`gltf_read`], [`gltf_write`]: that mesh from and to glTF 2.0.
//! - [`memory`]: a limit on what a file may claim.
//! - [`printable`]: names from files, safe to show.
//! - [`inspect`]: what a file of such meshes is made of.
//! - [`models`]: generated meshes: a dolphin, the body of a pass-through, random, degenerate and rigid ones.
//! - [`scenes`]: scripted motion for them, and the JSON scene format.
//! - [`assets`]: what lies in `assets/`, made of the above.
//! - [`numbers`]: numbers in JSON that may not be finite.
//! - [`oracle`]: the same question answered by brute force in exact arithmetic.
//! - [`mod@bench`]: every method timed against every other one.
//! - [`moments`]: bodies in one moment, ordinary and odd, that every method has to agree on.
//! - [`determinism`]: hashes of answers, which must be the same everywhere.
//! - [`fuzzing`]: what the fuzz targets do with bytes.
//! - [`near_degenerate`]: pairs of triangles that rounded arithmetic gets wrong.
//! - [`rivals`]: the same question answered by every other method that `morph_collision` is compared with.
//! - [`verify`]: the answers of trees against brute force, over situations drawn at random.
//! - [`stress`]: the same over generated trouble, family by family, and bad input at every door.
//! - [`search`]: hill climbing, to look for the worst rounding.
#![forbid(unsafe_code)]

pub mod assets;
pub mod bench;
pub mod clip;
pub mod determinism;
pub mod fuzzing;
pub mod gltf_read;
pub mod gltf_write;
pub mod inspect;
pub mod memory;
pub mod mesh;
pub mod models;
pub mod moments;
pub mod near_degenerate;
pub mod numbers;
pub mod oracle;
pub mod printable;
pub mod rivals;
pub mod scenes;
pub mod search;
pub mod stress;
pub mod verify;
