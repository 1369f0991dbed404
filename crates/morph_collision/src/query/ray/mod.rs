//! Rays against one body.

mod batch;
mod projection;
mod query;

pub use query::{Facing, RayHit, RayQuery};
