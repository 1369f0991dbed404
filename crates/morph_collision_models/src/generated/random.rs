//! Seeded random meshes: the same arguments always give the same mesh.

use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{grid, icosphere};
use crate::mesh::MorphMesh;

/// A bumpy closed surface of `20 * 4^level` triangles and radius about 1, with random targets.
///
/// `sparsity` in 0..=1 is the share of the sphere that each target does not move. A target moves the vertices in a
/// random cap, as a face's targets do, most in the middle.
pub fn random_blob(seed: u64, level: u32, targets: usize, sparsity: f32) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let (directions, triangles) = icosphere::icosphere(level);
    let roughness = 0.3 / f64::from(1 << level.min(16));
    let waves: [DVec3; 3] = std::array::from_fn(|_| point(&mut rng, 1.0));
    let positions = directions.iter().map(|&n| {
        let wave: f64 = waves.iter().map(|w| w.dot(n) * w.dot(n)).sum();
        grid::snap(n * (0.7 + 0.2 * wave + rng.random_range(-roughness..=roughness)))
    });
    let mut mesh = MorphMesh::rigid(format!("blob_{seed}"), positions.collect(), triangles);

    // A cap of angle a covers (1 - cos a) / 2 of the sphere.
    let rim = 2.0 * f64::from(sparsity.clamp(0.0, 1.0)) - 1.0;
    for target in 0..targets {
        let centre = point(&mut rng, 1.0).normalize_or(DVec3::X);
        let push = point(&mut rng, 0.5);
        let displaced = directions.iter().map(|n| {
            let depth = n.dot(centre) - rim;
            if depth <= 0.0 {
                return Vec3::ZERO;
            }
            let share = depth / (1.0 - rim);
            grid::snap(push * share + point(&mut rng, roughness))
        });
        mesh.targets.push(displaced.collect());
        mesh.target_names.push(format!("target_{target}"));
    }
    mesh
}

/// `count` separate triangles of very different sizes in the cube from -1 to 1. Every target displaces every corner.
pub fn triangle_soup(seed: u64, count: usize, targets: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut positions = Vec::with_capacity(count * 3);
    for _ in 0..count {
        let centre = point(&mut rng, 1.0);
        let size = 0.5_f64.powi(rng.random_range(0..8));
        positions.extend((0..3).map(|_| grid::snap(centre + point(&mut rng, size))));
    }
    let mut mesh = MorphMesh::rigid(format!("soup_{seed}"), positions, separate(count));
    for target in 0..targets {
        mesh.targets
            .push((0..count * 3).map(|_| grid::snap(point(&mut rng, 0.5))).collect());
        mesh.target_names.push(format!("target_{target}"));
    }
    mesh
}

/// `count` triangles that share no vertices.
pub(super) fn separate(count: usize) -> Vec<[u32; 3]> {
    (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()
}

/// A point in the cube from `-half` to `half`.
pub(super) fn point(rng: &mut Pcg64Mcg, half: f64) -> DVec3 {
    let [x, y, z] = std::array::from_fn(|_| rng.random_range(-half..=half));
    DVec3::new(x, y, z)
}
