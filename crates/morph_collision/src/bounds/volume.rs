use std::fmt::Debug;

use fearless_simd::Simd;
use glam::{DVec3, Vec3};

use super::{Aabb, Frame, LANES, Lanes};

/// Points to measure: as many passes over them as a volume needs.
pub(crate) type Points<'a> = &'a dyn Fn(&mut dyn FnMut(DVec3));

/// Eight bounding volumes of one kind, as structure of arrays.
///
/// A volume is a row of numbers that depend linearly on the points it is made from, so that volumes are blended as numbers:
/// `base + sum a * slope`. Lanes without a child hold zeros and are masked out by the caller.
pub(crate) trait Volume: Copy + Default + Debug + Send + Sync + 'static {
    /// One volume.
    type One: Copy + Debug + Send + Sync;
    /// Takes volumes to another frame, outward.
    type Map: Debug + Send + Sync;
    /// What a set of points spans, in `f64`; that of a node comes from those of its children.
    type Extent: Clone + Debug;

    /// Whether [`Volume::base`] and [`Volume::slope`] look at the points, and not only at their extent.
    const LOOKS_AT_POINTS: bool;
    /// Numbers per volume.
    const ROWS: usize;

    fn rows(&self) -> &[Lanes];
    fn rows_mut(&mut self) -> &mut [Lanes];
    fn get(&self, lane: usize) -> Self::One;
    fn set(&mut self, lane: usize, one: &Self::One);

    /// `self += a * slopes` for `a >= 0`.
    #[inline(always)]
    fn add_scaled<S: Simd>(&mut self, simd: S, a: f32, slopes: &Self) {
        for (sum, slope) in self.rows_mut().iter_mut().zip(slopes.rows()) {
            sum.add_scaled(simd, a, slope);
        }
    }

    /// Adds the interval of a displacement, scaled by a weight of any sign.
    fn add_interval<S: Simd>(&mut self, simd: S, weight: f32, slopes: &Self);

    /// Appends the rows of slopes as multiples of `scale`, rounded outward; no number is above 32766 times `scale`.
    fn quantize(&self, scale: f32, numbers: &mut Vec<i16>);

    /// Grows all eight so that they hold every point off by up to `by` per coordinate, and rows off by up to `by` times
    /// the length of their direction.
    fn widen<S: Simd>(&mut self, simd: S, by: f32);

    /// Makes one lane the smallest volume around some points, rounded outward.
    fn fit(&mut self, lane: usize, points: &[Vec3]);

    /// As [`Volume::fit`], around the corners of triangles side by side; every lane holds one.
    #[inline(always)]
    fn fit_corners<S: Simd>(&mut self, _simd: S, lane: usize, corners: &[[[Lanes; 3]; 3]]) {
        let mut points = Vec::with_capacity(3 * LANES * corners.len());
        for [x, y, z] in corners.iter().flatten() {
            points.extend((0..LANES).map(|lane| Vec3::new(x.0[lane], y.0[lane], z.0[lane])));
        }
        self.fit(lane, &points);
    }

    /// The map to a frame for volumes within the frame's source bounds; `None` where `f32` cannot hold it.
    fn map(frame: &Frame) -> Option<Self::Map>;
    fn map_one(map: &Self::Map, one: &Self::One) -> Self::One;

    /// As [`Volume::map_one`], lane by lane; what lanes without a child become is of no matter.
    fn map_all<S: Simd>(&self, simd: S, map: &Self::Map, mapped: &mut Self);

    /// How far each lane reaches into `other`, about: where intersections are the more likely the deeper.
    fn depths<S: Simd>(&self, simd: S, other: &Self::One, depths: &mut [f32; LANES]);

    /// The lanes that may share a point with `other`, as a bit mask; touching counts.
    fn overlap_mask<S: Simd>(&self, simd: S, other: &Self::One) -> u8;
    fn overlap(a: &Self::One, b: &Self::One) -> bool;

    /// A lower bound of the distance between two volumes, 0 or less where they may overlap.
    fn gap(a: &Self::One, b: &Self::One) -> f64;

    /// A length to tell which of two volumes is larger.
    fn size(one: &Self::One) -> f32;
    /// Whether a point lies in the volume or on its boundary, in `f64`.
    fn contains(one: &Self::One, point: DVec3) -> bool;
    /// The smallest volume of this kind around the lanes in a mask, rounded outward.
    fn hull(&self, lanes: u8) -> Self::One;
    /// A box around the volume.
    fn bounds(one: &Self::One) -> Aabb;

    /// What points span.
    fn extent(points: Points<'_>) -> Self::Extent;
    /// What two sets of points span together.
    fn union(a: &Self::Extent, b: &Self::Extent) -> Self::Extent;
    /// The volume of the base shape, rounded outward.
    fn base(extent: &Self::Extent, points: Points<'_>) -> Self::One;
    /// How the base volume moves towards that of a reference scaled by `scale`, per unit of weight, rounded outward.
    fn slope(base: &Self::One, reference: &Self::Extent, points: Points<'_>, scale: f64) -> Self::One;
    /// The interval of displacements, rounded outward.
    fn interval(displacements: &Self::Extent, points: Points<'_>) -> Self::One;
    /// How much a unit of such a slope loosens a volume.
    fn looseness(slope: &Self::One) -> f64;
}
