//! How a volume stands to exact points: what the tests of the error bounds measure.

use std::array::from_fn;

use glam::Vec3;
use morph_collision_testkit::oracle::Dyadic;

use super::directions::{direction, length};
use super::slab_map::SlabMap;
use super::slabs::Slab;
use super::spheres::{Sphere, SphereMap};
use super::{Slabs, Spheres, Volume};

/// An exact point.
pub(crate) type ExactPoint = [Dyadic; 3];

/// Where a map should have taken a point, times a determinant, and how far beside it a body's point may lie.
#[derive(Debug)]
pub(crate) struct Image {
    /// Positive.
    pub(crate) determinant: Dyadic,
    pub(crate) scaled: ExactPoint,
    /// Rows of a matrix, times the determinant, and the largest coordinates of the vector that it takes to an offset.
    pub(crate) scaled_offset: ([ExactPoint; 3], ExactPoint),
}

/// A volume that can be measured against exact points.
pub(crate) trait Probe: Volume {
    /// The volume of one point whose coordinates have few bits.
    fn at(point: Vec3) -> Self::One;
    /// [`Volume::contains`], exactly.
    fn holds(one: &Self::One, point: &ExactPoint) -> bool;
    /// The least that [`Volume::widen`] must be given for the volume to hold a point; negative for a point inside.
    fn lack(one: &Self::One, point: &ExactPoint) -> f64;
    /// The share of a map's slack that is needed for the mapped volume of a point to hold its image.
    fn slack_used(map: &Self::Map, point: &Self::One, image: &Image) -> f64;
}

fn along(normal: [i8; 3], point: &ExactPoint) -> Dyadic {
    let terms = normal.into_iter().zip(point);
    terms
        .map(|(n, coordinate)| Dyadic::from(f32::from(n)) * coordinate.clone())
        .sum()
}

impl Image {
    /// How far along a direction an offset may reach, times the determinant.
    fn offset_along(&self, normal: [i8; 3]) -> Dyadic {
        let (rows, reach) = &self.scaled_offset;
        let of = |column: usize| along(normal, &from_fn(|row| rows[row][column].clone()));
        (0..3).map(|column| of(column).abs() * reach[column].clone()).sum()
    }
}

impl<const H: usize> Probe for Slabs<H> {
    fn at(point: Vec3) -> Slab<H> {
        let ends = from_fn(|i| Vec3::from_array(direction(H, i).map(f32::from)).dot(point));
        Slab { min: ends, max: ends }
    }

    fn holds(one: &Slab<H>, point: &ExactPoint) -> bool {
        (0..H).all(|i| {
            let along = along(direction(H, i), point);
            Dyadic::from(one.min[i]) <= along && along <= Dyadic::from(one.max[i])
        })
    }

    fn lack(one: &Slab<H>, point: &ExactPoint) -> f64 {
        let beyond = |i: usize| {
            let along = along(direction(H, i), point);
            let below = Dyadic::from(one.min[i]) - along.clone();
            below.max(along - Dyadic::from(one.max[i])).to_f64() / f64::from(length(H, i))
        };
        (0..H).map(beyond).fold(f64::NEG_INFINITY, f64::max)
    }

    fn slack_used(map: &SlabMap<H>, point: &Slab<H>, image: &Image) -> f64 {
        let mapped = Self::map_one(map, point);
        let used = |i: usize| {
            let normal = direction(H, i);
            let (along, offset) = (along(normal, &image.scaled), image.offset_along(normal));
            let end = |end: f32| Dyadic::from(end) * image.determinant.clone();
            let room_below = along.clone() - offset.clone() - end(mapped.min[i]);
            let room = room_below.min(end(mapped.max[i]) - along - offset);
            let twice_slack = Dyadic::from(map.offset_max[i]) - Dyadic::from(map.offset_min[i]);
            1.0 - 2.0 * room.ratio(&(twice_slack * image.determinant.clone()))
        };
        (0..H).map(used).fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Probe for Spheres {
    fn at(point: Vec3) -> Sphere {
        Sphere {
            center: point,
            radius: 0.0,
        }
    }

    fn holds(one: &Sphere, point: &ExactPoint) -> bool {
        let square = |x: Dyadic| x.clone() * x;
        let squared = (0..3).map(|i| square(point[i].clone() - Dyadic::from(one.center[i])));
        one.radius >= 0.0 && squared.sum::<Dyadic>() <= square(Dyadic::from(one.radius))
    }

    fn lack(one: &Sphere, point: &ExactPoint) -> f64 {
        let apart = |i: usize| (point[i].clone() - Dyadic::from(one.center[i])).to_f64();
        let distance = apart(0).hypot(apart(1)).hypot(apart(2));
        (distance - f64::from(one.radius)) / 4.0
    }

    fn slack_used(map: &SphereMap, point: &Sphere, image: &Image) -> f64 {
        let mapped = Self::map_one(map, point);
        let apart = |i: usize| {
            let center = Dyadic::from(mapped.center[i]) * image.determinant.clone();
            let mut normal = [0; 3];
            normal[i] = 1;
            ((image.scaled[i].clone() - center).abs() + image.offset_along(normal)).ratio(&image.determinant)
        };
        apart(0).hypot(apart(1)).hypot(apart(2)) / f64::from(mapped.radius)
    }
}
