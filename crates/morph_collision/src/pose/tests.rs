//! Tests of what poses accept, keep and return.

use std::sync::Arc;

use glam::Vec3;

use super::{Blended, Pose, WeightsError};
use crate::bounds::WorldFromModel;
use crate::model::MorphModel;
use crate::tree::{BuildOptions, MorphBvh};

fn lifted_triangle() -> Pose {
    let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let model = MorphModel::from_displacements(&base, &[[0, 1, 2]], &[[Vec3::Z; 3], [Vec3::X; 3]]).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())))
}

fn blended(pose: &mut Pose) -> Blended {
    pose.posed().blended()
}

#[test]
fn equal_weights_keep_what_was_blended_and_new_ones_do_not() {
    let mut pose = lifted_triangle();
    assert_eq!(pose.set_weights(&[0.5, 0.0]), Ok(true));
    let low = pose.bounds();
    pose.source_vertex(0);
    let before = blended(&mut pose);
    assert_eq!(pose.set_weights(&[0.5, 0.0]), Ok(false));
    assert_eq!(pose.bounds(), low);
    pose.source_vertex(0);
    assert_eq!(blended(&mut pose), before);
    assert_eq!(pose.set_weights(&[2.0, 0.0]), Ok(true));
    assert!(pose.bounds().min.z > low.max.z);
    assert_eq!(blended(&mut pose).volumes, before.volumes + 1);
}

#[test]
fn refused_weights_leave_the_last_good_ones_in_force() {
    let mut pose = lifted_triangle();
    pose.set_weights(&[0.25, 1.0]).unwrap();
    let refusals = [
        (
            pose.set_weights(&[1.0]),
            WeightsError::WrongCount { given: 1, expected: 2 },
        ),
        (
            pose.set_weights(&[1.0, f32::INFINITY]),
            WeightsError::NotFinite {
                index: 1,
                value: f32::INFINITY,
            },
        ),
        (
            pose.set_weights(&[3e37, 0.0]),
            WeightsError::TooLarge { index: 0, value: 3e37 },
        ),
    ];
    for (refusal, expected) in refusals {
        assert_eq!(refusal, Err(expected));
    }
    assert!(matches!(
        pose.set_weights(&[0.0, f32::NAN]),
        Err(WeightsError::NotFinite { index: 1, .. })
    ));
    assert_eq!(pose.weights(), [0.25, 1.0]);
    assert_eq!(pose.source_vertex(1), Some(Vec3::new(2.0, 0.0, 0.25)));
    let [_, second, _] = pose.triangle(0).unwrap();
    assert_eq!(second, Vec3::new(2.0, 0.0, 0.25));
    assert_eq!(pose.vertex(pose.bvh().model().corners(0)[1]), Some(second));
}

#[test]
fn a_vertex_that_does_not_exist_is_none() {
    assert_eq!(lifted_triangle().source_vertex(3), None);
    assert_eq!(lifted_triangle().vertex(3), None);
    assert_eq!(lifted_triangle().triangle(1), None);
}

#[test]
fn weights_that_reach_the_limit_are_taken_and_larger_ones_refused() {
    let model = MorphModel::from_displacements(&[Vec3::ZERO; 3], &[[0, 1, 2]], &[[Vec3::X * 1e37; 3]]).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    assert_eq!(pose.set_weights(&[2.0]), Ok(true));
    let value = 2.0_f32.next_up();
    let refusal = WeightsError::TooLarge { index: 0, value };
    assert_eq!(pose.set_weights(&[value]), Err(refusal));
}

#[test]
fn a_copy_follows_its_pose_and_keeps_what_it_has_blended() {
    let mut pose = lifted_triangle();
    let mut copy = None;
    for weight in [0.0, 0.5] {
        pose.set_weights(&[weight, 0.0]).unwrap();
        let copied = Pose::copied(&mut copy, &pose);
        assert_eq!(copied.source_vertex(0), Some(Vec3::Z * weight));
        let before = blended(copied);
        let copied = Pose::copied(&mut copy, &pose);
        assert_eq!(copied.source_vertex(0), Some(Vec3::Z * weight));
        assert_eq!(blended(copied), before);
    }
}

/// Far from the origin, even a small change of weights moves a vertex by a whole unit in its last place, once per target whose
/// weight is not zero.
#[test]
fn the_displacement_between_weights_covers_roundings() {
    let base = [Vec3::splat(1e6), Vec3::splat(1e6) + Vec3::X, Vec3::splat(1e6) + Vec3::Y];
    for targets in [1, 8] {
        let model = MorphModel::from_displacements(&base, &[[0, 1, 2]], &vec![[Vec3::ONE; 3]; targets + 1]).unwrap();
        let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
        let rest = vec![0.0; targets + 1];
        let mut jumps = 0;
        for weight in [0.0, 0.031, 0.0313, 0.05, 0.094] {
            pose.set_weights(&rest).unwrap();
            let before = pose.vertex(0).unwrap().as_dvec3();
            let mut weights = vec![weight; targets];
            weights.push(0.0);
            pose.set_weights(&weights).unwrap();
            let moved = pose.vertex(0).unwrap().as_dvec3().distance(before);
            let mut resting = Pose::new(pose.bvh().clone());
            assert!(
                moved <= pose.displacement_from_pose(&mut resting),
                "{moved} at {weight}"
            );
            jumps += usize::from(moved > 3_f64.sqrt() * targets as f64 * f64::from(weight));
        }
        assert!(jumps > 0, "no vertex was rounded away from its exact place");
    }
}

#[test]
fn the_displacement_between_weights_is_that_of_the_targets_but_for_roundings() {
    let mut pose = lifted_triangle();
    pose.set_weights(&[0.5, 0.25]).unwrap();
    let mut resting = Pose::new(pose.bvh().clone());
    let bound = pose.displacement_from_pose(&mut resting);
    let moved = 0.3125_f64.sqrt();
    assert!((moved..moved + 1e-5).contains(&bound), "{bound}");
}

#[test]
fn memory_grows_with_what_was_visited() {
    let mut pose = lifted_triangle();
    let before = pose.bytes();
    pose.tight_world_bounds(&WorldFromModel::IDENTITY);
    pose.bounds();
    assert!(pose.bytes() > before);
}

/// Two references that differ greatly, as in the paper's figures.
fn two_references() -> Pose {
    let references = [
        vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        vec![Vec3::Z, Vec3::splat(5.0), Vec3::NEG_ONE],
    ];
    let [base, other] = &references;
    let target: Vec<Vec3> = other.iter().zip(base).map(|(p, b)| p - b).collect();
    let model = MorphModel::from_displacements(base, &[[0, 1, 2]], &[target]).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())))
}

#[test]
fn blended_boxes_are_tight_at_each_reference() {
    let mut pose = two_references();
    let expected = [
        (0.0, [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)]),
        (1.0, [Vec3::NEG_ONE, Vec3::splat(5.0)]),
    ];
    for (weight, [min, max]) in expected {
        pose.set_weights(&[weight]).unwrap();
        let bounds = pose.bounds();
        assert!(bounds.min.abs_diff_eq(min, 1e-5), "{bounds:?} at {weight}");
        assert!(bounds.max.abs_diff_eq(max, 1e-5), "{bounds:?} at {weight}");
    }
}

#[test]
fn a_weight_just_above_one_loosens_a_box_by_next_to_nothing() {
    let mut pose = two_references();
    pose.set_weights(&[1.0 + 2.0 * f32::EPSILON]).unwrap();
    assert!(pose.bounds().max.max_element() < 5.0 + 1e-4);
}

#[test]
fn debug_output_has_counts_and_no_mesh() {
    let mesh = morph_collision_models::generated::random::random_blob(3, 4, 2, 0.5);
    let model = MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap();
    let bvh = MorphBvh::build(Arc::new(model), &BuildOptions::default());
    let layout = format!("{:?}", bvh.layout());
    let pose = format!("{:?}", Pose::new(Arc::new(bvh)));
    for text in [layout, pose] {
        assert!(text.contains(&format!("triangles: {}", mesh.triangles.len())), "{text}");
        assert!(text.len() < 400, "{text}");
    }
}

#[test]
fn a_body_stands_where_its_last_weights_and_boxes_are() {
    let mut pose = lifted_triangle();
    let bounds = |pose: &mut Pose| pose.posed().placed_body().bounds;
    let low = bounds(&mut pose);
    pose.set_weights(&[2.0, 0.0]).unwrap();
    let high = bounds(&mut pose);
    assert!(high.min.z > low.max.z, "{low:?}, {high:?}");
    pose.refit();
    let tight = bounds(&mut pose);
    assert_eq!((tight.min.z, tight.max.z), (2.0, 2.0));
    assert!(high.min.z < 2.0);
}

#[test]
fn a_standing_body_has_the_size_and_the_slack_of_its_place() {
    let place = |scale: Vec3| WorldFromModel::new(glam::Affine3A::from_scale(scale)).unwrap();
    let mut pose = lifted_triangle();
    for (scale, size) in [
        (Vec3::new(3.0, 1.0, 1.0), 3.0),
        (Vec3::new(1.0, 4.0, 1.0), 4.0),
        (Vec3::splat(0.5), 0.5),
    ] {
        let place = place(scale);
        let found = pose.posed_at(&place).placed_body().size;
        assert!((found / size - 1.0).abs() < 1e-5, "{found}, {size}");
    }
    // Taller than wide: a triangle twice as high along y, and sides along z.
    let base = [Vec3::ZERO, Vec3::Y * 2.0, Vec3::Z * 4.0];
    let no_targets: [Vec<Vec3>; 0] = [];
    let model = MorphModel::from_displacements(&base, &[[0, 1, 2]], &no_targets).unwrap();
    let mut tall = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    for (scale, size) in [(Vec3::new(1.0, 10.0, 1.0), 20.0), (Vec3::new(1.0, 1.0, 10.0), 40.0)] {
        let place = place(scale);
        let found = tall.posed_at(&place).placed_body().size;
        assert!((found / size - 1.0).abs() < 1e-5, "{found}, {size}");
    }
    // All corners in one place: rounding is all that boxes hold.
    let model = MorphModel::from_displacements(&base, &[[0, 1, 2]], &[base.map(|p| Vec3::ONE - p)]).unwrap();
    let mut point = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    point.set_weights(&[1.0]).unwrap();
    let rounding = f64::from(point.posed().rounding(0.0));
    for scale in [1.0, 1000.0] {
        let place = place(Vec3::splat(scale as f32));
        let mut posed = point.posed_at(&place);
        let placed_body = posed.placed_body();
        let slack = placed_body.placed.error() + rounding * scale;
        assert!(
            (1.0..1.001).contains(&(placed_body.slack / slack)),
            "{}, {slack}",
            placed_body.slack
        );
    }
}

#[test]
fn normals_and_positions_are_those_of_the_posed_shape() {
    let base = [
        Vec3::ONE,
        Vec3::new(3.0, 1.0, 1.0),
        Vec3::new(1.0, 2.0, 1.0),
        Vec3::new(1.0, 1.0, 3.0),
    ];
    let triangles = [[0, 1, 2], [0, 3, 1]];
    let model = MorphModel::from_displacements(&base, &triangles, &[[Vec3::X; 4]]).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    pose.set_weights(&[2.0]).unwrap();
    let (mut positions, mut normals) = (vec![Vec3::ZERO], vec![Vec3::ZERO]);
    pose.source_positions(&mut positions);
    assert_eq!(positions, base.map(|p| p + Vec3::X * 2.0));
    pose.source_normals(&mut normals);
    // Areas of 1 and 2, along z and along y.
    let shared = Vec3::new(0.0, 2.0, 1.0).normalize();
    let expected = [shared, shared, Vec3::Z, Vec3::Y];
    for (normal, expected) in normals.iter().zip(expected) {
        assert!(normal.abs_diff_eq(expected, 1e-6), "{normals:?}");
    }
    assert_eq!(normals.len(), 4);
}
