//! `.ccdq`: single queries, each with its eight positions and its answer.

use std::path::Path;

use super::bytes::{Bytes, check_length, flag};
use super::error::{RecordError, RecordProblem};
use super::files::read_with;
use crate::motion::{ElementaryMotion, MotionKind};

const HEADER: u64 = 16;
const RECORD: u32 = 200;

/// One recorded query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueryRecord {
    /// What moves.
    pub motion: ElementaryMotion,
    /// Whether the features touch.
    pub touches: bool,
    /// Which table of the source it is from.
    pub part: u8,
    /// Its row in that table.
    pub row: u32,
}

/// Reads a `.ccdq` file.
///
/// # Errors
/// The file cannot be read, or is broken.
pub fn read_queries(path: &Path) -> Result<Vec<QueryRecord>, RecordError> {
    read_with(path, parse_queries)
}

/// Reads the content of a `.ccdq` file: a header of 16 bytes and records of 200.
///
/// # Errors
/// The content is broken.
pub fn parse_queries(content: &[u8]) -> Result<Vec<QueryRecord>, RecordProblem> {
    let mut bytes = Bytes(content);
    bytes.format(b"CCDQ")?;
    let count = bytes.u32();
    bytes.constant("record size", RECORD)?;
    check_length(content.len(), HEADER + u64::from(count) * u64::from(RECORD))?;
    (0..count as usize).map(|index| record(&mut bytes, index)).collect()
}

fn record(bytes: &mut Bytes<'_>, index: usize) -> Result<QueryRecord, RecordProblem> {
    let list = "query";
    let mut points = [[[0.0; 3]; 2]; 4];
    for time in 0..2 {
        for point in &mut points {
            point[time] = bytes.position(list, index)?;
        }
    }
    let [kind, touches, part, padding] = bytes.take();
    let kind = match kind {
        0 => MotionKind::VertexFace,
        1 => MotionKind::EdgeEdge,
        found => {
            let field = "kind";
            return Err(RecordProblem::Byte {
                list,
                index,
                field,
                found,
            });
        }
    };
    if padding != 0 {
        return Err(RecordProblem::Byte {
            list,
            index,
            field: "padding",
            found: padding,
        });
    }
    Ok(QueryRecord {
        motion: ElementaryMotion { kind, points },
        touches: flag(list, index, "answer", touches)?,
        part,
        row: bytes.u32(),
    })
}
