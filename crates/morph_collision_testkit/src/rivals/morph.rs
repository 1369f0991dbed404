//! The method that this project is about, as one of its kind.

use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{Aabb, Body, BuildOptions, MorphBvh, PairQuery, PairStats, Pose, TrianglePair, WorldFromModel};

use super::{Method, PoseError, SetUpError, Wanted};
use crate::mesh::MorphMesh;

/// Poses of shared trees of blended volumes.
#[derive(Debug)]
pub(super) struct Morph {
    bodies: Vec<(Pose, WorldFromModel)>,
    query: PairQuery,
    work: PairStats,
}

impl Morph {
    pub(super) fn new(meshes: &[MorphMesh], bodies: &[usize], options: &BuildOptions) -> Result<Self, SetUpError> {
        let mut trees = Vec::with_capacity(meshes.len());
        for (mesh, source) in meshes.iter().enumerate() {
            let model = source.to_model().map_err(|reason| SetUpError::Model { mesh, reason })?;
            trees.push(Arc::new(MorphBvh::build(Arc::new(model), options)?));
        }
        let pose = |&mesh: &usize| (Pose::new(Arc::clone(&trees[mesh])), WorldFromModel::IDENTITY);
        Ok(Self {
            bodies: bodies.iter().map(pose).collect(),
            query: PairQuery::new(),
            work: PairStats::default(),
        })
    }
}

impl Method for Morph {
    fn set_body(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<(), PoseError> {
        let world_from_model = WorldFromModel::new(*world_from_model)?;
        let (pose, place) = &mut self.bodies[body];
        pose.set_weights(weights)?;
        *place = world_from_model;
        Ok(())
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let (pose, place) = &mut self.bodies[body];
        pose.world_bounds(place)
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let Ok([(pose_a, place_a), (pose_b, place_b)]) = self.bodies.get_disjoint_mut([a, b]) else {
            return;
        };
        let (a, b) = (Body::new(pose_a, place_a), Body::new(pose_b, place_b));
        self.work += match wanted {
            Wanted::All => self.query.all(a, b, pairs),
            Wanted::First => {
                let (first, stats) = self.query.first(a, b);
                pairs.extend(first);
                stats
            }
        };
    }

    fn work(&self) -> PairStats {
        self.work
    }
}
