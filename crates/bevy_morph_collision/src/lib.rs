//! Bevy plugin: exact collision detection for meshes deformed by morph targets (blend shapes) and by joints (skinned meshes).
//!
//! The plugin builds one collision tree per mesh *asset*, in the background. All entities that show the mesh share it. Each
//! frame, queries refit the tree to an entity's morph weights and joints, but only the nodes that they visit. Answers are those
//! of [`morph_collision`]: exact, over the vertices that the mesh really has at these weights and with these joints.
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
//! Trees are always built in [`PostUpdate`](bevy::prelude::PostUpdate). By default everything else also runs there, after
//! animation and transform propagation; [`MorphCollisionPlugin::new`] picks another schedule. The stages, in the order of
//! [`MorphCollisionSystems`]:
//!
//! 1. **Import** (`scene`, `every_mesh`, `body_roots`, `import`): turns the parts of a [`MorphColliderScene`] into colliders of a
//!    body, and meshes into trees. Earlier, while Bevy loads a glTF file, meshes without normals are repaired (feature `gltf`, on
//!    by default).
//! 2. **Weights** (`velocities`, `weights`, `joints`, `skeletons`): remembers each collider's previous state, then sets its pose
//!    to the current weights and joint matrices.
//! 3. **Broad phase** (`broad_phase`): finds pairs of colliders whose world-space boxes overlap and that [`MorphCollisionLayers`]
//!    and [`MorphCollisionMode`]s allow.
//! 4. **Narrow phase** (`narrow_phase`, `contacts`, `body_pairs`): finds exact triangle pairs and contacts and stores them in
//!    [`MorphCollisions`], by collider and by body.
//! 5. **Events** (`events`, `body_events`, `changes`): reports which contacts of colliders and bodies started or ended since the
//!    last run, and updates [`MorphCollidingEntities`].
//! 6. **Anchors** (`anchors`): moves entities with a [`MorphSurfaceAnchor`] to where their triangle is drawn; always in
//!    [`PostUpdate`](bevy::prelude::PostUpdate).
//!
//! Each stage adds to [`MorphCollisionDiagnostics`]. Unchanged colliders cost almost nothing: weights, joints and transforms are
//! compared by value, and a pair keeps its answer if neither of its colliders changed. In a frame without changes, each collider
//! is only checked once. With a [`tolerance`](MorphCollider::tolerance), small movements do not count as changes (`tolerance`).
//! Pairs of a [`continuous`](MorphCollider::continuous) collider are also compared on the way from the last run (`continuous`,
//! `impact`).
//!
//! Independent of the pipeline:
//!
//! - [`MorphSpatialQuery`] (`spatial`): ray casts, shape casts, intersections, closest points, contacts and posed vertices. Any
//!   number of systems can use it at the same time.
//! - [`MorphColliderReady`], [`MorphColliderFailed`], [`MorphColliderSceneReady`] (`readiness`), and [`MorphTrees::progress`]:
//!   for loading screens.
//! - [`MorphBoundsPlugin`] (`bounds`): the `Aabb` by which Bevy culls morphing and skinned meshes.
//! - `MorphPickingPlugin` (`picking`, feature `picking`): pointers pick meshes as they are drawn.
//! - `MorphGizmosPlugin` (`gizmos`, feature `gizmos`): draws tree boxes, contacts and touching triangles.
//! - `MorphRapierPlugin` (`rapier`, feature `rapier`): rigid bodies and character controllers of `bevy_rapier3d` collide with the
//!   surface.
//! - `MorphAvianPlugin` (`avian`, feature `avian`): rigid bodies of `avian3d` collide with the surface.
//! - `MorphCollisionDiagnosticsPlugin` (feature `diagnostics`): publishes the counts in Bevy's `DiagnosticsStore`.
//!
//! [`MorphPlugins`] (`plugins`) adds all of these at once.
//!
//! # Bodies
//!
//! A *body* is a collider, or an entity with several colliders (`body`). Each of these colliders names its body with
//! [`MorphColliderOf`], and the body lists them in [`MorphColliders`]. The parts of a [`MorphColliderScene`] are colliders of its
//! root. Colliders of the same body never collide with each other. [`MorphBodyCollisionStart`] and [`MorphBodyCollisionEnd`]
//! report each touch of two bodies once, however many of their colliders touch, both as messages and to observers of the bodies.
//! [`MorphCollisionStart`] and [`MorphCollisionEnd`] report every pair of colliders.
//!
//! # Requirements
//!
//! - `AssetPlugin`, `MeshPlugin` and `TransformPlugin`. `DefaultPlugins` contains all three.
//! - Meshes must stay in main memory: use `RenderAssetUsages::default()`, not `RENDER_WORLD` alone. They may be compressed
//!   (`GltfPlugin::mesh_compression`).
//!
//! Data that cannot be used is logged once as an error with the names of the mesh and the entity. Only that entity is left out.
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
//! [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh). The propagated `GlobalTransform`s of its joints and the inverse bind poses
//! place it; see [`MorphCollider`] for missing or bad joints. All joints count, while on targets without storage buffers (WebGL
//! 2) Bevy draws only the first 256 joints of a skeleton correctly.
#![forbid(unsafe_code)]
// docs.rs shows which feature enables which item.
#![cfg_attr(docsrs, feature(doc_cfg))]
// Systems declare their needs as parameters.
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
mod continuous;
mod diagnostics;
mod events;
mod every_mesh;
#[cfg(feature = "gizmos")]
mod gizmos;
mod impact;
mod import;
mod joints;
mod layers;
mod lent_poses;
mod narrow_phase;
// Each engine uses only part of it.
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
mod self_collisions;
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
pub use continuous::MorphTeleported;
pub use diagnostics::MorphCollisionDiagnostics;
#[cfg(feature = "diagnostics")]
pub use diagnostics::MorphCollisionDiagnosticsPlugin;
pub use events::{MorphCollidingEntities, MorphCollisionEnd, MorphCollisionEventsEnabled, MorphCollisionStart};
#[cfg(feature = "gizmos")]
pub use gizmos::{MorphGizmos, MorphGizmosPlugin};
pub use impact::{MorphFeatures, MorphImpact};
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
pub use self_collisions::{MorphSelfCollisionEnd, MorphSelfCollisionStart, MorphSelfCollisions, MorphSelfContact};
pub use settings::MorphCollisionSettings;
pub use shape::MorphShape;
pub use spatial::{
    MorphClosestPoints, MorphManifold, MorphProjection, MorphQueryFilter, MorphRayHit, MorphShapeHit, MorphSpatialQuery,
};
pub use workers::TaskPoolWorkers;

/// Everything that an app using the plugin usually names.
pub mod prelude {
    #[cfg(feature = "diagnostics")]
    pub use crate::MorphCollisionDiagnosticsPlugin;
    pub use crate::{BuildOptions, Facing, MorphClosestPoints, MorphManifold, MorphProjection};
    pub use crate::{
        DefaultMorphTreeSettings, MorphBodyCollisionEnd, MorphBodyCollisionStart, MorphBodyRoot, MorphBoundsPlugin,
        MorphCollider, MorphColliderDisabled, MorphColliderOf, MorphColliderScene, MorphColliders,
        MorphCollidingEntities, MorphCollisionDiagnostics, MorphCollisionEnd, MorphCollisionEventsEnabled,
        MorphCollisionLayers, MorphCollisionMode, MorphCollisionPlugin, MorphCollisionSettings, MorphCollisionStart,
        MorphCollisionSystems, MorphCollisions, MorphContact, MorphContactPoint, MorphFeatures, MorphImpact,
        MorphPlugins, MorphQueryFilter, MorphRayHit, MorphSelfCollisionEnd, MorphSelfCollisionStart,
        MorphSelfCollisions, MorphSelfContact, MorphShape, MorphShapeHit, MorphSpatialQuery, MorphSurfaceAnchor,
        MorphTeleported, MorphTreeSettings, TrianglePair,
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

/// Compiles the README's snippets; two of them need the physics engines.
#[cfg(all(doctest, feature = "rapier", feature = "avian"))]
#[doc = include_str!("../README.md")]
struct Readme;
