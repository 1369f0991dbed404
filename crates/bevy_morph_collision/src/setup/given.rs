//! Components that the plugin gives, and that stay the user's once the user changes them.

/// Updates the value that the plugin gave to a component. Returns whether to write it: it differs from the current value, and the
/// user has neither changed nor removed the component. `new` says that it is given for the first time.
pub(crate) fn should_update<C: Copy>(
    new: bool,
    given: &mut C,
    now: Option<&C>,
    wanted: C,
    is_same: impl Fn(&C, &C) -> bool,
) -> bool {
    let unchanged = now.map_or(new, |now| is_same(now, given));
    let differs = now.is_none_or(|now| !is_same(now, &wanted));
    *given = wanted;
    unchanged && differs
}
