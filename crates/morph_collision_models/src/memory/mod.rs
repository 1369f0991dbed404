//! A limit on the memory that a file may claim, counted before anything is allocated, and on the length of files.

mod file;

use std::cell::Cell;
use std::fmt;
use std::rc::Rc;

pub use file::{FileFault, open_file, read_at_most};

/// The default limit: one gibibyte.
pub const DEFAULT_LIMIT: u64 = 1 << 30;

/// How much memory one file, or several files together, may still take. Clones share the limit and the count.
///
/// Files claim sizes that they do not store: a sparse accessor of a few bytes may stand for gigabytes. Every allocation whose
/// size a file decides is counted here first. The count is an upper estimate, not a measurement.
#[derive(Clone, Debug)]
pub struct MemoryBudget {
    limit: u64,
    counts: Rc<Counts>,
}

#[derive(Debug, Default)]
struct Counts {
    used: Cell<u64>,
    /// Part of `used`: memory that stays in use although it was taken while a budget was lent.
    kept: Cell<u64>,
}

/// Something would take more memory than is left.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} would take {}, which with the {} taken before is over the limit of {}", Bytes(*bytes), Bytes(*used), Bytes(*limit))]
pub struct OverBudget {
    /// The data that was to be allocated.
    pub what: String,
    /// Its size in bytes.
    pub bytes: u64,
    /// Bytes taken before.
    pub used: u64,
    /// The limit in bytes.
    pub limit: u64,
}

impl Default for MemoryBudget {
    fn default() -> Self {
        Self::new(DEFAULT_LIMIT)
    }
}

impl MemoryBudget {
    /// An unused budget of `limit` bytes.
    #[must_use]
    pub fn new(limit: u64) -> Self {
        Self {
            limit,
            counts: Rc::default(),
        }
    }

    /// The limit in bytes.
    #[must_use]
    pub fn limit(&self) -> u64 {
        self.limit
    }

    /// How many bytes are left.
    #[must_use]
    pub fn left(&self) -> u64 {
        self.limit - self.counts.used.get()
    }

    /// Takes memory for `count` things of `size` bytes each. `what` is called only for an error.
    ///
    /// # Errors
    /// If more is requested than is left; then nothing is taken.
    pub fn take(&self, count: u64, size: u64, what: impl FnOnce() -> String) -> Result<(), OverBudget> {
        let bytes = count.saturating_mul(size);
        let used = self.counts.used.get();
        if bytes > self.left() {
            return Err(OverBudget {
                what: what(),
                bytes,
                used,
                limit: self.limit,
            });
        }
        self.counts.used.set(used + bytes);
        Ok(())
    }

    /// Like [`MemoryBudget::take`], for memory that stays in use until the file is dropped: [`MemoryBudget::lend`] does not give
    /// it back.
    ///
    /// # Errors
    /// See [`MemoryBudget::take`].
    pub fn keep(&self, count: u64, size: u64, what: impl FnOnce() -> String) -> Result<(), OverBudget> {
        self.take(count, size, what)?;
        let kept = self.counts.kept.get();
        self.counts.kept.set(kept + count.saturating_mul(size));
        Ok(())
    }

    /// Runs `work` and gives back the memory that it took, except what it kept. Use it for data that is dropped before the next
    /// step.
    pub fn lend<T>(&self, work: impl FnOnce() -> T) -> T {
        let Counts { used, kept } = &*self.counts;
        let before = (used.get(), kept.get());
        let result = work();
        used.set(before.0 + (kept.get() - before.1));
        result
    }
}

/// A number of bytes, displayed in a suitable unit.
///
/// ```
/// assert_eq!(morph_collision_models::memory::Bytes(5 << 19).to_string(), "2.5 MiB");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.0 as f64;
        match self.0 {
            0..1024 => write!(f, "{} bytes", self.0),
            1024..0x10_0000 => write!(f, "{:.1} KiB", bytes / 1024.0),
            0x10_0000..0x4000_0000 => write!(f, "{:.1} MiB", bytes / 1024.0_f64.powi(2)),
            _ => write!(f, "{:.1} GiB", bytes / 1024.0_f64.powi(3)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_was_taken_counts_and_a_refusal_takes_nothing() {
        let budget = MemoryBudget::new(10 << 20);
        let take = |megabytes| budget.take(megabytes, 1 << 20, || "a mesh".into());
        assert_eq!(take(6), Ok(()));
        let error = take(5).expect_err("only 4 are left").to_string();
        assert_eq!(
            error,
            "a mesh would take 5.0 MiB, which with the 6.0 MiB taken before is over the limit of 10.0 MiB"
        );
        assert_eq!(take(4), Ok(()));
        assert!(budget.take(u64::MAX, 12, String::new).is_err());
        assert_eq!(budget.left(), 0);
    }

    #[test]
    fn what_is_lent_comes_back() {
        let budget = MemoryBudget::new(100);
        assert!(budget.lend(|| budget.take(80, 1, String::new)).is_ok());
        assert_eq!(budget.left(), 100);
        assert!(budget.lend(|| budget.keep(30, 1, String::new)).is_ok());
        assert_eq!(budget.left(), 70);
        assert!(budget.clone().take(70, 1, String::new).is_ok());
        assert_eq!(budget.left(), 0);
    }
}
