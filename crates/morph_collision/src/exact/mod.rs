//! Exact answers about `f64` points. Signs of determinants decide, never rounded lengths.
//!
//! - A `filter` in `f64` with an error bound decides most pairs of triangles. Of the others, a `separation` shows most of those that
//!   are apart to be so. Adaptive `predicates` decide the rest.
//! - Tests that need other polynomials (`ray`, `region`) are generic over [`Number`](number::Number). They run with error bounds
//!   first, and in exact arithmetic (`dyadic`) if that leaves a sign open. Quotients are rounded correctly (`double_double`).
//! - [`motion`] decides whether moving points, edges and triangles touch, and when.
//! - Points and lengths (`closest`, `contact`) are `f64`, with stated errors.

mod closest;
mod contact;
mod double_double;
mod dyadic;
mod filter;
mod intersection;
pub(crate) mod motion;
mod number;
mod predicates;
mod ray;
mod region;
mod segment;
mod separation;
mod triangle;

pub use closest::triangle_distance;
pub(crate) use closest::{
    ClosestPoints, TrianglePoint, closest_of_segment_and_triangle, closest_of_segments, closest_of_triangles,
    closest_on_segment, closest_on_triangle, closest_on_triangle_exactly,
};
pub use contact::{TriangleContact, triangle_contact};
pub(crate) use contact::{common_segment, unit_normal};
pub(crate) use filter::Facet;
pub(crate) use intersection::facets_intersect_counting;
pub use intersection::triangles_intersect;
pub(crate) use number::{largest, power_of_two, power_of_two_below};
pub(crate) use predicates::plane_side;
pub(crate) use ray::{Crossing, Line, ray_meets_triangle};
pub(crate) use region::{Plane, triangle_meets_region};
pub(crate) use segment::{Segment, edges, sorted};
pub use triangle::Triangle;

#[cfg(test)]
mod closest_tests;
#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod one_body_tests;
#[cfg(test)]
mod tests;
