//! A whole surface, as Avian's queries see it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use bevy_morph_physics::shape::{MorphSurface, Triangles, nowhere};
use parry3d::bounding_volume::{Aabb, BoundingSphere};
use parry3d::mass_properties::MassProperties;
use parry3d::math::{Pose as Isometry, Real, Vector};
use parry3d::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use parry3d::shape::{CompositeShape, FeatureId, Shape, ShapeType, TypedShape};

/// A surface in one pose.
///
/// The mesh's own tree answers rays and closest points. For queries against another shape, Avian uses Parry's own dispatcher,
/// which needs all triangles. They are gathered on the first such query.
#[derive(Clone)]
pub(crate) struct WholeSurface {
    surface: MorphSurface,
    /// Whether contacts are made with the whole surface instead of its parts.
    has_contacts: bool,
    /// Set while contacts are computed.
    stepping: Arc<AtomicBool>,
    all: OnceLock<Triangles>,
}

impl WholeSurface {
    /// Takes the surface in its current state. Later changes need a new value.
    pub(crate) fn new(surface: MorphSurface, has_contacts: bool, stepping: Arc<AtomicBool>) -> Self {
        Self {
            surface,
            has_contacts,
            stepping,
            all: OnceLock::new(),
        }
    }

    /// Whether the shape answers queries. While contacts are computed, the parts answer instead, unless contacts are made with
    /// the whole surface.
    fn answers(&self) -> bool {
        self.has_contacts || !self.stepping.load(Ordering::Acquire)
    }
}

impl RayCast for WholeSurface {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        self.surface
            .cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)
    }
}

impl PointQuery for WholeSurface {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        if self.answers() {
            self.surface.project_local_point(point, solid)
        } else {
            // Parry's contacts with balls use this method.
            nowhere(point)
        }
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Unknown)
    }
}

impl Shape for WholeSurface {
    fn compute_local_aabb(&self) -> Aabb {
        self.surface.compute_local_aabb()
    }

    fn compute_aabb(&self, position: &Isometry) -> Aabb {
        self.surface.compute_aabb(position)
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.surface.compute_local_bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// The surface already includes the entity's scale.
    fn scale_dyn(&self, _scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        Some(self.clone_dyn())
    }

    fn mass_properties(&self, density: Real) -> MassProperties {
        self.surface.mass_properties(density)
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }

    fn ccd_thickness(&self) -> Real {
        self.surface.ccd_thickness()
    }

    fn ccd_angular_thickness(&self) -> Real {
        self.surface.ccd_angular_thickness()
    }

    fn as_composite_shape(&self) -> Option<&(dyn CompositeShape + Sync)> {
        self.answers()
            .then(|| self.all.get_or_init(|| self.surface.lock().all_triangles(true)) as _)
    }
}
