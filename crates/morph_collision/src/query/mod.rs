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
            pub fn stats(&self) -> crate::query::QueryStats {
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
mod contact;
mod distance;
mod input;
mod leaves;
pub mod motion;
mod one_body;
mod pairs;
mod rank;
mod ray;
mod shape;
mod stats;
mod triangle_pair;
mod two_bodies;

pub use anchor::{SurfaceAnchor, SurfaceFrame};
pub use body::Body;
pub use contact::{ContactPoint, ContactQuery, Manifold};
pub use distance::{ClosestPair, DistanceQuery, SelfDistanceQuery};
pub use input::{ConvexRegion, Ray};
pub use pairs::{PairMemory, PairQuery, SelfQuery, touching_regions};
pub use rank::Rank;
pub use ray::{Facing, RayHit, RayQuery};
pub use shape::{
    ClosestPoint, ConvexHull, HullError, PlacedShape, Shape, ShapeCastHit, ShapeContact, ShapeGap, ShapeImpact,
    ShapeQuery,
};
pub use stats::QueryStats;
pub use triangle_pair::TrianglePair;
