//! Bevy culls a mesh by the box of its rest pose, so a model that morphs or is animated can vanish while it still reaches into the
//! picture. `MorphBoundsPlugin` keeps each box around what is drawn.
//!
//! Left: Bevy's own boxes. Right: the plugin's. To repair a game, one line is enough: `app.add_plugins(MorphBoundsPlugin)`. It needs
//! no colliders, and no other plugin of this project.
//!
//! `game` is what is special here; the gallery adds camera, light and panel. `--help` lists the options.

use std::f32::consts::PI;
use std::process::ExitCode;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::NoAutoAabb;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::view::arms::{self, RADIUS, REACH};
use morph_collision_workspace::view::clock::{Clock, started};
use morph_collision_workspace::view::halves::{self, Half};
use morph_collision_workspace::view::stage::Notes;
use morph_collision_workspace::view::{self, Demo};

/// Number of arms that reach into the picture.
const ARMS: usize = 4;

/// Index of an arm. Morph targets extend the even ones, joints the odd ones.
#[derive(Component)]
struct Arm(usize);

/// The joint that extends an arm, with the arm's index.
#[derive(Component)]
struct Hand(usize);

fn main() -> ExitCode {
    view::main(demo())
}

/// Arms that reach into the picture from outside.
#[must_use]
pub fn demo() -> Demo {
    Demo {
        name: "culling",
        about: "Left: culled by Bevy's own boxes, those of the rest pose. Right: by boxes that follow morph targets and joints.",
        keys: &[("left half", "is where the mouse moves both cameras")],
        eye: Vec3::new(0.0, 0.0, 7.0),
        target: Vec3::ZERO,
        pictures: &[0, 45, 90],
        scene: Box::new(|app| {
            // The gallery's panel counts colliders, of which there are none here.
            app.add_plugins((MorphCollisionPlugin, halves::plugin, game));
        }),
    }
}

fn game(app: &mut App) {
    app.add_plugins(MorphBoundsPlugin)
        .add_systems(Startup, spawn)
        .add_systems(Update, ((reach, sway).run_if(started), write_notes));
}

fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut bind_poses: ResMut<Assets<SkinnedMeshInverseBindposes>>,
) {
    let [morphing, skinned] = [arms::morphing(), arms::skinned()].map(|mesh| Mesh3d(meshes.add(mesh)));
    let bind_poses = bind_poses.add(vec![Mat4::IDENTITY; 2]);
    for (half, color) in [
        (Half::Left, Color::srgb(0.75, 0.5, 0.45)),
        (Half::Right, Color::srgb(0.4, 0.6, 0.5)),
    ] {
        let color = MeshMaterial3d(materials.add(color));
        for index in 0..ARMS {
            let place = Transform::from_xyz(2.4, 1.8 - 1.2 * index as f32, 0.0);
            let arm = (Arm(index), half, half.layer(), color.clone(), place);
            let arm = commands.spawn(arm).id();
            if index.is_multiple_of(2) {
                let weights = MeshMorphWeights::Value { weights: vec![0.0] };
                commands.entity(arm).insert((morphing.clone(), weights));
            } else {
                let shoulder = commands.spawn((Transform::default(), ChildOf(arm))).id();
                let hand = commands.spawn((Hand(index), Transform::default(), ChildOf(arm))).id();
                let skin = SkinnedMesh {
                    inverse_bindposes: bind_poses.clone(),
                    joints: vec![shoulder, hand],
                };
                commands.entity(arm).insert((skinned.clone(), skin));
            }
            if half == Half::Left {
                // As Bevy computes it, once, without the plugin. `NoAutoAabb` makes the plugin leave it alone.
                let rest = Aabb::from_min_max(Vec3::splat(-RADIUS), Vec3::splat(RADIUS));
                commands.entity(arm).insert((NoAutoAabb, rest));
            }
        }
    }
}

fn reach(mut arms: Query<(&Arm, &mut MeshMorphWeights)>, mut hands: Query<(&Hand, &mut Transform)>, clock: Res<Clock>) {
    let share = |index: usize| {
        let phase = clock.frame as f32 / 60.0 + 0.8 * index as f32;
        0.75 + 0.25 * phase.sin()
    };
    for (&Arm(index), mut weights) in &mut arms {
        *weights = MeshMorphWeights::Value {
            weights: vec![share(index)],
        };
    }
    for (&Hand(index), mut place) in &mut hands {
        place.translation.x = -REACH * share(index);
    }
}

/// Moves all arms aside until the balls they grow out of are out of sight, and back.
fn sway(mut arms: Query<(&Arm, &mut Transform), Without<Hand>>, clock: Res<Clock>) {
    for (&Arm(index), mut place) in &mut arms {
        let phase = PI * clock.frame as f32 / 90.0 + 0.1 * index as f32;
        place.translation.x = 1.8 + 2.0 * (0.5 - 0.5 * phase.cos());
    }
}

fn write_notes(arms: Query<(&Half, &ViewVisibility)>, mut notes: ResMut<Notes>) {
    let drawn = |wanted: Half| {
        let arms = arms.iter().filter(|(half, seen)| **half == wanted && seen.get());
        format!("{} of {ARMS}", arms.count())
    };
    notes.0 = vec![("drawn, left", drawn(Half::Left)), ("drawn, right", drawn(Half::Right))];
}
