//! A few triangles of a mesh as a shape that Parry's own algorithms can work with.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingSphere};
use bevy_rapier3d::parry::mass_properties::MassProperties;
use bevy_rapier3d::parry::math::{Pose, Real, Vector};
use bevy_rapier3d::parry::partitioning::{Bvh, BvhBuildStrategy};
use bevy_rapier3d::parry::query::details::NormalConstraints;
use bevy_rapier3d::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use bevy_rapier3d::parry::shape::{
    CompositeShape, FeatureId, Shape, ShapeType, SubShapeId, Triangle, TrianglePseudoNormals, TypedShape,
};

/// Triangles of a mesh, gathered anew whenever something asks what is near it: there are never many. Their sub-shapes are
/// numbered from 0, since Parry's trees have room for every number up to the largest.
#[derive(Clone)]
pub(super) struct Triangles {
    /// As the mesh numbers them; none if nobody asks.
    numbers: Vec<u32>,
    corners: Vec<Triangle>,
    /// Which normals contacts with a triangle may have, next to its neighbours; none for triangles with no area, and none at
    /// all if nobody asks.
    normals: Vec<Option<TrianglePseudoNormals>>,
    bvh: Bvh,
}

impl Triangles {
    pub(super) fn new(numbers: Vec<u32>, corners: Vec<Triangle>, normals: Vec<Option<TrianglePseudoNormals>>) -> Self {
        let leaves: Vec<Aabb> = corners.iter().map(Triangle::local_aabb).collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
        Self {
            numbers,
            corners,
            normals,
            bvh,
        }
    }

    /// The same triangles elsewhere.
    pub(super) fn move_to(&mut self, triangles: impl Iterator<Item = (Triangle, Option<TrianglePseudoNormals>)>) {
        self.corners.clear();
        self.normals.clear();
        for (corners, normals) in triangles {
            self.corners.push(corners);
            self.normals.push(normals);
        }
        for (triangle, number) in self.corners.iter().zip(0..) {
            self.bvh.insert_or_update_partially(triangle.local_aabb(), number, 0.0);
        }
        self.bvh.refit_without_opt();
    }

    pub(super) fn len(&self) -> usize {
        self.corners.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The mesh's number of a sub-shape.
    pub(super) fn number(&self, subshape: SubShapeId) -> SubShapeId {
        self.numbers.get(subshape as usize).copied().unwrap_or(0)
    }
}

impl CompositeShape for Triangles {
    fn map_part_at(&self, shape_id: u32, f: &mut dyn FnMut(Option<&Pose>, &dyn Shape, Option<&dyn NormalConstraints>)) {
        if let Some(triangle) = self.corners.get(shape_id as usize) {
            let normals = self.normals.get(shape_id as usize).and_then(Option::as_ref);
            f(None, triangle, normals.map(|normals| normals as _));
        }
    }

    fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    fn is_deformable(&self) -> bool {
        true
    }
}

impl RayCast for Triangles {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        let hits = (0..).zip(&self.corners).filter_map(|(subshape, triangle)| {
            let hit = triangle.cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)?;
            Some(RayIntersection { subshape, ..hit })
        });
        hits.min_by(|a, b| a.time_of_impact.total_cmp(&b.time_of_impact))
    }
}

impl PointQuery for Triangles {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let places = (0..).zip(&self.corners).map(|(number, triangle)| {
            let place = triangle.project_local_point(point, solid).with_subshape(number);
            (place.point.distance_squared(point), place)
        });
        let closest = places.min_by(|a, b| a.0.total_cmp(&b.0));
        closest.map_or_else(|| nowhere(point), |(_, place)| place)
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Unknown)
    }
}

/// Which normals contacts with a triangle may have: those between its own and its neighbours', on either side. Without that what
/// slides over a surface is caught by edges inside it.
///
/// Neighbours are given by their third corners, across the edges from a corner to the next. Of a solid body's surface `outward`
/// says whether the normal as triangles are wound points outward, 1 or -1; then what is inside is left alone.
pub(super) fn pseudo_normals(
    corners: [Vector; 3],
    across: [Option<Vector>; 3],
    outward: Option<Real>,
) -> Option<TrianglePseudoNormals> {
    let [a, b, c] = corners;
    let face = (b - a).cross(c - a).try_normalize()?;
    let edge = |from: Vector, to: Vector, across: Option<Vector>| {
        // Wound as it would be if it went around as this one does.
        let neighbour = across.and_then(|third| (from - to).cross(third - to).try_normalize());
        neighbour
            .and_then(|neighbour| (face + neighbour).try_normalize())
            .unwrap_or(face)
    };
    let sign = outward.unwrap_or(1.0);
    Some(TrianglePseudoNormals {
        face: sign * face,
        edges: [edge(a, b, across[0]), edge(b, c, across[1]), edge(c, a, across[2])].map(|edge| sign * edge),
        two_sided: outward.is_none(),
    })
}

/// The projection on a shape that has no points.
pub(super) fn nowhere(point: Vector) -> PointProjection {
    // As far away as can be said: `distance_to_point` and filters by distance leave it out.
    PointProjection::new(false, point + Vector::MAX)
}

impl Shape for Triangles {
    fn compute_local_aabb(&self) -> Aabb {
        self.bvh.root_aabb()
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.compute_local_aabb().bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    fn scale_dyn(&self, scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        let scaled = self.corners.iter().map(|triangle| triangle.scaled(scale)).collect();
        Some(Box::new(Self::new(self.numbers.clone(), scaled, Vec::new())))
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
        Some(self)
    }
}

/// The part of a surface that pushes bodies during a step, and is not there for anyone else.
#[derive(Clone)]
pub(super) struct Patch {
    pub(super) triangles: Triangles,
    /// Whether a step is going on, in which it exists.
    pub(super) stepping: Arc<AtomicBool>,
}

impl Patch {
    /// The triangles, while they exist.
    pub(super) fn present(&self) -> Option<&Triangles> {
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
        self.triangles.compute_local_aabb()
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.triangles.compute_local_bounding_sphere()
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
        self.present().map(|triangles| triangles as _)
    }
}
