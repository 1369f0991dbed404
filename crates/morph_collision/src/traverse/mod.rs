//! Walks that cull: over one list of bodies, and over two trees. What happens at a pair of leaves is the caller's.

mod cull;
mod one_shape;
mod pairs;
mod sweep;

pub(crate) use cull::{AsBoxes, CrossCull, Cull, Walkable};
pub(crate) use one_shape::{RankedStack, walk};
pub(crate) use pairs::{PairWalk, Stack};
pub use sweep::overlapping_pairs;
