//! How deep triangles are in each other, and how deep they must be to be reported.

use clap::Args;
use morph_collision::{Triangle, triangle_contact, triangle_distance};

/// What counts besides touching, or does not count although it touches.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct ThresholdArgs {
    /// Leave out what is less deep than this, in the file's unit. Faces that lie on each other touch by rounding alone.
    #[arg(long, value_name = "D", value_parser = length, allow_hyphen_values = true)]
    pub(crate) min_depth: Option<f64>,
    /// Triangles also count if they do not touch but are at most this far apart, in the file's unit. Their depth is minus the distance.
    ///
    /// Triangles of one mesh that share a vertex never count, but their next neighbours do, so choose a gap below the lengths of edges.
    #[arg(long, value_name = "G", value_parser = length, allow_hyphen_values = true, conflicts_with = "min_depth")]
    pub(crate) gap: Option<f64>,
}

/// A finite length.
fn length(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "expected a finite number of at least 0".to_owned())
}

/// How far the first triangle can move along the contact's normal before it leaves the second. If they do not touch, minus their distance.
pub(crate) fn depth(a: &Triangle, b: &Triangle) -> f64 {
    let Some(contact) = triangle_contact(a, b) else {
        return -triangle_distance(a, b);
    };
    let along = |triangle: &Triangle| triangle.map(|corner| corner.dot(contact.normal));
    let end = along(b).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let start = along(a).into_iter().fold(f64::INFINITY, f64::min);
    (end - start).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_finite_and_not_negative() {
        assert_eq!(length("0"), Ok(0.0));
        assert_eq!(length("1e-3"), Ok(0.001));
        for text in ["-1", "NaN", "inf", "1m", ""] {
            assert!(length(text).is_err(), "{text}");
        }
    }
}
