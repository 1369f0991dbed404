//! Boxes taken from one body's space to another's, outward.
//!
//! A cull compares the boxes of two bodies in one frame: the space of either body, or world space when neither body can
//! be inverted. All maps are made in `f64` with a bound on their own error, rounded to `f32`, and carry a slack that
//! covers everything `f32` does to a box on its way. `docs/numerics.md` derives the slack.

use glam::{DMat3, DVec3, Vec3};

use super::{Aabb, BoxLanes, LANES, Lanes, WorldFromModel};

/// Half a unit in the last place of 1, in `f64`.
const U64: f64 = 1.110_223_024_625_156_5e-16;
/// Half a unit in the last place of 1, in `f32`.
const U32: f64 = 5.960_464_477_539_063e-8;
/// Roundings on a box's way through a map: to centre and half size (2), through three products and sums (2 x 4), back to
/// ends (2), and the entries' own (2); each at most one `U32` of the largest magnitude reached.
const MAP_ROUNDINGS: f64 = 16.0;
/// Covers products, and entries times magnitudes, that underflow: far below any `f32` that is not subnormal.
const UNDERFLOW: f64 = 1e-42;
/// Magnitudes beyond this leave room for no sum; such a map is not used.
const LARGEST: f64 = 1e37;

/// A map of boxes to another frame; its slack makes the result hold the exact image of everything in the box.
#[derive(Clone, Debug)]
struct BoxMap {
    rows: [Vec3; 3],
    abs_rows: [Vec3; 3],
    translation: Vec3,
    slack: Vec3,
}

impl BoxMap {
    /// `error` bounds, per axis of the target frame, what the `f64` map misses of the exact one over the source box.
    fn new(linear: DMat3, translation: DVec3, magnitude: DVec3, error: DVec3) -> Option<Self> {
        let reach = abs(linear) * magnitude + translation.abs();
        let underflow = UNDERFLOW + UNDERFLOW * magnitude.element_sum();
        let slack = error + (MAP_ROUNDINGS * U32) * reach + DVec3::splat(underflow);
        let usable = |v: DVec3| v.is_finite() && v.max_element() < LARGEST;
        if !usable(reach) || !usable(slack) || !usable(abs(linear) * DVec3::ONE) {
            return None;
        }
        let linear = linear.as_mat3();
        let rows = [linear.row(0), linear.row(1), linear.row(2)];
        Some(Self {
            rows,
            abs_rows: rows.map(Vec3::abs),
            translation: translation.as_vec3(),
            // One more `f32` step outward for the conversion itself.
            slack: slack.as_vec3().map(f32::next_up),
        })
    }

    fn apply(&self, bounds: &Aabb) -> Aabb {
        let center = 0.5 * bounds.min + 0.5 * bounds.max;
        let half = 0.5 * bounds.max - 0.5 * bounds.min;
        let dot = |rows: &[Vec3; 3], v: Vec3| Vec3::from_array(rows.map(|row| row.dot(v)));
        let center = dot(&self.rows, center) + self.translation;
        let half = dot(&self.abs_rows, half) + self.slack;
        Aabb {
            min: center - half,
            max: center + half,
        }
    }

    #[inline]
    fn apply_lanes(&self, boxes: &BoxLanes) -> BoxLanes {
        let mut center = [Lanes::default(); 3];
        let mut half = [Lanes::default(); 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                let (min, max) = (0.5 * boxes.min[axis].0[lane], 0.5 * boxes.max[axis].0[lane]);
                center[axis].0[lane] = min + max;
                half[axis].0[lane] = max - min;
            }
        }
        let mut mapped = BoxLanes::default();
        for axis in 0..3 {
            let mut c = Lanes::splat(self.translation[axis]);
            let mut h = Lanes::splat(self.slack[axis]);
            for source in 0..3 {
                c.add_scaled(self.rows[axis][source], &center[source]);
                h.add_scaled(self.abs_rows[axis][source], &half[source]);
            }
            for lane in 0..LANES {
                mapped.min[axis].0[lane] = c.0[lane] - h.0[lane];
                mapped.max[axis].0[lane] = c.0[lane] + h.0[lane];
            }
        }
        mapped
    }
}

/// One of the two bodies of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    A,
    B,
}

/// A frame in which boxes of both bodies are compared; a side without a map is in its own space there.
#[derive(Clone, Debug)]
pub(crate) struct Cull {
    a: Option<BoxMap>,
    b: Option<BoxMap>,
}

impl Cull {
    /// Which of eight boxes of one side share a point with a box of the other, as far as this frame can tell.
    #[inline]
    pub(crate) fn overlap_mask(&self, side: Side, boxes: &BoxLanes, other: &Aabb) -> u8 {
        let (own, others) = match side {
            Side::A => (&self.a, &self.b),
            Side::B => (&self.b, &self.a),
        };
        let other = others.as_ref().map_or(*other, |map| map.apply(other));
        match own {
            Some(map) => map.apply_lanes(boxes).overlap_mask(&other),
            None => boxes.overlap_mask(&other),
        }
    }

    pub(crate) fn overlaps(&self, a: &Aabb, b: &Aabb) -> bool {
        let map = |map: &Option<BoxMap>, bounds: &Aabb| map.as_ref().map_or(*bounds, |map| map.apply(bounds));
        map(&self.a, a).overlaps(&map(&self.b, b))
    }
}

/// The frames that decide whether boxes of two placed bodies may meet: the SAT-lite test, both bodies' own axes.
///
/// `a` and `b` are the bodies' whole model-space bounds. World space serves where neither body can be inverted, and an
/// empty list, which culls nothing, where numbers are beyond `f32`.
pub(crate) fn culls_of(world_from_a: &WorldFromModel, a: &Aabb, world_from_b: &WorldFromModel, b: &Aabb) -> Vec<Cull> {
    let error = placement_error(world_from_a, a) + placement_error(world_from_b, b);
    let mut culls = Vec::with_capacity(2);
    if let Some(map) = relative(world_from_a, world_from_b, b, error) {
        culls.push(Cull { a: None, b: Some(map) });
    }
    if let Some(map) = relative(world_from_b, world_from_a, a, error) {
        culls.push(Cull { a: Some(map), b: None });
    }
    if culls.is_empty() {
        let origin = world_from_a.translation();
        if let (Some(a), Some(b)) = (
            to_world(world_from_a, origin, a, error),
            to_world(world_from_b, origin, b, error),
        ) {
            culls.push(Cull { a: Some(a), b: Some(b) });
        }
    }
    culls
}

/// A box in world space around everything that [`WorldFromModel::transform_point`] makes of points in `bounds`.
pub(crate) fn world_bounds(world_from_model: &WorldFromModel, bounds: &Aabb) -> Aabb {
    let error = placement_error(world_from_model, bounds);
    match to_world(world_from_model, DVec3::ZERO, bounds, error) {
        Some(map) => map.apply(bounds),
        None => Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        },
    }
}

/// The map to world space relative to `origin`, which keeps small bodies far from the world's origin sharp.
fn to_world(world_from_model: &WorldFromModel, origin: DVec3, bounds: &Aabb, error: DVec3) -> Option<BoxMap> {
    let translation = world_from_model.translation() - origin;
    let error = error + 2.0 * U64 * translation.abs();
    BoxMap::new(
        world_from_model.linear(),
        translation,
        bounds.magnitude().as_dvec3(),
        error,
    )
}

/// What [`WorldFromModel::transform_point`] may differ from the exact image of any point in the bounds, per world axis.
fn placement_error(world_from_model: &WorldFromModel, bounds: &Aabb) -> DVec3 {
    let reach = abs(world_from_model.linear()) * bounds.magnitude().as_dvec3() + world_from_model.translation().abs();
    4.0 * U64 * reach
}

/// `target_from_source` for boxes within `bounds`; `None` where the target body cannot be inverted safely.
fn relative(
    world_from_target: &WorldFromModel,
    world_from_source: &WorldFromModel,
    bounds: &Aabb,
    world_error: DVec3,
) -> Option<BoxMap> {
    let linear = world_from_target.linear();
    let inverse = inverse(linear)?;
    // inverse * linear = I - R gives |linear^-1 - inverse| <= |R| / (1 - |R|) |inverse|, with R's own rounding in it.
    let residual = abs(DMat3::IDENTITY - inverse * linear);
    let rho = norm(residual) + 8.0 * U64 * norm(abs(inverse) * abs(linear));
    if !rho.is_finite() || rho > 1.0 / 16.0 {
        return None;
    }
    let largest = column_maxima(abs(inverse));
    let error_of = |v: DVec3| DVec3::splat(1.1 * rho * largest.dot(v));
    let offset = world_from_source.translation() - world_from_target.translation();
    let magnitude = bounds.magnitude().as_dvec3();
    let reach = abs(world_from_source.linear()) * magnitude + offset.abs();
    let error =
        abs(inverse) * world_error + error_of(world_error) + error_of(reach) + 16.0 * U64 * (abs(inverse) * reach);
    BoxMap::new(inverse * world_from_source.linear(), inverse * offset, magnitude, error)
}

/// The inverse with the matrix scaled to around 1 first, so that tiny and huge bodies invert as well as any other.
fn inverse(linear: DMat3) -> Option<DMat3> {
    let largest = column_maxima(abs(linear)).max_element();
    if largest == 0.0 {
        return None;
    }
    let scaled = linear * (1.0 / largest);
    if scaled.determinant().abs() < 1e-60 {
        return None;
    }
    let inverse = scaled.inverse() * (1.0 / largest);
    inverse.is_finite().then_some(inverse)
}

fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// The largest row sum of a matrix without negative entries.
fn norm(m: DMat3) -> f64 {
    (m * DVec3::ONE).max_element()
}

fn column_maxima(m: DMat3) -> DVec3 {
    DVec3::new(m.x_axis.max_element(), m.y_axis.max_element(), m.z_axis.max_element())
}
