//! Bodies against balls, capsules, cuboids, half-spaces and segments.
//!
//! All shapes are convex, and one notion serves every question: the *signed distance* of a point, positive outside, zero on
//! the surface, negative inside, which is a convex function; a triangle's is the smallest of its points'. It is the largest of
//! `w . x - support(w)` over all directions `w`, so each direction tried gives a lower bound for a node (`bound`).

mod bound;
mod cuboid;
mod error;
mod placed;
mod query;
mod solid;

pub use error::ShapeError;
pub use placed::{PlacedShape, Shape, WorldFromShape};
pub use query::{ShapeContact, ShapeQuery};
