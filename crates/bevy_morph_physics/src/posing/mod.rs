//! Shapes of surfaces that are computed when somebody looks at them. While nothing is near a surface, nobody does.

mod joints;
mod lazy_pose;
mod placed_bounds;
#[cfg(test)]
mod tests;

pub use joints::SurfaceJoints;
pub use lazy_pose::LazyPose;
pub use placed_bounds::PlacedBounds;
