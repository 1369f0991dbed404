//! What users put on entities that collide, and the plugin's own state beside it.

use bevy::prelude::*;
use morph_collision::{Aabb, PlacedShape, Pose, WorldFromModel};

use crate::import::TreeKey;
use crate::layers::MorphCollisionLayers;
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
    pub mode: CollisionMode,
    /// Colliders count as touching up to this distance, in world units; the margins of both are added up. Not negative.
    pub margin: f32,
}

impl MorphCollider {
    /// A collider without a margin.
    #[must_use]
    pub fn new(mode: CollisionMode) -> Self {
        Self { mode, margin: 0.0 }
    }

    /// The same with a margin.
    #[must_use]
    pub fn with_margin(mut self, margin: f32) -> Self {
        self.margin = margin;
        self
    }

    /// Whether all is equal, bit by bit: a margin that is not a number is equal to itself.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.mode == other.mode && self.margin.to_bits() == other.margin.to_bits()
    }
}

/// How much a contact tells. Of the two colliders of a pair the one that asks for more decides.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[reflect(Debug, Default, Clone, PartialEq, Hash)]
pub enum CollisionMode {
    /// Nothing is asked on this collider's own account: two passive colliders are never compared. For scenery, and for what
    /// only spatial queries look at.
    Passive,
    /// Only whether they touch. As cheap as [`CollisionMode::First`].
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

/// The body that a collider is part of, named by any entity, usually the root of its scene.
///
/// Colliders of one body never collide with each other. A collider without this component is a body of its own, and so is
/// one whose body is [`Entity::PLACEHOLDER`], the default.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphBody(#[entities] pub Entity);

impl Default for MorphBody {
    fn default() -> Self {
        Self(Entity::PLACEHOLDER)
    }
}

/// The plugin's state of one collider.
#[derive(Component, Default)]
pub(crate) struct ColliderState {
    /// Which tree it has, or waits for.
    pub(crate) tree: Option<TreeKey>,
    /// The instance of that tree; none while there is none.
    pub(crate) pose: Option<Pose>,
    /// Whether the pose is skinned and has joint matrices. A skinned pose without any takes no part.
    pub(crate) has_joints: bool,
    /// How it took part in the last run; none if it did not.
    pub(crate) placed: Option<Placement>,
    /// Its state one run earlier.
    pub(crate) before: Before,
    /// Whether the pose has other weights or joints, or is another one, than when its bounds were last asked for.
    pub(crate) reposed: bool,
    /// Whether anything an answer depends on differs from the last run.
    pub(crate) changed: bool,
    /// The run in which it was looked at last: while its entity is disabled nobody looks.
    pub(crate) seen: u32,
    /// What has been said about its weights, so that it is not logged every frame.
    pub(crate) bad_weights: BadWeights,
    /// Likewise about where and how large it is.
    pub(crate) bad_place: bool,
}

/// What the broad and narrow phases go by besides the pose.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub(crate) form: Form,
    pub(crate) body: Entity,
    pub(crate) mode: CollisionMode,
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
