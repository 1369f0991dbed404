//! The ground of character controllers: a few triangles of a surface, which exist while controllers run.

use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingSphere};
use bevy_rapier3d::parry::mass_properties::MassProperties;
use bevy_rapier3d::parry::math::{Real, Vector};
use bevy_rapier3d::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use bevy_rapier3d::parry::shape::{CompositeShape, FeatureId, Shape, ShapeType, TypedShape};

use bevy_morph_physics::shape::{Triangles, nowhere};

/// Triangles of a surface that only Parry's default dispatcher sees. Rapier's controllers use that dispatcher to find the ground,
/// whatever the context's dispatcher is. [`MorphQueryDispatcher`](crate::MorphQueryDispatcher), rays and points ignore this
/// shape: they hit the surface itself and must not hit it twice.
#[derive(Clone)]
pub(crate) struct Ground(pub(crate) Triangles);

impl RayCast for Ground {
    fn cast_local_ray_and_get_normal(&self, _ray: &Ray, _max: Real, _solid: bool) -> Option<RayIntersection> {
        None
    }
}

impl PointQuery for Ground {
    fn project_local_point(&self, point: Vector, _solid: bool) -> PointProjection {
        nowhere(point)
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (nowhere(point), FeatureId::Unknown)
    }
}

impl Shape for Ground {
    fn compute_local_aabb(&self) -> Aabb {
        self.0.compute_local_aabb()
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.0.compute_local_bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    fn scale_dyn(&self, _scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        None
    }

    fn mass_properties(&self, _density: Real) -> MassProperties {
        MassProperties::default()
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

    fn as_composite_shape(&self) -> Option<&(dyn CompositeShape + Sync)> {
        Some(&self.0)
    }
}
