//! The body of the paper's first experiment: a sphere of 20480 triangles with three very different references.

use glam::{DVec3, Vec3};

use super::{grid, icosphere};
use crate::clip::WeightAnimation;
use crate::mesh::MorphMesh;

/// The level of the paper's body. Each of the icosahedron's 20 triangles is split into four at every level: 20480.
const LEVEL: u32 = 5;

/// Seconds from one reference to the next in the clip "morph".
const LEG: f32 = 1.5;

/// A morphing body of 20480 triangles and radius about 1, closed and star-shaped in every reference.
///
/// The base "start" is a smooth blob. The targets are "middle", a star with twelve spikes, and "end", a flattened
/// peanut with its long axis along `y`. The clip "morph" loops through start, middle, end, middle; at most two
/// neighbours are active at a time.
pub fn pass_through_body() -> MorphMesh {
    pass_through_body_at(LEVEL)
}

/// The same body with `20 * 4^level` triangles.
pub fn pass_through_body_at(level: u32) -> MorphMesh {
    let (directions, triangles) = icosphere::icosphere(level);
    let spikes = icosphere::icosahedron_corners();
    let reference =
        |shape: &dyn Fn(DVec3) -> DVec3| directions.iter().map(|&n| grid::snap(shape(n))).collect::<Vec<Vec3>>();
    let references = [reference(&blob), reference(&|n| star(&spikes, n)), reference(&peanut)];

    let name = format!("pass_through_{}", triangles.len());
    let mut mesh = MorphMesh::from_references(name, &references, triangles, &["middle", "end"]);
    mesh.animations.push(WeightAnimation {
        name: "morph".into(),
        times: (0..5_u8).map(|key| f32::from(key) * LEG).collect(),
        weights: vec![
            vec![0.0, 0.0],
            vec![1.0, 0.0],
            vec![0.0, 1.0],
            vec![1.0, 0.0],
            vec![0.0, 0.0],
        ],
        ..WeightAnimation::default()
    });
    mesh
}

/// A sphere with broad, low bumps. Polynomials only.
fn blob(n: DVec3) -> DVec3 {
    let bumps =
        n.x * n.y * n.z * 2.2 + 0.35 * n.x * (n.z * n.z - n.y * n.y) + 0.12 * n.y * (3.0 * n.x * n.x - n.z * n.z);
    n * (0.92 + 0.22 * bumps)
}

/// A small core with a spike towards every corner of the icosahedron.
fn star(spikes: &[DVec3], n: DVec3) -> DVec3 {
    let nearest = spikes.iter().map(|spike| spike.dot(n)).fold(-1.0, f64::max);
    // 0 at the start of the spike, 1 at its tip. Corners of an icosahedron are 63 degrees apart, so spikes do not
    // overlap.
    let rise = ((nearest - 0.86) / 0.14).max(0.0);
    n * (0.55 + 0.62 * rise * rise * rise)
}

/// Two lobes along `y` with a waist, flattened in `z`.
fn peanut(n: DVec3) -> DVec3 {
    let along = n.y * n.y;
    n * (0.42 + 0.72 * along * (1.5 - 0.5 * along)) * DVec3::new(1.0, 1.0, 0.55)
}
