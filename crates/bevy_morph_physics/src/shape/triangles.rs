//! A few triangles of a mesh as a shape for Parry's own algorithms.

use parry3d::bounding_volume::{Aabb, BoundingSphere};
use parry3d::mass_properties::MassProperties;
use parry3d::math::{Pose, Real, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::details::NormalConstraints;
use parry3d::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use parry3d::shape::{
    CompositeShape, FeatureId, Shape, ShapeType, SubShapeId, Triangle, TrianglePseudoNormals, TypedShape,
};

/// Some triangles of a mesh, gathered for each query about what is near it. There are never many. Their sub-shapes are numbered
/// from 0, because Parry's trees allocate space for every number up to the largest.
#[derive(Clone)]
pub struct Triangles {
    /// Triangle numbers of the mesh. Empty if they are not needed.
    numbers: Vec<u32>,
    corners: Vec<Triangle>,
    /// The normals that contacts with a triangle may have, limited by its neighbours. `None` for triangles without area. Empty if
    /// they are not needed.
    normals: Vec<Option<TrianglePseudoNormals>>,
    bvh: Bvh,
}

impl Triangles {
    /// Triangles of a mesh, with the numbers and normals of each, if these are needed.
    pub fn new(numbers: Vec<u32>, corners: Vec<Triangle>, normals: Vec<Option<TrianglePseudoNormals>>) -> Self {
        let leaves: Vec<Aabb> = corners.iter().map(Triangle::local_aabb).collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
        Self {
            numbers,
            corners,
            normals,
            bvh,
        }
    }

    /// Moves the same triangles. The engine computes contacts with them anew because their collider has changed.
    pub fn move_to(&mut self, triangles: impl Iterator<Item = (Triangle, Option<TrianglePseudoNormals>)>) {
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

    /// The number of triangles.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Whether contacts with a triangle may push in both directions, as those of a thin surface do.
    pub fn pushes_both_ways(&self, subshape: SubShapeId) -> bool {
        let normals = self.normals.get(subshape as usize).and_then(Option::as_ref);
        normals.is_none_or(|normals| normals.two_sided)
    }

    /// A triangle by its sub-shape.
    pub fn triangle(&self, subshape: SubShapeId) -> Option<&Triangle> {
        self.corners.get(subshape as usize)
    }

    /// Converts a sub-shape to the mesh's triangle number.
    pub fn number(&self, subshape: SubShapeId) -> SubShapeId {
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
        let hits = (0..).zip(&self.corners).filter_map(|(subshape, triangle)| {
            let hit = triangle.cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)?;
            Some(RayIntersection { subshape, ..hit })
        });
        hits.min_by(|a, b| a.time_of_impact.total_cmp(&b.time_of_impact))
    }
}

impl PointQuery for Triangles {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        let projections = (0..).zip(&self.corners).map(|(number, triangle)| {
            let projection = triangle.project_local_point(point, solid).with_subshape(number);
            (projection.point.distance_squared(point), projection)
        });
        let closest = projections.min_by(|a, b| a.0.total_cmp(&b.0));
        closest.map_or_else(|| nowhere(point), |(_, projection)| projection)
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, false), FeatureId::Unknown)
    }
}

/// The normals that contacts with a triangle may have: those between its own normal and its neighbours', on either side. Without
/// this limit, bodies that slide over a surface are caught by interior edges.
///
/// Neighbours are given by their third corners, across the edges from a corner to the next. For the surface of a solid body,
/// `outward` says whether the normal, by the triangles' winding, points outward (1) or inward (-1). Contacts then ignore what is
/// inside.
pub fn pseudo_normals(
    corners: [Vector; 3],
    across: [Option<Vector>; 3],
    outward: Option<Real>,
) -> Option<TrianglePseudoNormals> {
    let [a, b, c] = corners;
    let face = (b - a).cross(c - a).try_normalize()?;
    let edge = |from: Vector, to: Vector, across: Option<Vector>| {
        // The neighbour's normal for consistent winding.
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

/// The projection on a shape without points.
pub fn nowhere(point: Vector) -> PointProjection {
    // As far away as possible, so that `distance_to_point` and distance filters exclude it.
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

#[cfg(test)]
mod tests {
    use parry3d::math::Vector;
    use parry3d::shape::{CompositeShape, Triangle};

    use super::Triangles;

    #[test]
    fn contacts_are_only_kept_for_triangles_that_stay_the_same() {
        let corners = vec![Triangle::new(Vector::ZERO, Vector::X, Vector::Y)];
        let gathered = Triangles::new(vec![7], corners.clone(), Vec::new());
        assert!(gathered.is_deformable());
        let of_a_part = Triangles::new(Vec::new(), corners, Vec::new());
        assert!(!of_a_part.is_deformable());
    }
}
