//! Methods that look at the whole posed shape and blend every vertex.

use glam::{DVec3, Vec3};

use super::Pose;
use crate::bounds::{Aabb, Extent, WorldFromModel};

impl Pose {
    /// Returns the smallest `f32` box in world space around the posed triangles as [`WorldFromModel::transform_point`] places them.
    ///
    /// It is infinite if a coordinate exceeds the range of `f32`. Cost: every vertex is posed unless it is cached;
    /// [`Pose::world_bounds`] is far cheaper.
    pub fn tight_world_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        let mut extent = Extent::EMPTY;
        let mut posed = self.posed_at(world_from_model);
        for triangle in 0..posed.model.triangle_count() as u32 {
            extent = extent.union(Extent::of_triangle(&posed.world_triangle(triangle)));
        }
        extent.outward()
    }

    /// Replaces the contents of `positions` with the posed positions of all source vertices, in model space.
    ///
    /// [`WorldFromModel::transform_point`] takes them to world space. Cost: the same as [`Pose::tight_world_bounds`].
    pub fn source_positions(&mut self, positions: &mut Vec<Vec3>) {
        let bvh = self.bvh().clone();
        let mut posed = self.posed();
        positions.clear();
        let sources = bvh.model().welded_from_source().iter();
        positions.extend(sources.map(|&welded| posed.model_vertex(welded)));
    }

    /// Replaces the contents of `normals` with the unit normals of all source vertices, in model space.
    ///
    /// A normal is the mean of the normals of the vertex's triangles, weighted by area. It is zero if the weighted normals cancel, or
    /// if none of the triangles has an area. Welded vertices share their normal, so there are no seams.
    /// [`WorldFromModel::transform_normal`] takes a normal to world space. Cost: every vertex is posed, plus one pass over the
    /// triangles.
    pub fn source_normals(&mut self, normals: &mut Vec<Vec3>) {
        let bvh = self.bvh().clone();
        let model = bvh.model();
        let mut sums = vec![DVec3::ZERO; model.vertex_count()];
        let mut posed = self.posed();
        for triangle in 0..model.triangle_count() as u32 {
            let [a, b, c] = posed.world_triangle(triangle);
            // The normal with twice the area as its length.
            let normal = (b - a).cross(c - a);
            for vertex in model.corners(triangle) {
                sums[vertex as usize] += normal;
            }
        }
        let unit = |welded: &u32| sums[*welded as usize].normalize_or_zero().as_vec3();
        normals.clear();
        normals.extend(model.welded_from_source().iter().map(unit));
    }
}
