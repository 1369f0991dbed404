//! Continuous collision against recorded queries with known verdicts.
//!
//! `../shared/ccd` next to the repository may hold them. Without it, the tests print a reason and skip.

use std::error::Error;
use std::path::PathBuf;

use glam::DVec3;
use morph_collision::motion::{
    MovingPoint, StageCounts, edge_edge_impact, edge_edge_touch_counting, vertex_face_impact,
    vertex_face_touch_counting,
};
use morph_collision_testkit::motion::records::{FramePair, find_records, read_queries};
use morph_collision_testkit::motion::{ElementaryMotion, MotionKind};

const TOLERANCE: f64 = 1e-6;

fn files(extension: &str) -> Vec<PathBuf> {
    find_records(extension).unwrap_or_else(|missing| {
        println!("skipped: {missing}");
        Vec::new()
    })
}

/// Compares verdicts, and the widths of times, with what was recorded.
fn judge(queries: impl Iterator<Item = (ElementaryMotion, bool)>, name: &str) {
    let (mut stages, mut missed, mut wrong) = (StageCounts::default(), 0, 0);
    for (motion, recorded) in queries {
        let [a, b, c, d] = motion.points.map(|ends| {
            let [start, end] = ends.map(DVec3::from_array);
            MovingPoint::new(start, end)
        });
        let (touches, time) = match motion.kind {
            MotionKind::VertexFace => (
                vertex_face_touch_counting(a, [b, c, d], &mut stages),
                vertex_face_impact(a, [b, c, d], TOLERANCE),
            ),
            MotionKind::EdgeEdge => (
                edge_edge_touch_counting([a, b], [c, d], &mut stages),
                edge_edge_impact([a, b], [c, d], TOLERANCE),
            ),
        };
        missed += usize::from(recorded && !touches);
        wrong += usize::from(!recorded && touches);
        assert_eq!(time.is_some(), touches, "{motion:?}");
        assert!(
            time.is_none_or(|time| time.latest - time.earliest <= TOLERANCE),
            "{time:?}"
        );
    }
    println!("{name}: {stages:?}, {missed} missed, {wrong} wrong");
    assert_eq!((missed, wrong), (0, 0), "{name}");
    assert!(stages.total() > 0, "{name} is empty");
}

#[test]
fn no_single_query_is_missed_or_wrong() -> Result<(), Box<dyn Error>> {
    for path in files("ccdq") {
        let queries = read_queries(&path)?;
        let recorded = queries.into_iter().map(|query| (query.motion, query.touches));
        judge(recorded, &path.display().to_string());
    }
    Ok(())
}

#[test]
fn no_pair_of_a_simulated_frame_is_missed_or_wrong() -> Result<(), Box<dyn Error>> {
    for path in files("ccdp") {
        let frames = FramePair::read(&path)?;
        for kind in MotionKind::ALL {
            let pairs = frames.pairs(kind).iter();
            let recorded = pairs.map(|pair| {
                let motion = frames
                    .motion(kind, pair.features)
                    .expect("the pair names existing features");
                (motion, pair.touches)
            });
            judge(recorded, &format!("{}, {}", path.display(), kind.name()));
        }
    }
    Ok(())
}
