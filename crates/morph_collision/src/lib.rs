#![doc = include_str!("../README.md")]
//!
//! # Is this the crate you need?
//!
//! - You write a Bevy game: use `bevy_morph_collision`, which is this crate as a plugin.
//! - You have an engine of your own, or none: use this crate. It depends on `glam` and not on an engine.
//! - Your meshes never deform: any collision library will do. (Meshes without targets work here, as rigid bodies.)
//! - Your meshes are deformed by bones, with or without targets: use this crate ([`MorphModel::skinned`], [`Pose::set_joints`]).
//!
//! # The pipeline
//!
//! ```text
//! positions + targets -> MorphModel -> MorphBvh -> Pose (weights, joints, cache) -> PairQuery -> triangle pairs
//! (+ influences)         immutable     immutable   one per instance                 scratch
//! ```
//!
//! # What can be asked
//!
//! | question | answer |
//! |---|---|
//! | Which triangles of two bodies intersect? | [`PairQuery`], with [`PairMemory`] from frame to frame |
//! | Where do two bodies touch, how deep, and which way is out? | [`ContactQuery`], [`triangle_contact`] |
//! | How far apart are two bodies? | [`DistanceQuery`] |
//! | The same for many pairs, on several threads? | [`BatchQuery`], on [`Workers`] |
//! | Which of many boxes overlap? | [`overlapping_pairs`] |
//! | What does a ray hit? | [`RayQuery`] |
//! | What touches a ball, capsule, cuboid, half-space, box or frustum? Which point is closest? | [`ShapeQuery`] |
//! | What does a moving shape touch first? | [`ShapeQuery::cast`]; another shape: [`PlacedShape::cast`] |
//! | Is a point inside a closed mesh? | [`RayQuery::encloses`] |
//! | Where does a body intersect itself? | [`SelfQuery`] |
//! | Where is a point on the surface as the shape changes? | [`SurfaceAnchor`] |
//! | What are the bounds, positions and normals of a shape? | [`Pose`] |
//!
//! A query object holds scratch memory: create it once and reuse it. Its methods return the answer; `stats()` tells how much work the last
//! one took. Lists are appended to; the `up_to` forms stop at a limit and return whether there is more.
//!
//! How a tree is built ([`BuildOptions`]) never changes an answer; `docs/performance.md` in the repository says what the size of leaves is worth.
//!
//! # What an answer means
//!
//! A posed vertex is the `f32` blend of base and displacements in ascending target order, taken to world space in `f64`
//! by the body's affine; see [`WorldFromModel::transform_point`]. That of a skinned mesh is taken there by the weighted sum of
//! its joints' matrices instead, also in `f64`; [`Body::vertex`] gives it. Over those vertices the answer is exact: touching counts,
//! coplanar and degenerate triangles are handled, and there is no epsilon. Trees change only the speed. For balls, capsules and
//! half-spaces [`PlacedShape::intersects`] says what is exact.
#![forbid(unsafe_code)]
// docs.rs says which feature has what.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod bounds;
mod exact;
mod input_error;
mod joints;
mod model;
mod pose;
mod query;
mod traverse;
mod tree;

pub use bounds::{Aabb, Kernel, WorldFromModel};
pub use exact::{Triangle, TriangleContact, triangle_contact, triangles_intersect};
pub use input_error::InputError;
pub use joints::JointMatrices;
pub use model::{Influences, ModelError, MorphModel};
pub use pose::{Pose, PoseSnapshot, PosedNode, WeightsError};
#[cfg(feature = "rayon")]
pub use query::RayonWorkers;
pub use query::{
    BatchAnswers, BatchQuery, Body, ClosestPair, ClosestPoint, ContactPoint, ContactQuery, ConvexRegion, DistanceQuery,
    Facing, Manifold, PairMemory, PairQuery, PairTask, PlacedShape, QueryStats, Ray, RayHit, RayQuery, SelfQuery,
    Shape, ShapeCastHit, ShapeContact, ShapeGap, ShapeImpact, ShapeQuery, SurfaceAnchor, SurfaceFrame, ThreadWorkers,
    TrianglePair, Wanted, Workers,
};
pub use traverse::overlapping_pairs;
pub use tree::{BuildOptions, LayoutError, MorphBvh, MorphBvhBuilder, TreeLayout};
