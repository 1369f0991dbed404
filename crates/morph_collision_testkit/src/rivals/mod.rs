//! The methods that `morph_collision` is compared with, over the same meshes and with the same answers.
//!
//! A [`Method`] holds the bodies of a scene. Every frame each body is given its weights and place, and then pairs of bodies
//! are asked for their intersecting triangles. All methods decide triangles by the same exact test,
//! [`morph_collision::triangles_intersect`], over the same vertices (only the oracle has a test of its own), so they must
//! agree pair for pair and differ in nothing but the work:
//!
//! | [`MethodKind`] | what a frame costs before anything is asked | from |
//! |---|---|---|
//! | `morph` | nothing | this project |
//! | `morph-eager` | every vertex blended, every volume fitted to them, by this project's own code: what is method and what is engineering | |
//! | `rigid-floor` | nothing: every shape has a tree of its own, made beforehand; a floor, not a rival | |
//! | `paper` | nothing | Larsson, Akenine-Moller 2003: the method that this project starts from, as the paper has it |
//! | `bottom-up` | every vertex blended, every box refitted | van den Bergen 1997 |
//! | `hybrid` | every vertex blended, the upper half of the tree refitted, the rest when a walk gets there | Larsson, Akenine-Moller 2001 |
//! | `joint-boxes` | nothing: a node's box is around the images of boxes under its joints, one for each joint around the vertices that it moves | Bevy's bounds of skinned meshes, for every node |
//! | `joint-union` | nothing: the same with one box for each node | |
//! | `rebuild` | every vertex blended, the tree built anew | |
//! | `octree` | every vertex blended and placed in the world; an octree of faces for every pair of bodies | Smith et al. 1995 |
//! | `parry-trimesh` | every vertex blended in place, the tree of a `TriMesh` refitted | Parry |
//! | `parry-bvh` | every vertex blended, a bare `Bvh` refitted and put into a better order in memory | Parry |
//! | `parry-rebuild` | every vertex blended, the `Bvh` built anew (binned) | Parry |
//! | `brute-force` | every vertex blended and placed in the world | the oracle |
//!
//! Skinned meshes are for `morph`, `morph-eager`, `bottom-up`, `hybrid`, `joint-boxes`, `joint-union`, `rebuild`, Parry's three and `brute-force`: all but
//! ours and the two with boxes of joints place all vertices by their joints (`skin`) when these have moved. The other methods refuse them.
//!
//! What is fair is done for all of them: vertices are welded, targets with weight zero and vertices that a target leaves
//! alone are skipped, and a body whose weights stay the same is not refitted. `bottom-up`, `hybrid` and `rebuild` share one tree
//! (`tree`), eight-wide like the core's, and one walk (`walk`) with the same SAT-lite culling (`boxes`, `frames`).
//! `paper` is as the paper has it: one triangle in a leaf, one pair of nodes at a time, in `f64`. Its counts compare with those of
//! the others; its times would gain from what the others do beside their method.
//!
//! ```
//! use glam::{Affine3A, Vec3};
//! use morph_collision_testkit::models::dolphin;
//! use morph_collision_testkit::rivals::{MethodKind, MethodOptions, Wanted};
//!
//! let meshes = [dolphin(0)];
//! let mut method = MethodKind::BottomUp.set_up(&meshes, &[0, 0], &MethodOptions::default())?;
//! method.set_body(0, &[0.5, 0.0], &Affine3A::IDENTITY)?;
//! method.set_body(1, &[0.0, 0.5], &Affine3A::from_translation(Vec3::new(0.0, 0.2, 0.1)))?;
//! let mut pairs = Vec::new();
//! method.collide(0, 1, Wanted::All, &mut pairs);
//! assert!(!pairs.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod blended;
mod bottom_up;
mod boxes;
mod broad;
mod brute_force;
mod build;
mod cast;
mod frames;
mod hybrid;
mod joint_boxes;
mod joint_nodes;
mod kind;
mod limits;
mod morph;
mod octree;
mod options;
mod paper;
mod parry;
mod rebuild;
mod relative;
mod rigid_floor;
mod skin;
mod tree;
mod walk;

use std::fmt::Debug;
use std::ops::ControlFlow;

use glam::Affine3A;
use morph_collision::{Aabb, InputError, ModelError, QueryStats, TrianglePair, WeightsError};
use thiserror::Error;

pub use broad::BroadPhase;
pub use cast::{CastHit, CastRay};
pub use joint_nodes::{JointNode, JointNodes};
pub use kind::{MethodKind, UnknownMethod};
pub use limits::WeightLimits;
pub use options::MethodOptions;
pub use paper::{PaperOptions, PaperVolume, UnknownVolume};

/// How many intersecting pairs of triangles are wanted of two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// All of them.
    All,
    /// Any one.
    First,
    /// At most this many; there may be more. The search ends with the last one.
    UpTo(usize),
}

impl Wanted {
    /// The most pairs that are listed of two bodies.
    #[must_use]
    pub fn limit(self) -> usize {
        match self {
            Self::All => usize::MAX,
            Self::First => 1,
            Self::UpTo(limit) => limit,
        }
    }

    /// Appends a pair to those from `start` on; breaks once the list is as long as wanted.
    fn push(self, pairs: &mut Vec<TrianglePair>, start: usize, pair: TrianglePair) -> ControlFlow<()> {
        if pairs.len() - start < self.limit() {
            pairs.push(pair);
        }
        if pairs.len() - start < self.limit() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

/// A way to find the intersecting triangles of morphing and skinned bodies; see [`MethodKind::set_up`].
///
/// Bodies are numbered as they were set up. They start with all weights zero at the world's origin.
pub trait Method: Debug + Send + Sync {
    /// Makes ready, at no price to the method, what it is not judged by; only `rigid-floor` has anything of the kind. Says
    /// whether there was something to do.
    ///
    /// # Errors
    /// Weights that do not fit the mesh.
    fn prepare(&mut self, _body: usize, _weights: &[f32]) -> Result<bool, PoseError> {
        Ok(false)
    }

    /// Gives a body of a skinned mesh its joints: the matrices that take the mesh's space to world space. They take effect with the next
    /// [`Method::set_body`] or [`Method::blend`], whose place such a body ignores.
    ///
    /// # Errors
    /// A body or a method without joints, a wrong number of matrices, or an entry that is not finite; the body then keeps what it had.
    fn set_joints(&mut self, _body: usize, _world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        Err(PoseError::NoJoints)
    }

    /// Gives a body its weights, one per target, and its place: [`Method::blend`], and [`Method::refit`] if need be.
    ///
    /// # Errors
    /// Weights that do not fit the mesh or a place that is not finite; the body then keeps what it had.
    fn set_body(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<(), PoseError> {
        if self.blend(body, weights, world_from_model)? {
            self.refit(body);
        }
        Ok(())
    }

    /// The first half of [`Method::set_body`]: takes weights and place, and blends the vertices that have to follow at
    /// once. Says whether the volumes have to follow, too.
    ///
    /// # Errors
    /// As [`Method::set_body`].
    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError>;

    /// The second half: makes the volumes follow that have to follow at once.
    fn refit(&mut self, body: usize);

    /// Whether anything is left to follow when a query looks at it.
    fn is_lazy(&self) -> bool;

    /// A box in world space around a body, conservative: for a broad phase.
    fn world_bounds(&mut self, body: usize) -> Aabb;

    /// Appends the intersecting pairs of triangles of two bodies, in any order; no more than are wanted.
    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>);

    /// What a ray hits first of a body, which must have been given its pose. Methods that cast no rays
    /// ([`MethodKind::casts_rays`]) find nothing.
    fn cast(&mut self, _body: usize, _ray: &CastRay) -> Option<CastHit> {
        None
    }

    /// The work done since it was set up; volumes refitted and built count as blended.
    fn work(&self) -> QueryStats;
}

/// Why a method cannot be set up over a mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetUpError {
    /// A mesh is no good.
    #[error("mesh {mesh}: {reason}")]
    Model {
        /// Its index.
        mesh: usize,
        /// What is wrong.
        reason: ModelError,
    },
    /// A mesh is skinned, and the method knows no joints.
    #[error("mesh {mesh} is skinned, which {method} does not support")]
    Skinned {
        /// Its index.
        mesh: usize,
        /// The method.
        method: MethodKind,
    },
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] InputError),
    /// Parry refuses a mesh.
    #[error("mesh {mesh}: parry: {reason}")]
    Parry {
        /// Its index.
        mesh: usize,
        /// What Parry says.
        reason: String,
    },
    /// A body names a mesh that is not there.
    #[error("body {body} is of mesh {mesh}, there are {meshes}")]
    NoSuchMesh {
        /// The body.
        body: usize,
        /// The mesh that it names.
        mesh: usize,
        /// How many there are.
        meshes: usize,
    },
}

/// Why a body refuses a pose.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PoseError {
    /// The weights.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// The place, or the joints.
    #[error(transparent)]
    Place(#[from] InputError),
    /// Joints were given to a body that has none.
    #[error("the body has no joints")]
    NoJoints,
}
