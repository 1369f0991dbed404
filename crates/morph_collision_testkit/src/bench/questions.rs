//! The questions asked in a frame.

use morph_collision::TrianglePair;

use super::Experiment;
use crate::rivals::{BroadPhase, Method};
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
