//! The part of a surface that pushes bodies during a step, as a shape.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use parry3d::bounding_volume::{Aabb, BoundingSphere, BoundingVolume};
use parry3d::mass_properties::MassProperties;
use parry3d::math::{Real, Vector};
use parry3d::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use parry3d::shape::{CompositeShape, FeatureId, Shape, ShapeType, TypedShape};

use super::triangles::{Triangles, nowhere};

/// The part of a surface that pushes bodies during a step, and is invisible to everything else.
#[derive(Clone)]
pub struct Patch {
    /// Its triangles, relative to its origin.
    pub triangles: Triangles,
    /// Set while a step is in progress. The part exists only then.
    pub stepping: Arc<AtomicBool>,
    /// How much larger its box is than its triangles.
    pub reach: Real,
    /// How far ahead it prepares contacts in this step, besides the usual distance; at most `reach`.
    pub look_ahead: LookAhead,
    /// Its linear and angular velocity in the step, per second, about its origin.
    pub velocity: [Vector; 2],
}

/// A distance that can be set without a change of the shape in the engine.
#[derive(Clone, Debug, Default)]
pub struct LookAhead(Arc<AtomicU32>);

impl LookAhead {
    /// Sets the distance.
    pub fn set(&self, distance: Real) {
        self.0.store(distance.to_bits(), Ordering::Relaxed);
    }

    /// The distance.
    pub fn get(&self) -> Real {
        Real::from_bits(self.0.load(Ordering::Relaxed))
    }
}

impl Patch {
    /// The triangles, while they exist.
    pub fn present(&self) -> Option<&Triangles> {
        self.stepping.load(Ordering::Acquire).then_some(&self.triangles)
    }
}

impl RayCast for Patch {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        self.present()?
            .cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)
    }
}

impl PointQuery for Patch {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let present = self.present();
        present.map_or_else(
            || nowhere(point),
            |triangles| triangles.project_local_point(point, solid),
        )
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Unknown)
    }
}

impl Shape for Patch {
    fn compute_local_aabb(&self) -> Aabb {
        self.triangles.compute_local_aabb().loosened(self.reach)
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.triangles.compute_local_bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// Parts are not scaled.
    fn scale_dyn(&self, _scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        Some(self.clone_dyn())
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
        self.present().map(|triangles| triangles as _)
    }
}
