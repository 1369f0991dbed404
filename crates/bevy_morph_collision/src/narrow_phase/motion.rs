//! Finds the first contact of two colliders on their way from the last run to this one, within a limit of work.

use bevy::math::{DVec3, Vec3};
use morph_collision::motion::{Features, LimitReached, MotionContact, MovingBody, MovingShape, SurfaceImpact};
use morph_collision::{MorphModel, QueryStats, TrianglePair};

use super::comparison::Comparison;
use super::contact_queries::ContactQueries;
use super::participant::PlacedCollider;
use super::starts::{RunView, Start, StartForm};
use crate::contacts::{MorphContact, MorphImpact, MorphImpactFeatures, no_triangles, pair_with_shape};

/// The largest difference between the two ends of a time of impact, relative to the time between two runs.
const TOLERANCE: f64 = 1e-6;

/// The steps of work ([`MotionQuery::with_limit`](morph_collision::motion::MotionQuery::with_limit)) that each pair may take: about half a
/// millisecond, ten times what two characters take that fly through each other.
pub(super) const STEPS_PER_PAIR: u64 = 200_000;
/// The additional steps that pairs share which need more: about 8 ms.
pub(super) const SHARED_STEPS: u64 = 3_000_000;

/// What is known about two colliders on their way.
pub(super) enum SweptResult {
    /// They do not touch on it, or the way of one of them is not known.
    Apart,
    Touching(MorphImpact),
    /// There was not enough work left. If they touch, they do not touch before this time.
    Undecided(MorphImpact),
}

impl ContactQueries {
    /// The first contact on the way, within so many steps of work.
    pub(super) fn swept(
        &mut self,
        view: RunView<'_>,
        comparison: Comparison,
        steps: u64,
        stats: &mut QueryStats,
    ) -> SweptResult {
        let [a, b] = view.pair(comparison);
        let (Some(start_a), Some(start_b)) = (view.starts.of(a), view.starts.of(b)) else {
            return SweptResult::Apart;
        };
        self.motion.set_limit(steps);
        let first = match [&start_a.form, &start_b.form] {
            [StartForm::Shape(shape), _] => self.of_shape(shape, (b, start_b), true, view.seconds),
            [_, StartForm::Shape(shape)] => self.of_shape(shape, (a, start_a), false, view.seconds),
            _ => self.of_meshes((a, start_a), (b, start_b), view.seconds),
        };
        let Some(first) = first else {
            return SweptResult::Apart;
        };
        *stats += self.motion.stats();
        match first {
            Ok(None) => SweptResult::Apart,
            Ok(Some(impact)) if impact.latest - impact.earliest > TOLERANCE => SweptResult::Undecided(impact),
            Ok(Some(impact)) => SweptResult::Touching(impact),
            Err(LimitReached { not_before }) => {
                let [of_a, of_b] = [(a, start_a), (b, start_b)].map(|(now, start)| {
                    let way = now.placement.bounds.union(&start.bounds);
                    (way.min, way.max)
                });
                SweptResult::Undecided(MorphImpact {
                    earliest: not_before,
                    latest: 1.0,
                    point: middle(of_a.0.max(of_b.0), of_a.1.min(of_b.1)),
                    normal: Vec3::ZERO,
                    velocity: Vec3::ZERO,
                    features: MorphImpactFeatures::Undecided,
                    triangles: no_triangles(),
                    barycentrics: [Vec3::ZERO; 2],
                })
            }
        }
    }
}

type FirstImpact = Result<Option<MorphImpact>, LimitReached>;

impl ContactQueries {
    /// The first contact of two meshes; `None` if the way of one of them is not known.
    fn of_meshes(
        &mut self,
        (a, start_a): (&PlacedCollider<'_>, &Start),
        (b, start_b): (&PlacedCollider<'_>, &Start),
        seconds: f64,
    ) -> Option<FirstImpact> {
        // Each locks its pose: in ascending order, and the start of a collider after its end.
        let (mut end_a, mut mesh_a) = (a.mesh()?, start_a.mesh()?);
        let (mut end_b, mut mesh_b) = (b.mesh()?, start_b.mesh()?);
        let body_a = MovingBody::new(mesh_a.body(), end_a.body()).ok()?;
        let body_b = MovingBody::new(mesh_b.body(), end_b.body()).ok()?;
        let first = self.motion.first(body_a, body_b, TOLERANCE);
        let models = [&end_a, &end_b].map(|end| end.pose.bvh().model().as_ref());
        Some(first.map(|contact| contact.map(|contact| impact(&contact, models, seconds))))
    }

    /// The first contact of a shape and a mesh; `None` if the way of the mesh is not known.
    fn of_shape(
        &mut self,
        shape: &MovingShape,
        (mesh, start): (&PlacedCollider<'_>, &Start),
        shape_first: bool,
        seconds: f64,
    ) -> Option<FirstImpact> {
        let (mut end, mut start) = (mesh.mesh()?, start.mesh()?);
        let body = MovingBody::new(start.body(), end.body()).ok()?;
        let first = self.motion.first_of_shape(shape, body, TOLERANCE);
        Some(first.map(|found| found.map(|found| impact_of_shape(&found, shape_first, seconds))))
    }
}

fn impact_of_shape(found: &SurfaceImpact, shape_first: bool, seconds: f64) -> MorphImpact {
    let impact = MorphImpact {
        earliest: found.time.earliest,
        latest: found.time.latest,
        point: found.point.as_vec3(),
        normal: found.normal.as_vec3(),
        velocity: per_second(found.velocity, seconds),
        features: if found.time.latest > 0.0 {
            MorphImpactFeatures::Shape
        } else {
            MorphImpactFeatures::AtStart
        },
        triangles: pair_with_shape(found.triangle, true),
        barycentrics: [Vec3::ZERO, DVec3::from(found.barycentrics).as_vec3()],
    };
    if shape_first { impact } else { impact.reversed() }
}

/// A velocity per motion as one per second; zero if no time passed.
fn per_second(velocity: DVec3, seconds: f64) -> Vec3 {
    if seconds > 0.0 {
        (velocity / seconds).as_vec3()
    } else {
        Vec3::ZERO
    }
}

/// The middle of two corners, also if they are infinite or so far apart that their sum is.
fn middle(low: Vec3, high: Vec3) -> Vec3 {
    let [low, high] = [low, high].map(|corner| corner.clamp(Vec3::MIN, Vec3::MAX).as_dvec3());
    low.midpoint(high).as_vec3()
}

fn impact(contact: &MotionContact, [model_a, model_b]: [&MorphModel; 2], seconds: f64) -> MorphImpact {
    let TrianglePair { triangle_a, triangle_b } = contact.triangles;
    let [weights_a, weights_b] = contact.barycentrics;
    let face = |weights: [f64; 3]| DVec3::from(weights).as_vec3();
    // The weights of features become those of their triangles.
    let (features, barycentrics) = match contact.features {
        Features::VertexFace { vertex_a, .. } => {
            let of_a = within(model_a, triangle_a, &[vertex_a], weights_a);
            (MorphImpactFeatures::VertexFace, [of_a, face(weights_b)])
        }
        Features::FaceVertex { vertex_b, .. } => {
            let of_b = within(model_b, triangle_b, &[vertex_b], weights_b);
            (MorphImpactFeatures::FaceVertex, [face(weights_a), of_b])
        }
        Features::EdgeEdge { edge_a, edge_b } => {
            let of_a = within(model_a, triangle_a, &edge_a, weights_a);
            let of_b = within(model_b, triangle_b, &edge_b, weights_b);
            (MorphImpactFeatures::EdgeEdge, [of_a, of_b])
        }
        Features::AtStart(_) => (MorphImpactFeatures::AtStart, [face(weights_a), face(weights_b)]),
    };
    MorphImpact {
        earliest: contact.time.earliest,
        latest: contact.time.latest,
        point: contact.point.as_vec3(),
        normal: contact.normal.as_vec3(),
        velocity: per_second(contact.velocity, seconds),
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
    pub(super) fn passed(comparison: Comparison, pair: [&PlacedCollider<'_>; 2], impact: MorphImpact) -> Self {
        let contact = Self::of(comparison, pair);
        let triangles = match impact.features {
            MorphImpactFeatures::Undecided => Vec::new(),
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
