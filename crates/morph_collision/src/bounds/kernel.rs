//! The instruction sets that kernels are compiled for.
//!
//! A kernel is one `#[inline(always)]` function with a [`Simd`](fearless_simd::Simd) token; [`with_simd!`] compiles it for
//! each instruction set. All sets multiply and add in the same order without fusing, so all give the same bits.

use std::sync::OnceLock;

use fearless_simd::Level;

/// An instruction set of this machine. It decides the speed only: all of them give the same bits.
///
/// The default is the best one, which is detected once. Set another with
/// [`MorphBvh::with_kernel`](crate::MorphBvh::with_kernel) in tests and measurements.
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
    /// The instruction sets of this machine, best first. The last one exists on every machine of its kind.
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
        // AVX-512 is left out: a kernel has eight lanes, which fill 256 bits.
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

/// Evaluates an expression that calls one kernel, with the token of a level's instructions.
macro_rules! with_simd {
    ($level:expr, $simd:pat => $kernel:expr) => {
        fearless_simd::dispatch!($level, $simd => $kernel)
    };
}
pub(crate) use with_simd;
