//! What the collision tree needs of a [`Mesh`], checked for what only Bevy's meshes can get wrong.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, MeshAccessError, PrimitiveTopology};
use bevy::prelude::*;
use morph_collision::{InputError, ModelError, MorphModel};
use thiserror::Error;

use super::decode::Positions;
use super::skin_data::SkinData;

/// Why a mesh cannot collide.
#[derive(Reflect, Clone, Debug, PartialEq, Error)]
#[reflect(opaque)]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ImportError {
    /// The mesh data is for the renderer only, which takes it away.
    #[error(
        "its data does not stay in main memory: give it `RenderAssetUsages::default()` instead of `RENDER_WORLD` (for glTF \
         files `GltfLoaderSettings::load_meshes`)"
    )]
    Extracted,
    /// The mesh is made of points or lines.
    #[error("its topology is {0:?}, only TriangleList and TriangleStrip have triangles")]
    Topology(PrimitiveTopology),
    /// There is no position attribute.
    #[error("it has no vertex positions")]
    NoPositions,
    /// Positions are of an unusual format.
    #[error("its positions are {0}, only Float32x3 and Snorm16x4 (see `Mesh::compress_positions`) can be read")]
    PositionFormat(&'static str),
    /// Positions are compressed, and the box that they are relative to is missing.
    #[error("its positions are compressed (Snorm16x4), but there is no `Mesh::final_aabb` to decode them with")]
    NoPositionBounds,
    /// Joint indices are of an unusual format.
    #[error("its joint indices are {0}, only Uint16x4 and Uint8x4 can be read")]
    JointFormat(&'static str),
    /// Joint weights are of an unusual format.
    #[error(
        "its joint weights are {0}, only Float32x4, Float16x4, Unorm16x4, Unorm8x4, Snorm16x4 and Snorm8x4 can be read"
    )]
    JointWeightFormat(&'static str),
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
    /// The vertices were split for flat shading, the morph displacements were not.
    #[error(
        "it has {displacements} morph displacements for {vertices} vertices: it seems to have no normals, so that its vertices \
         were split for flat shading, but not its displacements. Export it with normals, or let `MorphCollisionPlugin` repair it \
         while Bevy loads it from glTF (feature `gltf`, on by default)"
    )]
    SplitVertices {
        /// How many displacements there are, of all targets together.
        displacements: usize,
        /// How many vertices there are after the split.
        vertices: usize,
    },
    /// The shape cannot be used.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A setting of [`MorphTreeSettings`](crate::MorphTreeSettings) is out of range.
    #[error(transparent)]
    Settings(#[from] InputError),
}

impl From<MeshAccessError> for ImportError {
    fn from(error: MeshAccessError) -> Self {
        match error {
            MeshAccessError::ExtractedToRenderWorld => Self::Extracted,
            MeshAccessError::NotFound => Self::NoPositions,
        }
    }
}

/// A mesh's shape, copied out piece by piece; the rest of the work is done on another thread.
///
/// Bevy shares no mesh data between threads, so what a tree is built of must be copied while the mesh is at hand.
pub(super) struct MeshData {
    positions: Vec<Vec3>,
    /// Without any, the vertices one after the other.
    indices: Option<Vec<u32>>,
    /// The index that ends a strip, if it is one that can be ended.
    restart: Option<u32>,
    is_strip: bool,
    /// Target by target.
    displacements: Vec<Vec3>,
    named_targets: Option<usize>,
    /// Of a mesh that is shown with a skeleton.
    skin: Option<SkinData>,
}

impl MeshData {
    /// An empty copy of a mesh that can be read, shown with a skeleton of this many joints, or with none.
    pub(super) fn of(mesh: &Mesh, joints: Option<usize>) -> Result<Self, ImportError> {
        // The renderer takes such a mesh away as soon as it is drawn. Sometimes a collider comes in time, but it should not
        // depend on that. Reading the mesh as soon as it is loaded would cost memory for every mesh that never collides.
        if mesh.asset_usage == RenderAssetUsages::RENDER_WORLD {
            return Err(ImportError::Extracted);
        }
        Positions::of(mesh)?;
        let is_strip = match mesh.primitive_topology() {
            PrimitiveTopology::TriangleList => false,
            PrimitiveTopology::TriangleStrip => true,
            other => return Err(ImportError::Topology(other)),
        };
        let indices = mesh.try_indices_option()?;
        Ok(Self {
            positions: Vec::new(),
            indices: indices.map(|_| Vec::new()),
            restart: indices.map(|indices| match indices {
                Indices::U16(_) => u16::MAX.into(),
                Indices::U32(_) => u32::MAX,
            }),
            is_strip,
            displacements: Vec::new(),
            named_targets: mesh.try_morph_target_names()?.map(<[String]>::len),
            skin: match joints {
                Some(joint_count) => SkinData::of(mesh, joint_count)?,
                None => None,
            },
        })
    }

    /// Copies the next part: at most `left` positions, displacements, indices, joints and weights. Returns whether the copy is complete.
    ///
    /// The mesh must be as it was when the copy was begun.
    pub(super) fn copy(&mut self, mesh: &Mesh, left: &mut usize) -> Result<bool, ImportError> {
        let mut is_complete = Positions::of(mesh)?.copy(&mut self.positions, left);
        if let Some(copied) = &mut self.indices {
            is_complete &= match mesh.try_indices_option()? {
                Some(Indices::U16(indices)) => copy(copied, indices, left, |&index| index.into()),
                Some(Indices::U32(indices)) => copy(copied, indices, left, |&index| index),
                None => true,
            };
        }
        match mesh.try_morph_targets() {
            Ok(displacements) => is_complete &= copy(&mut self.displacements, displacements, left, |d| d.position),
            Err(MeshAccessError::NotFound) => {}
            Err(error) => return Err(error.into()),
        }
        if let Some(skin) = &mut self.skin {
            is_complete &= skin.copy(mesh, left)?;
        }
        Ok(is_complete)
    }

    /// Makes a model from the whole copy, for a task in the background. Returns it with the vertices of each triangle, as the mesh
    /// numbers them.
    pub(super) fn into_model(self) -> Result<(MorphModel, Vec<[u32; 3]>), ImportError> {
        let targets = self.targets()?;
        let vertices = self.positions.len();
        let is_list = !self.is_strip;
        let indices = self.indices.unwrap_or_else(|| (0..vertices as u32).collect());
        let corners = if is_list {
            list_triangles(&indices)?
        } else {
            strip_triangles(&indices, self.restart)
        };
        let targets: Vec<&[Vec3]> = match targets {
            0 => Vec::new(),
            _ => self.displacements.chunks_exact(vertices).collect(),
        };
        let model = match &self.skin {
            Some(skin) => MorphModel::skinned(
                &self.positions,
                &corners,
                &targets,
                skin.joint_count(),
                &[skin.influences()],
            )?,
            None => MorphModel::from_displacements(&self.positions, &corners, &targets)?,
        };
        Ok((model, corners))
    }

    /// How many targets there are.
    fn targets(&self) -> Result<usize, ImportError> {
        let (displacements, vertices) = (self.displacements.len(), self.positions.len());
        if displacements == 0 {
            return Ok(0);
        }
        // `Mesh::duplicate_vertices` drops the indices and forgets the displacements. There the names tell; elsewhere they are a
        // file's free text, and any whole number of targets is believed.
        let is_split = self.indices.is_none() && !self.is_strip;
        let names = self.named_targets.filter(|_| self.indices.is_none());
        let fits = match names {
            Some(targets) => displacements == targets * vertices,
            None => vertices > 0 && displacements.is_multiple_of(vertices),
        };
        if fits {
            return Ok(displacements / vertices);
        }
        // One displacement per vertex of the file, and of these at most as many as there are now.
        let of_fewer = match names {
            Some(targets) => targets > 0 && displacements.is_multiple_of(targets) && displacements < targets * vertices,
            None => true,
        };
        Err(if is_split && of_fewer {
            ImportError::SplitVertices {
                displacements,
                vertices,
            }
        } else {
            ImportError::TargetLength {
                displacements,
                vertices,
                targets: names.map_or_else(|| "the same number".into(), |targets| targets.to_string()),
            }
        })
    }
}

/// Continues a copy; returns whether it is complete.
pub(super) fn copy<T, U>(into: &mut Vec<U>, from: &[T], left: &mut usize, convert: impl Fn(&T) -> U) -> bool {
    let missing = from.get(into.len()..).unwrap_or_default();
    let now = &missing[..missing.len().min(*left)];
    into.reserve_exact(missing.len());
    into.extend(now.iter().map(convert));
    *left -= now.len();
    now.len() == missing.len()
}

/// Triangle `t` has the indices `3 t`, `3 t + 1` and `3 t + 2`.
fn list_triangles(indices: &[u32]) -> Result<Vec<[u32; 3]>, ImportError> {
    let (triangles, []) = indices.as_chunks::<3>() else {
        return Err(ImportError::IncompleteTriangle(indices.len()));
    };
    Ok(triangles.to_vec())
}

/// Triangles of one or more strips, all turning the same way, numbered in the order of the strip.
///
/// The largest index restarts the strip, as on the GPU. Triangles that name a vertex twice only stitch strips together and
/// are never drawn; they are left out and not numbered.
fn strip_triangles(indices: &[u32], restart: Option<u32>) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for strip in indices.split(|&index| Some(index) == restart) {
        for (turn, corners) in strip.windows(3).enumerate() {
            let (a, b, c) = (corners[0], corners[1], corners[2]);
            if a != b && b != c && c != a {
                triangles.push(if turn.is_multiple_of(2) { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_turn_one_way_restart_and_lose_their_stitches() {
        assert_eq!(strip_triangles(&[0, 1, 2, 3], Some(65535)), [[0, 1, 2], [2, 1, 3]]);
        let restarted = strip_triangles(&[0, 1, 2, 65535, 3, 4, 5], Some(65535));
        assert_eq!(restarted, [[0, 1, 2], [3, 4, 5]]);
        let stitched = strip_triangles(&[0, 1, 2, 2, 2, 3, 3, 4, 5], None);
        assert_eq!(stitched, [[0, 1, 2], [3, 4, 5]]);
    }

    #[test]
    fn a_list_ends_with_a_whole_triangle() {
        assert_eq!(list_triangles(&[5, 4, 3, 2, 1, 0]), Ok(vec![[5, 4, 3], [2, 1, 0]]));
        assert_eq!(list_triangles(&[0; 5]), Err(ImportError::IncompleteTriangle(5)));
    }

    #[test]
    fn a_mesh_is_copied_a_few_numbers_at_a_time() {
        let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![Vec3::ZERO, Vec3::X, Vec3::Y])
            .with_inserted_indices(Indices::U16(vec![0, 1, 2]))
            .with_morph_targets(vec![bevy::mesh::morph::MorphAttributes::default(); 6]);
        let mut data = MeshData::of(&mesh, None).unwrap();
        let pieces: Vec<(bool, usize)> = (0..3)
            .map(|_| {
                let mut left = 5;
                (data.copy(&mesh, &mut left).unwrap(), left)
            })
            .collect();
        assert_eq!(pieces, [(false, 0), (false, 0), (true, 3)]);
        let (model, corners) = data.into_model().unwrap();
        assert_eq!((model.target_count(), corners), (2, vec![[0, 1, 2]]));
    }
}
