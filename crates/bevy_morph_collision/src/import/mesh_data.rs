//! What the collision tree needs of a [`Mesh`], checked for what only Bevy's meshes can get wrong.

use std::sync::Arc;

use bevy::mesh::{Indices, MeshAccessError, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use morph_collision::{BuildError, BuildOptions, ModelError, MorphBvh, MorphModel};
use thiserror::Error;

/// Why a mesh cannot collide.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The mesh data has been moved to the renderer.
    #[error("its data is no longer in main memory: load it with `RenderAssetUsages::MAIN_WORLD`")]
    Extracted,
    /// The mesh is made of points or lines.
    #[error("its topology is {0:?}, only TriangleList and TriangleStrip have triangles")]
    Topology(PrimitiveTopology),
    /// There is no position attribute.
    #[error("it has no vertex positions")]
    NoPositions,
    /// Positions are compressed, or of another unusual format.
    #[error("its positions are {0}, only uncompressed Float32x3 can be read (see `GltfPlugin::mesh_compression`)")]
    PositionFormat(&'static str),
    /// A triangle list ends in the middle of a triangle.
    #[error("it has {0} indices or unindexed vertices, not a multiple of 3")]
    IncompleteTriangle(usize),
    /// The morph displacements do not fit the vertices.
    #[error("it has {displacements} morph displacements, which is not {targets} for each of its {vertices} vertices")]
    TargetLength {
        /// How many displacements there are, of all targets together.
        displacements: usize,
        /// How many vertices there are.
        vertices: usize,
        /// How many targets, as text because it may be unknown.
        targets: String,
    },
    /// The shape cannot be used.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The plugin's build options are out of range.
    #[error(transparent)]
    Build(#[from] BuildError),
}

impl From<MeshAccessError> for ImportError {
    fn from(error: MeshAccessError) -> Self {
        match error {
            MeshAccessError::ExtractedToRenderWorld => Self::Extracted,
            MeshAccessError::NotFound => Self::NoPositions,
        }
    }
}

/// A mesh's shape, copied out so that the tree can be built on another thread.
pub(super) struct MeshData {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    targets: Vec<Vec<Vec3>>,
}

impl MeshData {
    /// Copies positions, triangles and displacements: linear in their size.
    pub(super) fn read(mesh: &Mesh) -> Result<Self, ImportError> {
        let positions = match mesh.try_attribute(Mesh::ATTRIBUTE_POSITION.id)? {
            VertexAttributeValues::Float32x3(values) => values.iter().copied().map(Vec3::from_array).collect(),
            other => return Err(ImportError::PositionFormat(other.enum_variant_name())),
        };
        let indices = mesh.try_indices_option()?;
        let triangles = match mesh.primitive_topology() {
            PrimitiveTopology::TriangleList => list_triangles(indices, Vec::len(&positions))?,
            PrimitiveTopology::TriangleStrip => strip_triangles(indices, Vec::len(&positions)),
            other => return Err(ImportError::Topology(other)),
        };
        let targets = read_targets(mesh, positions.len())?;
        Ok(Self {
            positions,
            triangles,
            targets,
        })
    }

    pub(super) fn build(&self, options: &BuildOptions) -> Result<MorphBvh, ImportError> {
        let model = MorphModel::from_displacements(&self.positions, &self.triangles, &self.targets)?;
        Ok(MorphBvh::build(Arc::new(model), options)?)
    }
}

/// The displacements of each target; none for a mesh without targets.
fn read_targets(mesh: &Mesh, vertices: usize) -> Result<Vec<Vec<Vec3>>, ImportError> {
    let displacements = match mesh.try_morph_targets() {
        Ok(displacements) if !displacements.is_empty() => displacements,
        Ok(_) | Err(MeshAccessError::NotFound) => return Ok(Vec::new()),
        Err(error) => return Err(error.into()),
    };
    // Bevy's `Mesh::duplicate_vertices`, which the glTF loader calls for meshes without normals, drops the indices and
    // forgets the displacements. There the names tell; elsewhere they are a file's free text and any whole number of
    // targets is believed.
    let names = match mesh.try_indices_option()? {
        Some(_) => None,
        None => mesh.try_morph_target_names()?.map(<[String]>::len),
    };
    let fits = match names {
        Some(targets) => displacements.len() == targets * vertices,
        None => vertices > 0 && displacements.len().is_multiple_of(vertices),
    };
    if !fits {
        return Err(ImportError::TargetLength {
            displacements: displacements.len(),
            vertices,
            targets: names.map_or_else(|| "the same number".into(), |targets| targets.to_string()),
        });
    }
    // Zero vertices with zero displacements per vertex were turned away as "no displacements" above.
    let of_target = |target: &[bevy::mesh::morph::MorphAttributes]| target.iter().map(|d| d.position).collect();
    Ok(displacements.chunks_exact(vertices).map(of_target).collect())
}

/// The vertices of a triangle, by the number that contacts and hits name it with.
pub(crate) fn triangle_corners(mesh: &Mesh, triangle: u32) -> Option<[u32; 3]> {
    let vertices = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION.id).ok()?.len();
    let indices = mesh.try_indices_option().ok()?;
    let place = triangle as usize;
    match mesh.primitive_topology() {
        PrimitiveTopology::TriangleList => {
            let corner = |i: usize| match indices {
                Some(indices) => indices.iter().nth(3 * place + i).map(|index| index as u32),
                None => (3 * place + i < vertices).then_some((3 * place + i) as u32),
            };
            Some([corner(0)?, corner(1)?, corner(2)?])
        }
        PrimitiveTopology::TriangleStrip => strip_triangles(indices, vertices).get(place).copied(),
        _ => None,
    }
}

/// Triangle `t` has the indices `3 t`, `3 t + 1` and `3 t + 2`.
fn list_triangles(indices: Option<&Indices>, vertices: usize) -> Result<Vec<[u32; 3]>, ImportError> {
    let indices = all_indices(indices, vertices);
    let (triangles, []) = indices.as_chunks::<3>() else {
        return Err(ImportError::IncompleteTriangle(indices.len()));
    };
    Ok(triangles.to_vec())
}

/// Triangles of one or more strips, all turning the same way, numbered in the order of the strip.
///
/// The largest index restarts the strip, as on the GPU. Triangles that name a vertex twice only stitch strips together and
/// are never drawn; they are left out and not numbered.
fn strip_triangles(indices: Option<&Indices>, vertices: usize) -> Vec<[u32; 3]> {
    let restart = match indices {
        Some(Indices::U16(_)) => Some(u32::from(u16::MAX)),
        Some(Indices::U32(_)) => Some(u32::MAX),
        None => None,
    };
    let mut triangles = Vec::new();
    for strip in all_indices(indices, vertices).split(|&index| Some(index) == restart) {
        for (turn, corners) in strip.windows(3).enumerate() {
            let (a, b, c) = (corners[0], corners[1], corners[2]);
            if a != b && b != c && c != a {
                triangles.push(if turn.is_multiple_of(2) { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    triangles
}

/// The indices as `u32`; without any, the vertices one after the other.
fn all_indices(indices: Option<&Indices>, vertices: usize) -> Vec<u32> {
    match indices {
        Some(Indices::U16(indices)) => indices.iter().copied().map(u32::from).collect(),
        Some(Indices::U32(indices)) => indices.clone(),
        None => (0..vertices as u32).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_turn_one_way_restart_and_lose_their_stitches() {
        let one = Indices::U16(vec![0, 1, 2, 3]);
        assert_eq!(strip_triangles(Some(&one), 4), [[0, 1, 2], [2, 1, 3]]);
        let restarted = Indices::U16(vec![0, 1, 2, u16::MAX, 3, 4, 5]);
        assert_eq!(strip_triangles(Some(&restarted), 6), [[0, 1, 2], [3, 4, 5]]);
        let stitched = Indices::U32(vec![0, 1, 2, 2, 2, 3, 3, 4, 5]);
        assert_eq!(strip_triangles(Some(&stitched), 6), [[0, 1, 2], [3, 4, 5]]);
    }

    #[test]
    fn a_triangle_has_the_vertices_that_the_tree_was_built_of() {
        use bevy::asset::RenderAssetUsages;
        let mesh = |topology| {
            Mesh::new(topology, RenderAssetUsages::default())
                .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0_f32; 3]; 6])
        };
        let list = mesh(PrimitiveTopology::TriangleList);
        assert_eq!(triangle_corners(&list, 1), Some([3, 4, 5]));
        assert_eq!(triangle_corners(&list, 2), None);
        let indexed = list.with_inserted_indices(Indices::U16(vec![5, 4, 3, 2, 1, 0]));
        assert_eq!(triangle_corners(&indexed, 1), Some([2, 1, 0]));
        let strip = mesh(PrimitiveTopology::TriangleStrip);
        assert_eq!(triangle_corners(&strip, 1), Some([2, 1, 3]));
    }

    #[test]
    fn lists_without_indices_take_vertices_in_order() {
        assert_eq!(list_triangles(None, 6), Ok(vec![[0, 1, 2], [3, 4, 5]]));
        assert_eq!(list_triangles(None, 5), Err(ImportError::IncompleteTriangle(5)));
    }
}
