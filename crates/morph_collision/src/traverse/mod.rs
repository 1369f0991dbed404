//! Culling: the sweep over many boxes, and the walks over one tree, over two trees, and over a tree and itself. Callers decide what
//! happens at the leaves.

mod cull;
mod one;
mod pairs;
mod rule;
mod sweep;
mod within;

pub(crate) use cull::{Culls, Side};
pub(crate) use one::{OneWalk, Queue};
pub(crate) use pairs::{PairWalk, Stack};
pub(crate) use rule::{Opened, PairRule};
pub use sweep::overlapping_pairs;
pub(crate) use within::{SelfStack, walk_within};
