//! Bounding volumes, eight at a time, and the frames in which volumes of two bodies are compared.
//!
//! [`Volume`] says what a kind of bounding volume must be able to do; [`Slabs`] are boxes and k-DOPs, [`Spheres`] are spheres.

mod aabb;
mod cross_axes;
mod directions;
mod frame;
mod gap;
mod kernel;
mod lanes;
#[cfg(test)]
mod levels;
#[cfg(test)]
mod probe;
mod rounding;
mod slab_map;
mod slabs;
mod spheres;
mod transform;
mod volume;
mod world_query;

pub use aabb::Aabb;
pub(crate) use cross_axes::{CrossAxes, FrameSide};
pub(crate) use frame::{Frame, Frames, a_from_b, are_below_resolution, frobenius, visit_frames, world_bounds};
pub(crate) use gap::{Box64, GapFrame};
pub use kernel::Kernel;
pub(crate) use kernel::with_simd;
pub(crate) use lanes::{LANES, Lanes};
#[cfg(test)]
pub(crate) use levels::levels;
#[cfg(test)]
pub(crate) use probe::{ExactPoint, Probe};
pub(crate) use rounding::{U64, down, up};
pub(crate) use slabs::{BoxLanes, Slab, Slabs};
pub(crate) use spheres::Spheres;
pub use transform::{TransformError, WorldFromModel};
pub(crate) use volume::{Points, Volume};
pub(crate) use world_query::{ModelPlane, RayCull};

#[cfg(test)]
mod rounding_tests;
