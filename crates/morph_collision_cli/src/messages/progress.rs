//! What the program is doing, on stderr: a line that is kept up to date on a terminal, and an occasional line elsewhere.
//!
//! There is one activity at a time, so it is a global. A thread of its own shows it, so a long step is shown while it lasts. A program that
//! uses this library is told instead, if it [listens](listen).

use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::complain;

/// The progress option of all commands.
#[derive(Debug, Args)]
pub struct ProgressArgs {
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

/// What a listener is told while a command runs.
#[derive(Clone, Copy, Debug)]
pub enum Message<'a> {
    /// Something begins, or one of its steps is done.
    Progress {
        /// What is being done.
        what: &'a str,
        /// Steps done and all steps, if they are counted.
        steps: Option<(u64, u64)>,
    },
    /// What was left out of the result, and why.
    Warning(&'a str),
}

/// A function that is told about progress and warnings.
pub type Listener = fn(Message<'_>);

/// What is being done, and how far it is.
#[derive(Debug)]
struct Activity {
    what: String,
    /// Steps done and all steps, if they are counted.
    steps: Option<(u64, u64)>,
    listeners: Listeners,
}

/// Who is told.
#[derive(Debug)]
enum Listeners {
    Stderr {
        start: Instant,
        every_step: bool,
        /// On a terminal, once something is shown.
        bar: Option<ProgressBar>,
    },
    Listener(Listener),
}

/// Passes progress and warnings of all that follows to a function, from the thread that does the work.
pub fn listen(listener: Listener) {
    *now() = Some(Activity::new(Listeners::Listener(listener)));
}

fn now() -> MutexGuard<'static, Option<Activity>> {
    NOW.lock().unwrap_or_else(PoisonError::into_inner)
}

impl ProgressArgs {
    /// Starts to show what the program does.
    pub fn start(&self) {
        *now() = Some(Activity::new(Listeners::Stderr {
            start: Instant::now(),
            every_step: self.progress == 0,
            bar: None,
        }));
        let every = Duration::from_secs(self.progress.into());
        // It ends with the program. Where there are no threads, only `--progress 0` shows anything.
        let _thread = std::thread::Builder::new().spawn(move || {
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
                let line = now().as_ref().and_then(Activity::line);
                if let Some(line) = line {
                    complain(line);
                }
            }
        });
    }
}

/// Says what is done next. Something that may take long follows.
pub fn doing(what: impl Into<String>) {
    if let Some(activity) = now().as_mut() {
        activity.begin(what.into(), None);
    }
}

/// Counts the steps of an activity. It counts by itself, so what another thread does meanwhile takes no step from it.
#[derive(Debug)]
pub struct Steps {
    what: String,
    done: AtomicU64,
    all: u64,
}

/// Starts to count `what` up to `length`.
pub fn count(what: &str, length: u64) -> Steps {
    if let Some(activity) = now().as_mut() {
        activity.begin(what.to_owned(), Some((0, length)));
    }
    Steps {
        what: what.to_owned(),
        done: AtomicU64::new(0),
        all: length,
    }
}

impl Steps {
    /// Counts one step.
    pub fn step(&self) {
        let mut line = None;
        if let Some(activity) = now().as_mut() {
            // Under the lock, so that the numbers told never go back.
            let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
            if activity.what != self.what {
                activity.clear();
                activity.what.clone_from(&self.what);
            }
            activity.steps = Some((done, self.all));
            activity.report();
            line = activity.line_of_step();
        }
        if let Some(line) = line {
            complain(line);
        }
    }
}

/// Removes the display, so that something else can be written to the terminal.
pub(crate) fn clear() {
    if let Some(activity) = now().as_mut() {
        activity.clear();
    }
}

/// Ends the display for good: the results follow.
pub(crate) fn end() {
    clear();
    *now() = None;
}

/// Passes a warning to the listener. Returns false if there is none.
pub(crate) fn warn_listener(warning: &str) -> bool {
    match now().as_ref().map(|activity| &activity.listeners) {
        Some(Listeners::Listener(listener)) => listener(Message::Warning(warning)),
        _ => return false,
    }
    true
}

impl Activity {
    fn new(listeners: Listeners) -> Self {
        Self {
            what: String::new(),
            steps: None,
            listeners,
        }
    }

    fn begin(&mut self, what: String, steps: Option<(u64, u64)>) {
        self.clear();
        (self.what, self.steps) = (what, steps);
        self.report();
    }

    fn clear(&mut self) {
        if let Listeners::Stderr { bar, .. } = &mut self.listeners
            && let Some(bar) = bar.take()
        {
            bar.finish_and_clear();
        }
    }

    /// Tells the listener, if there is one.
    fn report(&self) {
        if let Listeners::Listener(listener) = self.listeners {
            listener(Message::Progress {
                what: &self.what,
                steps: self.steps,
            });
        }
    }

    /// The line to write to stderr after some time.
    fn line(&self) -> Option<String> {
        let Listeners::Stderr { start, .. } = self.listeners else {
            return None;
        };
        let (what, seconds) = (&self.what, start.elapsed().as_secs());
        Some(match self.steps {
            Some((done, all)) => format!("progress: {what} {done} of {all} after {seconds} s"),
            None => format!("progress: {what}, after {seconds} s"),
        })
    }

    /// The line to write after each step, if that is asked for.
    fn line_of_step(&self) -> Option<String> {
        match self.listeners {
            Listeners::Stderr { every_step: true, .. } => self.line(),
            _ => None,
        }
    }

    /// Updates the line on the terminal.
    fn draw(&mut self) {
        let Listeners::Stderr { bar, .. } = &mut self.listeners else {
            return;
        };
        let bar = bar.get_or_insert_with(|| {
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
        let mut activity = Activity::new(Listeners::Stderr {
            start: Instant::now(),
            every_step: false,
            bar: None,
        });
        activity.begin("reading head.glb".into(), None);
        assert_eq!(
            activity.line().as_deref(),
            Some("progress: reading head.glb, after 0 s")
        );
        activity.begin("frame".into(), Some((3, 9)));
        assert_eq!(activity.line().as_deref(), Some("progress: frame 3 of 9 after 0 s"));
    }
}
