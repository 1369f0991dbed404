//! Bodies that collapse, blow up or turn inside out: answers, and the work that they take.

use std::sync::Arc;

use morph_collision::motion::{Features, LimitReached, MotionQuery, MovingPoint, edge_edge_impact, vertex_face_impact};
use morph_collision::{BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::extremes::{Extreme, extremes};

use super::bodies::{Step, TOLERANCE};

/// Two bodies on their way.
fn steps(meshes: [&MorphMesh; 2], extreme: &Extreme) -> [Step; 2] {
    [0, 1].map(|body: usize| {
        let model = Arc::new(meshes[body].to_model().unwrap());
        let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default()));
        let places = extreme.places[body].map(|place| WorldFromModel::new(place).unwrap());
        Step::between([Pose::new(bvh.clone()), Pose::new(bvh)], places)
    })
}

/// When features first touch: over all pairs, as precisely as `f64` can tell.
fn first_touch(a: &mut Step, b: &mut Step) -> Option<[f64; 2]> {
    let (points_a, points_b) = (a.points(), b.points());
    let at = |points: &[MovingPoint], vertex: u32| points[vertex as usize];
    let mut times = Vec::new();
    for (points, faces, of_faces) in [(&points_a, b.faces(), &points_b), (&points_b, a.faces(), &points_a)] {
        for face in faces.iter().map(|face| face.map(|vertex| at(of_faces, vertex))) {
            times.extend(points.iter().filter_map(|point| vertex_face_impact(*point, face, 0.0)));
        }
    }
    let edges_b = b.edges();
    for edge_a in a.edges().iter().map(|edge| edge.map(|vertex| at(&points_a, vertex))) {
        for edge_b in edges_b.iter().map(|edge| edge.map(|vertex| at(&points_b, vertex))) {
            times.extend(edge_edge_impact(edge_a, edge_b, 0.0));
        }
    }
    let first = times.into_iter().min_by(|x, y| x.latest.total_cmp(&y.latest))?;
    Some([first.earliest, first.latest])
}

#[test]
fn extreme_motions_have_exact_answers() {
    let meshes = [random_blob(1, 0, 0, 0.0), random_blob(2, 0, 0, 0.0)];
    let (mut query, mut touching) = (MotionQuery::new(), 0);
    for extreme in extremes() {
        let [mut a, mut b] = steps(meshes.each_ref(), &extreme);
        let truth = first_touch(&mut a, &mut b);
        let name = extreme.name;
        assert_eq!(query.any(a.moving(), b.moving()), Ok(truth.is_some()), "{name}");
        for tolerance in [TOLERANCE, 1e-2, 0.0] {
            let first = query.first(a.moving(), b.moving(), tolerance).unwrap();
            assert_eq!(first.is_some(), truth.is_some(), "{name}: {first:?}, {truth:?}");
            let (Some(first), Some([earliest, latest])) = (first, truth) else {
                continue;
            };
            let time = first.time;
            assert!(
                time.earliest <= earliest && earliest <= time.latest && time.earliest <= latest,
                "{name}: {time:?}, {truth:?}"
            );
            let is_neighbour = time.latest <= time.earliest.next_up();
            assert!(
                is_neighbour || time.latest - time.earliest <= tolerance,
                "{name}: {time:?}"
            );
            assert!(
                !matches!(first.features, Features::AtStart(_)),
                "{name}: apart at the start"
            );
            touching += 1;
        }
    }
    assert!(touching > 50, "{touching}");
}

#[test]
fn answers_at_the_limit_of_work_are_conservative() {
    let meshes = [random_blob(1, 0, 0, 0.0), random_blob(2, 0, 0, 0.0)];
    let (mut decided, mut cut, mut late) = (0, 0, 0);
    for extreme in extremes() {
        let [mut a, mut b] = steps(meshes.each_ref(), &extreme);
        let truth = first_touch(&mut a, &mut b);
        let first_time = truth.map_or(1.0, |[_, latest]| latest);
        let name = extreme.name;
        for limit in [0, 10, 100, 1_000, 30_000, 300_000] {
            let mut query = MotionQuery::new().with_limit(limit);
            match query.any(a.moving(), b.moving()) {
                Ok(touches) => assert_eq!(touches, truth.is_some(), "{name}, {limit}"),
                Err(LimitReached { not_before }) => assert!(not_before <= first_time, "{name}, {limit}: {not_before}"),
            }
            match (query.first(a.moving(), b.moving(), TOLERANCE), truth) {
                (Ok(None), truth) => assert_eq!(truth, None, "{name}, {limit}"),
                (Ok(Some(first)), Some([_, latest])) => {
                    assert!(first.time.earliest <= latest, "{name}, {limit}: {first:?}");
                    assert!(first.time.latest >= latest, "{name}, {limit}: {first:?}");
                    decided += 1;
                }
                (Err(LimitReached { not_before }), _) => {
                    assert!(not_before <= first_time, "{name}, {limit}: {not_before}, {truth:?}");
                    late += usize::from(not_before > 0.0);
                    cut += 1;
                }
                (first, truth) => panic!("{name}, {limit}: {first:?}, {truth:?}"),
            }
        }
    }
    assert!(decided > 40 && cut > 40 && late > 5, "{decided}, {cut}, {late}");
}

#[test]
fn extreme_motions_take_no_more_work_than_the_limit() {
    const LIMIT: u64 = 6_000_000;
    // A pair of triangles has 15 pairs of features, and a pair of leaves 64 of triangles. They are finished.
    const MOST_EXACT: u64 = LIMIT / 10_000 + 15;
    let meshes = [random_blob(1, 3, 0, 0.0), random_blob(2, 3, 0, 0.0)];
    let mut query = MotionQuery::new().with_limit(LIMIT);
    let mut undecided = Vec::new();
    for extreme in extremes() {
        let [mut a, mut b] = steps(meshes.each_ref(), &extreme);
        for is_first in [true, false] {
            let is_decided = if is_first {
                let first = query.first(a.moving(), b.moving(), TOLERANCE);
                first.is_ok_and(|first| first.is_none_or(|first| first.time.latest - first.time.earliest <= TOLERANCE))
            } else {
                query.any(a.moving(), b.moving()).is_ok()
            };
            let (stats, name) = (query.stats(), extreme.name);
            assert!(stats.exact_feature_tests <= MOST_EXACT, "{name}: {stats:?}");
            assert!(
                stats.node_tests + stats.triangle_tests <= LIMIT + 100,
                "{name}: {stats:?}"
            );
            if !is_decided {
                undecided.push(name);
            }
        }
    }
    // Many features are so close for so long that only exact arithmetic tells them apart.
    undecided.dedup();
    assert_eq!(
        undecided,
        [
            "to 1e-20",
            "from 1e-20",
            "from two points",
            "mirrored through each other",
            "a point through a body"
        ]
    );
}
