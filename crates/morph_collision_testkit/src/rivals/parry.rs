//! Parry for the tree, our exact test for the triangles.
//!
//! Parry's boxes are of posed `f32` vertices in the body's own space, exact as ours are; pairs of its nodes are compared
//! by the same SAT-lite as the other methods', so that nothing is missed whatever affine places the body (Parry itself
//! takes rigid motions only, and one body's axes).

use std::cell::Cell;
use std::fmt;
use std::sync::Arc;

use glam::{Affine3A, Vec3, Vec3A};
use morph_collision::{Aabb, QueryStats, Triangle, TrianglePair, triangles_intersect};
use parry3d::bounding_volume;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhNode, BvhWorkspace};
use parry3d::shape::{TriMesh, TriMeshBuilderError};

use super::blended::{BlendedBody, WeldedMesh};
use super::boxes::Box3;
use super::frames::{SatLite, world_bounds};
use super::{Method, PoseError, SetUpError, Wanted};

/// A tree of Parry's with a leaf per triangle, and the vertices it stands for.
pub(super) trait ParryTree: Sized + Send + Sync {
    fn new(mesh: &WeldedMesh) -> Result<Self, TriMeshBuilderError>;
    /// Blends the vertices.
    fn blend(&mut self, body: &mut BlendedBody);
    /// Makes the tree follow them.
    fn refit(&mut self, mesh: &WeldedMesh);
    /// Both, in the best way there is.
    fn update(&mut self, body: &mut BlendedBody) {
        self.blend(body);
        self.refit(&body.mesh);
    }
    fn bvh(&self) -> &Bvh;
    fn posed(&self) -> &[Vec3];
}

/// A mesh of Parry's, and vertices blended for it where blending is timed by itself.
#[derive(Clone)]
pub(super) struct Meshed {
    mesh: TriMesh,
    blended: Vec<Vec3>,
}

/// `update_vertices` is `set_vertices` without a copy.
impl ParryTree for Meshed {
    fn new(mesh: &WeldedMesh) -> Result<Self, TriMeshBuilderError> {
        Ok(Self {
            mesh: TriMesh::new(mesh.base.clone(), mesh.triangles.clone())?,
            blended: mesh.base.clone(),
        })
    }

    fn blend(&mut self, body: &mut BlendedBody) {
        body.blend(&mut self.blended);
    }

    fn refit(&mut self, _: &WeldedMesh) {
        let Self { mesh, blended } = self;
        mesh.update_vertices(|posed| posed.copy_from_slice(blended));
    }

    fn update(&mut self, body: &mut BlendedBody) {
        self.mesh.update_vertices(|posed| body.blend(posed));
    }

    fn bvh(&self) -> &Bvh {
        self.mesh.bvh()
    }

    fn posed(&self) -> &[Vec3] {
        self.mesh.vertices()
    }
}

/// A bare tree.
#[derive(Clone)]
struct Bare {
    bvh: Bvh,
    workspace: BvhWorkspace,
    posed: Vec<Vec3>,
}

impl Bare {
    fn new(mesh: &WeldedMesh) -> Self {
        let boxes: Vec<_> = mesh
            .triangles
            .iter()
            .map(|corners| around(corners, &mesh.base))
            .collect();
        Self {
            bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            workspace: BvhWorkspace::default(),
            posed: mesh.base.clone(),
        }
    }

    fn move_leaves(&mut self, mesh: &WeldedMesh) {
        for (triangle, corners) in (0..).zip(&mesh.triangles) {
            self.bvh
                .insert_or_update_partially(around(corners, &self.posed), triangle, 0.0);
        }
    }
}

#[inline]
fn around(corners: &[u32; 3], posed: &[Vec3]) -> bounding_volume::Aabb {
    let [p, q, r] = corners.map(|vertex| posed[vertex as usize]);
    bounding_volume::Aabb {
        mins: p.min(q).min(r),
        maxs: p.max(q).max(r),
    }
}

/// Refitted, and put in depth-first order in memory again.
#[derive(Clone)]
pub(super) struct Refitted(Bare);

impl ParryTree for Refitted {
    fn new(mesh: &WeldedMesh) -> Result<Self, TriMeshBuilderError> {
        Ok(Self(Bare::new(mesh)))
    }

    fn blend(&mut self, body: &mut BlendedBody) {
        body.blend(&mut self.0.posed);
    }

    fn refit(&mut self, mesh: &WeldedMesh) {
        self.0.move_leaves(mesh);
        self.0.bvh.refit(&mut self.0.workspace);
    }

    fn bvh(&self) -> &Bvh {
        &self.0.bvh
    }

    fn posed(&self) -> &[Vec3] {
        &self.0.posed
    }
}

/// Built anew with Parry's binned builder.
#[derive(Clone)]
pub(super) struct Rebuilt(Bare);

impl ParryTree for Rebuilt {
    fn new(mesh: &WeldedMesh) -> Result<Self, TriMeshBuilderError> {
        Ok(Self(Bare::new(mesh)))
    }

    fn blend(&mut self, body: &mut BlendedBody) {
        body.blend(&mut self.0.posed);
    }

    fn refit(&mut self, mesh: &WeldedMesh) {
        self.0.move_leaves(mesh);
        self.0.bvh.rebuild(&mut self.0.workspace, BvhBuildStrategy::Binned);
    }

    fn bvh(&self) -> &Bvh {
        &self.0.bvh
    }

    fn posed(&self) -> &[Vec3] {
        &self.0.posed
    }
}

/// A [`Method`] of bodies with trees of Parry's.
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
    /// Whatever Parry has against a mesh that passed our door.
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

    fn work(&self) -> QueryStats {
        self.work
    }
}

/// All vertices, and all boxes: Parry's tree is binary, with a triangle per leaf.
fn work_of_update(mesh: &WeldedMesh) -> QueryStats {
    QueryStats {
        vertices_blended: mesh.base.len() as u64,
        nodes_blended: 2 * mesh.triangles.len() as u64 - 1,
        ..QueryStats::default()
    }
}

/// The triangle that was looked at last, in world space: neighbouring pairs of leaves share one.
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
