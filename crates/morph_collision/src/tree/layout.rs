//! A tree's shape, apart from its mesh and its tables: what a game ships to save the time of splitting.

use std::sync::Arc;

use thiserror::Error;

use super::topology::{ChildKind, Topology};
use super::{BuildError, BuildOptions, MorphBvh, build};
use crate::bounds::LANES;
use crate::model::MorphModel;

/// The version of [`TreeLayout`] that this crate writes and reads.
const VERSION: u32 = 2;

/// Which triangles of a mesh a tree puts together, and the options it was built with; serialisable with the feature
/// `serde`.
///
/// Boxes are not in it: they are measured again on the mesh when the tree is restored, which is cheaper than splitting
/// it, keeps files small, and leaves no way for a corrupt file to make an answer wrong.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel};
/// # let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// # let model = Arc::new(MorphModel::from_displacements::<[Vec3; 3]>(&base, &[[0, 1, 2]], &[])?);
/// let bvh = MorphBvh::build(model.clone(), &BuildOptions::default())?;
/// let layout = bvh.layout(); // write it to a file, read it back in the game
/// let restored = MorphBvh::from_layout(model, &layout)?;
/// assert_eq!(restored.node_count(), bvh.node_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TreeLayout {
    version: u32,
    /// Of the mesh: see [`MorphModel::fingerprint`].
    fingerprint: u64,
    options: BuildOptions,
    /// Nodes in preorder: the number of children and then their triangle counts; a leaf is a 0.
    nodes: Vec<u32>,
    /// The mesh's triangle numbers in leaf order.
    triangles: Vec<u32>,
}

/// Why a [`TreeLayout`] does not fit a mesh.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// Written by another version of this crate.
    #[error("tree layout has version {found}, this is version {VERSION}")]
    Version {
        /// The layout's version.
        found: u32,
    },
    /// Written for another mesh.
    #[error("tree layout is of another mesh: its fingerprint is {found:016x}, the mesh's is {expected:016x}")]
    OtherMesh {
        /// The layout's fingerprint.
        found: u64,
        /// The mesh's.
        expected: u64,
    },
    /// The options in it are out of range.
    #[error("tree layout: {0}")]
    Options(#[from] BuildError),
    /// There are too few or too many triangles.
    #[error("tree layout: {found} triangles, the mesh has {expected}")]
    TriangleCount {
        /// How many the layout has.
        found: usize,
        /// How many the mesh has.
        expected: usize,
    },
    /// The triangles are not those of the mesh, each once.
    #[error("tree layout: entry {place} of the triangles is {triangle}, which is out of range or there twice")]
    Triangle {
        /// Index into the layout's triangles.
        place: usize,
        /// The triangle there.
        triangle: u32,
    },
    /// The nodes are no tree over the triangles.
    #[error("tree layout: the nodes are no tree over the triangles at entry {place}")]
    Nodes {
        /// Index into the layout's nodes.
        place: usize,
    },
}

impl TreeLayout {
    fn of(bvh: &MorphBvh) -> Self {
        let topology = bvh.topology();
        let mut nodes = Vec::new();
        let mut rest: Vec<ChildKind> = topology.group(0).children().iter().map(|root| root.kind()).collect();
        while let Some(node) = rest.pop() {
            match node {
                ChildKind::Leaf(_) => nodes.push(0),
                ChildKind::Group(group) => {
                    let children = topology.group(group).children();
                    nodes.push(children.len() as u32);
                    nodes.extend(children.iter().map(|child| triangles_below(topology, child.kind())));
                    rest.extend(children.iter().rev().map(|child| child.kind()));
                }
            }
        }
        Self {
            version: VERSION,
            fingerprint: bvh.model().fingerprint(),
            options: *bvh.options(),
            nodes,
            triangles: topology.triangles.clone(),
        }
    }

    fn check(&self, model: &MorphModel) -> Result<(), LayoutError> {
        if self.version != VERSION {
            return Err(LayoutError::Version { found: self.version });
        }
        if self.fingerprint != model.fingerprint() {
            return Err(LayoutError::OtherMesh {
                found: self.fingerprint,
                expected: model.fingerprint(),
            });
        }
        self.options.check()?;
        let expected = model.triangle_count();
        if self.triangles.len() != expected {
            return Err(LayoutError::TriangleCount {
                found: self.triangles.len(),
                expected,
            });
        }
        let mut seen = vec![false; expected];
        for (place, &triangle) in self.triangles.iter().enumerate() {
            match seen.get_mut(triangle as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(LayoutError::Triangle { place, triangle }),
            }
        }
        self.check_nodes()
    }

    /// Walks the nodes with the triangle counts and depths that they should have.
    fn check_nodes(&self) -> Result<(), LayoutError> {
        let mut due = vec![(self.triangles.len(), 0)];
        let mut place = 0;
        while let Some((count, depth)) = due.pop() {
            let broken = LayoutError::Nodes { place };
            let Some(&children) = self.nodes.get(place) else {
                return Err(broken);
            };
            place += 1;
            if children == 0 {
                if count > self.options.leaf_size {
                    return Err(broken);
                }
                continue;
            }
            let children = children as usize;
            if !(2..=LANES).contains(&children) || depth >= build::MOST_DEPTH {
                return Err(broken);
            }
            let Some(counts) = self.nodes.get(place..place + children) else {
                return Err(broken);
            };
            let sum: usize = counts.iter().map(|&count| count as usize).sum();
            if sum != count || counts.contains(&0) {
                return Err(broken);
            }
            due.extend(counts.iter().rev().map(|&count| (count as usize, depth + 1)));
            place += children;
        }
        if place != self.nodes.len() {
            return Err(LayoutError::Nodes { place });
        }
        Ok(())
    }
}

impl MorphBvh {
    /// The tree's shape, to be shipped and restored.
    #[must_use]
    pub fn layout(&self) -> TreeLayout {
        TreeLayout::of(self)
    }

    /// Restores a tree over the mesh it was built for.
    ///
    /// Cost: the boxes are measured, `O(n)` for `n` triangles; nothing is split.
    ///
    /// # Errors
    /// [`LayoutError`] if the layout is of another version or mesh, or corrupt.
    pub fn from_layout(model: Arc<MorphModel>, layout: &TreeLayout) -> Result<Self, LayoutError> {
        layout.check(&model)?;
        let splits = build::Recorded::new(&layout.nodes);
        Ok(build::build_over(
            model,
            &layout.options,
            layout.triangles.clone(),
            splits,
        ))
    }
}

fn triangles_below(topology: &Topology, node: ChildKind) -> u32 {
    match node {
        ChildKind::Leaf(leaf) => topology.leaf_triangles(leaf).len() as u32,
        ChildKind::Group(group) => {
            let children = topology.group(group).children();
            children
                .iter()
                .map(|child| triangles_below(topology, child.kind()))
                .sum()
        }
    }
}
