//! A morphing or skinned mesh as a Parry shape.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy::prelude::Entity;
use morph_collision::WorldFromModel;
use parry3d::bounding_volume::{Aabb, BoundingSphere};
use parry3d::mass_properties::MassProperties;
use parry3d::math::{Pose as Isometry, Real, Vector};
use parry3d::query::{PointProjection, Ray, RayCast, RayIntersection};
use parry3d::shape::{FeatureId, Shape, ShapeType, TypedShape};
use tracing::error;

use super::layout::MeshLayout;
use super::posed::Posed;
use super::range::MAX_COORDINATE;
use super::triangles::nowhere;
use crate::posing::LazyPose;

/// The surface of a morphing or skinned mesh as a Parry shape. With Rapier, it is the shape of the `Collider` of a
/// [`MorphPhysicsCollider`](crate::MorphPhysicsCollider).
///
/// The mesh's own tree answers rays and closest points and refits only the nodes that they visit. Everything else is a query about
/// the [triangles](Posed::triangles_in) near the other shape. Like a `TriMesh`, the surface has no inside, unless it is
/// [`solid`](crate::MorphPhysicsCollider::solid). Clones show the same mesh in the same pose.
#[derive(Clone)]
pub struct MorphSurface {
    entity: Entity,
    posed: Arc<Mutex<Posed>>,
    quiet: Arc<AtomicBool>,
    /// Whether a pair with which Parry cannot compute was logged.
    refused: Arc<AtomicBool>,
}

impl MorphSurface {
    /// A surface of the mesh of an entity, in a pose.
    pub fn new(entity: Entity, pose: LazyPose, collider_from_model: WorldFromModel, layout: Arc<MeshLayout>) -> Self {
        let posed = Posed::new(pose, collider_from_model, layout);
        Self {
            entity,
            posed: Arc::new(Mutex::new(posed)),
            quiet: Arc::default(),
            refused: Arc::default(),
        }
    }

    /// Logs, once per surface, that a query about it and another shape is not answered.
    pub fn refuse(&self) {
        if !self.refused.swap(true, Ordering::Relaxed) {
            error!(
                "the surface of entity `{}` does not meet a shape that is larger than {MAX_COORDINATE:e} units, farther away or faster: \
                 Parry cannot compute with it",
                self.entity
            );
        }
    }

    /// Whether its contacts do not matter, because it pushes with its parts and nothing listens for contacts.
    pub fn is_quiet(&self) -> bool {
        self.quiet.load(Ordering::Acquire)
    }

    /// Says whether its contacts do not matter.
    pub fn set_quiet(&self, quiet: bool) {
        self.quiet.store(quiet, Ordering::Release);
    }

    /// Its current state, which nobody else can read in the meantime.
    pub fn lock(&self) -> MutexGuard<'_, Posed> {
        // A query that panicked can only have left its own scratch memory unfinished.
        self.posed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for MorphSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MorphSurface").finish_non_exhaustive()
    }
}

impl RayCast for MorphSurface {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        self.lock().ray(ray, max_time_of_impact, solid).ok().flatten()
    }
}

impl parry3d::query::PointQuery for MorphSurface {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        self.lock().project(point, solid).unwrap_or_else(|| nowhere(point))
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Unknown)
    }
}

impl Shape for MorphSurface {
    fn compute_local_aabb(&self) -> Aabb {
        self.lock().bounds()
    }

    fn compute_aabb(&self, position: &Isometry) -> Aabb {
        self.lock().bounds_at(position)
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.compute_local_aabb().bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// The surface already includes the entity's scale.
    fn scale_dyn(&self, _scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        Some(self.clone_dyn())
    }

    /// The mass of the volume that the surface encloses in the pose of the first call.
    ///
    /// For a mesh with more than about 1,000 triangles, it is computed in the next few physics steps, and is 0 until then. If a dynamic body
    /// carries the surface, it is computed at once, which takes time linear in the size of the mesh.
    fn mass_properties(&self, density: Real) -> MassProperties {
        if density == 0.0 {
            return MassProperties::default();
        }
        self.lock().mass(density)
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }

    fn ccd_thickness(&self) -> Real {
        0.0
    }

    fn ccd_angular_thickness(&self) -> Real {
        std::f32::consts::FRAC_PI_4
    }
}
