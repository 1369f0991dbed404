//! The parts near one collider.

use morph_collision::ShapeQuery;
use parry3d::bounding_volume::Aabb;

use super::moved::Moved;
use super::part::Part;
use crate::math::between;
use crate::moving::MovingSurface;

/// The triangles near a collider that may move.
pub(super) struct ColliderParts<B, P> {
    pub(super) body: B,
    /// All triangles in this box are known, for the surface at the time of the search.
    pub(super) region: Aabb,
    pub(super) triangles: Vec<u32>,
    /// How far the surface had travelled by then.
    pub(super) travelled: f64,
    pub(super) parts: Vec<Part<P>>,
    /// Into how many parts the triangles are divided.
    pub(super) cut: usize,
    /// The last step in which the collider was near.
    pub(super) seen: u32,
}

impl<B, P: Default> ColliderParts<B, P> {
    pub(super) fn new(body: B) -> Self {
        Self {
            body,
            region: Aabb::new_invalid(),
            triangles: Vec::new(),
            travelled: 0.0,
            parts: Vec::new(),
            cut: 1,
            seen: 0,
        }
    }

    /// Finds the triangles in a box. Returns whether there are any.
    pub(super) fn search(&mut self, region: Aabb, moving: &mut MovingSurface, query: &mut ShapeQuery) -> bool {
        self.region = region;
        self.travelled = moving.travelled();
        self.triangles.clear();
        moving.triangles_in(&region, query, &mut self.triangles);
        !self.triangles.is_empty()
    }

    /// The motion of some of its triangles; `None` if they jump.
    pub(super) fn sample(&self, moving: &mut MovingSurface) -> Option<Moved> {
        let bvh = moving.bvh().clone();
        let each = self.triangles.len().div_ceil(SAMPLES);
        let triangles = self.triangles.iter().step_by(each);
        let corners = triangles.filter_map(|&triangle| bvh.model().triangle(triangle));
        let vertices: Vec<u32> = corners.flatten().collect();
        let [mut now, mut before, mut velocities] = [const { Vec::new() }; 3];
        moving.vertices(&vertices, &mut now);
        moving.moments.start.vertices(&vertices, &mut before);
        between(&before, &now, moving.motion_time(), &mut velocities);
        let moves = moving.is_motion(&vertices, &before, &velocities);
        moves.then(|| Moved::fitted(&before, &velocities))
    }

    pub(super) fn is_settled(&self) -> bool {
        self.parts.iter().all(Part::is_settled)
    }
}

/// The number of triangles that stand for those near a collider without parts.
const SAMPLES: usize = 4;
