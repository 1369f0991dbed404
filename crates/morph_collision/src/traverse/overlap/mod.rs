//! The walk over two trees that finds the leaves whose boxes overlap.

mod depth_sort;
mod mapped_boxes;
mod mapped_group;
mod node;
mod trees;
mod walk;

pub(crate) use walk::{Order, OverlapWalk};

#[cfg(test)]
mod tests;
