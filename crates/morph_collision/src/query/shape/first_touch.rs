//! When a moving shape first touches a triangle, which may move too, or another shape: by conservative advancement (Mirtich 1996).
//!
//! At each time, a plane separates the two. They stay apart until they have crossed the gap along its normal, at the largest speed
//! that any of their points has along it. So each step moves on to that time. Without rotation this is Newton's method for a convex function; with it,
//! each step takes at least a part of the remaining gap.

use glam::DVec3;

use super::closest::Closest;
use super::moving::MovingShape;
use super::solid::Solid;
use crate::exact::Triangle;
use crate::exact::motion::{MovingPoint, TimeOfImpact};

/// A first contact.
pub(in super::super) struct Touch {
    pub(in super::super) time: TimeOfImpact,
    /// Where the two touch, on the target.
    pub(in super::super) point: DVec3,
    /// The unit vector from the target to the shape; zero if there is no such direction.
    pub(in super::super) normal: DVec3,
}

/// The most times at which a solid and a target are compared.
const MAX_STEPS: u64 = 4096;
/// Smaller distances, relative to the coordinates involved, count as touching.
const TOUCHING: f64 = 1e-13;

/// What a shape moves towards.
pub(super) trait Target {
    /// Its point with the smallest signed distance from a solid, at a time.
    fn closest(&self, solid: &Solid, time: f64) -> Closest;

    /// How fast its points move along a unit vector at least.
    fn slowest(&self, direction: DVec3) -> f64;
}

/// A triangle whose corners move on straight lines.
impl Target for [MovingPoint; 3] {
    fn closest(&self, solid: &Solid, time: f64) -> Closest {
        solid.closest(&at(self, time))
    }

    fn slowest(&self, direction: DVec3) -> f64 {
        let [a, b, c] = self.map(|corner| direction.dot(corner.end - corner.start));
        a.min(b).min(c)
    }
}

/// A solid at rest.
impl Target for Solid {
    fn closest(&self, solid: &Solid, _: f64) -> Closest {
        solid.closest_of_solid(self)
    }

    fn slowest(&self, _: DVec3) -> f64 {
        0.0
    }
}

/// When a shape first touches a moving triangle; `None` if it does not, or only after `latest`. Adds the number of comparisons to `tests`.
pub(in super::super) fn first_touch_of_triangle(
    shape: &MovingShape,
    triangle: &[MovingPoint; 3],
    tolerance: f64,
    latest: f64,
    tests: &mut u64,
) -> Option<Touch> {
    first_touch(shape, triangle, tolerance, latest, tests)
}

/// The same for any target.
pub(super) fn first_touch(
    shape: &MovingShape,
    target: &impl Target,
    tolerance: f64,
    latest: f64,
    tests: &mut u64,
) -> Option<Touch> {
    let mut first: Option<Touch> = None;
    for (radius, solid_at) in shape.solids() {
        let latest = first.as_ref().map_or(latest, |first| first.time.latest);
        let pair = Pair {
            shape,
            radius,
            solid_at,
            target,
        };
        if let Some(touch) = pair.first_touch(tolerance, latest, tests)
            && first.as_ref().is_none_or(|first| touch.time.latest < first.time.latest)
        {
            first = Some(touch);
        }
    }
    first
}

struct Pair<'a, S, T> {
    shape: &'a MovingShape,
    radius: f64,
    solid_at: S,
    target: &'a T,
}

impl<S: Fn(f64) -> Solid, T: Target> Pair<'_, S, T> {
    fn first_touch(&self, tolerance: f64, latest: f64, tests: &mut u64) -> Option<Touch> {
        let mut now = 0.0_f64;
        let mut normal = DVec3::ZERO;
        for _ in 0..MAX_STEPS {
            let (closest, is_touching) = self.closest(now, tests);
            if closest.distance > 0.0 || normal == DVec3::ZERO {
                normal = closest.normal;
            }
            if is_touching {
                return Some(touch(now, now, &closest, normal));
            }
            let step = self.time_to_cross(&closest)?;
            let next = now + step;
            if next.is_nan() || next > latest {
                return None;
            }
            // Perhaps it is known well enough when they touch.
            let soon = (now + tolerance).min(1.0);
            if next <= soon {
                let (closest, is_touching) = self.closest(soon, tests);
                if is_touching {
                    return Some(touch(next, soon, &closest, normal));
                }
            }
            if next == now {
                return Some(touch(now, now, &closest, normal));
            }
            now = next;
        }
        let (closest, _) = self.closest(now, tests);
        Some(touch(now, latest.max(now), &closest, normal))
    }

    fn closest(&self, time: f64, tests: &mut u64) -> (Closest, bool) {
        *tests += 1;
        let solid = (self.solid_at)(time);
        let closest = self.target.closest(&solid, time);
        let reach = solid.reach() + closest.point.abs().max_element();
        (closest, closest.distance <= TOUCHING * reach)
    }

    /// How long they stay apart at least; `None` if forever.
    fn time_to_cross(&self, gap: &Closest) -> Option<f64> {
        let approach = self.shape.speed_along(gap.normal, self.radius) - self.target.slowest(gap.normal);
        (approach > 0.0).then(|| gap.distance / approach)
    }
}

/// The triangle at a time.
pub(in super::super) fn at(triangle: &[MovingPoint; 3], time: f64) -> Triangle {
    triangle.map(|point| point.at(time))
}

fn touch(earliest: f64, latest: f64, closest: &Closest, normal: DVec3) -> Touch {
    Touch {
        time: TimeOfImpact { earliest, latest },
        point: closest.point,
        normal: -normal,
    }
}
