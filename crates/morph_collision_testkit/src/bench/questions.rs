//! The questions asked in a frame.

use morph_collision::TrianglePair;

use super::Experiment;
use crate::rivals::{BroadPhase, Method, PoseError};
use morph_collision::batch::Wanted;

/// Asks a method the questions of an experiment's frames; keeps the memory that frames reuse.
#[derive(Debug, Default)]
pub struct Questions {
    broad_phase: BroadPhase,
    pairs: Vec<TrianglePair>,
}

/// The findings of a frame. For rays, `pairs` counts those that hit, and `touching` the bodies that were hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// Pairs of triangles.
    pub pairs: u64,
    /// Pairs of bodies with at least one such pair.
    pub touching: u64,
}

impl Questions {
    /// [Prepares](Method::prepare) the bodies' shapes of a frame, outside of all measurements. If anything had to be prepared, the frame is run once, because in a
    /// real scene bodies that never change would have been queried long before.
    ///
    /// # Errors
    /// See [`Method::prepare`] and [`Experiment::set_bodies`].
    pub fn prepare(
        &mut self,
        experiment: &Experiment,
        index: usize,
        method: &mut dyn Method,
        wanted: Wanted,
    ) -> Result<(), PoseError> {
        let mut prepared = false;
        for (body, (weights, _)) in experiment.frames[index].iter().enumerate() {
            prepared |= method.prepare(body, weights, experiment.joints_of(index, body))?;
        }
        if prepared {
            experiment.set_bodies(method, index)?;
            self.answer(experiment, index, method, wanted);
        }
        Ok(())
    }

    /// Broad phase and queries of a frame, or its rays. The bodies' poses must have been set before.
    pub fn answer(&mut self, experiment: &Experiment, index: usize, method: &mut dyn Method, wanted: Wanted) -> Answer {
        let mut found = Answer::default();
        let bodies = experiment.frames[index].len();
        if let Some(rays) = experiment.rays.get(index) {
            for body in 0..bodies {
                let hits = rays.iter().filter(|ray| method.cast(body, ray).is_some()).count() as u64;
                found.pairs += hits;
                found.touching += u64::from(hits > 0);
            }
            return found;
        }
        for &(a, b) in self.broad_phase.pairs(method, bodies) {
            self.pairs.clear();
            method.collide(a as usize, b as usize, wanted, &mut self.pairs);
            found.pairs += self.pairs.len() as u64;
            found.touching += u64::from(!self.pairs.is_empty());
        }
        found
    }
}
