//! Checks that a surface bounds a solid: closed, consistently oriented, facing outward.

use std::collections::HashMap;

use glam::Vec3;

/// The first directed edge without exactly one opposite edge; `None` for a closed, consistently oriented surface.
pub fn open_edge(triangles: &[[u32; 3]]) -> Option<(u32, u32)> {
    let mut count: HashMap<(u32, u32), u32> = HashMap::new();
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    for edge in edges() {
        *count.entry(edge).or_default() += 1;
    }
    edges().find(|&(a, b)| count[&(a, b)] != 1 || count.get(&(b, a)) != Some(&1))
}

/// The connected pieces of a surface as lists of triangle indices, in the order of their first triangles.
pub fn components(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<Vec<usize>> {
    let mut parent: Vec<u32> = (0..vertex_count as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    for &[a, b, c] in triangles {
        for other in [b, c] {
            let (a, other) = (root(&mut parent, a), root(&mut parent, other));
            parent[a.max(other) as usize] = a.min(other);
        }
    }
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    let mut piece_of_root = HashMap::new();
    for (index, triangle) in triangles.iter().enumerate() {
        let piece = *piece_of_root.entry(root(&mut parent, triangle[0])).or_insert_with(|| {
            pieces.push(Vec::new());
            pieces.len() - 1
        });
        pieces[piece].push(index);
    }
    pieces
}

/// The volume enclosed by a closed surface: positive if its triangles face outward.
pub fn signed_volume(positions: &[Vec3], triangles: impl IntoIterator<Item = [u32; 3]>) -> f64 {
    let volume = |triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|v| positions[v as usize].as_dvec3());
        a.dot(b.cross(c)) / 6.0
    };
    triangles.into_iter().map(volume).sum()
}
