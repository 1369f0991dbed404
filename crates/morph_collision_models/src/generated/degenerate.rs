//! Seeded meshes of the kinds that break geometry code: without area, without thickness, without distinct vertices.
//!
//! Coordinates lie on coarse binary grids, so that "collinear" and "coplanar" hold exactly, not just approximately.

use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{grid, random};
use crate::mesh::MorphMesh;

/// `count` long triangles, a millionth as wide as they are long. The only target slides them along random
/// directions.
pub fn slivers(seed: u64, count: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let (a, b) = (random::point(&mut rng, 1.0), random::point(&mut rng, 1.0));
        let apex = a.lerp(b, rng.random_range(0.0..=1.0)) + random::point(&mut rng, 1.0) * 1e-6 * a.distance(b);
        positions.extend([a, b, apex].map(DVec3::as_vec3));
    }
    let slides = per_triangle(&mut rng, count, |rng| grid::snap(random::point(rng, 0.5)));
    with_target("slivers", positions, random::separate(count), slides)
}

/// `count` triangles with exactly zero area: points, segments with a double end, and three distinct collinear
/// corners.
///
/// The only target translates each triangle as a whole, so that none gains area.
pub fn zero_area(seed: u64, count: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut positions = Vec::new();
    for index in 0..count {
        let a = lattice_point(&mut rng);
        let step = lattice_point(&mut rng);
        positions.extend(match index % 3 {
            0 => [a, a, a],
            1 => [a, a + step, a],
            _ => [a, a + step * 2.0, a + step],
        });
    }
    let shifts = per_triangle(&mut rng, count, lattice_point);
    with_target("zero_area", positions, random::separate(count), shifts)
}

/// `sheets` overlapping grids of 18 triangles each, all in the plane `z = 0`, with common edges and corners. The
/// only target moves each within the plane.
pub fn coplanar_sheets(seed: u64, sheets: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let in_plane = |rng: &mut Pcg64Mcg| lattice_point(rng) * Vec3::new(1.0, 1.0, 0.0);
    let (mut positions, mut shifts, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    let sheet = super::rigid::grid(0.75, 3);
    for _ in 0..sheets {
        let first = positions.len() as u32;
        let (place, shift) = (in_plane(&mut rng), in_plane(&mut rng));
        positions.extend(sheet.positions.iter().map(|p| Vec3::new(p.x, p.z, 0.0) + place));
        shifts.extend(sheet.positions.iter().map(|_| shift));
        triangles.extend(sheet.triangles.iter().map(|triangle| triangle.map(|v| first + v)));
    }
    with_target("coplanar_sheets", positions, triangles, shifts)
}

/// `mesh` with separate vertices for every triangle, as in files where every edge is a seam.
pub fn duplicated_vertices(mesh: &MorphMesh) -> MorphMesh {
    let corners =
        |values: &[Vec3]| -> Vec<Vec3> { mesh.triangles.iter().flatten().map(|&v| values[v as usize]).collect() };
    let skin = mesh
        .skin
        .as_ref()
        .map(|skin| skin.renumbered(mesh.triangles.iter().flatten()));
    MorphMesh {
        name: format!("{}_duplicated", mesh.name),
        positions: corners(&mesh.positions),
        triangles: random::separate(mesh.triangles.len()),
        targets: mesh.targets.iter().map(|target| corners(target)).collect(),
        skin,
        ..mesh.clone()
    }
}

/// `count` triangles whose corners are all the same point. The only target moves that point.
pub fn all_equal(count: usize) -> MorphMesh {
    let place = Vec3::new(0.25, -0.5, 0.125);
    with_target(
        "all_equal",
        vec![place; count * 3],
        random::separate(count),
        vec![Vec3::X; count * 3],
    )
}

/// A point with coordinates that are multiples of 1/8 between -1 and 1, where coincidences are common.
fn lattice_point(rng: &mut Pcg64Mcg) -> Vec3 {
    let [x, y, z] = std::array::from_fn(|_| f64::from(rng.random_range(-8..=8_i32)) / 8.0);
    DVec3::new(x, y, z).as_vec3()
}

/// One displacement per triangle, the same for its three corners.
fn per_triangle(rng: &mut Pcg64Mcg, count: usize, mut draw: impl FnMut(&mut Pcg64Mcg) -> Vec3) -> Vec<Vec3> {
    (0..count).flat_map(|_| [draw(rng); 3]).collect()
}

fn with_target(name: &str, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, displacements: Vec<Vec3>) -> MorphMesh {
    let mut mesh = MorphMesh::rigid(name, positions, triangles);
    mesh.targets.push(displacements);
    mesh.target_names.push("shift".into());
    mesh
}
