//! Reads skins: the joints that move a mesh, and their ancestors.

use std::cell::OnceCell;
use std::collections::HashMap;

use glam::{Mat4, Quat, Vec3};

use super::GltfFile;
use super::accessor::MATRICES;
use super::document::{ElementError, Node, abridged};
use super::error::{MeshProblem, ReadError, SkinProblem};
use super::influences;
use crate::mesh::MeshSkin;
use crate::skeleton::{Joint, LocalTransform, Skeleton, SkeletonNode};

/// Upper bound on the bytes of a skeleton's node without its name, including the map from the file's nodes.
const BYTES_PER_NODE: u64 = 200;

/// The parent of every node of a file, if it has one; computed on first use.
pub(super) type Parents = OnceCell<Vec<Option<usize>>>;

/// A skeleton without clips, and the index in it of each node of the file.
#[derive(Default)]
pub(super) struct Hierarchy {
    pub(super) skeleton: Skeleton,
    pub(super) places: HashMap<usize, u32>,
}

impl GltfFile {
    /// Reads the skin with which a node shows a mesh, or else [the mesh's main node](GltfFile::main_node): influences, joints and their clips.
    /// `None` if the node has no skin, and for a mesh without influences.
    ///
    /// The transform of the node is not used, because joints take vertices directly to world space. Clips that cannot be played are left out;
    /// [`Skeleton::broken`] says why.
    ///
    /// # Errors
    /// [`ReadError::Skin`] names the skin, the node, or the primitive and the accessor at fault.
    pub fn skin(&self, mesh: usize, node: Option<usize>) -> Result<Option<MeshSkin>, ReadError> {
        let fail = |problem| ReadError::Skin {
            path: self.path.clone(),
            mesh,
            name: abridged(&self.mesh_name(mesh)),
            problem: Box::new(problem),
        };
        let json = self.root.meshes.get(mesh, &self.budget);
        let json = json.map_err(|problem| fail(SkinProblem::Mesh(MeshProblem::Element(problem))))?;
        let Some(skin) = self.skin_of(mesh, json, node) else {
            return Ok(None);
        };
        let sets = influences::read(self, &json.primitives).map_err(fail)?;
        let mut hierarchy = self.hierarchy(skin).map_err(fail)?;
        self.add_clips(&mut hierarchy);
        let skeleton = hierarchy.skeleton;
        Ok(Some(MeshSkin { sets, skeleton }))
    }

    /// The skin with which a node, or else the main one, shows a mesh. Also `None` if none of the mesh's primitives has influences.
    pub(super) fn skin_of(&self, mesh: usize, json: &super::document::Mesh, node: Option<usize>) -> Option<usize> {
        let bound = |primitive: &super::document::Primitive| primitive.attributes.are_bound();
        if !json.primitives.iter().any(bound) {
            return None;
        }
        let node = node.or_else(|| self.main_node(mesh))?;
        self.root.nodes.get(node, &self.budget).ok()?.skin
    }

    /// The joints of a skin and all their ancestors.
    pub(super) fn hierarchy(&self, skin: usize) -> Result<Hierarchy, SkinProblem> {
        let json = self.root.skins.get(skin, &self.budget);
        let json = json.map_err(|problem| SkinProblem::Element { skin, problem })?;
        let mut hierarchy = Hierarchy::default();
        let count = json.joints.len();
        let what = || format!("its {count} joints");
        self.budget
            .take(count as u64, 160, what)
            .map_err(SkinProblem::OverBudget)?;
        let inverse_binds = match json.inverse_bind_matrices {
            None => vec![Mat4::IDENTITY; count],
            Some(accessor) => {
                let opened = self
                    .open_accessor(accessor, &MATRICES)
                    .map_err(SkinProblem::InverseBind)?;
                let found = opened.count();
                if found < count {
                    return Err(SkinProblem::MatrixCount {
                        skin,
                        found,
                        joints: count,
                    });
                }
                let what = || format!("its {found} inverse bind matrices");
                self.budget
                    .take(found as u64, 64, what)
                    .map_err(SkinProblem::OverBudget)?;
                opened.matrices().map_err(SkinProblem::InverseBind)?
            }
        };
        for (&node, &inverse_bind) in json.joints.iter().zip(&inverse_binds) {
            let node = self.add_with_ancestors(node, &mut hierarchy)?;
            hierarchy.skeleton.joints.push(Joint { node, inverse_bind });
        }
        Ok(hierarchy)
    }

    /// Adds a node to a skeleton after all its ancestors; returns its index there.
    pub(super) fn add_with_ancestors(&self, node: usize, hierarchy: &mut Hierarchy) -> Result<u32, SkinProblem> {
        let parents = self.parents()?;
        let (mut missing, mut above) = (Vec::new(), Some(node));
        while let Some(next) = above.filter(|next| !hierarchy.places.contains_key(next)) {
            if missing.len() > parents.len() {
                return Err(SkinProblem::Cycle { node });
            }
            missing.push(next);
            above = parents.get(next).copied().flatten();
        }
        let mut parent = above.map(|above| hierarchy.places[&above]);
        for node in missing.into_iter().rev() {
            let json = self.node(node)?;
            let name = json.name.clone().unwrap_or_else(|| format!("node_{node}"));
            let what = || "a node of its skeleton".into();
            let take = self.budget.take(BYTES_PER_NODE + name.len() as u64, 1, what);
            take.map_err(SkinProblem::OverBudget)?;
            let place = hierarchy.skeleton.nodes.len() as u32;
            hierarchy.places.insert(node, place);
            hierarchy.skeleton.nodes.push(SkeletonNode {
                name,
                parent,
                rest: rest(json),
            });
            parent = Some(place);
        }
        parent.ok_or(SkinProblem::Node {
            node,
            problem: ElementError::Missing,
        })
    }

    fn node(&self, node: usize) -> Result<&Node, SkinProblem> {
        let json = self.root.nodes.get(node, &self.budget);
        json.map_err(|problem| SkinProblem::Node { node, problem })
    }

    /// The parent of every node; the first one if a file names several.
    pub(super) fn parents(&self) -> Result<&[Option<usize>], SkinProblem> {
        if let Some(known) = self.parents.get() {
            return Ok(known);
        }
        let count = self.root.nodes.len();
        let what = || format!("its {count} nodes");
        self.budget
            .keep(count as u64, 16, what)
            .map_err(SkinProblem::OverBudget)?;
        let mut parents = vec![None; count];
        for parent in self.root.nodes.indices() {
            for &child in &self.node(parent)?.children {
                if let Some(slot) = parents.get_mut(child) {
                    slot.get_or_insert(parent);
                }
            }
        }
        Ok(self.parents.get_or_init(|| parents))
    }
}

/// A node's rest transform. A matrix is decomposed, as loaders that animate it do.
fn rest(node: &Node) -> LocalTransform {
    let default = LocalTransform::default();
    match &node.matrix {
        Some(matrix) => {
            let (scale, rotation, translation) = Mat4::from_cols_array(matrix).to_scale_rotation_translation();
            LocalTransform {
                translation,
                rotation,
                scale,
            }
        }
        None => LocalTransform {
            translation: node.translation.map_or(default.translation, Vec3::from_array),
            rotation: node.rotation.map_or(default.rotation, Quat::from_array),
            scale: node.scale.map_or(default.scale, Vec3::from_array),
        },
    }
}
