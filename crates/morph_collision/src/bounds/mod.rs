//! Boxes, eight of them at a time, and the maps that take them from one body's space to another's.

mod aabb;
mod lanes;
mod map;
mod transform;

pub use aabb::Aabb;
pub(crate) use lanes::{BoxLanes, LANES, Lanes};
pub(crate) use map::{Cull, Side, culls_of, world_bounds};
pub use transform::{TransformError, WorldFromModel};
