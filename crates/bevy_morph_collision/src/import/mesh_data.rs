//! The data of a [`Mesh`] that a tree needs, with checks for mistakes that only Bevy's meshes can have.

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::{Indices, MeshAccessError, PrimitiveTopology};
use bevy::prelude::*;
use morph_collision::{BadParts, MorphBvh, MorphModel, SparseTarget};

use super::copy::copy;
use super::decode::Positions;
use super::error::ImportError;
use super::left_out::MorphLeftOut;
use super::skin_data::SkinData;
use super::triangles::{list_triangles, strip_triangles};

/// A mesh that was read.
#[derive(Clone)]
pub(super) struct Imported {
    pub(super) model: Arc<MorphModel>,
    /// The vertices of each triangle, as numbered in the mesh.
    pub(super) corners: Arc<[[u32; 3]]>,
    pub(super) left_out: Option<MorphLeftOut>,
}

/// A new tree, and the mesh that was read for it.
pub(super) type Finished = (Arc<MorphBvh>, Imported);

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
        bad.repair(&mut self.positions);
        self.targets.iter_mut().for_each(|target| bad.repair_target(target));
        if let Some(skin) = &mut self.skin {
            skin.repair(&bad);
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

#[cfg(test)]
mod tests {
    use super::*;

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
