//! Balls and boxes rain on a body and on a face that wobble.

use std::path::PathBuf;

use bevy::asset::AssetPath;
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
use crate::view::stage::Notes;

/// From one surface to the next.
const APART: f32 = 6.4;

/// What falls on what.
#[derive(Resource, Clone, Debug)]
pub struct Rain {
    /// How many bodies.
    pub bodies: u32,
    /// Where and how they fall.
    pub seed: u64,
    /// Whether they are detected continuously.
    pub ccd: bool,
    /// The surfaces: names of assets or paths of glb files; a body and a face if there are none.
    pub models: Vec<PathBuf>,
}

impl Rain {
    fn surfaces(&self) -> Vec<PathBuf> {
        if self.models.is_empty() {
            return ["pass_through_20480.glb", "mh_head_eyes_teeth_arkit52.glb"]
                .map(PathBuf::from)
                .to_vec();
        }
        self.models.clone()
    }

    /// Where one of so many surfaces stands.
    fn aside(index: usize, count: usize) -> f32 {
        APART * (index as f32 - 0.5 * (count as f32 - 1.0))
    }
}

/// Rain on morphing surfaces.
#[must_use]
pub fn physics(rain: Rain) -> Show {
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
                    max_dt: 8.0 * DT,
                    time_scale: 1.0,
                    substeps: 4,
                })
                .insert_resource(rain)
                .add_systems(Startup, spawn)
                .add_systems(Update, (tell, (fall, wobble).run_if(started)));
        }),
    }
}

fn spawn(
    mut commands: Commands,
    rain: Res<Rain>,
    assets: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let colors = [Color::srgb(0.45, 0.62, 0.5), Color::srgb(0.85, 0.68, 0.6)];
    let surfaces = rain.surfaces();
    let count = surfaces.len();
    for (index, (file, base_color)) in surfaces.into_iter().zip(colors.into_iter().cycle()).enumerate() {
        commands.spawn((
            ModelRoot {
                model: assets.load(AssetPath::from_path_buf(file)),
                size: 5.0,
                material: StandardMaterial {
                    base_color,
                    perceptual_roughness: 0.7,
                    ..default()
                },
                pieces: &[],
                dress: |part| {
                    part.insert(MorphRapierCollider::default());
                },
            },
            Pending,
            Visibility::default(),
            Transform::from_xyz(Rain::aside(index, count), 0.0, 0.0),
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

/// All bodies are in the air when the show begins.
fn fall(
    rain: Res<Rain>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut done: Local<bool>,
) {
    if std::mem::replace(&mut *done, true) {
        return;
    }
    let count = rain.surfaces().len();
    let mut rng = Pcg64Mcg::seed_from_u64(rain.seed);
    let colors: Vec<_> = (0..6)
        .map(|i| materials.add(Color::hsl(60.0 * i as f32 + 15.0, 0.55, 0.55)))
        .collect();
    let (ball, cuboid) = (meshes.add(Sphere::new(1.0)), meshes.add(Cuboid::from_length(2.0)));
    for i in 0..rain.bodies {
        let mut within = |reach: f32| rng.random_range(-reach..=reach);
        let aside = Rain::aside(i as usize % count, count);
        let at = Vec3::new(aside + within(1.6), 3.5 + 0.06 * i as f32, within(1.6));
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
        let ccd = Ccd { enabled: rain.ccd };
        let place = Transform::from_translation(at);
        commands
            .spawn((RigidBody::Dynamic, collider, ccd, place, Visibility::default()))
            .with_child(drawn);
    }
}

fn tell(diagnostics: Res<MorphRapierDiagnostics>, bodies: Query<&RigidBody>, mut notes: ResMut<Notes>) {
    notes.0 = vec![
        ("bodies", bodies.iter().count().to_string()),
        ("parts of surfaces near", diagnostics.parts.to_string()),
    ];
}

fn wobble(mut surfaces: Query<&mut MeshMorphWeights, With<ModelPart>>, clock: Res<Clock>) {
    for mut weights in &mut surfaces {
        if let MeshMorphWeights::Value { weights } = &mut *weights {
            let count = weights.len();
            weights.clone_from(&wobbling(clock.frame as f32 * DT, count));
        }
    }
}
