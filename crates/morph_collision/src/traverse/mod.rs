//! Walks that cull: over one list of bodies, over one tree, and over two. What happens at the leaves is the caller's.

mod cull;
mod one;
mod pairs;
mod sweep;

pub(crate) use cull::{AsBoxes, Cull, Side, Walkable};
pub(crate) use one::{OneWalk, Queue};
pub(crate) use pairs::{Meeting, Opened, PairRule, PairWalk, Stack};
pub use sweep::overlapping_pairs;
