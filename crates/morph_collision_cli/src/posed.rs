//! Bodies with this project's trees, placed and posed.

use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{Body, BuildOptions, JointMatrices, MorphBvh, Pose, WorldFromModel};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::rivals::{PoseError, SetUpError};

use crate::cast::{SetUp, Shape};
use crate::tree_options::TreeArgs;

/// A body at one moment.
#[derive(Debug)]
pub(crate) struct Posed {
    pub(crate) pose: Pose,
    place: WorldFromModel,
}

impl Posed {
    /// A body at rest at the world's origin.
    pub(crate) fn new(tree: Arc<MorphBvh>) -> Self {
        Self {
            pose: Pose::new(tree),
            place: WorldFromModel::IDENTITY,
        }
    }

    /// Sets its weights, joints and placement.
    pub(crate) fn set(&mut self, shape: &Shape) -> Result<(), PoseError> {
        if let Some(joints) = &shape.joints {
            self.pose.set_joints(&JointMatrices::new(joints)?)?;
        }
        self.pose.set_weights(&shape.weights)?;
        self.place = WorldFromModel::new(shape.world_from_model)?;
        Ok(())
    }

    pub(crate) fn body(&mut self) -> Body<'_> {
        Body::new(&mut self.pose, &self.place)
    }

    /// A box around it in world space.
    pub(crate) fn bounds(&mut self) -> morph_collision::Aabb {
        self.pose.world_bounds(&self.place)
    }
}

/// One body of each mesh named.
impl SetUp for TreeArgs {
    type Bodies = Vec<Posed>;

    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64) {
        (mesh.tree_bytes(), mesh.body_bytes(false))
    }

    fn set_up(&self, meshes: &[MorphMesh], mesh_of_body: &[usize]) -> Result<Vec<Posed>, SetUpError> {
        let trees = trees(meshes, &self.build())?;
        Ok(mesh_of_body
            .iter()
            .map(|&mesh| Posed::new(Arc::clone(&trees[mesh])))
            .collect())
    }
}

/// One tree per mesh.
pub(crate) fn trees(meshes: &[MorphMesh], options: &BuildOptions) -> Result<Vec<Arc<MorphBvh>>, SetUpError> {
    let tree = |(mesh, source): (usize, &MorphMesh)| {
        let model = source.to_model().map_err(|reason| SetUpError::Model { mesh, reason })?;
        Ok(Arc::new(MorphBvh::build(Arc::new(model), options)))
    };
    meshes.iter().enumerate().map(tree).collect()
}

/// The joints of a skinned mesh that stands at `world_from_model`.
pub(crate) fn placed(world_from_model: Affine3A, joints: Vec<Affine3A>) -> Vec<Affine3A> {
    joints.into_iter().map(|joint| world_from_model * joint).collect()
}
