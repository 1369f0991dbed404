//! Culling: the sweep over many boxes, and the walks over one tree, over two trees, and over a tree against itself. The caller decides
//! what happens at the leaves.

mod mapping;
mod moving;
mod nearest;
mod one_tree;
mod overlap;
mod self_overlap;
mod sweep;

#[cfg(test)]
mod probe;
#[cfg(test)]
mod tests;

pub(crate) use moving::{Moving, MovingBoxes, middle};
pub(crate) use nearest::{NearestStack, walk_nearest};
pub(crate) use one_tree::{Queue, walk_one};
pub(crate) use overlap::{Order, OverlapWalk};
pub(crate) use self_overlap::{SelfStack, walk_near, walk_within};
pub use sweep::overlapping_pairs;
