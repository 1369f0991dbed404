//! k-DOPs of one body measured along the normals of another, conservatively with regard to the exact test in world space.

use super::directions::{Term, decompose, normals};
use super::slabs::Slabs;
use crate::rivals::relative::{ROUNDINGS_F64, Relative};

/// For each normal of the other space, the normals of the own space that bound it.
#[derive(Clone, Debug)]
pub(super) struct SlabMap<const H: usize> {
    terms: [[Term; 3]; H],
    /// Added to the lower and upper ends.
    offsets: [(f64, f64); H],
}

impl<const H: usize> SlabMap<H> {
    /// `None` if `f64` cannot represent it.
    pub(super) fn new(relative: &Relative) -> Option<Self> {
        let to_source = relative.linear.transpose();
        let mut map = Self {
            terms: [[(0, 0.0); 3]; H],
            offsets: [(0.0, 0.0); H],
        };
        for (i, normal) in normals::<H>().into_iter().enumerate() {
            // (L q + t) . n = q . (L^T n) + t . n
            let row = to_source * normal;
            let offset = normal.dot(relative.translation);
            // No product below has a larger sum of magnitudes. Volumes of nodes reach no farther than the root's, which is
            // `reach`.
            let magnitude = row.abs().element_sum() * relative.reach.element_sum() + offset.abs();
            let slack = normal.abs().dot(relative.error) + ROUNDINGS_F64 * magnitude;
            if !slack.is_finite() {
                return None;
            }
            map.terms[i] = decompose::<H>(row);
            map.offsets[i] = (offset - slack, offset + slack);
        }
        Some(map)
    }

    /// The largest extent of a k-DOP along a normal of the other space.
    #[inline]
    pub(super) fn along(&self, slabs: &Slabs<H>, normal: usize) -> (f64, f64) {
        let (mut start, mut end) = self.offsets[normal];
        for &(i, factor) in &self.terms[normal] {
            let (p, q) = (factor * slabs.start[i], factor * slabs.end[i]);
            start += if p < q { p } else { q };
            end += if p < q { q } else { p };
        }
        (start, end)
    }
}
