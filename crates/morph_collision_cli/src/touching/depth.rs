//! How deep triangles are in each other, and how deep they must be to be reported.

use clap::Args;
use glam::DVec3;
use morph_collision::{Triangle, triangle_distance, triangles_intersect};

/// What counts besides touching, or does not count although it touches.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct ThresholdArgs {
    /// Leave out what is less deep than this, in the file's unit. Faces that lie on each other touch by rounding alone, with a depth of about 0.
    ///
    /// `lint` measures at rest, too: a pair of triangles that is less deep at rest is reported if it gets deeper.
    #[arg(long, value_name = "D", value_parser = length, allow_hyphen_values = true)]
    pub(crate) min_depth: Option<f64>,
    /// Triangles also count if they do not touch but are at most this far apart, in the file's unit. Their depth is minus the distance.
    ///
    /// Triangles of one mesh that share a vertex never count, but their next neighbours do, so choose a gap below the lengths of edges.
    #[arg(long, value_name = "G", value_parser = length, allow_hyphen_values = true, conflicts_with = "min_depth")]
    pub(crate) gap: Option<f64>,
}

impl ThresholdArgs {
    /// What a single thing does that counts, in words.
    pub(crate) fn one(&self) -> String {
        self.words("touches", "is")
    }

    /// What several things do that count, in words.
    pub(crate) fn many(&self) -> String {
        self.words("touch", "are")
    }

    /// What such a thing does not do at rest, in words, after "that".
    pub(crate) fn at_rest(&self) -> &'static str {
        match (self.min_depth, self.gap) {
            (None, None) => "does not touch",
            _ => "is not so",
        }
    }

    fn words(&self, touch: &str, be: &str) -> String {
        match (self.min_depth, self.gap) {
            (Some(depth), _) => format!("{be} at least {depth} deep"),
            (None, Some(gap)) => format!("{be} at most {gap} apart"),
            (None, None) => touch.to_owned(),
        }
    }
}

/// A finite length.
fn length(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "expected a finite number of at least 0".to_owned())
}

/// How far one of two triangles has to move, in the best direction, to leave the other. If they do not touch, minus their distance.
///
/// Up to rounding, it is 0 for triangles in the same plane, and at most their size for others.
pub(crate) fn depth(a: &Triangle, b: &Triangle) -> f64 {
    if !triangles_intersect(a, b) {
        return -triangle_distance(a, b);
    }
    let edges = |[p, q, r]: &Triangle| [*q - *p, *r - *q, *p - *r];
    let (edges_a, edges_b) = (edges(a), edges(b));
    let normals = [edges_a, edges_b].map(|[first, second, _]| first.cross(second));
    // The faces of the difference of two convex bodies are perpendicular to these (the separating axis theorem).
    let crossed = edges_a.iter().flat_map(|of_a| edges_b.map(|of_b| of_a.cross(of_b)));
    let axes = normals.into_iter().chain(crossed).filter_map(DVec3::try_normalize);
    let along = |axis: DVec3| {
        let [of_a, of_b] = [a, b].map(|triangle| triangle.map(|corner| corner.dot(axis)));
        let [low_a, low_b] = [of_a, of_b].map(|[p, q, r]| p.min(q).min(r));
        let [high_a, high_b] = [of_a, of_b].map(|[p, q, r]| p.max(q).max(r));
        (high_a - low_b).min(high_b - low_a)
    };
    axes.map(along).reduce(f64::min).unwrap_or(0.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: Triangle = [DVec3::ZERO, DVec3::new(8.0, 0.0, 0.0), DVec3::new(0.0, 8.0, 0.0)];

    fn wall(height: f64) -> Triangle {
        [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 4.0]].map(|[x, y, z]| DVec3::new(x, y, z + height))
    }

    #[test]
    fn a_wall_in_a_floor_is_as_deep_as_it_stands_below_or_beside_it() {
        for (height, expected) in [(0.0, 0.0), (-0.25, 0.25), (-3.75, 0.25), (0.5, -0.5)] {
            for depth in [depth(&wall(height), &FLOOR), depth(&FLOOR, &wall(height))] {
                assert!((depth - expected).abs() < 1e-12, "{depth} at {height}");
            }
        }
        // Out over the edge is the shortest way.
        assert!((depth(&wall(-2.0), &FLOOR) - 1.0).abs() < 1e-12);
        assert_eq!(depth(&[DVec3::ONE; 3], &[DVec3::ONE; 3]), 0.0);
    }

    #[test]
    fn faces_that_lie_on_each_other_have_hardly_any_depth_whichever_way_they_face() {
        let tilted = FLOOR.map(|corner| corner + DVec3::Z * (1e-7 * corner.x - 2e-7));
        let [a, b, c] = tilted;
        for face in [tilted, [a, c, b], FLOOR] {
            let found = depth(&FLOOR, &face);
            assert!((0.0..1e-6).contains(&found), "{found}");
        }
    }

    #[test]
    fn lengths_are_finite_and_not_negative() {
        assert_eq!(length("0"), Ok(0.0));
        assert_eq!(length("1e-3"), Ok(0.001));
        for text in ["-1", "NaN", "inf", "1m", ""] {
            assert!(length(text).is_err(), "{text}");
        }
    }
}
