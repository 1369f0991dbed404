//! Finds the first contact of two meshes on their way from the last run to this one.

use bevy::math::{DVec3, Vec3};
use morph_collision::motion::{Features, MotionContact, MovingBody};
use morph_collision::{MorphModel, QueryStats, TrianglePair};

use super::starts::Starts;
use super::touch::Touch;
use super::{Asked, Placed};
use crate::collider::MorphCollisionMode;
use crate::contacts::MorphContact;
use crate::impact::{MorphFeatures, MorphImpact};

/// The largest difference between the two ends of a time of impact, relative to the time between two runs.
const TOLERANCE: f64 = 1e-6;

impl Touch {
    /// The first contact on the way; `None` if they do not touch on it, or if the way of one of them is not known.
    pub(super) fn impact(
        &mut self,
        (placed, starts): (&[Placed<'_>], &Starts),
        asked: Asked,
        seconds: f64,
        stats: &mut QueryStats,
    ) -> Option<MorphImpact> {
        let [a, b] = [&placed[asked.places.0], &placed[asked.places.1]];
        let (start_a, start_b) = (starts.of(a)?, starts.of(b)?);
        // Each locks its pose: in ascending order, and the start of a collider after its end.
        let (mut end_a, mut start_a) = (a.mesh()?, start_a.mesh());
        let (mut end_b, mut start_b) = (b.mesh()?, start_b.mesh());
        let body_a = MovingBody::new(start_a.body(), end_a.body()).ok()?;
        let body_b = MovingBody::new(start_b.body(), end_b.body()).ok()?;
        let contact = self.motion.first(body_a, body_b, TOLERANCE);
        *stats += self.motion.stats();
        let contact = contact?;
        let models = [&end_a, &end_b].map(|end| end.pose.bvh().model().as_ref());
        Some(impact(&contact, models, seconds))
    }
}

fn impact(contact: &MotionContact, [model_a, model_b]: [&MorphModel; 2], seconds: f64) -> MorphImpact {
    let TrianglePair { triangle_a, triangle_b } = contact.triangles;
    let [weights_a, weights_b] = contact.barycentrics;
    let face = |weights: [f64; 3]| DVec3::from(weights).as_vec3();
    // The weights of features become those of their triangles.
    let (features, barycentrics) = match contact.features {
        Features::VertexFace { vertex_a, .. } => {
            let of_a = within(model_a, triangle_a, &[vertex_a], weights_a);
            (MorphFeatures::VertexFace, [of_a, face(weights_b)])
        }
        Features::FaceVertex { vertex_b, .. } => {
            let of_b = within(model_b, triangle_b, &[vertex_b], weights_b);
            (MorphFeatures::FaceVertex, [face(weights_a), of_b])
        }
        Features::EdgeEdge { edge_a, edge_b } => {
            let of_a = within(model_a, triangle_a, &edge_a, weights_a);
            let of_b = within(model_b, triangle_b, &edge_b, weights_b);
            (MorphFeatures::EdgeEdge, [of_a, of_b])
        }
        Features::AtStart(_) => (MorphFeatures::AtStart, [face(weights_a), face(weights_b)]),
    };
    let velocity = if seconds > 0.0 {
        contact.velocity / seconds
    } else {
        DVec3::ZERO
    };
    MorphImpact {
        earliest: contact.time.earliest,
        latest: contact.time.latest,
        point: contact.point.as_vec3(),
        normal: contact.normal.as_vec3(),
        velocity: velocity.as_vec3(),
        features,
        triangles: contact.triangles,
        barycentrics,
    }
}

/// The barycentric coordinates in a triangle of a point that has these weights at some of its corners.
fn within(model: &MorphModel, triangle: u32, vertices: &[u32], weights: [f64; 3]) -> Vec3 {
    let mut barycentrics = Vec3::ZERO;
    let corners = model.triangle(triangle).unwrap_or_default();
    for (vertex, weight) in vertices.iter().zip(weights) {
        if let Some(corner) = corners.iter().position(|corner| corner == vertex) {
            barycentrics[corner] = weight as f32;
        }
    }
    barycentrics
}

impl MorphContact {
    /// The contact of a pair that touched only on its way.
    pub(super) fn passed(asked: Asked, placed: &[Placed<'_>], impact: MorphImpact) -> Self {
        let contact = Self::of(asked, [&placed[asked.places.0], &placed[asked.places.1]]);
        let triangles = match asked.mode {
            MorphCollisionMode::Any => Vec::new(),
            _ => vec![impact.triangles],
        };
        Self {
            point: impact.point,
            normal: impact.normal,
            triangles,
            impact: Some(impact),
            ..contact
        }
    }
}
