//! A face that speaks. Places where jaw, lips, teeth and tongue intersect are red, and pins stick to the skin.

use std::f32::consts::TAU;
use std::sync::Arc;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::morph_collision::{Pose, SelfQuery};
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::{MorphPick, MorphTrees};

use crate::view::Show;
use crate::view::clock::{Clock, Pending, is_typing, started};
use crate::view::models::{ModelPart, ModelRoot};
use crate::view::overlay::{OverlaySystems, SelfTouching};
use crate::view::pointer::{Clicks, Cue, Script};
use crate::view::stage::Notes;

/// The motion of the mouth, repeated: a target's name, cycles per second, phase at the start, and highest weight.
const SPEECH: [(&str, f32, f32, f32); 8] = [
    ("jawOpen", 0.5, 0.0, 0.9),
    ("tongueOut", 0.25, 0.55, 1.0),
    ("mouthPucker", 0.25, 0.25, 0.9),
    ("mouthRollLower", 0.5, 0.4, 0.9),
    ("mouthSmileLeft", 0.25, 0.8, 0.8),
    ("mouthSmileRight", 0.25, 0.8, 0.8),
    ("eyeBlinkLeft", 0.4, 0.3, 1.0),
    ("eyeBlinkRight", 0.4, 0.3, 1.0),
];

/// Colours of the skin, the tongue, and the rest: eyes and teeth.
const PIECES: [Color; 3] = [
    Color::srgb(0.87, 0.7, 0.61),
    Color::srgb(0.72, 0.42, 0.45),
    Color::srgb(0.96, 0.94, 0.9),
];

/// The height of the head.
const SIZE: f32 = 2.0;

/// The CC0 head.
#[must_use]
pub fn face() -> Show {
    Show {
        name: "face",
        about: "A head with eyes, teeth and tongue, 52 morph targets. Where it runs into itself is red.",
        keys: &[("click", "sticks a pin to the skin"), ("X", "removes the pins")],
        eye: Vec3::new(0.6, 0.1, 2.9),
        target: Vec3::new(-0.1, 0.0, 0.0),
        pictures: &[30, 60, 90, 140],
        scene: Box::new(|app| {
            let cues = PINS
                .iter()
                .zip((1..).step_by(3))
                .map(|(&at, frame)| Cue { frame, at, click: true });
            app.insert_resource(Script(cues.collect()))
                .add_systems(Startup, spawn)
                .add_systems(Update, (speak.run_if(started), remove_pins.run_if(not(is_typing))))
                .add_systems(
                    PostUpdate,
                    find_self_intersections
                        .after(MorphCollisionSystems::Weights)
                        .before(OverlaySystems),
                )
                .add_observer(stick_pin);
        }),
    }
}

/// Where pins are stuck in pictures: cheeks, chin, brow.
const PINS: [Vec3; 4] = [
    Vec3::new(0.32, -0.2, 0.7),
    Vec3::new(-0.22, -0.2, 0.75),
    Vec3::new(0.0, -0.52, 0.8),
    Vec3::new(0.2, 0.35, 0.8),
];

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let skin = StandardMaterial {
        perceptual_roughness: 0.65,
        double_sided: true,
        cull_mode: None,
        ..default()
    };
    commands.spawn((
        ModelRoot {
            model: assets.load("mh_head_eyes_teeth_arkit52.glb"),
            size: SIZE,
            material: skin,
            pieces: &PIECES,
            dress: |part| {
                part.insert((MorphCollider::new(MorphCollisionMode::Passive), SelfTouching::default()));
            },
        },
        Pending,
        Visibility::default(),
        Transform::default(),
    ));
}

fn speak(
    mut faces: Query<(&Mesh3d, &mut MeshMorphWeights), With<ModelPart>>,
    meshes: Res<Assets<Mesh>>,
    clock: Res<Clock>,
) {
    let seconds = clock.frame as f32 / 60.0;
    for (mesh, mut weights) in &mut faces {
        let names = meshes.get(&mesh.0).and_then(Mesh::morph_target_names);
        let (Some(names), MeshMorphWeights::Value { weights }) = (names, &mut *weights) else {
            continue;
        };
        weights.fill(0.0);
        for (target, cycles, phase, highest) in SPEECH {
            let slot = names
                .iter()
                .position(|name| name == target)
                .and_then(|slot| weights.get_mut(slot));
            if let Some(weight) = slot {
                *weight = highest * (TAU * (cycles * seconds - phase)).sin().max(0.0);
            }
        }
    }
}

/// The plugin compares bodies with each other. To compare a body with itself, this asks the core library, with a pose of the
/// same tree.
fn find_self_intersections(
    mut faces: Query<(&Mesh3d, &MeshMorphWeights, &mut SelfTouching)>,
    trees: Res<MorphTrees>,
    mut notes: ResMut<Notes>,
    mut kept: Local<Option<Pose>>,
) {
    for (mesh, weights, mut touching) in &mut faces {
        let (Some(tree), MeshMorphWeights::Value { weights }) = (trees.get(mesh.id()), weights) else {
            continue;
        };
        let pose = match &mut *kept {
            Some(pose) if Arc::ptr_eq(pose.bvh(), tree) => pose,
            other => other.insert(Pose::new(tree.clone())),
        };
        if pose.set_weights(weights).is_err() {
            continue;
        }
        touching.0.clear();
        let mut query = SelfQuery::new();
        query.all(pose, &mut touching.0);
        let stats = query.stats();
        notes.0 = vec![
            ("self-intersections", format!("{} pairs", touching.0.len())),
            ("nodes refitted for it", stats.nodes_blended.to_string()),
            ("exact tests for it", stats.triangle_tests.to_string()),
        ];
    }
}

#[derive(Component)]
struct Pin;

fn stick_pin(
    click: On<PointerClick>,
    clicks: Clicks,
    parts: Query<(), With<ModelPart>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    if !clicks.is_plain(&click) || !parts.contains(click.entity) {
        return;
    }
    let Some(pick) = click.hit.extra_as::<MorphPick>() else {
        return;
    };
    const LENGTH: f32 = 0.16;
    let anchor = MorphSurfaceAnchor::new(click.entity, pick.triangle, pick.barycentrics);
    let blue = materials.add(Color::srgb(0.15, 0.35, 0.85));
    // +Y points out of the surface.
    commands
        .spawn((Pin, anchor, Visibility::default()))
        .with_children(|pin| {
            pin.spawn((
                Mesh3d(meshes.add(Cylinder::new(0.008, LENGTH))),
                MeshMaterial3d(blue.clone()),
                Transform::from_xyz(0.0, 0.5 * LENGTH, 0.0),
            ));
            pin.spawn((
                Mesh3d(meshes.add(Sphere::new(0.03))),
                MeshMaterial3d(blue.clone()),
                Transform::from_xyz(0.0, LENGTH, 0.0),
            ));
        });
}

fn remove_pins(keys: Res<ButtonInput<KeyCode>>, pins: Query<Entity, With<Pin>>, mut commands: Commands) {
    if keys.just_pressed(KeyCode::KeyX) {
        pins.iter().for_each(|pin| commands.entity(pin).despawn());
    }
}
