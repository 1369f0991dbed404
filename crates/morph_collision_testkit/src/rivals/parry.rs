//! Parry's trees, with our exact test for the triangles.
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

use super::blended::{BlendedBody, WeldedMesh};
use super::boxes::Box3;
use super::cast::{cast_at_all, parry_ray};
use super::frames::{SatLite, world_bounds};
use super::{CastHit, CastRay, Method, PoseError, SetUpError, Wanted};

mod trees;

use trees::ParryTree;
pub(super) use trees::{Meshed, Refitted};

/// A [`Method`] over bodies with Parry's trees.
pub(super) struct Parry<T> {
    bodies: Vec<(BlendedBody, T)>,
    work: QueryStats,
}

impl<T> fmt::Debug for Parry<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Parry")
            .field("work", &self.work)
            .finish_non_exhaustive()
    }
}

impl<T: ParryTree + Clone> Parry<T> {
    /// # Errors
    /// Parry refuses a mesh that passed our validation.
    pub(super) fn new(meshes: &[Arc<WeldedMesh>], bodies: &[usize]) -> Result<Self, SetUpError> {
        let mut at_rest = Vec::with_capacity(meshes.len());
        for (index, mesh) in meshes.iter().enumerate() {
            let tree = T::new(mesh).map_err(|reason| SetUpError::Parry {
                mesh: index,
                reason: reason.to_string(),
            })?;
            at_rest.push((BlendedBody::new(Arc::clone(mesh)), tree));
        }
        Ok(Self {
            bodies: bodies.iter().map(|&mesh| at_rest[mesh].clone()).collect(),
            work: QueryStats::default(),
        })
    }
}

impl<T: ParryTree> Method for Parry<T> {
    fn set_joints(&mut self, body: usize, world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        self.bodies[body].0.set_joints(world_from_mesh)
    }

    fn set_body(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<(), PoseError> {
        let (body, tree) = &mut self.bodies[body];
        if body.set(weights, world_from_model)? {
            tree.update(body);
            self.work += work_of_update(&body.mesh);
        }
        Ok(())
    }

    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let (body, tree) = &mut self.bodies[body];
        let changed = body.set(weights, world_from_model)?;
        if changed {
            tree.blend(body);
        }
        Ok(changed)
    }

    fn refit(&mut self, body: usize) {
        let (body, tree) = &mut self.bodies[body];
        tree.refit(&body.mesh);
        self.work += work_of_update(&body.mesh);
    }

    fn is_lazy(&self) -> bool {
        false
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let (body, tree) = &self.bodies[body];
        world_bounds(&body.affine, &root(tree.bvh()))
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let ((a, tree_a), (b, tree_b)) = (&self.bodies[a], &self.bodies[b]);
        let (root_a, root_b) = (root(tree_a.bvh()), root(tree_b.bvh()));
        let culls = SatLite::new(&a.affine, &root_a, &b.affine, &root_b);
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
        for (triangle_a, triangle_b) in tree_a.bvh().leaf_pairs(tree_b.bvh(), check) {
            let corners_a = latest_a.corners(a, tree_a.posed(), triangle_a);
            let corners_b = latest_b.corners(b, tree_b.posed(), triangle_b);
            self.work.triangle_tests += 1;
            if triangles_intersect(corners_a, corners_b) {
                let pair = TrianglePair { triangle_a, triangle_b };
                if wanted.push(pairs, start, pair).is_break() {
                    break;
                }
            }
        }
        self.work.node_tests += node_tests.get();
    }

    fn cast(&mut self, body: usize, ray: &CastRay) -> Option<CastHit> {
        let (body, tree) = &self.bodies[body];
        let Some(in_model) = ray.in_model(&body.affine) else {
            return cast_at_all(body, tree.posed(), ray);
        };
        let tests = Cell::new(0);
        let meets = |triangle: u32| {
            tests.set(tests.get() + 1);
            let corners = body.world_triangle(tree.posed(), body.mesh.triangles[triangle as usize]);
            ray.meets(&corners, f64::INFINITY)
        };
        let nearest = |triangle: u32, _| meets(triangle).map(|t| t as f32);
        let found = tree.bvh().cast_ray(&parry_ray(&in_model), f32::MAX, nearest);
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
    fn corners(&mut self, body: &BlendedBody, posed: &[Vec3], triangle: u32) -> &Triangle {
        if self.0.is_some_and(|(latest, _)| latest != triangle) {
            self.0 = None;
        }
        let make = || {
            (
                triangle,
                body.world_triangle(posed, body.mesh.triangles[triangle as usize]),
            )
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
