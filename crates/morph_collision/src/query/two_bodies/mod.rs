//! What queries about two bodies share: the set-up of a walk, and what replaces the walk for bodies as small as rounding errors.

mod collapsed;
mod distinct_triangles;
mod neighbourhood;
mod placed_pair;

pub(super) use collapsed::Collapsed;
pub(super) use distinct_triangles::{DistinctTriangles, DistinctWalk};
pub(super) use neighbourhood::{Neighbourhood, Placement};
pub(super) use placed_pair::PlacedPair;
