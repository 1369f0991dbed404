//! What a user asks: each query is a walk and what it does at the leaves.

mod anchor;
mod batch;
mod body;
mod capped;
mod collapsed;
mod contact;
mod distance;
mod input;
mod leaves;
mod memory;
mod neighbourhood;
mod one;
mod overlap;
mod pairs;
mod patch;
mod patches;
mod places;
mod point;
mod ray;
mod self_pairs;
mod shape;
mod stats;

pub use anchor::{SurfaceAnchor, SurfaceFrame};
#[cfg(feature = "rayon")]
pub use batch::RayonWorkers;
pub use batch::{BatchAnswers, BatchQuery, OneThread, PairTask, ThreadWorkers, Wanted, Workers};
pub use body::Body;
pub use contact::{ContactPoint, ContactQuery, Manifold, PairContact, Separation};
pub use distance::{ClosestPair, DistanceQuery};
pub use input::{Ball, ConvexRegion, HalfSpace, Ray};
pub use memory::PairMemory;
pub use overlap::OverlapQuery;
pub use pairs::{PairQuery, TrianglePair};
pub use point::{ClosestPoint, PointQuery};
pub use ray::{Facing, RayHit, RayQuery};
pub use self_pairs::SelfQuery;
pub use shape::{PlacedShape, Shape, ShapeContact, ShapeError, ShapeQuery, WorldFromShape};
pub use stats::QueryStats;

#[cfg(test)]
mod patch_tests;
