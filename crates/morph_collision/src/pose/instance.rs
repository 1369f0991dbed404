use std::sync::Arc;

use glam::Vec3;
use thiserror::Error;

use super::blend::blend_group;
use super::cache::Stamped;
use crate::bounds::{Aabb, BoxLanes, WorldFromModel, world_bounds};
use crate::model::LARGEST;
use crate::tree::{Child, MorphBvh};

/// One instance of a morphing mesh: its weights, and the volumes and vertices blended for them so far.
///
/// New weights cost a comparison and a stamp; nothing is blended until a query looks at a node, and then once. Weights that
/// do not change keep everything that was blended. A pose is in the mesh's model space; where it stands in the world is
/// given with each query.
///
/// Memory: 8 bytes per inner node and 8 per vertex, and what was visited.
#[derive(Clone, Debug)]
pub struct Pose {
    bvh: Arc<MorphBvh>,
    weights: Vec<f32>,
    volumes: Stamped<BoxLanes>,
    vertices: Stamped<Vec3>,
    blended: Blended,
}

/// How much a pose has blended in its life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Blended {
    pub(crate) volumes: u64,
    pub(crate) vertices: u64,
}

/// Why a pose refuses weights; it keeps the ones it had.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// There must be one weight per target.
    #[error("{given} weights were given, the mesh has {expected} targets")]
    WrongCount {
        /// How many were given.
        given: usize,
        /// How many targets there are.
        expected: usize,
    },
    /// A weight is NaN or infinite.
    #[error("weight {index} is {value}, not a finite number")]
    NotFinite {
        /// The target.
        index: usize,
        /// Its weight.
        value: f32,
    },
    /// The weights could take a vertex out of the range of `f32`.
    #[error("weight {index} is {value}: posed vertices could be beyond 1e37")]
    TooLarge {
        /// The target at which the sum of the possible displacements went out of range.
        index: usize,
        /// Its weight.
        value: f32,
    },
}

/// A node as a traversal holds it: which child, and where its blended box is in the pose's cache.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeRef {
    pub(crate) child: Child,
    slot: u32,
    lane: u8,
}

impl Pose {
    /// An instance at rest: all weights zero.
    #[must_use]
    pub fn new(bvh: Arc<MorphBvh>) -> Self {
        Self {
            weights: vec![0.0; bvh.model().target_count()],
            volumes: Stamped::new(bvh.group_count()),
            vertices: Stamped::new(bvh.model().vertex_count()),
            blended: Blended::default(),
            bvh,
        }
    }

    /// Takes new weights, one per target, of any sign and size; says whether they differ from the ones before.
    ///
    /// Cost: one pass over the weights.
    ///
    /// # Errors
    /// A wrong count, a weight that is not finite, or weights so large that a vertex could leave the range of `f32`. The
    /// pose keeps the weights it had.
    pub fn set_weights(&mut self, weights: &[f32]) -> Result<bool, WeightsError> {
        let model = self.bvh.model();
        if weights.len() != model.target_count() {
            return Err(WeightsError::WrongCount {
                given: weights.len(),
                expected: model.target_count(),
            });
        }
        let mut reach = f64::from(model.base_reach());
        for (index, (&value, &target_reach)) in weights.iter().zip(model.target_reach()).enumerate() {
            if !value.is_finite() {
                return Err(WeightsError::NotFinite { index, value });
            }
            reach += f64::from(value.abs()) * f64::from(target_reach);
            if reach > f64::from(2.0 * LARGEST) {
                return Err(WeightsError::TooLarge { index, value });
            }
        }
        if self.weights == weights {
            return Ok(false);
        }
        self.weights.copy_from_slice(weights);
        self.volumes.next_epoch();
        self.vertices.next_epoch();
        Ok(true)
    }

    /// The weights in force, one per target.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The tree that this is an instance of.
    #[must_use]
    pub fn bvh(&self) -> &Arc<MorphBvh> {
        &self.bvh
    }

    /// A box around the posed mesh in model space: conservative, not always the smallest.
    ///
    /// Cost: the root's box is blended, in `O(active targets)`, unless it already was for these weights.
    pub fn bounds(&mut self) -> Aabb {
        let root = self.root();
        self.node_bounds(root)
    }

    /// A world-space box around the posed mesh placed in the world; conservative.
    ///
    /// It holds every posed vertex as [`WorldFromModel::transform_point`] places it. Where the world coordinates are beyond
    /// `f32` the box is infinite. Cost as [`Pose::bounds`].
    pub fn world_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        world_bounds(world_from_model, &self.bounds())
    }

    /// A vertex of the mesh as it was given, posed, in model space; `None` if there is no such vertex.
    pub fn source_vertex(&mut self, source: usize) -> Option<Vec3> {
        let welded = *self.bvh.model().welded_from_source().get(source)?;
        Some(self.vertex(welded))
    }

    /// Bytes held on the heap, the shared tree's not included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.weights) + self.volumes.bytes() + self.vertices.bytes()
    }

    pub(crate) fn blended(&self) -> Blended {
        self.blended
    }

    pub(crate) fn root(&mut self) -> NodeRef {
        let slot = self.open(0);
        self.node(slot, 0, 0)
    }

    /// Blends a group's boxes unless they are; returns the slot to read them from.
    #[inline]
    pub(crate) fn open(&mut self, group: usize) -> usize {
        let (bvh, weights, blended) = (&self.bvh, &self.weights, &mut self.blended);
        self.volumes.slot(group, || {
            blended.volumes += bvh.group(group).children().len() as u64;
            blend_group(bvh.tables(group), weights)
        })
    }

    #[inline]
    pub(crate) fn boxes(&self, slot: usize) -> &BoxLanes {
        self.volumes.get(slot)
    }

    #[inline]
    pub(crate) fn node(&self, slot: usize, group: usize, lane: usize) -> NodeRef {
        NodeRef {
            child: self.bvh.group(group).children()[lane],
            slot: slot as u32,
            lane: lane as u8,
        }
    }

    #[inline]
    pub(crate) fn node_bounds(&self, node: NodeRef) -> Aabb {
        self.volumes.get(node.slot as usize).get(usize::from(node.lane))
    }

    /// A posed welded vertex, blended unless it is.
    #[inline]
    pub(crate) fn vertex(&mut self, vertex: u32) -> Vec3 {
        let (bvh, weights, blended) = (&self.bvh, &self.weights, &mut self.blended);
        let slot = self.vertices.slot(vertex as usize, || {
            blended.vertices += 1;
            bvh.model().blend_vertex(vertex, weights)
        });
        *self.vertices.get(slot)
    }
}
