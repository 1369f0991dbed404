//! Bodies that move from one recorded frame to the next touch themselves where the recording says.

use std::collections::BTreeMap;
use std::error::Error;
use std::sync::Arc;

use morph_collision::motion::{Features, MotionQuery, MovingBody};
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_testkit::motion::records::{FramePair, find_records};
use morph_collision_testkit::motion::{ElementaryMotion, MotionKind, first_contact};

const WORLD: WorldFromModel = WorldFromModel::IDENTITY;
const TOLERANCE: f64 = 1e-6;

/// A vertex and a face, or the ends of two edges, as vertices of the recording.
type Key = (bool, Vec<u32>);

fn of_edges(mut edges: [[u32; 2]; 2]) -> Key {
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    edges.sort_unstable();
    (true, edges.concat())
}

#[test]
fn a_body_touches_itself_where_the_recording_says() -> Result<(), Box<dyn Error>> {
    let files = find_records("ccdp").unwrap_or_else(|missing| {
        println!("skipped: {missing}");
        Vec::new()
    });
    for path in files {
        let frames = FramePair::read(&path)?;
        let meshes = read_meshes(&path.with_extension("glb"))?;
        let model = meshes[0].to_model()?;
        assert_eq!(
            (model.source_vertex_count(), model.triangle_count()),
            (frames.vertices.len(), frames.faces.len())
        );
        // Contacts are between welded vertices. None is welded with another one here.
        assert_eq!(model.vertex_count(), model.source_vertex_count());
        let mut source_of = vec![0; model.vertex_count()];
        for (source, &welded) in model.welded_from_source().iter().enumerate() {
            source_of[welded as usize] = source as u32;
        }
        let source = |vertex: u32| source_of[vertex as usize];
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
        let (mut start, mut end) = (Pose::new(bvh.clone()), Pose::new(bvh));
        end.set_weights(&[1.0])?;

        let mut contacts = Vec::new();
        let mut query = MotionQuery::new();
        let body = MovingBody::new(Body::new(&mut start, &WORLD), Body::new(&mut end, &WORLD))?;
        query.all_within(body, TOLERANCE, &mut contacts)?;
        let found: BTreeMap<Key, _> = contacts
            .iter()
            .map(|contact| match contact.features {
                Features::VertexFace { vertex_a, triangle_b } => ((false, vec![source(vertex_a), triangle_b]), contact),
                Features::EdgeEdge { edge_a, edge_b } => (of_edges([edge_a.map(source), edge_b.map(source)]), contact),
                other => unreachable!("within one body: {other:?}"),
            })
            .collect();
        assert_eq!(found.len(), contacts.len(), "every pair is listed once");

        // The exact answer for the positions that the query used. The recording's are not rounded to `f32`.
        let welded: Vec<u32> = start.bvh().model().welded_from_source().to_vec();
        let mut point = |vertex: u32| {
            let at = |pose: &mut Pose| {
                Body::new(pose, &WORLD)
                    .vertex(welded[vertex as usize])
                    .expect("exists")
                    .to_array()
            };
            [at(&mut start), at(&mut end)]
        };
        let mut truth = |(is_edges, features): &Key| {
            let (kind, corners) = if *is_edges {
                (MotionKind::EdgeEdge, features.clone())
            } else {
                let [a, b, c] = frames.faces[features[1] as usize];
                (MotionKind::VertexFace, vec![features[0], a, b, c])
            };
            let points = std::array::from_fn(|i| point(corners[i]));
            first_contact(&ElementaryMotion { kind, points })
        };

        let (mut listed, mut touching, mut rounded, mut others) = (0, 0, 0, 0);
        let mut known = BTreeMap::new();
        for kind in MotionKind::ALL {
            for pair in frames.pairs(kind) {
                let key = match kind {
                    MotionKind::VertexFace => (false, pair.features.to_vec()),
                    MotionKind::EdgeEdge => of_edges(pair.features.map(|edge| frames.edges[edge as usize])),
                };
                listed += 1;
                touching += usize::from(found.contains_key(&key));
                let expected = pair.touches_rounded.unwrap_or(pair.touches);
                if found.contains_key(&key) != expected {
                    rounded += 1;
                    assert_eq!(found.contains_key(&key), truth(&key).is_some(), "{key:?}");
                }
                known.insert(key, expected);
            }
        }
        for (key, contact) in &found {
            if !known.contains_key(key) {
                others += 1;
                let first = truth(key).expect("what is found touches");
                let time = contact.time;
                assert!(first.is_within(time.earliest, time.latest), "{key:?}: {time:?}");
            }
        }
        let stats = query.stats();
        println!(
            "{}: {listed} pairs, {touching} touch, {rounded} differ because of rounding, {others} are not listed; {} feature tests, {} exact",
            path.display(),
            stats.feature_tests,
            stats.exact_feature_tests
        );
        assert!(rounded <= 8, "{rounded} of {listed}");
    }
    Ok(())
}
