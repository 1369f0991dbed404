//! Meshes with their names and targets.

use super::error::{MeshProblem, ReadError};
use super::skipped::Skipped;
use super::{GltfFile, primitive, target_names};
use crate::mesh::MorphMesh;

/// A mesh and further information from the file.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundMesh {
    /// The mesh, without its clips and its skin ([`GltfFile::skin`]). Targets without stored data are empty
    /// ([`MorphMesh::targets`]).
    pub mesh: MorphMesh,
    /// Whether [its main node](GltfFile::main_node) shows it with a skin, which moves its vertices by bones.
    pub skinned: bool,
    /// If none of its primitives has triangles, what it draws: `points`, `lines` or `points and lines`.
    pub not_triangles: Option<&'static str>,
    /// What was left out of it; nothing unless [`ReadOptions::skip_bad`](super::ReadOptions::skip_bad) is set.
    pub skipped: Skipped,
}

impl GltfFile {
    /// The number of meshes.
    #[must_use]
    pub fn mesh_count(&self) -> usize {
        self.root.meshes.len()
    }

    /// A mesh's name, or a default name.
    #[must_use]
    pub fn mesh_name(&self, index: usize) -> String {
        let name = self
            .root
            .meshes
            .get(index, &self.budget)
            .ok()
            .and_then(|mesh| mesh.name.clone());
        name.unwrap_or_else(|| format!("mesh_{index}"))
    }

    /// The names of the materials of a mesh's primitives, in order; `None` for a primitive without a material, or with one that has no
    /// name. Empty if there is no such mesh.
    #[must_use]
    pub fn material_names(&self, mesh: usize) -> Vec<Option<String>> {
        let Ok(json) = self.root.meshes.get(mesh, &self.budget) else {
            return Vec::new();
        };
        let name_of = |material: usize| self.root.materials.get(material, &self.budget).ok()?.name.clone();
        let primitives = json.primitives.iter();
        primitives
            .map(|primitive| primitive.material.and_then(name_of))
            .collect()
    }

    /// Reads a mesh.
    ///
    /// - Several primitives become one mesh. Their vertices are concatenated (once if primitives share them), and their triangles
    ///   are numbered consecutively.
    /// - Strips and fans become triangles of the same winding. Points and lines give an empty range.
    /// - Names of targets come from `targetNames` in the extras of the mesh or of its primitives, or from the accessors of the
    ///   targets.
    /// - A mesh without triangles or without targets is returned as it is.
    ///
    /// # Errors
    /// [`ReadError::Mesh`] names the primitive and the accessor at fault.
    pub fn mesh(&self, index: usize) -> Result<FoundMesh, ReadError> {
        let name = self.mesh_name(index);
        let fail = |problem| ReadError::Mesh {
            path: self.path.clone(),
            mesh: index,
            name: name.clone(),
            problem: Box::new(problem),
        };
        let json = self.root.meshes.get(index, &self.budget);
        let json = json.map_err(|problem| fail(MeshProblem::Element(problem)))?;
        let (mut mesh, drawn, skipped) = primitive::read(self, &json.primitives).map_err(fail)?;
        mesh.target_names = target_names::read(self, json, mesh.targets.len());
        mesh.name = name;
        Ok(FoundMesh {
            mesh,
            skinned: self.skin_of(index, json, None).is_some(),
            not_triangles: match (drawn.triangles, drawn.points, drawn.lines) {
                (false, true, true) => Some("points and lines"),
                (false, true, false) => Some("points"),
                (false, false, true) => Some("lines"),
                _ => None,
            },
            skipped,
        })
    }

    /// All meshes with their clips and skins. All targets are stored in full.
    pub(super) fn all_meshes(&self) -> Result<Vec<MorphMesh>, ReadError> {
        let read = |index: usize| {
            let mut mesh = self.mesh(index)?.mesh;
            let vertices = mesh.positions.len();
            for target in mesh.targets.iter_mut().filter(|target| target.is_empty()) {
                let what = || format!("the displacements of {vertices} vertices");
                let take = self.budget.take(vertices as u64, 12, what);
                take.map_err(|over| ReadError::Mesh {
                    path: self.path.clone(),
                    mesh: index,
                    name: mesh.name.clone(),
                    problem: Box::new(MeshProblem::OverBudget(over)),
                })?;
                *target = vec![glam::Vec3::ZERO; vertices];
            }
            mesh.default_weights = self.default_weights(index, None, mesh.targets.len())?;
            mesh.animations = self.clips(index, None, mesh.targets.len()).clips;
            mesh.skin = self.skin(index, None)?;
            Ok(mesh)
        };
        (0..self.mesh_count()).map(read).collect()
    }
}
