use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

use super::frame::{LARGEST, MAP_ROUNDINGS};
use super::rounding::{U32, up};
use super::slabs::Extent;
use super::{Aabb, BoxLanes, Frame, LANES, Lanes, Points, Volume};

/// Eight spheres (the paper's Eq. 7, and displacement balls as in James and Pai's BD-tree).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub(crate) struct Spheres {
    /// Centre x, y, z and radius.
    rows: [Lanes; 4],
}

/// One sphere, closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sphere {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
}

/// A sphere's way to another frame.
#[derive(Clone, Debug)]
pub(crate) struct SphereMap {
    rows: [Vec3; 3],
    translation: Vec3,
    stretch: f32,
    slack: f32,
}

/// How much longer a vector is than its largest coordinate, at most.
const SQRT_3: f64 = 1.732_050_807_568_877_3;

impl Spheres {
    fn sphere_at(center: Vec3, points: Points<'_>) -> Sphere {
        Sphere {
            center,
            radius: up(radius_around(center.as_dvec3(), points)),
        }
    }
}

/// The largest distance from a centre, not rounded down.
fn radius_around(center: DVec3, points: Points<'_>) -> f64 {
    let (mut squared, mut reach) = (0.0_f64, center.abs().max_element());
    points(&mut |p| {
        squared = squared.max(p.distance_squared(center));
        reach = reach.max(p.abs().max_element());
    });
    squared.sqrt() * (1.0 + 8.0 * f64::EPSILON) + 16.0 * f64::EPSILON * reach
}

/// As [`Spheres::overlap`], eight at a time.
#[inline(always)]
fn meeting<S: Simd>(simd: S, [x, y, z]: [f32x8<S>; 3], radius: f32x8<S>, other: &Sphere) -> u8 {
    let x = x - f32x8::splat(simd, other.center.x);
    let y = y - f32x8::splat(simd, other.center.y);
    let z = z - f32x8::splat(simd, other.center.z);
    let distance_squared = x * x + y * y + z * z;
    let reach = radius + f32x8::splat(simd, other.radius);
    let below = distance_squared * f32x8::splat(simd, 1.0 - 8.0 * f32::EPSILON) - f32x8::splat(simd, f32::MIN_POSITIVE);
    let overlap = below.simd_le(reach * reach) | reach.simd_gt(f32x8::splat(simd, 1e18));
    overlap.to_bitmask() as u8
}

impl Volume for Spheres {
    type One = Sphere;
    type Map = SphereMap;
    type Extent = Extent<3>;

    const LOOKS_AT_POINTS: bool = true;
    const ROWS: usize = 4;

    fn rows(&self) -> &[Lanes] {
        &self.rows
    }

    fn rows_mut(&mut self) -> &mut [Lanes] {
        &mut self.rows
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> Sphere {
        let [x, y, z, radius] = &self.rows;
        let lane = lane % LANES;
        let [x, y, z, radius] = [x.0[lane], y.0[lane], z.0[lane], radius.0[lane]];
        Sphere {
            center: Vec3::new(x, y, z),
            radius,
        }
    }

    fn set(&mut self, lane: usize, one: &Sphere) {
        for (row, value) in self.rows.iter_mut().zip(one.center.extend(one.radius).to_array()) {
            row.0[lane] = value;
        }
    }

    /// The centre follows the middle of the displacements, the radius grows with the weight's magnitude.
    #[inline(always)]
    fn add_interval<S: Simd>(&mut self, simd: S, weight: f32, slopes: &Self) {
        let [x, y, z, radius] = &mut self.rows;
        x.add_scaled(simd, weight, &slopes.rows[0]);
        y.add_scaled(simd, weight, &slopes.rows[1]);
        z.add_scaled(simd, weight, &slopes.rows[2]);
        radius.add_scaled(simd, weight.abs(), &slopes.rows[3]);
    }

    /// Centres go to the nearest multiple, which the radius makes up for.
    fn quantize(&self, scale: f32, numbers: &mut Vec<i16>) {
        let [x, y, z, radius] = &self.rows;
        numbers.extend(
            [x, y, z]
                .iter()
                .flat_map(|row| row.0.map(|c| (c / scale).round() as i16)),
        );
        // Half a multiple per coordinate is less than one multiple of distance. Lanes that stay put stay so.
        let still = |lane: usize| self.rows.iter().all(|row| row.0[lane] == 0.0);
        let rounded = |lane: usize| (radius.0[lane] / scale).ceil() as i16 + 1;
        numbers.extend((0..LANES).map(|lane| if still(lane) { 0 } else { rounded(lane) }));
    }

    /// Centre and radius may be off by the root of 3 times a coordinate's error each.
    #[inline(always)]
    fn widen<S: Simd>(&mut self, simd: S, by: f32) {
        self.rows[3].add(simd, 4.0 * by);
    }

    fn fit(&mut self, lane: usize, points: &[Vec3]) {
        let center = Aabb::from_points(points.iter().copied()).center();
        let sphere = Self::sphere_at(center, &|each| points.iter().for_each(|p| each(p.as_dvec3())));
        self.set(lane, &sphere);
    }

    fn map(frame: &Frame) -> Option<SphereMap> {
        // The largest stretch is the root of the largest eigenvalue of M^T M, which no row sum falls short of.
        let gram = frame.linear.transpose() * frame.linear;
        let row_sums = DVec3::new(
            gram.row(0).abs().element_sum(),
            gram.row(1).abs().element_sum(),
            gram.row(2).abs().element_sum(),
        );
        let stretch = row_sums.max_element().sqrt() * (1.0 + 16.0 * f64::EPSILON);
        // Radii are as large as the root of 3 times the coordinates, centres as the coordinates.
        let largest = frame.magnitude.max_element();
        let reach = frame.reach().max_element() + 4.0 * stretch * largest;
        let slack = SQRT_3 * frame.error.max_element() + 2.0 * MAP_ROUNDINGS * U32 * reach + 4.0 * frame.underflow();
        let largest = reach.max(slack).max(stretch);
        if !largest.is_finite() || largest > LARGEST {
            return None;
        }
        let linear = frame.linear.as_mat3();
        Some(SphereMap {
            rows: [linear.row(0), linear.row(1), linear.row(2)],
            translation: frame.translation.as_vec3(),
            stretch: up(stretch),
            slack: up(slack),
        })
    }

    fn map_one(map: &SphereMap, one: &Sphere) -> Sphere {
        Sphere {
            center: Vec3::from_array(map.rows.map(|row| row.dot(one.center))) + map.translation,
            radius: one.radius * map.stretch + map.slack,
        }
    }

    #[inline(always)]
    fn map_all<S: Simd>(&self, simd: S, map: &SphereMap, mapped: &mut Self) {
        let [x, y, z, radius] = &self.rows;
        let source = [x.load(simd), y.load(simd), z.load(simd)];
        for (i, (row, offset)) in map.rows.iter().zip(map.translation.to_array()).enumerate() {
            let center = source[0] * f32x8::splat(simd, row.x)
                + source[1] * f32x8::splat(simd, row.y)
                + source[2] * f32x8::splat(simd, row.z)
                + f32x8::splat(simd, offset);
            center.store_slice(&mut mapped.rows[i].0);
        }
        let radius = radius.load(simd) * f32x8::splat(simd, map.stretch) + f32x8::splat(simd, map.slack);
        radius.store_slice(&mut mapped.rows[3].0);
    }

    #[inline(always)]
    fn depths<S: Simd>(&self, simd: S, other: &Sphere, depths: &mut [f32; LANES]) {
        let [x, y, z, radius] = &self.rows;
        let x = x.load(simd) - f32x8::splat(simd, other.center.x);
        let y = y.load(simd) - f32x8::splat(simd, other.center.y);
        let z = z.load(simd) - f32x8::splat(simd, other.center.z);
        let apart = (x * x + y * y + z * z).sqrt();
        (radius.load(simd) + f32x8::splat(simd, other.radius) - apart).store_slice(depths);
    }

    #[inline(always)]
    fn overlap_mask<S: Simd>(&self, simd: S, other: &Sphere) -> u8 {
        let [x, y, z, radius] = &self.rows;
        meeting(
            simd,
            [x.load(simd), y.load(simd), z.load(simd)],
            radius.load(simd),
            other,
        )
    }

    /// Rounded in favour of an overlap; sums that overflow or underflow are one, too.
    #[inline]
    fn overlap(a: &Sphere, b: &Sphere) -> bool {
        let distance_squared = a.center.distance_squared(b.center);
        let reach = a.radius + b.radius;
        // The differences, squares and sums are off by at most 8 halves of a unit, the centres' own error is in the radii.
        distance_squared * (1.0 - 8.0 * f32::EPSILON) - f32::MIN_POSITIVE <= reach * reach || reach > 1e18
    }

    fn gap(a: &Sphere, b: &Sphere) -> f64 {
        let distance = a.center.as_dvec3().distance(b.center.as_dvec3());
        distance * (1.0 - 8.0 * f64::EPSILON) - (f64::from(a.radius) + f64::from(b.radius)) * (1.0 + 8.0 * f64::EPSILON)
    }

    fn size(one: &Sphere) -> f32 {
        2.0 * one.radius
    }

    fn hull(&self, lanes: u8) -> Sphere {
        let spheres = || {
            (0..LANES)
                .filter(|lane| lanes >> lane & 1 == 1)
                .map(|lane| self.get(lane))
        };
        let boxes = spheres().map(|sphere| Self::bounds(&sphere));
        let center = boxes.fold(Aabb::EMPTY, |hull, bounds| hull.union(&bounds)).center();
        let reach = |s: Sphere| s.center.as_dvec3().distance(center.as_dvec3()) + f64::from(s.radius);
        Sphere {
            center,
            radius: up(spheres().map(reach).fold(0.0, f64::max) * (1.0 + 8.0 * f64::EPSILON)),
        }
    }

    fn contains(one: &Sphere, point: DVec3) -> bool {
        one.center.as_dvec3().distance(point) <= f64::from(one.radius)
    }

    fn bounds(one: &Sphere) -> Aabb {
        // One unit in the last place of the largest coordinate for each sum.
        let reach = (one.center.abs() + one.radius) * (1.0 + f32::EPSILON);
        let half = Vec3::splat(one.radius) + f32::EPSILON * reach;
        Aabb {
            min: one.center - half,
            max: one.center + half,
        }
    }

    fn extent(points: Points<'_>) -> Extent<3> {
        BoxLanes::extent(points)
    }

    fn union(a: &Extent<3>, b: &Extent<3>) -> Extent<3> {
        BoxLanes::union(a, b)
    }

    fn base(extent: &Extent<3>, points: Points<'_>) -> Sphere {
        Self::sphere_at(extent.center().as_vec3(), points)
    }

    /// The slope of the centre is fixed in `f32` first; the reference's sphere is then measured around the centre it leads to.
    fn slope(base: &Sphere, reference: &Extent<3>, points: Points<'_>, scale: f64) -> Sphere {
        let base_center = base.center.as_dvec3();
        let center = ((reference.center() - base_center) / scale).as_vec3();
        let radius = radius_around(base_center + scale * center.as_dvec3(), points);
        Sphere {
            center,
            radius: up((radius - f64::from(base.radius)) / scale),
        }
    }

    fn interval(displacements: &Extent<3>, points: Points<'_>) -> Sphere {
        Self::sphere_at(displacements.center().as_vec3(), points)
    }

    fn looseness(slope: &Sphere) -> f64 {
        f64::from(slope.radius)
    }
}
