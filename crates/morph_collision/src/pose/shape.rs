//! The posed shape as a whole, blended vertex by vertex on request: what queries are there to avoid.

use glam::{DVec3, Vec3};
use thiserror::Error;

use super::Pose;
use super::posed::Posed;
use crate::bounds::{Aabb, WorldFromModel, down, up};

/// A vertex that the mesh does not have was asked for.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("entry {entry} names vertex {vertex}, the mesh has {vertices} vertices")]
pub struct NoSuchVertex {
    /// Where in the list it was named.
    pub entry: usize,
    /// The vertex.
    pub vertex: usize,
    /// How many the mesh has.
    pub vertices: usize,
}

impl Pose {
    /// The smallest model-space box around the posed triangles.
    ///
    /// Cost: every vertex is blended, unless it already was for these weights; [`Pose::bounds`] costs next to nothing.
    pub fn tight_bounds(&mut self) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        self.for_each_corner(|corner| {
            bounds.min = bounds.min.min(corner);
            bounds.max = bounds.max.max(corner);
        });
        bounds
    }

    /// The smallest `f32` box in world space around the posed triangles as [`WorldFromModel::transform_point`] places them.
    ///
    /// Where a coordinate is beyond `f32`, so is the box's. Cost as [`Pose::tight_bounds`].
    pub fn tight_world_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.for_each_corner(|corner| {
            let placed = world_from_model.transform_point(corner);
            min = min.min(placed);
            max = max.max(placed);
        });
        Aabb {
            min: Vec3::from_array(min.to_array().map(down)),
            max: Vec3::from_array(max.to_array().map(up)),
        }
    }

    /// Replaces `positions` by those of all vertices of the mesh as it was given, posed, in model space.
    ///
    /// In world space they are what [`WorldFromModel::transform_point`] makes of them. Cost as [`Pose::tight_bounds`].
    pub fn source_positions(&mut self, positions: &mut Vec<Vec3>) {
        positions.clear();
        let bvh = self.bvh().clone();
        let mut posed = self.posed();
        positions.extend(
            bvh.model()
                .welded_from_source()
                .iter()
                .map(|welded| posed.vertex(*welded)),
        );
    }

    /// Replaces `normals` by those of all vertices of the mesh as it was given, posed, in model space: unit vectors.
    ///
    /// A vertex has the mean of its triangles' normals by area, across seams: vertices that are welded share theirs. It is
    /// zero where the areas cancel or there are none. [`WorldFromModel::transform_normal`] takes it to world space.
    /// Cost: every vertex is blended, and one pass over the triangles.
    pub fn source_normals(&mut self, normals: &mut Vec<Vec3>) {
        let bvh = self.bvh().clone();
        let model = bvh.model();
        let mut sums = vec![DVec3::ZERO; model.vertex_count()];
        let mut posed = self.posed();
        for triangle in 0..model.triangle_count() {
            let normal = area_normal(&mut posed, triangle as u32);
            for vertex in model.triangle(triangle) {
                sums[vertex as usize] += normal;
            }
        }
        normals.clear();
        normals.extend(
            model
                .welded_from_source()
                .iter()
                .map(|welded| unit(sums[*welded as usize])),
        );
    }

    /// The posed positions of some vertices of the mesh as it was given, in model space; only these are blended.
    ///
    /// # Errors
    /// [`NoSuchVertex`] names the first entry that is out of range; then nothing is blended.
    pub fn source_positions_of(&mut self, vertices: &[usize]) -> Result<Vec<Vec3>, NoSuchVertex> {
        let welded = self.welded(vertices)?;
        let mut posed = self.posed();
        Ok(welded.iter().map(|vertex| posed.vertex(*vertex)).collect())
    }

    /// The normals of some vertices, as [`Pose::source_normals`] has them; only the triangles around these are blended.
    ///
    /// Cost: one pass over the triangles' indices.
    ///
    /// # Errors
    /// [`NoSuchVertex`] names the first entry that is out of range; then nothing is blended.
    pub fn source_normals_of(&mut self, vertices: &[usize]) -> Result<Vec<Vec3>, NoSuchVertex> {
        let welded = self.welded(vertices)?;
        let bvh = self.bvh().clone();
        let model = bvh.model();
        let mut wanted = welded.clone();
        wanted.sort_unstable();
        wanted.dedup();
        let mut sums = vec![DVec3::ZERO; wanted.len()];
        let mut posed = self.posed();
        for triangle in 0..model.triangle_count() {
            let places = model
                .triangle(triangle)
                .map(|vertex| wanted.binary_search(&vertex).ok());
            if places == [None; 3] {
                continue;
            }
            let normal = area_normal(&mut posed, triangle as u32);
            for place in places.into_iter().flatten() {
                sums[place] += normal;
            }
        }
        let normal_of = |vertex: &u32| {
            wanted
                .binary_search(vertex)
                .map_or(Vec3::ZERO, |place| unit(sums[place]))
        };
        Ok(welded.iter().map(normal_of).collect())
    }

    fn welded(&self, vertices: &[usize]) -> Result<Vec<u32>, NoSuchVertex> {
        let welded_from_source = self.bvh().model().welded_from_source();
        let find = |(entry, &vertex): (usize, &usize)| {
            welded_from_source.get(vertex).copied().ok_or(NoSuchVertex {
                entry,
                vertex,
                vertices: welded_from_source.len(),
            })
        };
        vertices.iter().enumerate().map(find).collect()
    }

    fn for_each_corner(&mut self, mut visit: impl FnMut(Vec3)) {
        let triangles = self.bvh().model().triangle_count() as u32;
        let mut posed = self.posed();
        for triangle in 0..triangles {
            posed.corners(triangle).into_iter().for_each(&mut visit);
        }
    }
}

/// Twice a posed triangle's area along its normal, in model space.
fn area_normal(posed: &mut Posed<'_>, triangle: u32) -> DVec3 {
    let [a, b, c] = posed.corners(triangle).map(Vec3::as_dvec3);
    (b - a).cross(c - a)
}

fn unit(sum: DVec3) -> Vec3 {
    sum.normalize_or_zero().as_vec3()
}
