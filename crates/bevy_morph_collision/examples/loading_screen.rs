//! A loading screen: a bar grows while models are loaded and their collision trees are built. Then the game starts, and everything collides from its first
//! frame on.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_collision --features cookbook --example loading_screen`
//!
//! For your game, replace `MODELS`, the bar, and what `start` does. A mesh that cannot be used counts as done, and so does a file that is missing: the log says why,
//! and the game starts without it.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// Files in the folder `assets`, each with its position and scale.
const MODELS: [(&str, Vec3, f32); 3] = [
    ("mh_head_eyes_teeth_arkit52.glb", Vec3::new(-2.5, -7.0, 0.0), 1.0),
    ("mh_character_low.glb", Vec3::ZERO, 0.25),
    ("dolphin_9024.glb", Vec3::new(2.5, 0.0, 0.0), 1.0),
];

fn main() {
    App::new().add_plugins((DefaultPlugins, MorphPlugins, game)).run();
}

pub(crate) fn game(app: &mut App) {
    app.add_systems(Startup, set_up)
        .add_systems(Update, (fill_bar, turn.run_if(resource_exists::<Playing>)))
        .add_observer(complain)
        .add_observer(start);
}

#[derive(Component)]
pub(crate) struct Model;

/// Marks a model whose parts are all ready to collide.
#[derive(Component)]
struct Ready;

#[derive(Component)]
pub(crate) struct Bar;

/// Exists once the game has started.
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
            // Hidden until the game starts.
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

/// A model has children once its file is loaded. It is ready without any if that failed.
type Loaded = (With<Model>, Or<(With<Children>, With<Ready>)>);

/// The first half of the bar is for loading files, the second half for building the trees of their colliders.
fn fill_bar(trees: Res<MorphTrees>, loaded: Query<(), Loaded>, bar: Single<&mut Transform, With<Bar>>) {
    let loaded = loaded.iter().count() as f32 / MODELS.len() as f32;
    // Before the first file is loaded, no tree has been requested and `fraction()` is 1, so weight it by `loaded`.
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

/// Starts the game when the last model is ready.
fn start(
    ready: On<MorphColliderSceneReady>,
    mut models: Query<(Entity, Has<Ready>, &mut Visibility), With<Model>>,
    bar: Option<Single<Entity, With<Bar>>>,
    mut commands: Commands,
) {
    // A scene may become ready more than once, for example when it gets another mesh.
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
