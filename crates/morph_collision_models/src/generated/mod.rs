//! Generated meshes, the same to the last bit on every machine.
//!
//! - [`dolphin()`] and [`pass_through_body()`]: the bodies of the two experiments in the paper on which this project is
//!   based.
//! - [`heaving_body()`]: a hill to walk on.
//! - [`random`]: seeded meshes for property tests.
//! - [`degenerate`]: geometry that files should not contain, but do.
//! - [`rigid`]: boxes and grids without targets.
//! - [`rigs`]: skinned meshes, and poses for skeletons.
//!
//! They are built with `grid` (coordinates that survive arithmetic), `subdivide`, `icosphere` and `tube`.

pub mod degenerate;
mod dolphin;
mod grid;
mod heaving;
mod icosphere;
mod pass_through;
pub mod random;
pub mod rigid;
pub mod rigs;
mod subdivide;
pub mod topology;
mod tube;

pub use self::dolphin::{dolphin, swim_weights};
pub(crate) use self::grid::round6;
pub use self::heaving::heaving_body;
pub use self::pass_through::{pass_through_body, pass_through_body_at};
