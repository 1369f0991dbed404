//! Morphing and skinned models under the pointer: picking hits exactly what is drawn.

use std::path::Path;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::picking::hover::HoverMap;
use bevy::prelude::*;
use bevy_morph_collision::MorphPick;
use bevy_morph_collision::prelude::*;

use crate::physics::wobbling;
use crate::view::Show;
use crate::view::clock::{Clock, Pending, started};
use crate::view::models::{ModelPart, ModelRoot, Plays, scene};
use crate::view::pointer::{Clicks, Cue, Script};
use crate::view::stage::Notes;

/// Models that can be hovered and clicked.
#[must_use]
pub fn picking() -> Show {
    Show {
        name: "picking",
        about: "Point at a model: the arrow stands on the triangle that is hit, as it is morphed and posed now.",
        keys: &[("click", "paints the model")],
        eye: Vec3::new(0.6, 0.5, 6.6),
        target: Vec3::new(0.6, -0.1, 0.0),
        pictures: &[20, 60, 100, 140],
        scene: Box::new(|app| {
            let cue = |frame, x, y, click| Cue {
                frame,
                at: Vec3::new(x, y, 0.0),
                click,
            };
            app.insert_resource(Script(vec![
                cue(18, -1.6, 0.0, false),
                cue(56, 0.6, 0.3, true),
                cue(98, 2.5, 0.2, false),
                cue(136, 4.1, 0.35, false),
            ]))
            .add_systems(Startup, spawn)
            .add_systems(Update, (wobble.run_if(started), point))
            .add_observer(clicked);
        }),
    }
}

/// Marks the arrow at the place under the pointer.
#[derive(Component, Clone, Copy, Debug)]
pub struct Arrow;

fn spawn(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let dolphin = Path::new("dolphin_2256.glb");
    commands.spawn((
        scene(&assets, dolphin),
        Plays::from(&assets, dolphin, 0.0),
        MorphColliderScene {
            collider: MorphCollider::new(MorphCollisionMode::Passive),
            ..default()
        },
        Transform::from_xyz(-1.6, 0.0, 0.0).with_rotation(Quat::from_rotation_y(0.9)),
    ));
    let character = Path::new("mh_character_low.glb");
    commands.spawn((
        scene(&assets, character),
        Plays::from(&assets, character, 0.0),
        MorphColliderScene {
            collider: MorphCollider::new(MorphCollisionMode::Passive),
            ..default()
        },
        // The model is in decimetres.
        Transform::from_xyz(4.1, 0.0, 0.0)
            .with_rotation(Quat::from_rotation_y(-0.5))
            .with_scale(Vec3::splat(0.11)),
    ));
    let models = [
        ("pass_through_20480.glb", 0.5, Color::srgb(0.45, 0.62, 0.5)),
        ("mh_head_eyes_teeth_arkit52.glb", 2.4, Color::srgb(0.85, 0.68, 0.6)),
    ];
    for (file, x, base_color) in models {
        commands.spawn((
            ModelRoot {
                model: assets.load(file),
                size: 1.8,
                material: StandardMaterial {
                    base_color,
                    ..default()
                },
                pieces: &[],
                dress: |part| {
                    part.insert(MorphCollider::new(MorphCollisionMode::Passive));
                },
            },
            Pending,
            Visibility::default(),
            Transform::from_xyz(x, 0.0, 0.0),
        ));
    }
    let blue = materials.add(Color::srgb(0.1, 0.3, 0.9));
    commands
        .spawn((Arrow, Visibility::Hidden, Transform::default()))
        .with_children(|arrow| {
            let tip = Cone {
                radius: 0.05,
                height: 0.15,
            };
            arrow.spawn((
                Mesh3d(meshes.add(tip)),
                MeshMaterial3d(blue.clone()),
                Transform::from_xyz(0.0, 0.075, 0.0).with_rotation(Quat::from_rotation_x(std::f32::consts::PI)),
                Pickable::IGNORE,
            ));
            arrow.spawn((
                Mesh3d(meshes.add(Cylinder::new(0.015, 0.3))),
                MeshMaterial3d(blue.clone()),
                Transform::from_xyz(0.0, 0.3, 0.0),
                Pickable::IGNORE,
            ));
        });
}

fn wobble(mut models: Query<&mut MeshMorphWeights, With<ModelPart>>, clock: Res<Clock>) {
    for mut weights in &mut models {
        if let MeshMorphWeights::Value { weights } = &mut *weights {
            let count = weights.len();
            weights.clone_from(&wobbling(clock.frame as f32 / 60.0 + 1.0, count));
        }
    }
}

/// A click changes the model's colour.
fn clicked(
    click: On<PointerClick>,
    clicks: Clicks,
    mut drawn: Query<&mut MeshMaterial3d<StandardMaterial>, With<MorphCollider>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut painted: Local<u32>,
) {
    if let Ok(mut material) = drawn.get_mut(click.entity)
        && clicks.is_plain(&click)
    {
        *painted += 1;
        material.0 = materials.add(Color::hsl(137.5 * *painted as f32 % 360.0, 0.6, 0.6));
    }
}

/// Queries the pointer every frame, because the model may move while the pointer stands still.
fn point(
    hover: Res<HoverMap>,
    names: Query<&Name>,
    mut arrow: Single<(&mut Transform, &mut Visibility), With<Arrow>>,
    mut notes: ResMut<Notes>,
) {
    let (place, visibility) = &mut *arrow;
    let mut hits = hover.values().flatten();
    let found =
        hits.find_map(|(&entity, hit)| Some((entity, hit.position?, hit.normal?, *hit.extra_as::<MorphPick>()?)));
    let Some((entity, at, normal, pick)) = found else {
        **visibility = Visibility::Hidden;
        notes.0 = vec![("pointed at", "nothing".into())];
        return;
    };
    **visibility = Visibility::Visible;
    **place = Transform::from_translation(at).with_rotation(Quat::from_rotation_arc(Vec3::Y, normal));
    let name = names
        .get(entity)
        .map_or_else(|_| entity.to_string(), ToString::to_string);
    let [u, v, w] = pick.barycentrics.to_array();
    let uv = pick.uv.map_or("none".into(), |uv| format!("{:.2} {:.2}", uv.x, uv.y));
    let joint = pick.joint.and_then(|joint| names.get(joint).ok());
    notes.0 = vec![
        ("pointed at", name),
        ("joint", joint.map_or("none".into(), ToString::to_string)),
        ("triangle", pick.triangle.to_string()),
        ("barycentrics", format!("{u:.2} {v:.2} {w:.2}")),
        ("uv", uv),
    ];
}
