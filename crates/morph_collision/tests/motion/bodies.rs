//! Contacts during motions, checked against every pair of features.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3A, Quat, Vec3, Vec3A};
use morph_collision::motion::{
    Features, MotionContact, MotionQuery, MovingBody, MovingPoint, TimeOfImpact, edge_edge_impact, vertex_face_impact,
};
use morph_collision::{
    Body, BuildOptions, ContactQuery, Influences, JointMatrices, MorphBvh, MorphModel, Pose, TrianglePair,
    WorldFromModel, triangle_contact,
};
use morph_collision_testkit::motion::{ElementaryMotion, MotionKind};
use morph_collision_testkit::verify::touch_geometry;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const TRIANGLES: usize = 60;
const JOINTS: usize = 4;
pub(super) const TOLERANCE: f64 = 1e-6;

pub(super) fn vector(rng: &mut Pcg64Mcg, size: f32) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| rng.random_range(-size..size)))
}

/// Small triangles in a cube with sides of 4, some of which share vertices, with two targets.
pub(super) fn model(rng: &mut Pcg64Mcg, is_skinned: bool) -> MorphModel {
    let (mut base, mut triangles) = (Vec::new(), Vec::new());
    while triangles.len() < TRIANGLES {
        let at = vector(rng, 2.0);
        let first = base.len() as u32;
        base.extend([(); 4].map(|()| at + vector(rng, 0.5)));
        triangles.extend([[first, first + 1, first + 2], [first + 2, first + 1, first + 3]]);
    }
    let targets = [(); 2].map(|()| base.iter().map(|_| vector(rng, 0.5)).collect::<Vec<_>>());
    if !is_skinned {
        return MorphModel::from_displacements(&base, &triangles, &targets).unwrap();
    }
    let joints: Vec<[u16; 4]> = base
        .iter()
        .map(|_| [(); 4].map(|()| rng.random_range(0..JOINTS as u16)))
        .collect();
    let weights: Vec<[f32; 4]> = base
        .iter()
        .map(|_| {
            let share = rng.random_range(0.0..1.0);
            [share, 1.0 - share, 0.0, 0.0]
        })
        .collect();
    let influences = Influences {
        joints: &joints,
        weights: &weights,
    };
    MorphModel::skinned(&base, &triangles, &targets, JOINTS, &[influences]).unwrap()
}

fn affine(rng: &mut Pcg64Mcg, at: Vec3, turn: f32) -> Affine3A {
    let axis = vector(rng, 1.0).try_normalize().unwrap_or(Vec3::X);
    let turn = Quat::from_axis_angle(axis, rng.random_range(-turn..turn));
    let kind = rng.random_range(0..8);
    let scale = match kind {
        0 => Vec3::new(1.0, 1.0, -1.0),
        1 => Vec3::new(1.5, 0.5, 1.0),
        2 => Vec3::new(1.0, 0.0, 1.0),
        3 => Vec3::splat(1e-3),
        _ => Vec3::ONE,
    };
    Affine3A {
        matrix3: Mat3A::from_quat(turn) * Mat3A::from_diagonal(scale),
        translation: Vec3A::from(at),
    }
}

/// A body at the start and at the end of a step.
#[derive(Clone)]
pub(super) struct Step {
    poses: [Pose; 2],
    places: [WorldFromModel; 2],
}

impl Step {
    /// A random step between two places, each up to 1 off.
    pub(super) fn new(rng: &mut Pcg64Mcg, model: &Arc<MorphModel>, leaf_size: usize, at: [Vec3; 2]) -> Self {
        let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
        let bvh = Arc::new(MorphBvh::build(model.clone(), &options));
        let mut places = [WorldFromModel::IDENTITY; 2];
        let turn = rng.random_range(0.0..3.2_f32) + 1e-3;
        let poses = [0, 1].map(|end| {
            let mut pose = Pose::new(bvh.clone());
            let weights = [(); 2].map(|()| rng.random_range(-1.0..2.0));
            pose.set_weights(&weights).unwrap();
            let near = at[end] + vector(rng, 1.0);
            let place = affine(rng, near, turn);
            places[end] = WorldFromModel::new(place).unwrap();
            if model.joint_count().is_some() {
                let joints: Vec<Affine3A> = (0..JOINTS)
                    .map(|_| {
                        let joint = affine(rng, at[end], turn);
                        joint * Affine3A::from_translation(vector(rng, 0.5))
                    })
                    .collect();
                pose.set_joints(&JointMatrices::new(&joints).unwrap()).unwrap();
            }
            pose
        });
        Self { poses, places }
    }

    /// A step from one place to another.
    pub(super) fn between(poses: [Pose; 2], places: [WorldFromModel; 2]) -> Self {
        Self { poses, places }
    }

    pub(super) fn moving(&mut self) -> MovingBody<'_> {
        let [start, end] = &mut self.poses;
        MovingBody::new(Body::new(start, &self.places[0]), Body::new(end, &self.places[1])).unwrap()
    }

    fn point(&mut self, vertex: u32) -> MovingPoint {
        let [start, end] = [0, 1].map(|end| {
            let mut body = Body::new(&mut self.poses[end], &self.places[end]);
            body.vertex(vertex).unwrap()
        });
        MovingPoint { start, end }
    }

    pub(super) fn points(&mut self) -> Vec<MovingPoint> {
        let vertices = self.poses[0].bvh().model().vertex_count() as u32;
        (0..vertices).map(|vertex| self.point(vertex)).collect()
    }

    pub(super) fn faces(&self) -> Vec<[u32; 3]> {
        let model = self.poses[0].bvh().model();
        (0..model.triangle_count() as u32)
            .map(|triangle| model.triangle(triangle).unwrap())
            .collect()
    }

    pub(super) fn edges(&self) -> BTreeSet<[u32; 2]> {
        let of_face = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
        self.faces()
            .into_iter()
            .flat_map(of_face)
            .filter(|[a, b]| a != b)
            .collect()
    }
}

/// What touches, and when.
type Timed = (Features, TimeOfImpact);

/// Every pair of features of two bodies that touch, ascending, with the time.
fn brute_force(a: &mut Step, b: &mut Step) -> Vec<Timed> {
    let (points_a, points_b) = (a.points(), b.points());
    let at = |points: &[MovingPoint], vertex: u32| points[vertex as usize];
    let mut found = Vec::new();
    let mut add = |features, time: Option<_>| found.extend(time.map(|time| (features, time)));
    for (triangle_b, face) in b.faces().into_iter().enumerate() {
        for (vertex_a, point) in points_a.iter().enumerate() {
            let time = vertex_face_impact(*point, face.map(|vertex| at(&points_b, vertex)), TOLERANCE);
            let (vertex_a, triangle_b) = (vertex_a as u32, triangle_b as u32);
            add(Features::VertexFace { vertex_a, triangle_b }, time);
        }
    }
    for (triangle_a, face) in a.faces().into_iter().enumerate() {
        for (vertex_b, point) in points_b.iter().enumerate() {
            let time = vertex_face_impact(*point, face.map(|vertex| at(&points_a, vertex)), TOLERANCE);
            let (triangle_a, vertex_b) = (triangle_a as u32, vertex_b as u32);
            add(Features::FaceVertex { triangle_a, vertex_b }, time);
        }
    }
    let edges_b = b.edges();
    for edge_a in a.edges() {
        for &edge_b in &edges_b {
            let ends = [
                edge_a.map(|vertex| at(&points_a, vertex)),
                edge_b.map(|vertex| at(&points_b, vertex)),
            ];
            add(
                Features::EdgeEdge { edge_a, edge_b },
                edge_edge_impact(ends[0], ends[1], TOLERANCE),
            );
        }
    }
    found.sort_by_key(|contact| contact.0);
    found
}

fn sorted(contacts: &[MotionContact]) -> Vec<Timed> {
    let mut timed: Vec<_> = contacts
        .iter()
        .map(|contact| (contact.features, contact.time))
        .collect();
    timed.sort_by_key(|contact| contact.0);
    timed
}

/// Asserts that points, normals and velocities fit the motions of the vertices.
fn assert_geometry(contacts: &[MotionContact], [a, b]: [&mut Step; 2]) {
    let (points_a, points_b) = (a.points(), b.points());
    let (faces_a, faces_b) = (a.faces(), b.faces());
    for contact in contacts {
        let at = |points: &[MovingPoint], vertex: u32| points[vertex as usize];
        let face = |points: &[MovingPoint], face: [u32; 3]| face.map(|vertex| at(points, vertex));
        let (kind, corners) = match contact.features {
            Features::VertexFace { vertex_a, triangle_b } => {
                let [p, q, r] = face(&points_b, faces_b[triangle_b as usize]);
                (MotionKind::VertexFace, [at(&points_a, vertex_a), p, q, r])
            }
            Features::FaceVertex { triangle_a, vertex_b } => {
                let [p, q, r] = face(&points_a, faces_a[triangle_a as usize]);
                (MotionKind::VertexFace, [at(&points_b, vertex_b), p, q, r])
            }
            Features::EdgeEdge { edge_a, edge_b } => {
                let ([p, q], [r, s]) = (
                    edge_a.map(|vertex| at(&points_a, vertex)),
                    edge_b.map(|vertex| at(&points_b, vertex)),
                );
                (MotionKind::EdgeEdge, [p, q, r, s])
            }
            Features::AtStart(_) => continue,
        };
        let points = corners.map(|corner| [corner.start, corner.end].map(|p| p.to_array()));
        let fault = touch_geometry(contact).fault(&ElementaryMotion { kind, points });
        assert_eq!(fault, None, "{contact:?} {points:?}");
    }
}

/// Bodies that meet, pass by, or stand still, near the origin or far away.
fn steps(rng: &mut Pcg64Mcg) -> [Step; 2] {
    let far = if rng.random_bool(0.2) {
        vector(rng, 1e4)
    } else {
        Vec3::ZERO
    };
    let common = if rng.random_bool(0.3) {
        vector(rng, 100.0)
    } else {
        Vec3::ZERO
    };
    [(); 2].map(|()| {
        let is_skinned = rng.random_bool(0.3);
        let model = Arc::new(model(rng, is_skinned));
        let leaf_size = [1, 3, 8, 20][rng.random_range(0..4)];
        let at = [far + vector(rng, 4.0), far + common + vector(rng, 4.0)];
        Step::new(rng, &model, leaf_size, at)
    })
}

#[test]
fn contacts_are_those_of_all_pairs_of_features() {
    let mut rng = Pcg64Mcg::seed_from_u64(61);
    let (mut query, mut touching, mut apart, mut tests, mut all) = (MotionQuery::new(), 0, 0, 0, 0);
    let (mut exactly_first, mut approximately_first) = (0, 0);
    for case in 0..60 {
        let [mut a, mut b] = steps(&mut rng);
        let truth = brute_force(&mut a, &mut b);
        let mut found = Vec::new();
        query.all(a.moving(), b.moving(), TOLERANCE, &mut found).unwrap();
        tests += query.stats().feature_tests;
        all +=
            a.points().len() * b.faces().len() + a.faces().len() * b.points().len() + a.edges().len() * b.edges().len();
        assert_eq!(sorted(&found), truth, "case {case}");
        assert_geometry(&found, [&mut a, &mut b]);
        touching += truth.len();
        apart += usize::from(truth.is_empty());
        // `any` and `first` also see what intersects at the start.
        let at_start = morph_collision::PairQuery::new().any(
            Body::new(&mut a.poses[0], &a.places[0]),
            Body::new(&mut b.poses[0], &b.places[0]),
        );
        assert_eq!(
            query.any(a.moving(), b.moving()),
            Ok(at_start || !truth.is_empty()),
            "case {case}"
        );
        let first = query.first(a.moving(), b.moving(), TOLERANCE).unwrap();
        match first.map(|contact| contact.features) {
            Some(Features::AtStart(TrianglePair { .. })) => assert!(at_start),
            Some(features) => {
                assert!(!at_start, "case {case}");
                let time = first.unwrap().time;
                // Among equal times, the features decide, unless there are very many.
                let order = |x: &&Timed, y: &&Timed| {
                    let times = |of: &Timed| (of.1.latest, of.1.earliest);
                    times(x).partial_cmp(&times(y)).unwrap().then(x.0.cmp(&y.0))
                };
                let earliest = truth.iter().min_by(order).copied().unwrap();
                if (features, time) == earliest {
                    exactly_first += 1;
                } else {
                    let own = truth.iter().find(|contact| contact.0 == features).unwrap().1;
                    assert!(
                        time.earliest <= own.earliest && own.latest <= time.latest,
                        "case {case}"
                    );
                    assert!(time.latest - time.earliest <= TOLERANCE, "case {case}");
                    assert!(time.earliest <= earliest.1.earliest, "case {case}");
                    approximately_first += 1;
                }
            }
            None => assert!(!at_start && truth.is_empty(), "case {case}"),
        }
    }
    println!("{touching} contacts, {apart} cases apart, {tests} of {all} pairs of features tested");
    assert!(
        touching > 1000 && apart > 5,
        "{touching} contacts, {apart} cases without any"
    );
    assert!(
        exactly_first > 10 && approximately_first < exactly_first / 5,
        "{exactly_first}, {approximately_first}"
    );
    assert!(tests < all as u64 / 10, "{tests} of {all} pairs of features tested");
}

#[test]
fn a_body_touches_itself_where_brute_force_says() {
    let mut rng = Pcg64Mcg::seed_from_u64(62);
    let (mut query, mut touching) = (MotionQuery::new(), 0);
    for case in 0..20 {
        let is_skinned = rng.random_bool(0.3);
        let model = Arc::new(model(&mut rng, is_skinned));
        let at = if case % 4 == 0 { Vec3::splat(1e5) } else { Vec3::ZERO };
        let mut body = Step::new(&mut rng, &model, [1, 8][case % 2], [at, at]);
        let (points, faces, edges) = (body.points(), body.faces(), body.edges());
        let mut truth = Vec::new();
        let mut add = |features, time: Option<_>| truth.extend(time.map(|time| (features, time)));
        for (triangle_b, face) in faces.iter().enumerate() {
            for vertex_a in (0..points.len() as u32).filter(|vertex| !face.contains(vertex)) {
                let corners = face.map(|vertex| points[vertex as usize]);
                let time = vertex_face_impact(points[vertex_a as usize], corners, TOLERANCE);
                let triangle_b = triangle_b as u32;
                add(Features::VertexFace { vertex_a, triangle_b }, time);
            }
        }
        for &edge_a in &edges {
            for &edge_b in edges
                .iter()
                .filter(|edge| edge_a < **edge && !edge.iter().any(|v| edge_a.contains(v)))
            {
                let [s, t] = [edge_a, edge_b].map(|edge| edge.map(|vertex| points[vertex as usize]));
                add(Features::EdgeEdge { edge_a, edge_b }, edge_edge_impact(s, t, TOLERANCE));
            }
        }
        let mut found = Vec::new();
        query.all_within(body.moving(), TOLERANCE, &mut found).unwrap();
        truth.sort_by_key(|contact| contact.0);
        assert_eq!(sorted(&found), truth, "case {case}");
        let mut other = body.clone();
        assert_geometry(&found, [&mut body, &mut other]);
        touching += truth.len();
    }
    assert!(touching > 500, "{touching}");
}

#[test]
fn a_shared_translation_costs_nothing_and_a_bullet_does_not_tunnel() {
    let mut rng = Pcg64Mcg::seed_from_u64(63);
    let model = Arc::new(model(&mut rng, false));
    let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default()));
    let place = |at: Vec3| WorldFromModel::new(Affine3A::from_translation(at)).unwrap();
    let step = |from: Vec3, to: Vec3| Step {
        poses: [Pose::new(bvh.clone()), Pose::new(bvh.clone())],
        places: [place(from), place(to)],
    };
    let mut query = MotionQuery::new();
    // Side by side on a fast train.
    let train = Vec3::new(1000.0, 0.0, 0.0);
    let (mut a, mut b) = (step(Vec3::ZERO, train), step(Vec3::Y * 6.0, train + Vec3::Y * 6.0));
    assert_eq!(query.any(a.moving(), b.moving()), Ok(false));
    assert_eq!(
        query.stats().node_tests,
        1,
        "only the roots are compared, and they are apart"
    );
    // Through each other in one step.
    let (mut a, mut b) = (step(Vec3::ZERO, Vec3::ZERO), step(Vec3::X * -500.0, Vec3::X * 500.0));
    let first = query.first(a.moving(), b.moving(), TOLERANCE).unwrap().unwrap();
    assert!(first.time.earliest > 0.49 && first.time.latest < 0.5, "{first:?}");
    // Poses of different trees are refused.
    let other = Arc::new(MorphBvh::build(bvh.model().clone(), &BuildOptions::default()));
    let (mut start, mut end, world) = (Pose::new(bvh.clone()), Pose::new(other), WorldFromModel::IDENTITY);
    let refused = MovingBody::new(Body::new(&mut start, &world), Body::new(&mut end, &world));
    assert!(
        refused
            .unwrap_err()
            .to_string()
            .contains("start and end of a moving body")
    );
}

/// A tetrahedron with corners on every side of the origin, seen from outside counter-clockwise.
fn tetrahedron() -> Arc<MorphBvh> {
    let corners = [
        Vec3::new(0.0, 0.0, -1.0),
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(-1.0, -1.0, 1.0),
    ];
    let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
    let model = MorphModel::from_displacements::<Vec<Vec3>>(&corners, &faces, &[]).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
}

#[test]
fn contacts_that_are_there_at_the_start_are_those_of_the_triangles() {
    let bvh = tetrahedron();
    // The tip of the upper one is in the flat face of the lower one, which is mirrored or not.
    for lower in [
        Affine3A::from_translation(Vec3::Z * -1.75),
        Affine3A::from_scale_rotation_translation(Vec3::new(1.0, -1.0, 1.0), Quat::IDENTITY, Vec3::Z * -1.75),
    ] {
        let step = |from: Affine3A, by: Vec3| Step {
            poses: [Pose::new(bvh.clone()), Pose::new(bvh.clone())],
            places: [from, Affine3A::from_translation(by) * from].map(|place| WorldFromModel::new(place).unwrap()),
        };
        let (mut a, mut b) = (step(Affine3A::IDENTITY, Vec3::Y), step(lower, Vec3::X * 2.0));
        let first = MotionQuery::new()
            .first(a.moving(), b.moving(), TOLERANCE)
            .unwrap()
            .unwrap();
        let Features::AtStart(pair) = first.features else {
            panic!("{first:?}")
        };
        let corners = [
            Body::new(&mut a.poses[0], &a.places[0])
                .triangle(pair.triangle_a)
                .unwrap(),
            Body::new(&mut b.poses[0], &b.places[0])
                .triangle(pair.triangle_b)
                .unwrap(),
        ];
        let contact = triangle_contact(&corners[0], &corners[1]).unwrap();
        assert_eq!(first.point, contact.point());
        assert_eq!(first.velocity.as_vec3(), Vec3::new(-2.0, 1.0, 0.0));
        for (corners, weights) in corners.iter().zip(first.barycentrics) {
            let point = corners
                .iter()
                .zip(weights)
                .fold(DVec3::ZERO, |sum, (corner, weight)| sum + *corner * weight);
            assert!(point.distance(first.point) < 1e-12, "{first:?}");
        }
        // Upwards, out of the lower one.
        let mut contacts = ContactQuery::new();
        let manifold = contacts
            .manifold(
                Body::new(&mut a.poses[0], &a.places[0]),
                Body::new(&mut b.poses[0], &b.places[0]),
            )
            .unwrap();
        assert!(
            manifold.normal.z > 0.9 && first.normal.dot(manifold.normal) > 0.5,
            "{first:?} {manifold:?}"
        );
        let swapped = MotionQuery::new()
            .first(b.moving(), a.moving(), TOLERANCE)
            .unwrap()
            .unwrap();
        assert!(swapped.normal.dot(manifold.normal) < -0.5, "{swapped:?}");
    }
}

#[test]
fn a_body_that_touches_at_the_start_and_leaves_has_an_outward_normal() {
    let bvh = tetrahedron();
    let place = |z: f32| WorldFromModel::new(Affine3A::from_translation(Vec3::Z * z)).unwrap();
    let step = |from: f32, to: f32| Step {
        poses: [Pose::new(bvh.clone()), Pose::new(bvh.clone())],
        places: [place(from), place(to)],
    };
    // The upper one stands with its tip on the lower one, and rises.
    let (mut upper, mut lower) = (step(2.0, 3.0), step(0.0, 0.0));
    for turn in [false, true] {
        let mut found = Vec::new();
        if turn {
            MotionQuery::new().all(lower.moving(), upper.moving(), TOLERANCE, &mut found)
        } else {
            MotionQuery::new().all(upper.moving(), lower.moving(), TOLERANCE, &mut found)
        }
        .unwrap();
        assert_eq!(found.len(), 1, "{found:?}");
        let side = if turn { -1.0 } else { 1.0 };
        assert!(found[0].normal.distance(DVec3::Z * side) < 1e-12, "{found:?}");
        assert_eq!(found[0].velocity, DVec3::Z * side);
        assert_eq!(found[0].point, DVec3::Z);
    }
}
