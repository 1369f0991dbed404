//! `.ccdp`: a mesh at two times, and pairs of its features with their answers.

use std::path::Path;

use super::bytes::{Bytes, check_length, flag};
use super::error::{RecordError, RecordProblem};
use super::files::read_with;
use crate::motion::{ElementaryMotion, MotionKind, PointMotion};

const HEADER: u64 = 32;

/// A mesh whose vertices move linearly from one frame to the next. All indices are in range.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePair {
    /// Positions at both times, for each vertex.
    pub vertices: Vec<PointMotion>,
    /// Vertices of each face.
    pub faces: Vec<[u32; 3]>,
    /// Vertices of each edge.
    pub edges: Vec<[u32; 2]>,
    /// Pairs of a vertex and a face.
    pub vertex_face: Vec<PairRecord>,
    /// Pairs of edges.
    pub edge_edge: Vec<PairRecord>,
}

/// A pair of features with its answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairRecord {
    /// A vertex and a face, or two edges.
    pub features: [u32; 2],
    /// Whether they touch.
    pub touches: bool,
    /// Whether they touch if the motion is rounded to the `f32` of a model file: base plus weight times target. `None` if that is
    /// not known.
    pub touches_rounded: Option<bool>,
    /// Where the pair is from.
    pub source: PairSource,
}

/// Where a pair is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PairSource {
    /// Overlapping boxes of the source's broad phase, with the source's answer.
    Given,
    /// A pair that nearly touches, found by a search.
    Searched,
}

impl PairSource {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Given, Self::Searched];
}

impl FramePair {
    /// Reads a `.ccdp` file.
    ///
    /// # Errors
    /// The file cannot be read, or is broken.
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        read_with(path, Self::parse)
    }

    /// Reads the content of a `.ccdp` file.
    ///
    /// # Errors
    /// The content is broken.
    pub fn parse(content: &[u8]) -> Result<Self, RecordProblem> {
        let mut bytes = Bytes(content);
        bytes.format(b"CCDP")?;
        let counts: [u32; 5] = bytes.u32s();
        bytes.constant("size of a coordinate", 8)?;
        let sizes = [48, 8, 12, 12, 12];
        let length = counts.iter().zip(sizes).map(|(&count, size)| u64::from(count) * size);
        check_length(content.len(), HEADER + length.sum::<u64>())?;
        let [vertices, edges, faces, vertex_face, edge_edge] = counts.map(|count| count as usize);

        let mut frame = || {
            (0..vertices)
                .map(|index| bytes.position("vertex", index))
                .collect::<Result<Vec<_>, _>>()
        };
        let (start, end) = (frame()?, frame()?);
        let face = |index| in_range(bytes.u32s(), "face", index, [("vertex", vertices); 3]);
        let faces_read = (0..faces).map(face).collect::<Result<_, _>>()?;
        let edge = |index| in_range(bytes.u32s(), "edge", index, [("vertex", vertices); 2]);
        let edges_read = (0..edges).map(edge).collect::<Result<_, _>>()?;
        let targets = [("vertex", vertices), ("face", faces)];
        let pair = |index| pair(&mut bytes, "vertex-face pair", index, targets);
        let vertex_face = (0..vertex_face).map(pair).collect::<Result<_, _>>()?;
        let pair = |index| self::pair(&mut bytes, "edge-edge pair", index, [("edge", edges); 2]);
        let edge_edge = (0..edge_edge).map(pair).collect::<Result<_, _>>()?;
        Ok(Self {
            vertices: start.into_iter().zip(end).map(|(start, end)| [start, end]).collect(),
            faces: faces_read,
            edges: edges_read,
            vertex_face,
            edge_edge,
        })
    }

    /// The pairs of a kind.
    #[must_use]
    pub fn pairs(&self, kind: MotionKind) -> &[PairRecord] {
        match kind {
            MotionKind::VertexFace => &self.vertex_face,
            MotionKind::EdgeEdge => &self.edge_edge,
        }
    }

    /// The motion of a pair's features. `None` if there are no such features.
    #[must_use]
    pub fn motion(&self, kind: MotionKind, features: [u32; 2]) -> Option<ElementaryMotion> {
        let [first, second] = features.map(|feature| feature as usize);
        let points = match kind {
            MotionKind::VertexFace => {
                let [a, b, c] = *self.faces.get(second)?;
                [features[0], a, b, c]
            }
            MotionKind::EdgeEdge => {
                let ([a, b], [c, d]) = (*self.edges.get(first)?, *self.edges.get(second)?);
                [a, b, c, d]
            }
        };
        let mut motions = [[[0.0; 3]; 2]; 4];
        for (motion, point) in motions.iter_mut().zip(points) {
            *motion = *self.vertices.get(point as usize)?;
        }
        Some(ElementaryMotion { kind, points: motions })
    }
}

fn pair(
    bytes: &mut Bytes<'_>,
    list: &'static str,
    index: usize,
    targets: [(&'static str, usize); 2],
) -> Result<PairRecord, RecordProblem> {
    let features = in_range(bytes.u32s(), list, index, targets)?;
    let [touches, source, rounded, padding] = bytes.take();
    let byte = |field, found| RecordProblem::Byte {
        list,
        index,
        field,
        found,
    };
    if padding != 0 {
        return Err(byte("padding", padding));
    }
    Ok(PairRecord {
        features,
        touches: flag(list, index, "answer", touches)?,
        touches_rounded: match rounded {
            255 => None,
            _ => Some(flag(list, index, "answer for rounded motion", rounded)?),
        },
        source: match source {
            0 => PairSource::Given,
            1 => PairSource::Searched,
            _ => return Err(byte("source", source)),
        },
    })
}

/// The indices, if each is below the count of what it refers to.
fn in_range<const N: usize>(
    indices: [u32; N],
    list: &'static str,
    index: usize,
    targets: [(&'static str, usize); N],
) -> Result<[u32; N], RecordProblem> {
    for (found, (target, count)) in indices.into_iter().zip(targets) {
        if found as usize >= count {
            return Err(RecordProblem::OutOfRange {
                list,
                index,
                target,
                found,
                count,
            });
        }
    }
    Ok(indices)
}
