//! Walks that cull: over one list of bodies, over two trees, and over a tree and itself. What happens at a pair of leaves is the caller's.

mod cull;
mod pairs;
mod sweep;
mod within;

pub(crate) use cull::{AsBoxes, Cull, Walkable};
pub(crate) use pairs::{PairWalk, Stack, Trace};
pub use sweep::overlapping_pairs;
pub(crate) use within::walk_within;
