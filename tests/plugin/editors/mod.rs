//! Settings are read and changed while the app runs, as inspectors and the Bevy Remote Protocol do it.
//!
//! - `remote`: the steps of the protocol's methods. `types`: all types that editors see, and that none is forgotten.
//! - `effects`: changes take effect. `ranges`: the ranges that fields name are those that the plugin accepts.

mod effects;
mod ranges;
mod remote;
mod types;
