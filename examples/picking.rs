//! Models under the pointer, morphing or moved by joints: what is drawn is what is hit.
//!
//! `MorphPickingPlugin` is a backend for Bevy's picking. A model that has a collider gets Bevy's pointer events, and a hit
//! says which triangle is under the pointer ([`MorphPick`]).
//!
//! `game` is what you would copy; the gallery adds camera, light and panel. `--help` lists the options.

use std::path::Path;
use std::process::ExitCode;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::picking::hover::HoverMap;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::surface::MorphPick;
use morph_collision_workspace::physics::wobbling;
use morph_collision_workspace::view::clock::{Clock, Pending, started};
use morph_collision_workspace::view::marks::Marks;
use morph_collision_workspace::view::models::{ModelPart, ModelRoot, Plays, scene};
use morph_collision_workspace::view::pointer::{Clicks, Cue, Script};
use morph_collision_workspace::view::stage::Notes;
use morph_collision_workspace::view::{self, Demo};

fn main() -> ExitCode {
    view::main(demo())
}

/// Models that can be hovered and clicked.
#[must_use]
pub fn demo() -> Demo {
    Demo {
        name: "picking",
        about: "Point at a model: the arrow stands on the triangle that is hit, as it is morphed and posed now.",
        keys: &[("click", "paints the model")],
        eye: Vec3::new(0.6, 0.5, 6.6),
        target: Vec3::new(0.6, -0.1, 0.0),
        pictures: &[20, 60, 100, 140],
        scene: Box::new(|app| {
            // Where to point in pictures, because there is no mouse.
            let script = [(18, -1.6, 0.0), (56, 0.6, 0.3), (98, 2.5, 0.2), (136, 4.1, 0.35)].map(|(frame, x, y)| Cue {
                frame,
                at: Vec3::new(x, y, 0.0),
                click: frame == 56,
            });
            app.insert_resource(Script(script.into())).add_plugins(game);
        }),
    }
}

fn game(app: &mut App) {
    app.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin, MorphPickingPlugin))
        .add_systems(Startup, spawn)
        .add_systems(Update, (wobble.run_if(started), point))
        .add_observer(paint);
}

/// Marks the arrow at the place under the pointer.
#[derive(Component, Clone, Copy, Debug)]
pub struct Arrow;

fn spawn(mut commands: Commands, assets: Res<AssetServer>, mut marks: Marks) {
    // A passive collider can be picked. It is never compared with others, so it costs nothing while nobody points at it.
    let passive = || MorphCollider::new(MorphCollisionMode::Passive);
    let turned = |x: f32, angle: f32| Transform::from_xyz(x, 0.0, 0.0).with_rotation(Quat::from_rotation_y(angle));
    for (file, place) in [
        ("dolphin_2256.glb", turned(-1.6, 0.9)),
        // This model is in decimetres.
        ("mh_character_low.glb", turned(4.1, -0.5).with_scale(Vec3::splat(0.11))),
    ] {
        let collider = passive();
        // All meshes of the scene get this collider.
        let colliders = MorphColliderScene { collider, ..default() };
        let plays = Plays::from(&assets, Path::new(file), 0.0);
        commands.spawn((scene(&assets, Path::new(file)), plays, colliders, place));
    }
    for (file, x, base_color) in [
        ("pass_through_20480.glb", 0.5, Color::srgb(0.45, 0.62, 0.5)),
        ("mh_head_eyes_teeth_arkit52.glb", 2.4, Color::srgb(0.85, 0.68, 0.6)),
    ] {
        let model = ModelRoot {
            model: assets.load(file),
            size: 1.8,
            material: base_color.into(),
            pieces: &[],
            // Each mesh gets a collider of its own.
            dress: |part| _ = part.insert(MorphCollider::new(MorphCollisionMode::Passive)),
        };
        commands.spawn((model, Pending, Visibility::default(), turned(x, 0.0)));
    }
    let arrow = marks.arrow(Color::srgb(0.1, 0.3, 0.9));
    commands.spawn((Arrow, Visibility::Hidden, Transform::default(), arrow));
}

fn wobble(mut models: Query<&mut MeshMorphWeights, With<ModelPart>>, clock: Res<Clock>) {
    for mut weights in &mut models {
        if let MeshMorphWeights::Value { weights } = &mut *weights {
            *weights = wobbling(clock.frame as f32 / 60.0 + 1.0, weights.len());
        }
    }
}

/// A click changes the model's colour.
fn paint(
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

/// Reads the hit in every frame instead of observing the pointer, because the model may move while the pointer stands still.
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
    let name = |entity: Entity| names.get(entity).map(ToString::to_string).ok();
    let [u, v, w] = pick.barycentrics.to_array();
    let uv = pick.uv.map(|uv| format!("{:.2} {:.2}", uv.x, uv.y));
    notes.0 = vec![
        ("pointed at", name(entity).unwrap_or(entity.to_string())),
        // The joint that moves the place most.
        ("joint", pick.joint.and_then(name).unwrap_or("none".into())),
        ("triangle", pick.triangle.to_string()),
        ("barycentrics", format!("{u:.2} {v:.2} {w:.2}")),
        ("uv", uv.unwrap_or("none".into())),
    ];
}
