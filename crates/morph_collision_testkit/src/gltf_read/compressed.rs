//! Buffer views and primitives that are stored compressed, decoded when they are first used.

use std::cell::OnceCell;

use super::document::Root;
use super::error::CompressionFault;
use super::extensions::{DRACO, MESHOPT};
use crate::memory::{MemoryBudget, OverBudget};

/// What was decoded so far, for each buffer view.
///
/// Files that require neither compression have empty lists. A file that uses a compression without requiring it also stores plain
/// data, and those are read.
#[derive(Debug)]
pub(super) struct Decoded {
    /// The bytes of views that are compressed by meshoptimizer.
    pub(super) views: Slots<Vec<u8>>,
    /// The meshes in views that hold Draco streams.
    pub(super) meshes: Slots<draco_core::Mesh>,
}

/// One slot for each buffer view of a file.
#[derive(Debug)]
pub(super) struct Slots<T>(Vec<OnceCell<Result<Box<T>, CompressionFault>>>);

impl Decoded {
    pub(super) fn new(root: &Root, budget: &MemoryBudget) -> Result<Self, OverBudget> {
        let required = |names: &[&str]| {
            root.extensions_required
                .iter()
                .any(|name| names.contains(&name.as_str()))
        };
        let views = root.buffer_views.len();
        Ok(Self {
            views: Slots::new(if required(&MESHOPT) { views } else { 0 }, budget)?,
            meshes: Slots::new(if required(&[DRACO]) { views } else { 0 }, budget)?,
        })
    }
}

impl<T> Slots<T> {
    fn new(count: usize, budget: &MemoryBudget) -> Result<Self, OverBudget> {
        let size = size_of::<OnceCell<Result<Box<T>, CompressionFault>>>();
        budget.take(count as u64, size as u64, || "the list of its compressed views".into())?;
        Ok(Self((0..count).map(|_| OnceCell::new()).collect()))
    }

    /// Whether the file requires this compression.
    pub(super) fn are_used(&self) -> bool {
        !self.0.is_empty()
    }

    /// The content of a view, decoded by `decode` on first use. Lack of memory is not remembered, because there may be more later.
    pub(super) fn get(
        &self,
        view: usize,
        decode: impl FnOnce() -> Result<T, CompressionFault>,
    ) -> Result<&T, CompressionFault> {
        let Some(slot) = self.0.get(view) else {
            return Err(CompressionFault::NoView);
        };
        if slot.get().is_none() {
            let found = decode().map(Box::new);
            if let Err(fault @ CompressionFault::OverBudget(_)) = found {
                return Err(fault);
            }
            // It was empty, so this sets it.
            let _ = slot.set(found);
        }
        match slot.get() {
            Some(Ok(content)) => Ok(content),
            Some(Err(fault)) => Err(fault.clone()),
            None => Err(CompressionFault::NoView),
        }
    }
}
