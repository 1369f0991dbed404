use std::sync::Arc;

use glam::Vec3;

use super::anchor::Anchor;
use super::cache::Stamped;
use super::posed::{Blended, Posed, Scratch};
use super::weights::{self, WeightsError};
use crate::bounds::{Aabb, BoxLanes, WorldFromModel, world_bounds};
use crate::tree::MorphBvh;

/// One instance of a morphing mesh: its weights, and the boxes and vertices blended for them so far.
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
    source: Source,
    boxes: Stamped<BoxLanes>,
    vertices: Stamped<Vec3>,
    blended: Blended,
    scratch: Scratch,
}

/// What a pose's boxes are made from.
#[derive(Clone, Debug)]
enum Source {
    /// The tree's references.
    References,
    /// Tight boxes at other weights.
    Anchor(Anchor),
    /// The vertices at the weights in force: all boxes are there.
    Vertices,
}

impl Pose {
    /// An instance at rest: all weights zero.
    #[must_use]
    pub fn new(bvh: Arc<MorphBvh>) -> Self {
        Self {
            weights: vec![0.0; bvh.model().target_count()],
            source: Source::References,
            boxes: Stamped::new(bvh.topology().group_count()),
            vertices: Stamped::new(bvh.model().vertex_count()),
            blended: Blended::default(),
            scratch: Scratch::default(),
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
        weights::check(self.bvh.model(), weights)?;
        let changed = self.weights != weights;
        if changed {
            self.weights.copy_from_slice(weights);
            self.boxes.next_epoch();
            self.vertices.next_epoch();
            match &mut self.source {
                Source::References => {}
                Source::Anchor(anchor) => anchor.follow(weights),
                Source::Vertices => self.source = Source::References,
            }
        }
        Ok(changed)
    }

    /// Fits all boxes tightly to the shape at the weights in force, and blends from there until the anchor is dropped.
    ///
    /// Worth it for weights that are set and then rest, such as a character's sliders: while they do, boxes are exact in
    /// them. Other weights are then bounded by intervals. Cost: the whole mesh is blended once; memory: one box per node.
    pub fn take_anchor(&mut self) {
        let mut anchor = Anchor::fit(self.bvh.model(), self.bvh.topology(), &self.weights);
        anchor.follow(&self.weights);
        self.source = Source::Anchor(anchor);
        self.boxes.next_epoch();
    }

    /// Goes back to blending from the tree's references; without an anchor nothing changes.
    pub fn drop_anchor(&mut self) {
        if self.is_anchored() {
            self.source = Source::References;
            self.boxes.next_epoch();
        }
    }

    /// Whether an anchor is in use.
    #[must_use]
    pub fn is_anchored(&self) -> bool {
        matches!(self.source, Source::Anchor(_))
    }

    /// Fits all boxes tightly to the shape at the weights in force, at once, until other weights are set; an anchor is dropped.
    ///
    /// Pays where a query is going to look at most of the tree: two bodies deep in each other of which all pairs are wanted.
    /// Otherwise leave it to queries to blend what they look at; `docs/performance.md` compares both. Cost: every vertex is
    /// blended and every box fitted, `O(n)`.
    pub fn refit(&mut self) {
        self.source = Source::Vertices;
        self.posed().refit();
    }

    /// Whether boxes are made from the tree's references alone, so that any other pose of it makes the same for the same
    /// weights.
    pub(crate) fn blends_from_references(&self) -> bool {
        matches!(self.source, Source::References)
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
        self.posed().bounds()
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
        Some(self.posed().vertex(welded))
    }

    /// A vertex as the model numbers it after welding ([`MorphModel::triangle`](crate::MorphModel::triangle)), posed, in model
    /// space; `None` if there is no such vertex.
    pub fn vertex(&mut self, vertex: u32) -> Option<Vec3> {
        let exists = (vertex as usize) < self.bvh.model().vertex_count();
        exists.then(|| self.posed().vertex(vertex))
    }

    /// The corners of a triangle, posed, in model space; `None` if there is no such triangle.
    pub fn triangle(&mut self, triangle: u32) -> Option<[Vec3; 3]> {
        let exists = (triangle as usize) < self.bvh.model().triangle_count();
        let corners = exists.then(|| self.bvh.model().triangle(triangle as usize))?;
        let mut posed = self.posed();
        Some(corners.map(|corner| posed.vertex(corner)))
    }

    /// Other weights under boxes that were blended for these: what a bug would do.
    #[cfg(test)]
    pub(super) fn pretend_weights(&mut self, weights: &[f32]) {
        self.weights.copy_from_slice(weights);
        self.vertices.next_epoch();
    }

    /// How far any vertex can be, in model space, from where it is with other weights, of which there is one per target: a bound,
    /// what both blends round included.
    ///
    /// Cost: linear in the number of targets.
    #[must_use]
    pub fn displacement_from(&self, before: &[f32]) -> f64 {
        weights::displacement(self.bvh.model(), before, &self.weights)
    }

    /// Bytes held on the heap, the shared tree's not included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let anchor = match &self.source {
            Source::Anchor(anchor) => anchor.bytes(),
            Source::References | Source::Vertices => 0,
        };
        size_of_val(&*self.weights) + anchor + self.boxes.bytes() + self.vertices.bytes()
    }

    pub(crate) fn posed(&mut self) -> Posed<'_> {
        Posed {
            model: self.bvh.model(),
            topology: self.bvh.topology(),
            tables: self.bvh.tables(),
            leaf_lanes: self.bvh.leaf_lanes(),
            weights: &self.weights,
            anchor: match &self.source {
                Source::Anchor(anchor) => Some(anchor),
                Source::References | Source::Vertices => None,
            },
            boxes: &mut self.boxes,
            vertices: &mut self.vertices,
            blended: &mut self.blended,
            scratch: &mut self.scratch,
            level: self.bvh.kernel().level(),
        }
    }
}
