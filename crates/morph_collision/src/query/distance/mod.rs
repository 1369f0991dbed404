//! How close triangles are to each other: of two bodies ([`DistanceQuery`]), or of one ([`SelfDistanceQuery`]).

mod closest;
mod closest_pair;
mod query;
mod search;
mod self_query;
mod within;

pub use closest_pair::ClosestPair;
pub use query::DistanceQuery;
pub use self_query::SelfDistanceQuery;
