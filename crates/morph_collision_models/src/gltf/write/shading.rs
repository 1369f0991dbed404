//! Computes what a renderer needs and a collision mesh does not have: normals and texture coordinates.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

/// Unit normals per vertex, averaged by area over all triangles that share its position, so that seams are invisible.
///
/// A vertex without area gets `+Y`. Sums are in `f64` in triangle order, so that the bits are the same everywhere.
pub(super) fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    // Adding zero makes -0 and +0 the same position.
    let key = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut sums: HashMap<[u32; 3], DVec3> = HashMap::new();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize].as_dvec3());
        let normal = (b - a).cross(c - a);
        for &v in triangle {
            *sums.entry(key(positions[v as usize])).or_default() += normal;
        }
    }
    let unit = |p: &Vec3| {
        sums.get(&key(*p))
            .map_or(DVec3::Y, |sum| sum.normalize_or(DVec3::Y))
            .as_vec3()
    };
    positions.iter().map(unit).collect()
}

/// Projects a side view onto the `xy` plane, scaled to the unit square; `v` points down.
pub(super) fn planar_uv(positions: &[Vec3]) -> Vec<[f32; 2]> {
    let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let size = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
    positions
        .iter()
        .map(|&p| (p - low) / size)
        .map(|t| [t.x, 1.0 - t.y])
        .collect()
}
