//! One primitive of a mesh, as engines draw it alone.

use std::collections::BTreeSet;
use std::slice;

use gltf::mesh::Mode;

use super::GltfFile;
use super::document::abridged;
use super::error::{MeshProblem, ReadError, SkinProblem};
use super::triangles::mode;
use super::{influences, primitive};
use crate::mesh::{InfluenceSet, MorphMesh};

/// A primitive as a mesh of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The mesh, without clips, a skin, or names of targets. Targets without stored data are empty ([`MorphMesh::targets`]).
    pub mesh: MorphMesh,
    /// Its sets of influences. They matter where a node shows it with a skin.
    pub influences: Vec<InfluenceSet>,
    /// Whether it stores separate triangles, not strips or fans.
    pub is_list: bool,
    /// Whether it has normals.
    pub has_normals: bool,
}

impl GltfFile {
    /// The number of primitives of a mesh; 0 if there is no such mesh.
    #[must_use]
    pub fn part_count(&self, mesh: usize) -> usize {
        let json = self.root.meshes.get(mesh, &self.budget);
        json.map_or(0, |json| json.primitives.len())
    }

    /// Reads one primitive of a mesh, with all its vertices, also those that only other primitives draw.
    ///
    /// # Errors
    /// As for [`GltfFile::mesh`] and [`GltfFile::skin`]; primitives are counted from this one. If there is no such primitive, it has no positions.
    pub fn part(&self, mesh: usize, part: usize) -> Result<Part, ReadError> {
        let name = abridged(&self.mesh_name(mesh));
        let fail = |problem| ReadError::Mesh {
            path: self.path.clone(),
            mesh,
            name: name.clone(),
            problem: Box::new(problem),
        };
        let json = self.root.meshes.get(mesh, &self.budget);
        let json = json.map_err(|problem| fail(MeshProblem::Element(problem)))?;
        let json = json.primitives.get(part);
        let json = json.ok_or_else(|| fail(MeshProblem::MissingPositions { primitive: part }))?;
        let alone = slice::from_ref(json);
        let (mut read, _, _) = primitive::read(self, alone).map_err(fail)?;
        read.name = name.clone();
        let influences = match json.attributes.are_bound() {
            true => influences::read(self, alone).map_err(|problem: SkinProblem| ReadError::Skin {
                path: self.path.clone(),
                mesh,
                name,
                problem: Box::new(problem),
            })?,
            false => Vec::new(),
        };
        Ok(Part {
            mesh: read,
            influences,
            is_list: mode(json.mode) == Some(Mode::Triangles),
            has_normals: json.attributes.has_normals,
        })
    }

    /// The numbers of joints of the skins with which nodes show a mesh; `None` is for nodes without a skin. Empty if no node shows it.
    #[must_use]
    pub fn joint_counts(&self, mesh: usize) -> BTreeSet<Option<usize>> {
        let skin_of = |node: usize| self.node_json(node)?.skin;
        let joints = |node: usize| {
            let skin = self.root.skins.get(skin_of(node)?, &self.budget);
            Some(skin.ok()?.joints.len())
        };
        self.nodes_of(mesh).map(joints).collect()
    }
}
