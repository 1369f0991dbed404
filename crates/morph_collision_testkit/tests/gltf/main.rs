//! glTF in and out: what is read, what is refused, and that the two ends agree.

mod broken;
mod reading;
mod support;
mod writing;
