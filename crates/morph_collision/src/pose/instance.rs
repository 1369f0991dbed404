use std::num::NonZeroU32;
use std::sync::Arc;

use glam::Vec3;

use super::anchor::{Anchor, Rest, Resting};
use super::cache::Stamped;
use super::posed::{AnyPosed, Blended, Posed, Scratch, with_posed};
use super::weights::{self, WeightsError};
use crate::bounds::{Aabb, Kernel, Slabs, Spheres, Volume, WorldFromModel, world_bounds};
use crate::tree::{AnyTables, MorphBvh, Tables};

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
    /// One weight per target of the tree, in-betweens included.
    spread: Vec<f32>,
    volumes: AnyCache,
    vertices: Stamped<Vec3>,
    resting: Option<Resting>,
    blended: Blended,
    scratch: Scratch,
    /// Whether the volumes in the cache are those of a refit.
    refitted: bool,
}

/// The volumes made so far, beside the tables they are made from.
#[derive(Clone, Debug)]
struct Cache<V> {
    tables: Arc<Tables<V>>,
    volumes: Stamped<V>,
    anchor: Option<Anchor<V>>,
}

#[derive(Clone, Debug)]
enum AnyCache {
    Aabb(Cache<Slabs<3>>),
    Kdop14(Cache<Slabs<7>>),
    Kdop18(Cache<Slabs<9>>),
    Kdop26(Cache<Slabs<13>>),
    Sphere(Cache<Spheres>),
}

impl<V: Volume> Cache<V> {
    fn new(tables: &Arc<Tables<V>>, groups: usize) -> Self {
        Self {
            tables: tables.clone(),
            volumes: Stamped::new(groups),
            anchor: None,
        }
    }

    fn next_epoch(&mut self, weights: &[f32]) {
        self.volumes.next_epoch();
        if let Some(anchor) = &mut self.anchor {
            anchor.follow(weights);
        }
    }

    fn bytes(&self) -> usize {
        self.volumes.bytes() + self.anchor.as_ref().map_or(0, Anchor::bytes)
    }
}

/// Evaluates an expression for the [`Cache`] in an [`AnyCache`], whatever its kind of volume.
macro_rules! with_cache {
    ($any:expr, $cache:ident => $body:expr) => {
        match $any {
            AnyCache::Aabb($cache) => $body,
            AnyCache::Kdop14($cache) => $body,
            AnyCache::Kdop18($cache) => $body,
            AnyCache::Kdop26($cache) => $body,
            AnyCache::Sphere($cache) => $body,
        }
    };
}

impl AnyCache {
    fn new(bvh: &MorphBvh) -> Self {
        let groups = bvh.topology().group_count();
        match bvh.tables() {
            AnyTables::Aabb(tables) => Self::Aabb(Cache::new(tables, groups)),
            AnyTables::Kdop14(tables) => Self::Kdop14(Cache::new(tables, groups)),
            AnyTables::Kdop18(tables) => Self::Kdop18(Cache::new(tables, groups)),
            AnyTables::Kdop26(tables) => Self::Kdop26(Cache::new(tables, groups)),
            AnyTables::Sphere(tables) => Self::Sphere(Cache::new(tables, groups)),
        }
    }
}

impl Pose {
    /// An instance at rest: all weights zero.
    #[must_use]
    pub fn new(bvh: Arc<MorphBvh>) -> Self {
        let weights = vec![0.0; bvh.model().target_count()];
        let mut spread = Vec::new();
        weights::spread(bvh.columns(), &weights, &mut spread);
        Self {
            weights,
            spread,
            volumes: AnyCache::new(&bvh),
            vertices: Stamped::new(bvh.model().vertex_count()),
            resting: None,
            blended: Blended::default(),
            scratch: Scratch::default(),
            refitted: false,
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
        let rest = self
            .resting
            .as_mut()
            .map(|resting| resting.count(&self.weights, weights));
        let changed = self.weights != weights;
        if changed {
            self.weights.copy_from_slice(weights);
            weights::spread(self.bvh.columns(), weights, &mut self.spread);
            with_cache!(&mut self.volumes, cache => cache.next_epoch(weights));
            self.vertices.next_epoch();
            self.refitted = false;
        }
        match rest {
            Some(Rest::Moved) => self.drop_anchor(),
            Some(Rest::Settled) => {
                let reach = self.bvh.model().target_reach();
                let settled = self
                    .resting
                    .as_ref()
                    .and_then(|resting| resting.settled(weights, reach));
                if let Some(settled) = settled {
                    self.anchor_at(&settled);
                }
            }
            Some(Rest::Unchanged) | None => {}
        }
        Ok(changed)
    }

    /// Fits all volumes tightly to the shape at the weights in force, and blends from there until the anchor is dropped.
    ///
    /// Worth it for weights that are set and then rest, such as a character's sliders: while they do, volumes are exact in
    /// them. Other weights are then bounded by intervals. Cost: the whole mesh is blended once; memory: one volume per node.
    pub fn take_anchor(&mut self) {
        let weights = self.weights.clone();
        self.anchor_at(&weights);
    }

    /// Goes back to blending from the tree's references.
    pub fn drop_anchor(&mut self) {
        let weights = &self.weights;
        with_cache!(&mut self.volumes, cache => {
            cache.anchor = None;
            cache.next_epoch(weights);
        });
        self.refitted = false;
    }

    /// Whether an anchor is in use.
    #[must_use]
    pub fn is_anchored(&self) -> bool {
        with_cache!(&self.volumes, cache => cache.anchor.is_some())
    }

    /// Takes an anchor by itself once weights that make up most of the shape have not changed in so many calls of
    /// [`Pose::set_weights`], and drops it when one of them moves; `None`, the default, never does.
    pub fn anchor_after(&mut self, calls: Option<NonZeroU32>) {
        let targets = self.weights.len();
        self.resting = calls.map(|calls| Resting::new(calls.get(), targets));
    }

    fn anchor_at(&mut self, weights: &[f32]) {
        let bvh = &self.bvh;
        let in_force = &self.weights;
        with_cache!(&mut self.volumes, cache => {
            cache.anchor = Some(Anchor::fit(bvh.model(), bvh.topology(), weights));
            cache.next_epoch(in_force);
        });
        self.refitted = false;
    }

    /// Fits all volumes tightly to the shape at the weights in force, at once, until other weights are set.
    ///
    /// Pays where a query is going to look at most of the tree: two bodies deep in each other of which all pairs are wanted.
    /// Otherwise leave it to queries to blend what they look at; `docs/performance.md` compares both. Cost: every vertex is
    /// blended and every volume fitted, `O(n)`.
    pub fn refit(&mut self) {
        with_posed!(self.posed(), mut posed => posed.refit());
        self.refitted = true;
    }

    /// Whether volumes are made from the tree's references alone, so that any other pose of it makes the same for the same
    /// weights.
    pub(crate) fn blends_from_references(&self) -> bool {
        !self.refitted && !self.is_anchored()
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
    /// Cost: the root's volume is blended, in `O(active targets)`, unless it already was for these weights.
    pub fn bounds(&mut self) -> Aabb {
        with_posed!(self.posed(), mut posed => posed.bounds())
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
        Some(with_posed!(self.posed(), mut posed => posed.vertex(welded)))
    }

    /// A vertex as the model numbers it after welding ([`MorphModel::triangle`](crate::MorphModel::triangle)), posed, in model
    /// space; `None` if there is no such vertex.
    pub fn vertex(&mut self, vertex: u32) -> Option<Vec3> {
        let exists = (vertex as usize) < self.bvh.model().vertex_count();
        exists.then(|| with_posed!(self.posed(), mut posed => posed.vertex(vertex)))
    }

    /// The corners of a triangle, posed, in model space; `None` if there is no such triangle.
    pub fn triangle(&mut self, triangle: u32) -> Option<[Vec3; 3]> {
        let exists = (triangle as usize) < self.bvh.model().triangle_count();
        let corners = exists.then(|| self.bvh.model().triangle(triangle as usize))?;
        Some(with_posed!(self.posed(), mut posed => corners.map(|corner| posed.vertex(corner))))
    }

    /// Other weights under volumes that were blended for these: what a bug would do.
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
        let volumes = with_cache!(&self.volumes, cache => cache.bytes());
        size_of_val(&*self.weights) + size_of_val(&*self.spread) + volumes + self.vertices.bytes()
    }

    pub(crate) fn posed(&mut self) -> AnyPosed<'_> {
        let Self {
            bvh,
            weights,
            spread,
            volumes,
            vertices,
            resting: _,
            blended,
            scratch,
            refitted: _,
        } = self;
        let level = Kernel::level();
        macro_rules! posed {
            ($cache:expr) => {
                Posed {
                    model: bvh.model(),
                    topology: bvh.topology(),
                    tables: &$cache.tables,
                    leaf_lanes: bvh.leaf_lanes(),
                    anchor: $cache.anchor.as_ref(),
                    weights,
                    spread,
                    volumes: &mut $cache.volumes,
                    vertices,
                    blended,
                    scratch,
                    level,
                }
            };
        }
        match volumes {
            AnyCache::Aabb(cache) => AnyPosed::Aabb(posed!(cache)),
            AnyCache::Kdop14(cache) => AnyPosed::Kdop14(posed!(cache)),
            AnyCache::Kdop18(cache) => AnyPosed::Kdop18(posed!(cache)),
            AnyCache::Kdop26(cache) => AnyPosed::Kdop26(posed!(cache)),
            AnyCache::Sphere(cache) => AnyPosed::Sphere(posed!(cache)),
        }
    }
}
