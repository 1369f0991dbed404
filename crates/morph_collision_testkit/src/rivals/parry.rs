//! Parry's triangle mesh with updated vertices, with our exact test for the triangles.
//!
//! Parry's boxes enclose posed `f32` vertices in the body's own space, and are exact like ours. Pairs of its nodes are
//! compared by the same SAT-lite as in the other methods, so nothing is missed for any affine placement (Parry itself
//! supports only rigid motions, and the axes of one body).

use std::cell::Cell;
use std::fmt;
use std::sync::Arc;

use glam::{Affine3A, Vec3, Vec3A};
use morph_collision::{Aabb, QueryStats, Triangle, TrianglePair, triangles_intersect};
use parry3d::partitioning::{Bvh, BvhNode};
use parry3d::shape::TriMesh;

use super::blended::{BlendedBody, WeldedMesh};
use super::boxes::Box3;
use super::cast::{cast_at_all, parry_ray};
use super::frames::{SatLite, world_bounds};
use super::{CastHit, CastRay, Method, PoseError, SetUpError, Wanted, push};

/// A [`Method`] over bodies with Parry's triangle meshes.
pub(super) struct Parry {
    bodies: Vec<Body>,
    work: QueryStats,
}

#[derive(Clone)]
struct Body {
    body: BlendedBody,
    mesh: TriMesh,
    /// The vertices, if blending is timed on its own.
    blended: Vec<Vec3>,
}

impl fmt::Debug for Parry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Parry")
            .field("work", &self.work)
            .finish_non_exhaustive()
    }
}

impl Parry {
    /// # Errors
    /// Parry refuses a mesh that passed our validation.
    pub(super) fn new(meshes: &[Arc<WeldedMesh>], bodies: &[usize]) -> Result<Self, SetUpError> {
        let mut at_rest = Vec::with_capacity(meshes.len());
        for (index, mesh) in meshes.iter().enumerate() {
            let of_parry = TriMesh::new(mesh.base.clone(), mesh.triangles.clone());
            at_rest.push(Body {
                body: BlendedBody::new(Arc::clone(mesh)),
                mesh: of_parry.map_err(|reason| SetUpError::Parry {
                    mesh: index,
                    reason: reason.to_string(),
                })?,
                blended: mesh.base.clone(),
            });
        }
        Ok(Self {
            bodies: bodies.iter().map(|&mesh| at_rest[mesh].clone()).collect(),
            work: QueryStats::default(),
        })
    }
}

impl Method for Parry {
    fn set_joints(&mut self, body: usize, world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        self.bodies[body].body.set_joints(world_from_mesh)
    }

    fn set_body(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<(), PoseError> {
        let Body { body, mesh, .. } = &mut self.bodies[body];
        if body.set(weights, world_from_model)? {
            // `set_vertices` without a copy.
            mesh.update_vertices(|posed| body.blend(posed));
            self.work += work_of_update(&body.mesh);
        }
        Ok(())
    }

    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let Body { body, blended, .. } = &mut self.bodies[body];
        let changed = body.set(weights, world_from_model)?;
        if changed {
            body.blend(blended);
        }
        Ok(changed)
    }

    fn refit(&mut self, body: usize) {
        let Body { body, mesh, blended } = &mut self.bodies[body];
        mesh.update_vertices(|posed| posed.copy_from_slice(blended));
        self.work += work_of_update(&body.mesh);
    }

    fn is_lazy(&self) -> bool {
        false
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let Body { body, mesh, .. } = &self.bodies[body];
        world_bounds(&body.affine, &root(mesh.bvh()))
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let (a, b) = (&self.bodies[a], &self.bodies[b]);
        let (root_a, root_b) = (root(a.mesh.bvh()), root(b.mesh.bvh()));
        let culls = SatLite::new(&a.body.affine, &root_a, &b.body.affine, &root_b);
        self.work.node_tests += 1;
        if !culls.overlap(&root_a, &root_b) {
            return;
        }
        let node_tests = Cell::new(0);
        let start = pairs.len();
        let check = |node_a: &BvhNode, node_b: &BvhNode| {
            node_tests.set(node_tests.get() + 1);
            culls.overlap(&of_node(node_a), &of_node(node_b))
        };
        let (mut latest_a, mut latest_b) = (Latest::default(), Latest::default());
        for (triangle_a, triangle_b) in a.mesh.bvh().leaf_pairs(b.mesh.bvh(), check) {
            let corners_a = latest_a.corners(a, triangle_a);
            let corners_b = latest_b.corners(b, triangle_b);
            self.work.triangle_tests += 1;
            if triangles_intersect(corners_a, corners_b) {
                let pair = TrianglePair { triangle_a, triangle_b };
                if push(wanted, pairs, start, pair).is_break() {
                    break;
                }
            }
        }
        self.work.node_tests += node_tests.get();
    }

    fn cast(&mut self, body: usize, ray: &CastRay) -> Option<CastHit> {
        let Body { body, mesh, .. } = &self.bodies[body];
        let Some(in_model) = ray.in_model(&body.affine) else {
            return cast_at_all(body, mesh.vertices(), ray);
        };
        let tests = Cell::new(0);
        let meets = |triangle: u32| {
            tests.set(tests.get() + 1);
            let corners = body.world_triangle(mesh.vertices(), body.mesh.triangles[triangle as usize]);
            ray.meets(&corners, f64::INFINITY)
        };
        let nearest = |triangle: u32, _| meets(triangle).map(|t| t as f32);
        let found = mesh.bvh().cast_ray(&parry_ray(&in_model), f32::MAX, nearest);
        self.work.triangle_tests += tests.get();
        let (triangle, _) = found?;
        meets(triangle).map(|t| CastHit { triangle, t })
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}

/// All vertices and all boxes. Parry's tree is binary, with a triangle per leaf.
fn work_of_update(mesh: &WeldedMesh) -> QueryStats {
    QueryStats {
        vertices_blended: mesh.base.len() as u64,
        nodes_blended: 2 * mesh.triangles.len() as u64 - 1,
        ..QueryStats::default()
    }
}

/// The triangle used last, in world space, because neighbouring pairs of leaves share one.
#[derive(Default)]
struct Latest(Option<(u32, Triangle)>);

impl Latest {
    fn corners(&mut self, of: &Body, triangle: u32) -> &Triangle {
        if self.0.is_some_and(|(latest, _)| latest != triangle) {
            self.0 = None;
        }
        let make = || {
            let corners = of.body.mesh.triangles[triangle as usize];
            (triangle, of.body.world_triangle(of.mesh.vertices(), corners))
        };
        &self.0.get_or_insert_with(make).1
    }
}

fn root(bvh: &Bvh) -> Box3 {
    let bounds = bvh.root_aabb();
    Box3 {
        min: Vec3A::from(bounds.mins),
        max: Vec3A::from(bounds.maxs),
    }
}

#[inline]
fn of_node(node: &BvhNode) -> Box3 {
    Box3 {
        min: Vec3A::from(node.mins()),
        max: Vec3A::from(node.maxs()),
    }
}
