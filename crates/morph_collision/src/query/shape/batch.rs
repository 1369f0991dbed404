//! Many shapes, or many points, at one moment.

use std::mem;

use glam::DVec3;

use super::query::check_within;
use super::{ClosestPoint, PlacedShape, ShapeContact, ShapeQuery};
use crate::input_error::{InputError, check_length, check_points};
use crate::query::batch::{Latest, OneBodyQuery, Workers};
use crate::query::{Body, QueryStats};

impl OneBodyQuery for ShapeQuery {
    fn work(&self) -> QueryStats {
        self.stats()
    }
}

impl ShapeQuery {
    /// Answers [`ShapeQuery::closest_point`] for many points, faster than one by one. Replaces `closest` by one answer per point, in the
    /// order of the points.
    ///
    /// The answers are the same as one by one, bit for bit, on any number of threads. Points are sorted so that neighbours follow each
    /// other. They are spread over the workers if that pays; for a single thread, pass [`ThreadWorkers::new(1)`](crate::batch::ThreadWorkers).
    ///
    /// # Errors
    /// [`InputError`] if a point is not finite or beyond 1e50 (the error names its index), or if `max_distance` is negative or NaN. Nothing
    /// is answered then, and `closest` stays as it is.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Vec3};
    /// use morph_collision::batch::ThreadWorkers;
    /// # use morph_collision::*;
    /// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
    /// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// # let world_from_model = WorldFromModel::IDENTITY;
    /// let points = [DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 9.0), DVec3::new(0.2, 0.2, 0.5)];
    /// let (mut query, mut closest) = (ShapeQuery::new(), Vec::new()); // keep both for the next batch
    /// let body = Body::new(&mut pose, &world_from_model);
    /// query.closest_point_batch(body, &points, 3.0, &ThreadWorkers::new(2), &mut closest)?;
    /// let distances = closest.iter().map(|closest| closest.map(|closest| closest.distance));
    /// assert!(distances.eq([Some(2.0), None, Some(0.5)]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_point_batch(
        &mut self,
        body: Body<'_>,
        points: &[DVec3],
        max_distance: f64,
        workers: &dyn Workers,
        closest: &mut Vec<Option<ClosestPoint>>,
    ) -> Result<(), InputError> {
        check_points(points)?;
        check_length("max_distance", max_distance)?;
        let places = points.iter().copied();
        self.of_places(body, places, workers, (closest, None), |query, body, point, latest| {
            query.closest_point_from(body, points[point as usize], max_distance, latest)
        });
        Ok(())
    }

    /// Answers [`ShapeQuery::closest`] for many shapes, such as the particles of a cloth. Replaces `contacts` by one answer per shape, in
    /// the order of the shapes.
    ///
    /// Shapes are sorted and spread over workers as the points of [`ShapeQuery::closest_point_batch`].
    ///
    /// # Errors
    /// [`InputError`] if `within` is NaN. Nothing is answered then, and `contacts` stays as it is.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Vec3};
    /// use morph_collision::batch::ThreadWorkers;
    /// # use morph_collision::*;
    /// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
    /// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// # let world_from_model = WorldFromModel::IDENTITY;
    /// let ball = |z| PlacedShape::ball(DVec3::new(0.2, 0.2, z), 0.5);
    /// let (balls, mut contacts) = ([ball(9.0)?, ball(0.25)?], Vec::new());
    /// let (body, one_thread) = (Body::new(&mut pose, &world_from_model), ThreadWorkers::new(1));
    /// ShapeQuery::new().closest_batch(body, &balls, 0.0, &one_thread, &mut contacts)?;
    /// let depths = contacts.iter().map(|contact| contact.map(|contact| -contact.distance));
    /// assert!(depths.eq([None, Some(0.25)]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_batch(
        &mut self,
        body: Body<'_>,
        shapes: &[PlacedShape],
        within: f64,
        workers: &dyn Workers,
        contacts: &mut Vec<Option<ShapeContact>>,
    ) -> Result<(), InputError> {
        check_within(within)?;
        let places = shapes.iter().map(PlacedShape::center);
        self.of_places(body, places, workers, (contacts, None), |query, body, shape, latest| {
            query.closest_from(body, &shapes[shape as usize], within, latest)
        });
        Ok(())
    }

    /// Answers [`ShapeQuery::any`] for many shapes. Replaces `are_met` by one answer per shape, in the order of the shapes.
    ///
    /// Shapes are sorted and spread over workers as the points of [`ShapeQuery::closest_point_batch`].
    pub fn any_batch(
        &mut self,
        body: Body<'_>,
        shapes: &[PlacedShape],
        workers: &dyn Workers,
        are_met: &mut Vec<bool>,
    ) {
        let places = shapes.iter().map(PlacedShape::center);
        self.of_places(body, places, workers, (are_met, false), |query, body, shape, _| {
            query.any(body, &shapes[shape as usize])
        });
    }

    fn of_places<A: Clone + Send>(
        &mut self,
        body: Body<'_>,
        places: impl Iterator<Item = DVec3> + Clone,
        workers: &dyn Workers,
        answers: (&mut Vec<A>, A),
        ask: impl Fn(&mut Self, Body<'_>, u32, &mut Latest) -> A + Sync,
    ) {
        let mut batch = mem::take(&mut self.batch);
        batch.questions.sort_points(places);
        let work = batch.run(self, body, workers, answers, ask);
        (self.batch, self.one.stats) = (batch, work);
    }
}
