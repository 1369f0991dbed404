//! Rigid motions, boxes, and maps between spaces.

mod isometry;
mod rigid_motion;
mod sorted_boxes;
mod velocities;
mod world_space;

pub use isometry::{affine_between, affine_of, is_rigid, rigid_part};
pub use rigid_motion::RigidMotion;
pub use sorted_boxes::SortedBoxes;
pub use velocities::{are_continuous, between, continuous, fastest, largest};
pub use world_space::{collider_from_world, corners, into_query, joint_in, mapped, precise, region};
