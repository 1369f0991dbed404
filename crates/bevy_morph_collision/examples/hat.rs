//! A head nods and frowns in a fixed-step game, and wears a hat that never slips.
//!
//! Collisions run with the game, in `FixedPostUpdate`; a ray from above finds the spot for the hat, once. From then on `MorphSurfaceAnchor` keeps it there in
//! every frame that is drawn, also in those without a step. Hats, decals, sparks, sweat: it is the same component.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_collision --example hat`
//!
//! Yours to replace: `HEAD`, any glTF with morph targets or a skeleton; the hat; `nod`.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// In the folder `assets`.
const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";
/// Above the brow, where all that frowning moves the skin.
const ABOVE: Vec3 = Vec3::new(0.1, 12.0, 1.38);

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, MorphPlugins::new(FixedPostUpdate), game))
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
    // An anchored entity has its +Y out of the surface, so a hat is built upwards from 0.
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

/// Tries until there is something below: the model is being loaded, and its tree is being built.
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

/// In `Update`, between the steps of the game: what is smooth to look at. About the neck.
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
