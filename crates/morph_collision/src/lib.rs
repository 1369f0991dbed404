#![doc = include_str!("../README.md")]
//!
//! # Is this the crate you need?
//!
//! - You write a Bevy game: use `bevy_morph_collision`, this crate as a plugin.
//! - You have your own engine, or none: use this crate. It depends on `glam`, not on an engine.
//! - Your meshes never deform: any collision library will do. (Meshes without targets also work here, as rigid bodies.)
//! - Joints deform your meshes, with or without targets: use this crate ([`MorphModel::skinned`], [`Pose::set_joints`]).
//!
//! # Concepts
//!
//! - A [`MorphModel`] is a mesh with its targets and joints. A [`MorphBvh`] is the tree over it. Both are immutable.
//! - A [`Pose`] is one instance: its weights and joints, and a cache of the boxes and vertices computed for them.
//! - A [`Body`] is a pose and its placement in the world, borrowed for one query.
//! - A query, such as [`PairQuery`], owns scratch memory: create it once and reuse it. Its methods return the answer, and `stats()` reports
//!   how much work the last call took. Methods that fill a list append to it. The `up_to` variants stop at a limit and return whether there
//!   is more. The `_batch` variants answer many questions at once; they replace a list by one answer per question.
//!
//! ```text
//! positions + targets -> MorphModel -> MorphBvh -> Pose (weights, joints, cache) -> PairQuery -> triangle pairs
//! (+ influences)         immutable     immutable   one per instance                 scratch
//! ```
//!
//! # Which query answers which question
//!
//! | question | use |
//! |---|---|
//! | Which triangles of two bodies intersect? | [`PairQuery`], with [`PairMemory`] from frame to frame |
//! | Which triangles of many pairs of bodies intersect, on several threads? | [`BatchQuery`](batch::BatchQuery), on [`Workers`](batch::Workers) |
//! | Where do two bodies touch, how deep, and which way is out? | [`ContactQuery`], [`triangle_contact`] |
//! | What touches while bodies move from one pose to another? When? What does a bullet hit? | [`MotionQuery`](motion::MotionQuery) |
//! | How far apart are two bodies? Which of their triangles are closer than a distance? | [`DistanceQuery`] |
//! | Which triangles of one body come closer to each other than a distance? | [`SelfDistanceQuery`] |
//! | Which of many boxes overlap? | [`overlapping_pairs`] |
//! | What does a ray hit? | [`RayQuery`] |
//! | What do thousands of rays hit? Which points are closest to thousands of points? | [`RayQuery::closest_batch`], [`ShapeQuery::closest_point_batch`] |
//! | What touches a [`Shape`], a box or a camera's frustum? Which point is closest? | [`ShapeQuery`] |
//! | What does a moving shape touch first? | [`ShapeQuery::cast`]; another shape: [`PlacedShape::cast`] |
//! | Is a point inside a closed mesh? | [`RayQuery::encloses`] |
//! | Where does a body intersect itself? | [`SelfQuery`]; for all weights at once: [`SelfProof`](proof::SelfProof) |
//! | Where is a point on the surface as the shape changes? | [`SurfaceAnchor`] |
//! | What are the bounds, positions and normals of a shape? | [`Pose`] |
//!
//! [`BuildOptions`] never change an answer. `docs/measurements/leaves.md` in the repository shows how the leaf size affects speed.
//!
//! # What an answer means
//!
//! A posed vertex is the `f32` blend of base and displacements, in ascending target order. The body's affine map takes it to world space in
//! `f64`; see [`WorldFromModel::transform_point`]. A vertex of a skinned mesh is taken to world space by the weighted sum of its joints'
//! matrices instead, also in `f64`. [`Body::vertex`] returns these positions.
//!
//! Over those vertices the answer is exact: touching counts, coplanar and degenerate triangles are handled, and there is no epsilon.
//! Trees only change the speed. [`PlacedShape`] and [`PlacedShape::intersects`] say what is exact for shapes.
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! proof > query > traverse > pose > tree > bounds, model > joints > exact, hash, input_error
//! ```
#![forbid(unsafe_code)]
// Tests make their shapes in any way.
#![cfg_attr(test, allow(clippy::disallowed_methods))]
// docs.rs shows which feature an item needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod bounds;
mod exact;
mod hash;
mod input_error;
mod joints;
mod model;
mod pose;
pub mod proof;
mod query;
mod traverse;
mod tree;

pub use bounds::{Aabb, Kernel, WorldFromModel};
pub use exact::{Triangle, TriangleContact, triangle_contact, triangle_distance, triangles_intersect};
pub use input_error::InputError;
pub use joints::JointMatrices;
pub use model::{BadParts, Influences, ModelError, MorphModel, SparseTarget, TargetDisplacements};
pub use pose::{Pose, PoseSnapshot, PosedNode, WeightsError};
pub use query::{
    Body, ClosestPair, ClosestPoint, ContactPoint, ContactQuery, ConvexHull, ConvexRegion, DistanceQuery, Facing,
    HullError, Manifold, PairMemory, PairQuery, PlacedShape, QueryStats, Rank, Ray, RayHit, RayQuery,
    SelfDistanceQuery, SelfQuery, Shape, ShapeCastHit, ShapeContact, ShapeGap, ShapeImpact, ShapeQuery, SurfaceAnchor,
    SurfaceFrame, TrianglePair, batch, motion, touching_regions,
};
pub use traverse::overlapping_pairs;
pub use tree::{BuildOptions, LayoutError, MorphBvh, MorphBvhBuilder, TreeLayout};
#[cfg(feature = "tree-file")]
pub use tree::{SavedTree, TreeFile, TreeFileError};
