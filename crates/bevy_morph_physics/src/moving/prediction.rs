//! Where a surface will be at the end of a step.

use morph_collision::WorldFromModel;

use crate::posing::SurfaceJoints;

/// Where a surface will be at the end of a step, as its engine predicts it.
pub struct Prediction {
    /// From the space of its pose, which is the collider's space for a skinned mesh.
    pub world_from_model: WorldFromModel,
    /// From the mesh to the engine's collider, which has a position and a rotation. This leaves scale and shear.
    pub collider_from_model: WorldFromModel,
    /// The joints of a skinned mesh, if they are known.
    pub joints: Option<SurfaceJoints>,
    /// Whether a dynamic body carries it. `world_from_model` is then that at the start of the step.
    pub carried: bool,
}
