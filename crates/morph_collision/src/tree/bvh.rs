//! The public type of a tree.

use std::fmt;
use std::sync::{Arc, OnceLock};

use super::certificates::{OpenPairs, SelfCertificates};
use super::{BuildOptions, Child, ChildKind, LeafLanes, Owners, SelfFront, SkinTables, Tables, Topology};
use crate::bounds::Kernel;
use crate::input_error::InputError;
use crate::model::{MorphModel, WeightBox};

/// A bounding volume hierarchy over a [`MorphModel`], valid for all weights. It is immutable and shared by all instances of the
/// mesh.
///
/// Each node stores its box at the base, and how the box moves with each target that moves any of its vertices. A
/// [`Pose`](crate::Pose) blends these when a query visits the node.
///
/// Building takes `O(n log n)` time for `n` triangles. Memory is proportional to the number of targets that move a node, summed
/// over all nodes. Cloning is cheap.
#[derive(Clone)]
pub struct MorphBvh {
    pub(super) model: Arc<MorphModel>,
    pub(crate) topology: Arc<Topology>,
    pub(crate) tables: Arc<Tables>,
    /// `Some` for a skinned mesh.
    pub(crate) skin: Option<Arc<SkinTables>>,
    pub(crate) leaf_lanes: Option<Arc<LeafLanes>>,
    /// Computed when a query about motion first needs it.
    pub(super) owners: Arc<OnceLock<Owners>>,
    /// Computed when a query about one body and itself first needs it.
    pub(super) self_front: Arc<OnceLock<SelfFront>>,
    pub(super) certificates: Arc<OnceLock<SelfCertificates>>,
    pub(super) options: BuildOptions,
    pub(super) kernel: Kernel,
}

impl MorphBvh {
    /// Makes queries use this instruction set instead of the machine's best one. For tests and measurements.
    ///
    /// Answers stay the same bit for bit. If the trees of two bodies use different instruction sets, pair queries use the first
    /// body's.
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

    /// The mesh.
    #[must_use]
    pub fn model(&self) -> &Arc<MorphModel> {
        &self.model
    }

    /// The options that the tree was built with.
    #[must_use]
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// The number of nodes, including the root and the leaves.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.topology.node_count()
    }

    /// The number of leaves.
    #[must_use]
    pub fn leaf_count(&self) -> usize {
        self.topology.leaf_count()
    }

    /// The number of edges on the longest path from the root to a leaf; 0 if the root is a leaf.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.topology.depth
    }

    /// Bytes on the heap, without the model.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let leaf_lanes = self.leaf_lanes.as_ref().map_or(0, |lanes| lanes.bytes());
        let skin = self.skin.as_ref().map_or(0, |skin| skin.bytes());
        let owners = self.owners.get().map_or(0, Owners::bytes);
        let self_front = self.self_front.get().map_or(0, SelfFront::bytes);
        let certificates = self.certificates.get().map_or(0, SelfCertificates::bytes);
        self.topology.bytes() + self.tables.bytes() + skin + leaf_lanes + owners + self_front + certificates
    }

    /// The triangle that owns each vertex and edge. Computed on first use: `O(n log n)`.
    pub(crate) fn owners(&self) -> &Owners {
        self.owners.get_or_init(|| Owners::new(&self.model))
    }

    /// Where walks over the tree and itself start. Computed on first use: `O(n log n)`.
    pub(crate) fn self_front(&self) -> &SelfFront {
        self.self_front
            .get_or_init(|| SelfFront::new(&self.model, &self.topology))
    }

    /// Makes every [`SelfQuery`](crate::SelfQuery) of this tree and its clones use certificates. Returns false if the tree has some already,
    /// which stay.
    ///
    /// # Errors
    /// They are of another tree. Trees that are built twice from the same mesh are different trees.
    pub fn set_certificates(&self, certificates: SelfCertificates) -> Result<bool, InputError> {
        if !Arc::ptr_eq(&self.topology, &certificates.topology) {
            return Err(InputError::DifferentTrees {
                what: "a tree and its certificates".to_owned(),
            });
        }
        Ok(self.certificates.set(certificates).is_ok())
    }

    /// The certificates of this tree.
    #[must_use]
    pub fn certificates(&self) -> Option<&SelfCertificates> {
        self.certificates.get()
    }

    /// Where walks over the tree and itself start that look for pairs of triangles, for these weights.
    pub(crate) fn self_front_for(&self, weights: &[f32]) -> &SelfFront {
        match self.certificates.get() {
            Some(certificates) if certificates.weights.contains(weights) => &certificates.front,
            _ => self.self_front(),
        }
    }

    /// Certificates for weights in a box. `open` has all pairs of triangles that share no vertex and are not proved free.
    pub(crate) fn self_certificates(&self, weights: WeightBox, open: &OpenPairs) -> SelfCertificates {
        SelfCertificates::new(&self.topology, self.self_front(), weights, open)
    }

    /// Cuts the mesh into parts of nearby triangles: the largest subtrees with at most `max_triangles` triangles. Every triangle is
    /// in exactly one part, and successive parts are near each other.
    ///
    /// Leaves are never cut, so a leaf with more than `max_triangles` triangles becomes a part as it is. Cost: the number of
    /// parts times the depth of the tree.
    #[must_use]
    pub fn subtrees(&self, max_triangles: usize) -> Vec<&[u32]> {
        let topology = &self.topology;
        let mut parts = Vec::new();
        let mut rest: Vec<Child> = topology.group(0).children().to_vec();
        while let Some(node) = rest.pop() {
            let triangles = topology.triangles_below(node);
            match node.kind() {
                ChildKind::Group(group) if triangles.len() > max_triangles => {
                    rest.extend(topology.group(group).children().iter().rev());
                }
                _ => parts.push(triangles),
            }
        }
        parts
    }
}

impl fmt::Debug for MorphBvh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MorphBvh")
            .field("model", &self.model)
            .field("options", &self.options)
            .field("nodes", &self.node_count())
            .field("leaves", &self.leaf_count())
            .field("depth", &self.depth())
            .finish_non_exhaustive()
    }
}
