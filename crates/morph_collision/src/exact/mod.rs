//! Exact answers over `f64` points: signs of determinants decide, never a rounded length.
//!
//! Orientation of given points comes from the `robust` crate (`predicates`); tests that need other polynomials are written
//! once over a [`Number`](number::Number) and run with an error bound first, exactly where that leaves a sign open. What is a length
//! (`closest`, `between`) is in `f64`, with a stated error.

mod between;
mod closest;
mod edge_on;
mod expansion;
mod number;
mod predicates;
mod ray;
mod region;
mod segment;
mod triangle;

pub(crate) use between::{Between, closest_between};
pub(crate) use closest::{OnTriangle, closest_on_triangle};
pub(crate) use number::VALUE_ERROR;
pub(crate) use ray::{Crossing, Line, ray_meets_triangle};
pub(crate) use region::{Plane, triangle_meets_region};
pub use triangle::{Triangle, triangles_intersect};

#[cfg(test)]
mod one_body_tests;
#[cfg(test)]
mod tests;
