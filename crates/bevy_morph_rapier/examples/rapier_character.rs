//! A character walks on the spot and talks while balls rain on it. They bounce off its shoulders, arms and face exactly as drawn.
//!
//! The character comes from a glTF file with a skeleton and morph targets. Put a `MorphPhysicsScene` on its root, and Rapier treats the character like any other
//! collider. You do not need to fit capsules to limbs.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_rapier --features cookbook --example rapier_character`
//!
//! For your game, replace `CHARACTER`, `CLIP` and `rain`. Your `Cargo.toml` needs `bevy_morph_collision = "0.2"` and `bevy_morph_rapier = "0.2"`.

use std::time::Duration;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::time::common_conditions::on_timer;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;

/// A file in the folder `assets`. Its unit is the decimetre; the character is 17 units high.
const CHARACTER: &str = "mh_character_low.glb";
/// The index of its clip `walk_and_talk`.
const CLIP: usize = 3;
pub(crate) const RADIUS: f32 = 0.08;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, RapierPhysicsPlugin::<NoUserData>::default()))
        .add_plugins((MorphPlugins, MorphRapierPlugin, game))
        .run();
}

pub(crate) fn game(app: &mut App) {
    app.add_systems(Startup, set_up)
        .add_systems(
            Update,
            rain.run_if(|physics: Res<MorphPhysicsDiagnostics>| physics.surfaces > 0)
                .run_if(on_timer(Duration::from_millis(100))),
        )
        .add_observer(play);
}

#[derive(Resource)]
struct Clip(Handle<AnimationGraph>, AnimationNodeIndex);

#[derive(Component)]
pub(crate) struct Ball;

fn set_up(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let (graph, node) = AnimationGraph::from_clip(assets.load(GltfAssetLabel::Animation(CLIP).from_asset(CHARACTER)));
    commands.insert_resource(Clip(graphs.add(graph), node));
    commands.spawn((
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(CHARACTER))),
        MorphPhysicsScene::default(),
        Transform::from_xyz(0.0, 0.82, 0.0).with_scale(Vec3::splat(0.1)),
    ));
    commands.spawn((
        Collider::cuboid(5.0, 0.1, 5.0),
        Mesh3d(meshes.add(Cuboid::new(10.0, 0.2, 10.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.4, 0.3))),
        Transform::from_xyz(0.0, -0.1, 0.0),
    ));
    commands.spawn((
        Camera3d::default(),
        Tonemapping::None,
        Transform::from_xyz(1.5, 2.0, 3.0).looking_at(Vec3::Y, Vec3::Y),
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
            player.play(clip.1).repeat();
            commands.entity(entity).insert(AnimationGraphHandle(clip.0.clone()));
        }
    }
}

/// Drops ten balls a second along a spiral above the head, once the character is in physics. Despawns balls that have fallen off.
fn rain(
    mut number: Local<u32>,
    balls: Query<(Entity, &Transform), With<Ball>>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (ball, place) in &balls {
        if place.translation.y < -2.0 {
            commands.entity(ball).despawn();
        }
    }
    *number += 1;
    let turn = 2.4 * *number as f32;
    commands.spawn((
        Ball,
        RigidBody::Dynamic,
        Collider::ball(RADIUS),
        Restitution {
            coefficient: 0.5,
            combine_rule: CoefficientCombineRule::Max,
        },
        Mesh3d(meshes.add(Sphere::new(RADIUS))),
        MeshMaterial3d(materials.add(Color::hsv(30.0 * (*number % 12) as f32, 0.8, 0.9))),
        Transform::from_xyz(0.3 * turn.sin(), 2.5, 0.1 + 0.15 * turn.cos()),
    ));
}
