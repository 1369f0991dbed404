//! Shapes without targets.

use glam::Vec3;

use crate::mesh::MorphMesh;

/// A box around the origin with the given half sizes: 8 vertices, 12 outward triangles.
pub fn box_mesh(half: Vec3) -> MorphMesh {
    let corner = |i: u32| {
        let sign = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
        half * Vec3::new(sign(1), sign(2), sign(4))
    };
    // Each face as a quad, counter-clockwise seen from outside.
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    MorphMesh::rigid("box", (0..8).map(corner).collect(), triangles)
}

/// A square sheet in the plane `y = 0`, centred, facing `+Y`: `cells * cells * 2` triangles with sides of `size / cells`.
pub fn grid(size: f32, cells: u32) -> MorphMesh {
    let cells = cells.max(1);
    let along = |i: u32| (i as f32 / cells as f32 - 0.5) * size;
    let rows = 0..=cells;
    let positions = rows
        .flat_map(|z| (0..=cells).map(move |x| Vec3::new(along(x), 0.0, along(z))))
        .collect();
    let mut triangles = Vec::with_capacity((cells * cells * 2) as usize);
    for z in 0..cells {
        for x in 0..cells {
            let a = z * (cells + 1) + x;
            let (b, c) = (a + 1, a + cells + 1);
            triangles.extend([[a, c, b], [b, c, c + 1]]);
        }
    }
    MorphMesh::rigid("grid", positions, triangles)
}
