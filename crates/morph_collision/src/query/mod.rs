//! What a user asks: each query is a walk and what it does at the leaves.

mod body;
mod memory;
mod pairs;
mod self_pairs;

pub use body::Body;
pub use memory::{PairMemory, Remember};
pub use pairs::{PairQuery, PairStats, TrianglePair};
pub use self_pairs::SelfQuery;
