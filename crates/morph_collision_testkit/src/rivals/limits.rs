//! Checks weights as the core library does: posed vertices must stay in the range of `f32`.

use glam::Vec3;
use morph_collision::WeightsError;

use morph_collision_models::mesh::MorphMesh;

/// The largest coordinate that a posed vertex may reach.
const LARGEST: f64 = 2e37;

/// How far a mesh's base and targets reach. Decides in `O(targets)` whether weights are acceptable.
#[derive(Clone, Debug)]
pub struct WeightLimits {
    base_reach: f64,
    target_reach: Vec<f64>,
}

impl WeightLimits {
    /// The limits of a mesh that has not been validated.
    pub fn of(mesh: &MorphMesh) -> Self {
        Self {
            base_reach: reach(&mesh.positions),
            target_reach: mesh.targets.iter().map(|target| reach(target)).collect(),
        }
    }

    /// # Errors
    /// See [`morph_collision::Pose::set_weights`].
    pub fn check(&self, weights: &[f32]) -> Result<(), WeightsError> {
        let (given, expected) = (weights.len(), self.target_reach.len());
        if given != expected {
            return Err(WeightsError::WrongCount { given, expected });
        }
        let mut reach = self.base_reach;
        for (index, (&value, target_reach)) in weights.iter().zip(&self.target_reach).enumerate() {
            if !value.is_finite() {
                return Err(WeightsError::NotFinite { index, value });
            }
            reach += f64::from(value.abs()) * target_reach;
            if reach > LARGEST {
                return Err(WeightsError::TooLarge { index, value });
            }
        }
        Ok(())
    }
}

fn reach(vectors: &[Vec3]) -> f64 {
    let largest = vectors
        .iter()
        .fold(0.0_f32, |reach, v| reach.max(v.abs().max_element()));
    f64::from(largest)
}
