//! The methods that `morph_collision` is compared with, over the same meshes and with the same answers.
//!
//! A [`Method`] holds the bodies of a scene. In every frame each body gets its weights and placement, and then pairs of bodies
//! are queried for their intersecting triangles. All methods decide triangles by the same exact test,
//! [`morph_collision::triangles_intersect`], over the same vertices; only the oracle has its own test. So they must agree pair
//! for pair and differ only in their work:
//!
//! | [`MethodKind`] | cost of a frame before any query | from |
//! |---|---|---|
//! | `morph` | nothing | this project |
//! | `bottom-up` | poses every vertex, refits every box | van den Bergen 1997 |
//! | `hybrid` | poses every vertex, refits the upper half of the tree; the rest when a walk reaches it | Larsson, Akenine-Moller 2001 |
//! | `rigid-floor` | nothing: every shape has its own tree, made beforehand, and skinned meshes are completely posed beforehand; a floor, not a rival | |
//! | `paper` | nothing | Larsson, Akenine-Moller 2003: the method on which this project is based, as published |
//! | `bottom-up-scalar`, `hybrid-scalar` | the same, as usually written: one vertex, box and triangle at a time, in plain loops | |
//! | `joint-boxes` | nothing: a node's box encloses the images of boxes under its joints, one for each joint around the vertices that it moves | Bevy's bounds of skinned meshes, for every node |
//! | `parry-trimesh` | blends every vertex in place, refits the tree of a `TriMesh` | Parry |
//! | `brute-force` | blends every vertex and places it in the world | the oracle |
//!
//! All methods but `paper` support skinned meshes. When joints have moved, all but ours and `joint-boxes`
//! place every vertex (`skin`).
//!
//! The comparison is fair to all of them: vertices are welded, targets with weight zero and vertices that a target does not move
//! are skipped, and a body whose weights stay the same is not refitted. `bottom-up` and `hybrid` use the core's trees, kernels, walks and
//! tests of triangles ([`Pose::refit`](morph_collision::Pose::refit), [`Pose::refit_lazily`](morph_collision::Pose::refit_lazily)), so they
//! differ from `morph` only in the method. Their scalar forms share one tree (`tree`), eight-wide like the core's, and one walk (`walk`)
//! with the same SAT-lite culling (`boxes`, `frames`). How much faster the same method is with the core's code says how much of a ratio to
//! them is engineering. `paper` follows the paper: one triangle per leaf, one pair of nodes at a time, in `f64`. Its counts are comparable with those of the
//! others; its times would gain from the engineering that the others have.
//!
//! ```
//! use glam::{Affine3A, Vec3};
//! use morph_collision_models::generated::dolphin;
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
mod morph;
mod node;
mod options;
mod paper;
mod parry;
mod relative;
mod rigid_floor;
mod skin;
mod tree;
mod walk;
pub mod within;

use std::fmt::Debug;
use std::ops::ControlFlow;

use glam::Affine3A;
use morph_collision::{Aabb, InputError, ModelError, QueryStats, TrianglePair, WeightsError};
use thiserror::Error;

pub use broad::BroadPhase;
pub use cast::{CastHit, CastRay};
pub use joint_nodes::JointNodes;
pub use kind::{MethodKind, UnknownMethod};
pub use morph_collision::batch::Wanted;
pub use node::RivalNode;
pub use options::MethodOptions;
pub use paper::{PaperOptions, PaperVolume, UnknownVolume};

/// Appends a pair to those from `start` on; breaks once the list is as long as wanted.
fn push(wanted: Wanted, pairs: &mut Vec<TrianglePair>, start: usize, pair: TrianglePair) -> ControlFlow<()> {
    let most = wanted.limit();
    if pairs.len() - start < most {
        pairs.push(pair);
    }
    if pairs.len() - start < most {
        ControlFlow::Continue(())
    } else {
        ControlFlow::Break(())
    }
}

/// A method to find the intersecting triangles of morphing and skinned bodies; see [`MethodKind::set_up`].
///
/// Bodies are numbered in the order of set-up. They start with all weights zero at the world's origin.
pub trait Method: Debug + Send + Sync {
    /// Prepares, outside of all measurements, data that is not part of the method's cost; only `rigid-floor` needs this. `joints` are
    /// those of a skinned mesh; without them, a body keeps its own. Returns whether there was anything to do.
    ///
    /// # Errors
    /// The weights or the joints do not fit the mesh.
    fn prepare(&mut self, _body: usize, _weights: &[f32], _joints: Option<&[Affine3A]>) -> Result<bool, PoseError> {
        Ok(false)
    }

    /// Sets the joints of a body with a skinned mesh: the matrices that map mesh space to world space. They take effect with the
    /// next [`Method::set_body`] or [`Method::blend`], whose placement is ignored for such a body.
    ///
    /// # Errors
    /// The body or the method has no joints, the number of matrices is wrong, or an entry is not finite. The body then keeps its
    /// old joints.
    fn set_joints(&mut self, _body: usize, _world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        Err(PoseError::NoJoints)
    }

    /// Sets a body's weights, one per target, and its placement: calls [`Method::blend`], and [`Method::refit`] if necessary.
    ///
    /// # Errors
    /// The weights do not fit the mesh, or the placement is not finite. The body then keeps its old state.
    fn set_body(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<(), PoseError> {
        if self.blend(body, weights, world_from_model)? {
            self.refit(body);
        }
        Ok(())
    }

    /// The first half of [`Method::set_body`]: sets weights and placement, and blends the vertices, unless the method does so on
    /// demand. Returns whether the volumes need [`Method::refit`].
    ///
    /// # Errors
    /// See [`Method::set_body`].
    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError>;

    /// The second half: updates the volumes, except those that are updated on demand.
    fn refit(&mut self, body: usize);

    /// Whether volumes or vertices are updated on demand during a query.
    fn is_lazy(&self) -> bool;

    /// A conservative world-space box around a body, for a broad phase.
    fn world_bounds(&mut self, body: usize) -> Aabb;

    /// Appends the intersecting pairs of triangles of two bodies, in any order and at most as many as wanted.
    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>);

    /// The first hit of a ray on a body, whose pose must have been set. Methods that cast no rays ([`MethodKind::casts_rays`])
    /// find nothing.
    fn cast(&mut self, _body: usize, _ray: &CastRay) -> Option<CastHit> {
        None
    }

    /// The work done since set-up; refitted and built volumes count as blended.
    fn work(&self) -> QueryStats;
}

/// Why a method cannot be set up for a mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetUpError {
    /// A mesh is invalid.
    #[error("mesh {mesh}: {reason}")]
    Model {
        /// Its index.
        mesh: usize,
        /// The problem.
        reason: ModelError,
    },
    /// A mesh is skinned, and the method does not support joints.
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
        /// Parry's error.
        reason: String,
    },
    /// A body names a mesh that does not exist.
    #[error("body {body} is of mesh {mesh}, there are {meshes}")]
    NoSuchMesh {
        /// The body.
        body: usize,
        /// The mesh that it names.
        mesh: usize,
        /// Number of meshes.
        meshes: usize,
    },
}

/// Why a body refuses a pose.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PoseError {
    /// The weights are invalid.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// The placement or the joints are invalid.
    #[error(transparent)]
    Place(#[from] InputError),
    /// Joints were given to a body that has none.
    #[error("the body has no joints")]
    NoJoints,
}
