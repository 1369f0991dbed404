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
//!         .add_plugins(MorphPlugins::default())
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
//! in another schedule ([`MorphCollisionPlugin::new`]). In the order of [`MorphCollisionSystems`]:
//!
//! 1. **Import** (`scene`, `every_mesh`, `body_roots`, `import`): parts of a [`MorphColliderScene`] become colliders of a body; meshes become trees. Before that,
//!    while Bevy loads a glTF file, meshes without normals are repaired (feature `gltf`, on by default).
//! 2. **Weights** (`velocities`, `weights`, `joints`, `skeletons`): what a collider was like in the last run is remembered, then its pose takes the weights in force,
//!    and the matrices of its joints.
//! 3. **Broad phase** (`broad_phase`): boxes around whole colliders in world space; pairs whose boxes overlap, and which
//!    [`MorphCollisionLayers`] and [`MorphCollisionMode`]s let through, go on.
//! 4. **Narrow phase** (`narrow_phase`, `contacts`, `body_pairs`): exact triangle pairs and contacts, into [`MorphCollisions`], by
//!    colliders and by bodies.
//! 5. **Events** (`events`, `body_events`, `changes`): what started and ended since the last run, of colliders and of bodies;
//!    [`MorphCollidingEntities`].
//! 6. **Anchors** (`anchors`): entities with a [`MorphSurfaceAnchor`] go where their triangle is drawn; always in
//!    [`PostUpdate`](bevy::prelude::PostUpdate).
//!
//! Each stage adds to [`MorphCollisionDiagnostics`]. Where nothing changed nothing is done: weights, joints and places are compared by
//! value, a pair of which neither collider changed keeps its answer, and a frame in which none did costs a look at each. With a
//! [`tolerance`](MorphCollider::tolerance), small movements are no change (`tolerance`).
//!
//! Beside the pipeline, each by itself:
//!
//! - [`MorphSpatialQuery`] (`spatial`): rays, shape casts, intersections, closest points, contacts, posed vertices, for any number of systems at a time.
//! - [`MorphColliderReady`], [`MorphColliderFailed`], [`MorphColliderSceneReady`] (`readiness`), and [`MorphTrees::progress`] for loading screens.
//! - [`MorphBoundsPlugin`] (`bounds`): the `Aabb` that Bevy culls morphing and skinned meshes by.
//! - `MorphPickingPlugin` (`picking`, feature `picking`): pointers hit what is drawn.
//! - `MorphGizmosPlugin` (`gizmos`, feature `gizmos`): boxes of trees, contacts, touching triangles, drawn.
//! - `MorphRapierPlugin` (`rapier`, feature `rapier`): rigid bodies and character controllers of `bevy_rapier3d` feel the surface.
//! - `MorphAvianPlugin` (`avian`, feature `avian`): rigid bodies of `avian3d` feel the surface.
//! - `MorphCollisionDiagnosticsPlugin` (feature `diagnostics`): the counts in Bevy's `DiagnosticsStore`.
//!
//! [`MorphPlugins`] (`plugins`) adds all of these at once.
//!
//! # Bodies
//!
//! A *body* is a collider, or an entity with several colliders (`body`): each of them names it with [`MorphColliderOf`], and it lists them in
//! [`MorphColliders`]. Parts of a [`MorphColliderScene`] are colliders of its root. Colliders of one body never collide with each other.
//! [`MorphBodyCollisionStart`] and [`MorphBodyCollisionEnd`] report each touch of two bodies once, however many of their colliders
//! touch, as messages and to observers of the bodies. [`MorphCollisionStart`] and [`MorphCollisionEnd`] report every pair of colliders.
//!
//! # What it needs
//!
//! `AssetPlugin`, `MeshPlugin` and `TransformPlugin`, which are all among `DefaultPlugins`. Meshes must stay in main memory
//! (`RenderAssetUsages::default()`, not `RENDER_WORLD` alone). They may be compressed (`GltfPlugin::mesh_compression`). Data that cannot be used is
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
//! | physics (`MorphRapierCollider`, `MorphAvianCollider`) | yes | yes | yes | yes |
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
#[cfg(feature = "avian")]
mod avian;
mod body;
mod body_events;
mod body_pairs;
mod body_roots;
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
// Each engine uses its own part of it.
#[cfg(any(feature = "rapier", feature = "avian"))]
#[cfg_attr(not(all(feature = "rapier", feature = "avian")), allow(dead_code))]
mod physics;
#[cfg(feature = "picking")]
mod picking;
mod plugin;
mod plugins;
#[cfg(feature = "rapier")]
mod rapier;
mod readiness;
mod scene;
mod settings;
mod shape;
mod skeletons;
mod spatial;
mod tolerance;
mod velocities;
mod weights;
mod workers;

pub use anchors::MorphSurfaceAnchor;
#[cfg(feature = "avian")]
pub use avian::{
    MorphAvianCollider, MorphAvianDiagnostics, MorphAvianPart, MorphAvianPlugin, MorphAvianScene, MorphAvianSystems,
};
pub use body::{MorphBodyRoot, MorphColliderOf, MorphColliders};
pub use body_events::{MorphBodyCollisionEnd, MorphBodyCollisionStart};
pub use bounds::{MorphBoundsPlugin, MorphBoundsSystems};
pub use collider::{MorphCollider, MorphColliderDisabled, MorphCollisionMode};
pub use contacts::{MorphCollisions, MorphContact, MorphContactPoint};
pub use diagnostics::MorphCollisionDiagnostics;
#[cfg(feature = "diagnostics")]
pub use diagnostics::MorphCollisionDiagnosticsPlugin;
pub use events::{MorphCollidingEntities, MorphCollisionEnd, MorphCollisionEventsEnabled, MorphCollisionStart};
#[cfg(feature = "gizmos")]
pub use gizmos::{MorphGizmos, MorphGizmosPlugin};
pub use import::{DefaultMorphTreeSettings, ImportError, MorphTreeProgress, MorphTreeSettings, MorphTrees};
pub use layers::MorphCollisionLayers;
pub use morph_collision;
pub use morph_collision::{BuildOptions, Facing, InputError, QueryStats, TrianglePair};
#[cfg(feature = "picking")]
pub use picking::{MorphPick, MorphPickingPlugin, MorphPickingSettings};
pub use plugin::{MorphCollisionPlugin, MorphCollisionSystems};
pub use plugins::MorphPlugins;
#[cfg(feature = "rapier")]
pub use rapier::{
    MorphCharacterCarry, MorphCharacterGround, MorphQueryDispatcher, MorphRapierCollider, MorphRapierDiagnostics,
    MorphRapierPlugin, MorphRapierScene, MorphRapierSystems, MorphRapierVelocity, MorphSurface,
};
pub use readiness::{MorphColliderFailed, MorphColliderReady, MorphColliderSceneReady};
pub use scene::MorphColliderScene;
pub use settings::MorphCollisionSettings;
pub use shape::MorphShape;
pub use spatial::{
    MorphClosestPoints, MorphManifold, MorphProjection, MorphQueryFilter, MorphRayHit, MorphShapeHit, MorphSpatialQuery,
};
pub use workers::TaskPoolWorkers;

/// What a program that uses the plugin needs by name.
pub mod prelude {
    #[cfg(feature = "diagnostics")]
    pub use crate::MorphCollisionDiagnosticsPlugin;
    pub use crate::{BuildOptions, Facing, MorphClosestPoints, MorphManifold, MorphProjection};
    pub use crate::{
        DefaultMorphTreeSettings, MorphBodyCollisionEnd, MorphBodyCollisionStart, MorphBodyRoot, MorphBoundsPlugin,
        MorphCollider, MorphColliderDisabled, MorphColliderOf, MorphColliderScene, MorphColliders,
        MorphCollidingEntities, MorphCollisionDiagnostics, MorphCollisionEnd, MorphCollisionEventsEnabled,
        MorphCollisionLayers, MorphCollisionMode, MorphCollisionPlugin, MorphCollisionSettings, MorphCollisionStart,
        MorphCollisionSystems, MorphCollisions, MorphContact, MorphContactPoint, MorphPlugins, MorphQueryFilter,
        MorphRayHit, MorphShape, MorphShapeHit, MorphSpatialQuery, MorphSurfaceAnchor, MorphTreeSettings, TrianglePair,
    };
    pub use crate::{
        ImportError, MorphColliderFailed, MorphColliderReady, MorphColliderSceneReady, MorphTreeProgress, MorphTrees,
    };
    #[cfg(feature = "avian")]
    pub use crate::{MorphAvianCollider, MorphAvianDiagnostics, MorphAvianPart, MorphAvianPlugin, MorphAvianScene};
    #[cfg(feature = "rapier")]
    pub use crate::{
        MorphCharacterCarry, MorphCharacterGround, MorphRapierCollider, MorphRapierDiagnostics, MorphRapierPlugin,
        MorphRapierScene, MorphRapierVelocity,
    };
    #[cfg(feature = "gizmos")]
    pub use crate::{MorphGizmos, MorphGizmosPlugin};
    #[cfg(feature = "picking")]
    pub use crate::{MorphPick, MorphPickingPlugin, MorphPickingSettings};
}

/// The README's snippets, compiled; two of them are about physics engines.
#[cfg(all(doctest, feature = "rapier", feature = "avian"))]
#[doc = include_str!("../README.md")]
struct Readme;
