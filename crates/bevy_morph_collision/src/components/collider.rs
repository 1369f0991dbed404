//! The components of colliders.

use std::ops::RangeInclusive;

use bevy::prelude::*;

use super::layers::MorphCollisionLayers;
use super::unit::MorphUnit;

/// The margins and tolerances that colliders may have.
pub(crate) const LENGTHS: RangeInclusive<f32> = 0.0..=1e30;

/// Makes the [`Mesh3d`] of this entity collide as it is drawn, with its current morph weights, joints and [`GlobalTransform`].
///
/// If the entity has a [`MorphShape`](crate::components::MorphShape), the shape collides and the mesh does not.
///
/// A mesh can have any affine transform: mirrored, sheared, or scaled by zero. A mesh with neither morph targets nor joints is
/// rigid.
///
/// A mesh with joint indices and weights on an entity with [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh) is placed by the
/// [`GlobalTransform`]s of its joints. Its own transform is ignored, as when Bevy draws it. Without `SkinnedMesh`, the mesh's own
/// transform places it.
///
/// - A joint without an inverse bind pose, or whose entity never existed, leaves its vertices where they are in the mesh.
/// - A joint that is despawned stays where it was.
/// - While the transform of a joint is NaN or infinite, the whole mesh stays where it was, and the log says so once.
///
/// For a glTF scene, put a [`MorphColliderScene`](crate::components::MorphColliderScene) on the entity that spawns it: its meshes are on entities
/// below. On an entity without a mesh, this component has no effect, and a warning in the log says so.
///
/// The collider takes part as soon as its mesh is loaded and the mesh's tree is built. While a newly assigned mesh is being
/// prepared, the collider is left out. [`MorphColliderDisabled`] takes it out temporarily.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
///     let hand = MorphCollider::new(MorphCollisionMode::Contacts).with_continuous(true);
///     commands.spawn((Mesh3d(meshes.add(Sphere::new(0.1))), hand));
/// }
/// # App::new().add_systems(Startup, spawn);
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform, MorphCollisionLayers)]
pub struct MorphCollider {
    /// How much detail contacts of this collider report.
    pub mode: MorphCollisionMode,
    /// Colliders count as touching up to this distance, in world units. The margins of both colliders are added. Not negative.
    #[reflect(@LENGTHS, @MorphUnit::Length)]
    pub margin: f32,
    /// How far the collider's points may move, in world units, before its pairs are compared again. Not negative. With 0, the
    /// default, pairs are compared after every movement.
    ///
    /// Until the plugin can no longer be sure that every point has moved by at most this distance, through weights, joints and
    /// transforms together, collisions see the collider in an earlier state; then they see its current state. A collider never
    /// lags by more than its own tolerance. Contacts are therefore exact for the two shapes displaced by at most their
    /// tolerances, and the error does not build up. Choose a value several times smaller than you could notice. A tolerance helps
    /// most with bodies that move little for their size, such as faces.
    ///
    /// Only collisions use the tolerance: spatial queries, anchors, bounds for culling and physics always see the current state.
    /// All other changes, such as of the mesh, layers, mode or body, take effect immediately.
    #[reflect(@LENGTHS, @MorphUnit::Length)]
    pub tolerance: f32,
    /// Whether pairs of this collider are also compared on the way from where they were in the last run to where they are now. Then
    /// fast motion, such as a bullet or a slap at a low frame rate, cannot go through others unnoticed.
    ///
    /// It is enough if one of two colliders is continuous; the motion of both counts. In between, every vertex moves on a straight
    /// line in the world. [`MorphContact::impact`](crate::contacts::MorphContact::impact) tells when and where a contact began. A contact that
    /// begins and ends between two runs is reported as started and then as ended, in the same run.
    ///
    /// Motion counts from one run to the next, with weights, joints and transforms together. It does not count
    ///
    /// - for a half-space, and for a [`MorphShape`](crate::components::MorphShape) that was one of another kind in the last run;
    /// - while collisions are paused, and for colliders that took no part in the last run (new, disabled, or with another mesh);
    /// - for entities that you put somewhere else: tell the plugin with [`MorphTeleported`](crate::components::MorphTeleported).
    ///
    /// The margin only counts where the colliders are now, not on the way. Straight lines flatten a mesh that turns far from one run to the
    /// next: half a turn leads through the axis. A shape keeps its form: its middle moves on a straight line while it turns, the shorter
    /// way round.
    ///
    /// Costs a second pose, and one query along the way for each pair that is close and did not touch.
    pub continuous: bool,
}

impl MorphCollider {
    /// Creates a collider without margin and tolerance that is not continuous.
    #[must_use]
    pub fn new(mode: MorphCollisionMode) -> Self {
        Self {
            mode,
            margin: 0.0,
            tolerance: 0.0,
            continuous: false,
        }
    }

    /// Sets the margin.
    #[must_use]
    pub fn with_margin(mut self, margin: f32) -> Self {
        self.margin = margin;
        self
    }

    /// Sets the tolerance.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f32) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Sets whether the collider is also compared on its way.
    #[must_use]
    pub fn with_continuous(mut self, continuous: bool) -> Self {
        self.continuous = continuous;
        self
    }

    /// Whether all fields are equal, bit by bit, so that a NaN margin equals itself.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let bits = |collider: &Self| [collider.margin, collider.tolerance].map(f32::to_bits);
        self.mode == other.mode && self.continuous == other.continuous && bits(self) == bits(other)
    }
}

/// How much detail a contact reports. If two colliders have different modes, the more detailed one applies.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[reflect(Debug, Default, Clone, PartialEq, Hash)]
pub enum MorphCollisionMode {
    /// Reports only what the other collider asks for. Two passive colliders are never compared. Use it for scenery, and for
    /// colliders that only serve spatial queries.
    Passive,
    /// One pair of intersecting triangles: the first one found.
    First,
    /// Every pair of intersecting triangles.
    #[default]
    All,
    /// Every pair of intersecting triangles, and up to four contact points with depths, deepest first.
    Contacts,
}

/// Takes a [`MorphCollider`] out of collisions and spatial queries while it is present. Its contacts end.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphColliderDisabled;
