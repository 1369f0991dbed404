//! Copies in parts.

/// Continues a copy. Returns whether it is complete.
pub(super) fn copy<T, U>(into: &mut Vec<U>, from: &[T], left: &mut usize, convert: impl Fn(&T) -> U) -> bool {
    let missing = from.get(into.len()..).unwrap_or_default();
    let now = &missing[..missing.len().min(*left)];
    into.reserve_exact(missing.len());
    into.extend(now.iter().map(convert));
    *left -= now.len();
    now.len() == missing.len()
}
