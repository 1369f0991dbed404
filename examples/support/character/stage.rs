//! Draws the character, its crates and darts, and where its hand touches its face.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::surface::MorphPick;
use bevy_morph_rapier::prelude::*;

use super::{Character, Crate, Dart, GROUND, HALF, HandOnFace, Moment, Skin, Tally};
use crate::view::clock::{Clock, Pending};
use crate::view::marks::Marks;
use crate::view::overlay::{OverlaySystems, SelfTouching};
use crate::view::pointer::{Clicks, remove_by_key};
use crate::view::stage::Notes;

/// Keeps the game's time, draws, and lets the user stick darts to the skin.
pub fn plugin(app: &mut App) {
    app.add_systems(Startup, light_the_ground)
        .add_systems(PreUpdate, (wait, keep_time))
        .add_systems(Update, (color, draw, remove_by_key::<Dart>, write_notes))
        .add_systems(
            PostUpdate,
            show_touching
                .after(MorphCollisionSystems::Anchors)
                .before(OverlaySystems),
        )
        .add_observer(stick_dart);
}

/// Waits until the character has its clips and its tree.
fn wait(
    roots: Query<(Entity, Has<Pending>), With<Character>>,
    skins: Query<(&Mesh3d, &SkinnedMesh), With<Skin>>,
    players: Query<(), With<AnimationGraphHandle>>,
    trees: Res<MorphTrees>,
    clock: Res<Clock>,
    mut commands: Commands,
) {
    for (root, is_pending) in &roots {
        let is_there = skins
            .single()
            .is_ok_and(|(mesh, skin)| trees.shown_with(mesh, None, Some(skin)).is_some());
        let waits = !(is_there && !players.is_empty());
        if is_pending && !waits {
            commands.entity(root).remove::<Pending>();
        } else if !is_pending && waits && !clock.started {
            commands.entity(root).insert(Pending);
        }
    }
}

fn keep_time(clock: Res<Clock>, mut moment: ResMut<Moment>) {
    *moment = Moment {
        seconds: clock.frame as f32 / 60.0,
        started: clock.started,
    };
}

fn light_the_ground(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::from_size(2.0 * GROUND))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.82, 0.84))),
        Transform::from_xyz(0.0, -GROUND.y, 0.0),
    ));
}

/// A mannequin's colour.
fn color(
    skins: Query<&MeshMaterial3d<StandardMaterial>, Added<Skin>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for skin in &skins {
        if let Some(mut material) = materials.get_mut(&skin.0) {
            material.base_color = Color::srgb(0.5, 0.63, 0.7);
            material.perceptual_roughness = 0.65;
        }
    }
}

/// Draws crates and darts.
fn draw(
    crates: Query<Entity, Added<Crate>>,
    darts: Query<Entity, Added<Dart>>,
    mut marks: Marks,
    mut commands: Commands,
) {
    for entity in &crates {
        let cube = marks.mesh(Color::srgb(0.72, 0.55, 0.36), Cuboid::from_length(2.0 * HALF));
        commands.entity(entity).insert(cube);
    }
    for entity in &darts {
        let pin = marks.pin(Color::srgb(0.95, 0.6, 0.1), 0.12);
        commands.entity(entity).insert(pin);
    }
}

fn show_touching(mut skins: Query<(Entity, &HandOnFace, Option<&mut SelfTouching>)>, mut commands: Commands) {
    for (skin, HandOnFace(pairs), drawn) in &mut skins {
        match drawn {
            Some(mut drawn) => drawn.0.clone_from(pairs),
            None => {
                commands.entity(skin).insert(SelfTouching(pairs.clone()));
            }
        }
    }
}

fn stick_dart(click: On<PointerClick>, clicks: Clicks, skins: Query<(), With<Skin>>, mut commands: Commands) {
    if !clicks.is_plain(&click) || !skins.contains(click.entity) {
        return;
    }
    if let Some(pick) = click.hit.extra_as::<MorphPick>() {
        let anchor = MorphSurfaceAnchor::new(click.entity, pick.triangle, pick.barycentrics);
        commands.spawn((Dart, anchor, Visibility::default()));
    }
}

fn write_notes(
    tally: Res<Tally>,
    diagnostics: Res<MorphPhysicsDiagnostics>,
    touching: Query<&HandOnFace>,
    mut notes: ResMut<Notes>,
) {
    let pairs: usize = touching.iter().map(|HandOnFace(pairs)| pairs.len()).sum();
    let (joint, speed) = match &tally.last_hit {
        Some((joint, velocity)) => (joint.clone(), format!("{:.1} m/s", velocity.length())),
        None => ("none yet".into(), "none yet".into()),
    };
    notes.0 = vec![
        ("hand on face", format!("{pairs} pairs")),
        ("rays that hit", format!("{} of {}", tally.hits, tally.rays)),
        ("last hit on", joint),
        ("skin there at", speed),
        ("crates kicked", tally.kicks.to_string()),
        ("parts near crates", diagnostics.parts.to_string()),
    ];
}
