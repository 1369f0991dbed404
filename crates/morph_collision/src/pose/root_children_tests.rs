//! The root's children of skinned meshes, which queries about one body blend one by one.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::tree::ChildKind;
use crate::{
    Body, BuildOptions, Influences, JointMatrices, Kernel, MorphBvh, MorphModel, Pose, Ray, RayQuery, WorldFromModel,
};

const JOINTS: usize = 12;
const SIDE: usize = 24;

/// The sums of a vertex's weights.
#[derive(Clone, Copy, Debug)]
enum Sums {
    /// 1, up to rounding.
    One,
    /// Anything, also 0.
    Any,
}

/// A wavy sheet with one target. Each vertex is moved by up to four of the joints nearby.
fn sheet(sums: Sums, rng: &mut Pcg64Mcg) -> Arc<MorphBvh> {
    let (mut base, mut joints, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for vertex in 0..SIDE * SIDE {
        let (x, y) = (vertex % SIDE, vertex / SIDE);
        base.push(Vec3::new(x as f32, y as f32, (x + 2 * y) as f32 % 3.0));
        let near = (x * JOINTS / SIDE) as u16;
        joints.push([(); 4].map(|()| (near + rng.random_range(0..5)) % JOINTS as u16));
        let of: [f32; 4] = [(); 4].map(|()| rng.random_range(-0.5_f32..1.0).max(0.0));
        let sum: f32 = of.iter().sum();
        weights.push(match sums {
            Sums::One if sum > 0.0 => of.map(|weight| weight / sum),
            Sums::One => [1.0, 0.0, 0.0, 0.0],
            Sums::Any => of,
        });
    }
    let at = |x: usize, y: usize| (y * SIDE + x) as u32;
    let cells = (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y)));
    let triangles: Vec<_> = cells
        .flat_map(|(x, y)| {
            [
                [at(x, y), at(x + 1, y), at(x, y + 1)],
                [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)],
            ]
        })
        .collect();
    let lift: Vec<Vec3> = base.iter().map(|p| Vec3::Z * p.x.sin()).collect();
    let influences = Influences {
        joints: &joints,
        weights: &weights,
    };
    let model = MorphModel::skinned(&base, &triangles, &[lift], JOINTS, &[influences]).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
}

/// Joints that turn by up to an angle around the middle of the sheet, far from the origin by `at`; each axis is scaled by one of `scales`.
fn turned(rng: &mut Pcg64Mcg, angle: f32, scales: &[f32], at: Vec3) -> JointMatrices {
    let mut joint = || {
        let mut random = || rng.random_range(-1.0_f32..1.0);
        let turn = Quat::from_scaled_axis(angle * Vec3::new(random(), random(), random()));
        let size = Vec3::from_array([(); 3].map(|()| scales[rng.random_range(0..scales.len())]));
        let middle = Affine3A::from_translation(Vec3::splat(SIDE as f32 / 2.0));
        Affine3A::from_translation(at)
            * middle
            * Affine3A::from_scale_rotation_translation(size, turn, Vec3::ZERO)
            * middle.inverse()
    };
    let joints = [(); JOINTS].map(|()| joint());
    JointMatrices::new(&joints).unwrap()
}

/// The largest distance of a vertex beyond the outer box of its child, and the lengths of the boxes' and the vertices' diagonals.
fn check_outer_boxes(pose: &mut Pose, context: &str) -> (f64, f64) {
    let mut posed = pose.posed();
    let top = posed.top_group();
    assert!(posed.is_lazy(top), "{context}");
    let (boxes, are_outer) = posed.outer_boxes().map(|(boxes, outer)| (*boxes, outer)).unwrap();
    assert_eq!(are_outer, u8::MAX);
    let (mut of_boxes, mut of_vertices) = (0.0, 0.0);
    for (lane, child) in posed.topology.group(top).children().iter().enumerate() {
        let bounds = boxes.get(lane);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &triangle in posed.topology.triangles_below(*child) {
            for point in posed.world_triangle(triangle) {
                let (point, error) = posed.world_from_model.model_point(point);
                // Positions in the world are rounded.
                let error = DVec3::splat(error + 1e-13 * point.length());
                let is_in = (point + error).cmpge(bounds.min.as_dvec3()) & (point - error).cmple(bounds.max.as_dvec3());
                assert!(is_in.all(), "{context}: {point} outside {bounds:?}");
                (low, high) = (low.min(point), high.max(point));
            }
        }
        of_boxes += bounds.size().as_dvec3().length();
        of_vertices += (high - low).length();
    }
    (of_boxes, of_vertices)
}

#[test]
fn outer_boxes_contain_every_vertex() {
    let mut rng = Pcg64Mcg::seed_from_u64(31);
    for sums in [Sums::One, Sums::Any] {
        for kernel in Kernel::available() {
            let bvh = Arc::into_inner(sheet(sums, &mut rng)).unwrap();
            let bvh = Arc::new(bvh.with_kernel(*kernel));
            for (scales, at) in [
                (&[1.0][..], 0.0),
                (&[1.0], 1e4),
                (&[0.0, 1.0, 2.0], 3.0),
                (&[-1.0, 1.0], -50.0),
                (&[0.0], 7.0),
            ] {
                for angle in [0.0, 0.5, 3.0] {
                    let mut pose = Pose::new(Arc::clone(&bvh));
                    for weight in [0.0, -3.0, 1.0] {
                        let joints = turned(&mut rng, angle, scales, Vec3::splat(at));
                        pose.set_joints(&joints).unwrap();
                        pose.set_weights(&[weight]).unwrap();
                        check_outer_boxes(&mut pose, &format!("{sums:?} {scales:?} {at} {angle} {weight}"));
                    }
                }
            }
        }
    }
}

#[test]
fn outer_boxes_of_a_stiff_body_are_tight_and_those_of_huge_numbers_endless() {
    let mut rng = Pcg64Mcg::seed_from_u64(32);
    let mut pose = Pose::new(sheet(Sums::One, &mut rng));
    pose.set_joints(&turned(&mut rng, 0.0, &[1.0], Vec3::X)).unwrap();
    let (of_boxes, of_vertices) = check_outer_boxes(&mut pose, "stiff");
    assert!(of_boxes < of_vertices * 1.001, "{of_boxes} {of_vertices}");
    for (weight, is_endless) in [(1e30, false), (2e37, true)] {
        pose.set_weights(&[weight]).unwrap();
        let mut posed = pose.posed();
        let (boxes, _) = posed.outer_boxes().unwrap();
        assert_eq!(boxes.get(0).max.x == f32::INFINITY, is_endless, "{boxes:?}");
    }
}

#[test]
fn a_ray_blends_only_the_children_that_it_needs_and_later_queries_blend_the_rest() {
    let mut rng = Pcg64Mcg::seed_from_u64(33);
    let bvh = sheet(Sums::One, &mut rng);
    let place = WorldFromModel::IDENTITY;
    let joints = turned(&mut rng, 0.05, &[1.0], Vec3::ZERO);
    let mut pose = Pose::new(Arc::clone(&bvh));
    pose.set_joints(&joints).unwrap();
    let mut query = RayQuery::new();
    let miss = Ray::new(DVec3::new(-50.0, 0.0, 50.0), DVec3::Y, f64::INFINITY).unwrap();
    assert_eq!(query.closest(Body::new(&mut pose, &place), &miss), None);
    assert_eq!(query.stats().nodes_blended, 0);

    let down = |x, y| Ray::new(DVec3::new(x, y, 100.0), DVec3::NEG_Z, f64::INFINITY).unwrap();
    let children = pose.posed().topology.group(1).children().len();
    let blended = |pose: &mut Pose| {
        let (_, are_outer) = pose.posed().outer_boxes().unwrap();
        children - (are_outer & ((1 << children) - 1) as u8).count_ones() as usize
    };
    assert_eq!(blended(&mut pose), 0);
    let hit = query.closest(Body::new(&mut pose, &place), &down(2.5, 2.3));
    let mut fresh = Pose::new(Arc::clone(&bvh));
    fresh.set_joints(&joints).unwrap();
    fresh.world_bounds(&place);
    assert_eq!(query.closest(Body::new(&mut fresh, &place), &down(2.5, 2.3)), hit);
    assert!(hit.is_some());
    let first = blended(&mut pose);
    assert!((1..=children / 2).contains(&first), "{first} of {children}");

    // Another ray needs others, and the same ray nothing more.
    assert!(query.any(Body::new(&mut pose, &place), &down(2.5, 2.3)));
    assert_eq!(query.stats().nodes_blended, 0);
    assert!(query.any(Body::new(&mut pose, &place), &down(20.5, 20.3)));
    assert!(blended(&mut pose) > first);

    // Bounds need all of them, and are those of a pose that has blended them at once.
    assert_eq!(pose.world_bounds(&place), fresh.world_bounds(&place));
    assert_eq!(blended(&mut pose), children);
    let posed = pose.posed();
    assert!(!posed.is_lazy(1) && matches!(posed.topology.group(0).child(0).kind(), ChildKind::Group(1)));
    assert_eq!(posed.first_group(), 0);

    // New joints start anew.
    pose.set_joints(&turned(&mut rng, 0.05, &[1.0], Vec3::X)).unwrap();
    assert_eq!(blended(&mut pose), 0);
}
