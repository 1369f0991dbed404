//! This project's method as a [`Method`], and the methods that refit, with this project's code.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{
    Aabb, Body, JointMatrices, MorphBvh, PairMemory, PairQuery, Pose, QueryStats, Ray, RayQuery, TrianglePair,
    WorldFromModel,
};

use super::{CastHit, CastRay, Method, MethodOptions, PoseError, SetUpError, Wanted, push};
use morph_collision_models::mesh::MorphMesh;

/// Poses of shared trees.
#[derive(Debug)]
pub(super) struct Morph {
    bodies: Vec<(Pose, WorldFromModel)>,
    /// For each body, whether its joints have moved since its boxes were fitted.
    joints_moved: Vec<bool>,
    /// For each body, the number of boxes that are fitted at once.
    fitted_at_once: Vec<u64>,
    follow: Follow,
    query: PairQuery,
    rays: RayQuery,
    witness: bool,
    /// For every queried pair of bodies, if witnesses are remembered.
    memories: BTreeMap<(usize, usize), PairMemory>,
    work: QueryStats,
}

/// When volumes and vertices are updated for new weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Follow {
    /// Blended when a query looks at them.
    Lazily,
    /// All vertices posed and all boxes fitted at once.
    AtOnce,
    /// All vertices posed and the upper half of the levels fitted at once, the others when a query looks at them.
    ByHalves,
}

impl Morph {
    pub(super) fn new(
        follow: Follow,
        meshes: &[MorphMesh],
        bodies: &[usize],
        options: &MethodOptions,
    ) -> Result<Self, SetUpError> {
        let mut trees = Vec::with_capacity(meshes.len());
        for (mesh, source) in meshes.iter().enumerate() {
            let model = source.to_model().map_err(|reason| SetUpError::Model { mesh, reason })?;
            trees.push(Arc::new(MorphBvh::build(Arc::new(model), &options.tree)));
        }
        let pose = |&mesh: &usize| (Pose::new(Arc::clone(&trees[mesh])), WorldFromModel::IDENTITY);
        let fitted: Vec<u64> = trees.iter().map(|tree| follow.fitted_at_once(tree)).collect();
        Ok(Self {
            bodies: bodies.iter().map(pose).collect(),
            fitted_at_once: bodies.iter().map(|&mesh| fitted[mesh]).collect(),
            joints_moved: vec![false; bodies.len()],
            follow,
            query: PairQuery::new(),
            rays: RayQuery::new(),
            witness: options.witness,
            memories: BTreeMap::new(),
            work: QueryStats::default(),
        })
    }
}

impl Follow {
    /// The number of boxes of a tree that are fitted at once.
    fn fitted_at_once(self, tree: &Arc<MorphBvh>) -> u64 {
        let deepest = match self {
            Self::Lazily => return 0,
            Self::AtOnce => return tree.node_count() as u64,
            Self::ByHalves => tree.depth().div_ceil(2),
        };
        let mut count = 0;
        Pose::new(Arc::clone(tree)).visit_nodes(|node| {
            count += 1;
            node.depth < deepest
        });
        count
    }
}

impl Method for Morph {
    fn set_joints(&mut self, body: usize, world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        let pose = &mut self.bodies[body].0;
        if pose.joints().is_none() {
            return Err(PoseError::NoJoints);
        }
        self.joints_moved[body] |= pose.set_joints(&JointMatrices::new(world_from_mesh)?)?;
        Ok(())
    }

    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let world_from_model = WorldFromModel::new(*world_from_model)?;
        let (pose, place) = &mut self.bodies[body];
        let changed = pose.set_weights(weights)? || self.joints_moved[body];
        *place = world_from_model;
        Ok(changed && self.follow != Follow::Lazily)
    }

    fn refit(&mut self, body: usize) {
        let pose = &mut self.bodies[body].0;
        match self.follow {
            Follow::Lazily => {}
            Follow::AtOnce => pose.refit(),
            Follow::ByHalves => pose.refit_lazily(),
        }
        self.joints_moved[body] = false;
        self.work.nodes_blended += self.fitted_at_once[body];
        self.work.vertices_blended += pose.bvh().model().vertex_count() as u64;
    }

    fn is_lazy(&self) -> bool {
        self.follow != Follow::AtOnce
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let (pose, place) = &mut self.bodies[body];
        pose.broad_phase_bounds(place)
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let Ok([(pose_a, place_a), (pose_b, place_b)]) = self.bodies.get_disjoint_mut([a, b]) else {
            return;
        };
        let (body_a, body_b) = (Body::new(pose_a, place_a), Body::new(pose_b, place_b));
        let Self {
            query,
            memories,
            witness,
            ..
        } = self;
        let start = pairs.len();
        match wanted {
            Wanted::All | Wanted::UpTo(_) => query.visit(body_a, body_b, |pair| push(wanted, pairs, start, pair)),
            Wanted::First => pairs.extend(if *witness {
                query.first_with(memories.entry((a, b)).or_default(), body_a, body_b)
            } else {
                query.first(body_a, body_b)
            }),
        }
        self.work += query.stats();
    }

    fn cast(&mut self, body: usize, ray: &CastRay) -> Option<CastHit> {
        let (pose, place) = &mut self.bodies[body];
        let ray = Ray::new(ray.origin, ray.direction, f64::INFINITY).ok()?;
        let hit = self.rays.closest(Body::new(pose, place), &ray);
        self.work += self.rays.stats();
        hit.map(|hit| CastHit {
            triangle: hit.triangle,
            t: hit.t,
        })
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
