//! What to try, whether it comes from a command line or from a program.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use morph_collision::BuildOptions;

use crate::files::drawn::DrawnArgs;
use crate::files::model::{FileArgs, MeshChoice};
use crate::touching::depth::ThresholdArgs;

/// What lint tries, and how. `Default` tries single targets, clips, expressions and random mixtures, on all threads.
#[derive(Debug)]
pub(crate) struct LintOptions {
    /// The name of the model, for messages.
    pub(super) model: PathBuf,
    /// Only this mesh, in its own space.
    pub(super) mesh: Option<MeshChoice>,
    /// Which meshes, if not only one.
    pub(super) drawn: DrawnArgs,
    /// All pairs of targets.
    pub(super) pairs: bool,
    /// Files of recorded weights.
    pub(super) capture: Vec<PathBuf>,
    /// The number of random mixtures.
    pub(super) mixtures: usize,
    /// The random seed.
    pub(super) seed: u64,
    /// The animations to play; all of the file if there are none.
    pub(super) clip: Vec<String>,
    /// Whether an animation's end is its beginning.
    pub(super) is_loop: bool,
    /// Frames per second of animations.
    pub(super) fps: f32,
    /// The largest weights that do not clip.
    pub(super) suggest: bool,
    /// A garment to compare with instead of the mesh itself.
    pub(super) garment: Option<PathBuf>,
    pub(super) garment_mesh: Option<MeshChoice>,
    /// Proofs for all weights from 0 to 1.
    pub(super) prove: bool,
    /// How many parts of the box of all weights a proof looks at for each pair of triangles.
    pub(super) effort: u32,
    /// Whether findings get pictures.
    pub(super) pictures: bool,
    /// The number of threads; `None` for one per core.
    pub(super) threads: Option<NonZeroUsize>,
    pub(super) thresholds: ThresholdArgs,
    pub(super) tree: BuildOptions,
    pub(super) files: FileArgs,
}

impl LintOptions {
    /// The default number of random mixtures.
    pub(super) const MIXTURES: usize = 100;
    /// The default random seed.
    pub(super) const SEED: u64 = 1;
    /// The default for the parts of the box of all weights that a proof looks at.
    pub(super) const EFFORT: u32 = 1;
    /// The default frames per second of animations.
    pub(super) const FPS: f32 = 30.0;
}

impl Default for LintOptions {
    fn default() -> Self {
        Self {
            model: PathBuf::new(),
            mesh: None,
            drawn: DrawnArgs::default(),
            pairs: false,
            capture: Vec::new(),
            mixtures: Self::MIXTURES,
            seed: Self::SEED,
            clip: Vec::new(),
            is_loop: false,
            fps: Self::FPS,
            suggest: false,
            garment: None,
            garment_mesh: None,
            prove: false,
            effort: Self::EFFORT,
            pictures: false,
            threads: None,
            thresholds: ThresholdArgs::default(),
            tree: BuildOptions::default(),
            files: FileArgs::default(),
        }
    }
}
