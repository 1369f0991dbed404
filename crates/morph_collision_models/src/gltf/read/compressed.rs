//! Buffer views and primitives that are stored compressed, decoded when they are first used.

use std::cell::OnceCell;

use super::document::Root;
use super::error::CompressionFault;
use crate::memory::MemoryBudget;

/// What was decoded so far, for each buffer view.
///
/// Compressed data are decoded wherever they are, even if the file does not say in `extensionsRequired` that readers need to.
#[derive(Debug)]
pub(super) struct Decoded {
    /// The bytes of views that are compressed by meshoptimizer.
    pub(super) views: Slots<Vec<u8>>,
    /// The meshes in views that hold Draco streams.
    pub(super) meshes: Slots<draco_core::Mesh>,
}

/// One slot for each buffer view of a file. The slots are made on first use, so that files without compression have none.
#[derive(Debug)]
pub(super) struct Slots<T> {
    views: usize,
    slots: OnceCell<Vec<Slot<T>>>,
}

type Slot<T> = OnceCell<Result<Box<T>, CompressionFault>>;

impl Decoded {
    pub(super) fn new(root: &Root) -> Self {
        let views = root.buffer_views.len();
        Self {
            views: Slots::new(views),
            meshes: Slots::new(views),
        }
    }
}

impl<T> Slots<T> {
    fn new(views: usize) -> Self {
        let slots = OnceCell::new();
        Self { views, slots }
    }

    fn slots(&self, budget: &MemoryBudget) -> Result<&[Slot<T>], CompressionFault> {
        if let Some(slots) = self.slots.get() {
            return Ok(slots);
        }
        let what = || "the list of its compressed views".into();
        let keep = budget.keep(self.views as u64, size_of::<Slot<T>>() as u64, what);
        keep.map_err(CompressionFault::OverBudget)?;
        Ok(self
            .slots
            .get_or_init(|| (0..self.views).map(|_| OnceCell::new()).collect()))
    }

    /// The content of a view, decoded by `decode` on first use. Lack of memory is not remembered, because there may be more later.
    pub(super) fn get(
        &self,
        view: usize,
        budget: &MemoryBudget,
        decode: impl FnOnce() -> Result<T, CompressionFault>,
    ) -> Result<&T, CompressionFault> {
        let Some(slot) = self.slots(budget)?.get(view) else {
            return Err(CompressionFault::NoView);
        };
        if slot.get().is_none() {
            let found = decode().map(Box::new);
            match found {
                Err(fault) if fault.is_lack_of_memory() => return Err(fault),
                // It was empty, so this sets it.
                found => drop(slot.set(found)),
            }
        }
        match slot.get() {
            Some(Ok(content)) => Ok(content),
            Some(Err(fault)) => Err(fault.clone()),
            None => Err(CompressionFault::NoView),
        }
    }
}
