//! Exact answers about `f64` points: signs of determinants decide, never rounded lengths.
//!
//! Most pairs of triangles are decided by a `filter` in `f64` with an error bound, the rest by adaptive `predicates`. Tests
//! that need other polynomials (`ray`, `region`) are written once over a [`Number`](number::Number). They run with error
//! bounds first, and in exact arithmetic (`dyadic`) where a sign is left open. Points and lengths (`closest`, `contact`) are
//! in `f64`, with stated errors.

mod closest;
mod contact;
mod dyadic;
mod filter;
mod number;
mod predicates;
mod ray;
mod region;
mod segment;
mod triangle;

pub(crate) use closest::{
    ClosestPoints, TrianglePoint, closest_of_segment_and_triangle, closest_of_segments, closest_of_triangles,
    closest_on_segment, closest_on_triangle, closest_on_triangle_exactly,
};
pub use contact::{TriangleContact, triangle_contact};
pub(crate) use contact::{common_segment, unit_normal};
pub(crate) use filter::Facet;
pub(crate) use number::{VALUE_ERROR, power_of_two, power_of_two_below};
pub(crate) use predicates::plane_side;
pub(crate) use ray::{Crossing, Line, ray_meets_triangle};
pub(crate) use region::{Plane, triangle_meets_region};
pub(crate) use segment::{Segment, edges, sorted};
pub(crate) use triangle::facets_intersect_counting;
pub use triangle::{Triangle, triangles_intersect};

#[cfg(test)]
mod closest_tests;
#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod one_body_tests;
#[cfg(test)]
mod tests;
