//! A loading screen: a bar grows while models are loaded and their collision trees are built; then the game starts, once, and everything collides from its
//! first frame on.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_collision --example loading_screen`
//!
//! Yours to replace: `MODELS`; the bar; what happens in `start`. A mesh that cannot be used counts as done, and the log says why; a file
//! that is missing is waited for.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// In the folder `assets`, with where they stand and how large they are.
const MODELS: [(&str, Vec3, f32); 3] = [
    ("mh_head_eyes_teeth_arkit52.glb", Vec3::new(-2.5, -7.0, 0.0), 1.0),
    ("mh_character_low.glb", Vec3::ZERO, 0.25),
    ("dolphin_9024.glb", Vec3::new(2.5, 0.0, 0.0), 1.0),
];

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, MorphPlugins::default(), game))
        .run();
}

pub(crate) fn game(app: &mut App) {
    app.add_systems(Startup, set_up)
        .add_systems(Update, (fill_bar, turn.run_if(resource_exists::<Playing>)))
        .add_observer(complain)
        .add_observer(start);
}

#[derive(Component)]
pub(crate) struct Model;

/// A model whose parts all collide.
#[derive(Component)]
struct Ready;

#[derive(Component)]
pub(crate) struct Bar;

/// There from when the game runs.
#[derive(Resource)]
pub(crate) struct Playing;

fn set_up(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (file, place, size) in MODELS {
        commands.spawn((
            Model,
            WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(file))),
            MorphColliderScene::default(),
            Transform::from_translation(place).with_scale(Vec3::splat(size)),
            // The curtain.
            Visibility::Hidden,
        ));
    }
    commands.spawn((
        Bar,
        Mesh3d(meshes.add(Cuboid::new(4.0, 0.2, 0.2))),
        MeshMaterial3d(materials.add(Color::srgb(0.2, 0.7, 0.3))),
        Transform::from_scale(Vec3::new(0.0, 1.0, 1.0)),
    ));
    commands.spawn((
        Camera3d::default(),
        Tonemapping::None,
        Transform::from_xyz(0.0, 0.5, 8.0).looking_at(Vec3::ZERO, Vec3::Y),
        children![DirectionalLight::default()],
    ));
}

/// Half of the bar is for files, which bring their colliders with them, and half for the trees of these.
fn fill_bar(trees: Res<MorphTrees>, roots: Query<Has<Children>, With<Model>>, bar: Single<&mut Transform, With<Bar>>) {
    let loaded = roots.iter().filter(|&is_there| is_there).count() as f32 / MODELS.len() as f32;
    // Before the first file is there nobody has asked for a tree, and none is missing.
    let filled = 0.5 * loaded + 0.5 * loaded * trees.progress().fraction();
    let mut bar = bar.into_inner();
    bar.scale.x = bar.scale.x.max(filled);
    bar.translation.x = 2.0 * (bar.scale.x - 1.0);
}

fn complain(failed: On<MorphColliderFailed>, names: Query<NameOrEntity>) {
    if let Ok(name) = names.get(failed.entity) {
        warn!("{name} will not collide: {}", failed.reason);
    }
}

/// When the last model is ready.
fn start(
    ready: On<MorphColliderSceneReady>,
    mut models: Query<(Entity, Has<Ready>, &mut Visibility), With<Model>>,
    bar: Option<Single<Entity, With<Bar>>>,
    mut commands: Commands,
) {
    // A scene may become ready again: when it gets another mesh, for example.
    commands.entity(ready.entity).insert(Ready);
    let is_last = models
        .iter()
        .all(|(model, is_ready, _)| is_ready || model == ready.entity);
    if let Some(bar) = bar.filter(|_| is_last) {
        commands.entity(*bar).despawn();
        commands.insert_resource(Playing);
        models
            .iter_mut()
            .for_each(|(.., mut curtain)| *curtain = Visibility::Visible);
        info!("the game starts");
    }
}

fn turn(time: Res<Time>, mut models: Query<&mut Transform, With<Model>>) {
    for mut model in &mut models {
        model.rotate_y(time.delta_secs());
    }
}
