//! The same bits everywhere: hashes of answers and posed vertices against a file of expected ones, for every kind of volume
//! and any number of threads and every set of instructions the machine has. Debug and release builds, and every machine, are judged by the same file.
//!
//! Only what is promised is in the file: what does not depend on the tree. Which of several pairs a walk comes to first does;
//! it must be one of them, and the same for any number of threads.

mod answers;
mod expected;
mod hash;
mod scenes;

use morph_collision::{Kernel, VolumeKind};

/// A way to run the queries, which no answer may depend on.
#[derive(Clone, Copy, Debug)]
struct Run {
    volume: VolumeKind,
    kernel: Kernel,
    threads: usize,
}

/// Every way that this machine knows.
fn runs() -> impl Iterator<Item = Run> {
    let ways = Kernel::available().iter().enumerate().flat_map(|(i, &kernel)| {
        let threads: &[usize] = if i == 0 { &[1, 2, 8] } else { &[1] };
        threads.iter().map(move |&threads| (kernel, threads))
    });
    VolumeKind::ALL.into_iter().flat_map(move |volume| {
        ways.clone().map(move |(kernel, threads)| Run {
            volume,
            kernel,
            threads,
        })
    })
}

#[test]
fn answers_and_vertices_are_the_expected_bits_for_every_volume_and_thread_count() {
    let scenes = scenes::all();
    let mut touching = 0;
    let all: Vec<expected::Line> = scenes
        .iter()
        .map(|scene| {
            let mut lines = runs().map(|run| (run, answers::of(scene, run)));
            let (_, reference) = lines.next().expect("there are runs");
            touching += usize::from(reference.pair_count > 0);
            let (mut firsts, mut volume) = (reference.firsts, runs().next().expect("there are runs").volume);
            for (run, line) in lines {
                assert_eq!(line.hashes, reference.hashes, "{}: {run:?} differs", scene.name);
                if run.volume != volume {
                    (firsts, volume) = (line.firsts, run.volume);
                }
                assert_eq!(line.firsts, firsts, "{}: first pairs of {run:?} differ", scene.name);
            }
            expected::Line {
                scene: scene.name.clone(),
                inputs: scene.hash(),
                hashes: reference.hashes,
            }
        })
        .collect();
    assert!(
        touching * 4 > scenes.len() * 3,
        "only {touching} of {} scenes touch",
        scenes.len()
    );
    expected::check(&all);
}
