//! Answers as JSON and as text.

use std::fmt::Write;

use morph_collision::{ClosestPoint, Facing, QueryStats, RayHit, TrianglePair};
use morph_collision_models::text::Printable;
use morph_collision_models::text::{number, numbers};
use serde::Serialize;

use crate::options::shape::ShapedMesh;

/// An answer that can be shown as JSON or as text.
pub(super) trait QueryReport: Serialize {
    fn text(&self) -> String;
}

/// The mesh and its shape.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ShapeReport {
    mesh: usize,
    name: String,
    weights: Vec<f32>,
    /// The same in words.
    #[serde(skip)]
    in_words: String,
}

/// All hits of a ray, by ascending `t`.
#[derive(Debug, Serialize)]
pub(super) struct RayReport {
    shape: ShapeReport,
    hits: Vec<HitReport>,
    work: WorkReport,
}

#[derive(Debug, Serialize)]
struct HitReport {
    triangle: u32,
    #[serde(serialize_with = "number")]
    t: f64,
    #[serde(serialize_with = "number")]
    distance: f64,
    #[serde(serialize_with = "numbers")]
    point: [f64; 3],
    #[serde(serialize_with = "numbers")]
    barycentrics: [f64; 3],
    /// Zero if the triangle has no area.
    #[serde(serialize_with = "numbers")]
    normal: [f64; 3],
    /// `front`, `back` or `edge-on`.
    facing: &'static str,
}

/// The point of the surface that is closest to a point.
#[derive(Debug, Serialize)]
pub(super) struct PointReport {
    shape: ShapeReport,
    closest: Option<ClosestReport>,
    work: WorkReport,
}

#[derive(Debug, Serialize)]
struct ClosestReport {
    triangle: u32,
    #[serde(serialize_with = "number")]
    distance: f64,
    #[serde(serialize_with = "numbers")]
    point: [f64; 3],
    #[serde(serialize_with = "numbers")]
    barycentrics: [f64; 3],
}

/// The pairs of triangles in which the mesh intersects itself, ascending.
#[derive(Debug, Serialize)]
pub(super) struct SelfReport {
    shape: ShapeReport,
    pairs: Vec<[u32; 2]>,
    work: WorkReport,
}

/// The work done for the answer.
#[derive(Debug, Serialize)]
struct WorkReport {
    node_tests: u64,
    triangle_tests: u64,
    nodes_blended: u64,
    vertices_blended: u64,
}

impl ShapeReport {
    pub(super) fn new(shaped: &ShapedMesh) -> Self {
        Self {
            mesh: shaped.index,
            name: shaped.mesh.name.clone(),
            weights: shaped.pose.weights().to_vec(),
            in_words: shaped.weights_in_words(),
        }
    }

    fn text(&self) -> String {
        format!("mesh {} \"{}\", {}\n", self.mesh, Printable(&self.name), self.in_words)
    }
}

impl RayReport {
    pub(super) fn new(shape: ShapeReport, hits: &[RayHit], stats: QueryStats) -> Self {
        let hit = |hit: &RayHit| HitReport {
            triangle: hit.triangle,
            t: hit.t,
            distance: hit.distance,
            point: hit.point.to_array(),
            barycentrics: hit.barycentrics,
            normal: hit.normal.to_array(),
            facing: match hit.facing {
                Facing::Front => "front",
                Facing::Back => "back",
                Facing::EdgeOn => "edge-on",
            },
        };
        Self {
            shape,
            hits: hits.iter().map(hit).collect(),
            work: WorkReport::new(stats),
        }
    }
}

impl PointReport {
    pub(super) fn new(shape: ShapeReport, closest: Option<&ClosestPoint>, stats: QueryStats) -> Self {
        let closest = closest.map(|closest| ClosestReport {
            triangle: closest.triangle,
            distance: closest.distance,
            point: closest.point.to_array(),
            barycentrics: closest.barycentrics,
        });
        Self {
            shape,
            closest,
            work: WorkReport::new(stats),
        }
    }
}

impl SelfReport {
    pub(super) fn new(shape: ShapeReport, mut pairs: Vec<TrianglePair>, stats: QueryStats) -> Self {
        pairs.sort_unstable();
        Self {
            shape,
            pairs: pairs.iter().map(|pair| [pair.triangle_a, pair.triangle_b]).collect(),
            work: WorkReport::new(stats),
        }
    }
}

impl WorkReport {
    fn new(stats: QueryStats) -> Self {
        Self {
            node_tests: stats.node_tests,
            triangle_tests: stats.triangle_tests,
            nodes_blended: stats.nodes_blended,
            vertices_blended: stats.vertices_blended,
        }
    }

    fn text(&self) -> String {
        format!(
            "tested {} boxes and {} triangles; blended {} boxes and {} vertices\n",
            self.node_tests, self.triangle_tests, self.nodes_blended, self.vertices_blended
        )
    }
}

impl QueryReport for RayReport {
    fn text(&self) -> String {
        let mut text = self.shape.text() + &format!("{} hits\n", self.hits.len());
        for hit in &self.hits {
            let [x, y, z] = hit.point;
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "  triangle {} at t {:.6}, distance {:.6}, point {x:.6} {y:.6} {z:.6}, {}",
                hit.triangle, hit.t, hit.distance, hit.facing
            );
        }
        text + &self.work.text()
    }
}

impl QueryReport for SelfReport {
    fn text(&self) -> String {
        let mut text = self.shape.text() + &format!("{} pairs of triangles\n", self.pairs.len());
        for [a, b] in &self.pairs {
            let _ = writeln!(text, "  triangle {a} and triangle {b}");
        }
        text + &self.work.text()
    }
}

impl QueryReport for PointReport {
    fn text(&self) -> String {
        let found = match &self.closest {
            Some(ClosestReport {
                triangle,
                distance,
                point: [x, y, z],
                ..
            }) => format!("triangle {triangle}, distance {distance:.6}, point {x:.6} {y:.6} {z:.6}\n"),
            None => "nothing\n".into(),
        };
        self.shape.text() + &found + &self.work.text()
    }
}
