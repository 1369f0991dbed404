//! A talking face. Click on it, and the log tells you what you hit: "nose left", "jaw", "lower teeth".
//!
//! No zones are painted. Eyeballs, teeth and tongue are ranges of triangles. A point on the skin is named after the target that moves it most: what `jawOpen`
//! moves is the jaw, what `noseSneerLeft` moves is the left side of the nose. Pins mark the hits and follow the moving skin.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_collision --features cookbook --example face_zones`
//!
//! For your game, replace:
//!
//! - `FACE`: any glTF whose targets have such names works. Play a clip instead of `talk`.
//! - `PARTS`: if eyes and teeth are separate meshes, drop it and look at the `Name` of `hit.entity` instead.

use std::ops::Range;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

/// A file in the folder `assets`.
const FACE: &str = "mh_head_eyes_teeth_arkit52.glb";

/// This face is a single mesh. Exporters write one object after another, so each part is a range of triangles. The rest is skin.
const PARTS: [(Range<u32>, &str); 5] = [
    (8614..8754, "left eyeball"),
    (8754..8894, "right eyeball"),
    (8894..8990, "upper teeth"),
    (8990..9086, "lower teeth"),
    (9086..9534, "tongue"),
];

fn main() {
    App::new().add_plugins((DefaultPlugins, MorphPlugins, game)).run();
}

pub(crate) fn game(app: &mut App) {
    app.add_message::<Shot>()
        .add_systems(Startup, set_up)
        .add_systems(Update, (talk, aim, hit).chain());
}

/// A shot along a ray. Here it is a click; in your game it may be an arrow.
#[derive(Message)]
pub(crate) struct Shot(pub(crate) Ray3d);

#[derive(Resource)]
struct Pin(Handle<Mesh>, Handle<StandardMaterial>);

fn set_up(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(FACE))),
        MorphColliderScene::default(),
    ));
    commands.spawn((
        Camera3d::default(),
        Tonemapping::None,
        Transform::from_xyz(0.0, 7.2, 6.0).looking_at(Vec3::new(0.0, 7.1, 0.0), Vec3::Y),
        children![DirectionalLight::default()],
    ));
    let red = materials.add(Color::srgb(0.9, 0.1, 0.1));
    commands.insert_resource(Pin(meshes.add(Sphere::new(0.04)), red));
}

/// Sets the weights directly. An animation clip works as well: only the weights matter.
fn talk(time: Res<Time>, meshes: Res<Assets<Mesh>>, mut faces: Query<&mut MorphWeights>) {
    let t = time.elapsed_secs();
    for mut face in &mut faces {
        let mesh = face.first_mesh().and_then(|mesh| meshes.get(mesh));
        let Some(names) = mesh.and_then(Mesh::morph_target_names) else {
            continue;
        };
        for (name, weight) in names.iter().zip(face.weights_mut()) {
            *weight = match name.as_str() {
                "jawOpen" => 0.35 * (1.0 - (5.0 * t).cos()),
                "browInnerUp" => 0.5 + 0.5 * (1.3 * t).sin(),
                _ => 0.0,
            };
        }
    }
}

fn aim(
    buttons: Res<ButtonInput<MouseButton>>,
    window: Single<&Window>,
    camera: Single<(&Camera, &GlobalTransform)>,
    mut shots: MessageWriter<Shot>,
) {
    let (camera, place) = *camera;
    if buttons.just_pressed(MouseButton::Left)
        && let Some(cursor) = window.cursor_position()
        && let Ok(ray) = camera.viewport_to_world(place, cursor)
    {
        shots.write(Shot(ray));
    }
}

fn hit(
    mut shots: MessageReader<Shot>,
    spatial: MorphSpatialQuery,
    faces: Query<&Mesh3d>,
    meshes: Res<Assets<Mesh>>,
    pin: Res<Pin>,
    mut commands: Commands,
) {
    for Shot(ray) in shots.read() {
        let Some(hit) = spatial.cast_ray(ray.origin, ray.direction, f32::INFINITY, &MorphQueryFilter::default()) else {
            info!("missed");
            continue;
        };
        let mesh = faces.get(hit.entity).ok().and_then(|face| meshes.get(&face.0));
        let part = PARTS.iter().find(|(triangles, _)| triangles.contains(&hit.triangle));
        let part = part.map(|(_, name)| (*name).to_owned());
        let name = part.or_else(|| zone(mesh?, hit.triangle)).unwrap_or("head".into());
        info!("{name}");
        commands.spawn((
            Name::new(name),
            Mesh3d(pin.0.clone()),
            MeshMaterial3d(pin.1.clone()),
            MorphSurfaceAnchor::at(&hit),
        ));
    }
}

/// Names the zone after the target that moves the triangle most, if any target moves it noticeably.
fn zone(mesh: &Mesh, triangle: u32) -> Option<String> {
    let (names, moves) = (mesh.morph_target_names()?, mesh.morph_targets()?);
    let first = 3 * triangle as usize;
    let corners: Vec<usize> = match mesh.indices() {
        Some(indices) => indices.iter().skip(first).take(3).collect(),
        None => (first..first + 3).collect(),
    };
    // Bevy stores one target after another, each with all vertices.
    let vertices = mesh.count_vertices();
    let reach_of = |target: usize, corner: &usize| moves[target * vertices + corner].position.length();
    let reach = |target: usize| corners.iter().map(|corner| reach_of(target, corner)).sum::<f32>();
    let strongest = (0..names.len()).max_by(|&a, &b| reach(a).total_cmp(&reach(b)))?;
    let name = &names[strongest];
    let zone = name.split(char::is_uppercase).next()?;
    let side = ["Left", "Right"].into_iter().find(|side| name.ends_with(side));
    let zone = format!("{zone} {}", side.unwrap_or_default());
    (reach(strongest) > 0.03).then(|| zone.trim().to_lowercase())
}
