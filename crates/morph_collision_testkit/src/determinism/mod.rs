//! The same bits everywhere: hashes of answers and posed vertices against a file of expected ones, for trees of
//! several leaf sizes and any number of threads and every set of instructions the machine has. Debug and release builds, and every machine, browsers
//! among them, are judged by the same file.
//!
//! Only what is promised is in the file: what does not depend on the tree. Which of several pairs a walk comes to first does;
//! it must be one of them, and the same for any number of threads.

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

/// A way to run the queries, which no answer may depend on.
#[derive(Clone, Copy, Debug)]
struct Run {
    leaf_size: usize,
    kernel: Kernel,
    threads: usize,
}

/// Every way that this machine knows: with its best instructions on so many threads, with all others on one.
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

/// What a scene comes to: a line of the file.
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

/// [`answer`] for all [`scenes`].
///
/// # Errors
/// As [`answer`]; or so few scenes touch that their hashes say little.
///
/// # Panics
/// As [`answer`].
pub fn answer_all(threads: &[usize]) -> Result<Vec<Line>, String> {
    let lines: Vec<Line> = scenes()
        .iter()
        .map(|scene| answer(scene, threads))
        .collect::<Result<_, _>>()?;
    let touching = lines.iter().filter(|line| line.touches()).count();
    if touching * 4 <= lines.len() * 3 {
        return Err(format!("only {touching} of {} scenes touch", lines.len()));
    }
    Ok(lines)
}

/// Asks a scene's questions in every way that this machine knows. The best instructions are tried on each of these numbers of
/// threads; where there are no threads, `&[1]`.
///
/// # Errors
/// Two ways give different answers: the message names the scene and the way.
///
/// # Panics
/// A query contradicts itself, or answers with NaN.
pub fn answer(scene: &Scene, threads: &[usize]) -> Result<Line, String> {
    let mut first: Option<Answers> = None;
    // The pairs that walks come to first depend on the tree, and so on its leaves, but on nothing else.
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
