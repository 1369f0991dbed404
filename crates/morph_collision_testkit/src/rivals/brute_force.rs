//! The oracle as a method: no tree, and a triangle test in integers that shares nothing with the others.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use morph_collision::{Aabb, QueryStats, TrianglePair};

use super::blended::{BlendedBody, WeldedMesh};
use super::cast::cast_at_all;
use super::{CastHit, CastRay, Method, PoseError, Wanted, push};
use crate::oracle::visit_intersecting_pairs;

/// Bodies with all their vertices in world space.
#[derive(Debug)]
pub(super) struct BruteForce {
    bodies: Vec<WorldBody>,
    work: QueryStats,
}

#[derive(Debug)]
struct WorldBody {
    body: BlendedBody,
    posed: Vec<Vec3>,
    world: Vec<DVec3>,
}

impl BruteForce {
    pub(super) fn new(meshes: &[Arc<WeldedMesh>], bodies: &[usize]) -> Self {
        let placed = |&mesh: &usize| WorldBody {
            body: BlendedBody::new(Arc::clone(&meshes[mesh])),
            posed: meshes[mesh].base.clone(),
            world: meshes[mesh].base.iter().map(|p| p.as_dvec3()).collect(),
        };
        Self {
            bodies: bodies.iter().map(placed).collect(),
            work: QueryStats::default(),
        }
    }
}

impl Method for BruteForce {
    fn set_joints(&mut self, body: usize, world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        self.bodies[body].body.set_joints(world_from_mesh)
    }

    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let WorldBody { body, posed, world } = &mut self.bodies[body];
        if body.set(weights, world_from_model)? {
            body.blend(posed);
            self.work.vertices_blended += posed.len() as u64;
        }
        world.clear();
        world.extend(body.world_vertices(posed));
        Ok(false)
    }

    fn refit(&mut self, _: usize) {}

    fn is_lazy(&self) -> bool {
        false
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let outward = |vertex: &DVec3| {
            let nearest = vertex.as_vec3();
            [nearest.map(f32::next_down), nearest.map(f32::next_up)]
        };
        Aabb::from_points(self.bodies[body].world.iter().flat_map(outward))
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let (a, b) = (&self.bodies[a], &self.bodies[b]);
        let (of_a, of_b) = (&a.body.mesh.triangles, &b.body.mesh.triangles);
        self.work.triangle_tests += of_a.len() as u64 * of_b.len() as u64;
        let start = pairs.len();
        let keep = |triangle_a, triangle_b| push(wanted, pairs, start, TrianglePair { triangle_a, triangle_b });
        visit_intersecting_pairs(&a.world, of_a, &b.world, of_b, keep);
    }

    fn cast(&mut self, body: usize, ray: &CastRay) -> Option<CastHit> {
        let WorldBody { body, posed, .. } = &self.bodies[body];
        self.work.triangle_tests += body.mesh.triangles.len() as u64;
        cast_at_all(body, posed, ray)
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
