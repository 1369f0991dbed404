//! The order of hits.

use std::cmp::Ordering;

/// Margin for rounding errors of squared distances. Pairs whose lower bound exceeds the best squared distance by up to this factor are
/// still measured, so that the answer does not depend on the tree.
pub(super) const MARGIN: f64 = 1.0 + 1e-9;

/// The place of a hit among others: a smaller distance comes first, and among equal distances a lower id.
///
/// All queries with a first or closest answer, and all sorted lists of hits, use this order. So the first hit of a list is the hit that a
/// query for the first one returns. It is a total order, so the answer does not depend on the order in which hits are found.
///
/// Use it to compare hits on several bodies. The id then starts with the body:
///
/// ```
/// use morph_collision::Rank;
///
/// // The distances, bodies and triangles of three hits. Two bodies have a surface at the same place.
/// let hits = [(2.0, 1, 7), (1.5, 3, 4), (1.5, 2, 9)];
/// let first = hits.iter().min_by_key(|&&(distance, body, triangle)| Rank::new(distance, (body, triangle)));
/// assert_eq!(first, Some(&(1.5, 2, 9)));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rank<Id> {
    /// What decides first: a ray's [`t`](crate::RayHit::t), or a distance.
    pub distance: f64,
    /// What decides among equal distances: usually the index of a triangle.
    pub id: Id,
}

impl<Id> Rank<Id> {
    /// Creates a rank. A distance of -0 is the same as 0, and NaN comes last.
    #[must_use]
    pub fn new(distance: f64, id: Id) -> Self {
        // The sum of -0 and 0 is 0. A NaN with a sign would come first.
        let distance = if distance.is_nan() { f64::NAN } else { distance + 0.0 };
        Self { distance, id }
    }
}

impl<Id: Ord> Ord for Rank<Id> {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_distance = self.distance.total_cmp(&other.distance);
        by_distance.then_with(|| self.id.cmp(&other.id))
    }
}

impl<Id: Ord> PartialOrd for Rank<Id> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<Id: Ord> PartialEq for Rank<Id> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<Id: Ord> Eq for Rank<Id> {}
