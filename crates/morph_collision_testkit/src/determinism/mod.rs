//! Checks that every machine computes the same bits: compares hashes of answers and posed vertices with a file of expected ones.
//!
//! The hashes must not depend on the leaf size of trees, the number of threads or the set of instructions. Debug and release
//! builds, and all machines including browsers, use the same file.
//!
//! The file contains only what is promised, that is, what does not depend on the tree. For example, a walk may find any of
//! several pairs first. That pair must be one of them, and the same for any number of threads.

mod answers;
mod expected;
mod hash;
mod scenes;

use std::fmt;

use morph_collision::Kernel;

pub use expected::{differences, write};
pub use scenes::{Scene, all as scenes};

use crate::verify::LEAF_SIZES;
use answers::{Answers, COLUMNS};
use hash::Hash;

/// A way to run the queries. No answer may depend on it.
#[derive(Clone, Copy, Debug)]
struct Run {
    leaf_size: usize,
    kernel: Kernel,
    threads: usize,
}

/// All ways that this machine supports: its best instructions on each of these numbers of threads, all other instructions on one
/// thread.
fn runs(threads: &[usize]) -> impl Iterator<Item = Run> + Clone {
    let ways = Kernel::available().iter().enumerate().flat_map(move |(i, &kernel)| {
        let threads = if i == 0 { threads } else { &[1] };
        threads.iter().map(move |&threads| (kernel, threads))
    });
    LEAF_SIZES.into_iter().flat_map(move |leaf_size| {
        ways.clone().map(move |(kernel, threads)| Run {
            leaf_size,
            kernel,
            threads,
        })
    })
}

/// The hashes of a scene: a line of the file.
#[derive(Clone, Debug)]
pub struct Line {
    scene: String,
    inputs: u64,
    hashes: [Hash; COLUMNS.len()],
    touches: bool,
}

impl Line {
    /// Whether any of its bodies touch.
    #[must_use]
    pub fn touches(&self) -> bool {
        self.touches
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x} ", self.inputs)?;
        for hash in self.hashes {
            write!(f, "{:016x} ", hash.value())?;
        }
        f.write_str(&self.scene)
    }
}

/// Calls [`answer`] for all [`scenes`], and `progress` after each.
///
/// # Errors
/// Those of [`answer`], and if so few scenes touch that their hashes say little.
///
/// # Panics
/// See [`answer`].
pub fn answer_all(threads: &[usize], mut progress: impl FnMut()) -> Result<Vec<Line>, String> {
    let lines: Vec<Line> = scenes()
        .iter()
        .map(|scene| answer(scene, threads).inspect(|_| progress()))
        .collect::<Result<_, _>>()?;
    let touching = lines.iter().filter(|line| line.touches()).count();
    if touching * 4 <= lines.len() * 3 {
        return Err(format!("only {touching} of {} scenes touch", lines.len()));
    }
    Ok(lines)
}

/// Asks a scene's questions in every way that this machine supports. The best instructions run on each of these numbers of
/// threads; pass `&[1]` if there are no threads.
///
/// # Errors
/// Two ways give different answers. The message names the scene and the way.
///
/// # Panics
/// A query contradicts itself, or answers with NaN.
pub fn answer(scene: &Scene, threads: &[usize]) -> Result<Line, String> {
    let mut first: Option<Answers> = None;
    // The pairs that walks find first depend on the tree, and so on its leaf size, but on nothing else.
    let mut of_tree: Option<(usize, Hash)> = None;
    for run in runs(threads) {
        let answers = answers::of(scene, run);
        let reference = *first.get_or_insert(answers);
        if answers.hashes != reference.hashes {
            return Err(format!("{}: {run:?} differs", scene.name));
        }
        match of_tree {
            Some((leaf_size, firsts)) if leaf_size == run.leaf_size => {
                if firsts != answers.firsts {
                    return Err(format!("{}: first pairs of {run:?} differ", scene.name));
                }
            }
            _ => of_tree = Some((run.leaf_size, answers.firsts)),
        }
    }
    let Some(reference) = first else {
        return Err(format!("{}: there is no way to ask", scene.name));
    };
    Ok(Line {
        scene: scene.name.clone(),
        inputs: scene.hash(),
        hashes: reference.hashes,
        touches: reference.pair_count > 0,
    })
}
