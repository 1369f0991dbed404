use std::cell::{Cell, RefCell};

use glam::{DMat3, DVec3};

use super::super::places::Places;
use super::limits::Approximation;
use crate::bounds::{LANES, U64, Volume, WorldFromModel};
use crate::pose::NodeRef;
use crate::traverse::{Meeting, Opened, PairRule, Side, Walkable};
use crate::tree::Child;

/// Two nodes, and how far triangles below them can be apart in the world.
pub(super) type Settled = (Child, Child, f64);

/// The rule of node pairs that may meet, are not all within the tolerance, and are still within the budget.
pub(super) struct Approximating<'a, V: Volume> {
    pub(super) meeting: Meeting<'a, V>,
    pub(super) limits: Approximation,
    /// Whether to stop at the first pair of parts within the tolerance.
    pub(super) first: bool,
    pub(super) spans: Spans,
    /// Triangles tested so far.
    pub(super) triangle_tests: Cell<u64>,
    pub(super) near: RefCell<Vec<Settled>>,
}

impl<V: Volume> PairRule<V> for Approximating<'_, V> {
    type Key = ();

    fn start(&self, a: &V::One, b: &V::One) -> Option<()> {
        self.meeting.start(a, b)
    }

    #[inline]
    fn children<T: Walkable<Kind = V>>(
        &self,
        side: Side,
        own: (&T, Opened),
        other: (&T, NodeRef),
        keys: &mut [(); LANES],
    ) -> u8 {
        self.meeting.children(side, own, other, keys)
    }

    /// A budget is kept to within a few tests.
    fn takes_both(&self) -> bool {
        self.limits.budget.is_none()
    }

    #[inline]
    fn both<T: Walkable<Kind = V>>(&self, a: (&T, Opened), b: (&T, Opened), rows: u8) -> [u8; LANES] {
        self.meeting.both(a, b, rows)
    }

    #[inline]
    fn still_wanted(&self, (): ()) -> bool {
        true
    }

    #[inline]
    fn goes_on(&self, node_tests: u64) -> bool {
        let found = self.first && !self.near.borrow().is_empty();
        let spent = self
            .limits
            .budget
            .is_some_and(|budget| node_tests + self.triangle_tests.get() >= budget);
        !found && !spent
    }

    const SETTLES: bool = true;

    fn settles(&self, (node_a, a): (NodeRef, &V::One), (node_b, b): (NodeRef, &V::One)) -> bool {
        // Nothing is as near as that, and asking costs.
        if self.limits.tolerance == 0.0 {
            return false;
        }
        let distance = self.spans.distance::<V>(a, b);
        let settled = distance <= self.limits.tolerance;
        if settled {
            self.near.borrow_mut().push((node_a.child, node_b.child, distance));
        }
        settled
    }
}

/// Where volumes of two bodies lie in the world, from outside.
pub(super) struct Spans {
    a: Span,
    b: Span,
}

struct Span {
    linear: DMat3,
    absolute: DMat3,
    translation: DVec3,
}

impl Spans {
    pub(super) fn of(places: &Places<'_>) -> Self {
        Self {
            a: Span::of(places.world_from_a),
            b: Span::of(places.world_from_b),
        }
    }

    /// What no point of one volume is farther than from any point of the other, as both are placed.
    pub(super) fn distance<V: Volume>(&self, a: &V::One, b: &V::One) -> f64 {
        let (center_a, half_a) = self.a.image::<V>(a);
        let (center_b, half_b) = self.b.image::<V>(b);
        ((center_a - center_b).abs() + half_a + half_b).length() * (1.0 + 16.0 * U64)
    }
}

impl Span {
    fn of(world_from_model: &WorldFromModel) -> Self {
        let linear = world_from_model.linear();
        Self {
            linear,
            absolute: DMat3::from_cols(linear.x_axis.abs(), linear.y_axis.abs(), linear.z_axis.abs()),
            translation: world_from_model.translation(),
        }
    }

    /// Centre and half size of a world-space box around a volume; the slack covers the roundings of the placed vertices
    /// (three sums) and of the box itself.
    fn image<V: Volume>(&self, one: &V::One) -> (DVec3, DVec3) {
        let bounds = V::bounds(one);
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, half) = (0.5 * (min + max), 0.5 * (max - min));
        let slack = self.absolute * (center.abs() + half) + self.translation.abs();
        (
            self.linear * center + self.translation,
            self.absolute * half + 32.0 * U64 * slack,
        )
    }
}
