//! A boss with three plates of armour. Each hit dents a plate with a morph target, and the last one breaks it. Then the flesh behind it can be hit.
//!
//! A volley of three balls is one body, and so is the boss. `MorphCollisionStart` on a *plate* tells you which part was hit by which ball.
//! `MorphBodyCollisionStart` on the *boss* fires once per volley; play the sound there.
//!
//! To run it: `cargo run -p bevy_morph_collision --features cookbook --example boss_armour`
//! For your game, replace `plate` with glTF meshes that have targets for dents, and `volley` with whatever your players throw.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy::prelude::*;
use bevy::time::common_conditions::on_timer;
use bevy_morph_collision::prelude::*;

pub(crate) const DENT: f32 = 0.4;

fn main() {
    App::new().add_plugins((DefaultPlugins, MorphPlugins, game)).run();
}

pub(crate) fn game(app: &mut App) {
    let volley = volley.run_if(on_timer(core::time::Duration::from_secs(2)));
    app.add_systems(Startup, set_up).add_systems(Update, (volley, fly));
}

/// Counts the volleys that have hit the boss.
#[derive(Component)]
pub(crate) struct Boss(pub(crate) u32);

/// How many more hits a plate or the flesh can take.
#[derive(Component)]
pub(crate) struct Part(pub(crate) u32);

#[derive(Component)]
pub(crate) struct Volley;

/// A square sheet in the xy plane. Its only target pushes the middle in, towards -Z.
fn plate() -> Mesh {
    let mut mesh = Plane3d::new(Vec3::Z, Vec2::splat(0.6)).mesh().subdivisions(12).build();
    let positions = mesh.attribute(Mesh::ATTRIBUTE_POSITION);
    let positions = positions.and_then(|values| values.as_float3()).unwrap_or_default();
    let depth = |x, y| (1.0 - Vec2::new(x, y).length() / 0.6).max(0.0);
    let push = |&[x, y, _]: &[f32; 3]| MorphAttributes::new(Vec3::NEG_Z * DENT * depth(x, y), Vec3::ZERO, Vec3::ZERO);
    mesh.set_morph_targets(positions.iter().map(push).collect());
    mesh
}

fn set_up(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    // All child meshes become parts of one body: the rigid flesh as well as the morphing plates.
    let scene = MorphColliderScene {
        only_deforming: false,
        events: true,
        ..default()
    };
    let boss = (Boss(0), scene, Visibility::default());
    let boss = commands.spawn(boss).observe(cry).id();
    let [flesh, plate] = [Cuboid::new(4.2, 1.4, 0.8).into(), plate()].map(|mesh: Mesh| Mesh3d(meshes.add(mesh)));
    let steel = Color::srgb(0.5, 0.55, 0.6);
    let mut part = |health: u32, mesh: &Mesh3d, color: Color, place: Vec3| {
        let look = (mesh.clone(), MeshMaterial3d(materials.add(color)));
        let part = (Part(health), look, Transform::from_translation(place), ChildOf(boss));
        commands.spawn(part).observe(hit).id()
    };
    part(5, &flesh, Color::srgb(0.7, 0.2, 0.2), Vec3::NEG_Z * 1.2);
    for plate in [(-1.4, 2), (0.0, 3), (1.4, 4)].map(|(x, health)| part(health, &plate, steel, Vec3::X * x)) {
        let undented = MeshMorphWeights::Value { weights: vec![0.0] };
        commands.entity(plate).insert(undented);
    }
    commands.spawn((
        Camera3d::default(),
        Tonemapping::None,
        Transform::from_xyz(2.5, 2.5, 5.0).looking_at(Vec3::ZERO, Vec3::Y),
        children![DirectionalLight::default()],
    ));
}

/// Throws a volley. Does not run once all parts of the boss are broken, because then `Populated` finds none.
fn volley(
    old: Query<Entity, With<Volley>>,
    _alive: Populated<(), (With<Part>, Without<MorphColliderDisabled>)>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    old.iter().for_each(|volley| commands.entity(volley).despawn());
    let ball = Mesh3d(meshes.add(Sphere::new(0.15)));
    let volley = (Volley, Transform::from_xyz(0.0, 0.0, 5.0), Visibility::default());
    let volley = commands.spawn(volley).id();
    for x in [-1.4, 0.0, 1.4] {
        commands.spawn((
            MorphShape::Ball { radius: 0.15 },
            // The three balls are one body.
            MorphColliderOf { body: volley },
            (ball.clone(), MeshMaterial3d::<StandardMaterial>::default()),
            Transform::from_xyz(x, 0.0, 0.0),
            ChildOf(volley),
        ));
    }
}

/// Balls that stick to something have an anchor.
fn fly(time: Res<Time>, mut balls: Query<&mut Transform, (With<MorphShape>, Without<MorphSurfaceAnchor>)>) {
    for mut place in &mut balls {
        place.translation.z -= 5.0 * time.delta_secs();
    }
}

/// Observes each part: runs once for each ball that hits it.
fn hit(
    start: On<MorphCollisionStart>,
    mut parts: Query<(&mut Part, Option<&mut MeshMorphWeights>)>,
    collisions: Res<MorphCollisions>,
    mut commands: Commands,
) {
    let (part, ball) = (start.collider1, start.collider2);
    let Ok((mut health, weights)) = parts.get_mut(part) else {
        return;
    };
    health.0 = health.0.saturating_sub(1);
    if health.0 == 0 {
        // The whole volley goes with it, including the balls that stick to it.
        let broken = (MorphColliderDisabled, Visibility::Hidden);
        commands.entity(part).insert(broken);
        commands.entity(start.body2).try_despawn();
        return;
    }
    if let Some(mut weights) = weights {
        let dent = vec![1.0 / (1 + health.0) as f32];
        *weights = MeshMorphWeights::Value { weights: dent };
    }
    // The ball sticks where it hit and follows the dent, so it keeps touching the boss until the volley is despawned.
    let contact = collisions.get(part, ball);
    if let Some(pair) = contact.and_then(|contact| contact.triangles.first()) {
        // A ball has no triangles. Its index in the pair is larger than any triangle's.
        let triangle = pair.triangle_a.min(pair.triangle_b);
        let anchor = MorphSurfaceAnchor::new(part, triangle, Vec3::splat(1.0 / 3.0));
        // The ball may be despawned already, if its volley broke another part in this frame.
        commands.entity(ball).try_insert(anchor);
    }
}

/// Observes the boss: runs once for each volley, whatever it hits and however often.
fn cry(start: On<MorphBodyCollisionStart>, mut bosses: Query<&mut Boss>) {
    if let Ok(mut boss) = bosses.get_mut(start.body1) {
        boss.0 += 1;
        info!("clang, at {}", start.point);
    }
}
