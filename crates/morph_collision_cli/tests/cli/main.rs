//! Drives the `morph-collide` binary as a user would: passes files and checks its output and exit
//! code.

mod bad_input;
mod bench;
mod bombs;
mod drawn;
mod clips;
mod export;
mod guides;
mod inspect;
mod lint;
mod lint_garment;
mod motion;
mod outputs;
mod picture;
mod query;
mod run;
mod scene;
mod skins;
mod stress;
mod support;
mod surface;
mod sweep;
mod verify;
mod weights;
