//! Bevy plugin: exact collision detection for meshes deformed by morph targets (blend shapes) and by joints (skinned meshes).
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_morph_collision::prelude::*;
//!
//! fn main() {
//!     App::new()
//!         // With a window and a renderer this is `DefaultPlugins`.
//!         .add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin))
//!         .add_plugins(MorphPlugins)
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
//! # Concepts
//!
//! - A **collider** is an entity with a [`MorphCollider`](components::MorphCollider) and a `Mesh3d`. It collides as its mesh is drawn, with the current morph
//!   weights, joints and transform. A [`MorphShape`](components::MorphShape) instead of the mesh makes it a rigid shape, such as a ball.
//! - A **body** is a collider, or an entity with several colliders, such as the root of a glTF scene. Colliders of one body never
//!   collide with each other.
//! - A **tree** makes queries fast. There is one for each mesh *asset*, built in the background and shared by all entities that
//!   show the mesh. A collider takes part as soon as its tree is ready. Queries refit only the nodes that they visit.
//! - A **run** compares all colliders once: by default in every frame, in [`PostUpdate`](bevy::prelude::PostUpdate), after
//!   animation. Events, [`MorphCollisions`](contacts::MorphCollisions) and spatial queries show the state of the last run.
//! - A **[mode](components::MorphCollisionMode)** says how much you want to know about a contact: whether two colliders touch, one pair of
//!   triangles, all pairs, or contact points with depths.
//!
//! Answers are those of [`morph_collision`]: exact, over the vertices that the mesh really has. Colliders report contact; they do
//! not push. For that, connect a [physics engine](#let-physics-feel-the-mesh).
//!
//! # Tasks
//!
//! ## Make things collide
//!
//! [`MorphColliderScene`](components::MorphColliderScene) on the root of a glTF scene makes its deforming meshes colliders of one body. [`MorphCollider`](components::MorphCollider) does it for
//! one mesh, and [`MorphCollisionSettings`](components::MorphCollisionSettings) for every mesh that deforms.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_morph_collision::prelude::*;
//! fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
//!     commands.spawn((
//!         WorldAssetRoot(assets.load("boss.glb#Scene0")),
//!         MorphColliderScene { collider: MorphCollider::new(MorphCollisionMode::Contacts), ..default() },
//!     ));
//!     commands.spawn((MorphShape::Ball { radius: 0.05 }, Transform::from_xyz(0.0, 1.5, 0.3)));
//! }
//! # App::new().add_systems(Startup, spawn);
//! ```
//!
//! A [`MorphShape`](components::MorphShape) is a rigid ball, capsule, box, cylinder, cone, half-space or convex hull of a mesh
//! ([`MorphConvexHull`](components::MorphConvexHull)), and comes from Bevy's primitives with `From`. Several of them make a compound.
//!
//! [`MorphCollisionLayers`](components::MorphCollisionLayers) decide what collides with what. For rules that depend on more than that, such as
//! teams, owners and one-way surfaces, there are [hooks](hooks::MorphCollisionHooks).
//!
//! ## Find out what touches
//!
//! [`MorphBodyCollisionStart`](events::MorphBodyCollisionStart) and [`MorphBodyCollisionEnd`](events::MorphBodyCollisionEnd) come once per pair of bodies, however many of their colliders touch:
//! as messages, and to observers of the bodies. [`MorphCollisionStart`](events::MorphCollisionStart) and [`MorphCollisionEnd`](events::MorphCollisionEnd) report every pair of colliders.
//! Between these events, [`MorphCollidingEntities`](events::MorphCollidingEntities) lists what an entity touches, and [`MorphCollisions`](contacts::MorphCollisions) has the contacts:
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_morph_collision::prelude::*;
//! fn sparks(collisions: Res<MorphCollisions>) {
//!     for contact in collisions.iter() {
//!         println!("{} touches {} at {}", contact.collider1, contact.collider2, contact.point);
//!     }
//! }
//! # App::new().add_systems(Update, sparks);
//! ```
//!
//! A [`continuous`](components::MorphCollider::continuous) collider, a mesh or a shape, is also compared on its way from the last run, so nothing
//! passes through it unnoticed. [`MorphTeleported`](components::MorphTeleported) says that an entity did not move but was put somewhere else, also to physics.
//! [`MorphSelfCollisions`](self_collisions::MorphSelfCollisions) reports where a mesh intersects itself.
//!
//! ## Ask about the surface
//!
//! [`MorphSpatialQuery`](spatial::MorphSpatialQuery) casts rays and shapes, finds closest points and intersections, and returns posed vertices and velocities.
//! Any number of systems can use it at the same time.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_morph_collision::prelude::*;
//! fn shoot(spatial: MorphSpatialQuery, names: Query<&Name>) {
//!     if let Some(hit) = spatial.cast_ray(Vec3::Y, Dir3::NEG_Z, 100.0, &MorphQueryFilter::default()) {
//!         let joint = hit.joint.and_then(|joint| names.get(joint).ok());
//!         println!("hit triangle {} of {}, moved by {joint:?}", hit.triangle, hit.entity);
//!     }
//! }
//! # App::new().add_systems(Update, shoot);
//! ```
//!
//! [`MorphRayCaster`](spatial::MorphRayCaster) and [`MorphShapeCaster`](spatial::MorphShapeCaster) are components that do it in every run: on an eye, a
//! foot or a camera. [`cast_moving_shape`](spatial::MorphSpatialQuery::cast_moving_shape) swings a shape that turns, such as a sword.
//!
//! [`MorphSurfaceAnchor`](surface::MorphSurfaceAnchor) keeps an entity on the surface: a hat, a decal. With `MorphPickingPlugin` (feature `picking`), pointers
//! hit meshes as they are drawn. [`MorphBoundsPlugin`](bounds::MorphBoundsPlugin) keeps Bevy's `Aabb` around what is drawn, for culling.
//!
//! ## Let physics feel the mesh
//!
//! Two other crates connect physics engines, with the same components: `MorphPhysicsCollider` for one mesh, `MorphPhysicsScene` for the
//! deforming meshes of a scene.
//!
//! - `bevy_morph_rapier` has `MorphRapierPlugin`: rigid bodies and character controllers of `bevy_rapier3d` collide with the surface.
//! - `bevy_morph_avian` has `MorphAvianPlugin`: so do rigid bodies of `avian3d`. `MorphAvianCarry` carries characters that use Avian's
//!   `MoveAndSlide`, and `MorphTnuaPlugin` those of `bevy-tnua`. `MorphAvianCollisions` lists Avian's contacts with surfaces.
//!
//! [`physics_api`] is for crates that connect another engine.
//!
//! ## Wait until everything is ready
//!
//! [`MorphColliderReady`](setup::MorphColliderReady), [`MorphColliderFailed`](setup::MorphColliderFailed) and [`MorphColliderSceneReady`](setup::MorphColliderSceneReady) are triggered on colliders and scenes.
//! [`MorphTrees::progress`](crate::import::MorphTrees::progress) is for loading screens.
//!
//! With [`MorphTreeFilesPlugin`](crate::import::MorphTreeFilesPlugin), trees come from files that `morph-collide bake` wrote, and colliders are
//! ready as soon as their meshes are loaded.
//!
//! ## Save time
//!
//! Unchanged colliders cost almost nothing: weights, joints and transforms are compared by value, and a pair keeps its answer if
//! neither of its colliders changed. With a [`tolerance`](components::MorphCollider::tolerance), small movements do not count as changes.
//! [`MorphCollisionDiagnostics`](state::MorphCollisionDiagnostics) counts the work of each run, and [`MorphPairCosts`](state::MorphPairCosts)
//! lists the pairs that take most of it. `MorphCollisionDiagnosticsPlugin` (feature `diagnostics`) publishes the counts in Bevy's
//! `DiagnosticsStore`. `MorphDiagnosticsUiPlugin` (feature `diagnostic_ui`) shows everything in a panel:
//!
#![cfg_attr(feature = "diagnostic_ui", doc = "```")]
#![cfg_attr(not(feature = "diagnostic_ui"), doc = "```ignore")]
//! # use bevy::prelude::*;
//! # use bevy_morph_collision::prelude::*;
//! # let mut app = App::new();
//! app.add_plugins(MorphDiagnosticsUiPlugin);
//! ```
//!
//! ## Editors and the Bevy Remote Protocol
//!
//! All components and resources that a game writes are registered for reflection, so inspectors and the Bevy Remote Protocol can read and
//! change them. A change takes effect in the next run. A bad value does what it does if code sets it: the log says so once, and the collider is
//! left out until the value is good again, or the last good one stays in use. Fields have their unit, a [`MorphUnit`](components::MorphUnit), and
//! their range, a `RangeInclusive`, as attributes for sliders.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
//! # use bevy_morph_collision::prelude::*;
//! /// What `world.mutate_components` does for `{"component": "bevy_morph_collision::components::collider::MorphCollider",
//! /// "path": ".margin", "value": 0.5}`.
//! fn widen(world: &mut World, collider: Entity) {
//!     let registry = world.resource::<AppTypeRegistry>().clone();
//!     let registry = registry.read();
//!     let registration = registry.get_with_short_type_path("MorphCollider").unwrap();
//!     let component = registration.data::<ReflectComponent>().unwrap();
//!     let mut collider = component.reflect_mut(world.entity_mut(collider)).unwrap();
//!     *collider.path_mut::<f32>(".margin").unwrap() = 0.5;
//! }
//! # let mut world = World::new();
//! # world.init_resource::<AppTypeRegistry>();
//! # world.resource::<AppTypeRegistry>().write().register::<MorphCollider>();
//! # let collider = world.spawn(MorphCollider::default()).id();
//! # widen(&mut world, collider);
//! # assert_eq!(world.get::<MorphCollider>(collider).unwrap().margin, 0.5);
//! ```
//!
//! For the protocol, add `RemotePlugin` and `RemoteHttpPlugin` of the crate `bevy_remote`; nothing else is needed. Three things cannot be
//! changed in this way: a [`MorphColliderOf`](components::MorphColliderOf) is immutable and has to be inserted again, the protocol has no
//! text for the handle of a [`MorphTreeFrom`](import::MorphTreeFrom), and it does not see `MorphGizmos` in Bevy's `GizmoConfigStore`.
//!
//! ## Go back to an earlier frame
//!
//! For rollback netcode, [`MorphCollisionState`](rollback::MorphCollisionState) is what runs remember of earlier runs. Register it with a library such as `bevy_ggrs`
//! or `lightyear`, and frames that are simulated again report the same bits. `docs/netcode.md` in the repository has the details.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_morph_collision::prelude::*;
//! fn go_back(world: &mut World) {
//!     MorphCollisionState::save(world);
//!     let saved = world.resource::<MorphCollisionState>().clone();
//!     // Some frames later, after the game has put its own components back:
//!     world.insert_resource(saved);
//!     MorphCollisionState::restore(world);
//! }
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphPlugins));
//! # app.add_systems(Last, go_back);
//! # app.finish();
//! # app.update();
//! ```
//!
//! ## Find out why nothing happens
//!
//! Read the log first. Data that cannot be used is logged once, as an error with the mesh's file and the entity's name; only that entity
//! is left out. Likely mistakes are logged as warnings: components on entities where they have no effect, scenes without colliders, and
//! missing plugins. Only an app without any of this crate's plugins stays silent.
//!
//! `MorphGizmosPlugin` (feature `gizmos`) draws boxes, contacts and touching triangles. `docs/why_no_collision.md` in the repository
//! lists common problems.
//!
//! # Requirements
//!
//! - `AssetPlugin`, `MeshPlugin` and `TransformPlugin`. `DefaultPlugins` contains all three. If one is missing, the log names it.
//! - Meshes must stay in main memory: use `RenderAssetUsages::default()`, not `RENDER_WORLD` alone. They may be compressed
//!   (`GltfPlugin::mesh_compression`).
//!
//! # What works with which mesh
//!
//! Everything works with rigid meshes, with morph targets, with joints, and with both. Two differences: a hit on a mesh with joints
//! names the joint, and [`MorphBoundsPlugin`](bounds::MorphBoundsPlugin) leaves the `Aabb` of rigid meshes to Bevy.
//!
//! A mesh has joints if it has `Mesh::ATTRIBUTE_JOINT_INDEX` and `Mesh::ATTRIBUTE_JOINT_WEIGHT` and its entity has
//! [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh). The propagated `GlobalTransform`s of its joints and the inverse bind poses
//! place it; see [`MorphCollider`](components::MorphCollider) for missing or bad joints. All joints count, while on platforms without storage buffers (WebGL
//! 2) Bevy draws only the first 256 joints of a skeleton correctly.
//!
//! # The pipeline
//!
//! [`MorphPlugins`](plugins::MorphPlugins) adds all plugins at once. Trees are always built in [`PostUpdate`](bevy::prelude::PostUpdate).
//! Everything else runs there by default, too; `MorphPlugins.in_schedule(..)` picks another schedule. The stages, in the order of
//! [`MorphCollisionSystems`](app::MorphCollisionSystems), with their folders:
//!
//! 1. **Import** ([`setup`], [`import`]): turns the parts of a [`MorphColliderScene`](components::MorphColliderScene) into colliders of a
//!    body, and meshes into trees. Reports what is ready and what failed; `misuse` reports likely mistakes. Earlier, while Bevy loads a
//!    glTF file, meshes without normals are repaired (feature `gltf`, on by default).
//! 2. **Weights** (`posing`): remembers each collider's previous state, then sets its pose to the current weights and joint matrices.
//! 3. **Broad phase** (`broad_phase`): finds pairs of colliders whose world-space boxes overlap and that
//!    [`MorphCollisionLayers`](components::MorphCollisionLayers) and [`MorphCollisionMode`](components::MorphCollisionMode)s allow.
//!    [`hooks`] are asked about these.
//! 4. **Narrow phase** (`narrow_phase`, [`self_collisions`]): finds exact triangle pairs and contacts and stores them in
//!    [`MorphCollisions`](contacts::MorphCollisions), by collider and by body. Finds where meshes intersect themselves.
//! 5. **Events** ([`events`]): reports which contacts of colliders and bodies started or ended since the last run, and updates
//!    [`MorphCollidingEntities`](events::MorphCollidingEntities).
//! 6. **Anchors** ([`surface`]): moves entities with a [`MorphSurfaceAnchor`](surface::MorphSurfaceAnchor) to where their triangle is
//!    drawn; always in [`PostUpdate`](bevy::prelude::PostUpdate).
//!
//! # Order of the folders
//!
//! A folder uses only those to its right:
//!
//! ```text
//! plugins, physics_api > misuse, rollback > bounds, surface, hooks > setup, posing, narrow_phase, self_collisions, spatial, events > broad_phase, debug
//!     > state > import, contacts > components, app
//! ```
#![forbid(unsafe_code)]
// docs.rs shows which feature enables which item.
#![cfg_attr(docsrs, feature(doc_cfg))]
// Systems declare their needs as parameters.
#![allow(clippy::type_complexity, clippy::too_many_arguments)]

pub mod app;
pub mod bounds;
mod broad_phase;
pub mod components;
pub mod contacts;
pub mod debug;
pub mod events;
pub mod hooks;
pub mod import;
mod misuse;
mod narrow_phase;
pub mod physics_api;
pub mod plugins;
mod posing;
pub mod rollback;
pub mod self_collisions;
pub mod setup;
pub mod spatial;
pub mod state;
pub mod surface;

pub use morph_collision;

/// Everything that an app using the plugin usually names.
pub mod prelude {
    pub use morph_collision::TrianglePair;

    pub use crate::app::MorphCollisionSystems;
    pub use crate::bounds::MorphBoundsPlugin;
    pub use crate::components::{
        MorphActiveCollisionHooks, MorphBodyRoot, MorphCollider, MorphColliderDisabled, MorphColliderOf,
        MorphColliderScene, MorphColliders, MorphCollisionEventsEnabled, MorphCollisionLayers, MorphCollisionMode,
        MorphCollisionSettings, MorphConvexHull, MorphLayerMask, MorphShape, MorphTeleported, MorphTreeOptions,
        MorphUnit,
    };
    pub use crate::contacts::{MorphCollisions, MorphContact, MorphContactPoint, MorphImpact, MorphImpactFeatures};
    #[cfg(feature = "diagnostics")]
    pub use crate::debug::MorphCollisionDiagnosticsPlugin;
    #[cfg(feature = "diagnostic_ui")]
    pub use crate::debug::{MorphDiagnosticsUi, MorphDiagnosticsUiPlugin, MorphDiagnosticsUiSettings};
    #[cfg(feature = "gizmos")]
    pub use crate::debug::{MorphGizmos, MorphGizmosPlugin};
    pub use crate::events::{
        MorphBodyCollisionEnd, MorphBodyCollisionStart, MorphCollidingEntities, MorphCollisionEnd, MorphCollisionStart,
    };
    pub use crate::hooks::{MorphCandidatePair, MorphCollisionHooks};
    pub use crate::import::{MorphTreeFilesPlugin, MorphTreeFrom, MorphTrees};
    pub use crate::plugins::{MorphCollisionHooksPlugin, MorphCollisionPlugin, MorphPlugins};
    pub use crate::rollback::MorphCollisionState;
    pub use crate::self_collisions::{
        MorphSelfCollisionEnd, MorphSelfCollisionStart, MorphSelfCollisions, MorphSelfContact,
    };
    pub use crate::setup::{MorphColliderFailed, MorphColliderReady, MorphColliderSceneReady};
    pub use crate::spatial::{
        MorphMotionHit, MorphQueryFilter, MorphRayCaster, MorphRayHit, MorphRayHits, MorphShapeCaster, MorphShapeHit,
        MorphShapeHits, MorphShapeMotion, MorphSpatialQuery,
    };
    pub use crate::state::{MorphCollisionDiagnostics, MorphPairCosts, MorphStageTimes};
    pub use crate::surface::MorphSurfaceAnchor;
    #[cfg(feature = "picking")]
    pub use crate::surface::{MorphPick, MorphPickingPlugin, MorphPickingSettings};
}

/// Compiles the README's snippets.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
