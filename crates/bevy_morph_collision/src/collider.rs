//! What users put on entities that collide, and the plugin's own state beside it.

use std::sync::{Mutex, MutexGuard, PoisonError};

use bevy::prelude::*;
use morph_collision::{Aabb, PlacedShape, Pose, WorldFromModel};

use crate::import::TreeKey;
use crate::layers::MorphCollisionLayers;
use crate::readiness::Told;
use crate::tolerance::Held;
use crate::velocities::Before;
use crate::weights::BadWeights;

/// Makes the [`Mesh3d`] of this entity collide as it is drawn: at its current morph weights and joints, at its current [`GlobalTransform`].
///
/// If the entity has a [`MorphShape`](crate::MorphShape), the shape collides and the mesh does not.
///
/// Any affine transform will do for a mesh: mirrored, sheared, scaled by zero. A mesh with neither morph targets nor joints is rigid.
///
/// A mesh with joint indices and weights on an entity with [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh) is where its joints' [`GlobalTransform`]s place it; its own is
/// ignored, as it is when Bevy draws it. A joint without an inverse bind pose, or whose entity never existed, leaves vertices as they are; a joint that
/// is despawned stays where it was. While the transform of a joint is NaN or infinite, the whole mesh stays where it was, and the log
/// says so once. Without `SkinnedMesh`, the mesh is where its own transform says.
///
/// The collider takes part as soon as its mesh is loaded and the mesh's tree is built; while a swapped mesh is being prepared,
/// it is left out. [`MorphColliderDisabled`] takes it out for a while.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform, MorphCollisionLayers, ColliderState)]
pub struct MorphCollider {
    /// How much a contact of this collider should tell.
    pub mode: MorphCollisionMode,
    /// Colliders count as touching up to this distance, in world units; the margins of both are added up. Not negative.
    pub margin: f32,
    /// How far its points may move, in world units, before its pairs are compared again; not negative. 0, the default, compares them
    /// whenever anything has moved.
    ///
    /// Collisions see the collider as it was at an earlier moment until the plugin can no longer be sure that weights, joints and places together have
    /// moved every point by at most this; then they see it as it is. Each collider lags by its own tolerance at most, so contacts are exact for the two shapes displaced by at
    /// most their tolerances, and do not drift. Choose a few times less than you could notice. It helps bodies that move little for their size, such as faces.
    ///
    /// It concerns nothing but collisions: spatial queries, anchors, bounds for culling and physics follow the collider as it is. All other changes, such as
    /// those of its mesh, layers, mode or body, count at once.
    pub tolerance: f32,
}

impl MorphCollider {
    /// A collider without a margin and without a tolerance.
    #[must_use]
    pub fn new(mode: MorphCollisionMode) -> Self {
        Self {
            mode,
            margin: 0.0,
            tolerance: 0.0,
        }
    }

    /// The same with a margin.
    #[must_use]
    pub fn with_margin(mut self, margin: f32) -> Self {
        self.margin = margin;
        self
    }

    /// The same with a tolerance.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f32) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Whether all is equal, bit by bit: a margin that is not a number is equal to itself.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let bits = |collider: &Self| [collider.margin, collider.tolerance].map(f32::to_bits);
        self.mode == other.mode && bits(self) == bits(other)
    }
}

/// How much a contact tells. Of the two colliders of a pair the one that asks for more decides.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[reflect(Debug, Default, Clone, PartialEq, Hash)]
pub enum MorphCollisionMode {
    /// Nothing is asked on this collider's own account: two passive colliders are never compared. For scenery, and for what
    /// only spatial queries look at.
    Passive,
    /// Only whether they touch. As cheap as [`MorphCollisionMode::First`].
    Any,
    /// One pair of intersecting triangles, the first that is found.
    First,
    /// Every pair of intersecting triangles.
    #[default]
    All,
    /// Every pair of intersecting triangles, and up to four points of contact with their depths, the deepest first.
    Contacts,
}

/// Takes a [`MorphCollider`] out of collisions and spatial queries until it is removed; its contacts end.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphColliderDisabled;

/// The plugin's state of one collider.
#[derive(Component, Default)]
pub(crate) struct ColliderState {
    /// Which tree it has, or waits for.
    pub(crate) tree: Option<TreeKey>,
    /// The instance of that tree; none while there is none.
    pub(crate) pose: Option<LockedPose>,
    /// Whether the pose is skinned and has joint matrices. A skinned pose without any takes no part.
    pub(crate) has_joints: bool,
    /// How it took part in the last run; none if it did not.
    pub(crate) placed: Option<Placement>,
    /// How collisions see it, if that may be another state than the one it is in.
    pub(crate) held: Option<Box<Held>>,
    /// Its state one run earlier.
    pub(crate) before: Before,
    /// Whether the pose has other weights or joints, or is another one, than when its bounds were last asked for.
    pub(crate) reposed: bool,
    /// Whether anything an answer depends on differs from the last run. With a tolerance: whether collisions see it in another state.
    pub(crate) changed: bool,
    /// The run in which it was looked at last: while its entity is disabled nobody looks.
    pub(crate) seen: u32,
    /// What has been said about its weights, so that it is not logged every frame.
    pub(crate) bad_weights: BadWeights,
    /// Likewise about where and how large it is.
    pub(crate) bad_place: bool,
    /// Which of the events that it is ready, or never will be, it has had.
    pub(crate) told: Told,
}

/// A pose that queries refit though they only read: the lock is for those of other systems that ask at the same time.
pub(crate) struct LockedPose(Mutex<Pose>);

impl LockedPose {
    pub(crate) fn new(pose: Pose) -> Self {
        Self(Mutex::new(pose))
    }

    /// Without a lock.
    pub(crate) fn get_mut(&mut self) -> &mut Pose {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Do not ask for another pose while this one is locked, but in ascending order of entities.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Pose> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ColliderState {
    pub(crate) fn pose_mut(&mut self) -> Option<&mut Pose> {
        self.pose.as_mut().map(LockedPose::get_mut)
    }
}

/// What the broad and narrow phases go by besides the pose.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub(crate) form: Form,
    pub(crate) body: Entity,
    pub(crate) mode: MorphCollisionMode,
    pub(crate) layers: MorphCollisionLayers,
    pub(crate) margin: f32,
    /// In world space, the margin not included.
    pub(crate) bounds: Aabb,
}

/// What is where.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Form {
    /// For a skinned mesh the identity: its joints place it.
    Mesh(WorldFromModel),
    Shape(PlacedShape),
}

impl Placement {
    pub(crate) fn bounds_with_margin(&self) -> Aabb {
        let Aabb { min, max } = self.bounds;
        if self.margin == 0.0 {
            return self.bounds;
        }
        // Outward by what subtraction rounds.
        Aabb {
            min: (min - self.margin).map(f32::next_down),
            max: (max + self.margin).map(f32::next_up),
        }
    }
}

/// Takes over a new value for a component that the plugin gave, and returns whether to write it: it differs, and the
/// user has not changed or removed what was given. `new` if it is given for the first time.
pub(crate) fn follows<C: Copy>(
    new: bool,
    given: &mut C,
    now: Option<&C>,
    wanted: C,
    is_same: impl Fn(&C, &C) -> bool,
) -> bool {
    let unchanged = now.map_or(new, |now| is_same(now, given));
    let differs = now.is_none_or(|now| !is_same(now, &wanted));
    *given = wanted;
    unchanged && differs
}

/// Removes the plugin's state together with [`MorphCollider`].
pub(crate) fn forget_collider(removed: On<Remove<MorphCollider>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<ColliderState>();
}
