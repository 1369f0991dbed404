//! Answers that may be off are off by no more than they say.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use morph_collision::{
    ApproximatePose, ApproximateQuery, ApproximateTouch, Approximation, Body, BuildOptions, MorphBvh, PairQuery,
    PartPair, Pose, TrianglePair, VolumeKind, WorldFromModel,
};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::random;
use morph_collision_testkit::oracle;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Two posed blobs: poses, places, and the world-space vertices that they have by definition.
struct Moment {
    mesh: MorphMesh,
    poses: [Pose; 2],
    places: [WorldFromModel; 2],
    vertices: [Vec<DVec3>; 2],
}

impl Moment {
    /// From deep inside each other to apart.
    fn new(seed: u64, volume: VolumeKind) -> Self {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mesh = random::random_blob(3, 1, 4, 0.3);
        let options = BuildOptions::default().with_volume(volume).with_leaf_size(2);
        let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model().unwrap()), &options).unwrap());
        let mut number = |range: std::ops::Range<f32>| rng.random_range(range);
        let affines = [0, 1].map(|body| {
            Affine3A::from_scale_rotation_translation(
                Vec3::new(number(0.5..1.5), number(-1.5..-0.5), number(0.5..1.5)),
                glam::Quat::from_rotation_y(number(-3.0..3.0)),
                Vec3::X * (number(0.0..3.0) * body as f32),
            )
        });
        let weights = [0, 1].map(|_| [0; 4].map(|_| number(-0.5..1.0)));
        let poses = weights.map(|weights| {
            let mut pose = Pose::new(bvh.clone());
            pose.set_weights(&weights).unwrap();
            pose
        });
        let vertices = [0, 1].map(|i| {
            let posed = oracle::posed_vertices(&mesh.positions, &mesh.targets, &weights[i]);
            oracle::world_vertices(&posed, &affines[i])
        });
        Self {
            mesh,
            poses,
            places: affines.map(|affine| WorldFromModel::new(affine).unwrap()),
            vertices,
        }
    }

    fn bodies(&mut self) -> [Body<'_>; 2] {
        let [a, b] = &mut self.poses;
        [Body::new(a, &self.places[0]), Body::new(b, &self.places[1])]
    }

    fn truth(&self) -> BTreeSet<TrianglePair> {
        let triangles = &self.mesh.triangles;
        oracle::intersecting_pairs(&self.vertices[0], triangles, &self.vertices[1], triangles)
            .into_iter()
            .map(|(triangle_a, triangle_b)| TrianglePair { triangle_a, triangle_b })
            .collect()
    }

    /// The largest distance between a corner of one part and a corner of the other.
    fn farthest(&self, parts: &PartPair) -> f64 {
        let corners = |body: usize, triangles: &[u32]| -> Vec<DVec3> {
            let vertex = |v: u32| self.vertices[body][v as usize];
            triangles
                .iter()
                .flat_map(|&t| self.mesh.triangles[t as usize].map(vertex))
                .collect()
        };
        let (a, b) = (corners(0, parts.a.triangles()), corners(1, parts.b.triangles()));
        a.iter()
            .flat_map(|p| b.iter().map(|q| p.distance(*q)))
            .fold(0.0, f64::max)
    }

    fn all(&mut self, limits: &Approximation) -> morph_collision::ApproximatePairs {
        let [a, b] = self.bodies();
        ApproximateQuery::new().all(a, b, limits)
    }
}

fn moments() -> impl Iterator<Item = Moment> {
    VolumeKind::ALL
        .into_iter()
        .flat_map(|volume| (0..12).map(move |seed| Moment::new(seed, volume)))
}

/// The pairs of some parts, none of them twice.
fn pairs_of(parts: &[PartPair]) -> BTreeSet<TrianglePair> {
    let listed: Vec<_> = parts.iter().flat_map(PartPair::pairs).collect();
    let set: BTreeSet<_> = listed.iter().copied().collect();
    assert_eq!(set.len(), listed.len(), "a pair is listed twice");
    assert_eq!(parts.iter().map(PartPair::pair_count).sum::<u64>(), set.len() as u64);
    set
}

#[test]
fn without_limits_the_answer_is_exact_and_says_so() {
    let mut touching = 0;
    for mut moment in moments() {
        let answer = moment.all(&Approximation::new());
        assert!(answer.is_exact());
        let found: BTreeSet<_> = answer.touching.iter().copied().collect();
        assert_eq!(found, moment.truth());
        touching += found.len();
        let [a, b] = moment.bodies();
        let mut exact = Vec::new();
        let stats = PairQuery::new().all(a, b, &mut exact);
        assert_eq!(answer.touching, exact);
        assert_eq!(answer.stats.node_tests, stats.node_tests);
        assert_eq!(answer.stats.triangle_tests, stats.triangle_tests);
    }
    assert!(touching > 1000, "{touching}");
}

#[test]
fn a_tolerance_misses_nothing_and_names_only_what_is_near() {
    let (mut saved, mut near) = (0, 0);
    for mut moment in moments() {
        let truth = moment.truth();
        for tolerance in [0.0, 0.05, 0.4, 2.0, f64::INFINITY] {
            let limits = Approximation::new().with_tolerance(tolerance).unwrap();
            let answer = moment.all(&limits);
            assert!(answer.undecided.is_empty());
            assert!(answer.touching.iter().all(|pair| truth.contains(pair)));
            let listed = pairs_of(&answer.near);
            let touching: BTreeSet<_> = answer.touching.iter().copied().collect();
            assert!(listed.is_disjoint(&touching));
            assert!(
                truth
                    .iter()
                    .all(|pair| touching.contains(pair) || listed.contains(pair))
            );
            for parts in &answer.near {
                assert!(parts.distance <= tolerance);
                assert!(moment.farthest(parts) <= parts.distance);
            }
            near += answer.near.len();
            saved += truth.len() - touching.len();
        }
    }
    assert!(
        saved > 1000 && near > 100,
        "{saved} pairs not looked at in {near} parts"
    );
}

#[test]
fn a_budget_stops_the_work_and_lists_what_is_left() {
    let (mut stopped, mut finished) = (0, 0);
    for mut moment in moments() {
        let truth = moment.truth();
        for budget in [0, 20, 300, 1_000_000] {
            let answer = moment.all(&Approximation::new().with_budget(budget));
            // A step tests at most eight volumes or the pairs of two leaves, which hold two triangles each.
            assert!(answer.stats.node_tests + answer.stats.triangle_tests <= budget + 8);
            let left = pairs_of(&answer.undecided);
            let touching: BTreeSet<_> = answer.touching.iter().copied().collect();
            assert!(left.is_disjoint(&touching));
            assert!(touching.iter().all(|pair| truth.contains(pair)));
            assert!(truth.iter().all(|pair| touching.contains(pair) || left.contains(pair)));
            for parts in &answer.undecided {
                assert!(moment.farthest(parts) <= parts.distance);
            }
            stopped += usize::from(!answer.is_exact());
            finished += usize::from(answer.is_exact());
        }
    }
    assert!(stopped > 20 && finished > 20, "{stopped} stopped, {finished} finished");
}

#[test]
fn whether_bodies_touch_is_never_said_wrongly() {
    let mut seen = [0; 4];
    for mut moment in moments() {
        let truth = moment.truth();
        let limits = [
            Approximation::new(),
            Approximation::new().with_tolerance(2.0).unwrap(),
            Approximation::new().with_budget(30),
            Approximation::new().with_tolerance(2.0).unwrap().with_budget(100),
        ];
        for limits in limits {
            let [a, b] = moment.bodies();
            match ApproximateQuery::new().touch(a, b, &limits).0 {
                ApproximateTouch::Touching(pair) => {
                    seen[0] += 1;
                    assert!(truth.contains(&pair));
                }
                ApproximateTouch::Near(parts) => {
                    seen[1] += 1;
                    assert!(parts.distance <= 2.0 && moment.farthest(&parts) <= parts.distance);
                }
                ApproximateTouch::Apart => {
                    seen[2] += 1;
                    assert!(truth.is_empty());
                }
                ApproximateTouch::Undecided(parts) => {
                    seen[3] += 1;
                    let left = pairs_of(&parts);
                    assert!(truth.is_subset(&left));
                }
            }
        }
    }
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
}

#[test]
fn tolerances_that_are_none_are_refused() {
    for tolerance in [-1.0, f64::NAN] {
        let error = Approximation::new().with_tolerance(tolerance).unwrap_err().to_string();
        assert!(error.contains("tolerance"), "{error}");
    }
}

#[test]
fn an_approximate_pose_is_displaced_by_no_more_than_it_says() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mesh = random::random_blob(3, 1, 12, 0.3);
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model().unwrap()), &BuildOptions::default()).unwrap());
    for tolerance in [0.0, 0.01, 0.2, f64::NAN, -1.0] {
        let mut pose = ApproximatePose::new(bvh.clone(), tolerance);
        let mut weights = [0.0_f32; 12];
        let (mut kept, mut changed, mut left_out) = (0, 0, 0);
        for _ in 0..100 {
            for (target, weight) in weights.iter_mut().enumerate() {
                // Some move much, most tremble.
                *weight += rng.random_range(-1.0..1.0) * if target == 0 { 0.004 } else { 0.0003 };
            }
            let moved = pose.set_weights(&weights).unwrap();
            assert_eq!(pose.weights(), weights);
            *if moved { &mut changed } else { &mut kept } += 1;
            left_out += pose.weights_in_use().iter().filter(|weight| **weight == 0.0).count();
            let mut positions = Vec::new();
            let answer = pose.ask(|pose| pose.source_positions(&mut positions));
            assert!(answer.displacement <= tolerance.max(0.0));
            let truth = oracle::posed_vertices(&mesh.positions, &mesh.targets, &weights);
            for (shown, truth) in positions.iter().zip(&truth) {
                let off = shown.as_dvec3().distance(truth.as_dvec3());
                assert!(off <= answer.displacement, "{off} > {}", answer.displacement);
            }
        }
        if tolerance > 0.0 {
            assert!(
                kept > changed && left_out > 100,
                "{kept} kept, {changed} changed, {left_out} left out"
            );
        } else {
            assert_eq!((kept, left_out), (0, 0));
        }
        let before = pose.weights_in_use().to_vec();
        assert!(pose.set_weights(&[f32::NAN; 12]).is_err());
        assert!(pose.set_weights(&[0.0; 3]).is_err());
        assert_eq!((pose.weights(), pose.weights_in_use()), (&weights[..], &before[..]));
    }
}
