//! Exact answers over `f64` points: signs of determinants decide, never a rounded length.
//!
//! Where an answer is a point or a distance (`contact`, `closest`), it is `f64` and says how far it may be off.

mod closest;
mod contact;
mod predicates;
mod segment;
mod triangle;

pub(crate) use closest::{
    Nearest, closest_of_segment_and_triangle, closest_of_segments, closest_on_segment, closest_on_triangle, edges,
    unit_normal,
};
pub(crate) use contact::common_segment;
pub use contact::{TriangleContact, triangle_contact};
pub(crate) use predicates::plane_side;
pub(crate) use segment::Segment;
pub use triangle::{Triangle, triangles_intersect};

#[cfg(test)]
mod tests;
