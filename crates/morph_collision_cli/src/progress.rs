//! What the program is doing, on stderr: a line that is kept up to date on a terminal, and an occasional line elsewhere.
//!
//! There is one activity at a time, so it is a global. A thread of its own shows it, so a long step is shown while it lasts.

use std::io::{self, IsTerminal};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use crate::output;

/// The progress option of all commands.
#[derive(Debug, Args)]
pub(crate) struct ProgressArgs {
    /// Seconds between progress lines on standard error when it is not a terminal; 0 writes one for every step.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 10,
        global = true,
        help_heading = "Everywhere"
    )]
    progress: u32,
}

/// A terminal shows nothing of commands that take less.
const PATIENCE: Duration = Duration::from_millis(500);
/// How often a terminal is updated.
const TICK: Duration = Duration::from_millis(100);

static NOW: Mutex<Option<Activity>> = Mutex::new(None);

/// What is being done, and how far it is.
#[derive(Debug)]
struct Activity {
    what: String,
    /// Steps done and all steps, if they are counted.
    steps: Option<(u64, u64)>,
    start: Instant,
    every_step: bool,
    /// On a terminal, once something is shown.
    bar: Option<ProgressBar>,
}

fn now() -> MutexGuard<'static, Option<Activity>> {
    NOW.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ProgressArgs {
    /// Starts to show what the program does.
    pub(crate) fn start(&self) {
        *now() = Some(Activity {
            what: String::new(),
            steps: None,
            start: Instant::now(),
            every_step: self.progress == 0,
            bar: None,
        });
        let every = Duration::from_secs(self.progress.into());
        // It ends with the program.
        std::thread::spawn(move || {
            if io::stderr().is_terminal() {
                std::thread::sleep(PATIENCE);
                loop {
                    if let Some(activity) = now().as_mut() {
                        activity.draw();
                    }
                    std::thread::sleep(TICK);
                }
            }
            while !every.is_zero() {
                std::thread::sleep(every);
                let line = now().as_ref().map(Activity::line);
                if let Some(line) = line {
                    output::complain(line);
                }
            }
        });
    }
}

/// Says what is done next. Something that may take long follows.
pub(crate) fn doing(what: impl Into<String>) {
    if let Some(activity) = now().as_mut() {
        activity.begin(what.into(), None);
    }
}

/// Counts the steps of an activity.
#[derive(Debug)]
pub(crate) struct Steps(());

/// Starts to count `what` up to `length`.
pub(crate) fn count(what: &str, length: u64) -> Steps {
    if let Some(activity) = now().as_mut() {
        activity.begin(what.to_owned(), Some((0, length)));
    }
    Steps(())
}

impl Steps {
    /// Counts one step.
    pub(crate) fn step(&self) {
        let mut line = None;
        if let Some(activity) = now().as_mut() {
            if let Some((done, _)) = &mut activity.steps {
                *done += 1;
            }
            line = activity.every_step.then(|| activity.line());
        }
        if let Some(line) = line {
            output::complain(line);
        }
    }
}

/// Removes the display, so that something else can be written to the terminal.
pub(crate) fn clear() {
    if let Some(bar) = now().as_mut().and_then(|activity| activity.bar.take()) {
        bar.finish_and_clear();
    }
}

/// Ends the display for good: the results follow.
pub(crate) fn end() {
    clear();
    *now() = None;
}

impl Activity {
    fn begin(&mut self, what: String, steps: Option<(u64, u64)>) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        (self.what, self.steps) = (what, steps);
    }

    /// The line to write after `self.start`.
    fn line(&self) -> String {
        let (what, seconds) = (&self.what, self.start.elapsed().as_secs());
        match self.steps {
            Some((done, all)) => format!("progress: {what} {done} of {all} after {seconds} s"),
            None => format!("progress: {what}, after {seconds} s"),
        }
    }

    /// Updates the line on the terminal.
    fn draw(&mut self) {
        let bar = self.bar.get_or_insert_with(|| {
            let (bar, template) = match self.steps {
                Some((_, all)) => (ProgressBar::new(all), "{msg} {pos}/{len} [{bar:40}] {eta} left"),
                None => (ProgressBar::new_spinner(), "{spinner} {msg}"),
            };
            match ProgressStyle::with_template(template) {
                Ok(style) => bar.with_style(style).with_message(self.what.clone()),
                Err(_) => bar,
            }
        });
        match self.steps {
            Some((done, _)) => bar.set_position(done),
            None => bar.tick(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_done_and_how_far_it_is() {
        let mut activity = Activity {
            what: "reading head.glb".into(),
            steps: None,
            start: Instant::now(),
            every_step: false,
            bar: None,
        };
        assert_eq!(activity.line(), "progress: reading head.glb, after 0 s");
        activity.begin("frame".into(), Some((3, 9)));
        assert_eq!(activity.line(), "progress: frame 3 of 9 after 0 s");
    }
}
