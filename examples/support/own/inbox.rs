//! The inbox for files, and the verdict on them.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;
use serde::Serialize;

/// Files are put here for the show to take. Clones share the same inbox.
#[derive(Resource, Clone, Debug, Default)]
pub struct Inbox(Arc<Mutex<Option<(String, Vec<u8>)>>>);

impl Inbox {
    /// Puts a file here: its name, for messages, and its content. Replaces a file that has not been taken yet.
    pub fn put(&self, name: String, bytes: Vec<u8>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some((name, bytes));
    }

    pub(super) fn take(&self) -> Option<(String, Vec<u8>)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The verdict on the latest file. Clones share the same verdict.
#[derive(Resource, Clone, Debug, Default)]
pub struct Verdict(Arc<Mutex<Judged>>);

/// A file and its verdict.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Judged {
    /// How many files were provided, including this one.
    pub number: u32,
    /// Its name.
    pub name: String,
    /// A description of its content, if it could be read.
    pub report: Option<String>,
    /// Why it is not shown.
    pub error: Option<String>,
    /// Whether it is on the stage.
    pub shown: bool,
}

impl Verdict {
    /// A copy of the current verdict.
    #[must_use]
    pub fn now(&self) -> Judged {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn change(&self, change: impl FnOnce(&mut Judged)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
