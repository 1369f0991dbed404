//! Compares the library's continuous tests with exact arithmetic: `motions [COUNT] [SEED]`.
//!
//! It draws `COUNT` random motions (a million by default) and reads all recorded ones. It prints a row per family and per file: how
//! many motions there are and how many touch, how many answers differ, how many time intervals do not hold the exact first time of
//! contact or are too wide, and how many recorded answers are wrong. If anything is wrong, it prints the first such motion of each
//! row and exits with 1.

mod core;
mod recorded;
mod row;

use std::process::ExitCode;

use morph_collision_testkit::motion::Family;

use self::row::{Row, judge_all};

const COUNT: u64 = 1_000_000;

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let (Ok(count), Ok(seed)) = (numbers.next().unwrap_or(Ok(COUNT)), numbers.next().unwrap_or(Ok(1))) else {
        eprintln!("usage: motions [COUNT] [SEED], both whole numbers");
        return ExitCode::from(2);
    };
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
    match recorded::judge_files() {
        Ok(recorded) if recorded && agree => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("motions: error: {error}");
            ExitCode::from(2)
        }
    }
}
