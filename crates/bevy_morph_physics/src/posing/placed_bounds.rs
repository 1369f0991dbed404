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
    /// From a box around the drawn mesh. `moved` is a bound on how far from the origin joints take vertices, apart from their translation.
    /// `missing` is the largest difference between 1 and the sum of a vertex's joint weights: it pulls the drawn mesh to the origin of the
    /// world, and the surface to that of its collider.
    ///
    /// `None` if the numbers are so large that conversions could overflow.
    pub fn new(bounds: &morph_collision::Aabb, moved: f64, missing: f64, collider: Isometry) -> Option<Self> {
        let corners = [bounds.min, bounds.max];
        // False for NaN.
        let fits = |corner: Vec3| corner.abs().cmple(Vec3::splat(LARGEST)).all();
        if !corners.into_iter().all(fits) {
            return None;
        }
        let [min, max] = corners.map(Vec3::as_dvec3);
        let place = collider.translation.as_dvec3();
        let far = (min - place).abs().max((max - place).abs()).max_element();
        // Joints in the collider's space are rounded, and again between frames.
        let by = 1e-6 * (far + moved) + missing * place.abs().max_element();
        Some(Self {
            bounds: outward(min - by, max + by),
            collider,
        })
    }

    /// A box around both, which are of one surface, whose collider may have moved.
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
        outward(middle - half, middle + half)
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

/// A box around one in `f64`.
fn outward(min: DVec3, max: DVec3) -> Aabb {
    Aabb::new(min.as_vec3().map(f32::next_down), max.as_vec3().map(f32::next_up))
}
