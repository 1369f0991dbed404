//! Exact answers over `f64` points: signs of determinants decide, never a rounded length.

mod predicates;
mod segment;
mod triangle;

pub use triangle::{Triangle, triangles_intersect};

#[cfg(test)]
mod tests;
