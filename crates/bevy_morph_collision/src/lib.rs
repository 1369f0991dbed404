//! Bevy plugin: exact collision detection for meshes deformed by morph targets (blend shapes).
//!
//! A collision tree is built once per mesh *asset*, in the background, and shared by every entity that shows the mesh.
//! Each frame the tree is refitted to an entity's morph weights, where and only where a query looks at it. Answers are
//! those of [`morph_collision`]: exact, over the vertices that the mesh really has at these weights.
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
//! Everything runs in [`PostUpdate`], after animation and transform propagation, in the order of [`MorphCollisionSystems`]:
//!
//! 1. **Import** (`import`, `collider`): parts of a [`MorphColliderScene`] become colliders; meshes become trees.
//! 2. **Weights** (`weights`): every collider's pose takes the weights in force.
//! 3. **Broad phase** (`bounds`): boxes around whole colliders in world space; pairs whose boxes overlap go on.
//! 4. **Narrow phase** (`detect`): exact triangle pairs, into [`MorphCollisions`].
//! 5. **Events** (`events`): what started and ended since the last frame.
//!
//! Each stage adds to [`MorphCollisionDiagnostics`].
//!
//! # What it needs
//!
//! `AssetPlugin`, `MeshPlugin` and `TransformPlugin`, which are all among `DefaultPlugins`. Meshes must stay in main memory
//! (`RenderAssetUsages::MAIN_WORLD`, which is the default) with uncompressed positions. Data that cannot be used is
//! logged once as an error with the mesh's and the entity's name, and only that entity is left out.
#![forbid(unsafe_code)]

mod bounds;
mod collider;
mod detect;
mod diagnostics;
mod events;
mod import;
mod weights;
mod workers;

use bevy::app::AnimationSystems;
use bevy::asset::AssetEventSystems;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

pub use collider::{CollisionMode, MorphBody, MorphCollider, MorphColliderScene};
pub use detect::{MorphCollisions, MorphContact};
pub use diagnostics::MorphCollisionDiagnostics;
pub use events::{MorphCollisionEnd, MorphCollisionEventsEnabled, MorphCollisionStart};
pub use import::{ImportError, MorphTrees};
pub use morph_collision;
pub use morph_collision::{BuildOptions, QueryStats, TrianglePair};
pub use workers::TaskPoolWorkers;

/// What a program that uses the plugin needs by name.
pub mod prelude {
    pub use crate::{
        CollisionMode, MorphBody, MorphCollider, MorphColliderScene, MorphCollisionDiagnostics, MorphCollisionEnd,
        MorphCollisionEventsEnabled, MorphCollisionPlugin, MorphCollisionStart, MorphCollisionSystems, MorphCollisions,
        MorphContact, MorphTreeOptions, TrianglePair,
    };
}

/// Detects collisions between [`MorphCollider`]s every frame.
///
/// Insert [`MorphTreeOptions`] before the plugin to build trees in another way than the default one.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphCollisionPlugin;

/// How trees are built, for all meshes. No answer depends on it.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::{BuildOptions, MorphCollisionPlugin, MorphTreeOptions};
/// # let mut app = App::new();
/// app.insert_resource(MorphTreeOptions(BuildOptions::default().with_leaf_size(8)));
/// app.add_plugins(MorphCollisionPlugin);
/// ```
#[derive(Resource, Clone, Debug, Default)]
pub struct MorphTreeOptions(pub BuildOptions);

/// The stages of the plugin, in [`PostUpdate`], in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphCollisionSystems {
    /// Finds new colliders, builds the trees of their meshes and hands them out.
    Import,
    /// Reads the morph weights in force.
    Weights,
    /// Places colliders in the world and finds the pairs whose boxes overlap.
    BroadPhase,
    /// Finds the triangles that intersect.
    NarrowPhase,
    /// Reports what started and ended.
    Events,
}

impl Plugin for MorphCollisionPlugin {
    fn build(&self, app: &mut App) {
        let options = app.world_mut().get_resource_or_init::<MorphTreeOptions>().clone();
        app.insert_resource(MorphTrees::new(options.0))
            .init_resource::<bounds::Candidates>()
            .init_resource::<MorphCollisions>()
            .init_resource::<MorphCollisionDiagnostics>()
            .add_message::<MorphCollisionStart>()
            .add_message::<MorphCollisionEnd>()
            .register_type::<MorphCollider>()
            .register_type::<MorphColliderScene>()
            .register_type::<MorphBody>()
            .register_type::<CollisionMode>()
            .register_type::<MorphCollisionEventsEnabled>()
            .register_type::<MorphCollisionStart>()
            .register_type::<MorphCollisionEnd>()
            .register_type::<MorphCollisionDiagnostics>()
            .add_observer(collider::forget_collider)
            .add_observer(collider::forget_scene);

        use MorphCollisionSystems as Stage;
        app.configure_sets(
            PostUpdate,
            (
                Stage::Import,
                Stage::Weights,
                Stage::BroadPhase,
                Stage::NarrowPhase,
                Stage::Events,
            )
                .chain()
                .after(AnimationSystems)
                .after(TransformSystems::Propagate)
                .after(AssetEventSystems),
        )
        .add_systems(
            PostUpdate,
            (
                (
                    diagnostics::begin_frame,
                    collider::add_scene_parts,
                    import::follow_asset_events,
                    import::request_trees,
                    import::finish_trees,
                    import::hand_out_trees,
                )
                    .chain()
                    .in_set(Stage::Import),
                weights::read_weights.in_set(Stage::Weights),
                bounds::find_candidates.in_set(Stage::BroadPhase),
                detect::find_contacts.in_set(Stage::NarrowPhase),
                events::report_changes.in_set(Stage::Events),
            ),
        );
    }
}

/// The README's snippet, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
