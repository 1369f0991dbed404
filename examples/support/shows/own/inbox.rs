//! The way in for files, and what is said about them.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;
use serde::Serialize;

/// Where files are put for the show to take. Clones are of the same one.
#[derive(Resource, Clone, Debug, Default)]
pub struct Inbox(Arc<Mutex<Option<(String, Vec<u8>)>>>);

impl Inbox {
    /// Puts a file there: its name, for messages, and all that is in it. One that has not been taken yet is dropped.
    pub fn put(&self, name: String, bytes: Vec<u8>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some((name, bytes));
    }

    pub(super) fn take(&self) -> Option<(String, Vec<u8>)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// What has become of the file that was brought last. Clones are of the same one.
#[derive(Resource, Clone, Debug, Default)]
pub struct Verdict(Arc<Mutex<Judged>>);

/// A file, and what is to be said about it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Judged {
    /// How many were brought, with this one.
    pub number: u32,
    /// Its name.
    pub name: String,
    /// What it is made of, if it could be read.
    pub report: Option<String>,
    /// Why it is not shown.
    pub error: Option<String>,
    /// Whether it is on the stage.
    pub shown: bool,
}

impl Verdict {
    /// A copy of it.
    #[must_use]
    pub fn now(&self) -> Judged {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn change(&self, change: impl FnOnce(&mut Judged)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
