//! Exact answers over `f64` points: signs of determinants decide, never a rounded length.
//!
//! Two triangles are mostly decided in `f64` with an error bound (`filter`). Where it leaves them open, orientation comes from
//! adaptive predicates (`predicates`); tests that need other polynomials are written once over a [`Number`](number::Number)
//! and run with an error bound first, exactly where that leaves a sign open. What is a point or a length (`closest`,
//! `between`, `nearest`, `contact`) is in `f64`, with a stated error.

mod between;
mod closest;
mod contact;
mod dyadic;
mod edge_on;
mod filter;
mod nearest;
mod number;
mod predicates;
mod ray;
mod region;
mod segment;
mod triangle;

pub(crate) use between::{Between, closest_between};
pub(crate) use closest::{OnTriangle, closest_on_triangle};
pub(crate) use contact::common_segment;
pub use contact::{TriangleContact, triangle_contact};
pub(crate) use filter::Facet;
pub use filter::triangles_intersect_filtered;
pub(crate) use nearest::{
    Nearest, closest_of_segment_and_triangle, closest_of_segments, closest_on_segment, edges, unit_normal,
};
pub(crate) use number::VALUE_ERROR;
pub(crate) use predicates::plane_side;
pub(crate) use ray::{Crossing, Line, ray_meets_triangle};
pub(crate) use region::{Plane, triangle_meets_region};
pub(crate) use segment::Segment;
pub(crate) use triangle::facets_intersect_counting;
pub use triangle::{Triangle, triangles_intersect};

#[cfg(test)]
mod one_body_tests;
#[cfg(test)]
mod tests;
