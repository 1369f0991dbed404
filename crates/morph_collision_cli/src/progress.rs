//! Progress of a long command on stderr: a live bar on a terminal, an occasional line elsewhere.

use std::cell::RefCell;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use crate::output;

/// The progress option of commands that may take long.
#[derive(Debug, Args)]
pub(crate) struct ProgressArgs {
    /// Seconds between progress lines on stderr when it is not a terminal; 0 writes one per step.
    #[arg(long, value_name = "SECONDS", default_value_t = 10)]
    progress: u32,
}

/// Counts steps.
pub(crate) enum Progress {
    Bar(ProgressBar),
    Lines(RefCell<Lines>),
}

/// When to write a line, and what.
pub(crate) struct Lines {
    what: &'static str,
    length: u64,
    done: u64,
    start: Instant,
    every: Duration,
    next: Duration,
}

impl ProgressArgs {
    /// Starts counting `what` up to `length`.
    pub(crate) fn start(&self, what: &'static str, length: u64) -> Progress {
        let every = Duration::from_secs(self.progress.into());
        if !io::stderr().is_terminal() {
            return Progress::Lines(RefCell::new(Lines::new(what, length, every)));
        }
        let bar = ProgressBar::new(length);
        Progress::Bar(
            match ProgressStyle::with_template("{msg} {pos}/{len} [{bar:40}] {eta} left") {
                Ok(style) => bar.with_style(style).with_message(what),
                Err(_) => bar,
            },
        )
    }
}

impl Progress {
    /// Counts one step.
    pub(crate) fn step(&self) {
        match self {
            Self::Bar(bar) => bar.inc(1),
            Self::Lines(lines) => {
                let mut lines = lines.borrow_mut();
                let now = lines.start.elapsed();
                if let Some(line) = lines.step(now) {
                    output::complain(line);
                }
            }
        }
    }

    /// Ends the progress display; a bar disappears.
    pub(crate) fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

impl Lines {
    fn new(what: &'static str, length: u64, every: Duration) -> Self {
        Self {
            what,
            length,
            done: 0,
            start: Instant::now(),
            every,
            next: every,
        }
    }

    /// The line to write after a step that ended at `now`, counted from the start.
    fn step(&mut self, now: Duration) -> Option<String> {
        self.done += 1;
        if now < self.next {
            return None;
        }
        self.next = now + self.every;
        let (what, done, length, seconds) = (self.what, self.done, self.length, now.as_secs());
        Some(format!("progress: {what} {done} of {length} after {seconds} s"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_at_the_first_step_after_every_interval() {
        let mut lines = Lines::new("frame", 9, Duration::from_secs(10));
        let written: Vec<_> = [3, 9, 10, 12, 31, 32, 40, 41, 42]
            .into_iter()
            .filter_map(|second| lines.step(Duration::from_secs(second)))
            .collect();
        assert_eq!(
            written,
            [
                "progress: frame 3 of 9 after 10 s",
                "progress: frame 5 of 9 after 31 s",
                "progress: frame 8 of 9 after 41 s",
            ]
        );
    }
}
