//! Finds the first contact of two colliders on their way from the last run to this one.

use bevy::math::DVec3;
use morph_collision::QueryStats;
use morph_collision::motion::{Features, MotionContact, MovingBody};

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
        let (mut end_a, mut start_a) = (a.mesh()?, start_a.mesh()?);
        let (mut end_b, mut start_b) = (b.mesh()?, start_b.mesh()?);
        let body_a = MovingBody::new(start_a.body(), end_a.body()).ok()?;
        let body_b = MovingBody::new(start_b.body(), end_b.body()).ok()?;
        let contact = self.motion.first(body_a, body_b, TOLERANCE);
        *stats += self.motion.stats();
        contact.map(|contact| impact(&contact, seconds))
    }
}

fn impact(contact: &MotionContact, seconds: f64) -> MorphImpact {
    let velocity = if seconds > 0.0 { contact.velocity / seconds } else { DVec3::ZERO };
    MorphImpact {
        earliest: contact.time.earliest,
        latest: contact.time.latest,
        point: contact.point.as_vec3(),
        normal: contact.normal.as_vec3(),
        velocity: velocity.as_vec3(),
        features: match contact.features {
            Features::VertexFace { .. } => MorphFeatures::VertexFace,
            Features::FaceVertex { .. } => MorphFeatures::FaceVertex,
            Features::EdgeEdge { .. } => MorphFeatures::EdgeEdge,
            Features::AtStart(_) => MorphFeatures::AtStart,
        },
        triangles: contact.triangles,
        barycentrics: contact.barycentrics.map(|of| DVec3::from(of).as_vec3()),
    }
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
