//! Files of text beside models and scenes.

use std::path::Path;

use morph_collision_models::gltf::read::{LFS_POINTER, Remedy, is_lfs_pointer};
use morph_collision_models::memory::{FileFault, MemoryBudget, OverBudget, open_file, read_at_most};

use super::model::FileArgs;
use crate::error::CliError;

/// A file of text that an option names.
pub(crate) struct TextFile<'a> {
    pub(crate) flag: &'static str,
    pub(crate) path: &'a Path,
}

impl TextFile<'_> {
    /// Reads it within a budget, which then lacks its length.
    pub(crate) fn read(&self, files: &FileArgs, budget: &MemoryBudget) -> Result<String, CliError> {
        let text = open_file(self.path, files.allows_any_path()).and_then(|(file, length)| {
            // Of a length that is not known, the buffer grows.
            let growth = if length.is_some() { 1 } else { 3 };
            let bytes = read_at_most(file, length, budget.left() / growth)?;
            Ok((bytes, growth))
        });
        let (bytes, growth) = text.map_err(|fault| self.fault(&fault))?;
        if is_lfs_pointer(&bytes) {
            return Err(self.error(LFS_POINTER));
        }
        self.take(budget, bytes.len() as u64, growth, "its text")?;
        String::from_utf8(bytes).map_err(|error| self.error(error))
    }

    /// Counts memory for what is made of it.
    pub(crate) fn take(&self, budget: &MemoryBudget, count: u64, size: u64, what: &str) -> Result<(), CliError> {
        let taken = budget.take(count, size, || what.to_owned());
        taken.map_err(|over: OverBudget| self.refused(&over, Remedy::MoreMemory))
    }

    fn fault(&self, fault: &FileFault) -> CliError {
        match fault {
            FileFault::Io(_) => self.error(fault),
            FileFault::NotRegular => self.refused(fault, Remedy::AnyPath),
            FileFault::TooLong { .. } => self.refused(fault, Remedy::MoreMemory),
        }
    }

    fn refused(&self, reason: &dyn std::fmt::Display, remedy: Remedy) -> CliError {
        self.error(format_args!("{reason}{}", Remedy::hint(Some(remedy))))
    }

    /// An error that names the file and the option.
    pub(crate) fn error(&self, reason: impl std::fmt::Display) -> CliError {
        CliError::Flag {
            flag: self.flag,
            reason: format!("{}: {reason}", self.path.display()),
        }
    }
}
