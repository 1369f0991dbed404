//! Which leaves share vertices, and which of their triangles do. The shape of the mesh does not matter, only its connectivity.

use super::{Leaf, Topology};
use crate::bounds::LANES;
use crate::model::MorphModel;

/// Vertices in more leaves than this are left out, so that memory stays linear in the number of triangles: at most this many pairs for
/// each leaf of a vertex. Vertices of real meshes are in a handful of leaves.
const MAX_LEAVES: usize = 32;

/// Two patches of leaves that share a vertex, or of the same leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatchPair {
    /// In ascending order.
    pub(crate) leaves: [u32; 2],
    /// The index of each patch in its leaf.
    pub(crate) patches: [u8; 2],
    /// Which triangles share no vertex: bit `8 i + j` is that of triangle `i` of the first patch and triangle `j` of the second. Of two
    /// triangles of the same patch, `i` is the smaller one.
    pub(crate) unrelated: u64,
}

impl PatchPair {
    #[inline(always)]
    pub(crate) fn leaves(&self) -> [Leaf; 2] {
        self.leaves.map(|leaf| Leaf(leaf as usize))
    }

    /// The triangles of the first patch of which a mask has any pair.
    #[inline(always)]
    pub(crate) fn rows(mask: u64) -> u8 {
        const FIRSTS: u64 = 0x0101_0101_0101_0101;
        let mut any = mask | mask >> 4;
        any |= any >> 2;
        any |= any >> 1;
        // Collects the lowest bit of each byte.
        ((any & FIRSTS).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
    }

    /// The triangles of the second patch that share no vertex with a triangle of the first, as a bit mask.
    #[inline(always)]
    pub(crate) fn unrelated_to(mask: u64, lane: usize) -> u8 {
        (mask >> (LANES * (lane % LANES))) as u8
    }
}

/// The pairs of leaves that share a vertex, ascending, and each leaf with itself. Also returns whether all of them are listed.
pub(super) fn adjacent_leaves(topology: &Topology, vertex_count: usize) -> (Vec<[u32; 2]>, bool) {
    let mut of_vertices: Vec<(u32, u32)> = Vec::with_capacity(2 * vertex_count);
    let leaves = 0..topology.leaf_count() as u32;
    for leaf in leaves.clone() {
        let vertices = topology.leaf_vertices(Leaf(leaf as usize)).iter();
        of_vertices.extend(vertices.map(|&vertex| (vertex, leaf)));
    }
    of_vertices.sort_unstable();
    let (mut pairs, mut is_complete): (Vec<_>, _) = (leaves.map(|leaf| [leaf; 2]).collect(), true);
    for of_vertex in of_vertices.chunk_by(|a, b| a.0 == b.0) {
        if of_vertex.len() > MAX_LEAVES {
            is_complete = false;
            continue;
        }
        for (i, &(_, a)) in of_vertex.iter().enumerate() {
            pairs.extend(of_vertex[i + 1..].iter().map(|&(_, b)| [a, b]));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    (pairs, is_complete)
}

/// The pairs of patches of adjacent leaves, in the order of the leaves.
pub(super) fn adjacent_patches(model: &MorphModel, topology: &Topology, leaves: &[[u32; 2]]) -> Vec<PatchPair> {
    let mut pairs = Vec::with_capacity(leaves.len());
    for &[a, b] in leaves {
        let triangles = [a, b].map(|leaf| topology.leaf_triangles(Leaf(leaf as usize)));
        for (i, of_a) in triangles[0].chunks(LANES).enumerate() {
            for (j, of_b) in triangles[1].chunks(LANES).enumerate() {
                if a < b || i <= j {
                    pairs.push(PatchPair {
                        leaves: [a, b],
                        patches: [i as u8, j as u8],
                        unrelated: unrelated(model, of_a, of_b, a == b && i == j),
                    });
                }
            }
        }
    }
    pairs
}

/// Which triangles share no vertex, as [`PatchPair::unrelated`]. `is_same` says that both lists are the same.
pub(crate) fn unrelated(model: &MorphModel, of_a: &[u32], of_b: &[u32], is_same: bool) -> u64 {
    let mut mask = 0;
    for (i, &a) in of_a.iter().enumerate() {
        let [x, y, z] = model.corners(a);
        for (j, &b) in of_b.iter().enumerate().skip(if is_same { i + 1 } else { 0 }) {
            let others = model.corners(b);
            if !(others.contains(&x) || others.contains(&y) || others.contains(&z)) {
                mask |= 1 << (LANES * i + j);
            }
        }
    }
    mask
}
