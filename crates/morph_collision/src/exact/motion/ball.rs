//! When a moving ball first reaches a moving triangle, in `f64` with an error bound (`docs/numerics.md`, Motion).

use glam::DVec3;

use super::filter::{DEEPEST, level};
use super::moving::{MovingPoint, TimeOfImpact};
use crate::exact::closest::closest_on_triangle;
use crate::exact::number::{UNIT_ROUNDOFF, power_of_two};

/// A triangle as the center of the ball sees it: its corners at the start and at the end.
type RelativeTriangle = [MovingPoint; 3];

/// When a ball may first reach a triangle; `None` if it certainly does not, or only after `latest`.
///
/// The interval is one of `2^k` equal parts of [0, 1], or only 0 if they touch at the start. Before it, the ball does not touch. It is longer
/// than the tolerance if the ball passes by so closely for so long that too many parts would have to be looked at.
///
/// Adds the parts that it looks at to `looks`.
pub(crate) fn ball_impact(
    center: &MovingPoint,
    radius: f64,
    corners: &[MovingPoint; 3],
    tolerance: f64,
    latest: f64,
    looks: &mut u64,
) -> Option<TimeOfImpact> {
    *looks += 1;
    let relative = relative_to(center, corners);
    if closest_on_triangle(DVec3::ZERO, &relative.map(|corner| corner.start)).squared <= radius * radius {
        return Some(TimeOfImpact {
            earliest: 0.0,
            latest: 0.0,
        });
    }
    let sizes = relative.map(|corner| corner.start.abs().max(corner.end.abs()).max_element());
    let size = sizes[0].max(sizes[1]).max(sizes[2]);
    let distance = radius + HEIGHT_ERROR * (size + radius) + f64::MIN_POSITIVE;
    let finest = level(tolerance).unwrap_or(DEEPEST);
    // Intervals from `start / 2^depth` to `(start + 1) / 2^depth`. The last one is the earliest.
    let (mut waiting, mut count) = ([(0_u64, 0_u32); DEEPEST as usize + 2], 1);
    let most = *looks + MOST_PARTS;
    while count > 0 {
        *looks += 1;
        count -= 1;
        let (start, depth) = waiting[count];
        let unit = power_of_two(-i64::from(depth));
        let ends = [start, start + 1].map(|end| end as f64 * unit);
        if ends[0] > latest {
            return None;
        }
        if is_farther(&relative, ends, distance) {
            continue;
        }
        if depth == finest || *looks > most {
            let [earliest, latest] = ends;
            return Some(TimeOfImpact { earliest, latest });
        }
        waiting[count] = (2 * start + 1, depth + 1);
        waiting[count + 1] = (2 * start, depth + 1);
        count += 2;
    }
    None
}

/// Parts of [0, 1] that are looked at for one triangle: some milliseconds of work. A part is shown to be free if, in it, the triangle turns
/// by less than the gap divided by the triangle's size. So a triangle that turns by 0.2 radians at a distance of 1/10,000 of its size
/// takes about 2,000 parts. Most take one, and a contact takes about two for each halving.
const MOST_PARTS: u64 = 1 << 16;

/// A triangle's corners relative to the center.
pub(crate) fn relative_to(center: &MovingPoint, corners: &[MovingPoint; 3]) -> RelativeTriangle {
    corners.map(|corner| MovingPoint {
        start: corner.start - center.start,
        end: corner.end - center.end,
    })
}

/// More than the rounding error of a height: of the difference of two points, of three means, and of the scalar product with a unit
/// vector, relative to the largest coordinate; and of that vector's length.
const HEIGHT_ERROR: f64 = 64.0 * UNIT_ROUNDOFF;

/// Whether a plane shows that the triangle is farther from the center than `distance`, during the whole interval. False for NaN.
///
/// Any plane may show it. Heights of corners over a plane are linear in the time, so the smallest of all is that at an end of the interval.
fn is_farther(relative: &RelativeTriangle, [from, to]: [f64; 2], distance: f64) -> bool {
    let middle = relative.map(|corner| corner.at(from.midpoint(to)));
    let normal = closest_on_triangle(DVec3::ZERO, &middle).point.normalize();
    let heights = |time: f64| relative.map(|corner| corner.at(time).dot(normal));
    heights(from)
        .iter()
        .chain(&heights(to))
        .all(|height| *height > distance)
}
