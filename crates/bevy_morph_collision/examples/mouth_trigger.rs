//! Meatballs fly at a mouth that opens and closes. What gets in is eaten; what hits the lips or cheeks bounces off.
//!
//! You need no trigger volume that follows the mouth: the mouth itself is the trigger. A meatball is eaten if it touches teeth or tongue first, and bounces off if
//! it touches skin first. The lips cover the teeth exactly when they are drawn that way.
//!
//! In a clone of the repository: `BEVY_ASSET_ROOT=$PWD cargo run -p bevy_morph_collision --features cookbook --example mouth_trigger`
//!
//! For your game, replace `FACE`, `throw`, and `INSIDE`: if teeth and tongue are separate meshes, compare the `Name` of `start.collider1` instead.

use std::time::Duration;

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy::time::common_conditions::on_timer;
use bevy_morph_collision::prelude::*;

/// A file in the folder `assets`.
const FACE: &str = "mh_head_eyes_teeth_arkit52.glb";
/// The first triangle of teeth and tongue, which come last in this file.
const INSIDE: u32 = 8894;
/// The time between two meatballs.
const EVERY: Duration = Duration::from_millis(330);
pub(crate) const RADIUS: f32 = 0.07;

fn main() {
    App::new().add_plugins((DefaultPlugins, MorphPlugins, game)).run();
}

pub(crate) fn game(app: &mut App) {
    let throw = throw.run_if(resource_exists::<Hungry>).run_if(on_timer(EVERY));
    app.init_resource::<Score>()
        .add_systems(Startup, set_up)
        .add_systems(Update, (chew, throw, fly));
}

#[derive(Resource, Default, Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    pub(crate) eaten: u32,
    pub(crate) bounced: u32,
}

/// Exists once the face is ready to collide.
#[derive(Resource)]
struct Hungry;

#[derive(Component)]
pub(crate) struct Food {
    pub(crate) velocity: Vec3,
    /// Whether it has hit the face before. If so, it is not eaten any more.
    pub(crate) is_spent: bool,
}

fn set_up(mut commands: Commands, assets: Res<AssetServer>) {
    commands
        .spawn((
            WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(FACE))),
            MorphColliderScene::default(),
        ))
        .observe(|_: On<MorphColliderSceneReady>, mut commands: Commands| commands.insert_resource(Hungry))
        .observe(taste);
    commands.spawn((
        Camera3d::default(),
        Tonemapping::None,
        Transform::from_xyz(3.0, 7.5, 6.0).looking_at(Vec3::new(0.0, 6.8, 1.0), Vec3::Y),
        children![DirectionalLight::default()],
    ));
}

/// Opens and closes the mouth: about two seconds open, two seconds closed.
fn chew(time: Res<Time>, meshes: Res<Assets<Mesh>>, mut faces: Query<&mut MorphWeights>) {
    for mut face in &mut faces {
        let mesh = face.first_mesh().and_then(|mesh| meshes.get(mesh));
        let names = mesh.and_then(Mesh::morph_target_names);
        let jaw = names.and_then(|names| names.iter().position(|name| name == "jawOpen"));
        if let Some(jaw) = jaw {
            face.weights_mut()[jaw] = 0.5 - 0.5 * (1.5 * time.elapsed_secs()).cos();
        }
    }
}

/// Throws a meatball, usually at the mouth, sometimes slightly off.
fn throw(
    mut thrown: Local<usize>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let aims = [(0.0, 6.45), (0.1, 6.45), (0.45, 6.7), (-0.05, 6.5), (0.0, 6.85)];
    let (x, y) = aims[*thrown % aims.len()];
    *thrown += 1;
    commands.spawn((
        Food {
            velocity: Vec3::NEG_Z * 3.0,
            is_spent: false,
        },
        MorphShape::Ball { radius: RADIUS },
        Mesh3d(meshes.add(Sphere::new(RADIUS))),
        MeshMaterial3d(materials.add(Color::srgb(0.4, 0.15, 0.05))),
        Transform::from_xyz(x, y, 4.0),
    ));
}

fn fly(time: Res<Time>, mut commands: Commands, mut flying: Query<(Entity, &mut Food, &mut Transform)>) {
    for (entity, mut food, mut place) in &mut flying {
        if food.is_spent {
            food.velocity.y -= 9.81 * time.delta_secs();
        }
        place.translation += food.velocity * time.delta_secs();
        if place.translation.y < 4.0 || place.translation.z < -3.0 {
            commands.entity(entity).despawn();
        }
    }
}

/// Observes the face: runs once for each meatball, however many triangles it touches.
fn taste(
    start: On<MorphBodyCollisionStart>,
    collisions: Res<MorphCollisions>,
    mut flying: Query<&mut Food>,
    mut score: ResMut<Score>,
    mut commands: Commands,
) {
    let Ok(mut food) = flying.get_mut(start.body2) else {
        return;
    };
    // A ball has no triangles. Its index in the pair is larger than any triangle's.
    let mut touched = collisions
        .collisions_between_bodies(start.body1, start.body2)
        .flat_map(|contact| &contact.triangles)
        .map(|pair| pair.triangle_a.min(pair.triangle_b));
    if !food.is_spent && touched.any(|triangle| triangle >= INSIDE) {
        score.eaten += 1;
        info!("yum");
        commands.entity(start.body2).despawn();
        return;
    }
    if !food.is_spent {
        score.bounced += 1;
        info!("ouch");
    }
    food.is_spent = true;
    // The normal is the direction in which the face leaves the meatball. The meatball bounces the opposite way.
    let out = -start.normal;
    let speed = food.velocity.dot(out);
    food.velocity -= 1.6 * speed.min(0.0) * out;
}
