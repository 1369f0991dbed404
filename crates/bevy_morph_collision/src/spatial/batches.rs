//! Many questions at one moment.

use bevy::math::Isometry3d;
use bevy::prelude::*;
use morph_collision::InputError;
use morph_collision::batch::{QuestionBatch, Workers};

use super::points::checked_distance;
use super::rays::RayCast;
use super::shapes::place;
use super::walker::{PoseCopies, Walker};
use super::{MorphProjection, MorphQueryFilter, MorphRayHit, MorphSpatialQuery};
use crate::app::TaskPoolWorkers;
use crate::components::MorphShape;

/// Fewer questions are not worth waking a thread, even if each finds something.
const MIN_QUESTIONS_PER_THREAD: usize = 256;

impl MorphSpatialQuery<'_, '_> {
    /// Answers [`MorphSpatialQuery::cast_ray`] for many rays, faster than one by one. Replaces `hits` by one answer per ray, in the order
    /// of the rays.
    ///
    /// The answers are the same as one by one. Rays are sorted so that similar rays follow each other, and large batches are spread over the
    /// threads of the [`ComputeTaskPool`](bevy::tasks::ComputeTaskPool). A ray with invalid input hits nothing.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// fn scan(spatial: MorphSpatialQuery, mut hits: Local<Vec<Option<MorphRayHit>>>) {
    ///     let directions = (0..1000).filter_map(|i| Dir3::new(Quat::from_rotation_y(i as f32) * Vec3::new(1.0, 0.001 * i as f32, 0.0)).ok());
    ///     let rays: Vec<Ray3d> = directions.map(|direction| Ray3d::new(Vec3::Y, direction)).collect();
    ///     spatial.cast_rays(&rays, 100.0, &MorphQueryFilter::default(), &mut hits);
    ///     for (ray, hit) in rays.iter().zip(hits.iter()) {
    ///         println!("{:?}: {:?}", ray.direction, hit.map(|hit| hit.distance));
    ///     }
    /// }
    /// # let mut app = App::new();
    /// # app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphCollisionPlugin));
    /// # app.add_systems(Update, scan).update();
    /// ```
    pub fn cast_rays(
        &self,
        rays: &[Ray3d],
        max_distance: f32,
        filter: &MorphQueryFilter,
        hits: &mut Vec<Option<MorphRayHit>>,
    ) {
        let mut batch = QuestionBatch::new();
        batch.sort_rays(rays.iter().map(|ray| [ray.origin.as_dvec3(), ray.direction.as_dvec3()]));
        let found = self.answers(&batch, |walker, index| {
            let Ray3d { origin, direction } = rays[index];
            let cast = self.valid_in("cast_rays", index, RayCast::new(origin, direction, max_distance))?;
            walker.first_hit(&cast, filter, &mut |_| true)
        });
        hits.clear();
        hits.extend(found.iter().map(|hit| Some(self.ray_hit(hit.as_ref()?))));
    }

    /// Answers [`MorphSpatialQuery::project_point`] for many points, faster than one by one. Replaces `projections` by one answer per point,
    /// in the order of the points.
    ///
    /// The answers are the same as one by one. Points are sorted so that neighbours follow each other, and large batches are spread over the
    /// threads of the [`ComputeTaskPool`](bevy::tasks::ComputeTaskPool). An invalid point has no projection.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::{prelude::*, spatial::MorphProjection};
    /// fn hold_off(spatial: MorphSpatialQuery, mut near: Local<Vec<Option<MorphProjection>>>) {
    ///     let mut particles = vec![Vec3::ZERO, Vec3::Y, Vec3::new(0.0, 1.0, 0.5)];
    ///     spatial.project_points(&particles, 0.1, &MorphQueryFilter::default(), &mut near);
    ///     for (particle, near) in particles.iter_mut().zip(near.iter()) {
    ///         if let Some(near) = near {
    ///             *particle = near.point + 0.1 * near.normal;
    ///         }
    ///     }
    /// }
    /// # let mut app = App::new();
    /// # app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphCollisionPlugin));
    /// # app.add_systems(Update, hold_off).update();
    /// ```
    pub fn project_points(
        &self,
        points: &[Vec3],
        max_distance: f32,
        filter: &MorphQueryFilter,
        projections: &mut Vec<Option<MorphProjection>>,
    ) {
        let mut batch = QuestionBatch::new();
        batch.sort_points(points.iter().map(|point| point.as_dvec3()));
        let found = self.answers(&batch, |walker, index| {
            self.valid_in("project_points", index, checked_distance(points[index], max_distance))?;
            walker.closest_point(points[index], max_distance, filter, &mut |_| true)
        });
        projections.clear();
        projections.extend(found.iter().map(|closest| Some(self.projection(closest.as_ref()?))));
    }

    /// Answers [`MorphSpatialQuery::shape_intersections`] for many shapes, faster than one by one. Replaces `intersections` by one list per
    /// shape, in the order of the shapes.
    ///
    /// The answers are the same as one by one. Shapes are sorted so that neighbours follow each other, and large batches are spread over the
    /// threads of the [`ComputeTaskPool`](bevy::tasks::ComputeTaskPool). An invalid shape intersects nothing.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// fn burn(spatial: MorphSpatialQuery, flames: Query<&GlobalTransform>, mut burnt: Local<Vec<Vec<Entity>>>) {
    ///     let ball = MorphShape::Ball { radius: 0.2 };
    ///     let balls: Vec<_> = flames.iter().map(|place| (ball.clone(), place.to_isometry())).collect();
    ///     spatial.intersections_with_shapes(&balls, &MorphQueryFilter::default(), &mut burnt);
    ///     println!("{} flames touch something", burnt.iter().filter(|touched| !touched.is_empty()).count());
    /// }
    /// # let mut app = App::new();
    /// # app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin, MorphCollisionPlugin));
    /// # app.add_systems(Update, burn).update();
    /// ```
    pub fn intersections_with_shapes(
        &self,
        shapes: &[(MorphShape, Isometry3d)],
        filter: &MorphQueryFilter,
        intersections: &mut Vec<Vec<Entity>>,
    ) {
        let mut batch = QuestionBatch::new();
        batch.sort_points(shapes.iter().map(|(_, place)| Vec3::from(place.translation).as_dvec3()));
        *intersections = self.answers(&batch, |walker, index| {
            let (shape, Isometry3d { rotation, translation }) = &shapes[index];
            let placed = place(shape, (*translation).into(), *rotation);
            let placed = self.valid_in("intersections_with_shapes", index, placed);
            placed.map_or_else(Vec::new, |placed| {
                walker.intersections_with(&placed, filter, &mut |_| true)
            })
        });
    }

    /// Answers sorted questions, on several threads if that pays.
    pub(super) fn answers<A: Default + Send>(
        &self,
        batch: &QuestionBatch,
        ask: impl Fn(&mut Walker<'_, '_, '_>, usize) -> A + Sync,
    ) -> Vec<A> {
        let mut answers = Vec::new();
        answers.resize_with(batch.order().len(), A::default);
        let parts = (answers.len() / MIN_QUESTIONS_PER_THREAD).min(TaskPoolWorkers.count());
        batch.answer(parts, &TaskPoolWorkers, &mut answers, |_, chunks, found| {
            if let Some(mut walker) = self.walker() {
                walker.copies = (parts > 1).then(PoseCopies::default);
                for &question in chunks.flatten() {
                    found.push((question, ask(&mut walker, question as usize)));
                }
            }
        });
        answers
    }

    /// [`MorphSpatialQuery::valid`] for a question of a batch. What is logged names its index.
    fn valid_in<T>(&self, method: &'static str, index: usize, asked: Result<T, InputError>) -> Option<T> {
        let named = |mut error: InputError| {
            if let InputError::BadCoordinate { what, .. }
            | InputError::BadNumber { what, .. }
            | InputError::NoDirection { what, .. } = &mut error
            {
                *what = format!("question {index}: {what}");
            }
            error
        };
        self.valid(method, asked.map_err(named))
    }
}
