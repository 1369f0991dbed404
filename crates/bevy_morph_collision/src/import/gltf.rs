//! Repairs meshes without normals while Bevy loads them from glTF.
//!
//! The loader makes such meshes flat-shaded: it gives every triangle its own three vertices (`Mesh::duplicate_vertices`). Bevy
//! 0.20 does not do the same with the morph displacements, of which there is still one per vertex of the file. The mesh would be
//! drawn wrong, and no tree could be built from it. This handler records each primitive's indices as the loader reads them, and
//! copies the displacements to the new vertices before the mesh leaves the loader.

use std::future::ready;

use bevy::asset::LoadContext;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler, GltfExtensionHandlers};
use bevy::gltf::gltf::{Gltf, Mesh as GltfFileMesh, Primitive, Semantic, mesh::Mode};
use bevy::gltf::{GltfAssetLabel, GltfMesh};
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::{MeshVertexAttribute, PrimitiveTopology};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::{ConditionalSendFuture, block_on};
use tracing::debug;

use super::complaints::FurtherInfluences;
use super::influence_sets::FurtherSets;

/// Whether the handler has been added to the loader.
#[derive(Resource)]
struct Registered;

/// Adds the handler, and the one that finds [`FurtherSets`], to Bevy's glTF loader, once. Does nothing while there is no `GltfPlugin`.
pub(crate) fn repair_split_meshes(app: &mut App) {
    let world = app.world_mut();
    if world.contains_resource::<Registered>() {
        return;
    }
    let Some(handlers) = world.get_resource::<GltfExtensionHandlers>() else {
        return;
    };
    let handlers = handlers.0.clone();
    let further = world.get_resource_or_init::<FurtherInfluences>().clone();
    block_on(async {
        let mut handlers = handlers.write().await;
        handlers.push(Box::new(SplitMeshes::default()));
        handlers.push(Box::new(FurtherSets(further.clone())));
    });
    world.insert_resource(Registered);
}

/// The primitives of the mesh that is being loaded. For every file, the loader starts with a clone of the registered handler,
/// which is empty.
#[derive(Clone, Default)]
struct SplitMeshes(Vec<Shared>);

/// How the triangles of a primitive share its vertices in the file.
#[derive(Clone)]
struct Shared {
    primitive: usize,
    vertices: usize,
    indices: Vec<u32>,
}

impl GltfExtensionHandler for SplitMeshes {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_gltf_primitive(
        &mut self,
        _: &mut LoadContext<'_>,
        _: &Gltf,
        _: &GltfFileMesh,
        primitive: &Primitive,
        buffers: &[Vec<u8>],
        _: &HashMap<Box<str>, MeshVertexAttribute>,
        _: bool,
        _: bool,
        decoded: &mut Option<Mesh>,
    ) -> impl ConditionalSendFuture<Output = ()> {
        self.0.extend(match decoded {
            Some(mesh) => Shared::of_decoded(primitive.index(), mesh),
            None => Shared::of_file(primitive, buffers),
        });
        ready(())
    }

    fn on_gltf_mesh(&mut self, context: &mut LoadContext<'_>, file_mesh: &GltfFileMesh, _: Handle<GltfMesh>) {
        for shared in std::mem::take(&mut self.0) {
            let label = GltfAssetLabel::Primitive {
                mesh: file_mesh.index(),
                primitive: shared.primitive,
            }
            .to_string();
            let mesh = context.get_labeled(&label).and_then(|asset| asset.get::<Mesh>());
            let repaired = mesh.and_then(|mesh| {
                let displacements = shared.spread(mesh)?;
                // The loader only lends its meshes for reading.
                Some(mesh.clone().with_morph_targets(displacements))
            });
            if let Some(repaired) = repaired {
                debug!("{label} has no normals: its morph displacements go to the vertices that shade it flat");
                context.add_labeled_asset(label, repaired);
            }
        }
    }
}

impl Shared {
    /// From the file. `None` if the loader will not split its vertices.
    fn of_file(primitive: &Primitive, buffers: &[Vec<u8>]) -> Option<Self> {
        if primitive.mode() != Mode::Triangles || primitive.morph_targets().len() == 0 {
            return None;
        }
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        Some(Self {
            primitive: primitive.index(),
            vertices: primitive.get(&Semantic::Positions)?.count(),
            indices: reader.read_indices()?.into_u32().collect(),
        })
    }

    /// From the mesh that another handler decoded.
    fn of_decoded(primitive: usize, mesh: &Mesh) -> Option<Self> {
        mesh.try_morph_targets().ok()?;
        Some(Self {
            primitive,
            vertices: mesh.count_vertices(),
            indices: mesh.indices()?.iter().map(|index| index as u32).collect(),
        })
    }

    /// The displacements of a mesh, target by target, one per vertex after the split. `None` if its vertices were not split in
    /// this way.
    fn spread(&self, mesh: &Mesh) -> Option<Vec<MorphAttributes>> {
        let displacements = mesh.try_morph_targets().ok()?;
        let was_split = mesh.primitive_topology() == PrimitiveTopology::TriangleList
            && mesh.indices().is_none()
            && mesh.count_vertices() == self.indices.len()
            && self.vertices > 0
            && !self.indices.is_empty()
            && displacements.len().is_multiple_of(self.vertices)
            && self.indices.iter().all(|&index| (index as usize) < self.vertices);
        if !was_split || !self.agrees_with(mesh)? {
            return None;
        }
        let mut spread = Vec::with_capacity(displacements.len() / self.vertices * self.indices.len());
        for target in displacements.chunks_exact(self.vertices) {
            spread.extend(self.indices.iter().map(|&index| target[index as usize]));
        }
        Some(spread)
    }

    /// Whether vertices that were one vertex in the file have the same position in the mesh. Another handler may have changed the
    /// mesh.
    fn agrees_with(&self, mesh: &Mesh) -> Option<bool> {
        let positions = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION).ok()?.get_bytes();
        let places = positions.chunks_exact(positions.len() / self.indices.len());
        let mut place_of = vec![None; self.vertices];
        let agrees = |(&index, place)| *place_of[index as usize].get_or_insert(place) == place;
        Some(self.indices.iter().zip(places).all(agrees))
    }
}

#[cfg(test)]
mod tests {
    use bevy::asset::RenderAssetUsages;
    use bevy::mesh::Indices;

    use super::*;

    /// Two triangles with a common edge, and two targets.
    fn square() -> Mesh {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let displacement = |i: u8| MorphAttributes::new(Vec3::splat(i.into()), Vec3::X, Vec3::Y);
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
            .with_inserted_indices(Indices::U16(vec![0, 1, 2, 0, 2, 3]))
            .with_morph_targets((0..8).map(displacement).collect())
    }

    #[test]
    fn displacements_follow_their_vertices() {
        let mesh = square();
        let shared = Shared::of_decoded(0, &mesh).unwrap();
        assert_eq!(shared.spread(&mesh), None, "nothing was split");
        let spread = shared.spread(&mesh.with_duplicated_vertices()).unwrap();
        let first: Vec<f32> = spread.iter().map(|d| d.position.x).collect();
        assert_eq!(first, [0.0, 1.0, 2.0, 0.0, 2.0, 3.0, 4.0, 5.0, 6.0, 4.0, 6.0, 7.0]);
        assert!(spread.iter().all(|d| d.normal == Vec3::X && d.tangent == Vec3::Y));
    }

    #[test]
    fn a_mesh_that_was_split_otherwise_stays_as_it_is() {
        let mesh = square();
        let mut shared = Shared::of_decoded(0, &mesh).unwrap();
        let split = mesh.with_duplicated_vertices();
        shared.indices.swap(1, 2);
        assert_eq!(shared.spread(&split), None);
        shared.indices.swap(1, 2);
        shared.vertices = 3;
        assert_eq!(shared.spread(&split), None);
        shared.indices.pop();
        assert_eq!(shared.spread(&split), None);
    }
}
