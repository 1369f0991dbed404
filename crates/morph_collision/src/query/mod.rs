//! What a user asks: each query is a walk and what it does at the leaves.

mod body;
mod pairs;

pub use body::Body;
pub use pairs::{PairQuery, PairStats, TrianglePair};
