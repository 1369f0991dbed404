//! The component that lists where a mesh intersects itself.

use bevy::prelude::*;
use morph_collision::TrianglePair;

/// Reports where the mesh of a [`MorphCollider`](crate::components::MorphCollider) intersects itself: lips and teeth, a hand in the hip.
///
/// Put it on the entity of a mesh collider of any mode, also a passive one. The plugin updates it in every run and sends [`MorphSelfCollisionStart`](crate::self_collisions::MorphSelfCollisionStart) and [`MorphSelfCollisionEnd`](crate::self_collisions::MorphSelfCollisionEnd).
///
/// Touching triangles are grouped into [regions](MorphSelfContact). Two triangles with a common vertex never count, although they
/// always touch. The answer is exact for the mesh as it is drawn now, whatever the collider's margin and tolerance are. Different
/// meshes of a character are different colliders: this does not compare a body with its clothes.
///
/// Costs one query over the tree of the mesh whenever its weights or joints change: for a head of 9534 triangles with 52 targets
/// that talks, ten million instructions, or about six with [`prove`](Self::prove). The joints of a character that walks change in every frame. The first query of a mesh also
/// finds what intersects at rest.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn warn(mut started: MessageReader<MorphSelfCollisionStart>) {
///     for start in started.read() {
///         warn!("{} runs into itself at {}", start.collider, start.point);
///     }
/// }
///
/// # fn spawn(mut commands: Commands, face: Handle<Mesh>) {
/// commands.spawn((Mesh3d(face), MorphCollider::default(), MorphSelfCollisions::default()));
/// # }
/// # bevy::ecs::system::assert_is_system(warn);
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphSelfCollisions {
    /// Whether to report also pairs of triangles that intersect at rest. By default they are left out: eyes lie in their sockets, and
    /// hair reaches into the scalp.
    ///
    /// At rest, all morph weights are 0, the joints are as they were bound, and the character stands at the world's origin. If the
    /// joint weights of each vertex sum to 1, this is the shape in the file, and it is the same shape wherever the character stands.
    /// Otherwise Bevy draws another shape at each place ([docs/skinning.md]), and none of them may look like the one at rest. Then
    /// what is left out is not what you expect; a warning in the log names the mesh. Normalise its joint weights, or set this to
    /// `true`.
    ///
    /// [docs/skinning.md]: https://github.com/morph-collision/morph_collision/blob/main/docs/skinning.md#a-skinned-vertex
    pub include_rest: bool,
    /// Whether to prove in the background which triangles never touch for any weights from 0 to 1, and to leave them out from then
    /// on, while all weights are in that range. Reports stay the same.
    ///
    /// A talking head then takes two thirds of the time per run, a body whose face talks a fifth. The proof takes a thread several seconds,
    /// once for each mesh, and about 56 bytes for each node of the tree and target that moves it while it runs. It does nothing for skinned
    /// meshes, and where the game has only one thread, as on the web.
    pub prove: bool,
    pub(super) regions: Vec<MorphSelfContact>,
    pub(super) is_truncated: bool,
}

impl MorphSelfCollisions {
    /// Sets whether to report also what intersects at rest.
    #[must_use]
    pub fn with_rest(mut self, include_rest: bool) -> Self {
        self.include_rest = include_rest;
        self
    }

    /// Sets whether to prove what cannot touch.
    #[must_use]
    pub fn with_proof(mut self, prove: bool) -> Self {
        self.prove = prove;
        self
    }

    /// Where the mesh intersects itself now, in ascending order of [`MorphSelfContact::region`].
    #[must_use]
    pub fn regions(&self) -> &[MorphSelfContact] {
        &self.regions
    }

    /// Whether more pairs of triangles intersect than are listed. The limit is
    /// [`MorphCollisionSettings::max_triangle_pairs`](crate::components::MorphCollisionSettings). Which pairs are listed then depends on the
    /// tree, so regions may end although they still intersect.
    #[must_use]
    pub fn is_truncated(&self) -> bool {
        self.is_truncated
    }
}

/// A connected part of a mesh that intersects itself: pairs of triangles that share vertices with each other.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphSelfContact {
    /// The number of the region. It keeps its number as long as some of its triangles keep touching others. If two regions grow
    /// together, the older one goes on and the other ends.
    pub region: u32,
    /// The mean of the middles of its triangles, in world space.
    pub point: Vec3,
    /// The pairs of intersecting triangles, sorted; the smaller number first. Numbered as in
    /// [`MorphContact::triangles`](crate::contacts::MorphContact::triangles), and never empty unless created by reflection.
    #[reflect(ignore)]
    pub triangles: Vec<TrianglePair>,
}
