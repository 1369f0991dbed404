//! Whether a claim about where and how features touch fits their motion.

use glam::DVec3;

use super::elementary::{ElementaryMotion, MotionKind, PointMotion};

/// A claim about a contact. The first feature is the vertex, or the first edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchGeometry {
    /// An interval of times. The claim is about its middle.
    pub time: [f64; 2],
    /// Where the features touch.
    pub point: DVec3,
    /// The unit vector from the second feature to the first.
    pub normal: DVec3,
    /// The velocity of the first feature relative to the second.
    pub velocity: DVec3,
    /// The weights of the corners of both features.
    pub barycentrics: [[f64; 3]; 2],
}

/// The sizes of coordinates whose fourth powers stay in range. Other motions are not judged.
const SIZES: std::ops::Range<f64> = 1e-60..1e60;
/// Many roundings.
const ROUNDINGS: f64 = 256.0 * f64::EPSILON;

impl TouchGeometry {
    /// What is wrong with the claim, if anything is.
    ///
    /// The point must be on both features, up to their motion during the interval and rounding. The normal must be a unit vector across
    /// the face or both edges, and the first feature must come from its side. The velocity must be that of the point's corners.
    #[must_use]
    pub fn fault(&self, motion: &ElementaryMotion) -> Option<String> {
        let reach = largest(motion.points.as_flattened().iter().map(|p| DVec3::from_array(*p)));
        if !SIZES.contains(&reach) {
            return None;
        }
        let [from, to] = self.time;
        let middle = from.midpoint(to);
        let corners = motion.points.map(|point| at(&point, middle));
        let velocities = motion
            .points
            .map(|[start, end]| DVec3::from_array(end) - DVec3::from_array(start));
        let speed = largest(velocities);
        let [first, second]: [&[usize]; 2] = match motion.kind {
            MotionKind::VertexFace => [&[0], &[1, 2, 3]],
            MotionKind::EdgeEdge => [&[0, 1], &[2, 3]],
        };
        let blend = |of: &[DVec3; 4], feature: &[usize], weights: &[f64; 3]| -> DVec3 {
            let terms = feature
                .iter()
                .zip(weights)
                .map(|(&corner, weight)| of[corner] * *weight);
            terms.fold(DVec3::ZERO, |sum, term| sum + term)
        };
        for (feature, weights) in [first, second].into_iter().zip(&self.barycentrics) {
            let are_weights = weights.iter().all(|weight| *weight >= 0.0)
                && (weights.iter().sum::<f64>() - 1.0).abs() <= 1e-9
                && weights[feature.len()..].iter().all(|weight| *weight == 0.0);
            if !are_weights {
                return Some(format!("{weights:?} are no weights"));
            }
            // Features touch somewhere in the interval, so in its middle they are apart by at most what they move in half of it.
            let off = blend(&corners, feature, weights).distance(self.point);
            let allowed = 2.0 * speed * (to - from) + ROUNDINGS * reach;
            if off > allowed {
                return Some(format!("the point is off {feature:?} by {off:e}, not {allowed:e}"));
            }
        }
        let [of_first, of_second] = &self.barycentrics;
        let velocity = blend(&velocities, first, of_first) - blend(&velocities, second, of_second);
        if velocity.distance(self.velocity) > ROUNDINGS * reach {
            return Some(format!("the velocity is {velocity}"));
        }
        let edges = match motion.kind {
            MotionKind::VertexFace => [corners[2] - corners[1], corners[3] - corners[1]],
            MotionKind::EdgeEdge => [corners[1] - corners[0], corners[3] - corners[2]],
        };
        self.wrong_normal(edges, reach)
    }

    fn wrong_normal(&self, edges: [DVec3; 2], reach: f64) -> Option<String> {
        if self.normal == DVec3::ZERO {
            let is_still = self.velocity.length() <= ROUNDINGS * reach;
            return (!is_still).then(|| "no normal, but a velocity".to_owned());
        }
        if (self.normal.length() - 1.0).abs() > 1e-12 {
            return Some("the normal is no unit vector".to_owned());
        }
        let [u, v] = edges;
        let sine = u.normalize_or_zero().cross(v.normalize_or_zero()).length();
        let shortest = u.length().min(v.length());
        if sine * shortest > 1e-6 * reach {
            let along = edges.map(|edge| self.normal.dot(edge.normalize()).abs());
            if along.iter().any(|along| *along > 1e-6) {
                return Some(format!("the normal is along the edges by {along:?}"));
            }
        }
        let approach = -self.normal.dot(self.velocity);
        let is_behind = self.time[1] > 0.0 && approach < -1e-6 * self.velocity.length() - ROUNDINGS * reach;
        is_behind.then(|| format!("the first feature moves along the normal by {}", -approach))
    }
}

fn at([start, end]: &PointMotion, time: f64) -> DVec3 {
    DVec3::from_array(*start) * (1.0 - time) + DVec3::from_array(*end) * time
}

fn largest(vectors: impl IntoIterator<Item = DVec3>) -> f64 {
    vectors
        .into_iter()
        .fold(0.0, |most, vector| vector.abs().max_element().max(most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_claims_pass_and_each_wrong_part_is_named() {
        let resting = |p: [f64; 3]| [p, p];
        let motion = ElementaryMotion {
            kind: MotionKind::VertexFace,
            points: [
                [[1.0, 1.0, 1.0], [1.0, 1.0, -3.0]],
                resting([0.0, 0.0, 0.0]),
                resting([4.0, 0.0, 0.0]),
                resting([0.0, 4.0, 0.0]),
            ],
        };
        let right = TouchGeometry {
            time: [0.25; 2],
            point: DVec3::new(1.0, 1.0, 0.0),
            normal: DVec3::Z,
            velocity: DVec3::Z * -4.0,
            barycentrics: [[1.0, 0.0, 0.0], [0.5, 0.25, 0.25]],
        };
        assert_eq!(right.fault(&motion), None);
        let named = |wrong: TouchGeometry, part: &str| {
            let fault = wrong.fault(&motion).unwrap_or_default();
            assert!(fault.contains(part), "{fault}, not {part}");
        };
        let mut wrong = right;
        wrong.point.z = 1e-9;
        named(wrong, "off [0]");
        let mut wrong = right;
        wrong.barycentrics[1] = [0.25, 0.5, 0.25];
        named(wrong, "off [1, 2, 3]");
        wrong.barycentrics[1] = [0.75, 0.5, -0.25];
        named(wrong, "no weights");
        let mut wrong = right;
        wrong.velocity.x = 1e-9;
        named(wrong, "the velocity is");
        for (normal, part) in [
            (DVec3::ZERO, "no normal"),
            (DVec3::Z * 1.1, "no unit vector"),
            (DVec3::X, "along the edges"),
            (DVec3::NEG_Z, "moves along the normal"),
        ] {
            let wrong = TouchGeometry { normal, ..right };
            named(wrong, part);
        }
        // At the start, no side is the wrong one.
        let mut start = motion;
        start.points[0][0] = [1.0, 1.0, 0.0];
        let mut claim = TouchGeometry {
            time: [0.0; 2],
            velocity: DVec3::Z * -3.0,
            ..right
        };
        assert_eq!(claim.fault(&start), None);
        claim.normal = DVec3::NEG_Z;
        assert_eq!(claim.fault(&start), None);
    }
}
