//! Morph displacements that Bevy's glTF loader leaves behind.
//!
//! For a mesh without normals the loader gives every triangle three vertices of its own, to shade it flat, but leaves the
//! morph displacements as they are in the file, one per shared vertex (bevy 0.20). Such a mesh would be drawn wrong, and the
//! collision plugin refuses it. Here the displacements are read from the file again and spread over the new vertices.

use bevy::gltf::{Gltf, GltfMesh};
use bevy::mesh::{PrimitiveTopology, morph::MorphAttributes};
use bevy::prelude::*;
use morph_collision_testkit::{gltf_read::ReadError, mesh::MorphMesh};

use crate::error::ExampleError;

/// Repairs every mesh of a loaded file whose vertices were split; leaves the others alone. `read` has the file's meshes.
///
/// # Errors
/// There is such a mesh, and the file cannot be read a second time.
pub(crate) fn spread_over_split_vertices(
    world: &mut World,
    gltf: &Handle<Gltf>,
    read: impl FnOnce() -> Result<Vec<MorphMesh>, ReadError>,
) -> Result<(), ExampleError> {
    let split = split_meshes(world, gltf);
    if split.is_empty() {
        return Ok(());
    }
    let read = read().map_err(|error| ExampleError::Read(error.to_string()))?;
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    for (mesh, primitive, handle) in split {
        let spread = read.get(mesh).and_then(|mesh| spread(mesh, primitive));
        if let (Some(spread), Some(mut mesh)) = (spread, meshes.get_mut(&handle)) {
            mesh.set_morph_targets(spread);
        }
    }
    Ok(())
}

/// Mesh index, primitive index and handle of the meshes that have been split.
fn split_meshes(world: &World, gltf: &Handle<Gltf>) -> Vec<(usize, usize, Handle<Mesh>)> {
    let (files, parts) = (world.resource::<Assets<Gltf>>(), world.resource::<Assets<GltfMesh>>());
    let meshes = world.resource::<Assets<Mesh>>();
    let was_split = |mesh: &Mesh| {
        mesh.primitive_topology() == PrimitiveTopology::TriangleList
            && mesh.indices().is_none()
            && mesh.morph_targets().is_some()
    };
    let file = files.get(gltf).into_iter();
    file.flat_map(|file| &file.meshes)
        .filter_map(|mesh| parts.get(mesh))
        .flat_map(|mesh| mesh.primitives.iter().map(|primitive| (mesh.index, primitive)))
        .filter(|(_, primitive)| meshes.get(&primitive.mesh).is_some_and(was_split))
        .map(|(mesh, primitive)| (mesh, primitive.index, primitive.mesh.clone()))
        .collect()
}

/// One displacement per target and triangle corner of a primitive, target by target.
fn spread(mesh: &MorphMesh, primitive: usize) -> Option<Vec<MorphAttributes>> {
    let range = mesh.primitives.get(primitive)?;
    let triangles = mesh.triangles.get(range.start as usize..range.end as usize)?;
    let mut spread = Vec::with_capacity(mesh.targets.len() * triangles.len() * 3);
    for target in &mesh.targets {
        for &corner in triangles.as_flattened() {
            let position = *target.get(corner as usize)?;
            spread.push(MorphAttributes::new(position, Vec3::ZERO, Vec3::ZERO));
        }
    }
    Some(spread)
}
