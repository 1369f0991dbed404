use std::sync::Arc;

use super::build::build;
use super::{BuildError, BuildOptions, LeafLanes, Tables, Topology};
use crate::bounds::Kernel;
use crate::model::MorphModel;

/// A bounding-volume tree for every pose of a [`MorphModel`]: immutable, shared by all instances of the mesh.
///
/// Each node holds its box at the base and, for each target that moves any of its vertices, how the box moves; a
/// [`Pose`](crate::Pose) blends them when a query looks at the node.
///
/// Building takes `O(n log n)` time for `n` triangles, and memory in proportion to the sum over all nodes of the targets
/// that move them. Cloning is cheap.
#[derive(Clone, Debug)]
pub struct MorphBvh {
    pub(super) model: Arc<MorphModel>,
    pub(super) topology: Arc<Topology>,
    pub(super) tables: Arc<Tables>,
    pub(super) leaf_lanes: Option<Arc<LeafLanes>>,
    pub(super) options: BuildOptions,
    pub(super) kernel: Kernel,
}

impl MorphBvh {
    /// Builds the tree.
    ///
    /// # Errors
    /// [`BuildError`] if an option is out of range.
    pub fn build(model: Arc<MorphModel>, options: &BuildOptions) -> Result<Self, BuildError> {
        build(model, options)
    }

    /// Makes queries use this instruction set instead of the machine's best one: for tests and measurements.
    ///
    /// The bits of the answers do not change. Where the trees of two bodies differ, pairs are compared with the first body's.
    #[must_use]
    pub fn with_kernel(mut self, kernel: Kernel) -> Self {
        self.kernel = kernel;
        self
    }

    /// The instruction set that queries use.
    #[must_use]
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// The mesh the tree was built over.
    #[must_use]
    pub fn model(&self) -> &Arc<MorphModel> {
        &self.model
    }

    /// How the tree was built.
    #[must_use]
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// How many nodes there are, leaves and root included.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.topology.node_count()
    }

    /// How many of the nodes are leaves.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        self.topology.leaf_starts.len() - 1
    }

    /// Edges on the longest way from the root to a leaf; 0 when the root is a leaf.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.topology.depth
    }

    /// Bytes held on the heap, the model's not included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let leaf_lanes = self.leaf_lanes.as_ref().map_or(0, |lanes| lanes.bytes());
        self.topology.bytes() + self.tables.bytes() + leaf_lanes
    }

    pub(crate) fn topology(&self) -> &Topology {
        &self.topology
    }

    pub(crate) fn tables(&self) -> &Tables {
        &self.tables
    }

    pub(crate) fn leaf_lanes(&self) -> Option<&LeafLanes> {
        self.leaf_lanes.as_deref()
    }
}
