//! Compares two patches, eight pairs at a time.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::triangles::Patch;
use super::verdict::ErrorBounds;

/// The result for one triangle of a patch against the triangles of another patch, as bit masks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::query::pairs) struct Row {
    pub(in crate::query::pairs) lane: usize,
    /// Triangles that might intersect it.
    pub(in crate::query::pairs) near: u8,
    /// Those of `near` that certainly intersect it.
    pub(in crate::query::pairs) meet: u8,
}

impl Patch {
    /// Filters the triangle pairs in the two masks. Calls `found` for every triangle of this patch that might intersect a triangle of
    /// the other.
    ///
    /// `select` takes a triangle of this patch and a mask of the other patch's triangles whose boxes overlap it. It returns the mask
    /// of those to test.
    #[inline(always)]
    pub(in crate::query::pairs) fn compare<S: Simd>(
        &self,
        simd: S,
        other: &Self,
        [mut own, others]: [u8; 2],
        select: impl Fn(usize, u8) -> u8,
        mut found: impl FnMut(Row) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let errors = ErrorBounds::new(simd, self.reach.max(other.reach));
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let mut near = select(lane, other.boxes.overlap_mask(simd, &self.boxes.get(lane)) & others);
            if near != 0 {
                let verdict = other.judge(simd, self, lane, &errors, near);
                near &= !verdict.apart;
                if near != 0 {
                    let meet = near & verdict.meet;
                    found(Row { lane, near, meet })?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}
