//! Where the weights of a surface come from.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::physics_api::{WeightsProblem, drawn_weights};

use crate::posing::LazyPose;

/// The weights with which a mesh is drawn: its own, or those of the entity that it refers to.
#[derive(Clone, Copy)]
pub struct WeightSource<'a> {
    /// The entity's component. A mesh without it is drawn in its rest pose.
    pub component: Option<&'a MeshMorphWeights>,
    /// The weights that meshes of one node share.
    pub shared: &'a Query<'a, 'a, &'static MorphWeights>,
}

impl WeightSource<'_> {
    /// Copies the weights of a mesh with this number of targets. They may be invalid.
    ///
    /// # Errors
    /// The entity that it refers to has no weights.
    pub fn read(&self, count: usize, into: &mut Vec<f32>) -> Result<(), WeightsProblem> {
        let mut rest = Vec::new();
        let weights = drawn_weights(count, self.component, self.shared, &mut rest)?;
        into.clear();
        into.extend_from_slice(weights);
        Ok(())
    }

    /// Gives a pose the weights.
    ///
    /// # Errors
    /// They do not fit the pose, which keeps its own.
    pub fn pose(&self, pose: &mut LazyPose, rest: &mut Vec<f32>) -> Result<(), WeightsProblem> {
        let drawn = drawn_weights(pose.weights().len(), self.component, self.shared, rest)?;
        Ok(pose.set_weights(drawn)?)
    }
}
