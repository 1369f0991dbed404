//! A character that kicks crates and is hit by rays. Places where its hand touches its face are
//! red.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::{MorphPick, MorphTrees};
use bevy_rapier3d::prelude::*;

use crate::character::{Character, Crate, Dart, GROUND, HALF, HandOnFace, Moment, Skin, Tally, plugin};
use crate::view::Show;
use crate::view::clock::{Clock, Pending, is_typing};
use crate::view::overlay::{OverlaySystems, SelfTouching};
use crate::view::pointer::Clicks;
use crate::view::stage::Notes;

/// The CC0 character.
#[must_use]
pub fn character() -> Show {
    Show {
        name: "character",
        about: "A skinned and morphed character: rays stick to its skin, crates feel its feet, and its hand on its face is red.",
        keys: &[("click", "sticks a dart to the skin"), ("X", "removes the darts")],
        eye: Vec3::new(-0.35, 1.15, 3.75),
        target: Vec3::new(-0.2, 0.62, 0.5),
        pictures: &[66, 200],
        scene: Box::new(|app| {
            app.add_plugins((
                RapierPhysicsPlugin::<NoUserData>::default(),
                MorphRapierPlugin::default(),
                plugin,
            ))
            .add_systems(Startup, light_the_ground)
            .add_systems(PreUpdate, (wait, keep_time))
            .add_systems(Update, (color, draw, remove_darts.run_if(not(is_typing)), tell))
            .add_systems(
                PostUpdate,
                show_touching
                    .after(MorphCollisionSystems::Anchors)
                    .before(OverlaySystems),
            )
            .add_observer(stick_dart);
        }),
    }
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
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut looks: Local<Option<[Handle<StandardMaterial>; 2]>>,
    mut commands: Commands,
) {
    let [wood, orange] = looks.get_or_insert_with(|| {
        [Color::srgb(0.72, 0.55, 0.36), Color::srgb(0.95, 0.6, 0.1)].map(|color| materials.add(color))
    });
    for entity in &crates {
        let cube = meshes.add(Cuboid::from_length(2.0 * HALF));
        commands
            .entity(entity)
            .insert((Mesh3d(cube), MeshMaterial3d(wood.clone())));
    }
    for entity in &darts {
        const LENGTH: f32 = 0.12;
        // +Y points out of the skin.
        let shaft = Mesh3d(meshes.add(Cylinder::new(0.006, LENGTH)));
        let end = Mesh3d(meshes.add(Sphere::new(0.02)));
        commands.entity(entity).with_children(|dart| {
            for (mesh, height) in [(shaft, 0.5 * LENGTH), (end, LENGTH)] {
                let place = Transform::from_xyz(0.0, height, 0.0);
                dart.spawn((mesh, MeshMaterial3d(orange.clone()), place, Pickable::IGNORE));
            }
        });
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

fn remove_darts(keys: Res<ButtonInput<KeyCode>>, darts: Query<Entity, With<Dart>>, mut commands: Commands) {
    if keys.just_pressed(KeyCode::KeyX) {
        darts.iter().for_each(|dart| commands.entity(dart).despawn());
    }
}

fn tell(
    tally: Res<Tally>,
    diagnostics: Res<MorphRapierDiagnostics>,
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
