//! The structure of a tree in a form that can be stored.

use std::sync::Arc;
use std::{fmt, mem};

use super::budget::{Budget, run_to_end};
use super::build::{MAX_DEPTH, Recorded, build_over};
use super::certificate_layout::CertificateLayout;
use super::layout_error::{LayoutError, VERSION};
use super::topology::Child;
use super::{BuildOptions, ChildKind, MorphBvh};
use crate::bounds::LANES;
use crate::model::MorphModel;

/// The structure of a tree without its boxes: which triangles each node holds, and the build options. Ship it with your game to
/// skip splitting at load time. The feature `serde` makes it serialisable.
///
/// [`MorphBvh::from_layout`] measures the boxes again on the mesh. This is cheaper than splitting, keeps files small, and means
/// that corrupt nodes cannot make an answer wrong. Certificates ([`MorphBvh::set_certificates`]) are stored, too, with a checksum.
///
/// Reading one takes memory in proportion to its bytes, whatever mesh it is for, so limit the bytes of files that are not your own.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel};
/// # let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// # let model = Arc::new(MorphModel::from_displacements::<[Vec3; 3]>(&base, &[[0, 1, 2]], &[])?);
/// let bvh = MorphBvh::build(model.clone(), &BuildOptions::default());
/// let layout = bvh.layout(); // write it to a file, read it back in the game
/// let restored = MorphBvh::from_layout(model, &layout)?;
/// assert_eq!(restored.node_count(), bvh.node_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TreeLayout {
    version: u32,
    /// [`MorphModel::fingerprint`] of the mesh.
    fingerprint: u64,
    options: BuildOptions,
    /// The nodes in preorder. A node is its number of children, then the number of triangles below each child. A leaf is a 0.
    nodes: Vec<u32>,
    /// The mesh's triangle numbers in leaf order.
    triangles: Vec<u32>,
    #[cfg_attr(feature = "serde", serde(default))]
    certificates: Option<CertificateLayout>,
}

impl TreeLayout {
    /// [`MorphModel::fingerprint`] of the mesh for which it was written.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// The number of triangles that it lists. Only a mesh with as many has this tree.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// How the tree was built.
    #[must_use]
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// Gives changed certificates the right checksum, for tests and fuzzing.
    #[doc(hidden)]
    pub fn correct_certificates(&mut self) {
        if let Some(certificates) = &mut self.certificates {
            certificates.correct();
        }
    }

    pub(super) fn check(&self, model: &MorphModel) -> Result<(), LayoutError> {
        if self.version != VERSION {
            return Err(LayoutError::Version { found: self.version });
        }
        let (found, expected) = (self.fingerprint, model.fingerprint());
        if found != expected {
            return Err(LayoutError::OtherMesh { found, expected });
        }
        let (found, expected) = (self.triangles.len(), model.triangle_count());
        if found != expected {
            return Err(LayoutError::TriangleCount { found, expected });
        }
        let mut seen = vec![false; expected];
        let is_bad = |&(_, &triangle): &(usize, &u32)| match seen.get_mut(triangle as usize) {
            Some(seen) => mem::replace(seen, true),
            None => true,
        };
        if let Some((entry, &triangle)) = self.triangles.iter().enumerate().find(is_bad) {
            return Err(LayoutError::Triangle { entry, triangle });
        }
        self.check_nodes()
    }

    /// The tree over a mesh that was checked, without certificates.
    pub(super) async fn rebuild(&self, model: Arc<MorphModel>, budget: &Budget) -> MorphBvh {
        let (triangles, splits) = (self.triangles.clone(), Recorded(&self.nodes));
        build_over(model, &self.options, triangles, splits, budget).await
    }

    /// Gives a new tree the certificates, if there are any.
    pub(super) fn certify(&self, bvh: &MorphBvh) -> Result<(), LayoutError> {
        if let Some(certificates) = &self.certificates {
            let restored = certificates.restore(bvh)?;
            // A new tree has none.
            let _ = bvh.certificates.set(restored);
        }
        Ok(())
    }

    /// Walks the nodes and checks each against its number of triangles and its depth.
    fn check_nodes(&self) -> Result<(), LayoutError> {
        let mut rest = vec![(self.triangles.len(), 0)];
        let mut entry = 0;
        while let Some((count, depth)) = rest.pop() {
            let broken = LayoutError::Nodes { entry };
            let children = match self.nodes.get(entry) {
                Some(0) if count <= self.options.leaf_size() => 0,
                Some(&children) if (2..=LANES as u32).contains(&children) && depth < MAX_DEPTH => children as usize,
                _ => return Err(broken),
            };
            entry += 1;
            let Some(counts) = self.nodes.get(entry..entry + children) else {
                return Err(broken);
            };
            let sum: u64 = counts.iter().map(|&count| u64::from(count)).sum();
            if children > 0 && sum != count as u64 || counts.contains(&0) {
                return Err(broken);
            }
            rest.extend(counts.iter().rev().map(|&count| (count as usize, depth + 1)));
            entry += children;
        }
        if entry != self.nodes.len() {
            return Err(LayoutError::Nodes { entry });
        }
        Ok(())
    }
}

impl fmt::Debug for TreeLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TreeLayout")
            .field("version", &self.version)
            .field("fingerprint", &self.fingerprint)
            .field("options", &self.options)
            .field("triangles", &self.triangles.len())
            .finish_non_exhaustive()
    }
}

impl MorphBvh {
    /// The structure of the tree, to store and restore it.
    #[must_use]
    pub fn layout(&self) -> TreeLayout {
        let topology = &self.topology;
        let mut nodes = Vec::new();
        let mut rest = topology.group(0).children().to_vec();
        while let Some(node) = rest.pop() {
            match node.kind() {
                ChildKind::Leaf(_) => nodes.push(0),
                ChildKind::Group(group) => {
                    let children = topology.group(group).children();
                    nodes.push(children.len() as u32);
                    let triangles = |&child: &Child| topology.triangles_below(child).len() as u32;
                    nodes.extend(children.iter().map(triangles));
                    rest.extend(children.iter().rev());
                }
            }
        }
        TreeLayout {
            version: VERSION,
            fingerprint: self.model().fingerprint(),
            options: *self.options(),
            nodes,
            triangles: topology.triangles.clone(),
            certificates: self.certificates().map(CertificateLayout::new),
        }
    }

    /// Restores a tree over the mesh for which it was built.
    ///
    /// Cost: `O(n)` for `n` triangles. Boxes are measured, but nothing is split. If the layout has certificates, the tree has them, too; if
    /// they are corrupt, the whole layout is refused.
    ///
    /// # Errors
    /// [`LayoutError`] if the layout has another version, belongs to another mesh, or is corrupt.
    pub fn from_layout(model: Arc<MorphModel>, layout: &TreeLayout) -> Result<Self, LayoutError> {
        layout.check(&model)?;
        let bvh = run_to_end(layout.rebuild(model, &Budget::unlimited()));
        layout.certify(&bvh)?;
        Ok(bvh)
    }
}
