//! A box along the axes of the world.

use bevy::math::{DMat3, DVec3, Vec3};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Pose as Isometry;

use crate::math::{affine_of, collider_from_world, precise};
use morph_collision::WorldFromModel;

/// A box along the axes of the world around a surface whose collider is somewhere.
#[derive(Clone, Copy)]
pub struct PlacedBounds {
    bounds: Aabb,
    collider: Isometry,
}

/// Larger coordinates are for the box of a pose.
const LARGEST: f32 = 1e15;

impl PlacedBounds {
    /// From a box around the drawn mesh. `missing` is the largest difference between 1 and the sum of a vertex's joint weights: it pulls the
    /// drawn mesh to the origin of the world, and the surface to that of its collider.
    ///
    /// `None` if the numbers are so large that conversions could overflow.
    pub fn new(bounds: &morph_collision::Aabb, missing: f32, collider: Isometry) -> Option<Self> {
        let corners = [bounds.min, bounds.max];
        // False for NaN.
        let fits = corners.map(|corner| corner.abs().max_element() <= LARGEST) == [true; 2];
        // Joints in the collider's space are rounded.
        let distances = corners.map(|corner| (corner - collider.translation).abs().max_element());
        let rounding = 1e-6 * distances[0].max(distances[1]);
        let pull = missing * collider.translation.abs().max_element();
        fits.then(|| Self {
            bounds: Aabb::new(bounds.min, bounds.max).loosened(rounding + pull),
            collider,
        })
    }

    /// A box around both, which are of the same collider.
    pub fn hull(&self, other: &Self) -> Self {
        if self.collider == other.collider {
            return Self {
                bounds: self.bounds.merged(&other.bounds),
                collider: self.collider,
            };
        }
        Self {
            bounds: self.in_collider().merged(&other.in_collider()),
            collider: Isometry::IDENTITY,
        }
    }

    /// The box along the axes of the collider around this one.
    pub fn in_collider(&self) -> Aabb {
        if self.collider == Isometry::IDENTITY {
            return self.bounds;
        }
        let to_collider = collider_from_world(&self.collider);
        let [min, max] = [self.bounds.mins, self.bounds.maxs].map(Vec3::as_dvec3);
        let middle = to_collider.transform_point3(0.5 * (min + max));
        let columns = [
            to_collider.matrix3.x_axis,
            to_collider.matrix3.y_axis,
            to_collider.matrix3.z_axis,
        ];
        let half = DMat3::from_cols_array_2d(&columns.map(|column| column.abs().to_array())) * (0.5 * (max - min));
        let outward = |corner: DVec3, round: fn(f32) -> f32| corner.as_vec3().map(round);
        Aabb::new(
            outward(middle - half, f32::next_down),
            outward(middle + half, f32::next_up),
        )
    }

    /// The box while the collider is at `place`.
    pub fn at(&self, place: &Isometry) -> Aabb {
        if self.collider == *place {
            self.bounds
        } else {
            self.in_collider().transform_by(place)
        }
    }

    /// The box, if the collider is at `place`.
    pub fn at_exactly(&self, place: &WorldFromModel) -> Option<Aabb> {
        let own = precise(&affine_of(&self.collider));
        let is_there = own.matrix3 == place.linear() && own.translation == place.translation();
        is_there.then_some(self.bounds)
    }
}
