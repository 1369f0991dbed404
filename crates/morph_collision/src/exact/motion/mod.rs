//! Exact continuous collision of moving points, edges and triangles.
//!
//! Every corner moves from its start to its end on a straight line, at constant speed, while the time goes from 0 to 1. Two surfaces
//! that move like this touch first where a vertex meets a face or an edge meets an edge, so those are the two tests.
//!
//! - [`vertex_face_touch`] and [`edge_edge_touch`] say whether there is contact at any time.
//! - [`vertex_face_impact`] and [`edge_edge_impact`] say when it starts.
//!
//! Contact means that the distance is exactly zero. Faces and edges include their boundaries, and the times include 0 and 1. The
//! decision is exact for all finite coordinates: there is no missed contact, no false one, and no epsilon. Faces and edges may be
//! degenerate, always or at some times, and the motion may stay in one plane.
//!
//! # How it decides
//!
//! All questions are signs of polynomials in the time (`features`). Four stages answer them, cheapest
//! first; [`StageCounts`] says which one did.
//!
//! 1. Separation: along an axis of space, all differences of the two features' corners have the same sign.
//! 2. Filter: `f64` with an error bound, at the times at which all corners are in one plane, or on ever shorter intervals of time
//!    (`docs/numerics.md` derives the bound).
//! 3. Ends: what the features are exactly at the start and at the end, if they touch at the start or can only touch at the end.
//! 4. Exact: integer polynomials, their isolated roots, and greatest common divisors where a sign might be zero.

mod answer;
mod ball;
mod bernstein;
mod directions;
mod ends;
mod features;
mod filter;
mod geometry;
mod moving;
mod polynomial;
mod root;
mod solve;
mod stages;
mod touch;

pub(crate) use ball::{ball_impact, relative_to};
pub(crate) use features::{FeaturePair, Kind};
pub(crate) use geometry::impact_geometry;
pub use moving::{MovingPoint, TimeOfImpact};
pub use stages::StageCounts;
pub use touch::{
    edge_edge_impact, edge_edge_impact_counting, edge_edge_touch, edge_edge_touch_counting, vertex_face_impact,
    vertex_face_impact_counting, vertex_face_touch, vertex_face_touch_counting,
};

#[cfg(test)]
mod geometry_tests;
#[cfg(test)]
mod stage_tests;
#[cfg(test)]
mod tests;
