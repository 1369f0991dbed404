//! glTF in and out: what is read, what is refused, and that the two ends agree.

mod bombs;
mod broken;
mod reading;
mod skins;
mod support;
mod unused;
mod uris;
mod writing;
mod writing_skins;
