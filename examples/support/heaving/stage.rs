//! Draws the game, and turns keys into wishes of the player.

use bevy::light::CascadeShadowConfigBuilder;
use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;

use super::{Falling, Form, GROUND, HALF_SEGMENT, Hill, Player, RADIUS, Tally, Wish};
use crate::view::clock::{PauseKey, Pending, is_typing};
use crate::view::sliders::SliderSystems;
use crate::view::smooth::{self, Smooth};
use crate::view::stage::{Notes, StageCamera};

/// Draws the game, and lets the user play it.
pub fn plugin(app: &mut App) {
    app.insert_resource(PauseKey(KeyCode::KeyP, "P"))
        .add_plugins(smooth::plugin)
        // Physics reads the weights that are drawn.
        .configure_sets(PostUpdate, SliderSystems.before(TransformSystems::Propagate))
        .add_systems(PostStartup, (wait, cast_shadows, light_the_ground))
        .add_systems(
            PreUpdate,
            listen.after(bevy::input::InputSystems).run_if(not(is_typing)),
        )
        .add_systems(Update, (begin, dress, turn, write_notes));
}

/// Marks a show whose game has not begun.
#[derive(Component)]
struct Loading;

fn wait(mut commands: Commands, hills: Query<Entity, With<Hill>>) {
    for hill in &hills {
        commands.entity(hill).insert(Pending);
    }
    commands.spawn((Loading, Pending));
}

fn begin(mut commands: Commands, players: Query<(), With<Player>>, loading: Query<Entity, With<Loading>>) {
    if !players.is_empty() {
        loading.iter().for_each(|entity| commands.entity(entity).despawn());
    }
}

/// A low sun, because its shadows show what stands on what, and how the hill moves.
fn cast_shadows(mut commands: Commands, mut lights: Query<(Entity, &mut DirectionalLight)>) {
    let brightest = lights
        .iter_mut()
        .max_by(|a, b| a.1.illuminance.total_cmp(&b.1.illuminance));
    if let Some((entity, mut light)) = brightest {
        light.shadow_maps_enabled = true;
        light.illuminance *= 1.6;
        let cascades = CascadeShadowConfigBuilder {
            num_cascades: 1,
            maximum_distance: 30.0,
            ..default()
        };
        let low = Transform::from_xyz(-4.0, 2.2, 0.6).looking_at(Vec3::ZERO, Vec3::Y);
        commands.entity(entity).insert((cascades.build(), low));
    }
}

fn light_the_ground(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::from_size(2.0 * GROUND))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.82, 0.80, 0.74),
            perceptual_roughness: 0.95,
            ..default()
        })),
        Transform::from_xyz(0.0, -GROUND.y, 0.0),
    ));
}

/// Turns keys into walking directions as seen from the camera.
fn listen(
    keys: Res<ButtonInput<KeyCode>>,
    camera: Single<&GlobalTransform, With<StageCamera>>,
    mut wish: ResMut<Wish>,
) {
    let axis =
        |more: [KeyCode; 2], less: [KeyCode; 2]| f32::from(keys.any_pressed(more)) - f32::from(keys.any_pressed(less));
    let right = axis(
        [KeyCode::KeyD, KeyCode::ArrowRight],
        [KeyCode::KeyA, KeyCode::ArrowLeft],
    );
    let ahead = axis([KeyCode::KeyW, KeyCode::ArrowUp], [KeyCode::KeyS, KeyCode::ArrowDown]);
    let camera_right = camera.right().xz().normalize_or_zero();
    // Also correct for a camera that looks straight down.
    let camera_ahead = -camera_right.perp();
    wish.walk = (right * camera_right + ahead * camera_ahead).clamp_length_max(1.0);
    wish.jump |= keys.just_pressed(KeyCode::Space);
}

/// The part of the player that is drawn and turns.
#[derive(Component)]
struct Figure;

/// Draws the player and the rain.
fn dress(
    players: Query<Entity, Added<Player>>,
    bodies: Query<(Entity, &Falling), Added<Falling>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for player in &players {
        let [suit, visor, pack] = [
            (Color::srgb(0.95, 0.42, 0.08), 0.5),
            (Color::srgb(0.07, 0.10, 0.16), 0.15),
            (Color::srgb(0.98, 0.95, 0.88), 0.6),
        ]
        .map(|(base_color, perceptual_roughness)| {
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color,
                perceptual_roughness,
                ..default()
            }))
        });
        let body = Mesh3d(meshes.add(Capsule3d::new(RADIUS, 2.0 * HALF_SEGMENT)));
        let eyes = Mesh3d(meshes.add(Capsule3d::new(0.5 * RADIUS, 0.6 * RADIUS)));
        let load = Mesh3d(meshes.add(Cuboid::new(1.1 * RADIUS, 1.5 * RADIUS, 0.6 * RADIUS)));
        let lying = Transform::from_xyz(0.0, 0.95 * HALF_SEGMENT, 0.62 * RADIUS)
            .with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
        let behind = Transform::from_xyz(0.0, 0.1, -RADIUS);
        commands.entity(player).with_children(|player| {
            player
                .spawn((Figure, Smooth::default(), Transform::default(), body, suit))
                .with_children(|figure| {
                    figure.spawn((eyes, visor, lying));
                    figure.spawn((load, pack, behind));
                });
        });
    }
    if bodies.is_empty() {
        return;
    }
    // Pale, so that the player stands out.
    let colors: Vec<_> = (0..6)
        .map(|i| materials.add(Color::hsl(35.0 * i as f32 + 160.0, 0.35, 0.72)))
        .collect();
    let (ball, cuboid) = (meshes.add(Sphere::new(1.0)), meshes.add(Cuboid::from_length(2.0)));
    for (body, falling) in &bodies {
        let (mesh, size) = match falling.form {
            Form::Ball(radius) => (ball.clone(), Vec3::splat(radius)),
            Form::Cuboid(half) => (cuboid.clone(), half),
        };
        // The drawn mesh is scaled to the collider's size.
        let place = Transform::from_scale(size);
        let color = colors[falling.number as usize / 2 % colors.len()].clone();
        commands
            .entity(body)
            .with_child((Smooth::at(place), place, Mesh3d(mesh), MeshMaterial3d(color)));
    }
}

fn turn(mut figures: Query<(&mut Smooth, &ChildOf), With<Figure>>, players: Query<&Player>) {
    for (mut figure, parent) in &mut figures {
        if let Ok(player) = players.get(parent.parent()) {
            figure.own.rotation = Quat::from_rotation_y(player.facing);
        }
    }
}

fn write_notes(
    diagnostics: Res<MorphPhysicsDiagnostics>,
    bodies: Query<(), With<Falling>>,
    grounds: Query<(&Player, &MorphCharacterGround)>,
    tally: Res<Tally>,
    mut notes: ResMut<Notes>,
) {
    let (place, speed) = grounds
        .iter()
        .next()
        .map_or(("not there yet", 0.0), |(player, ground)| {
            let place = match (ground.surface, player.airborne > 0.0) {
                (Some(_), _) => "on the hill",
                (None, true) => "in the air",
                (None, false) => "on the ground",
            };
            (place, ground.velocity.length())
        });
    notes.0 = vec![
        ("player", place.into()),
        ("carried at", format!("{speed:.2} units/s")),
        (
            "steps on its feet",
            format!("{:.1} %", 100.0 * tally.share(tally.grounded)),
        ),
        ("bodies", bodies.iter().count().to_string()),
        ("parts of surfaces near", diagnostics.parts.to_string()),
    ];
}
