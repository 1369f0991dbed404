//! Boxes of the nodes above the chunks of a skinned mesh's tree, and which chunks a query poses.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::bounds::Aabb;
use crate::{
    Body, BuildOptions, Influences, JointMatrices, Kernel, MorphBvh, MorphModel, Pose, Ray, RayQuery, SelfQuery,
    WorldFromModel,
};

const JOINTS: usize = 12;
/// The root's children are chunks.
const SMALL: usize = 24;
/// There are chunks below each child of the root, too.
const LARGE: usize = 72;

/// The sums of a vertex's weights.
#[derive(Clone, Copy, Debug)]
enum Sums {
    /// 1, up to rounding.
    One,
    /// Anything, also 0.
    Any,
}

/// A wavy sheet with one target. Each vertex is moved by up to four of the joints nearby.
fn sheet(side: usize, sums: Sums, rng: &mut Pcg64Mcg) -> Arc<MorphBvh> {
    let (mut base, mut joints, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for vertex in 0..side * side {
        let (x, y) = (vertex % side, vertex / side);
        base.push(Vec3::new(x as f32, y as f32, (x + 2 * y) as f32 % 3.0));
        let near = (x * JOINTS / side) as u16;
        joints.push([(); 4].map(|()| (near + rng.random_range(0..5)) % JOINTS as u16));
        let of: [f32; 4] = [(); 4].map(|()| rng.random_range(-0.5_f32..1.0).max(0.0));
        let sum: f32 = of.iter().sum();
        weights.push(match sums {
            Sums::One if sum > 0.0 => of.map(|weight| weight / sum),
            Sums::One => [1.0, 0.0, 0.0, 0.0],
            Sums::Any => of,
        });
    }
    let at = |x: usize, y: usize| (y * side + x) as u32;
    let cells = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| (x, y)));
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
        let middle = Affine3A::from_translation(Vec3::splat(SMALL as f32 / 2.0));
        Affine3A::from_translation(at)
            * middle
            * Affine3A::from_scale_rotation_translation(size, turn, Vec3::ZERO)
            * middle.inverse()
    };
    let joints = [(); JOINTS].map(|()| joint());
    JointMatrices::new(&joints).unwrap()
}

/// Fails if a vertex is outside a box of a group above the chunks, or if one is posed for the boxes. Returns the lengths of the diagonals of
/// the boxes and of their vertices, summed over the children of groups whose boxes come from parts.
fn check_outer_boxes(pose: &mut Pose, context: &str) -> (f64, f64) {
    let mut posed = pose.posed();
    let (tables, _) = posed.skin.as_ref().unwrap();
    let groups: Vec<usize> = tables.chunks.outer_groups().collect();
    let before = posed.blended().vertices;
    let mut boxes: Vec<Vec<Aabb>> = Vec::new();
    for &group in &groups {
        let (slot, children) = (posed.open(group), posed.topology.group(group).children().len());
        boxes.push((0..children).map(|lane| posed.boxes(slot).get(lane)).collect());
    }
    assert_eq!(posed.blended().vertices, before, "{context}");
    let world: Vec<DVec3> = (0..posed.model.vertex_count() as u32)
        .map(|vertex| posed.world_vertex(vertex))
        .collect();
    let origin = posed.world_from_model.translation();
    // Boxes hold exact vertices; the others are rounded.
    let error = posed.skin.as_ref().unwrap().1.error();
    let (mut of_boxes, mut of_vertices) = (0.0, 0.0);
    for (group, boxes) in groups.into_iter().zip(boxes) {
        for (child, bounds) in posed.topology.group(group).children().iter().zip(boxes) {
            let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let triangles = posed.topology.triangles_below(*child).iter();
            for vertex in triangles.flat_map(|&triangle| posed.model.corners(triangle)) {
                let point = world[vertex as usize] - origin;
                let error = error + 1e-15 * point.abs().max_element();
                let is_in = (point + error).cmpge(bounds.min.as_dvec3()) & (point - error).cmple(bounds.max.as_dvec3());
                assert!(is_in.all(), "{context}: {point} outside {bounds:?}");
                (low, high) = (low.min(point), high.max(point));
            }
            if group > 0 {
                of_boxes += bounds.size().as_dvec3().length();
                of_vertices += (high - low).length();
            }
        }
    }
    (of_boxes, of_vertices)
}

/// The number of groups above the chunks.
fn outer_count(bvh: &MorphBvh) -> usize {
    bvh.skin.as_ref().unwrap().chunks.outer_groups().count()
}

#[test]
fn outer_boxes_contain_every_vertex() {
    let mut rng = Pcg64Mcg::seed_from_u64(31);
    for (side, sums) in [(SMALL, Sums::One), (SMALL, Sums::Any), (LARGE, Sums::Any)] {
        for kernel in Kernel::available() {
            let bvh = Arc::into_inner(sheet(side, sums, &mut rng)).unwrap();
            let bvh = Arc::new(bvh.with_kernel(*kernel));
            assert!(outer_count(&bvh) > 2 || side == SMALL);
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
    for side in [SMALL, LARGE] {
        let mut pose = Pose::new(sheet(side, Sums::One, &mut rng));
        pose.set_joints(&turned(&mut rng, 0.0, &[1.0], Vec3::X)).unwrap();
        let (of_boxes, of_vertices) = check_outer_boxes(&mut pose, "stiff");
        assert!(of_boxes < of_vertices * 1.001, "{of_boxes} {of_vertices}");
        for (weight, is_endless) in [(1e30, false), (2e37, true)] {
            pose.set_weights(&[weight]).unwrap();
            let mut posed = pose.posed();
            let slot = posed.open(1);
            let bounds = posed.boxes(slot).get(0);
            assert_eq!(bounds.max.x == f32::INFINITY, is_endless, "{bounds:?}");
        }
    }
}

#[test]
fn a_ray_poses_only_the_chunks_that_it_needs_and_later_queries_pose_the_rest() {
    let mut rng = Pcg64Mcg::seed_from_u64(33);
    for side in [SMALL, LARGE] {
        let bvh = sheet(side, Sums::One, &mut rng);
        let all = bvh.model().vertex_count() as u64;
        let place = WorldFromModel::IDENTITY;
        let joints = turned(&mut rng, 0.05, &[1.0], Vec3::ZERO);
        let mut pose = Pose::new(Arc::clone(&bvh));
        pose.set_joints(&joints).unwrap();
        let mut total = 0;
        // The number of vertices that were posed since the last call.
        let mut posed = |pose: &mut Pose| {
            let new = pose.posed().blended().vertices - total;
            total += new;
            new
        };
        let mut query = RayQuery::new();
        let miss = Ray::new(DVec3::new(-50.0, 0.0, 50.0), DVec3::Y, f64::INFINITY).unwrap();
        assert_eq!(query.closest(Body::new(&mut pose, &place), &miss), None);
        let bounds = pose.world_bounds(&place);
        assert_eq!(posed(&mut pose), 0);

        let down = |x, y| Ray::new(DVec3::new(x, y, 100.0), DVec3::NEG_Z, f64::INFINITY).unwrap();
        let mut refitted = Pose::new(Arc::clone(&bvh));
        refitted.set_joints(&joints).unwrap();
        refitted.refit();
        let (of_boxes, of_vertices) = check_outer_boxes(&mut refitted, "refitted");
        assert!(of_boxes < of_vertices * 1.0001, "{of_boxes} {of_vertices}");
        let far = side as f64 - 3.5;
        let mut first = 0;
        for (x, y) in [(2.5, 2.3), (far, far)] {
            let hit = query.closest(Body::new(&mut pose, &place), &down(x, y));
            assert!(hit.is_some());
            assert_eq!(query.closest(Body::new(&mut refitted, &place), &down(x, y)), hit);
            // Another ray needs others, and the same ray nothing more.
            let new = posed(&mut pose);
            assert!((1..=all / 2).contains(&new), "{new} of {all}");
            first += new;
            assert!(query.any(Body::new(&mut pose, &place), &down(x, y)));
            assert_eq!(posed(&mut pose), 0);
        }

        // A query that needs all vertices poses the rest, and none of them again.
        let [mut of_both, mut of_refitted] = [Vec::new(), Vec::new()];
        let mut pairs = SelfQuery::new();
        pairs.all(&mut pose, &mut of_both);
        pairs.all(&mut refitted, &mut of_refitted);
        of_both.sort_unstable();
        of_refitted.sort_unstable();
        assert_eq!(of_both, of_refitted);
        pose.visit_nodes(|_| true);
        assert_eq!(posed(&mut pose), all - first);
        pose.refit();
        assert_eq!(posed(&mut pose), 0);
        assert!(bounds.contains(pose.world_bounds(&place).min) && bounds.contains(pose.world_bounds(&place).max));
        assert_eq!(pose.world_bounds(&place), refitted.world_bounds(&place));

        // New joints and new weights start anew.
        pose.set_joints(&turned(&mut rng, 0.05, &[1.0], Vec3::X)).unwrap();
        pose.visit_nodes(|_| true);
        assert_eq!(posed(&mut pose), all);
        pose.set_weights(&[0.1]).unwrap();
        check_outer_boxes(&mut pose, "new weights");
        assert_eq!(posed(&mut pose), all);
        pose.set_weights(&[0.1]).unwrap();
        pose.visit_nodes(|_| true);
        assert_eq!(posed(&mut pose), 0);
    }
}
