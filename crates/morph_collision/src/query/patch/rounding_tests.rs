//! How near the errors of intervals along the filter's axes come to the doubt, in exact arithmetic.

use fearless_simd::Level;
use glam::{Affine3A, DVec3, Vec3};
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::Climb;
use rand::RngExt;

use super::vectors::Vector;
use super::verdict::{Along, Doubt, Sides, lone_first};
use super::*;
use crate::bounds::{levels, with_simd};
use crate::tree::put;

/// An axis of the filter, as far as `f32` got with it: along it one triangle looks to be beyond the other by `gap`.
struct Along {
    axis: [f32; 3],
    /// Whether it is the first triangle that is beyond.
    a_beyond: bool,
    /// The triangles are turned away where this is above `doubt`.
    gap: Dyadic,
    doubt: f32,
}

type ExactCorners = [[Dyadic; 3]; 3];

/// Two triangles in one place, near an origin.
struct Pair {
    patches: [Patch; 2],
    exact: [ExactCorners; 2],
}

impl Pair {
    /// `numbers` are the corners, the place, and the neighbourhood's origin.
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
                let mut lanes = CornerLanes::default();
                for lane in 0..LANES {
                    (0..3).for_each(|corner| put(&mut lanes, lane, corner, corners[corner]));
                }
                let mut patch = Patch::default();
                with_simd!(level, simd => patch.place(simd, &lanes, 1, &place, &near));
                patch
            }),
            exact: world.map(|corners| corners.map(exactly)),
        })
    }

    /// By how much the triangles are apart along an axis, exactly, in that order; below 0 where they overlap.
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

    /// The largest share of its doubt that the filter needs along one of its axes.
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

/// The axes that the filter looks along, and what it sees there.
#[inline(always)]
fn look_along<S: Simd>(simd: S, a: &Patch, b: &Patch, all: &mut Vec<Along>) {
    let doubt = Doubt::new(simd, a.reach.max(b.reach));
    let (own, theirs) = (a.load(simd), b.load(simd));
    let mut sides = Vec::new();
    for (plane, corners, a_has_plane) in [(b, &own, false), (a, &theirs, true)] {
        let axis = plane.normals.map(|row| row.load(simd));
        let heights = [dot(axis, corners[0]), dot(axis, corners[1]), dot(axis, corners[2])];
        let (low, high) = (plane.low.load(simd), plane.high.load(simd));
        sides.push(split(heights, low, high, doubt.of_normals).1);
        let [least, most] = least_and_most(heights);
        let bound = doubt.of_normals;
        // Compared with `high + doubt` and `low - doubt`, rounded.
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
    let [p, q, r] = lone_first(own, sides[0]);
    let [u, v, w] = lone_first(theirs, sides[1]);
    let [from_p, from_u] = [[sub(q, p), sub(r, p)], [sub(v, u), sub(w, u)]];
    for edge in from_p {
        for other in from_u {
            let axis = cross(edge, other);
            let [a_least, a_most] = least_and_most([dot(axis, own[0]), dot(axis, own[1]), dot(axis, own[2])]);
            let [b_least, b_most] = least_and_most([dot(axis, theirs[0]), dot(axis, theirs[1]), dot(axis, theirs[2])]);
            // As `parted` has it.
            let error = (axis[0].abs() + axis[1].abs() + axis[2].abs()) * doubt.per_length + doubt.floor;
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
            // Slight turns and an origin close by, so that the coordinates have bits to lose.
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
    assert!(share >= 0.01, "the doubt is lazy, or the search is: {share}");
}
