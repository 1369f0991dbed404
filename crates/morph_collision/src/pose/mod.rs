//! One instance of a mesh: its weights, and a cache of what has been blended for them.
//!
//! - Every box comes from [`Posed::open`], which blends it from the tree's tables on first use (`blend`). It stays cached until the
//!   weights change (`cache`).
//! - The boxes of skinned meshes are fitted to posed vertices (`posed_vertices`), a chunk of the tree at a time (`fitted_boxes`,
//!   `posed_skin`). Above the chunks they are computed from one box per joint (`outer_boxes`).
//! - [`Pose::refit`] fits all boxes to the posed vertices at once instead, [`Pose::refit_lazily`] half of them (`refit`).

mod blend;
mod blended_vertices;
mod box_source;
mod box_tree;
mod cache;
mod displacement;
mod fitted_boxes;
mod instance;
mod joint_hull;
mod outer_boxes;
mod part_boxes;
mod placed_body;
mod posed;
mod posed_bounds;
mod posed_skin;
mod posed_vertices;
mod refit;
mod shape;
mod skin_tree;
mod skinning;
mod snapshot;
mod stamps;
mod visit;
mod weights;

pub(crate) use box_tree::BoxTree;
pub(crate) use cache::EpochCache;
pub(crate) use displacement::displacement;
pub use instance::Pose;
pub(crate) use placed_body::PlacedBody;
pub(crate) use posed::{Blended, NodeRef, Posed};
pub(crate) use posed_skin::LeafPositions;
pub use snapshot::PoseSnapshot;
pub use visit::PosedNode;
pub use weights::WeightsError;

#[cfg(test)]
mod corners_tests;
#[cfg(test)]
mod displacement_tests;
#[cfg(test)]
mod joint_rounding_tests;
#[cfg(test)]
mod lazy_work_tests;
#[cfg(test)]
mod outer_boxes_tests;
#[cfg(test)]
mod placement_rounding_tests;
#[cfg(test)]
mod refit_tests;
#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod skin_tightness_tests;
#[cfg(test)]
mod skinning_tests;
#[cfg(test)]
mod tests;
