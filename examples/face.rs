//! A face speaks. Places where jaw, lips, teeth and tongue intersect are red. Click to stick pins to the skin.
//!
//! - `MorphSelfCollisions` finds where a mesh intersects itself.
//! - `MorphSurfaceAnchor` keeps each pin on its triangle while the skin moves.
//!
//! `game` is what you would copy; the gallery adds camera, light and panel. `--help` lists the options.

use std::f32::consts::TAU;
use std::process::ExitCode;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::surface::MorphPick;
use morph_collision_workspace::view::clock::{Clock, Pending, started};
use morph_collision_workspace::view::marks::Marks;
use morph_collision_workspace::view::models::{ModelPart, ModelRoot};
use morph_collision_workspace::view::pointer::{Clicks, Script, remove_by_key};
use morph_collision_workspace::view::stage::Notes;
use morph_collision_workspace::view::{self, Demo};

/// The motion of the mouth, repeated: how a target's name begins, cycles per second, phase at the start, and highest weight.
const SPEECH: [(&str, f32, f32, f32); 6] = [
    ("jawOpen", 0.5, 0.0, 0.9),
    ("tongueOut", 0.25, 0.55, 1.0),
    ("mouthPucker", 0.25, 0.25, 0.9),
    ("mouthRollLower", 0.5, 0.4, 0.9),
    ("mouthSmile", 0.25, 0.8, 0.8),
    ("eyeBlink", 0.4, 0.3, 1.0),
];

/// Colours of the skin, the tongue, and the rest: eyes and teeth.
const PIECES: [Color; 3] = [
    Color::srgb(0.87, 0.7, 0.61),
    Color::srgb(0.72, 0.42, 0.45),
    Color::srgb(0.96, 0.94, 0.9),
];

/// Where pins are stuck in pictures: cheeks, chin, brow.
const PINS: [Vec3; 4] = [
    Vec3::new(0.32, -0.2, 0.7),
    Vec3::new(-0.22, -0.2, 0.75),
    Vec3::new(0.0, -0.52, 0.8),
    Vec3::new(0.2, 0.35, 0.8),
];

fn main() -> ExitCode {
    view::main(demo())
}

/// The CC0 head.
#[must_use]
pub fn demo() -> Demo {
    Demo {
        name: "face",
        about: "A head with eyes, teeth and tongue, 52 morph targets. Where it runs into itself is red.",
        keys: &[("click", "sticks a pin to the skin"), ("X", "removes the pins")],
        eye: Vec3::new(0.6, 0.1, 2.9),
        target: Vec3::new(-0.1, 0.0, 0.0),
        pictures: &[30, 60, 90, 140],
        scene: Box::new(|app| {
            app.insert_resource(Script::clicks(&PINS)).add_plugins(game);
        }),
    }
}

fn game(app: &mut App) {
    app.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin, MorphPickingPlugin))
        .add_systems(Startup, spawn)
        .add_systems(Update, (speak.run_if(started), write_notes, remove_by_key::<Pin>))
        .add_observer(stick_pin);
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let model = ModelRoot {
        model: assets.load("mh_head_eyes_teeth_arkit52.glb"),
        size: 2.0,
        material: StandardMaterial {
            perceptual_roughness: 0.65,
            double_sided: true,
            cull_mode: None,
            ..default()
        },
        pieces: &PIECES,
        dress: |mesh| {
            // Passive: it is only compared with itself, and can be picked.
            let collider = MorphCollider::new(MorphCollisionMode::Passive);
            // Also what intersects at rest: eyes lie in their sockets.
            mesh.insert((collider, MorphSelfCollisions::default().with_rest(true)));
        },
    };
    commands.spawn((model, Pending, Visibility::default(), Transform::default()));
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
        for (name, weight) in names.iter().zip(weights) {
            let part = SPEECH.iter().find(|(target, ..)| name.starts_with(target));
            *weight = part.map_or(0.0, |&(_, cycles, phase, highest)| {
                highest * (TAU * (cycles * seconds - phase)).sin().max(0.0)
            });
        }
    }
}

/// Where the face intersects itself: regions of connected triangles, which the gallery draws in red.
fn write_notes(faces: Query<&MorphSelfCollisions>, mut notes: ResMut<Notes>) {
    for face in &faces {
        let pairs: usize = face.regions().iter().map(|region| region.triangles.len()).sum();
        notes.0 = vec![
            ("self-intersections", format!("{pairs} pairs")),
            ("in regions", face.regions().len().to_string()),
        ];
    }
}

#[derive(Component)]
struct Pin;

/// A picking hit names the triangle and the place on it: all that an anchor needs.
fn stick_pin(
    click: On<PointerClick>,
    clicks: Clicks,
    faces: Query<(), With<MorphCollider>>,
    mut marks: Marks,
    mut commands: Commands,
) {
    if let Some(pick) = click.hit.extra_as::<MorphPick>()
        && faces.contains(click.entity)
        && clicks.is_plain(&click)
    {
        let anchor = MorphSurfaceAnchor::new(click.entity, pick.triangle, pick.barycentrics);
        let pin = marks.pin(Color::srgb(0.15, 0.35, 0.85), 0.16);
        commands.spawn((Pin, anchor, Visibility::default(), pin));
    }
}
