//! Velocities of points: which of them are motion, and which are jumps.

use bevy::math::DVec3;

/// Whether velocities are a motion and not a jump: they are small, or they continue those of the previous step.
///
/// `limit` is the maximum change of velocity in one step. A point that suddenly moves faster counts as moving when the next step
/// confirms it.
pub fn continuous(velocities: &[DVec3], before: Option<&[DVec3]>, limit: f64) -> bool {
    let before = before.map(|before| before.iter().copied());
    are_continuous(velocities.iter().copied(), before, limit)
}

/// The same for velocities that are computed when they are needed.
pub fn are_continuous(
    velocities: impl Iterator<Item = DVec3> + Clone,
    before: Option<impl Iterator<Item = DVec3>>,
    limit: f64,
) -> bool {
    let speed = largest(velocities.clone().map(DVec3::length_squared)).sqrt();
    if speed <= limit {
        return true;
    }
    let Some(before) = before else { return false };
    let changes = velocities.zip(before).map(|(v, u)| v.distance(u));
    largest(changes) <= limit.max(0.5 * speed)
}

/// The velocities of points that move from one position to another in some time.
pub fn between(from: &[DVec3], to: &[DVec3], time: f64, into: &mut Vec<DVec3>) {
    into.clear();
    into.extend(from.iter().zip(to).map(|(from, to)| (to - from) / time));
}

/// The highest speed among velocities.
pub fn fastest(velocities: &[DVec3]) -> f64 {
    largest(velocities.iter().map(|v| v.length_squared())).sqrt()
}

/// The largest of some numbers and 0. NaN does not count.
///
/// Written out, because LLVM 22 (rustc 1.97.1) can compile `fold(0.0, f64::max)` incorrectly.
pub fn largest<T: PartialOrd + Default>(numbers: impl IntoIterator<Item = T>) -> T {
    let larger = |most, number| if number > most { number } else { most };
    numbers.into_iter().fold(T::default(), larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jumps_are_told_from_motion() {
        let fast = [DVec3::Y * 12.0];
        assert!(continuous(&[DVec3::Y], None, 1.5));
        assert!(!continuous(&fast, None, 1.5));
        assert!(!continuous(&fast, Some(&[DVec3::ZERO]), 1.5));
        assert!(continuous(&fast, Some(&[DVec3::Y * 11.0]), 1.5));
        assert!(continuous(&fast, Some(&[DVec3::Y * 7.0]), 1.5));
        assert!(!continuous(&fast, Some(&[DVec3::Y * -12.0]), 1.5));
    }
}
