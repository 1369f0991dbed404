//! What a user asks: each query is a walk and what it does at the leaves.

mod anchor;
mod body;
mod distance;
mod input;
mod one;
mod overlap;
mod pairs;
mod point;
mod ray;

pub use anchor::{SurfaceAnchor, SurfaceFrame};
pub use body::Body;
pub use distance::{ClosestPair, DistanceQuery};
pub use input::{Ball, ConvexRegion, HalfSpace, InputError, Ray};
pub use one::BodyStats;
pub use overlap::OverlapQuery;
pub use pairs::{PairQuery, PairStats, TrianglePair};
pub use point::{ClosestPoint, PointQuery};
pub use ray::{Facing, RayHit, RayQuery};
