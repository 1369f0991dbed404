//! Balls and boxes rain on a body that wobbles and on a face that speaks.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_rapier3d::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::physics::{DT, wobbling};
use crate::view::Show;
use crate::view::clock::{Clock, Pending, started};
use crate::view::models::{ModelPart, ModelRoot};

/// How far the two surfaces stand from the middle.
const ASIDE: f32 = 3.2;

#[derive(Resource)]
struct Rain {
    bodies: u32,
    seed: u64,
}

/// Rain of `bodies` bodies.
#[must_use]
pub fn physics(bodies: u32, seed: u64) -> Show {
    Show {
        name: "physics",
        about: "What morphs pushes, carries and throws what falls on it, at the speed of its surface.",
        keys: &[],
        eye: Vec3::new(0.0, 3.4, 11.0),
        target: Vec3::new(0.0, 0.2, 0.0),
        pictures: &[60, 180, 360, 540],
        scene: Box::new(move |app| {
            app.add_plugins((RapierPhysicsPlugin::<NoUserData>::default(), MorphRapierPlugin))
                .insert_resource(TimestepMode::Variable {
                    max_dt: 2.0 * DT,
                    time_scale: 1.0,
                    substeps: 1,
                })
                .insert_resource(Rain { bodies, seed })
                .add_systems(Startup, spawn)
                .add_systems(Update, (hold, (rain, wobble).run_if(started)));
        }),
    }
}

fn spawn(
    mut commands: Commands,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let surfaces = [
        ("pass_through_20480.glb", Color::srgb(0.45, 0.62, 0.5)),
        ("mh_head_eyes_teeth_arkit52.glb", Color::srgb(0.85, 0.68, 0.6)),
    ];
    for (side, (file, base_color)) in surfaces.into_iter().enumerate() {
        commands.spawn((
            ModelRoot {
                model: assets.load(file),
                size: 5.0,
                material: StandardMaterial {
                    base_color,
                    perceptual_roughness: 0.7,
                    ..default()
                },
                dress: |part| {
                    part.insert(MorphRapierCollider::default());
                },
            },
            Pending,
            Visibility::default(),
            Transform::from_xyz((2.0 * side as f32 - 1.0) * ASIDE, 0.0, 0.0),
        ));
    }
    let ground = Vec3::new(9.0, 0.2, 9.0);
    commands.spawn((
        Collider::cuboid(ground.x, ground.y, ground.z),
        Mesh3d(meshes.add(Cuboid::from_size(2.0 * ground))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.82, 0.84))),
        Transform::from_xyz(0.0, -3.2, 0.0),
    ));
}

/// Physics stands still where time does.
fn hold(mut worlds: Query<&mut RapierConfiguration>, time: Res<Time>) {
    for mut world in &mut worlds {
        world.physics_pipeline_active = time.delta_secs() > 0.0;
    }
}

/// All bodies are in the air when the show begins.
fn rain(
    rain: Res<Rain>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut done: Local<bool>,
) {
    if std::mem::replace(&mut *done, true) {
        return;
    }
    let mut rng = Pcg64Mcg::seed_from_u64(rain.seed);
    let colors: Vec<_> = (0..6).map(|i| materials.add(Color::hsl(60.0 * i as f32 + 15.0, 0.55, 0.55))).collect();
    let (ball, cuboid) = (meshes.add(Sphere::new(1.0)), meshes.add(Cuboid::from_length(2.0)));
    for i in 0..rain.bodies {
        let mut within = |reach: f32| rng.random_range(-reach..=reach);
        let side = if i % 2 == 0 { -ASIDE } else { ASIDE };
        let at = Vec3::new(side + within(1.6), 3.5 + 0.06 * i as f32, within(1.6));
        let size = 0.2 + within(0.08);
        let (collider, mesh, shape) = match i % 4 {
            0 | 1 => (Collider::ball(size), ball.clone(), Vec3::splat(size)),
            _ => {
                let half = size * Vec3::new(1.0, 0.8, 0.6);
                (Collider::cuboid(half.x, half.y, half.z), cuboid.clone(), half)
            }
        };
        // What is drawn is scaled, what collides has its size.
        let drawn = (
            Mesh3d(mesh),
            MeshMaterial3d(colors[i as usize % colors.len()].clone()),
            Transform::from_scale(shape),
        );
        commands
            .spawn((RigidBody::Dynamic, collider, Transform::from_translation(at), Visibility::default()))
            .with_child(drawn);
    }
}

fn wobble(mut surfaces: Query<&mut MeshMorphWeights, With<ModelPart>>, clock: Res<Clock>) {
    for mut weights in &mut surfaces {
        if let MeshMorphWeights::Value { weights } = &mut *weights {
            let count = weights.len();
            weights.clone_from(&wobbling(clock.frame as f32 * DT, count));
        }
    }
}
