//! Volumes that share a vertex in the world are never reported as separate, wherever the bodies are.

use glam::{Affine3A, DVec3, Mat3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::super::body::Body;
use super::super::slabs::Slabs;
use super::super::sphere::Sphere;
use super::super::tree::Content;
use super::super::volume::Volume;
use super::{volume, welded};
use morph_collision_models::generated::random;
use morph_collision_models::mesh::MorphMesh;

/// Rotated, sheared, stretched along some axes by up to 2^20 or down to 0, and so far away that vertices may coincide.
fn place(rng: &mut Pcg64Mcg) -> Affine3A {
    let mut power = |range: i32| 2f32.powi(rng.random_range(-range..=range));
    let (size, offset) = (power(40), power(55));
    let mut scales = Vec3::new(power(20), power(3), 1.0) * size;
    let turned = Quat::from_euler(glam::EulerRot::XYZ, power(1), power(2), power(3));
    let shear = Mat3::from_cols(Vec3::X, Vec3::new(power(2), 1.0, 0.0), Vec3::Z);
    if rng.random_range(0..4) == 0 {
        scales.y = 0.0;
    }
    let linear = Mat3::from_quat(turned) * shear * Mat3::from_diagonal(scales);
    Affine3A::from_mat3_translation(linear, Vec3::new(1.0, -0.3, 0.7) * size * offset)
}

/// The same body in another model space, with x and y swapped and everything `2^-power` as large. Its vertices in the world are
/// the same to the last bit.
fn disguised(mesh: &MorphMesh, place: &Affine3A, power: i32) -> (MorphMesh, Affine3A) {
    let (down, up) = (2f32.powi(-power), 2f32.powi(power));
    let swap = |v: &Vec3| Vec3::new(v.y, v.x, v.z) * down;
    let mut other = mesh.clone();
    other.positions = mesh.positions.iter().map(swap).collect();
    for (of_other, target) in other.targets.iter_mut().zip(&mesh.targets) {
        *of_other = target.iter().map(swap).collect();
    }
    let columns = place.matrix3;
    let mut moved = *place;
    moved.matrix3.x_axis = columns.y_axis * up;
    moved.matrix3.y_axis = columns.x_axis * up;
    moved.matrix3.z_axis = columns.z_axis * up;
    (other, moved)
}

/// Lists the nodes above any of these triangles, from the leaves to the root.
fn nodes_over<V: Volume>(body: &Body<V>, node: u32, triangles: &[u32], over: &mut Vec<u32>) {
    let before = over.len();
    let is_over = match body.tree.content(node).clone() {
        Content::Triangle(triangle) => triangles.contains(&triangle),
        Content::Children(children) => {
            for child in children {
                nodes_over(body, child, triangles, over);
            }
            over.len() > before
        }
    };
    if is_over {
        over.push(node);
    }
}

/// How many pairs of nodes share a vertex, and how many of those are reported as separate.
fn judge<V: Volume>() -> (usize, usize) {
    let mut rng = Pcg64Mcg::seed_from_u64(23);
    let (mut shared, mut apart) = (0, 0);
    for seed in 0..150 {
        let mesh = random::random_blob(seed, 1, 3, 0.5);
        let place = place(&mut rng);
        let (other, moved) = disguised(&mesh, &place, rng.random_range(-10..=10));
        let weights: Vec<f32> = (0..3).map(|_| rng.random_range(-1.0..=1.5)).collect();
        let (mesh, other) = (welded(&mesh), welded(&other));
        let (mut a, mut b) = (Body::<V>::new(&mesh, false), Body::<V>::new(&other, false));
        a.set(&weights, &place).unwrap();
        b.set(&weights, &moved).unwrap();
        let work = &mut Default::default();
        let world = |body: &mut Body<V>| {
            (0..80)
                .map(|t| body.world_triangle(t, &mut Default::default()))
                .collect::<Vec<_>>()
        };
        let world_a = world(&mut a);
        assert_eq!(world_a, world(&mut b), "the same in the world");
        let mut points: Vec<DVec3> = world_a.as_flattened().to_vec();
        points.sort_by(|p, q| (p.x, p.y, p.z).partial_cmp(&(q.x, q.y, q.z)).unwrap());
        points.dedup();

        let culling = V::culling(&a.placed(work), &b.placed(work));
        for point in points {
            let around: Vec<u32> = (0..80).filter(|&t| world_a[t as usize].contains(&point)).collect();
            let (mut over_a, mut over_b) = (Vec::new(), Vec::new());
            nodes_over(&a, 0, &around, &mut over_a);
            nodes_over(&b, 0, &around, &mut over_b);
            for &node_a in &over_a {
                for &node_b in &over_b {
                    let (volume_a, volume_b) = (volume(&mut a, node_a), volume(&mut b, node_b));
                    assert!(
                        V::overlap(&culling, &volume_a, &volume_b),
                        "seed {seed}: {volume_a:?} and {volume_b:?} share {point}"
                    );
                    shared += 1;
                }
            }
        }
        for node_a in 0..a.tree.node_count() as u32 {
            for node_b in 0..b.tree.node_count() as u32 {
                let (volume_a, volume_b) = (volume(&mut a, node_a), volume(&mut b, node_b));
                apart += usize::from(!V::overlap(&culling, &volume_a, &volume_b));
            }
        }
    }
    (shared, apart)
}

#[test]
fn volumes_that_share_a_vertex_overlap_wherever_the_bodies_are() {
    for (shared, apart) in [
        judge::<Slabs<3>>(),
        judge::<Slabs<7>>(),
        judge::<Slabs<9>>(),
        judge::<Slabs<13>>(),
        judge::<Sphere>(),
    ] {
        assert!(
            shared > 100_000 && apart > 100_000,
            "{shared} share a vertex, {apart} are told apart"
        );
    }
}
