//! Which of the processor's instructions the kernels use: found out once, at run time.
//!
//! Kernels are written once, as `#[inline(always)]` functions with a [`Simd`](fearless_simd::Simd) token, and compiled for each set of
//! instructions by [`with_simd!`]. Every set multiplies and adds in the same order without fusing, so that all give the
//! same bits.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use fearless_simd::Level;

/// A set of instructions that this machine has. It is a matter of speed alone: answers are the same bits with any.
///
/// The best one is in use from the start; others are for tests and measurements.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    name: &'static str,
    level: Level,
}

/// Index into [`Kernel::available`].
static IN_USE: AtomicUsize = AtomicUsize::new(0);

impl Kernel {
    /// What this machine has, the one that is used if none is chosen first. The last one is what every machine of its kind has.
    #[must_use]
    pub fn available() -> &'static [Self] {
        static AVAILABLE: OnceLock<Vec<Kernel>> = OnceLock::new();
        AVAILABLE.get_or_init(Self::detect)
    }

    /// The one in use.
    #[must_use]
    pub fn in_use() -> Self {
        let available = Self::available();
        available[IN_USE.load(Ordering::Relaxed).min(available.len() - 1)]
    }

    /// Makes all queries of this process that start from now on use it.
    pub fn choose(self) {
        let index = Self::available().iter().position(|kernel| kernel.name == self.name);
        IN_USE.store(index.unwrap_or(0), Ordering::Relaxed);
    }

    /// What it is called: `avx2`, `sse2`, `neon`, `simd128` or `scalar`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.name
    }

    #[inline]
    pub(crate) fn level() -> Level {
        Self::in_use().level
    }

    fn detect() -> Vec<Self> {
        let best = Level::new();
        let mut kernels = Vec::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            // 512-bit vectors gain nothing with eight lanes.
            kernels.extend(best.as_avx2().map(|avx2| Self {
                name: "avx2",
                level: Level::Avx2(avx2),
            }));
            kernels.extend(best.as_sse2().map(|sse2| Self {
                name: "sse2",
                level: Level::Sse2(sse2),
            }));
        }
        #[cfg(target_arch = "aarch64")]
        kernels.extend(best.as_neon().map(|neon| Self {
            name: "neon",
            level: Level::Neon(neon),
        }));
        if kernels.is_empty() {
            let name = if cfg!(target_arch = "wasm32") && !best.is_fallback() {
                "simd128"
            } else {
                "scalar"
            };
            kernels.push(Self { name, level: best });
        }
        kernels
    }
}

/// Evaluates an expression, a call of one kernel, with the token of a level's instructions.
macro_rules! with_simd {
    ($level:expr, $simd:pat => $kernel:expr) => {
        fearless_simd::dispatch!($level, $simd => $kernel)
    };
}
pub(crate) use with_simd;
