//! The broad phase that all methods share: world-space boxes, and their overlapping pairs.

use morph_collision::{Aabb, overlapping_pairs};

use super::Method;

/// Memory that broad phases reuse.
#[derive(Debug, Default)]
pub struct BroadPhase {
    bounds: Vec<Option<Aabb>>,
    candidates: Vec<(u32, u32)>,
}

impl BroadPhase {
    /// The pairs of bodies `a < b`, ascending, whose boxes overlap. `bodies` is the number of
    /// bodies.
    pub fn pairs(&mut self, method: &mut dyn Method, bodies: usize) -> &[(u32, u32)] {
        self.bounds.clear();
        self.bounds
            .extend((0..bodies).map(|body| Some(method.world_bounds(body))));
        self.candidates.clear();
        overlapping_pairs(&self.bounds, &mut self.candidates);
        &self.candidates
    }
}
