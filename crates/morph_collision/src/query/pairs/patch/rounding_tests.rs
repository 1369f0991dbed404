//! Measures, in exact arithmetic, how close the actual errors along the filter's axes come to their bounds.

use fearless_simd::prelude::*;
use fearless_simd::{Level, f32x8};
use glam::{Affine3A, DVec3, Vec3};
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::triangles::Patch;
use super::vectors::{Vector, cross, dot, sub};
use super::verdict::{Along as Parted, ErrorBounds, Sides, lone_first};
use crate::bounds::{LANES, Lanes, WorldFromModel, levels, with_simd};
use crate::query::two_bodies::Neighbourhood;
use crate::tree::put;

/// An axis of the filter, as computed in `f32`. Along it, one triangle appears to be beyond the other by `gap`.
struct Along {
    axis: [f32; 3],
    /// Whether the first triangle is the one beyond.
    a_beyond: bool,
    /// The pair is rejected if this exceeds `doubt`.
    gap: Dyadic,
    /// The error bound.
    doubt: f32,
}

type ExactCorners = [[Dyadic; 3]; 3];

/// Two triangles with the same transform, near an origin.
struct Pair {
    patches: [Patch; 2],
    exact: [ExactCorners; 2],
}

impl Pair {
    /// `numbers` are the corners, the transform, and the neighbourhood's origin.
    fn new(level: Level, numbers: &[f32]) -> Option<Self> {
        let mut columns = [0.0; 12];
        columns.copy_from_slice(&numbers[18..30]);
        let place = WorldFromModel::new(Affine3A::from_cols_array(&columns)).ok()?;
        let triangle = |first: usize| [0, 3, 6].map(|i| Vec3::from_slice(&numbers[first + i..first + i + 3]));
        let triangles = [triangle(0), triangle(9)];
        let origin = Vec3::from_slice(&numbers[30..33]).as_dvec3();
        let world = triangles.map(|corners| corners.map(|p| place.transform_point(p)));
        let size = world.as_flattened().iter().map(|p| (p - origin).abs().max_element());
        let size = size.fold(0.0, f64::max);
        if !(1e-60..1e60).contains(&size) {
            return None;
        }
        let near = Neighbourhood::new(origin, size);
        let exactly = |p: DVec3| {
            let offset = |i: usize| (Dyadic::from(p[i]) - Dyadic::from(origin[i])) * Dyadic::from(near.scale);
            std::array::from_fn(offset)
        };
        Some(Self {
            patches: triangles.map(|corners| {
                let mut patch = Patch::default();
                for lane in 0..LANES {
                    (0..3).for_each(|corner| put(&mut patch.corners, lane, corner, corners[corner]));
                }
                with_simd!(level, simd => {
                    near.placement(&place).place(simd, &mut patch.corners);
                    patch.measure(simd, 1);
                });
                patch
            }),
            exact: world.map(|corners| corners.map(exactly)),
        })
    }

    /// The exact gap between the triangles along an axis, for the given order; negative if they overlap.
    fn exact_gap(&self, axis: [f32; 3], a_beyond: bool) -> Dyadic {
        let heights = |corners: &ExactCorners| {
            corners.clone().map(|corner| {
                let terms = axis.into_iter().zip(corner).map(|(n, x)| Dyadic::from(n) * x);
                terms.sum::<Dyadic>()
            })
        };
        let [a, b] = [heights(&self.exact[0]), heights(&self.exact[1])];
        let (beyond, before) = if a_beyond { (a, b) } else { (b, a) };
        let (least, most) = (beyond.into_iter().min(), before.into_iter().max());
        least.unwrap_or_else(Dyadic::zero) - most.unwrap_or_else(Dyadic::zero)
    }

    /// The largest ratio of actual error to error bound over the filter's axes.
    fn share(&self, level: Level) -> Option<f64> {
        let [a, b] = &self.patches;
        let reach = a.reach.max(b.reach);
        if !(f32::MIN_POSITIVE..f32::INFINITY).contains(&reach) {
            return None;
        }
        let mut all = Vec::new();
        with_simd!(level, simd => look_along(simd, a, b, &mut all));
        let shares = all.into_iter().filter(|along| along.axis != [0.0; 3]).map(|along| {
            let off = along.gap - self.exact_gap(along.axis, along.a_beyond);
            off.ratio(&along.doubt.into())
        });
        shares.reduce(f64::max)
    }
}

/// Collects the filter's axes and what it computes along them.
#[inline(always)]
fn look_along<S: Simd>(simd: S, a: &Patch, b: &Patch, all: &mut Vec<Along>) {
    let errors = ErrorBounds::new(simd, a.reach.max(b.reach));
    let (own, theirs) = (a.load(simd), b.load(simd));
    let mut above = Vec::new();
    for (plane, corners, a_has_plane) in [(b, &own, false), (a, &theirs, true)] {
        let axis = plane.normals.map(|row| row.load(simd));
        let (low, high) = (plane.low.load(simd), plane.high.load(simd));
        let sides = Sides::new(axis, *corners, low, high);
        above.push(sides.above());
        let heights = sides.heights;
        let [least, most] = least_and_most(heights);
        let bound = errors.of_normals;
        // The filter compares with the rounded `high + doubt` and `low - doubt`.
        let limits = [high + bound, low - bound];
        let doubt = Dyadic::from(first(bound));
        let above = Dyadic::from(first(least)) - Dyadic::from(first(limits[0])) + doubt.clone();
        let below = Dyadic::from(first(limits[1])) - Dyadic::from(first(most)) + doubt;
        for (gap, above) in [(above, true), (below, false)] {
            all.push(Along {
                axis: axis.map(first),
                a_beyond: above != a_has_plane,
                gap,
                doubt: first(bound),
            });
        }
    }
    let [p, q, r] = lone_first(own, above[0]);
    let [u, v, w] = lone_first(theirs, above[1]);
    let [from_p, from_u] = [[sub(q, p), sub(r, p)], [sub(v, u), sub(w, u)]];
    for edge in from_p {
        for other in from_u {
            let axis = cross(edge, other);
            let [a_least, a_most] = least_and_most([dot(axis, own[0]), dot(axis, own[1]), dot(axis, own[2])]);
            let [b_least, b_most] = least_and_most([dot(axis, theirs[0]), dot(axis, theirs[1]), dot(axis, theirs[2])]);
            let error = Parted::new(axis, own, theirs, &errors).error;
            for (gap, a_beyond) in [(a_least - b_most, true), (b_least - a_most, false)] {
                all.push(Along {
                    axis: axis.map(first),
                    a_beyond,
                    gap: first(gap).into(),
                    doubt: first(error),
                });
            }
        }
    }
}

/// The largest ratio of actual error to error bound of the heights and products that certify an intersection.
#[inline(always)]
fn certainty<S: Simd>(simd: S, pair: &Pair) -> f64 {
    let [a, b] = &pair.patches;
    let errors = ErrorBounds::new(simd, a.reach.max(b.reach));
    let (own, theirs) = (a.load(simd), b.load(simd));
    let spans = a.span.load(simd) + b.span.load(simd);
    let mut most = 0.0_f64;
    for (plane, corners, exact_plane, exact) in [
        (b, own, &pair.exact[1], &pair.exact[0]),
        (a, theirs, &pair.exact[0], &pair.exact[1]),
    ] {
        let normal = plane.normals.map(|row| row.load(simd));
        let (low, high) = (plane.low.load(simd), plane.high.load(simd));
        let sides = Sides::new(normal, corners, low, high);
        let allowed = first(errors.of_sides + errors.of_tilts * spans * plane.tilt.load(simd) + (high - low));
        let [p, q, r] = exact_plane;
        let exact_normal = exact_cross(&exact_sub(q, p), &exact_sub(r, p));
        let largest = exact_normal.iter().map(|n| n.to_f64().abs()).fold(0.0, f64::max);
        let scale = Dyadic::from(2.0 / largest);
        for (height, corner) in sides.heights.into_iter().zip(exact) {
            let height = first(height + height - (low + high));
            let exact = exact_dot(&exact_normal, &exact_sub(corner, p)) * scale.clone();
            most = most.max((Dyadic::from(height) - exact).abs().ratio(&allowed.into()));
        }
    }
    for (i, j) in CORNERS {
        for (k, l) in CORNERS {
            let (p, q, u, v) = (own[i], own[j], theirs[k], theirs[l]);
            let step = dot(cross(sub(q, p), sub(v, u)), sub(u, p));
            let allowed = first(errors.of_products * (spans * spans) + errors.floor);
            let [exact_a, exact_b] = &pair.exact;
            let (p, q, u, v) = (&exact_a[i], &exact_a[j], &exact_b[k], &exact_b[l]);
            let axis = exact_cross(&exact_sub(q, p), &exact_sub(v, u));
            let exact = exact_dot(&axis, &exact_sub(u, p));
            most = most.max((Dyadic::from(first(step)) - exact).abs().ratio(&allowed.into()));
        }
    }
    most
}

const CORNERS: [(usize, usize); 6] = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];

fn exact_sub(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> [Dyadic; 3] {
    std::array::from_fn(|i| a[i].clone() - b[i].clone())
}

fn exact_dot(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> Dyadic {
    a.iter().zip(b).map(|(a, b)| a.clone() * b.clone()).sum()
}

fn exact_cross(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> [Dyadic; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].clone() * b[k].clone() - a[k].clone() * b[j].clone()
    })
}

#[inline(always)]
fn least_and_most<S: Simd>([a, b, c]: Vector<S>) -> [f32x8<S>; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

#[inline(always)]
fn first<S: Simd>(value: f32x8<S>) -> f32 {
    let mut lanes = Lanes::default();
    value.store_slice(&mut lanes.0);
    lanes.0[0]
}

#[test]
fn intervals_need_much_of_the_doubt_and_never_more() {
    let level = levels()[0];
    let climb = Climb {
        seed: 7,
        starts: 16,
        steps: 500,
    };
    let (share, _) = climb.highest(
        |i, rng| {
            let mut numbers: Vec<f32> = (0..33).map(|_| rng.random_range(-1.0..1.0)).collect();
            // Slight rotations and an origin close by, so that the coordinates have bits to lose.
            for (column, axis) in [18, 22, 26].into_iter().enumerate() {
                numbers[18 + 3 * column..21 + 3 * column]
                    .iter_mut()
                    .for_each(|x| *x *= 0.01);
                numbers[axis] += 1.0;
            }
            match i % 4 {
                0 => {}
                1 => numbers[27..33].fill(0.0),
                2 => {
                    // Long coordinates along one axis, short ones along the others.
                    numbers[27..33].fill(0.0);
                    for corner in numbers[..18].chunks_exact_mut(3) {
                        corner[0] = corner[0].signum() * (1.0 + 0.01 * corner[0].abs());
                    }
                }
                _ => {
                    let scale = 2_f32.powi(rng.random_range(-60..60));
                    numbers[18..30].iter_mut().for_each(|x| *x *= scale);
                    numbers[30..33].fill(0.0);
                }
            }
            numbers
        },
        |numbers| {
            let share = Pair::new(level, numbers)?.share(level)?;
            assert!(share <= 1.0, "{share} of the doubt: {numbers:?}");
            Some(share)
        },
    );
    println!("triangles side by side: {share:.3} of the doubt");
    assert!(is_as_known(share, 0.361), "{share} of the doubt, known is 0.361");
}

#[test]
fn what_says_that_triangles_meet_needs_less_than_it_allows_for() {
    let level = levels()[0];
    let climb = Climb {
        seed: 8,
        starts: 16,
        steps: 300,
    };
    let (share, _) = climb.highest(
        |i, rng| {
            // Triangles of various sizes around a point, with the identity or a slight rotation.
            let size = [1.0, 0.1, 1e-2, 1e-4][i % 4];
            let mut numbers: Vec<f32> = (0..18).map(|_| rng.random_range(-1.0..1.0) * size).collect();
            let center: [f32; 3] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
            for corner in numbers.chunks_exact_mut(3) {
                corner.iter_mut().zip(center).for_each(|(x, c)| *x += c);
            }
            numbers.extend([
                1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
            ]);
            if i % 3 == 0 {
                numbers[18..33]
                    .iter_mut()
                    .for_each(|x| *x += rng.random_range(-0.1..0.1));
            }
            numbers
        },
        |numbers| {
            let pair = Pair::new(level, numbers)?;
            let [a, b] = &pair.patches;
            let reach = a.reach.max(b.reach);
            // Edges larger than their rounding errors, as in every triangle that passes `Sides::clear`.
            let least = 21.0 * f32::EPSILON / 2.0 * reach;
            let edges = a.span.0[0].min(b.span.0[0]) > least && a.tilt.0[0].min(b.tilt.0[0]) > 0.0;
            if !edges || !a.hull.overlaps(&b.hull) || !reach.is_finite() {
                return None;
            }
            let share = with_simd!(level, simd => certainty(simd, &pair));
            assert!(share <= 1.0, "{share} of what is allowed for: {numbers:?}");
            Some(share)
        },
    );
    println!("triangles that meet: {share:.3} of what is allowed for");
    assert!(
        is_as_known(share, 0.026),
        "{share} of what is allowed for, known is 0.026"
    );
}
