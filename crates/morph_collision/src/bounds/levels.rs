//! The levels of all instructions that the machine has, for tests of single kernels.

use std::sync::OnceLock;

use fearless_simd::Level;

use super::Kernel;

/// One per [`Kernel::available`], in that order.
pub(crate) fn levels() -> &'static [Level] {
    static LEVELS: OnceLock<Vec<Level>> = OnceLock::new();
    LEVELS.get_or_init(|| {
        let before = Kernel::in_use();
        let level = |kernel: &Kernel| {
            kernel.choose();
            Kernel::level()
        };
        let levels = Kernel::available().iter().map(level).collect();
        before.choose();
        levels
    })
}
