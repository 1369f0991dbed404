//! All recorded motions.

use std::path::Path;

use morph_collision_cli::shared::AnyError;
use morph_collision_testkit::motion::MotionKind;
use morph_collision_testkit::motion::records::{FramePair, find_records, read_queries};

use super::row::judge_all;

/// Prints a row for each file and returns whether all answers agree.
pub(super) fn judge_files() -> Result<bool, AnyError> {
    let mut agree = true;
    let queries = find_records("ccdq").unwrap_or_else(|missing| {
        println!("skipped: {missing}");
        Vec::new()
    });
    for path in queries {
        let queries = read_queries(&path)?;
        let row = judge_all(queries.len() as u64, |index| {
            let query = &queries[index as usize];
            (query.motion, Some(query.touches))
        });
        agree &= row.print(name(&path));
    }
    for path in find_records("ccdp").unwrap_or_default() {
        let frames = FramePair::read(&path)?;
        for kind in MotionKind::ALL {
            let pairs = frames.pairs(kind);
            let motion = |features| frames.motion(kind, features);
            let queries: Option<Vec<_>> = pairs
                .iter()
                .map(|pair| Some((motion(pair.features)?, Some(pair.touches))))
                .collect();
            let queries = queries.ok_or("a pair has no features")?;
            let row = judge_all(queries.len() as u64, |index| queries[index as usize]);
            agree &= row.print(&format!("{}, {}", name(&path), kind.name()));
        }
    }
    Ok(agree)
}

fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or("")
}
