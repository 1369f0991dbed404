//! `morph-lab motions [COUNT] [SEED]`: compares the library's continuous tests with exact arithmetic.
//!
//! It draws `COUNT` random motions and reads all recorded ones. It prints a row per family and per file: how
//! many motions there are and how many touch, how many answers differ, how many time intervals do not hold the exact first time of
//! contact or are too wide, and how many recorded answers are wrong. If anything is wrong, it prints the first such motion of each
//! row.

mod core;
mod recorded;
mod row;

use clap::Args;
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_testkit::motion::Family;

use self::row::{Row, judge_all};
use crate::verdict;

/// Compare the library's continuous tests with exact arithmetic, on random and recorded motions.
#[derive(Debug, Args)]
pub(crate) struct MotionsArgs {
    /// Number of random motions.
    #[arg(default_value_t = 1_000_000)]
    count: u64,
    /// Random seed; the same seed gives the same motions.
    #[arg(default_value_t = 1)]
    seed: u64,
}

pub(crate) fn motions(&MotionsArgs { count, seed }: &MotionsArgs) -> Result<Verdict, AnyError> {
    println!("{}", Row::HEADER);
    let mut agree = true;
    let each = count.div_ceil(Family::ALL.len() as u64);
    for family in Family::ALL {
        // Exact answers take long there.
        let each = if family == Family::Extreme {
            each.div_ceil(10)
        } else {
            each
        };
        let row = judge_all(each, |index| (family.motion(seed, index), None));
        agree &= row.print(family.name());
    }
    let recorded = recorded::judge_files()?;
    Ok(verdict(recorded && agree))
}
