//! The data of a [`Mesh`] that a tree needs, with checks for mistakes that only Bevy's meshes can have.

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::{Indices, MeshAccessError, PrimitiveTopology};
use bevy::prelude::*;
use morph_collision::{BadParts, InputError, ModelError, MorphModel, SparseTarget};
use thiserror::Error;

use super::decode::Positions;
use super::left_out::MorphLeftOut;
use super::skin_data::SkinData;

/// Why a mesh cannot collide.
#[derive(Reflect, Clone, Debug, PartialEq, Error)]
#[reflect(opaque)]
#[reflect(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ImportError {
    /// Bevy could not load it; the text is Bevy's reason. Only this error may also concern a scene.
    #[error("it could not be loaded: {0}")]
    NotLoaded(String),
    /// The mesh data is only for the renderer, which takes it away.
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
    /// Positions have an unsupported format.
    #[error("its positions are {0}, only Float32x3 and Snorm16x4 (see `Mesh::compress_positions`) can be read")]
    PositionFormat(&'static str),
    /// Positions are compressed, but the box to decode them is missing.
    #[error("its positions are compressed (Snorm16x4), but there is no `Mesh::final_aabb` to decode them with")]
    NoPositionBounds,
    /// Joint indices have an unsupported format.
    #[error("its joint indices are {0}, only Uint16x4 and Uint8x4 can be read")]
    JointFormat(&'static str),
    /// Joint weights have an unsupported format.
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
        /// The number of displacements of all targets together.
        displacements: usize,
        /// The number of vertices.
        vertices: usize,
        /// The number of targets, as text because it may be unknown.
        targets: String,
    },
    /// The vertices were split for flat shading, but the morph displacements were not.
    #[error(
        "it has {displacements} morph displacements for {vertices} vertices: it seems to have no normals, so that its vertices \
         were split for flat shading, but not its displacements. Export it with normals, or let `MorphCollisionPlugin` repair it \
         while Bevy loads it from glTF (feature `gltf`, on by default)"
    )]
    SplitVertices {
        /// The number of displacements of all targets together.
        displacements: usize,
        /// The number of vertices after the split.
        vertices: usize,
    },
    /// The model data is invalid.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A setting of [`MorphTreeSettings`](crate::import::MorphTreeSettings) is out of range.
    #[error(transparent)]
    Settings(#[from] InputError),
}

impl ImportError {
    /// Whether the rest of the mesh could be used without the bad triangles.
    pub(super) fn is_about_a_triangle(&self) -> bool {
        use ModelError::{BadCoordinate, BadInfluence, IndexOutOfRange, JointOutOfRange, WeightsTooLarge};
        match self {
            Self::IncompleteTriangle(_) => true,
            Self::Model(error) => matches!(
                error,
                BadCoordinate { .. }
                    | BadInfluence { .. }
                    | IndexOutOfRange { .. }
                    | JointOutOfRange { .. }
                    | WeightsTooLarge { .. }
            ),
            _ => false,
        }
    }
}

impl From<MeshAccessError> for ImportError {
    fn from(error: MeshAccessError) -> Self {
        match error {
            MeshAccessError::ExtractedToRenderWorld => Self::Extracted,
            MeshAccessError::NotFound => Self::NoPositions,
        }
    }
}

/// A mesh that was read.
#[derive(Clone)]
pub(super) struct Imported {
    pub(super) model: Arc<MorphModel>,
    /// The vertices of each triangle, as numbered in the mesh.
    pub(super) corners: Arc<[[u32; 3]]>,
    pub(super) left_out: Option<MorphLeftOut>,
}

/// A copy of a mesh's shape, made piece by piece. Another thread does the rest of the work.
///
/// Bevy shares no mesh data between threads, so everything that a tree needs must be copied while the mesh is accessible.
pub(super) struct MeshData {
    positions: Vec<Vec3>,
    /// `None` means that the vertices are used in order.
    indices: Option<Vec<u32>>,
    /// The index that restarts a strip, for indexed strips.
    restart: Option<u32>,
    is_strip: bool,
    /// Sparse, because a face's targets move only a part of its vertices each.
    targets: Vec<SparseTarget>,
    /// The number of displacements in all targets.
    displacements: usize,
    named_targets: Option<usize>,
    /// Set if the mesh is shown with a skeleton.
    skin: Option<SkinData>,
}

impl MeshData {
    /// Starts an empty copy of a readable mesh, which is shown with a skeleton of `joints` joints, or with none.
    pub(super) fn of(mesh: &Mesh, joints: Option<usize>) -> Result<Self, ImportError> {
        // The renderer takes such a mesh away as soon as it is drawn. Sometimes a collider reads it in time, but it should not
        // depend on that. Reading every mesh as soon as it is loaded would cost memory for meshes that never collide.
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
            targets: Vec::new(),
            displacements: 0,
            named_targets: mesh.try_morph_target_names()?.map(<[String]>::len),
            skin: match joints {
                Some(joint_count) => SkinData::of(mesh, joint_count)?,
                None => None,
            },
        })
    }

    /// Copies the next part: at most `left` positions, displacements, indices, joints and weights. Returns whether the copy is
    /// complete.
    ///
    /// The mesh must not have changed since the copy was started.
    pub(super) fn copy(&mut self, mesh: &Mesh, left: &mut usize) -> Result<bool, ImportError> {
        let positions = Positions::of(mesh)?;
        let mut is_complete = positions.copy(&mut self.positions, left);
        if let Some(copied) = &mut self.indices {
            is_complete &= match mesh.try_indices_option()? {
                Some(Indices::U16(indices)) => copy(copied, indices, left, |&index| index.into()),
                Some(Indices::U32(indices)) => copy(copied, indices, left, |&index| index),
                None => true,
            };
        }
        match mesh.try_morph_targets() {
            Ok(displacements) => is_complete &= self.copy_displacements(displacements, positions.len(), left),
            Err(MeshAccessError::NotFound) => {}
            Err(error) => return Err(error.into()),
        }
        if let Some(skin) = &mut self.skin {
            is_complete &= skin.copy(mesh, left)?;
        }
        Ok(is_complete)
    }

    /// Continues to copy the displacements of all targets, which have one per vertex. Returns whether all are copied.
    fn copy_displacements(&mut self, all: &[MorphAttributes], vertices: usize, left: &mut usize) -> bool {
        let missing = all.get(self.displacements..).unwrap_or_default();
        let mut now = &missing[..missing.len().min(*left)];
        *left -= now.len();
        let is_complete = now.len() == missing.len();
        self.displacements += now.len();
        while !now.is_empty() {
            let target = match self.targets.last_mut().filter(|target| target.len() < vertices) {
                Some(target) => target,
                None => self.targets.push_mut(SparseTarget::default()),
            };
            // Without vertices, the number of displacements is an error.
            let of_target = now.len().min((vertices - target.len()).max(1));
            target.extend(now[..of_target].iter().map(|d| d.position));
            if target.len() >= vertices {
                target.shrink_to_fit();
            }
            now = &now[of_target..];
        }
        is_complete
    }

    /// Builds a model from the complete copy, in a background task. With `skip_bad`, bad triangles are left out.
    pub(super) fn into_model(mut self, skip_bad: bool) -> Result<Imported, ImportError> {
        self.check_targets()?;
        let vertices = self.positions.len();
        let is_list = !self.is_strip;
        let indices = self.indices.take().unwrap_or_else(|| (0..vertices as u32).collect());
        let (mut corners, incomplete) = if is_list {
            list_triangles(&indices)
        } else {
            (strip_triangles(&indices, self.restart), None)
        };
        let left_out = match incomplete {
            incomplete if skip_bad => self.leave_out_bad_triangles(&mut corners, incomplete)?,
            Some(incomplete) => return Err(incomplete),
            None => None,
        };
        let model = match &self.skin {
            Some(skin) => MorphModel::skinned(
                &self.positions,
                &corners,
                &self.targets,
                skin.joint_count(),
                &[skin.influences()],
            )?,
            None => MorphModel::from_displacements(&self.positions, &corners, &self.targets)?,
        };
        Ok(Imported {
            model: Arc::new(model),
            corners: corners.into(),
            left_out,
        })
    }

    /// Removes bad triangles, and makes bad vertices equal to a good one.
    fn leave_out_bad_triangles(
        &mut self,
        corners: &mut Vec<[u32; 3]>,
        incomplete: Option<ImportError>,
    ) -> Result<Option<MorphLeftOut>, ImportError> {
        let influences = self.skin.as_ref().map(|skin| (skin.joint_count(), [skin.influences()]));
        let skin = influences.as_ref().map(|(joints, sets)| (*joints, &sets[..]));
        let bad = BadParts::find(&self.positions, corners, &self.targets, skin)?;
        let left_out = MorphLeftOut::of(&bad, corners.len(), incomplete);
        bad.mend(&mut self.positions);
        self.targets.iter_mut().for_each(|target| bad.mend_target(target));
        if let Some(skin) = &mut self.skin {
            skin.mend(&bad);
        }
        bad.remove_from(corners);
        Ok(left_out)
    }

    /// Checks that every target has one displacement per vertex.
    fn check_targets(&self) -> Result<(), ImportError> {
        let (displacements, vertices) = (self.displacements, self.positions.len());
        if displacements == 0 {
            return Ok(());
        }
        // `Mesh::duplicate_vertices` drops the indices and ignores the displacements. In that case the number of target names
        // decides. Elsewhere names are free text from a file, and any whole number of targets is accepted.
        let is_split = self.indices.is_none() && !self.is_strip;
        let names = self.named_targets.filter(|_| self.indices.is_none());
        let fits = match names {
            Some(targets) => displacements == targets * vertices,
            None => vertices > 0 && displacements.is_multiple_of(vertices),
        };
        if fits {
            return Ok(());
        }
        // One displacement per vertex of the file, which has no more vertices than the mesh has now.
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

/// Continues a copy. Returns whether it is complete.
pub(super) fn copy<T, U>(into: &mut Vec<U>, from: &[T], left: &mut usize, convert: impl Fn(&T) -> U) -> bool {
    let missing = from.get(into.len()..).unwrap_or_default();
    let now = &missing[..missing.len().min(*left)];
    into.reserve_exact(missing.len());
    into.extend(now.iter().map(convert));
    *left -= now.len();
    now.len() == missing.len()
}

/// Triangle `t` has the indices `3 t`, `3 t + 1` and `3 t + 2`. The error tells of an incomplete last triangle, which is left out.
fn list_triangles(indices: &[u32]) -> (Vec<[u32; 3]>, Option<ImportError>) {
    let (triangles, rest) = indices.as_chunks::<3>();
    let incomplete = (!rest.is_empty()).then_some(ImportError::IncompleteTriangle(indices.len()));
    (triangles.to_vec(), incomplete)
}

/// The triangles of one or more strips with consistent winding, numbered in the order of the strip.
///
/// The largest index restarts the strip, as on the GPU. Triangles that use a vertex twice only connect strips and are never
/// drawn; they are left out and not numbered.
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
        assert_eq!(list_triangles(&[5, 4, 3, 2, 1, 0]), (vec![[5, 4, 3], [2, 1, 0]], None));
        let incomplete = (vec![[0; 3]], Some(ImportError::IncompleteTriangle(5)));
        assert_eq!(list_triangles(&[0; 5]), incomplete);
    }

    #[test]
    fn a_mesh_is_copied_a_few_numbers_at_a_time() {
        let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![Vec3::ZERO, Vec3::X, Vec3::Y])
            .with_inserted_indices(Indices::U16(vec![0, 1, 2]))
            .with_morph_targets(vec![MorphAttributes::default(); 6]);
        let mut data = MeshData::of(&mesh, None).unwrap();
        let pieces: Vec<(bool, usize)> = (0..3)
            .map(|_| {
                let mut left = 5;
                (data.copy(&mesh, &mut left).unwrap(), left)
            })
            .collect();
        assert_eq!(pieces, [(false, 0), (false, 0), (true, 3)]);
        let imported = data.into_model(false).unwrap();
        assert_eq!(
            (imported.model.target_count(), &*imported.corners),
            (2, &[[0, 1, 2]][..])
        );
    }
}
