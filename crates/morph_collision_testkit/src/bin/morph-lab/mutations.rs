//! `morph-lab mutations SECONDS [SEED]`: feeds mutated files to the readers. `just mutations` runs it under `ulimit -v`,
//! in a build that checks for overflow.
//!
//! Seeds are the fuzz corpora, the scenes in `assets/`, the models of the tests, and generated models. Half of the models are
//! changed without regard to what the bytes mean: a number is replaced by an odd one, pieces are deleted, repeated or swapped, or a bit is
//! flipped. The other half keep their structure ([`fuzzing::bend`]). Anything other than an error or a good answer ends the program: a
//! panic, an abort because memory ran out, or a file that takes more than ten seconds. At the end it prints the longest time of a file and
//! the most memory that the process took.

use std::path::Path;
use std::time::{Duration, Instant};

use clap::Args;
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_models::generated;
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_testkit::fuzzing;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const NUMBERS: [&str; 16] = [
    "0",
    "1",
    "-1",
    "2",
    "3",
    "255",
    "65536",
    "16777216",
    "1000000000",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "1e39",
    "0.5",
    "null",
    "{}",
];

/// Feed mutated files to the readers of models, scenes and trees for a given time.
#[derive(Debug, Args)]
pub(crate) struct MutationsArgs {
    /// How long, in all.
    seconds: u64,
    /// Random seed; the same seed gives the same files.
    #[arg(default_value_t = 1)]
    seed: u64,
}

pub(crate) fn mutations(args: &MutationsArgs) -> Result<Verdict, AnyError> {
    let mut rng = Pcg64Mcg::seed_from_u64(args.seed);
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let targets: [fuzzing::Target; 4] = [
        ("gltf", fuzzing::gltf),
        ("scene", fuzzing::scene),
        ("layout", fuzzing::layout),
        ("tree_file", fuzzing::tree_file),
    ];
    for (name, target) in targets {
        let mut seeds = files(&root.join("fuzz/corpus").join(name))?;
        if name == "gltf" {
            let copies = seeds.len() / 8 + 1;
            let data = root.join("crates/morph_collision_models/tests/gltf/data");
            let models = [files(&data)?, files(&data.join("field"))?].concat();
            let models = models.into_iter().filter(|bytes| bytes.starts_with(b"glTF"));
            seeds.extend(models.flat_map(|glb| std::iter::repeat_n(glb, copies / 4 + 1)));
            for mesh in [
                generated::random::random_blob(1, 0, 3, 0.5),
                generated::rigs::rigid_pieces(1, 2, 1),
            ] {
                let glb = to_glb(&mesh, &Appearance::default())?;
                seeds.extend(std::iter::repeat_n(glb, copies));
            }
        } else if name == "scene" {
            seeds.extend(files(&root.join("assets/scenes"))?);
        }
        let (start, mut runs, mut longest) = (Instant::now(), 0_u64, Duration::ZERO);
        while start.elapsed() < Duration::from_secs(args.seconds) / targets.len() as u32 {
            let bytes = mutated(&seeds[rng.random_range(0..seeds.len())], name == "gltf", &mut rng);
            let before = Instant::now();
            target(&bytes);
            longest = longest.max(before.elapsed());
            if longest > MOST_TIME {
                std::fs::write("slow", &bytes)?;
                return Err(format!("a mutated {name} took {longest:?}; it is in the file `slow`").into());
            }
            runs += 1;
        }
        println!(
            "{name}: {runs} mutated files of {} seeds, nothing found; the longest took {longest:?}{}",
            seeds.len(),
            peak_memory()
                .map(|peak| format!(", the process at most {peak}"))
                .unwrap_or_default()
        );
    }
    Ok(Verdict::Clean)
}

/// A file that takes longer is a bug.
const MOST_TIME: Duration = Duration::from_secs(10);

/// The most memory that this process took so far, if the system tells.
fn peak_memory() -> Option<String> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(peak.trim().to_owned())
}

fn mutated(seed: &[u8], is_gltf: bool, rng: &mut impl Rng) -> Vec<u8> {
    if is_gltf
        && rng.random_bool(0.5)
        && let Some(bent) = fuzzing::bend(seed, rng.random())
    {
        return bent;
    }
    let mut bytes = seed.to_vec();
    for _ in 0..rng.random_range(1..6) {
        mutate(&mut bytes, rng);
    }
    bytes
}

/// The files in a folder, but not in folders in it.
fn files(folder: &Path) -> std::io::Result<Vec<Vec<u8>>> {
    let entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut paths: Vec<_> = entries.iter().map(std::fs::DirEntry::path).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    paths.iter().map(std::fs::read).collect()
}

fn mutate(bytes: &mut Vec<u8>, rng: &mut impl Rng) {
    if bytes.is_empty() {
        bytes.push(b'{');
    }
    let at = rng.random_range(0..bytes.len());
    let end = (at + rng.random_range(1..40)).min(bytes.len());
    match rng.random_range(0..6) {
        0 => bytes[at] ^= 1 << rng.random_range(0..8),
        1 => {
            bytes.drain(at..end);
        }
        2 => {
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
        3 => {
            let other = rng.random_range(0..bytes.len());
            bytes.swap(at, other);
        }
        // Replaces the number at or after a position.
        _ => {
            let Some(first) = bytes[at..].iter().position(u8::is_ascii_digit) else {
                return;
            };
            let first = at + first;
            let length = bytes[first..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            let number = NUMBERS[rng.random_range(0..NUMBERS.len())];
            bytes.splice(first..first + length, number.bytes());
            keep_glb_lengths(bytes, number.len() as i64 - length as i64);
        }
    }
}

/// Fixes the lengths of a `.glb` whose JSON grew or shrank.
fn keep_glb_lengths(bytes: &mut [u8], by: i64) {
    if !bytes.starts_with(b"glTF") {
        return;
    }
    for at in [8, 12] {
        if let Some(field) = bytes.get_mut(at..at + 4) {
            let length = u32::from_le_bytes([field[0], field[1], field[2], field[3]]);
            field.copy_from_slice(&((i64::from(length) + by) as u32).to_le_bytes());
        }
    }
}
