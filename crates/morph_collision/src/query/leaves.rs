//! The triangles of leaves in world space, cached for the duration of a query, because a leaf is compared with several leaves of the
//! other body.

use std::ops::Range;

use glam::{DVec3, Vec3};

use crate::bounds::{LANES, Lanes, WorldFromModel};
use crate::exact::Triangle;
use crate::pose::{EpochCache, LeafPositions, Posed};
use crate::tree::{CornerLanes, Leaf};

/// The triangles, in world space, of the leaves of one body that a query has read. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    /// For each leaf, its range of `placed`.
    blocks: EpochCache<Range<usize>>,
    placed: Vec<(u32, Triangle)>,
    /// Scratch memory of `read`.
    posed: Vec<CornerLanes>,
}

impl Leaves {
    /// Starts a query: clears all leaves.
    pub(super) fn begin(&mut self) {
        self.blocks.next_epoch();
        self.placed.clear();
    }

    /// The block of a leaf. Blends and places its triangles on the first call.
    pub(super) fn read(&mut self, tree: &mut Posed<'_>, leaf: Leaf) -> Range<usize> {
        let slot = self.blocks.find(leaf.0).unwrap_or_else(|| {
            let start = self.placed.len();
            place_leaf(tree, leaf, &mut self.posed, &mut self.placed);
            self.blocks.insert(leaf.0, start..self.placed.len())
        });
        self.blocks.get(slot).clone()
    }

    /// The triangles of a block, each with its index.
    pub(super) fn triangles(&self, block: Range<usize>) -> &[(u32, Triangle)] {
        &self.placed[block]
    }
}

/// Appends a leaf's triangles to `placed`, each with its index and its corners in world space. `posed` is scratch memory.
pub(super) fn place_leaf(
    tree: &mut Posed<'_>,
    leaf: Leaf,
    posed: &mut Vec<CornerLanes>,
    placed: &mut Vec<(u32, Triangle)>,
) {
    let numbers = tree.topology.leaf_triangles(leaf);
    if tree.is_skinned() {
        let mesh = tree.topology.leaf_mesh(leaf);
        let LeafPositions { vertices, world } = tree.leaf_positions(leaf);
        let point = |vertex: u16| {
            let [x, y, z, _] = world[vertices[usize::from(vertex)] as usize];
            DVec3::new(x, y, z)
        };
        let corners = |triangle: &[u16; 3]| triangle.map(point);
        placed.extend(
            numbers
                .iter()
                .zip(mesh.corners)
                .map(|(&number, triangle)| (number, corners(triangle))),
        );
        return;
    }
    posed.clear();
    tree.leaf_corners(leaf, posed);
    for (corners, numbers) in posed.iter().zip(numbers.chunks(LANES)) {
        let triangles = numbers.iter().enumerate();
        placed.extend(triangles.map(|(lane, &number)| (number, placed_triangle(corners, lane, tree.world_from_model))));
    }
}

/// The world-space corners of the triangle in a patch's lane.
#[inline(always)]
pub(super) fn placed_triangle(posed: &CornerLanes, lane: usize, world_from_model: &WorldFromModel) -> Triangle {
    let lane = lane % LANES;
    let corner = |[x, y, z]: &[Lanes; 3]| {
        let posed = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
        world_from_model.transform_point(posed)
    };
    let [a, b, c] = posed;
    [corner(a), corner(b), corner(c)]
}
