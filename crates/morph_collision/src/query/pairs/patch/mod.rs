//! Up to eight triangles side by side in `f32`, tested against those of another patch with error bounds.
//!
//! A pair is rejected if the triangles are apart along some axis by more than the error bound. Any axis is valid; a well-chosen one
//! only saves time. The axes are:
//!
//! - the coordinate axes;
//! - both normals;
//! - two cross products of edges. If the triangles cross each other's planes but are disjoint, one of the two separates them
//!   (Guigue and Devillers 2003).
//!
//! If all signs involved are certain, they say whether the triangles intersect. The caller decides the pairs that are still open.

mod compare;
mod triangles;
mod vectors;
mod verdict;

pub(super) use compare::Row;
pub(super) use triangles::Patch;

#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod tests;
