//! Parry's trees, and how they are updated for new vertices.

use glam::Vec3;
use parry3d::bounding_volume;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use parry3d::shape::{TriMesh, TriMeshBuilderError};

use crate::rivals::blended::{BlendedBody, WeldedMesh};

/// One of Parry's trees, with a leaf per triangle, and its vertices.
pub(in crate::rivals) trait ParryTree: Sized + Send + Sync {
    fn new(mesh: &WeldedMesh) -> Result<Self, TriMeshBuilderError>;
    /// Blends the vertices.
    fn blend(&mut self, body: &mut BlendedBody);
    /// Updates the tree for the blended vertices.
    fn refit(&mut self, mesh: &WeldedMesh);
    /// Does both in the fastest way.
    fn update(&mut self, body: &mut BlendedBody) {
        self.blend(body);
        self.refit(&body.mesh);
    }
    fn bvh(&self) -> &Bvh;
    fn posed(&self) -> &[Vec3];
}

/// Parry's triangle mesh, with separately blended vertices if blending is timed separately.
#[derive(Clone)]
pub(in crate::rivals) struct Meshed {
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

/// Refitted, and put back into depth-first order in memory.
#[derive(Clone)]
pub(in crate::rivals) struct Refitted(Bare);

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
