//! Tests of what models accept and how they weld vertices.

use glam::Vec3;

use super::{BadParts, Influences, ModelError, MorphModel, SparseTarget};

const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

#[test]
fn vertices_are_welded_only_if_they_move_alike() {
    // A quad of two triangles with split corners. Vertices 1 and 4 are equal; 2 and 3 are equal only until the target moves 3.
    let base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Y, Vec3::X, Vec3::ONE];
    let mut target = [Vec3::ZERO; 6];
    target[3] = Vec3::Z;
    let model = MorphModel::from_displacements(&base, &[[0, 1, 2], [3, 4, 5]], &[target]).unwrap();
    assert_eq!(model.source_vertex_count(), 6);
    assert_eq!(model.vertex_count(), 5);
    assert_eq!(model.welded_from_source(), [0, 1, 2, 3, 1, 4]);
    assert_eq!(model.triangle(1), Some([3, 1, 4]));
    assert_eq!(model.triangle(2), None);
    assert_eq!(model.displaced_vertex_count(0), 1);
    assert_eq!(model.displaced_vertex_count(7), 0);
}

#[test]
fn negative_zero_is_welded_to_zero() {
    let base = [Vec3::ZERO, Vec3::X, Vec3::Y, -Vec3::ZERO];
    let model = MorphModel::from_displacements::<[Vec3; 4]>(&base, &[[0, 1, 2], [3, 1, 2]], &[]).unwrap();
    assert_eq!(model.vertex_count(), 3);
}

#[test]
fn the_error_of_joint_weights_is_the_largest_of_all_vertices() {
    let error = |weights: [[f32; 4]; 3]| {
        let influences = Influences {
            joints: &[[0, 1, 0, 0]; 3],
            weights: &weights,
        };
        let none: [[Vec3; 3]; 0] = [];
        let model = MorphModel::skinned(&CORNERS, &[[0, 1, 2]], &none, 2, &[influences]).unwrap();
        model.joint_weight_error().unwrap()
    };
    let whole = [0.5, 0.5, 0.0, 0.0];
    assert!(error([whole; 3]) < 1e-14);
    assert!((error([whole, [1.0, 0.75, 0.0, 0.0], whole]) - 0.75).abs() < 1e-14);
    assert!((error([whole, whole, [0.0; 4]]) - 1.0).abs() < 1e-14);
    let none: [[Vec3; 3]; 0] = [];
    let rigid = MorphModel::from_displacements(&CORNERS, &[[0, 1, 2]], &none).unwrap();
    assert_eq!(rigid.joint_weight_error(), None);
}

#[test]
fn a_vertex_may_have_any_number_of_influences_up_to_a_sum_of_their_weights() {
    let build = |sets: usize, weight: f32| {
        let influences = Influences {
            joints: &[[0, 1, 0, 1]; 3],
            weights: &[[weight; 4]; 3],
        };
        let none: [[Vec3; 3]; 0] = [];
        MorphModel::skinned(&CORNERS, &[[0, 1, 2]], &none, 2, &vec![influences; sets])
    };
    // 12 influences were refused before, and so were all of more sets.
    for sets in [0, 1, 2, 3, 4, 40] {
        let weight = 0.25 / sets.max(1) as f32;
        let model = build(sets, weight).unwrap();
        let sum = 4.0 * f64::from(weight) * sets as f64;
        let error = model.joint_weight_error().unwrap();
        assert!((error - (1.0 - sum).abs()).abs() < 1e-12, "{sets} sets: {error}");
    }
    // As much as eight influences could have: more would leave the range of the exact tests.
    assert!(build(2, 1000.0).is_ok() && build(4, 500.0).is_ok());
    let refused = build(3, 1000.0).unwrap_err();
    assert_eq!(
        refused,
        ModelError::WeightsTooLarge {
            vertex: 0,
            sum: 12_000.0
        }
    );
    assert!(
        refused
            .to_string()
            .starts_with("vertex 0: its joint weights sum to 12000")
    );
}

#[test]
fn unusable_meshes_are_refused_with_what_and_where() {
    type Targets = Vec<Vec<Vec3>>;
    let none: Targets = Vec::new();
    let build = |base: &[Vec3], triangles: &[[u32; 3]], targets: &Targets| {
        MorphModel::from_displacements(base, triangles, targets).unwrap_err()
    };
    assert_eq!(build(&[], &[[0, 1, 2]], &none), ModelError::NoVertices);
    assert_eq!(build(&CORNERS, &[], &none), ModelError::NoTriangles);
    assert_eq!(
        build(&CORNERS, &[[0, 1, 2], [0, 3, 1]], &none),
        ModelError::IndexOutOfRange {
            triangle: 1,
            corner: 1,
            index: 3,
            vertices: 3
        }
    );
    assert_eq!(
        build(&CORNERS, &[[0, 1, 2]], &vec![vec![Vec3::ZERO; 3], vec![Vec3::ZERO; 2]]),
        ModelError::LengthMismatch {
            shape: "target 1".into(),
            length: 2,
            expected: 3
        }
    );
    assert_eq!(
        build(
            &CORNERS,
            &[[0, 1, 2]],
            &vec![vec![Vec3::ZERO, Vec3::X * 2e37, Vec3::ZERO]]
        ),
        ModelError::BadCoordinate {
            shape: "target 0".into(),
            vertex: 1,
            value: 2e37
        }
    );
    let nan = build(
        &[Vec3::ZERO, Vec3::new(0.0, f32::NAN, 0.0), Vec3::Y],
        &[[0, 1, 2]],
        &none,
    );
    assert!(matches!(&nan, ModelError::BadCoordinate { shape, vertex: 1, value } if shape == "base" && value.is_nan()));
    let mut bent = CORNERS;
    bent[2].y = f32::INFINITY;
    let error = build(&CORNERS, &[[0, 1, 2]], &vec![bent.to_vec()]);
    assert!(error.to_string().starts_with("target 0, vertex 2: "), "{error}");
}

/// A fan of triangles around vertex 0, and a target.
fn fan() -> (Vec<Vec3>, Vec<[u32; 3]>, Vec<Vec3>) {
    let base = (0..12).map(|i| Vec3::new(i as f32, (i * i) as f32, 1.0)).collect();
    let triangles = (1..11).map(|i| [0, i, i + 1]).collect();
    (base, triangles, vec![Vec3::Z; 12])
}

#[test]
fn bad_parts_are_those_for_which_a_model_is_refused() {
    let (base, triangles, target) = fan();
    let (joints, weights) = (vec![[0, 1, 9, 9]; 12], vec![[0.5, 0.5, 0.0, 0.0]; 12]);
    type Spoil = fn(&mut Vec<Vec3>, &mut Vec<[u32; 3]>, &mut Vec<Vec3>, &mut Vec<[u16; 4]>, &mut Vec<[f32; 4]>);
    let cases: [(Spoil, &[u32], &[u32], &str); 8] = [
        (|_, _, _, _, _| {}, &[], &[], ""),
        (|base, _, _, _, _| base[3].y = f32::NAN, &[1, 2], &[3], "base, vertex 3"),
        (
            |_, _, target, _, _| target[11].z = 1e38,
            &[9],
            &[11],
            "target 0, vertex 11",
        ),
        (
            |_, _, _, _, weights| weights[5][1] = f32::NAN,
            &[3, 4],
            &[5],
            "vertex 5, influence 1",
        ),
        (
            |_, _, _, _, weights| weights[5][2] = -0.1,
            &[3, 4],
            &[5],
            "vertex 5, influence 2",
        ),
        (
            |_, _, _, joints, _| joints[11][0] = 2,
            &[9],
            &[11],
            "vertex 11, influence 0: joint 2",
        ),
        (
            |_, triangles, _, _, _| triangles[4][2] = 12,
            &[4],
            &[],
            "triangle 4, corner 2",
        ),
        (
            |base, triangles, _, _, weights| {
                base[2].x = f32::INFINITY;
                triangles[7][0] = u32::MAX;
                weights[2][0] = f32::NAN;
            },
            &[0, 1, 7],
            &[2],
            "base, vertex 2",
        ),
    ];
    for (spoil, bad_triangles, bad_vertices, reason) in cases {
        let (mut base, mut triangles, mut target) = (base.clone(), triangles.clone(), target.clone());
        let (mut joints, mut weights) = (joints.clone(), weights.clone());
        spoil(&mut base, &mut triangles, &mut target, &mut joints, &mut weights);
        let build = |base: &[Vec3], triangles: &[[u32; 3]], target: &Vec<Vec3>, joints: &[[u16; 4]], weights: &[_]| {
            MorphModel::skinned(base, triangles, &[target], 2, &[Influences { joints, weights }])
        };
        let refused = build(&base, &triangles, &target, &joints, &weights).err();
        assert_eq!(refused.is_some(), !reason.is_empty(), "{refused:?}");
        let sets = [Influences {
            joints: &joints,
            weights: &weights,
        }];
        let bad = BadParts::find(&base, &triangles, &[&target], Some((2, &sets))).unwrap();
        assert_eq!(
            (bad.triangles(), bad.vertices()),
            (bad_triangles, bad_vertices),
            "{reason}"
        );
        let message = bad.first().map(ToString::to_string).unwrap_or_default();
        assert!(
            message.starts_with(reason) && message.is_empty() == reason.is_empty(),
            "{message}"
        );
        bad.repair(&mut base);
        let mut sparse: SparseTarget = target.iter().copied().collect();
        bad.repair_target(&mut sparse);
        bad.repair(&mut target);
        assert_eq!(sparse, target.iter().copied().collect());
        bad.repair(&mut joints);
        bad.repair(&mut weights);
        bad.remove_from(&mut triangles);
        let model = build(&base, &triangles, &target, &joints, &weights).unwrap();
        assert_eq!(model.triangle_count(), 10 - bad_triangles.len());
        // Bad vertices count for nothing.
        assert_eq!(model.vertex_count(), 12 - bad_vertices.len());
        assert!(model.joint_weight_error().unwrap() < 1e-12);
    }
}

#[test]
fn what_cannot_be_mended_stays_an_error() {
    let (_, triangles, target) = fan();
    let mut base = vec![Vec3::NAN; 12];
    let bad = BadParts::find(&base, &triangles, &[&target], None).unwrap();
    assert_eq!((bad.triangles().len(), bad.vertices().len()), (10, 12));
    bad.repair(&mut base);
    assert!(base[0].is_nan(), "there is no good vertex");
    let short = BadParts::find(&base, &triangles, &[&target[1..]], None).unwrap_err();
    assert!(matches!(short, ModelError::LengthMismatch { .. }));
}
