//! Two morphing bodies pass right through each other, and where they touch is red. This is the first experiment of the paper on
//! which this project is based (its Fig. 4).
//!
//! `game` is what you would copy; the gallery adds camera, light and panel, and draws the triangles that touch. `--help` lists
//! the options.

use std::path::Path;
use std::process::ExitCode;

use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::scenes::pass_through as way;
use morph_collision_workspace::view::clock::{Clock, FRACTIONS, started};
use morph_collision_workspace::view::models::scene;
use morph_collision_workspace::view::stage::Notes;
use morph_collision_workspace::view::{self, Demo};

fn main() -> ExitCode {
    view::main(demo())
}

#[derive(Component)]
struct Side(usize);

/// The paper's first experiment.
#[must_use]
pub fn demo() -> Demo {
    Demo {
        name: "pass_through",
        about: "Two bodies of 20480 triangles morph while they pass through each other.",
        keys: &[],
        eye: Vec3::new(0.6, 1.1, 4.1),
        target: Vec3::ZERO,
        // The same as in the figure.
        pictures: &[60, 120, 180, 220, 260, 320],
        scene: Box::new(|app| {
            app.add_plugins(game);
        }),
    }
}

fn game(app: &mut App) {
    app.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin))
        .add_systems(Startup, spawn)
        .add_systems(Update, (pass, paint, write_notes).run_if(started));
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    for side in 0..2 {
        commands.spawn((
            Side(side),
            scene(&assets, Path::new("pass_through_20480.glb")),
            // Every mesh of the scene becomes a collider; the scene's root is the body.
            MorphColliderScene::default(),
            Transform::from_xyz(1000.0 * side as f32, 0.0, 0.0),
        ));
    }
}

fn pass(mut bodies: Query<(&Side, &mut Transform)>, mut weights: Query<&mut MorphWeights>, clock: Res<Clock>) {
    let steps = way::STEPS * FRACTIONS;
    let step = clock.fractions() % steps;
    let places = way::placements(step, steps);
    for (&Side(side), mut place) in &mut bodies {
        *place = Transform::from_matrix(Mat4::from(places[side]));
    }
    let morph = way::weights(step, steps);
    for mut weights in &mut weights {
        for (weight, &wanted) in weights.weights_mut().iter_mut().zip(&morph) {
            *weight = wanted;
        }
    }
}

/// What touches now, as any system can read it.
fn write_notes(collisions: Res<MorphCollisions>, mut notes: ResMut<Notes>) {
    let pairs: usize = collisions.iter().map(|contact| contact.triangles.len()).sum();
    notes.0 = vec![("intersecting", format!("{pairs} pairs of triangles"))];
}

/// Gives each body its colour.
fn paint(
    mut drawn: Query<(Entity, &mut MeshMaterial3d<StandardMaterial>)>,
    sides: Query<&Side>,
    parents: Query<&ChildOf>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut done: Local<bool>,
) {
    if std::mem::replace(&mut *done, true) {
        return;
    }
    for (entity, mut material) in &mut drawn {
        let side = parents.iter_ancestors(entity).find_map(|above| sides.get(above).ok());
        if let Some(&Side(side)) = side {
            let color = [Color::srgb(0.35, 0.55, 0.75), Color::srgb(0.85, 0.75, 0.5)][side];
            material.0 = materials.add(StandardMaterial {
                base_color: color,
                perceptual_roughness: 0.6,
                ..default()
            });
        }
    }
}
