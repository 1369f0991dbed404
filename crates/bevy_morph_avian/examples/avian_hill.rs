//! Crates rain on a hill that heaves like the back of a sleeping giant. They ride on its waves, exactly as drawn.
//!
//! The hill comes from a glTF file with morph targets and a clip. Put a `MorphPhysicsScene` on its root, and Avian treats the hill like any other collider. Avian's
//! components, such as `Friction`, go on its meshes: see `grip`.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_avian --features cookbook --example avian_hill`
//!
//! For your game, replace `HILL`, `CLIP` and `rain`. Your `Cargo.toml` needs `bevy_morph_collision = "0.2"` and `bevy_morph_avian = "0.2"`.

use std::collections::VecDeque;
use std::time::Duration;

use avian3d::prelude::*;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::time::common_conditions::on_timer;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_avian::prelude::*;
use bevy_morph_collision::prelude::*;

/// A file in the folder `assets`. The hill is 2 units wide.
const HILL: &str = "heaving_body_5120.glb";
/// The index of its clip.
const CLIP: usize = 0;
/// The length of a crate's edges.
pub(crate) const EDGE: f32 = 0.3;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, PhysicsPlugins::default()))
        .add_plugins((MorphPlugins, MorphAvianPlugin, game))
        .run();
}

pub(crate) fn game(app: &mut App) {
    app.add_systems(Startup, set_up)
        .add_systems(
            Update,
            rain.run_if(|physics: Res<MorphPhysicsDiagnostics>| physics.surfaces > 0)
                .run_if(on_timer(Duration::from_millis(250))),
        )
        .add_observer(play)
        .add_observer(grip);
}

#[derive(Resource)]
struct Clip(Handle<AnimationGraph>, AnimationNodeIndex);

#[derive(Component)]
pub(crate) struct Crate;

fn set_up(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let (graph, node) = AnimationGraph::from_clip(assets.load(GltfAssetLabel::Animation(CLIP).from_asset(HILL)));
    commands.insert_resource(Clip(graphs.add(graph), node));
    commands.spawn((
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(HILL))),
        MorphPhysicsScene::default(),
        Transform::from_scale(Vec3::splat(4.0)),
    ));
    commands.spawn((
        RigidBody::Static,
        Collider::cuboid(20.0, 0.2, 20.0),
        Mesh3d(meshes.add(Cuboid::new(20.0, 0.2, 20.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.4, 0.3))),
        Transform::from_xyz(0.0, -0.1, 0.0),
    ));
    commands.spawn((
        Camera3d::default(),
        Tonemapping::None,
        Transform::from_xyz(4.0, 5.0, 8.0).looking_at(Vec3::Y, Vec3::Y),
        children![DirectionalLight::default()],
    ));
}

/// Starts the clip once the scene is spawned. The animation players are descendants of its root.
fn play(
    ready: On<WorldInstanceReady>,
    children: Query<&Children>,
    mut players: Query<&mut AnimationPlayer>,
    clip: Res<Clip>,
    mut commands: Commands,
) {
    for entity in children.iter_descendants(ready.entity) {
        if let Ok(mut player) = players.get_mut(entity) {
            player.play(clip.1).repeat().set_speed(2.0);
            commands.entity(entity).insert(AnimationGraphHandle(clip.0.clone()));
        }
    }
}

/// Makes every mesh of the hill rough, as soon as it is in physics.
fn grip(added: On<Add<MorphPhysicsCollider>>, mut commands: Commands) {
    commands.entity(added.entity).insert(Friction::new(0.8));
}

/// Drops four crates a second along a spiral above the hill, once the hill is in physics. Despawns the oldest ones.
fn rain(
    mut number: Local<u32>,
    mut crates: Local<VecDeque<Entity>>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    *number += 1;
    let turn = 2.4 * *number as f32;
    let reach = 0.3 + 0.1 * (*number % 12) as f32;
    let new = commands.spawn((
        Crate,
        RigidBody::Dynamic,
        Collider::cuboid(EDGE, EDGE, EDGE),
        Mesh3d(meshes.add(Cuboid::from_length(EDGE))),
        MeshMaterial3d(materials.add(Color::hsv(30.0 * (*number % 12) as f32, 0.6, 0.8))),
        Transform::from_xyz(reach * turn.sin(), 5.0, reach * turn.cos()),
    ));
    crates.push_back(new.id());
    if crates.len() > 60
        && let Some(oldest) = crates.pop_front()
    {
        commands.entity(oldest).despawn();
    }
}
