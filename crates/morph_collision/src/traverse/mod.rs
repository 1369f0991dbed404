//! Walks that cull: over one list of bodies, and over two trees. What happens at a pair of leaves is the caller's.

mod cull;
mod pairs;
mod sweep;

pub(crate) use cull::{AsBoxes, Cull, Walkable};
pub(crate) use pairs::{PairWalk, Stack};
pub use sweep::overlapping_pairs;
