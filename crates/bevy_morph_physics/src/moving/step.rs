//! What other code asks about a surface during a step.

use bevy::math::DVec3;
use morph_collision::{Aabb, Body, Pose, ShapeQuery, WorldFromModel};
use parry3d::bounding_volume::Aabb as ParryAabb;

use super::moment::{Moment, Moments, displacement, posed_vertices};
use super::surface::MovingSurface;
use crate::math::region;

impl MovingSurface {
    /// Whether the coming step uses values between frames.
    pub fn looks_between_frames(&self) -> bool {
        self.span.is_some() && self.drawn.is_interpolated()
    }

    /// Queries the surface at the start of the coming step, with its transform: in world space, or for a skinned mesh that of its
    /// collider.
    pub fn at_start<T>(&mut self, query: impl FnOnce(&mut Pose, &WorldFromModel) -> T) -> T {
        let Moments { end, start, .. } = &mut self.moments;
        if self.moves {
            query(start.pose.get(), &start.world_from_model)
        } else {
            query(self.surface.lock().pose.get(), end)
        }
    }

    /// The maximum distance that any vertex moves during the coming step, in world units.
    ///
    /// Computed when it is first asked for: nobody asks while nothing is near.
    pub fn displacement(&mut self) -> f64 {
        let Self {
            displacement: known,
            moments: Moments { end, start, .. },
            ..
        } = self;
        *known.get_or_insert_with(|| {
            let displacement = displacement(start, self.surface.lock().pose.get(), end);
            self.travelled += displacement;
            displacement
        })
    }

    /// The maximum distance that any vertex has travelled up to the end of the coming step. Only differences mean something, and only while
    /// somebody asks in every step.
    pub fn travelled(&mut self) -> f64 {
        self.displacement();
        self.travelled
    }

    /// The same before the coming step.
    pub fn travelled_before(&mut self) -> f64 {
        self.travelled() - if self.moves { self.displacement() } else { 0.0 }
    }

    /// A box around the surface during the coming step.
    pub fn bounds(&mut self) -> Aabb {
        let now = self.surface.lock().pose.world_bounds(&self.moments.end);
        if !self.moves {
            return now;
        }
        let Moment { pose, world_from_model } = &mut self.moments.start;
        now.union(&pose.world_bounds(world_from_model))
    }

    /// Appends the triangles that intersect a world-space box at the end of the coming step.
    pub fn triangles_in(&mut self, bounds: &ParryAabb, query: &mut ShapeQuery, into: &mut Vec<u32>) {
        let mut posed = self.surface.lock();
        let (pose, end) = (posed.pose.get(), &self.moments.end);
        if let Ok(region) = region(bounds, pose, end) {
            query.all_in_region(Body::new(pose, end), &region, into);
        }
    }

    /// The positions of vertices in world space at the end of the coming step.
    pub fn vertices(&mut self, vertices: &[u32], into: &mut Vec<DVec3>) {
        posed_vertices(self.surface.lock().pose.get(), &self.moments.end, vertices, into);
    }
}
