//! A mesh all of whose vertices are blended, and brute force over it.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use morph_collision::{QueryStats, Triangle, TrianglePair, triangles_intersect};

use super::super::PoseError;
use super::super::blended::{BlendedBody, WeldedMesh};
use super::super::bottom_up::box_around;
use super::super::boxes::Box3;
use super::SelfMethod;

/// A mesh all of whose vertices are blended.
#[derive(Debug)]
pub(super) struct Posed {
    pub(super) body: BlendedBody,
    pub(super) vertices: Vec<Vec3>,
    /// Of all triangles.
    boxes: Vec<Box3>,
}

impl Posed {
    pub(super) fn new(mesh: &Arc<WeldedMesh>) -> Self {
        let mut posed = Self {
            vertices: mesh.base.clone(),
            body: BlendedBody::new(Arc::clone(mesh)),
            boxes: Vec::new(),
        };
        posed.box_triangles();
        posed
    }

    fn box_triangles(&mut self) {
        let triangles = self.body.mesh.triangles.iter();
        self.boxes.clear();
        self.boxes
            .extend(triangles.map(|corners| box_around(corners, &self.vertices)));
    }

    /// Returns whether the weights are new.
    pub(super) fn set(&mut self, weights: &[f32], work: &mut QueryStats) -> Result<bool, PoseError> {
        let is_new = self.body.set(weights, &Affine3A::IDENTITY)?;
        if is_new {
            self.body.blend(&mut self.vertices);
            self.box_triangles();
            work.vertices_blended += self.vertices.len() as u64;
        }
        Ok(is_new)
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        self.body.mesh.triangles[triangle as usize]
    }

    fn triangle(&self, triangle: u32) -> Triangle {
        self.corners(triangle)
            .map(|corner| self.vertices[corner as usize].as_dvec3())
    }

    /// Compares two triangles.
    #[inline]
    pub(super) fn test(&self, a: u32, b: u32, work: &mut QueryStats, pairs: &mut Vec<TrianglePair>) {
        if self.boxes[a as usize].overlaps(&self.boxes[b as usize]) {
            self.test_near(a, b, work, pairs);
        }
    }

    /// Compares two triangles whose boxes overlap.
    fn test_near(&self, a: u32, b: u32, work: &mut QueryStats, pairs: &mut Vec<TrianglePair>) {
        let (of_a, of_b) = (self.corners(a), self.corners(b));
        if of_a.iter().any(|corner| of_b.contains(corner)) {
            return;
        }
        work.triangle_tests += 1;
        if triangles_intersect(&self.triangle(a), &self.triangle(b)) {
            let (triangle_a, triangle_b) = (a.min(b), a.max(b));
            pairs.push(TrianglePair { triangle_a, triangle_b });
        }
    }
}

#[derive(Debug)]
pub(super) struct AllPairs {
    body: Posed,
    work: QueryStats,
}

impl AllPairs {
    pub(super) fn new(mesh: &Arc<WeldedMesh>) -> Self {
        Self {
            body: Posed::new(mesh),
            work: QueryStats::default(),
        }
    }
}

impl SelfMethod for AllPairs {
    fn find(&mut self, weights: &[f32], pairs: &mut Vec<TrianglePair>) -> Result<(), PoseError> {
        self.body.set(weights, &mut self.work)?;
        let (body, boxes) = (&self.body, &self.body.boxes);
        for (i, one) in boxes.iter().enumerate() {
            for (j, other) in boxes.iter().enumerate().skip(i + 1) {
                if one.overlaps(other) {
                    body.test_near(i as u32, j as u32, &mut self.work, pairs);
                }
            }
        }
        let count = boxes.len() as u64;
        self.work.node_tests += count * count.saturating_sub(1) / 2;
        Ok(())
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
