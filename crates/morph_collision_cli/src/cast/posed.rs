//! Bodies with this project's trees, placed and posed.

use std::sync::Arc;

use glam::{Affine3A, DVec3};
use morph_collision::{Aabb, Body, BuildOptions, JointMatrices, MorphBvh, MorphModel, Pose, WorldFromModel};
use morph_collision_models::mesh::MorphMesh;

use super::{SetUp, Shape, Source};
use crate::error::{AnyError, PoseError};
use crate::options::tree::TreeArgs;

/// A body at one moment.
#[derive(Debug)]
pub struct Posed {
    pub(crate) pose: Pose,
    world_from_model: WorldFromModel,
}

impl Posed {
    /// A body at rest at the world's origin.
    pub(crate) fn new(tree: Arc<MorphBvh>) -> Self {
        Self {
            pose: Pose::new(tree),
            world_from_model: WorldFromModel::IDENTITY,
        }
    }

    /// Sets its weights, joints and placement.
    pub(crate) fn set(&mut self, shape: &Shape) -> Result<(), PoseError> {
        if let Some(joints) = &shape.joints {
            self.pose.set_joints(&JointMatrices::new(joints)?)?;
        }
        self.pose.set_weights(&shape.weights)?;
        self.world_from_model = WorldFromModel::new(shape.world_from_model)?;
        Ok(())
    }

    pub(crate) fn body(&mut self) -> Body<'_> {
        Body::new(&mut self.pose, &self.world_from_model)
    }

    /// A box around it in world space.
    pub(crate) fn bounds(&mut self) -> Aabb {
        self.pose.world_bounds(&self.world_from_model)
    }

    /// A box around it in world space that is cheap to compute.
    pub(crate) fn broad_phase_bounds(&mut self) -> Aabb {
        self.pose.broad_phase_bounds(&self.world_from_model)
    }

    /// Its vertices in world space, in the order of its mesh.
    pub(crate) fn vertices(&mut self) -> Vec<DVec3> {
        let bvh = Arc::clone(self.pose.bvh());
        let mut body = self.body();
        let welded = bvh.model().welded_from_source().iter();
        welded.filter_map(|&vertex| body.vertex(vertex)).collect()
    }
}

/// One body of each mesh named.
impl SetUp for TreeArgs {
    type Bodies = Vec<Posed>;

    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64) {
        (mesh.tree_bytes(), mesh.body_bytes(false))
    }

    fn set_up(&self, source: &Source<'_>) -> Result<Vec<Posed>, AnyError> {
        let trees = trees(source, &self.build());
        Ok(source
            .mesh_of_body
            .iter()
            .map(|&mesh| Posed::new(Arc::clone(&trees[mesh])))
            .collect())
    }
}

/// One tree per mesh.
pub(crate) fn trees(source: &Source<'_>, options: &BuildOptions) -> Vec<Arc<MorphBvh>> {
    let tree = |model: &Arc<MorphModel>| Arc::new(MorphBvh::build(Arc::clone(model), options));
    source.models.iter().map(tree).collect()
}

/// The joints of a skinned mesh that stands at `world_from_model`.
pub(crate) fn placed(world_from_model: Affine3A, joints: Vec<Affine3A>) -> Vec<Affine3A> {
    joints.into_iter().map(|joint| world_from_model * joint).collect()
}
