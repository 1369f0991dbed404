//! Walks that cull: over one list of bodies, over one tree, over two, and over a tree and itself. What happens at the
//! leaves is the caller's.

mod cull;
mod one;
mod overlap_rule;
mod pairs;
mod rule;
mod sweep;
mod within;

pub(crate) use cull::{Culls, Side};
pub(crate) use one::{OneWalk, Queue};
pub(crate) use overlap_rule::OverlapRule;
pub(crate) use pairs::{PairWalk, Stack};
pub(crate) use rule::{Opened, PairRule};
pub use sweep::overlapping_pairs;
pub(crate) use within::{SelfStack, walk_within};
