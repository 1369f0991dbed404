//! The triangles of leaves in world space, kept for the time of a query: a leaf meets several of the other body's.

use glam::{DVec3, Vec3};

use crate::bounds::WorldFromModel;
use crate::exact::Triangle;
use crate::pose::Posed;
use crate::tree::{Leaf, LeafMesh, Topology};

/// Which leaves of a body a query has read, and as which of its blocks.
#[derive(Debug, Default)]
pub(super) struct LeafStamps {
    /// Per leaf: the query that read it last, and the block it is in that one.
    stamps: Vec<(u32, u32)>,
    query: u32,
}

impl LeafStamps {
    /// Forgets the query before; there are so many leaves.
    pub(super) fn begin(&mut self, leaves: usize) {
        self.query = self.query.wrapping_add(1);
        if self.query == 0 {
            self.stamps.fill((0, 0));
            self.query = 1;
        }
        if self.stamps.len() < leaves {
            self.stamps.resize(leaves, (0, 0));
        }
    }

    /// The block of a leaf that was read.
    #[inline]
    pub(super) fn find(&self, leaf: Leaf) -> Option<usize> {
        let (query, block) = self.stamps[leaf.0];
        (query == self.query).then_some(block as usize)
    }

    pub(super) fn insert(&mut self, leaf: Leaf, block: usize) {
        self.stamps[leaf.0] = (self.query, block as u32);
    }
}

/// The placed vertices of the leaves of one body that a query has read; the memory is reused by the next query.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    stamps: LeafStamps,
    /// Where the vertices of a block are among `points`.
    blocks: Vec<usize>,
    points: Vec<DVec3>,
    /// Of the leaf that is being read.
    posed: Vec<Vec3>,
}

impl Leaves {
    /// Forgets the leaves of the query before.
    pub(super) fn begin(&mut self, leaves: usize) {
        self.stamps.begin(leaves);
        self.blocks.clear();
        self.points.clear();
    }

    /// A leaf's block; its vertices are blended and placed at the first call.
    pub(super) fn read(&mut self, tree: &mut Posed<'_>, world_from_model: &WorldFromModel, leaf: Leaf) -> usize {
        if let Some(block) = self.stamps.find(leaf) {
            return block;
        }
        let block = self.blocks.len();
        self.stamps.insert(leaf, block);
        self.blocks.push(self.points.len());
        self.posed.clear();
        tree.leaf_vertices(leaf, &mut self.posed);
        let points = self.posed.iter().map(|&posed| world_from_model.transform_point(posed));
        self.points.extend(points);
        block
    }

    /// The triangles of a leaf that was read.
    pub(super) fn triangles<'a>(&'a self, topology: &'a Topology, leaf: Leaf, block: usize) -> Triangles<'a> {
        Triangles {
            mesh: topology.leaf_mesh(leaf),
            points: &self.points[self.blocks[block]..],
        }
    }
}

/// The placed triangles of a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangles<'a> {
    mesh: LeafMesh<'a>,
    points: &'a [DVec3],
}

impl Triangles<'_> {
    /// Each with its number.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, Triangle)> {
        let corners = self.mesh.corners.iter();
        let placed = corners.map(|corners| corners.map(|corner| self.points[usize::from(corner)]));
        self.mesh.triangles.iter().copied().zip(placed)
    }
}
