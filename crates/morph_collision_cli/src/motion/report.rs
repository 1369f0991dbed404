//! The first contacts of a replay, as JSON and as a readable summary.

use std::fmt::Write;

use morph_collision::motion::Features;
use serde::Serialize;

use super::steps::{FirstContact, Stage};

/// The JSON of `motion`.
#[derive(Debug, Serialize)]
pub(super) struct MotionReport {
    steps: usize,
    bodies: usize,
    /// By step, then by bodies.
    contacts: Vec<Contact>,
    /// Bodies of which it takes too long to tell whether they touch.
    undecided: Vec<Undecided>,
    node_tests: u64,
    triangle_tests: u64,
    feature_tests: u64,
    /// Feature tests that needed exact arithmetic.
    exact_tests: u64,
}

#[derive(Debug, Serialize)]
struct Contact {
    /// The step leads from this frame to the next.
    frame: usize,
    body_a: usize,
    body_b: usize,
    /// The first contact is between these times, as shares of the step.
    earliest: f64,
    latest: f64,
    #[serde(flatten)]
    features: Touching,
    /// Where they touch, in world space.
    point: [f64; 3],
    /// The unit vector from body B to body A.
    normal: [f64; 3],
    /// The velocity of body A relative to body B at the point, in world units per step.
    velocity: [f64; 3],
    /// Present only if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pairs: Option<u64>,
}

#[derive(Debug, Serialize)]
struct Undecided {
    frame: usize,
    body_a: usize,
    body_b: usize,
    /// Nothing touches before this share of the step.
    not_before: f64,
}

/// What touches.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(tag = "features", rename_all = "snake_case")]
enum Touching {
    VertexFace { vertex_a: u32, triangle_b: u32 },
    FaceVertex { triangle_a: u32, vertex_b: u32 },
    EdgeEdge { edge_a: [u32; 2], edge_b: [u32; 2] },
    AtStart { triangle_a: u32, triangle_b: u32 },
}

impl From<Features> for Touching {
    fn from(features: Features) -> Self {
        match features {
            Features::VertexFace { vertex_a, triangle_b } => Self::VertexFace { vertex_a, triangle_b },
            Features::FaceVertex { triangle_a, vertex_b } => Self::FaceVertex { triangle_a, vertex_b },
            Features::EdgeEdge { edge_a, edge_b } => Self::EdgeEdge { edge_a, edge_b },
            Features::AtStart(pair) => Self::AtStart {
                triangle_a: pair.triangle_a,
                triangle_b: pair.triangle_b,
            },
        }
    }
}

impl Touching {
    fn in_words(self, [a, b]: [usize; 2]) -> String {
        match self {
            Self::VertexFace { vertex_a, triangle_b } => {
                format!("vertex {vertex_a} of body {a} and triangle {triangle_b} of body {b}")
            }
            Self::FaceVertex { triangle_a, vertex_b } => {
                format!("triangle {triangle_a} of body {a} and vertex {vertex_b} of body {b}")
            }
            Self::EdgeEdge {
                edge_a: [p, q],
                edge_b: [r, s],
            } => {
                format!("edge {p}-{q} of body {a} and edge {r}-{s} of body {b}")
            }
            Self::AtStart { triangle_a, triangle_b } => {
                format!("triangles {triangle_a} of body {a} and {triangle_b} of body {b} intersect at the start")
            }
        }
    }
}

impl MotionReport {
    pub(super) fn new(steps: usize, bodies: usize, stage: Stage) -> Self {
        let contact = |first: FirstContact| Contact {
            frame: first.frame,
            body_a: first.bodies[0],
            body_b: first.bodies[1],
            earliest: first.contact.time.earliest,
            latest: first.contact.time.latest,
            features: first.contact.features.into(),
            point: first.contact.point.to_array(),
            normal: first.contact.normal.to_array(),
            velocity: first.contact.velocity.to_array(),
            pairs: first.pairs,
        };
        let undecided = stage.undecided.iter().map(|undecided| Undecided {
            frame: undecided.frame,
            body_a: undecided.bodies[0],
            body_b: undecided.bodies[1],
            not_before: undecided.not_before,
        });
        let stats = stage.stats;
        Self {
            steps,
            bodies,
            undecided: undecided.collect(),
            contacts: stage.contacts.into_iter().map(contact).collect(),
            node_tests: stats.node_tests,
            triangle_tests: stats.triangle_tests,
            feature_tests: stats.feature_tests,
            exact_tests: stats.exact_feature_tests,
        }
    }

    pub(super) fn summary(&self) -> String {
        let mut text = format!(
            "steps: {}, bodies: {}, first contacts: {}\n",
            self.steps,
            self.bodies,
            self.contacts.len()
        );
        for contact in &self.contacts {
            let bodies = [contact.body_a, contact.body_b];
            let what = contact.features.in_words(bodies);
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "frame {} to {}, bodies {} and {}, at {} to {}: {what}, at {}, normal {}",
                contact.frame,
                contact.frame + 1,
                bodies[0],
                bodies[1],
                contact.earliest,
                contact.latest,
                in_brackets(contact.point),
                in_brackets(contact.normal)
            );
            let _ = match contact.pairs {
                Some(pairs) => writeln!(text, " ({pairs} pairs of features touch in this step)"),
                None => writeln!(text),
            };
        }
        for undecided in &self.undecided {
            let _ = writeln!(
                text,
                "frame {} to {}, bodies {} and {}: undecided. Nothing touches before {}, but very many features are very close then.",
                undecided.frame,
                undecided.frame + 1,
                undecided.body_a,
                undecided.body_b,
                undecided.not_before
            );
        }
        let _ = writeln!(
            text,
            "{} node tests, {} triangle tests, {} feature tests, {} of them exact",
            self.node_tests, self.triangle_tests, self.feature_tests, self.exact_tests
        );
        text
    }
}

/// A vector with as many digits as an `f32` has.
fn in_brackets([x, y, z]: [f64; 3]) -> String {
    format!("({}, {}, {})", x as f32, y as f32, z as f32)
}
