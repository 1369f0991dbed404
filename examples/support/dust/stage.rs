//! Draws dust: all grains in one mesh, and the ground.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;

use super::Dust;
use crate::view::clock::{Pending, started};
use crate::view::stage::Notes;

/// The corners of a grain, a tetrahedron, in metres.
const CORNERS: [Vec3; 4] = {
    const R: f32 = 0.004;
    [
        Vec3::new(R, R, R),
        Vec3::new(R, -R, -R),
        Vec3::new(-R, R, -R),
        Vec3::new(-R, -R, R),
    ]
};
const FACES: [u32; 12] = [0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2];
/// The colour of a grain in the air, and on the skin.
const COLORS: [[f32; 4]; 2] = [[0.62, 0.5, 0.36, 1.0], [0.75, 0.2, 0.05, 1.0]];

/// The mesh of all grains.
#[derive(Resource)]
struct Grains(Handle<Mesh>);

/// Adds what draws the dust.
pub fn plugin(app: &mut App) {
    app.add_systems(Startup, spawn)
        .add_systems(Update, (wait, write_notes))
        .add_systems(Last, draw.run_if(started));
}

fn spawn(
    dust: Res<Dust>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    let grains = 0..dust.places.len() as u32;
    let faces = grains.flat_map(|grain| FACES.map(|corner| 4 * grain + corner));
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_indices(Indices::U32(faces.collect()));
    fill(&mut mesh, &dust);
    let mesh = meshes.add(mesh);
    commands.insert_resource(Grains(mesh.clone()));
    let material = StandardMaterial {
        unlit: true,
        ..default()
    };
    let material = MeshMaterial3d(materials.add(material));
    commands.spawn((Mesh3d(mesh), material, NoFrustumCulling, Pickable::IGNORE));
    let ground = Mesh3d(meshes.add(Circle::new(1.2)));
    let flat = Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let grey = MeshMaterial3d(materials.add(Color::srgb(0.8, 0.82, 0.8)));
    commands.spawn((ground, grey, flat, Pickable::IGNORE));
}

/// Waits until the model is there.
fn wait(roots: Query<Entity, Added<WorldAssetRoot>>, mut commands: Commands) {
    for root in &roots {
        commands.entity(root).insert(Pending);
    }
}

fn draw(dust: Res<Dust>, grains: Res<Grains>, mut meshes: ResMut<Assets<Mesh>>) {
    if let Some(mut mesh) = meshes.get_mut(&grains.0) {
        fill(&mut mesh, &dust);
    }
}

/// Puts all grains where they are.
fn fill(mesh: &mut Mesh, dust: &Dust) {
    let places = dust.places.iter();
    let corners = places.flat_map(|place| CORNERS.map(|corner| (*place + corner).to_array()));
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, corners.collect::<Vec<_>>());
    let mut colors = vec![COLORS[0]; 4 * dust.places.len()];
    for &grain in &dust.on_skin {
        colors[4 * grain as usize..][..4].fill(COLORS[1]);
    }
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
}

fn write_notes(dust: Res<Dust>, mut notes: ResMut<Notes>) {
    notes.0 = vec![
        ("grains", dust.places.len().to_string()),
        ("on the skin", dust.on_skin.len().to_string()),
    ];
}
