//! The queries. Each is a walk over trees plus a test at the leaves.

/// The two methods that queries have in common.
macro_rules! query_basics {
    ($query:ty, |$self:ident| $stats:expr) => {
        impl $query {
            /// Creates an empty query. It allocates on first use.
            #[must_use]
            pub fn new() -> Self {
                Self::default()
            }

            /// Returns the work done by the last call.
            #[must_use]
            pub fn stats(&self) -> crate::QueryStats {
                let $self = self;
                $stats
            }
        }
    };
}

mod anchor;
pub mod batch;
mod body;
mod capped;
mod collapsed;
mod contact;
mod distance;
mod distinct_triangles;
mod input;
mod leaves;
mod memory;
pub mod motion;
mod neighbourhood;
mod one;
mod pairs;
mod patch;
mod patches;
mod placements;
mod rank;
mod ray;
mod ray_view;
mod regions;
mod self_distance;
mod self_pairs;
mod shape;
mod stats;

pub use anchor::{SurfaceAnchor, SurfaceFrame};
pub use body::Body;
pub use contact::{ContactPoint, ContactQuery, Manifold};
pub use distance::{ClosestPair, DistanceQuery};
pub use input::{ConvexRegion, Ray};
pub use memory::PairMemory;
pub use pairs::{PairQuery, TrianglePair};
pub use rank::Rank;
pub use ray::{Facing, RayHit, RayQuery};
pub use regions::touching_regions;
pub use self_distance::SelfDistanceQuery;
pub use self_pairs::SelfQuery;
pub use shape::{ClosestPoint, PlacedShape, Shape, ShapeCastHit, ShapeContact, ShapeGap, ShapeImpact, ShapeQuery};
pub use stats::QueryStats;

#[cfg(test)]
mod pair_tests;
#[cfg(test)]
mod patch_tests;
