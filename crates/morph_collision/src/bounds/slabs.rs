use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};
use glam::{DVec3, Vec3};

use super::directions::{along, direction, length};
use super::rounding::{down, up};
use super::slab_map::SlabMap;
use super::{Aabb, Frame, LANES, Lanes, Points, Volume};

/// Eight k-DOPs of `H` slabs: boxes (3), 14-DOPs (7), 18-DOPs (9) or 26-DOPs (13).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub(crate) struct Slabs<const H: usize> {
    /// Lower ends, then upper ends, along each direction.
    ends: [[Lanes; H]; 2],
}

/// Eight boxes.
pub(crate) type BoxLanes = Slabs<3>;

/// One k-DOP.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slab<const H: usize> {
    pub(crate) min: [f32; H],
    pub(crate) max: [f32; H],
}

impl<const H: usize> Default for Slab<H> {
    fn default() -> Self {
        Self {
            min: [0.0; H],
            max: [0.0; H],
        }
    }
}

impl BoxLanes {
    /// The lower and upper ends along an axis.
    #[inline]
    pub(super) fn along(&self, axis: usize) -> (&Lanes, &Lanes) {
        (&self.ends[0][axis], &self.ends[1][axis])
    }
}

impl BoxLanes {
    /// Makes these the boxes between corners.
    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, min: [f32x8<S>; 3], max: [f32x8<S>; 3]) {
        for (rows, corner) in self.ends.iter_mut().zip([min, max]) {
            for (row, coordinate) in rows.iter_mut().zip(corner) {
                coordinate.store_slice(&mut row.0);
            }
        }
    }
}

impl BoxLanes {
    /// The box around all eight.
    #[inline(always)]
    pub(crate) fn hull_of_all(&self) -> Slab<3> {
        let [mins, maxs] = &self.ends;
        let mut hull = Slab::default();
        for i in 0..3 {
            hull.min[i] = mins[i].least();
            hull.max[i] = maxs[i].most();
        }
        hull
    }
}

impl Slab<3> {
    pub(crate) fn of_box(bounds: &Aabb) -> Self {
        Self {
            min: bounds.min.to_array(),
            max: bounds.max.to_array(),
        }
    }
}

/// What points span along each direction, and the largest coordinate magnitude among them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent<const H: usize> {
    min: [f64; H],
    max: [f64; H],
    reach: f64,
}

impl<const H: usize> Extent<H> {
    const EMPTY: Self = Self {
        min: [f64::INFINITY; H],
        max: [f64::NEG_INFINITY; H],
        reach: 0.0,
    };

    fn add(&mut self, p: DVec3) {
        for i in 0..H {
            let x = along(H, i, p);
            self.min[i] = self.min[i].min(x);
            self.max[i] = self.max[i].max(x);
        }
        self.reach = self.reach.max(p.abs().max_element());
    }

    /// The middle of the points' box.
    pub(super) fn center(&self) -> DVec3 {
        DVec3::new(
            0.5 * (self.min[0] + self.max[0]),
            0.5 * (self.min[1] + self.max[1]),
            0.5 * (self.min[2] + self.max[2]),
        )
    }

    /// Both ends, padded by the roundings of the sums they come from, and then rounded outward. Along the axes no sum is
    /// involved when the points themselves are not sums.
    fn outward(&self) -> Slab<H> {
        let pad = |i: usize| if i < 3 { 0.0 } else { self.pad() };
        Slab {
            min: std::array::from_fn(|i| down(self.min[i] - pad(i))),
            max: std::array::from_fn(|i| up(self.max[i] + pad(i))),
        }
    }

    /// Covers a few `f64` roundings of sums of coordinates.
    fn pad(&self) -> f64 {
        8.0 * f64::EPSILON * self.reach
    }
}

impl<const H: usize> Default for Slabs<H> {
    fn default() -> Self {
        Self {
            ends: [[Lanes::default(); H]; 2],
        }
    }
}

impl<const H: usize> Volume for Slabs<H> {
    type One = Slab<H>;
    type Map = SlabMap<H>;
    type Extent = Extent<H>;

    const LOOKS_AT_POINTS: bool = false;
    const ROWS: usize = 2 * H;

    fn rows(&self) -> &[Lanes] {
        self.ends.as_flattened()
    }

    fn rows_mut(&mut self) -> &mut [Lanes] {
        self.ends.as_flattened_mut()
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> Slab<H> {
        let [mins, maxs] = &self.ends;
        // Cut off rather than checked for every row.
        let lane = lane % LANES;
        let mut one = Slab::default();
        for i in 0..H {
            one.min[i] = mins[i].0[lane];
            one.max[i] = maxs[i].0[lane];
        }
        one
    }

    fn set(&mut self, lane: usize, one: &Slab<H>) {
        let [min, max] = &mut self.ends;
        for i in 0..H {
            min[i].0[lane] = one.min[i];
            max[i].0[lane] = one.max[i];
        }
    }

    /// A negative weight takes the lower end by the largest displacement and the upper end by the smallest.
    #[inline(always)]
    fn add_interval<S: Simd>(&mut self, simd: S, weight: f32, slopes: &Self) {
        let [min, max] = &mut self.ends;
        let [low, high] = &slopes.ends;
        let (low, high) = if weight < 0.0 { (high, low) } else { (low, high) };
        for i in 0..H {
            min[i].add_scaled(simd, weight, &low[i]);
            max[i].add_scaled(simd, weight, &high[i]);
        }
    }

    fn quantize(&self, scale: f32, numbers: &mut Vec<i16>) {
        let [min, max] = &self.ends;
        numbers.extend(min.iter().flat_map(|row| row.0.map(|x| (x / scale).floor() as i16)));
        numbers.extend(max.iter().flat_map(|row| row.0.map(|x| (x / scale).ceil() as i16)));
    }

    #[inline(always)]
    fn widen<S: Simd>(&mut self, simd: S, by: f32) {
        let [min, max] = &mut self.ends;
        for i in 0..H {
            min[i].add(simd, -by * length(H, i));
            max[i].add(simd, by * length(H, i));
        }
    }

    fn fit(&mut self, lane: usize, points: &[Vec3]) {
        let [min, max] = &mut self.ends;
        for i in 0..H {
            let [x, y, z] = direction(H, i).map(f32::from);
            let ends = points
                .iter()
                .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], p| {
                    let (along, error) = if i < 3 {
                        (p[i], 0.0)
                    } else {
                        // Two sums, each off by at most half a unit in the last place.
                        let sum = x * p.x + y * p.y + z * p.z;
                        (sum, 2.0 * f32::EPSILON * p.abs().element_sum())
                    };
                    [low.min(along - error), high.max(along + error)]
                });
            min[i].0[lane] = ends[0];
            max[i].0[lane] = ends[1];
        }
    }

    #[inline(always)]
    fn fit_corners<S: Simd>(&mut self, simd: S, lane: usize, corners: &[[[Lanes; 3]; 3]]) {
        let [mins, maxs] = &mut self.ends;
        for i in 0..H {
            let mut low = f32x8::splat(simd, f32::INFINITY);
            let mut high = f32x8::splat(simd, f32::NEG_INFINITY);
            for [x, y, z] in corners.as_flattened() {
                let (x, y, z) = (x.load(simd), y.load(simd), z.load(simd));
                let [along, error] = if i < 3 {
                    [[x, y, z][i], f32x8::splat(simd, 0.0)]
                } else {
                    let [a, b, c] = direction(H, i).map(f32::from);
                    let sum = x * f32x8::splat(simd, a) + y * f32x8::splat(simd, b) + z * f32x8::splat(simd, c);
                    // Two sums, each off by at most half a unit in the last place.
                    let magnitude = x.abs() + y.abs() + z.abs();
                    [sum, magnitude * f32x8::splat(simd, 2.0 * f32::EPSILON)]
                };
                low = low.min(along - error);
                high = high.max(along + error);
            }
            let (mut lows, mut highs) = (Lanes::default(), Lanes::default());
            low.store_slice(&mut lows.0);
            high.store_slice(&mut highs.0);
            mins[i].0[lane % LANES] = lows.least();
            maxs[i].0[lane % LANES] = highs.most();
        }
    }

    fn map(frame: &Frame) -> Option<SlabMap<H>> {
        SlabMap::new(frame)
    }

    #[inline]
    fn map_one(map: &SlabMap<H>, one: &Slab<H>) -> Slab<H> {
        map.one(one)
    }

    #[inline(always)]
    fn map_all<S: Simd>(&self, simd: S, map: &SlabMap<H>, mapped: &mut Self) {
        map.all(simd, &self.ends, &mut mapped.ends);
    }

    #[inline(always)]
    fn depths<S: Simd>(&self, simd: S, other: &Slab<H>, depths: &mut [f32; LANES]) {
        let [min, max] = &self.ends;
        let mut depth = f32x8::splat(simd, f32::INFINITY);
        for i in 0..3 {
            depth = depth.min(max[i].load(simd) - f32x8::splat(simd, other.min[i]));
            depth = depth.min(f32x8::splat(simd, other.max[i]) - min[i].load(simd));
        }
        depth.store_slice(depths);
    }

    #[inline(always)]
    fn overlap_mask<S: Simd>(&self, simd: S, other: &Slab<H>) -> u8 {
        let [min, max] = &self.ends;
        let mut overlap = mask32x8::splat(simd, true);
        for i in 0..H {
            overlap &= min[i].load(simd).simd_le(f32x8::splat(simd, other.max[i]));
            overlap &= max[i].load(simd).simd_ge(f32x8::splat(simd, other.min[i]));
        }
        overlap.to_bitmask() as u8
    }

    fn overlap(a: &Slab<H>, b: &Slab<H>) -> bool {
        (0..H).all(|i| a.min[i] <= b.max[i] && b.min[i] <= a.max[i])
    }

    fn gap(a: &Slab<H>, b: &Slab<H>) -> f64 {
        let apart = |i: usize| {
            let gap = (f64::from(a.min[i]) - f64::from(b.max[i])).max(f64::from(b.min[i]) - f64::from(a.max[i]));
            // A direction with n coordinates of 1 is as long as the root of n.
            gap / f64::from(length(H, i)).sqrt()
        };
        (0..H).map(apart).fold(f64::NEG_INFINITY, f64::max) * (1.0 - 8.0 * f64::EPSILON)
    }

    fn size(one: &Slab<H>) -> f32 {
        (0..3).map(|i| one.max[i] - one.min[i]).sum()
    }

    fn hull(&self, lanes: u8) -> Slab<H> {
        let [min, max] = &self.ends;
        let of = |row: &Lanes, start: f32, best: fn(f32, f32) -> f32| {
            (0..LANES)
                .filter(|lane| lanes >> lane & 1 == 1)
                .fold(start, |hull, lane| best(hull, row.0[lane]))
        };
        Slab {
            min: std::array::from_fn(|i| of(&min[i], f32::INFINITY, f32::min)),
            max: std::array::from_fn(|i| of(&max[i], f32::NEG_INFINITY, f32::max)),
        }
    }

    fn contains(one: &Slab<H>, point: DVec3) -> bool {
        (0..H).all(|i| {
            let along = along(H, i, point);
            f64::from(one.min[i]) <= along && along <= f64::from(one.max[i])
        })
    }

    fn bounds(one: &Slab<H>) -> Aabb {
        Aabb {
            min: Vec3::new(one.min[0], one.min[1], one.min[2]),
            max: Vec3::new(one.max[0], one.max[1], one.max[2]),
        }
    }

    fn extent(points: Points<'_>) -> Extent<H> {
        let mut extent = Extent::EMPTY;
        points(&mut |p| extent.add(p));
        extent
    }

    fn union(a: &Extent<H>, b: &Extent<H>) -> Extent<H> {
        Extent {
            min: std::array::from_fn(|i| a.min[i].min(b.min[i])),
            max: std::array::from_fn(|i| a.max[i].max(b.max[i])),
            reach: a.reach.max(b.reach),
        }
    }

    fn base(extent: &Extent<H>, _: Points<'_>) -> Slab<H> {
        extent.outward()
    }

    fn slope(base: &Slab<H>, reference: &Extent<H>, _: Points<'_>, scale: f64) -> Slab<H> {
        let slope = |end: f64, base: f32, pad: f64| (end - f64::from(base) + pad) / scale;
        let pad = |i: usize| reference.pad() + 4.0 * f64::EPSILON * f64::from(base.min[i].abs().max(base.max[i].abs()));
        Slab {
            min: std::array::from_fn(|i| down(slope(reference.min[i], base.min[i], -pad(i)))),
            max: std::array::from_fn(|i| up(slope(reference.max[i], base.max[i], pad(i)))),
        }
    }

    fn interval(displacements: &Extent<H>, _: Points<'_>) -> Slab<H> {
        displacements.outward()
    }

    fn looseness(slope: &Slab<H>) -> f64 {
        let width = |i: usize| f64::from(slope.max[i]) - f64::from(slope.min[i]);
        (0..H).map(|i| width(i) / f64::from(length(H, i)).sqrt()).sum()
    }
}
