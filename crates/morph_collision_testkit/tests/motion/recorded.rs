//! Recorded motions with known answers.

use std::error::Error;
use std::path::PathBuf;

use morph_collision_testkit::motion::records::{FramePair, PairSource, find_records, read_queries};
use morph_collision_testkit::motion::{MotionKind, first_contact};

/// Pairs of each kind, source and answer that are taken from a file.
const SAMPLE: usize = 60;

fn files(extension: &str) -> Vec<PathBuf> {
    find_records(extension).unwrap_or_else(|missing| {
        println!("skipped: {missing}");
        Vec::new()
    })
}

#[test]
fn every_recorded_query_has_its_answer() -> Result<(), Box<dyn Error>> {
    let (mut count, mut touching) = (0, 0);
    for path in files("ccdq") {
        for query in read_queries(&path)? {
            let touches = first_contact(&query.motion).is_some();
            assert_eq!(
                touches,
                query.touches,
                "{} part {} row {}",
                path.display(),
                query.part,
                query.row
            );
            count += 1;
            touching += usize::from(touches);
        }
    }
    println!("{count} recorded queries, {touching} touch");
    Ok(())
}

#[test]
fn a_sample_of_the_recorded_pairs_has_their_answers() -> Result<(), Box<dyn Error>> {
    let (mut count, mut touching) = (0, 0);
    for path in files("ccdp") {
        let frames = FramePair::read(&path)?;
        for kind in MotionKind::ALL {
            for class in PairSource::ALL
                .into_iter()
                .flat_map(|source| [(source, false), (source, true)])
            {
                let of_class = |index: &usize| {
                    let pair = &frames.pairs(kind)[*index];
                    (pair.source, pair.touches) == class
                };
                let pairs: Vec<usize> = (0..frames.pairs(kind).len()).filter(of_class).collect();
                for &index in pairs.iter().step_by((pairs.len() / SAMPLE).max(1)) {
                    let pair = &frames.pairs(kind)[index];
                    let motion = frames.motion(kind, pair.features).ok_or("no such features")?;
                    let touches = first_contact(&motion).is_some();
                    assert_eq!(touches, pair.touches, "{} {} pair {index}", path.display(), kind.name());
                    count += 1;
                    touching += usize::from(touches);
                }
            }
        }
    }
    println!("{count} recorded pairs, {touching} touch");
    Ok(())
}
