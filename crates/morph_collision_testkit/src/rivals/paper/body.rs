//! A body: its weights, its placement, and the data that queries have blended for them.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use morph_collision::{QueryStats, Triangle};

use super::references::References;
use super::tree::Tree;
use super::volume::Volume;
use super::weights::Blend;
use crate::rivals::PoseError;
use crate::rivals::blended::{BlendedBody, WeldedMesh};
use crate::rivals::relative::RoundedBody;

/// A body whose volumes and vertices are blended when a query looks at them, once for the same weights (Sect. 5: time
/// stamps).
#[derive(Clone, Debug)]
pub(super) struct Body<V> {
    body: BlendedBody,
    references: Arc<References>,
    pub(super) tree: Arc<Tree<V>>,
    in_betweens: bool,
    blend: Blend,
    /// Counts changes of weights.
    frame: u32,
    volumes: Vec<V>,
    /// The frame in which a volume was blended.
    volume_stamps: Vec<u32>,
    vertices: Vec<Vec3>,
    vertex_stamps: Vec<u32>,
}

impl<V: Volume> Body<V> {
    /// A body at rest at the world's origin.
    pub(super) fn new(mesh: &Arc<WeldedMesh>, in_betweens: bool) -> Self {
        let references = References::new(mesh);
        let tree = Tree::build(&references, in_betweens);
        let mut blend = Blend::default();
        blend.set(&vec![0.0; references.target_count()], &references, in_betweens);
        Self {
            body: BlendedBody::new(Arc::clone(mesh)),
            in_betweens,
            blend,
            frame: 1,
            volumes: vec![V::ZERO; tree.node_count()],
            volume_stamps: vec![0; tree.node_count()],
            vertices: vec![Vec3::ZERO; references.vertex_count()],
            vertex_stamps: vec![0; references.vertex_count()],
            references: Arc::new(references),
            tree: Arc::new(tree),
        }
    }

    /// Sets weights and placement without blending anything.
    pub(super) fn set(&mut self, weights: &[f32], affine: &Affine3A) -> Result<(), PoseError> {
        if self.body.set(weights, affine)? {
            self.blend.set(weights, &self.references, self.in_betweens);
            self.frame = self.frame.wrapping_add(1);
            if self.frame == 0 {
                self.volume_stamps.fill(0);
                self.vertex_stamps.fill(0);
                self.frame = 1;
            }
        }
        Ok(())
    }

    /// Blends a node's volume if that has not happened yet for these weights.
    #[inline]
    pub(super) fn refit(&mut self, node: u32, work: &mut QueryStats) {
        let index = node as usize;
        if self.volume_stamps[index] != self.frame {
            self.volume_stamps[index] = self.frame;
            self.volumes[index] = self.tree.blend(node, &self.blend);
            work.nodes_blended += 1;
        }
    }

    /// The volume of a refitted node.
    #[inline]
    pub(super) fn volume(&self, node: u32) -> &V {
        &self.volumes[node as usize]
    }

    /// A triangle in world space.
    #[inline]
    pub(super) fn world_triangle(&mut self, triangle: u32, work: &mut QueryStats) -> Triangle {
        let [a, b, c] = self.references.triangles[triangle as usize];
        [
            self.world_vertex(a, work),
            self.world_vertex(b, work),
            self.world_vertex(c, work),
        ]
    }

    /// Blends a vertex if that has not happened yet for these weights.
    #[inline]
    fn world_vertex(&mut self, vertex: u32, work: &mut QueryStats) -> DVec3 {
        let index = vertex as usize;
        if self.vertex_stamps[index] != self.frame {
            self.vertex_stamps[index] = self.frame;
            self.vertices[index] = self.references.blend(vertex, self.body.weights());
            work.vertices_blended += 1;
        }
        self.body.world_vertex(self.vertices[index])
    }

    /// The corners of a box around the whole body in model space.
    pub(super) fn aabb(&mut self, work: &mut QueryStats) -> [DVec3; 2] {
        self.refit(0, work);
        self.volume(0).aabb()
    }

    /// Its placement, and how far it reaches.
    pub(super) fn placed(&mut self, work: &mut QueryStats) -> RoundedBody {
        let [least, most] = self.aabb(work);
        RoundedBody::new(&self.body.affine, least.abs().max(most.abs()))
    }

    pub(super) fn affine(&self) -> &Affine3A {
        &self.body.affine
    }

    #[cfg(test)]
    pub(super) fn references(&self) -> &References {
        &self.references
    }
}
