//! Many rays, or many points, at one moment.

use std::mem;

use glam::DVec3;

use super::{RayHit, RayQuery};
use crate::bounds::Aabb;
use crate::input_error::{InputError, check_points};
use crate::query::batch::{OneBodyQuery, Workers};
use crate::query::input::Ray;
use crate::query::{Body, QueryStats};

impl OneBodyQuery for RayQuery {
    fn work(&self) -> QueryStats {
        self.stats()
    }
}

impl RayQuery {
    /// Answers [`RayQuery::closest`] for many rays, on several threads if you like. Replaces `hits` by one answer per ray, in the order of the
    /// rays.
    ///
    /// The answers are the same as one by one, bit for bit, on any number of threads. Rays are sorted so that similar rays follow each
    /// other. They are spread over the workers if that pays; for a single thread, pass [`ThreadWorkers::new(1)`](crate::batch::ThreadWorkers).
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Vec3};
    /// use morph_collision::batch::ThreadWorkers;
    /// # use morph_collision::*;
    /// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
    /// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// # let world_from_model = WorldFromModel::IDENTITY;
    /// let down = |x| Ray::new(DVec3::new(x, 0.25, 2.0), DVec3::NEG_Z, f64::INFINITY);
    /// let rays = [down(0.25)?, down(5.0)?, down(0.5)?];
    /// let (mut query, mut hits) = (RayQuery::new(), Vec::new()); // keep both for the next batch
    /// query.closest_batch(Body::new(&mut pose, &world_from_model), &rays, &ThreadWorkers::new(2), &mut hits);
    /// let distances = hits.iter().map(|hit| hit.map(|hit| hit.distance));
    /// assert!(distances.eq([Some(2.0), None, Some(2.0)]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_batch(
        &mut self,
        body: Body<'_>,
        rays: &[Ray],
        workers: &dyn Workers,
        hits: &mut Vec<Option<RayHit>>,
    ) {
        self.of_rays(body, rays, workers, (hits, None), Self::closest);
    }

    /// Answers [`RayQuery::any`] for many rays, such as lines of sight. Replaces `are_hits` by one answer per ray, in the order of the rays.
    ///
    /// Rays are sorted and spread over workers as for [`RayQuery::closest_batch`].
    pub fn any_batch(&mut self, body: Body<'_>, rays: &[Ray], workers: &dyn Workers, are_hits: &mut Vec<bool>) {
        self.of_rays(body, rays, workers, (are_hits, false), Self::any);
    }

    /// Answers [`RayQuery::encloses`] for many points. Replaces `are_inside` by one answer per point, in the order of the points.
    ///
    /// Points are sorted and spread over workers as the rays of [`RayQuery::closest_batch`].
    ///
    /// # Errors
    /// [`InputError`] if a point is not finite or beyond 1e50. The error names the point's index. Nothing is answered then, and `are_inside`
    /// stays as it is.
    pub fn encloses_batch(
        &mut self,
        body: Body<'_>,
        points: &[DVec3],
        workers: &dyn Workers,
        are_inside: &mut Vec<bool>,
    ) -> Result<(), InputError> {
        check_points(points)?;
        let mut batch = mem::take(&mut self.batch);
        batch.questions.sort_points(points.iter().copied());
        let work = batch.run(self, body, workers, (are_inside, false), |query, body, point, _| {
            // Only a point could be wrong.
            query.encloses(body, points[point as usize]).unwrap_or(false)
        });
        (self.batch, self.one.stats) = (batch, work);
        Ok(())
    }

    fn of_rays<A: Clone + Send>(
        &mut self,
        body: Body<'_>,
        rays: &[Ray],
        workers: &dyn Workers,
        answers: (&mut Vec<A>, A),
        ask: impl Fn(&mut Self, Body<'_>, &Ray) -> A + Sync,
    ) {
        let mut batch = mem::take(&mut self.batch);
        let bounds = body.pose.broad_phase_bounds(body.world_from_model);
        batch.questions.sort_rays(rays.iter().map(|ray| place(ray, &bounds)));
        let work = batch.run(self, body, workers, answers, |query, body, ray, _| {
            ask(query, body, &rays[ray as usize])
        });
        (self.batch, self.one.stats) = (batch, work);
    }
}

/// A point where the ray is close to the middle of a body, and its direction.
fn place(Ray { line, .. }: &Ray, bounds: &Aabb) -> [DVec3; 2] {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let along = (0.5 * (min + max) - line.origin).dot(line.direction) / line.direction.length_squared();
    // Not `clamp`: it panics for a NaN.
    let point = line.origin + line.direction * along.max(0.0).min(line.max_t);
    [point.max(min).min(max), line.direction]
}
