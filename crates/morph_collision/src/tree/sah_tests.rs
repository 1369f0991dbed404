//! Tests of splits by the surface-area heuristic: no child is empty, and leaves are nearly full.

use std::sync::Arc;

use glam::Vec3;
use morph_collision_models::generated::{degenerate, dolphin, random};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::budget::{Budget, run_to_end};
use super::sah::{Base, Partition};
use super::validate_tests::validate;
use super::*;
use crate::bounds::Aabb;
use crate::model::MorphModel;

fn shape(triangles: &[[Vec3; 3]]) -> Base {
    Base {
        midpoints: triangles.iter().map(|[a, b, c]| (*a + *b + *c) / 3.0).collect(),
        bounds: triangles.iter().map(|t| Aabb::from_points(*t)).collect(),
    }
}

/// Checks that a split keeps every triangle exactly once and makes no empty child.
fn judge(base: &Base, target: Option<&Base>, about: &str) {
    let count = base.midpoints.len();
    let mut partition = Partition::over(1, base.clone());
    if let Some(target) = target {
        partition.add_target(target.bounds.clone());
    }
    for leaf_size in [1, 3, 8, 255] {
        partition.leaf_size = leaf_size;
        let mut triangles: Vec<u32> = (0..count as u32).collect();
        let lengths = run_to_end(partition.by_area(&mut triangles, &Budget::unlimited()));
        let about = format!("{about}, {count} triangles, {leaf_size} to a leaf: {lengths:?}");
        assert!(!lengths.contains(&0) && lengths.len() <= 8, "{about}");
        assert_eq!(lengths.iter().sum::<usize>(), count, "{about}");
        triangles.sort_unstable();
        assert!(triangles.into_iter().eq(0..count as u32), "{about}");
    }
}

#[test]
fn no_split_makes_an_empty_child() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut point = |size: f32| Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0_f32) * size));
    let base = [point(1.0), point(1.0), point(1.0)];
    for count in [1, 2, 7, 8, 9, 16, 17, 63, 64, 65, 300, 2100] {
        let of = |corner: &mut dyn FnMut(usize) -> [Vec3; 3]| shape(&(0..count).map(&mut *corner).collect::<Vec<_>>());
        let shapes = [
            ("identical", of(&mut |_| base)),
            ("points", of(&mut |_| [base[0]; 3])),
            (
                "all but one identical",
                of(&mut |i| if i == 0 { [Vec3::X; 3] } else { base }),
            ),
            (
                "two heaps",
                of(&mut |i| base.map(|p| if i % 2 == 0 { p } else { p + Vec3::X })),
            ),
            ("in a row", of(&mut |i| base.map(|p| p + Vec3::X * i as f32))),
            (
                "ever farther",
                of(&mut |i| base.map(|p| p + Vec3::X * 1.5_f32.powi((i % 150) as i32))),
            ),
            (
                "neighbouring numbers",
                of(&mut |i| [Vec3::splat(f32::from_bits(0x3f80_0000 + (i % 3) as u32)); 3]),
            ),
            ("huge", of(&mut |i| base.map(|p| p * 1e37 * (1.0 - i as f32 / 5000.0)))),
            ("tiny", of(&mut |i| base.map(|p| p * 1e-44 * i as f32))),
            ("anywhere", of(&mut |_| [point(1.0), point(1.0), point(1.0)])),
        ];
        for (name, shape) in &shapes {
            judge(shape, None, name);
        }
        // Planes are placed on the first shape, costs are summed over both.
        let [(_, identical), .., (_, anywhere)] = &shapes;
        judge(identical, Some(anywhere), "identical at the base only");
        judge(anywhere, Some(identical), "identical at a target");
    }
}

fn mean_leaf_triangles(bvh: &MorphBvh) -> f64 {
    bvh.model().triangle_count() as f64 / bvh.leaf_count() as f64
}

#[test]
fn leaves_of_smooth_meshes_are_nearly_full() {
    for mesh in [
        random::random_blob(1, 4, 0, 0.0),
        random::random_blob(2, 4, 3, 0.5),
        dolphin(1),
    ] {
        let model = MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap();
        let model = Arc::new(model);
        let bvh = MorphBvh::build(model, &BuildOptions::default());
        let fill = mean_leaf_triangles(&bvh) / 8.0;
        println!("{}: {fill:.2} full", mesh.name);
        assert!(fill >= 0.6, "{}: {fill}", mesh.name);
    }
}

#[test]
fn identical_triangles_make_nearly_full_leaves_and_a_shallow_tree() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 1.0)];
    let no_targets: [[Vec3; 3]; 0] = [];
    let model = Arc::new(MorphModel::from_displacements(&triangle, &[[0, 1, 2]; 5000], &no_targets).unwrap());
    let bvh = MorphBvh::build(model, &BuildOptions::default());
    validate(&bvh);
    assert!(mean_leaf_triangles(&bvh) >= 0.6 * 8.0 && bvh.depth() <= 6, "{bvh:?}");
}

#[test]
fn triangles_at_one_point_make_a_shallow_tree() {
    // All planes cost 0, so leaves need not be full.
    let mesh = degenerate::all_equal(5000);
    let model = Arc::new(MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap());
    let bvh = MorphBvh::build(model, &BuildOptions::default());
    validate(&bvh);
    assert!(bvh.depth() <= 6, "{}", bvh.depth());
}
