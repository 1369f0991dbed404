//! A head nods and frowns in a fixed-step game, and wears a hat that never slips.
//!
//! Collisions run with the game, in `FixedPostUpdate`. A ray from above finds the place for the hat once. From then on `MorphSurfaceAnchor` keeps the hat there in
//! every drawn frame, even in frames without a fixed step. Use the same component for decals, sparks or sweat.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_collision --features cookbook --example hat`
//!
//! For your game, replace `HEAD` (any glTF with morph targets or a skeleton works), the hat, and `nod`.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// A file in the folder `assets`.
const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";
/// A point above the brow, where frowning moves the skin.
const ABOVE: Vec3 = Vec3::new(0.1, 12.0, 1.38);

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, MorphPlugins.in_schedule(FixedPostUpdate), game))
        .run();
}

pub(crate) fn game(app: &mut App) {
    app.add_systems(Startup, set_up)
        .add_systems(
            FixedUpdate,
            put_on_hat.run_if(not(any_with_component::<MorphSurfaceAnchor>)),
        )
        .add_systems(Update, (nod, frown).run_if(any_with_component::<MorphSurfaceAnchor>));
}

#[derive(Component)]
struct Head;

#[derive(Component)]
pub(crate) struct Hat;

fn set_up(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Head,
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(HEAD))),
        MorphColliderScene::default(),
    ));
    let felt = materials.add(Color::srgb(0.1, 0.1, 0.15));
    // The +Y axis of an anchored entity points out of the surface, so the hat is built upwards from 0.
    let mut part = |radius: f32, height: f32| {
        let middle = Transform::from_xyz(0.0, 0.5 * height, 0.0);
        (
            Mesh3d(meshes.add(Cylinder::new(radius, height))),
            MeshMaterial3d(felt.clone()),
            middle,
        )
    };
    commands.spawn((Hat, Visibility::Hidden, children![part(0.4, 0.04), part(0.25, 0.4)]));
    commands.spawn((
        Camera3d::default(),
        Tonemapping::None,
        Transform::from_xyz(2.5, 8.5, 7.0).looking_at(Vec3::Y * 7.3, Vec3::Y),
        children![DirectionalLight::default()],
    ));
}

/// Casts the ray until it hits: it misses while the model is loading and its tree is being built.
fn put_on_hat(
    spatial: MorphSpatialQuery,
    mut hats: Query<(Entity, &mut Visibility), With<Hat>>,
    mut commands: Commands,
) {
    for (hat, mut visibility) in &mut hats {
        if let Some(hit) = spatial.cast_ray(ABOVE, Dir3::NEG_Y, 10.0, &MorphQueryFilter::default()) {
            commands.entity(hat).insert(MorphSurfaceAnchor::at(&hit));
            *visibility = Visibility::Visible;
        }
    }
}

/// Rotates the head about the neck. Runs in `Update`, so the motion is smooth between the game's fixed steps.
fn nod(time: Res<Time>, mut heads: Query<&mut Transform, With<Head>>) {
    const NECK: Vec3 = Vec3::new(0.0, 6.0, 0.0);
    for mut head in &mut heads {
        let t = time.elapsed_secs();
        let turn = Quat::from_euler(EulerRot::YXZ, 0.5 * (0.8 * t).sin(), 0.2 * (2.0 * t).sin(), 0.0);
        *head = Transform::from_translation(NECK - turn * NECK).with_rotation(turn);
    }
}

fn frown(time: Res<Time>, meshes: Res<Assets<Mesh>>, mut faces: Query<&mut MorphWeights>) {
    for mut face in &mut faces {
        let mesh = face.first_mesh().and_then(|mesh| meshes.get(mesh));
        let Some(names) = mesh.and_then(Mesh::morph_target_names) else {
            continue;
        };
        let raised = (3.0 * time.elapsed_secs()).sin();
        for (name, weight) in names.iter().zip(face.weights_mut()) {
            if name.starts_with("brow") {
                let is_up = name.contains("Up");
                *weight = if is_up { raised.max(0.0) } else { (-raised).max(0.0) };
            }
        }
    }
}
