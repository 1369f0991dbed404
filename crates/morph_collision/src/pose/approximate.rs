use std::sync::Arc;

use super::Pose;
use super::weights::{self, WeightsError};
use crate::tree::MorphBvh;

/// An answer about a mesh that is displaced from the one that was asked about.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Approximate<T> {
    /// Exact for a mesh of which no vertex is farther off than the displacement.
    pub answer: T,
    /// A length in model units; 0 where the answer is that for the weights that were set.
    pub displacement: f64,
}

/// An instance whose shape may be off by a length, so that less of it is blended, and less often.
///
/// Targets that move nothing by more than a small part of that length are left out, and weights that change little do not
/// make what was blended stale. Between them a crowd of faces that all tremble costs no more than a few that speak.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())?);
/// let mut pose = ApproximatePose::new(bvh, 0.01);
/// assert!(pose.set_weights(&[0.5])?); // moves by 0.5
/// assert!(!pose.set_weights(&[0.501])?); // moves by 0.001: the shape stays
/// let down = Ray::new(glam::DVec3::new(0.2, 0.2, 2.0), -glam::DVec3::Z, f64::INFINITY)?;
/// let hit = pose.ask(|pose| {
///     let body = Body::new(pose, &WorldFromModel::IDENTITY);
///     RayQuery::new().closest(body, &down).0.map(|hit| hit.t)
/// });
/// assert_eq!(hit.answer, Some(1.5));
/// assert!(hit.displacement > 0.001 && hit.displacement <= 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ApproximatePose {
    pose: Pose,
    tolerance: f64,
    wanted: Vec<f32>,
    /// Reused by [`ApproximatePose::set_weights`].
    reduced: Vec<f32>,
    by_influence: Vec<(f64, usize)>,
}

impl ApproximatePose {
    /// An instance at rest whose vertices may be displaced by up to `tolerance` in model units; negative or NaN is 0.
    #[must_use]
    pub fn new(bvh: Arc<MorphBvh>, tolerance: f64) -> Self {
        let targets = bvh.model().target_count();
        Self {
            pose: Pose::new(bvh),
            tolerance: tolerance.max(0.0),
            wanted: vec![0.0; targets],
            reduced: Vec::new(),
            by_influence: Vec::new(),
        }
    }

    /// Takes new weights, one per target, of any sign and size; says whether the shape in use changes.
    ///
    /// The shape stays while its displacement is within the tolerance. If it has to change, targets are left out, those
    /// first that move least, until they come to half the tolerance; the other half is left for weights to change.
    ///
    /// Cost: one pass over the weights, and sorting them if the shape changes.
    ///
    /// # Errors
    /// As [`Pose::set_weights`]; the weights before stay.
    pub fn set_weights(&mut self, weights: &[f32]) -> Result<bool, WeightsError> {
        let model = self.pose.bvh().model().clone();
        weights::check(&model, weights)?;
        self.wanted.copy_from_slice(weights);
        if self.displacement() <= self.tolerance {
            return Ok(false);
        }
        let influence = |(target, weight): (usize, &f32)| {
            let moves = f64::from(weight.abs()) * f64::from(model.target_reach()[target]);
            (*weight != 0.0).then_some((moves, target))
        };
        self.by_influence.clear();
        self.by_influence
            .extend(weights.iter().enumerate().filter_map(influence));
        self.by_influence.sort_by(|x, y| x.0.total_cmp(&y.0));
        let Self {
            reduced, by_influence, ..
        } = self;
        let mut leave_out = |count: usize| {
            reduced.clear();
            reduced.extend_from_slice(weights);
            by_influence[..count]
                .iter()
                .for_each(|&(_, target)| reduced[target] = 0.0);
            weights::displacement(&model, reduced, weights)
        };
        let (mut fits, mut too_many) = (0, by_influence.len() + 1);
        while fits + 1 < too_many {
            let count = fits.midpoint(too_many);
            if leave_out(count) <= 0.5 * self.tolerance {
                fits = count;
            } else {
                too_many = count;
            }
        }
        leave_out(fits);
        self.pose.set_weights(&self.reduced)
    }

    /// Asks anything of the shape in use.
    ///
    /// For a question about two such poses, ask one inside the other; each answer has the displacement of its own pose.
    pub fn ask<T>(&mut self, question: impl FnOnce(&mut Pose) -> T) -> Approximate<T> {
        let displacement = self.displacement();
        let answer = question(&mut self.pose);
        Approximate {
            answer,
            displacement: displacement.max(self.displacement()),
        }
    }

    /// What no vertex of the shape in use is farther off than, in model units.
    #[must_use]
    pub fn displacement(&self) -> f64 {
        self.pose.displacement_from(&self.wanted)
    }

    /// The weights that were set.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.wanted
    }

    /// The weights of the shape in use.
    #[must_use]
    pub fn weights_in_use(&self) -> &[f32] {
        self.pose.weights()
    }
}
