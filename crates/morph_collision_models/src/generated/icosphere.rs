//! Evenly triangulated unit spheres.

use glam::DVec3;

use super::subdivide;

/// The twelve corners of an icosahedron of circumradius 1.
pub(super) fn icosahedron_corners() -> [DVec3; 12] {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z).normalize();
    [
        corner(-1.0, golden, 0.0),
        corner(1.0, golden, 0.0),
        corner(-1.0, -golden, 0.0),
        corner(1.0, -golden, 0.0),
        corner(0.0, -1.0, golden),
        corner(0.0, 1.0, golden),
        corner(0.0, -1.0, -golden),
        corner(0.0, 1.0, -golden),
        corner(golden, 0.0, -1.0),
        corner(golden, 0.0, 1.0),
        corner(-golden, 0.0, -1.0),
        corner(-golden, 0.0, 1.0),
    ]
}

#[rustfmt::skip]
const FACES: [[u32; 3]; 20] = [
    [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
    [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
    [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
    [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
];

/// Unit directions and `20 * 4^level` outward triangles.
pub(super) fn icosphere(level: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut directions = icosahedron_corners().to_vec();
    let mut triangles = FACES.to_vec();
    for _ in 0..level {
        let known = directions.len();
        subdivide::midpoint(std::slice::from_mut(&mut directions), &mut triangles, 1);
        for direction in &mut directions[known..] {
            *direction = direction.normalize();
        }
    }
    (directions, triangles)
}
