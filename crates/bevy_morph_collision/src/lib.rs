//! Bevy plugin: exact collision detection for meshes deformed by morph targets (blend shapes) and by joints (skinned meshes).
//!
//! A collision tree is built once per mesh *asset*, in the background, and shared by every entity that shows the mesh.
//! Each frame the tree is refitted to an entity's morph weights and joints, where and only where a query looks at it. Answers are
//! those of [`morph_collision`]: exact, over the vertices that the mesh really has at these weights, where these joints put them.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_morph_collision::prelude::*;
//!
//! fn main() {
//!     App::new()
//!         // With a window and a renderer this is `DefaultPlugins`.
//!         .add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin))
//!         .add_plugins(MorphCollisionPlugin)
//!         .add_systems(Startup, |mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>| {
//!             let mesh = meshes.add(Sphere::new(1.0).mesh().ico(3).unwrap());
//!             commands.spawn((Mesh3d(mesh.clone()), MorphCollider::default()));
//!             commands.spawn((Mesh3d(mesh), Transform::from_xyz(1.5, 0.0, 0.0), MorphCollider::default()));
//!         })
//!         .add_systems(Update, |mut starts: MessageReader<MorphCollisionStart>| {
//!             for start in starts.read() {
//!                 println!("{} touches {}", start.collider1, start.collider2);
//!             }
//!         })
//!         .run();
//! }
//! ```
//!
//! # The pipeline
//!
//! Trees are kept in [`PostUpdate`](bevy::prelude::PostUpdate), and so by default is the rest, after animation and transform propagation; it can run
//! in another schedule ([`MorphCollisionPlugin::in_schedule`]). In the order of [`MorphCollisionSystems`]:
//!
//! 1. **Import** (`scene`, `every_mesh`, `import`): parts of a [`MorphColliderScene`] become colliders; meshes become trees. Before that,
//!    while Bevy loads a glTF file, meshes without normals are repaired (feature `gltf`, on by default).
//! 2. **Weights** (`weights`, `joints`, `skeletons`): every collider's pose takes the weights in force, and the matrices of its joints.
//! 3. **Broad phase** (`broad_phase`): boxes around whole colliders in world space; pairs whose boxes overlap, and which
//!    [`MorphCollisionLayers`] and [`CollisionMode`]s let through, go on.
//! 4. **Narrow phase** (`narrow_phase`, `contacts`): exact triangle pairs and contacts, into [`MorphCollisions`].
//! 5. **Events** (`events`, `changes`): what started and ended since the last run; [`MorphCollidingEntities`].
//! 6. **Anchors** (`anchors`): entities with a [`MorphSurfaceAnchor`] go where their triangle is drawn; always in
//!    [`PostUpdate`](bevy::prelude::PostUpdate).
//!
//! Each stage adds to [`MorphCollisionDiagnostics`]. Where nothing changed nothing is done: weights, joints and places are compared by
//! value, a pair of which neither collider changed keeps its answer, and a frame in which none did costs a look at each.
//!
//! Beside the pipeline, each by itself:
//!
//! - [`MorphSpatialQuery`] (`spatial`): rays, overlaps, closest points, contacts, posed vertices, for any system.
//! - [`MorphBoundsPlugin`] (`bounds`): the `Aabb` that Bevy culls morphing and skinned meshes by.
//! - `MorphPickingPlugin` (`picking`, feature `picking`): pointers hit what is drawn.
//! - `MorphGizmosPlugin` (`gizmos`, feature `gizmos`): boxes of trees, contacts, touching triangles, drawn.
//! - `MorphRapierPlugin` (`rapier`, feature `rapier`): rigid bodies of `bevy_rapier3d` feel the surface.
//! - `MorphCollisionDiagnosticsPlugin` (feature `diagnostics`): the counts in Bevy's `DiagnosticsStore`.
//!
//! # What it needs
//!
//! `AssetPlugin`, `MeshPlugin` and `TransformPlugin`, which are all among `DefaultPlugins`. Meshes must stay in main memory
//! (`RenderAssetUsages::default()`, not `RENDER_WORLD` alone) with uncompressed positions. Data that cannot be used is
//! logged once as an error with the mesh's and the entity's name, and only that entity is left out.
//!
//! # What works with which mesh
//!
//! | | rigid | morph targets | joints | both |
//! |---|---|---|---|---|
//! | events, layers, modes, contacts | yes | yes | yes | yes |
//! | rays, overlaps, closest points, posed vertices, velocities of the surface | yes | yes | yes, a hit names the joint | yes, a hit names the joint |
//! | picking, surface anchors, debug drawing | yes | yes | yes | yes |
//! | `Aabb` (`MorphBoundsPlugin`) | Bevy's own | yes | yes | yes |
//! | physics (`MorphRapierCollider`) | yes | yes | yes | yes |
//!
//! A mesh has joints if it has `Mesh::ATTRIBUTE_JOINT_INDEX` and `Mesh::ATTRIBUTE_JOINT_WEIGHT` and its entity has
//! [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh). It is where its joints' `GlobalTransform`s, after propagation, and the inverse bind poses put it; see
//! [`MorphCollider`] for joints that are missing or bad. All joints are followed. On targets without storage buffers (WebGL 2), Bevy draws only the
//! first 256 of a skeleton right.
#![forbid(unsafe_code)]
// docs.rs says which feature has what.
#![cfg_attr(docsrs, feature(doc_cfg))]
// Systems say in their parameters what they ask for.
#![allow(clippy::type_complexity, clippy::too_many_arguments)]

mod anchors;
mod bounds;
mod broad_phase;
mod changes;
mod collider;
mod contacts;
mod diagnostics;
mod events;
mod every_mesh;
#[cfg(feature = "gizmos")]
mod gizmos;
mod import;
mod joints;
mod layers;
mod lent_poses;
mod narrow_phase;
#[cfg(feature = "picking")]
mod picking;
mod plugin;
#[cfg(feature = "rapier")]
mod rapier;
mod scene;
mod settings;
mod shape;
mod skeletons;
mod spatial;
mod velocities;
mod weights;
mod workers;

pub use anchors::MorphSurfaceAnchor;
pub use bounds::{MorphBoundsPlugin, MorphBoundsSystems};
pub use collider::{CollisionMode, MorphBody, MorphCollider, MorphColliderDisabled};
pub use contacts::{MorphCollisions, MorphContact, MorphContactPoint};
pub use diagnostics::MorphCollisionDiagnostics;
#[cfg(feature = "diagnostics")]
pub use diagnostics::MorphCollisionDiagnosticsPlugin;
pub use events::{MorphCollidingEntities, MorphCollisionEnd, MorphCollisionEventsEnabled, MorphCollisionStart};
#[cfg(feature = "gizmos")]
pub use gizmos::{MorphGizmos, MorphGizmosPlugin};
pub use import::{ImportError, MorphTreeOptions, MorphTreeSettings, MorphTrees};
pub use layers::MorphCollisionLayers;
pub use morph_collision;
pub use morph_collision::{BuildOptions, Facing, InputError, QueryStats, TrianglePair};
#[cfg(feature = "picking")]
pub use picking::{MorphPick, MorphPickingPlugin, MorphPickingSettings};
pub use plugin::{MorphCollisionIn, MorphCollisionPlugin, MorphCollisionSystems};
#[cfg(feature = "rapier")]
pub use rapier::{
    MorphQueryDispatcher, MorphRapierCollider, MorphRapierDiagnostics, MorphRapierIn, MorphRapierPlugin,
    MorphRapierSystems, MorphSurface,
};
pub use scene::MorphColliderScene;
pub use settings::MorphCollisionSettings;
pub use shape::MorphShape;
pub use spatial::{
    MorphClosestPoints, MorphContacts, MorphProjection, MorphQueryFilter, MorphRayHit, MorphSpatialQuery,
};
pub use workers::TaskPoolWorkers;

/// What a program that uses the plugin needs by name.
pub mod prelude {
    pub use crate::{
        CollisionMode, MorphBody, MorphBoundsPlugin, MorphCollider, MorphColliderDisabled, MorphColliderScene,
        MorphCollidingEntities, MorphCollisionDiagnostics, MorphCollisionEnd, MorphCollisionEventsEnabled,
        MorphCollisionLayers, MorphCollisionPlugin, MorphCollisionSettings, MorphCollisionStart, MorphCollisionSystems,
        MorphCollisions, MorphContact, MorphQueryFilter, MorphRayHit, MorphShape, MorphSpatialQuery,
        MorphSurfaceAnchor, MorphTreeOptions, MorphTreeSettings, TrianglePair,
    };
    #[cfg(feature = "gizmos")]
    pub use crate::{MorphGizmos, MorphGizmosPlugin};
    #[cfg(feature = "picking")]
    pub use crate::{MorphPick, MorphPickingPlugin};
    #[cfg(feature = "rapier")]
    pub use crate::{MorphRapierCollider, MorphRapierDiagnostics, MorphRapierPlugin};
}

/// The README's snippets, compiled; one of them is about Rapier.
#[cfg(all(doctest, feature = "rapier"))]
#[doc = include_str!("../README.md")]
struct Readme;
