//! Boxes and vertices of skinned meshes under random joints and weights.

use std::sync::Arc;

use glam::{Affine3A, DVec3, EulerRot, Mat3A, Quat, Vec3, Vec3A};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::bounds::{Aabb, BoxLanes, CenteredLanes, LANES};
use crate::{
    Body, BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, PairQuery, Pose, TrianglePair, WorldFromModel,
    triangles_intersect,
};

const JOINTS: usize = 7;
/// Enough for several chunks.
const RINGS: usize = 60;
const SIDES: usize = 6;

/// The kind of joint weights of the vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Weights {
    /// Two joints per vertex, with weights that sum to 1.
    Smooth,
    /// One joint per vertex.
    Rigid,
    /// Four joints drawn at random, with any sum.
    Random,
}

/// A tube along x with joints along it and two targets.
fn tube(kind: Weights, rng: &mut Pcg64Mcg) -> Arc<MorphBvh> {
    let (mut base, mut joints, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for ring in 0..RINGS {
        for side in 0..SIDES {
            let angle = side as f32 / SIDES as f32 * std::f32::consts::TAU;
            let along = ring as f32 / RINGS as f32 * JOINTS as f32;
            base.push(Vec3::new(along, angle.cos() * 0.4, angle.sin() * 0.4));
            let joint = (along.floor() as u16).min(JOINTS as u16 - 1);
            let next = (joint + 1).min(JOINTS as u16 - 1);
            let share = along.fract();
            let (j, w) = match kind {
                Weights::Smooth => ([joint, next, 0, 0], [1.0 - share, share, 0.0, 0.0]),
                Weights::Rigid => ([joint, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]),
                Weights::Random => (
                    [(); 4].map(|()| rng.random_range(0..JOINTS as u16)),
                    [(); 4].map(|()| {
                        if rng.random_bool(0.4) {
                            rng.random_range(0.0..0.8)
                        } else {
                            0.0
                        }
                    }),
                ),
            };
            joints.push(j);
            weights.push(w);
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..RINGS as u32 - 1 {
        for side in 0..SIDES as u32 {
            let at = |ring: u32, side: u32| ring * SIDES as u32 + side % SIDES as u32;
            let [a, b, c, d] = [
                at(ring, side),
                at(ring, side + 1),
                at(ring + 1, side),
                at(ring + 1, side + 1),
            ];
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    let bulge: Vec<Vec3> = base
        .iter()
        .map(|p| Vec3::new(0.0, p.y, p.z) * (p.x * 2.0).sin())
        .collect();
    let lift: Vec<Vec3> = base
        .iter()
        .map(|p| if p.x > 5.0 { Vec3::Y * 0.3 } else { Vec3::ZERO })
        .collect();
    let influences = Influences {
        joints: &joints,
        weights: &weights,
    };
    let model = MorphModel::skinned(&base, &triangles, &[bulge, lift], JOINTS, &[influences]).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
}

/// A chain of joints, each rotated relative to the previous one.
fn bent(rng: &mut Pcg64Mcg, angle: f32, scale: [f32; 2], at: Vec3) -> JointMatrices {
    let mut parent = Affine3A::from_translation(at);
    let mut all = Vec::new();
    for joint in 0..JOINTS {
        let [x, y, z] = [(); 3].map(|()| {
            if angle > 0.0 {
                rng.random_range(-angle..angle)
            } else {
                0.0
            }
        });
        let turn = Quat::from_euler(EulerRot::XYZ, x, y, z);
        let size = Vec3::from_array([(); 3].map(|()| {
            if scale[0] < scale[1] {
                rng.random_range(scale[0]..scale[1])
            } else {
                scale[0]
            }
        }));
        let local = Affine3A::from_scale_rotation_translation(size, turn, Vec3::X * f32::from(joint > 0));
        parent *= local;
        all.push(parent * Affine3A::from_translation(Vec3::NEG_X * joint as f32));
    }
    JointMatrices::new(&all).unwrap()
}

/// Turned, scaled, mirrored and sheared, near the origin and far away.
fn spaces() -> [WorldFromModel; 3] {
    let turned = Quat::from_euler(EulerRot::XYZ, 0.4, -2.0, 1.1);
    let mut sheared = Affine3A::from_scale_rotation_translation(Vec3::new(1e-2, 3.0, 0.7), turned, Vec3::splat(1e3));
    sheared.matrix3.y_axis += 0.5 * sheared.matrix3.z_axis;
    [
        Affine3A::from_rotation_translation(turned, Vec3::new(1.0, -2.0, 0.5)),
        Affine3A::from_scale_rotation_translation(Vec3::new(-2.0, 2.0, 2.0), turned, Vec3::ZERO),
        sheared,
    ]
    .map(|place| WorldFromModel::new(place).unwrap())
}

/// The point that a map takes to a place in the world, and a bound on its rounding error.
fn preimage(map: &WorldFromModel, world: DVec3) -> (DVec3, f64) {
    let (inverse, offset) = (map.linear().inverse(), world - map.translation());
    let rounded = inverse.abs() * DVec3::splat(world.abs().max(map.translation().abs()).max_element());
    (inverse * offset, 1e-14 * rounded.max_element())
}

/// Fails if a vertex is outside the box of any node above it, or outside the bounds of the whole body in any space.
fn check_boxes(pose: &mut Pose) {
    let place = WorldFromModel::IDENTITY;
    for bounds in [pose.world_bounds(&place), pose.broad_phase_bounds(&place)] {
        for triangle in 0..pose.bvh().model().triangle_count() as u32 {
            for point in Body::new(pose, &place).triangle(triangle).unwrap() {
                let is_in = point.cmple(bounds.max.as_dvec3()) & point.cmpge(bounds.min.as_dvec3());
                assert!(is_in.all(), "{triangle}: {point} outside {bounds:?}");
            }
        }
    }
    let mut boxes = Vec::new();
    let all: Vec<u32> = (0..pose.bvh().model().triangle_count() as u32).collect();
    for place in spaces() {
        boxes.push((pose.local_bounds(&place), place, all.clone()));
    }
    pose.visit_nodes(|node| {
        boxes.push((node.bounds, node.world_from_bounds.unwrap(), node.triangles.to_vec()));
        true
    });
    for (bounds, world_from_bounds, triangles) in boxes {
        for triangle in triangles {
            for corner in Body::new(pose, &place).triangle(triangle).unwrap() {
                let (point, slack) = preimage(&world_from_bounds, corner);
                let is_in = (point - slack).cmple(bounds.max.as_dvec3()) & (point + slack).cmpge(bounds.min.as_dvec3());
                assert!(is_in.all(), "{triangle}: {point} outside {bounds:?}");
            }
        }
    }
}

fn brute_force(a: &mut Pose, b: &mut Pose) -> Vec<TrianglePair> {
    let place = WorldFromModel::IDENTITY;
    let triangles = |pose: &mut Pose| -> Vec<_> {
        let count = pose.bvh().model().triangle_count() as u32;
        (0..count)
            .map(|t| Body::new(pose, &place).triangle(t).unwrap())
            .collect()
    };
    let (of_a, of_b) = (triangles(a), triangles(b));
    let mut pairs = Vec::new();
    for (triangle_a, a) in (0..).zip(&of_a) {
        for (triangle_b, b) in (0..).zip(&of_b) {
            if triangles_intersect(a, b) {
                pairs.push(TrianglePair { triangle_a, triangle_b });
            }
        }
    }
    pairs
}

#[test]
fn boxes_hold_every_vertex_and_pairs_are_those_of_brute_force() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut touching = 0;
    for kind in [Weights::Smooth, Weights::Rigid, Weights::Random] {
        let bvh = tube(kind, &mut rng);
        let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
        for case in 0..12 {
            let (angle, scale) = [(0.3, [1.0; 2]), (2.1, [1.0; 2]), (0.8, [0.0, 2.0]), (0.0, [0.0; 2])][case % 4];
            let at = if case / 4 == 1 {
                Vec3::new(1e4, -300.0, 7.0)
            } else {
                Vec3::ZERO
            };
            for pose in [&mut a, &mut b] {
                pose.set_joints(&bent(&mut rng, angle, scale, at)).unwrap();
                let weights = [rng.random_range(-2.0..12.0), rng.random_range(-1.0..1.0)];
                pose.set_weights(&weights).unwrap();
                check_boxes(pose);
            }
            let place = WorldFromModel::IDENTITY;
            let mut pairs = Vec::new();
            PairQuery::new().all(Body::new(&mut a, &place), Body::new(&mut b, &place), &mut pairs);
            pairs.sort_unstable();
            assert_eq!(pairs, brute_force(&mut a, &mut b), "{kind:?}, case {case}");
            touching += usize::from(!pairs.is_empty());
            let refit = [Pose::refit, Pose::refit_lazily].get(case % 3);
            if let Some(refit) = refit {
                // None of its vertices is posed yet.
                let mut refitted = Pose::new(a.bvh().clone());
                refitted.set_joints(a.joints().unwrap()).unwrap();
                refitted.set_weights(a.weights()).unwrap();
                refit(&mut refitted);
                check_boxes(&mut refitted);
                let mut of_refitted = Vec::new();
                let [body_a, body_b] = [&mut refitted, &mut b].map(|pose| Body::new(pose, &place));
                PairQuery::new().all(body_a, body_b, &mut of_refitted);
                of_refitted.sort_unstable();
                assert_eq!(of_refitted, pairs, "{kind:?}, case {case}");
            }
        }
    }
    assert!(touching > 15, "{touching}");
}

#[test]
fn a_skinned_vertex_is_as_defined() {
    let base = [Vec3::new(1.0, 2.0, 3.0), Vec3::X, Vec3::Y];
    let influences = Influences {
        joints: &[[1, 0, 1, 9], [0; 4], [1; 4]],
        weights: &[[0.5, 0.25, 0.125, 0.0], [0.0; 4], [1.0, 0.0, 0.0, 0.0]],
    };
    let lift = vec![Vec3::Z; 3];
    let model = MorphModel::skinned(&base, &[[0, 1, 2]], &[lift], 2, &[influences]).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    let turned = Affine3A {
        matrix3: Mat3A::from_cols(Vec3A::Y, Vec3A::Z, Vec3A::X),
        translation: Vec3A::new(10.0, 20.0, 30.0),
    };
    pose.set_joints(&JointMatrices::new(&[Affine3A::from_scale(Vec3::splat(2.0)), turned]).unwrap())
        .unwrap();
    pose.set_weights(&[1.0]).unwrap();
    let place = WorldFromModel::IDENTITY;
    let mut body = Body::new(&mut pose, &place);
    // (1, 2, 4) with 5/8 of the second joint, which takes it to (14, 21, 32), and 1/4 of the first, which doubles it.
    let expected = DVec3::new(14.0, 21.0, 32.0) * 0.625 + DVec3::new(2.0, 4.0, 8.0) * 0.25;
    assert_eq!(body.vertex(0), Some(expected));
    assert_eq!(body.vertex(1), Some(DVec3::ZERO), "no influences: the world's origin");
    assert_eq!(body.vertex(2), Some(DVec3::new(11.0, 20.0, 31.0)));
    assert_eq!(body.vertex(3), None);
}

/// If weights do not quite sum to 1, vertices are pulled towards the world's origin.
#[test]
fn boxes_are_right_wherever_a_body_goes() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let tube = tube(Weights::Rigid, &mut rng);
    let model = tube.model();
    let base: Vec<Vec3> = (0..model.vertex_count() as u32).map(|v| model.base(v)).collect();
    let triangles: Vec<_> = (0..model.triangle_count() as u32).map(|t| model.corners(t)).collect();
    let influences = Influences {
        joints: &vec![[0; 4]; base.len()],
        weights: &vec![[1.0 - 1.2e-7, 0.0, 0.0, 0.0]; base.len()],
    };
    let model = MorphModel::skinned::<[Vec3; 0]>(&base, &triangles, &[], 1, &[influences]).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    for x in [0.0, 1.0, 1024.0, 1500.0, 1e6, 1.0] {
        let joint = Affine3A::from_translation(Vec3::X * x);
        pose.set_joints(&JointMatrices::new(&[joint]).unwrap()).unwrap();
        check_boxes(&mut pose);
    }
}

/// A body with coordinates up to about 8e39 in the world, which a box in `f32` cannot have.
#[test]
fn boxes_of_huge_weights_hold_their_vertices() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let base: Vec<Vec3> = (0..1800)
        .map(|_| Vec3::from_array([(); 3].map(|()| rng.random_range(5e35..1e36))))
        .collect();
    let influences = Influences {
        joints: &vec![[0, 1, 2, 0]; base.len()],
        weights: &vec![[900.0, 800.0, 800.0, 0.0]; base.len()],
    };
    let triangles: Vec<[u32; 3]> = (0..base.len() as u32 / 3)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let model = MorphModel::skinned::<[Vec3; 0]>(&base, &triangles, &[], 3, &[influences]).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    for (scale, is_endless) in [(1.0, true), (1e-6, false), (1.0, true)] {
        let joints = [1.0, 3.0, 2.0].map(|of| Affine3A::from_scale(Vec3::splat(of * scale)));
        pose.set_joints(&JointMatrices::new(&joints).unwrap()).unwrap();
        for refit in [|_: &mut Pose| (), Pose::refit, Pose::refit_lazily] {
            refit(&mut pose);
            check_boxes(&mut pose);
            pose.visit_nodes(|node| {
                let is_whole = node.bounds == Aabb::UNBOUNDED;
                // Refitted groups above the chunks have the hulls of infinite boxes.
                assert_eq!(is_whole, is_endless, "{:?} at depth {}", node.bounds, node.depth);
                true
            });
        }
    }
}

/// Every state that a pose may be in, for a mesh with joints and for one without.
fn states(rng: &mut Pcg64Mcg) -> Vec<Pose> {
    let bvhs = [(); 2].map(|()| tube(Weights::Smooth, rng));
    let joints = [0.2, 0.4].map(|angle| bent(rng, angle, [1.0, 1.0], Vec3::ZERO));
    let mesh = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let plain = MorphModel::from_displacements(&mesh, &[[0, 1, 2]], &[[Vec3::Z; 3], [Vec3::X; 3]]).unwrap();
    let plain = Arc::new(MorphBvh::build(Arc::new(plain), &BuildOptions::default()));
    let mut states = Vec::new();
    for weights in [[0.0, 0.5], [0.25, 0.0]] {
        for is_refitted in [false, true] {
            let mut add = |mut pose: Pose, joints: Option<&JointMatrices>| {
                if let Some(joints) = joints {
                    pose.set_joints(joints).unwrap();
                }
                pose.set_weights(&weights).unwrap();
                if is_refitted {
                    pose.refit();
                }
                states.push(pose);
            };
            add(Pose::new(plain.clone()), None);
            for bvh in &bvhs {
                for joints in &joints {
                    add(Pose::new(bvh.clone()), Some(joints));
                }
            }
        }
    }
    states
}

#[test]
fn a_copy_takes_every_state_of_a_pose_and_then_keeps_what_it_has_blended() {
    let states = states(&mut Pcg64Mcg::seed_from_u64(21));
    let place = WorldFromModel::IDENTITY;
    for before in &states {
        for pose in &states {
            let mut copy = Some(before.clone());
            let copied = Pose::copied(&mut copy, pose);
            assert!(Arc::ptr_eq(copied.bvh(), pose.bvh()));
            assert_eq!((copied.weights(), copied.joints()), (pose.weights(), pose.joints()));
            assert_eq!(copied.world_bounds(&place), pose.clone().world_bounds(&place));
            let (blended, of_pose) = (copied.posed().blended(), pose.clone().posed().blended());
            let again = Pose::copied(&mut copy, pose);
            assert_eq!(again.posed().blended(), blended);
            assert!(blended.volumes >= of_pose.volumes);
        }
    }
}

#[test]
fn a_broad_phase_follows_weights_and_blends_no_node() {
    let mut rng = Pcg64Mcg::seed_from_u64(22);
    let mut pose = Pose::new(tube(Weights::Smooth, &mut rng));
    let place = WorldFromModel::IDENTITY;
    for weights in [[0.0, 0.0], [0.0, 20.0], [5.0, 0.0]] {
        pose.set_weights(&weights).unwrap();
        let bounds = pose.broad_phase_bounds(&place);
        let tight = pose.tight_world_bounds(&place);
        assert_eq!(bounds.union(&tight), bounds, "{weights:?}");
        let (size, least) = (bounds.size().max_element(), tight.size().max_element());
        assert!(size < 2.0 * least, "{weights:?}: {size}, {least}");
    }
    assert_eq!(pose.posed().blended().volumes, 0);
}

#[test]
fn a_box_in_a_space_that_turns_with_the_joints_stays_the_same() {
    let mut rng = Pcg64Mcg::seed_from_u64(25);
    let mut pose = Pose::new(tube(Weights::Smooth, &mut rng));
    let joints = bent(&mut rng, 0.1, [1.0, 1.0], Vec3::new(1.0, 2.0, 0.0));
    let still: Vec<Affine3A> = (0..JOINTS as u16)
        .map(|joint| {
            let [x, y, z, at] = joints.columns(joint).map(DVec3::as_vec3);
            Affine3A::from_cols(x.into(), y.into(), z.into(), at.into())
        })
        .collect();
    pose.set_joints(&joints).unwrap();
    let expected = pose.world_bounds(&WorldFromModel::IDENTITY);
    for turn in [0.0, 1.6, 4.0, 0.8] {
        // Joints and space move together, which does not change what the space sees.
        let moved = Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(5.0, 0.0, -3.0));
        let turned: Vec<Affine3A> = still.iter().map(|joint| moved * *joint).collect();
        pose.set_joints(&JointMatrices::new(&turned).unwrap()).unwrap();
        let bounds = pose.local_bounds(&WorldFromModel::new(moved).unwrap());
        let off = (bounds.min - expected.min).abs().max((bounds.max - expected.max).abs());
        assert!(off.max_element() < 1e-4, "{turn}: {bounds:?}, {expected:?}");
    }
    // Along the world's axes, it grows.
    let turned = pose.world_bounds(&WorldFromModel::IDENTITY).size().element_product();
    assert!(turned > 1.5 * expected.size().element_product(), "{turned}");
}

#[test]
fn a_mesh_without_joints_has_the_same_local_bounds_everywhere() {
    let no_targets: [Vec<Vec3>; 0] = [];
    let model = MorphModel::from_displacements(&Vec3::AXES, &[[0, 1, 2]], &no_targets).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    let expected = pose.bounds();
    for place in spaces() {
        assert_eq!(pose.local_bounds(&place), expected);
    }
}

#[test]
fn a_space_that_cannot_be_inverted_has_an_infinite_box() {
    let mut pose = Pose::new(tube(Weights::Smooth, &mut Pcg64Mcg::seed_from_u64(26)));
    let flat = WorldFromModel::new(Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))).unwrap();
    assert_eq!(pose.local_bounds(&flat), Aabb::UNBOUNDED);
}

/// Its root is a leaf.
#[test]
fn the_box_of_a_single_skinned_triangle_is_the_smallest() {
    let base = [Vec3::ZERO, Vec3::new(1.0, 2.0, 0.0), Vec3::new(-1.0, 1.0, 3.0)];
    let influences = Influences {
        joints: &[[0, 1, 0, 0]; 3],
        weights: &[[0.5, 0.5, 0.0, 0.0]; 3],
    };
    let no_targets: [Vec<Vec3>; 0] = [];
    let model = MorphModel::skinned(&base, &[[0, 1, 2]], &no_targets, 2, &[influences]).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    let joint = |at: f32| Affine3A::from_rotation_translation(Quat::from_rotation_y(at), Vec3::splat(at));
    pose.set_joints(&JointMatrices::new(&[joint(0.1), joint(0.3)]).unwrap())
        .unwrap();
    for is_refitted in [false, true] {
        if is_refitted {
            pose.refit();
        }
        check_boxes(&mut pose);
        let mut boxes = 0;
        pose.visit_nodes(|node| {
            let size = node.bounds.size();
            assert!(size.cmpgt(Vec3::splat(0.5)).all() && size.cmplt(Vec3::splat(4.0)).all());
            boxes += 1;
            true
        });
        assert_eq!(boxes, 1);
    }
}

#[test]
fn the_memory_of_a_skinned_pose_grows_with_what_was_visited() {
    let mut pose = Pose::new(tube(Weights::Smooth, &mut Pcg64Mcg::seed_from_u64(23)));
    let place = WorldFromModel::IDENTITY;
    let vertices = pose.bvh().model().vertex_count();
    let groups = pose.posed().topology.group_count();
    pose.set_weights(&[0.1, 0.2]).unwrap();
    let mut before = pose.bytes();
    // Stamps of groups, and room for the parts of those above the chunks.
    assert!((8 * groups..8 * groups + 500).contains(&before), "{before}");
    let mut grows = |pose: &Pose, least: usize| {
        let by = pose.bytes() - before;
        assert!((least..=least + least / 8).contains(&by), "{by}, {least}");
        before += by;
    };
    // These weights move little, so the boxes at rest do.
    pose.broad_phase_bounds(&place);
    grows(&pose, 0);
    pose.set_weights(&[10.0, 20.0]).unwrap();
    pose.broad_phase_bounds(&place);
    grows(&pose, JOINTS.div_ceil(LANES) * size_of::<CenteredLanes>());
    // The first vertex reserves room for all.
    pose.vertex(0);
    grows(&pose, 48 * vertices);
    assert_eq!(pose.posed().blended().vertices, LANES as u64);
    pose.tight_world_bounds(&place);
    grows(&pose, 0);
    assert_eq!(pose.posed().blended().vertices, vertices as u64);
    let bytes = pose.bytes();
    pose.visit_nodes(|_| true);
    assert!(pose.bytes() >= bytes + groups * size_of::<BoxLanes>());
    // New values take the place of old ones.
    let bytes = pose.bytes();
    pose.set_weights(&[0.5, 0.5]).unwrap();
    pose.visit_nodes(|_| true);
    pose.tight_world_bounds(&place);
    assert_eq!(pose.bytes(), bytes);
}

#[test]
fn a_skinned_body_is_rounded_by_what_its_boxes_were_widened() {
    let mut rng = Pcg64Mcg::seed_from_u64(24);
    let mut pose = Pose::new(tube(Weights::Smooth, &mut rng));
    let joints = bent(&mut rng, 0.3, [1.0, 1.0], Vec3::X * 100.0);
    pose.set_joints(&joints).unwrap();
    let mut posed = pose.posed();
    posed.bounds();
    let rounding = posed.rounding(0.0);
    assert!((1e-6..1e-2).contains(&rounding), "{rounding}");
}
