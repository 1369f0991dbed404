//! Continuous collision against published queries with known verdicts.
//!
//! `../shared/ccd` next to the repository may hold them. Without it, the test prints a reason and skips.

use std::path::{Path, PathBuf};

use glam::DVec3;
use morph_collision::motion::{
    MovingPoint, StageCounts, edge_edge_impact, edge_edge_touch_counting, vertex_face_impact,
    vertex_face_touch_counting,
};

/// A vertex and a face, or two edges, and whether they touch.
struct Query {
    corners: [MovingPoint; 4],
    is_edges: bool,
    touches: bool,
}

impl Query {
    fn touch(&self, stages: &mut StageCounts) -> bool {
        let [a, b, c, d] = self.corners;
        if self.is_edges {
            edge_edge_touch_counting([a, b], [c, d], stages)
        } else {
            vertex_face_touch_counting(a, [b, c, d], stages)
        }
    }

    /// The width of the interval of the first time.
    fn impact_width(&self, tolerance: f64) -> Option<f64> {
        let [a, b, c, d] = self.corners;
        let time = if self.is_edges {
            edge_edge_impact([a, b], [c, d], tolerance)
        } else {
            vertex_face_impact(a, [b, c, d], tolerance)
        };
        time.map(|time| time.latest - time.earliest)
    }
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_first_chunk().expect("the file is complete");
        self.0 = rest;
        *head
    }

    fn index(&mut self) -> usize {
        u32::from_le_bytes(self.bytes()) as usize
    }

    fn point(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| f64::from_le_bytes(self.bytes())))
    }

    fn indices<const N: usize>(&mut self) -> [usize; N] {
        std::array::from_fn(|_| self.index())
    }
}

/// Single queries: eight points, the kind and the verdict each.
fn read_queries(file: &[u8]) -> Vec<Query> {
    let mut header = Reader(&file[8..16]);
    let (count, size) = (header.index(), header.index());
    let read = |record: &[u8]| {
        let mut reader = Reader(record);
        let [starts, ends]: [[DVec3; 4]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| reader.point()));
        let [is_edges, touches] = reader.bytes().map(|byte: u8| byte == 1);
        let corners = std::array::from_fn(|i| MovingPoint::new(starts[i], ends[i]));
        Query {
            corners,
            is_edges,
            touches,
        }
    };
    let queries: Vec<Query> = file[16..].chunks_exact(size).map(read).collect();
    assert_eq!(queries.len(), count);
    queries
}

/// Two frames of a mesh, and pairs of its parts.
fn read_pairs(file: &[u8]) -> Vec<Query> {
    let mut reader = Reader(&file[8..]);
    let [vertices, edges, faces, vertex_faces, edge_edges, _] = reader.indices();
    let [starts, ends]: [Vec<DVec3>; 2] = std::array::from_fn(|_| (0..vertices).map(|_| reader.point()).collect());
    let faces: Vec<[usize; 3]> = (0..faces).map(|_| reader.indices()).collect();
    let edges: Vec<[usize; 2]> = (0..edges).map(|_| reader.indices()).collect();
    let moving = |vertex: usize| MovingPoint::new(starts[vertex], ends[vertex]);
    let mut read = |is_edges: bool| {
        let [a, b] = reader.indices();
        let [touches, ..] = reader.bytes::<4>();
        let vertices = if is_edges {
            let ([p, q], [r, s]) = (edges[a], edges[b]);
            [p, q, r, s]
        } else {
            let [p, q, r] = faces[b];
            [a, p, q, r]
        };
        Query {
            corners: vertices.map(moving),
            is_edges,
            touches: touches == 1,
        }
    };
    (0..vertex_faces + edge_edges)
        .map(|i| read(i >= vertex_faces))
        .collect()
}

fn files(extension: &str) -> Vec<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/ccd"));
    let Ok(entries) = std::fs::read_dir(folder) else {
        eprintln!("skipped: there is no folder {}", folder.display());
        return Vec::new();
    };
    let paths = entries.flatten().map(|entry| entry.path());
    let mut paths: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .collect();
    paths.sort();
    paths
}

fn judge(extension: &str, read: fn(&[u8]) -> Vec<Query>, every_nth: usize) {
    for path in files(extension) {
        let queries = read(&std::fs::read(&path).expect("the file is readable"));
        let (mut stages, mut missed, mut wrong) = (StageCounts::default(), 0, 0);
        for query in queries.iter().step_by(every_nth) {
            let touches = query.touch(&mut stages);
            missed += usize::from(query.touches && !touches);
            wrong += usize::from(!query.touches && touches);
            let width = query.impact_width(1e-6);
            assert_eq!(width.is_some(), touches);
            assert!(width.is_none_or(|width| width <= 1e-6), "{width:?}");
        }
        eprintln!("{}: {stages:?}, {missed} missed, {wrong} wrong", path.display());
        assert_eq!((missed, wrong), (0, 0), "{}", path.display());
    }
}

#[test]
fn no_single_query_is_missed_or_wrong() {
    judge("ccdq", read_queries, 1);
}

#[test]
fn no_pair_of_a_simulated_frame_is_missed_or_wrong() {
    judge("ccdp", read_pairs, 1);
}
