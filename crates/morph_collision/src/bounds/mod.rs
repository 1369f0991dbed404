//! Bounding boxes, single ([`Aabb`]) or eight side by side ([`BoxLanes`]), and the frames in which the boxes of two bodies
//! are compared.

mod aabb;
mod box_lanes;
mod box_map;
mod centered_lanes;
mod distance;
mod extent;
mod frame;
mod gap;
mod intervals;
mod inverse;
mod kernel;
mod lanes;
mod local;
mod map_frame;
mod moving_extent;
mod moving_lanes;
#[cfg(test)]
mod probe;
mod ray;
mod rounding;
mod slopes;
mod transform;
mod world_query;

pub use aabb::Aabb;
pub(crate) use box_lanes::{BoxLanes, Corners};
pub(crate) use box_map::{BoxMap, world_map};
pub(crate) use centered_lanes::CenteredLanes;
pub(crate) use distance::DistanceCull;
pub(crate) use extent::Extent;
pub(crate) use frame::{Frame, FrameLanes, PlacedBounds, visit_frames};
pub(crate) use gap::{Box64, GapFrame};
pub(crate) use intervals::{Intervals, intervals_len, push_intervals};
pub use kernel::Kernel;
pub(crate) use kernel::with_simd;
pub(crate) use lanes::{LANES, Lanes, lanes_of};
pub(crate) use map_frame::MapFrame;
pub(crate) use moving_extent::{MovingExtent, first_overlap};
pub(crate) use moving_lanes::MovingLanes;
#[cfg(test)]
pub(crate) use probe::{ExactPoint, adjugate, exact_image, holds, lack, levels};
pub(crate) use ray::{LocalRay, RayCull};
pub(crate) use rounding::{down, up};
pub(crate) use slopes::{Slopes, push_slopes, slopes_len};
pub use transform::WorldFromModel;
pub(crate) use world_query::{ByBox, Keys, LowerBounds, ModelPlane};

#[cfg(test)]
mod distance_tests;
#[cfg(test)]
mod ray_tests;
#[cfg(test)]
mod rounding_tests;
