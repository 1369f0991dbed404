//! Rays against one body.

mod projection;
mod query;

pub use query::{Facing, RayHit, RayQuery};
