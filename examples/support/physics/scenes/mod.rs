//! Scenes of rigid bodies on morphing surfaces, for any physics engine. Tests of an engine's crate include this file.

pub mod behaviour;
pub mod bullets;
pub mod drops;
pub mod engine;
pub mod player;

use std::f32::consts::TAU;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use morph_collision_models::generated::rigid;
use morph_collision_models::mesh::MorphMesh;

/// The length of a step.
pub const DT: f32 = 1.0 / 60.0;

/// A level sheet of 8 by 8 around the origin. One target lifts it by 1, another moves it by 1 along `+X`.
#[must_use]
pub fn sheet(cells: u32) -> MorphMesh {
    let mut mesh = rigid::grid(8.0, cells);
    mesh.targets = vec![vec![Vec3::Y; mesh.positions.len()], vec![Vec3::X; mesh.positions.len()]];
    mesh.target_names = vec!["rise".into(), "slide".into()];
    mesh
}

/// A mesh as a Bevy [`Mesh`].
#[must_use]
pub fn bevy_mesh(mesh: &MorphMesh) -> Mesh {
    let indices = mesh.triangles.as_flattened().to_vec();
    let mut bevy = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, mesh.positions.clone())
        .with_inserted_indices(Indices::U32(indices));
    if !mesh.targets.is_empty() {
        let difference = |&d: &Vec3| MorphAttributes::new(d, Vec3::ZERO, Vec3::ZERO);
        bevy.set_morph_targets(mesh.targets.iter().flatten().map(difference).collect());
    }
    bevy
}

/// Runs frames until every tree is built and in physics.
pub fn settle(app: &mut App) {
    app.update();
    while app.world().resource::<MorphTrees>().building() > 0 {
        app.update();
    }
    app.update();
    app.update();
}

/// Weights that oscillate, each at its own rate, at `time` seconds.
#[must_use]
pub fn wobbling(time: f32, targets: usize) -> Vec<f32> {
    let weight = |target: usize| {
        let phase = TAU * (0.25 * time - target as f32 / targets.max(1) as f32);
        phase.sin().max(0.0).powi(4)
    };
    (0..targets).map(weight).collect()
}

/// Blends every vertex, one target after the other, as fast as plain loops can.
pub fn blend(mesh: &MorphMesh, weights: &[f32], into: &mut Vec<Vec3>) {
    into.clone_from(&mesh.positions);
    for (target, &weight) in mesh.targets.iter().zip(weights) {
        if weight != 0.0 {
            for (vertex, &displacement) in into.iter_mut().zip(target) {
                *vertex += weight * displacement;
            }
        }
    }
}
