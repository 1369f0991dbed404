//! A few triangles of a mesh as a shape for Parry's own algorithms.

use std::sync::OnceLock;

use bevy::math::DVec3;
use parry3d::bounding_volume::{Aabb, BoundingSphere, BoundingVolume};
use parry3d::mass_properties::MassProperties;
use parry3d::math::{Pose, Real, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::details::NormalConstraints;
use parry3d::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use parry3d::shape::{CompositeShape, FeatureId, Shape, ShapeType, SubShapeId, Triangle, TypedShape};

use super::layout::NONE;
use super::normals::NormalLimits;

/// Some triangles of a mesh: a part of a surface, or what a query about two shapes needs. There are never many. Their sub-shapes are
/// numbered from 0, because Parry's trees allocate space for every number up to the largest.
#[derive(Clone)]
pub(crate) struct Triangles {
    /// Triangle numbers of the mesh. Empty if they are not needed.
    numbers: Vec<u32>,
    vertices: Vec<Vector>,
    /// Indices into the vertices.
    corners: Vec<[u32; 3]>,
    /// The third corners of neighbours, across the edges from a corner to the next, or [`NONE`]. Empty if contacts are not needed.
    across: Vec<[u32; 3]>,
    /// See [`NormalLimits`].
    outward: Option<Real>,
    boxes: Vec<Aabb>,
    /// Around all boxes.
    bounds: Aabb,
    /// Not every query needs it.
    bvh: OnceLock<Bvh>,
}

/// The triangles of a part, relative to its origin.
pub(crate) struct PartShape<'a> {
    pub(crate) vertices: &'a [DVec3],
    /// As in [`Triangles`].
    pub(crate) corners: &'a [[u32; 3]],
    pub(crate) across: &'a [[u32; 3]],
    pub(crate) outward: Option<Real>,
}

impl Triangles {
    /// No triangles.
    pub(crate) fn none() -> Self {
        Self {
            numbers: Vec::new(),
            vertices: Vec::new(),
            corners: Vec::new(),
            across: Vec::new(),
            outward: None,
            boxes: Vec::new(),
            bounds: Aabb::new_invalid(),
            bvh: OnceLock::new(),
        }
    }

    /// The triangles of a part.
    pub(crate) fn of(shape: &PartShape<'_>) -> Self {
        let mut triangles = Self {
            corners: shape.corners.to_vec(),
            across: shape.across.to_vec(),
            ..Self::none()
        };
        triangles.move_to(shape);
        triangles
    }

    /// Adds a triangle with a number, and for contacts the third corners of its neighbours.
    pub(crate) fn push(&mut self, number: u32, triangle: [Vector; 3], across: Option<[Option<Vector>; 3]>) {
        let mut add = |vertex: Vector| {
            self.vertices.push(vertex);
            self.vertices.len() as u32 - 1
        };
        self.numbers.push(number);
        self.corners.push(triangle.map(&mut add));
        if let Some(across) = across {
            self.across.push(across.map(|vertex| vertex.map_or(NONE, &mut add)));
        }
        let bounds = Triangle::from(triangle).local_aabb();
        self.bounds.merge(&bounds);
        self.boxes.push(bounds);
        self.bvh = OnceLock::new();
    }

    /// Contacts push one way only; see [`NormalLimits`].
    pub(crate) fn set_outward(&mut self, outward: Option<Real>) {
        self.outward = outward;
    }

    /// Moves the triangles of a part. The engine computes contacts with them anew because their collider has changed.
    pub(crate) fn move_to(&mut self, shape: &PartShape<'_>) {
        self.vertices.clear();
        self.vertices.extend(shape.vertices.iter().map(|vertex| vertex.as_vec3()));
        self.outward = shape.outward;
        self.boxes.clear();
        self.bounds = Aabb::new_invalid();
        for &corners in &self.corners {
            let bounds = triangle(&self.vertices, corners).local_aabb();
            self.bounds.merge(&bounds);
            self.boxes.push(bounds);
        }
        if let Some(bvh) = self.bvh.get_mut() {
            for (bounds, number) in self.boxes.iter().zip(0..) {
                bvh.insert_or_update_partially(*bounds, number, 0.0);
            }
            bvh.refit_without_opt();
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Converts a sub-shape to the mesh's triangle number.
    pub(crate) fn number(&self, subshape: SubShapeId) -> SubShapeId {
        self.numbers.get(subshape as usize).copied().unwrap_or(0)
    }

    /// The triangles whose boxes intersect a box, with the normals that contacts with them may have.
    #[cfg(feature = "rapier")]
    pub(crate) fn near(&self, bounds: &Aabb) -> impl Iterator<Item = (u32, Triangle, Option<NormalLimits>)> {
        let near = (0..).zip(&self.boxes).filter(|(_, other)| other.intersects(bounds));
        near.map(|(number, _)| {
            (number, triangle(&self.vertices, self.corners[number as usize]), self.limits(number))
        })
    }

    fn all(&self) -> impl Iterator<Item = (u32, Triangle)> {
        let triangles = self.corners.iter().map(|&corners| triangle(&self.vertices, corners));
        (0..).zip(triangles)
    }

    fn limits(&self, number: u32) -> Option<NormalLimits> {
        let across = self.across.get(number as usize)?;
        let corners = self.corners.get(number as usize)?;
        Some(NormalLimits {
            corners: corners.map(|corner| self.vertices[corner as usize]),
            across: across.map(|corner| self.vertices.get(corner as usize).copied()),
            outward: self.outward,
        })
    }
}

fn triangle(vertices: &[Vector], corners: [u32; 3]) -> Triangle {
    Triangle::from(corners.map(|corner| vertices[corner as usize]))
}

impl CompositeShape for Triangles {
    fn map_part_at(&self, shape_id: u32, f: &mut dyn FnMut(Option<&Pose>, &dyn Shape, Option<&dyn NormalConstraints>)) {
        if let Some(&corners) = self.corners.get(shape_id as usize) {
            let limits = self.limits(shape_id);
            let limits = limits.as_ref().map(|limits| limits as _);
            f(None, &triangle(&self.vertices, corners), limits);
        }
    }

    fn bvh(&self) -> &Bvh {
        self.bvh.get_or_init(|| Bvh::from_leaves(BvhBuildStrategy::Binned, &self.boxes))
    }

    fn is_deformable(&self) -> bool {
        // Triangles that are gathered for a question may be others than last time under the same numbers, so contacts of last time
        // do not belong to them. The triangles of a part stay the same until its collider is told.
        !self.numbers.is_empty()
    }
}

impl RayCast for Triangles {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        let hits = self.all().filter_map(|(subshape, triangle)| {
            let hit = triangle.cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)?;
            Some(RayIntersection { subshape, ..hit })
        });
        hits.min_by(|a, b| a.time_of_impact.total_cmp(&b.time_of_impact))
    }
}

impl PointQuery for Triangles {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let places = self.all().map(|(number, triangle)| {
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

/// The projection on a shape without points.
pub(crate) fn nowhere(point: Vector) -> PointProjection {
    // As far away as possible, so that `distance_to_point` and distance filters exclude it.
    PointProjection::new(false, point + Vector::MAX)
}

impl Shape for Triangles {
    fn compute_local_aabb(&self) -> Aabb {
        self.bounds
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.compute_local_aabb().bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    fn scale_dyn(&self, scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        let mut scaled = Self::none();
        for (number, triangle) in self.all() {
            scaled.push(self.number(number), triangle.scaled(scale).vertices().map(Vector::from), None);
        }
        Some(Box::new(scaled))
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

#[cfg(test)]
mod tests {
    use parry3d::math::Vector;
    use parry3d::shape::CompositeShape;

    use super::{PartShape, Triangles};

    #[test]
    fn contacts_are_only_kept_for_triangles_that_stay_the_same() {
        let corners = [Vector::ZERO, Vector::X, Vector::Y];
        let mut gathered = Triangles::none();
        gathered.push(7, corners, None);
        assert!(gathered.is_deformable());
        let of_a_part = Triangles::of(&PartShape {
            vertices: &corners.map(|corner| corner.as_dvec3()),
            corners: &[[0, 1, 2]],
            across: &[[3; 3]],
            outward: None,
        });
        assert!(!of_a_part.is_deformable());
    }
}
