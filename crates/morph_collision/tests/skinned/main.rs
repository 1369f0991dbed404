//! Every query gives the same answer for a skinned body as for a rigid body of the same shape.
//!
//! Positions, weights and joints are multiples of small powers of two, so a rigid mesh can represent the vertices of the skinned mesh
//! exactly. All answers must be equal bit for bit.
#![allow(clippy::disallowed_methods)]

use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3A, Quat, Vec3, Vec3A};
use morph_collision::batch::{BatchQuery, PairTask, ThreadWorkers, Wanted};
use morph_collision::{
    Body, BuildOptions, ContactQuery, ConvexRegion, DistanceQuery, Influences, JointMatrices, MorphBvh, MorphModel,
    PairMemory, PairQuery, PlacedShape, Pose, Ray, RayQuery, SelfQuery, Shape, ShapeQuery, SurfaceAnchor, TrianglePair,
    WorldFromModel,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const JOINTS: usize = 6;
const VERTICES: usize = 240;
const WORLD: WorldFromModel = WorldFromModel::IDENTITY;

/// A random multiple of 1/64 between -4 and 4.
fn coarse(rng: &mut Pcg64Mcg) -> f32 {
    rng.random_range(-256..256) as f32 / 64.0
}

fn point(rng: &mut Pcg64Mcg) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| coarse(rng)))
}

/// Small triangles at random positions, with a target. One or two joints move each vertex.
fn skinned(rng: &mut Pcg64Mcg) -> Pose {
    let mut base = Vec::new();
    for _ in 0..VERTICES / 3 {
        let at = point(rng);
        base.extend([(); 3].map(|()| at + point(rng) / 4.0));
    }
    let triangles: Vec<[u32; 3]> = (0..VERTICES as u32 / 3)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let target: Vec<Vec3> = base.iter().map(|_| point(rng)).collect();
    let joints: Vec<[u16; 4]> = (0..VERTICES)
        .map(|_| [(); 4].map(|()| rng.random_range(0..JOINTS as u16)))
        .collect();
    let weights = [
        [1.0, 0.0, 0.0, 0.0],
        [0.5, 0.5, 0.0, 0.0],
        [0.75, 0.0, 0.25, 0.0],
        [0.25, 0.25, 0.25, 0.25],
        [0.5, 0.25, 0.0, 0.0],
    ];
    let weights: Vec<[f32; 4]> = (0..VERTICES)
        .map(|_| weights[rng.random_range(0..weights.len())])
        .collect();
    let influences = Influences {
        joints: &joints,
        weights: &weights,
    };
    let model = MorphModel::skinned(&base, &triangles, &[target], JOINTS, &[influences]).unwrap();
    let options = BuildOptions::default().with_leaf_size(4).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)))
}

/// Joints that rotate by right angles, scale and shear, and some of which mirror if `mirrored` is set.
fn joints(rng: &mut Pcg64Mcg, mirrored: bool) -> JointMatrices {
    let mut one = || {
        let axes = [Vec3A::X, Vec3A::Y, Vec3A::Z];
        let first = rng.random_range(0..3);
        let mut scaled = |axis: usize| {
            axes[(first + axis) % 3] * [0.5, 1.0, 2.0, 1.5, -1.0][rng.random_range(0..if mirrored { 5 } else { 4 })]
        };
        let matrix3 = Mat3A::from_cols(scaled(0), scaled(1), scaled(2));
        let shear = Mat3A::from_cols(
            Vec3A::X,
            Vec3A::new(rng.random_range(-2..3) as f32 / 4.0, 1.0, 0.0),
            Vec3A::Z,
        );
        Affine3A {
            matrix3: matrix3 * shear,
            translation: (point(rng) / 2.0).into(),
        }
    };
    JointMatrices::new(&[(); JOINTS].map(|()| one())).unwrap()
}

/// A rigid body with the shape of a pose.
fn frozen(pose: &mut Pose) -> Pose {
    let model = pose.bvh().model().clone();
    let mut body = Body::new(pose, &WORLD);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for triangle in 0..model.triangle_count() as u32 {
        let first = positions.len() as u32;
        for corner in body.triangle(triangle).unwrap() {
            assert_eq!(corner.as_vec3().as_dvec3(), corner, "not a number that a mesh can have");
            positions.push(corner.as_vec3());
        }
        triangles.push([first, first + 1, first + 2]);
    }
    let model = MorphModel::from_displacements::<[Vec3; 0]>(&positions, &triangles, &[]).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())))
}

/// Two skinned bodies, and rigid bodies of the same shapes. With odd seeds, some joints are mirrored.
fn pairs_of_bodies(seed: u64) -> ([Pose; 2], [Pose; 2]) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut poses = [(); 2].map(|()| skinned(&mut rng));
    for pose in &mut poses {
        pose.set_joints(&joints(&mut rng, seed % 2 == 1)).unwrap();
        pose.set_weights(&[[0.0, 0.5, -1.0, 2.0][rng.random_range(0..4)]])
            .unwrap();
    }
    if seed.is_multiple_of(3) {
        poses[0].refit();
    }
    let rigid = poses.each_mut().map(frozen);
    (poses, rigid)
}

fn bodies([a, b]: &mut [Pose; 2]) -> [Body<'_>; 2] {
    [Body::new(a, &WORLD), Body::new(b, &WORLD)]
}

/// Runs a query for skinned and for rigid bodies, and fails if the answers differ. Returns the number of answers that are not the default.
fn same<T: PartialEq + std::fmt::Debug + Default>(
    seeds: impl IntoIterator<Item = u64>,
    mut query: impl FnMut(&mut [Pose; 2], &mut Pcg64Mcg) -> T,
) -> usize {
    let mut found = 0;
    for seed in seeds {
        let (mut skinned, mut rigid) = pairs_of_bodies(seed);
        let answers = [&mut skinned, &mut rigid].map(|bodies| query(bodies, &mut Pcg64Mcg::seed_from_u64(seed)));
        assert_eq!(answers[0], answers[1], "seed {seed}");
        found += usize::from(answers[0] != T::default());
    }
    found
}

#[test]
fn pairs_first_pairs_and_batches() {
    let sorted = |mut pairs: Vec<TrianglePair>| {
        pairs.sort_unstable();
        pairs
    };
    let all = same(0..30, |poses, _| {
        let [a, b] = bodies(poses);
        let mut pairs = Vec::new();
        PairQuery::new().all(a, b, &mut pairs);
        sorted(pairs)
    });
    let mut memory = PairMemory::new();
    let first = same(0..30, |poses, _| {
        let [a, b] = bodies(poses);
        PairQuery::new().first_with(&mut memory, a, b).is_some()
    });
    let batch = same(0..30, |poses, _| {
        let mut tasks = [PairTask::new(0, 1, Wanted::All)];
        let (mut query, mut bodies) = (BatchQuery::new(), bodies(poses));
        let answers = query.run(&mut bodies, &mut tasks, &ThreadWorkers::new(2));
        sorted(answers.get(0).to_vec())
    });
    assert!(all > 25 && first == all && batch == all, "{all} {first} {batch}");
}

#[test]
fn a_remembered_pair_is_found_again_without_any_boxes() {
    let mut query = PairQuery::new();
    let mut remembered = 0;
    for seed in 0..20 {
        let (mut poses, _) = pairs_of_bodies(seed);
        let mut memory = PairMemory::new();
        let mut run = |poses: &mut [Pose; 2]| {
            let [a, b] = bodies(poses);
            (query.first_with(&mut memory, a, b), query.stats())
        };
        let (first, _) = run(&mut poses);
        let Some(first) = first else { continue };
        for pose in &mut poses {
            let nearly = pose.weights()[0] * (1.0 + f32::EPSILON) + 1e-6;
            pose.set_weights(&[nearly]).unwrap();
        }
        let (again, stats) = run(&mut poses);
        assert_eq!(again, Some(first), "seed {seed}");
        assert_eq!((stats.nodes_blended, stats.node_tests), (0, 0), "seed {seed}");
        assert!(stats.vertices_blended > 0, "seed {seed}");
        remembered += 1;
    }
    assert!(remembered > 10, "{remembered}");
}

#[test]
fn self_intersections() {
    let found = same(0..20, |poses, _| {
        let mut pairs = Vec::new();
        SelfQuery::new().all(&mut poses[0], &mut pairs);
        pairs.sort_unstable();
        pairs
    });
    assert!(found > 15, "{found}");
}

#[test]
fn contacts_and_distances() {
    // With mirrored joints, the outer side would differ from triangle to triangle.
    let contacts = same((0..40).step_by(2), |poses, _| {
        let [a, b] = bodies(poses);
        let manifold = ContactQuery::new().manifold(a, b);
        manifold.map(|manifold| manifold.points().iter().map(|p| p.point).collect::<Vec<_>>())
    });
    let distances = same(0..20, |poses, rng| {
        let apart = Affine3A::from_translation(Vec3::X * (20.0 + coarse(rng)));
        let apart = WorldFromModel::new(apart).unwrap();
        // The second body is rigid in both queries.
        let mut other = frozen(&mut poses[1]);
        let [a, _] = bodies(poses);
        let closest = DistanceQuery::new().closest(a, Body::new(&mut other, &apart), f64::INFINITY);
        closest.unwrap().map(|pair| pair.distance.to_bits())
    });
    assert!(contacts > 15 && distances == 20, "{contacts} {distances}");
}

/// The outer side of a mesh that a joint mirrors is that of the same mesh mirrored by its transform.
#[test]
fn mirrored_bodies_keep_their_outer_side() {
    let base = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0, Vec3::Z * 4.0];
    let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
    let influences = Influences {
        joints: &[[0; 4]; 4],
        weights: &[[1.0, 0.0, 0.0, 0.0]; 4],
    };
    let skinned = MorphModel::skinned::<[Vec3; 0]>(&base, &triangles, &[], 1, &[influences]).unwrap();
    let plain = MorphModel::from_displacements::<[Vec3; 0]>(&base, &triangles, &[]).unwrap();
    let [mut skinned, mut plain] =
        [skinned, plain].map(|model| Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))));
    let mut other = plain.clone();
    let beside = WorldFromModel::new(Affine3A::from_translation(Vec3::new(-2.0, 0.5, 0.25))).unwrap();
    for x in [1.0, -1.0] {
        let place = Affine3A::from_scale_rotation_translation(Vec3::new(x, 1.0, 1.0), Quat::IDENTITY, Vec3::ONE / 4.0);
        skinned.set_joints(&JointMatrices::new(&[place]).unwrap()).unwrap();
        let place = WorldFromModel::new(place).unwrap();
        let mut manifold = |pose: &mut Pose| {
            let [a, b] = [Body::new(pose, &place), Body::new(&mut other, &beside)];
            ContactQuery::new().manifold(a, b).unwrap()
        };
        let (of_skinned, of_plain) = (manifold(&mut skinned), manifold(&mut plain));
        assert_eq!(of_skinned, of_plain, "{x}");
        assert!(of_plain.normal.length() > 0.5, "{x}");
    }
}

#[test]
fn rays_and_anchors() {
    let found = same(0..20, |poses, rng| {
        let [mut body, _] = bodies(poses);
        let mut hits = Vec::new();
        for _ in 0..60 {
            let [from, to] = [(); 2].map(|()| (point(rng) * 4.0).as_dvec3());
            let ray = Ray::new(from, to - from + DVec3::X * 1e-3, f64::INFINITY).unwrap();
            let closest = RayQuery::new().closest(body.reborrow(), &ray);
            let any = RayQuery::new().any(body.reborrow(), &ray);
            let mut all = Vec::new();
            RayQuery::new().all(body.reborrow(), &ray, &mut all);
            let anchor = closest.map(|hit| SurfaceAnchor::from(&hit).frame(body.reborrow()));
            hits.push((closest, any, all, anchor));
        }
        hits.retain(|(_, any, ..)| *any);
        hits
    });
    assert!(found > 15, "{found}");
}

#[test]
fn points_shapes_and_regions() {
    let found = same(0..20, |poses, rng| {
        let [mut body, _] = bodies(poses);
        let mut query = ShapeQuery::new();
        let mut answers = Vec::new();
        for _ in 0..20 {
            let at = point(rng);
            let closest = query
                .closest_point(body.reborrow(), at.as_dvec3(), f64::INFINITY)
                .unwrap();
            let shapes = [
                Shape::Ball { radius: 1.5 },
                Shape::Capsule {
                    half_length: 2.0,
                    radius: 0.5,
                },
                Shape::Cuboid {
                    half_extents: Vec3::new(2.0, 1.0, 0.5),
                },
                Shape::HalfSpace { normal: Vec3::Y },
            ];
            let (mut touching, mut casts) = (Vec::new(), Vec::new());
            let direction = point(rng).as_dvec3() + DVec3::new(0.0, 0.0, 8.0);
            for shape in shapes {
                let placed = PlacedShape::new(shape, Quat::from_rotation_z(0.5), at).unwrap();
                casts.push(query.cast(body.reborrow(), &placed, direction, 9.0).unwrap());
                query.all(body.reborrow(), &placed, &mut touching);
                touching.push(u32::MAX);
            }
            touching
                .chunk_by_mut(|&a, &b| a != u32::MAX && b != u32::MAX)
                .for_each(<[u32]>::sort_unstable);
            let planes = [(DVec3::X, 1.0), (DVec3::NEG_X, 1.0), (DVec3::new(0.3, 1.0, 0.2), 0.5)];
            query.all_in_region(
                body.reborrow(),
                &ConvexRegion::from_half_spaces(&planes).unwrap(),
                &mut touching,
            );
            answers.push((closest, touching, casts));
        }
        answers
    });
    assert_eq!(found, 20);
}

#[test]
fn bounds_and_positions() {
    let found = same(0..20, |poses, _| {
        let mut positions = Vec::new();
        poses[0].source_positions(&mut positions);
        let bounds = poses[0].tight_world_bounds(&WORLD);
        let loose = poses[0].world_bounds(&WORLD);
        assert!(loose.contains(bounds.min) && loose.contains(bounds.max));
        Some((positions, bounds.min, bounds.max))
    });
    assert_eq!(found, 20);
}

#[test]
fn at_rest_a_skinned_mesh_is_the_mesh_without_joints() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let base: Vec<Vec3> = (0..60)
        .map(|_| Vec3::from_array([(); 3].map(|()| rng.random_range(-1.0..1.0))))
        .collect();
    let target: Vec<Vec3> = base.iter().map(|p| Vec3::new(p.y, p.z, p.x) * 0.3).collect();
    let triangles: Vec<[u32; 3]> = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    // Weights that sum to exactly 1.
    let weights: Vec<[f32; 4]> = (0..60)
        .map(|i| [1.0 - i as f32 / 64.0, i as f32 / 128.0, i as f32 / 128.0, 0.0])
        .collect();
    let influences = Influences {
        joints: &[[0, 1, 2, 0]; 60],
        weights: &weights,
    };
    let skinned = MorphModel::skinned(&base, &triangles, &[&target], 3, &[influences]).unwrap();
    let plain = MorphModel::from_displacements(&base, &triangles, &[&target]).unwrap();
    let [mut skinned, mut plain] = [skinned, plain].map(|model| {
        let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
        pose.set_weights(&[0.7]).unwrap();
        pose
    });
    for triangle in 0..20 {
        let [a, b] = [&mut skinned, &mut plain].map(|pose| Body::new(pose, &WORLD).triangle(triangle));
        assert_eq!(a, b);
    }
    let ray = Ray::new(DVec3::new(0.1, 0.2, -5.0), DVec3::Z, f64::INFINITY).unwrap();
    let [a, b] = [&mut skinned, &mut plain].map(|pose| {
        let mut hits = Vec::new();
        RayQuery::new().all(Body::new(pose, &WORLD), &ray, &mut hits);
        hits
    });
    assert_eq!(a, b);
    assert!(!a.is_empty());
}

#[test]
fn bad_joints_are_refused_and_the_last_ones_stay() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    let mut pose = skinned(&mut rng);
    let before = joints(&mut rng, true);
    assert!(pose.set_joints(&before).unwrap());
    assert!(!pose.set_joints(&before.clone()).unwrap(), "the same again");
    let few = JointMatrices::new(&[Affine3A::IDENTITY; 2]).unwrap();
    assert_eq!(
        pose.set_joints(&few).unwrap_err().to_string(),
        "2 joints were given, 6 are needed"
    );
    assert_eq!(pose.joints(), Some(&before));
    let mut bad = [Affine3A::IDENTITY; 3];
    bad[1].translation.y = f32::NAN;
    let error = JointMatrices::new(&bad).unwrap_err().to_string();
    assert!(
        error.starts_with("joint 1: translation: coordinate 1 is NaN"),
        "{error}"
    );
    let mut rigid = frozen(&mut pose);
    assert!(rigid.set_joints(&few).unwrap_err().to_string().contains("0 are needed"));
    assert_eq!(rigid.joints(), None);
}
