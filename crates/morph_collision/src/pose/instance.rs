use std::sync::Arc;

use glam::Vec3;

use super::cache::Stamped;
use super::posed::{AnyPosed, Blended, Posed, Scratch, with_posed};
use super::weights::{self, WeightsError};
use crate::bounds::{Aabb, Slabs, Spheres, Volume, WorldFromModel, world_bounds};
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
    blended: Blended,
    scratch: Scratch,
}

/// The volumes made so far, beside the tables they are made from.
#[derive(Clone, Debug)]
struct Cache<V> {
    tables: Arc<Tables<V>>,
    volumes: Stamped<V>,
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
        }
    }
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

    fn next_epoch(&mut self) {
        match self {
            Self::Aabb(cache) => cache.volumes.next_epoch(),
            Self::Kdop14(cache) => cache.volumes.next_epoch(),
            Self::Kdop18(cache) => cache.volumes.next_epoch(),
            Self::Kdop26(cache) => cache.volumes.next_epoch(),
            Self::Sphere(cache) => cache.volumes.next_epoch(),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Aabb(cache) => cache.volumes.bytes(),
            Self::Kdop14(cache) => cache.volumes.bytes(),
            Self::Kdop18(cache) => cache.volumes.bytes(),
            Self::Kdop26(cache) => cache.volumes.bytes(),
            Self::Sphere(cache) => cache.volumes.bytes(),
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
        if self.weights == weights {
            return Ok(false);
        }
        self.weights.copy_from_slice(weights);
        weights::spread(self.bvh.columns(), weights, &mut self.spread);
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

    /// Bytes held on the heap, the shared tree's not included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.weights) + size_of_val(&*self.spread) + self.volumes.bytes() + self.vertices.bytes()
    }

    pub(crate) fn posed(&mut self) -> AnyPosed<'_> {
        let Self {
            bvh,
            weights,
            spread,
            volumes,
            vertices,
            blended,
            scratch,
        } = self;
        macro_rules! posed {
            ($cache:expr) => {
                Posed {
                    model: bvh.model(),
                    topology: bvh.topology(),
                    tables: &$cache.tables,
                    weights,
                    spread,
                    volumes: &mut $cache.volumes,
                    vertices,
                    blended,
                    scratch,
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
