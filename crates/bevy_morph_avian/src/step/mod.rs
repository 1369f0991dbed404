//! The systems around Avian's step.

mod contacts;
mod frames;
mod movers;
mod predict;
mod query;
mod stages;
mod stepping;
mod systems;

pub(crate) use contacts::{refresh_contacts, remove_parts, report_contacts, stop_disabled};
pub(crate) use frames::{record_frame, rest, watch_clock};
pub(crate) use movers::find_movers;
pub(crate) use stepping::Stepping;
pub(crate) use systems::{after_step, apply_expulsion, before_step};
