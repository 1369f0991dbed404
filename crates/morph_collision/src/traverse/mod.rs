//! Culling: the sweep over many boxes, and the walks over one tree, over two trees, and over a tree against itself. The caller decides
//! what happens at the leaves.

mod joint_spaces;
mod moving;
mod nearest;
mod one;
mod overlap;
mod sweep;
mod view;
mod views;
mod within;

#[cfg(test)]
mod probe;
#[cfg(test)]
mod tests;

pub(crate) use moving::{Moving, MovingBoxes, middle};
pub(crate) use nearest::{NearestStack, walk_nearest};
pub(crate) use one::{Queue, walk_one};
pub(crate) use overlap::{Order, OverlapWalk};
pub use sweep::overlapping_pairs;
pub(crate) use within::{SelfStack, walk_near, walk_within};
