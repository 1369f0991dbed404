//! The instruction sets that kernels are compiled for.
//!
//! A kernel is an `#[inline(always)]` function that takes a [`Simd`](fearless_simd::Simd) token; [`with_simd!`] compiles it for
//! each instruction set. All of them multiply and add in the same order without fusing, so they give the same bits.

use std::sync::OnceLock;

use fearless_simd::Level;

/// A SIMD instruction set of this machine. It only affects speed: all instruction sets give the same bits.
///
/// The default is the best one available, which is detected once. For tests and measurements, choose another with
/// [`MorphBvh::with_kernel`](crate::MorphBvh::with_kernel).
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    name: &'static str,
    pub(crate) level: Level,
}

impl Default for Kernel {
    /// The first of [`Kernel::available`].
    fn default() -> Self {
        Self::available()[0]
    }
}

impl Kernel {
    /// The instruction sets of this machine, best first. Every machine of the same architecture has the last one.
    #[must_use]
    pub fn available() -> &'static [Self] {
        static AVAILABLE: OnceLock<Vec<Kernel>> = OnceLock::new();
        AVAILABLE.get_or_init(Self::detect)
    }

    /// `avx2`, `sse2`, `neon`, `simd128` or `scalar`.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.name
    }

    fn detect() -> Vec<Self> {
        let best = Level::new();
        // No AVX-512: kernels have eight lanes, which fill 256 bits.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let levels = [
            ("avx2", best.as_avx2().map(Level::Avx2)),
            ("sse2", best.as_sse2().map(Level::Sse2)),
        ];
        #[cfg(target_arch = "aarch64")]
        let levels = [("neon", best.as_neon().map(Level::Neon))];
        #[cfg(target_arch = "wasm32")]
        let levels = [("simd128", (!best.is_fallback()).then_some(best))];
        #[cfg(not(any(
            target_arch = "x86",
            target_arch = "x86_64",
            target_arch = "aarch64",
            target_arch = "wasm32"
        )))]
        let levels: [(&str, Option<Level>); 0] = [];
        let here = |(name, level): (_, Option<Level>)| level.map(|level| Self { name, level });
        let mut kernels: Vec<Self> = levels.into_iter().filter_map(here).collect();
        if kernels.is_empty() {
            kernels.push(Self {
                name: "scalar",
                level: best,
            });
        }
        kernels
    }
}

/// Evaluates an expression that calls one kernel, passing it the SIMD token of a level.
macro_rules! with_simd {
    ($level:expr, $simd:pat => $kernel:expr) => {
        fearless_simd::dispatch!($level, $simd => $kernel)
    };
}
pub(crate) use with_simd;
